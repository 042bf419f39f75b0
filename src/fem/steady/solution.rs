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
        let area: f64 = (0..n)
            .map(|j| {
                let before = touching_part(&state.forces, j, n - 1);
                let after = touching_part(&state.forces, j, 1);
                before * step((j + n - 1) % n) + after * step(j)
            })
            .sum();
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

/// Length in contact beside a contact node, in whole elements: a half towards another contact node,
/// or what reaches up to the edge of the contact, which lies before the node if this is negative.
/// `towards` is the step to the neighbour on the side in question, modulo the nodes.
///
/// The force of a node is the integral of the pressure with the node's shape function. Next to an
/// edge the pressure grows like the root of the distance, so that the last two forces of a contact
/// have the ratio `I(d) / I(d + 1)` for an edge `d` elements behind the last node, with `I` the
/// integral of a hat with that root.
fn touching_part(forces: &[f64], node: usize, towards: usize) -> f64 {
    let n = forces.len();
    if forces[node] <= 0.0 {
        return 0.0;
    }
    if forces[(node + towards) % n] > 0.0 {
        return 0.5;
    }
    let inside = forces[(node + n - towards) % n];
    let ratio = forces[node] / inside;
    let of = |d: f64| hat_with_root(d) / hat_with_root(d + 1.0);
    // A single node, or one with more force than the next: no edge in reach.
    if inside <= 0.0 || ratio >= of(1.0) {
        return 0.5;
    }
    let (mut low, mut high) = (-1.0, 1.0);
    while high - low > 1e-12 {
        let middle = 0.5 * (low + high);
        if of(middle) < ratio { low = middle } else { high = middle }
    }
    low
}

/// `∫ max(0, 1 - |x|) sqrt(max(0, d - x)) dx`: the second difference of `4/15 y^(5/2)`.
fn hat_with_root(d: f64) -> f64 {
    let power = |y: f64| y.max(0.0).powf(2.5);
    4.0 / 15.0 * (power(d + 1.0) - 2.0 * power(d) + power(d - 1.0))
}
