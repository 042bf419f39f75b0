//! A solved contact and what is read from it.

use super::newton::Level;
use super::path::Scene;
use super::state::State;

/// The steady contact at one mean pressure.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadySolution {
    /// Mean pressure p in Pa on the upper edge.
    pub mean_pressure: f64,
    /// Friction coefficient: horizontal over vertical contact force, positive where it opposes the
    /// motion.
    pub friction_coefficient: f64,
    /// Friction coefficient from the power that the branches turn into heat, over `p v`. On the
    /// converged mesh it equals [`Self::friction_coefficient`]; the difference measures the mesh.
    pub hysteretic_friction: f64,
    /// Contact area fraction: length in contact along x over the period, edges read between nodes.
    pub contact_area_fraction: f64,
    /// Mean separation in m: of the mean planes of the deformed surface and the profile.
    pub mean_separation: f64,
    /// Mean shear of the block.
    pub shear: f64,
    /// Euclidean norm of the unbalanced nodal forces over that of the contact forces, or the
    /// largest violated gap over the height of the profile, whichever is more.
    pub residual: f64,
    /// Newton steps on all meshes since the solution before.
    pub newton_steps: usize,
    /// Applications of the tangent since the solution before.
    pub krylov_iterations: usize,
    /// Columns and rows of the mesh.
    pub elements: [usize; 2],
    /// The contact nodes.
    pub nodes: Vec<ContactNode>,
}

/// A node of the deformed surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactNode {
    /// Position in m.
    pub x: f64,
    /// Height of the profile there in m, about its mean.
    pub profile_height: f64,
    /// Normal pressure in Pa on the deformed surface.
    pub pressure: f64,
    /// Vertical gap in m.
    pub separation: f64,
}

impl SteadySolution {
    pub(super) fn read(
        state: &State,
        level: &Level,
        scene: &Scene,
        speed: f64,
        pressure: f64,
        residual: f64,
    ) -> Self {
        let mesh = level.block.mesh();
        let n = mesh.columns;
        let xs: Vec<f64> =
            (0..n).map(|j| j as f64 * mesh.spacing() + state.displacements[2 * j]).collect();
        // Distance to the next node along x.
        let step = |j: usize| {
            let wrap = if j + 1 == n { mesh.period } else { 0.0 };
            xs[(j + 1) % n] + wrap - xs[j]
        };
        let profile: Vec<_> = xs.iter().map(|x| scene.profile.at(*x)).collect();
        let load: f64 = state.forces.iter().sum();
        let traction: f64 = state.forces.iter().zip(&profile).map(|(f, at)| f * at.slope).sum();
        let nodes: Vec<ContactNode> = (0..n)
            .map(|j| ContactNode {
                x: xs[j],
                profile_height: profile[j].height - scene.heights.mean,
                pressure: state.forces[j] / (0.5 * (step((j + n - 1) % n) + step(j))),
                separation: state.gaps[j],
            })
            .collect();
        let area = (0..2 * n)
            .map(|k| {
                touching_part(&nodes, k / 2, k % 2 == 1)
                    * step(if k % 2 == 1 { k / 2 } else { (k / 2 + n - 1) % n })
            })
            .sum::<f64>();
        let mean_height: f64 = (0..n)
            .map(|j| {
                let z = |j: usize| state.displacements[2 * (j % n) + 1];
                0.5 * (z(j) + z(j + 1)) * step(j)
            })
            .sum::<f64>()
            / mesh.period;
        let power = level.block.dissipation(&state.displacements);
        Self {
            mean_pressure: pressure,
            friction_coefficient: traction / load,
            hysteretic_friction: power / (load * speed),
            contact_area_fraction: area / mesh.period,
            mean_separation: mean_height - scene.heights.mean,
            shear: state.shear(mesh),
            residual,
            newton_steps: 0,
            krylov_iterations: 0,
            elements: [n, mesh.rows()],
            nodes,
        }
    }
}

/// Share in contact of the half element beside a contact node, in whole elements. Between a node
/// in contact and one that is not lies the edge: the square of the pressure falls to zero there
/// along a straight line, as it does at the edge of any smooth contact.
fn touching_part(nodes: &[ContactNode], node: usize, after: bool) -> f64 {
    let n = nodes.len();
    let neighbour =
        |offset: usize| &nodes[if after { node + offset } else { node + n - offset } % n];
    let here = nodes[node].pressure;
    if here <= 0.0 {
        return 0.0;
    }
    if neighbour(1).pressure > 0.0 {
        return 0.5;
    }
    let inside = if after { &nodes[(node + n - 1) % n] } else { &nodes[(node + 1) % n] };
    let (here, inside) = (here * here, inside.pressure * inside.pressure);
    // Not further than the next node, which is open.
    if inside > here { (here / (inside - here)).min(1.0) } else { 0.5 }
}
