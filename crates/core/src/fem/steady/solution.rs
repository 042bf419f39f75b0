//! A solved contact and the quantities read from it.

use super::level::Level;
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
    /// Friction coefficient from the power of the shear traction, over `p v`: zero without one. On the converged mesh
    /// friction is the sum of both.
    pub interface_friction: f64,
    /// Contact area fraction: length in contact along x over the period, edges read between nodes.
    pub contact_area_fraction: f64,
    /// Mean separation in m: of the mean planes of the deformed surface and the profile.
    pub mean_separation: f64,
    /// Mean shear of the block.
    pub shear: f64,
    /// Largest `I1 - 3` of the elastic part of the deformation of a spring, at the points where shear parts are
    /// integrated; `None` under the linear law. Beyond [`Rheology::limit`](crate::rubber::Rheology::limit) there is no
    /// solution.
    pub largest_invariant: Option<f64>,
    /// Root mean square, over the contact nodes, of the unbalanced nodal forces, over the mean contact
    /// force. Gaps are met exactly.
    pub residual: f64,
    /// Newton steps on all grids, those of failed attempts among them, since the solution before.
    pub newton_steps: usize,
    /// Applications of the tangent since the solution before.
    pub krylov_iterations: usize,
    /// Columns and rows of the mesh.
    pub elements: [usize; 2],
    /// The same contact on half the columns, if the solution was refined from there.
    pub coarser: Option<Coarser>,
    /// The contact nodes.
    pub nodes: Vec<ContactNode>,
}

/// The same contact on half the columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coarser {
    /// Its friction coefficient.
    pub friction_coefficient: f64,
    /// Its contact area fraction.
    pub contact_area_fraction: f64,
}

/// A node of the deformed surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactNode {
    /// Position in m.
    pub x: f64,
    /// Height of the profile there in m, about its mean.
    pub profile_height: f64,
    /// Normal pressure in Pa on the deformed surface, which is the vertical force over the length along x.
    pub pressure: f64,
    /// Vertical gap in m, above the mean of the short waves where they are a layer.
    pub separation: f64,
}

impl SteadySolution {
    /// Reads an exact state; the block of the level must be at it.
    pub(super) fn read(level: &Level, state: &State, speed: f64, residual: f64) -> Self {
        let grid = level.grid();
        let (n, spacing) = (grid.contact_nodes(), grid.spacing(0));
        let (pairs, surface) = (level.pairs(state, 0.0), &level.surface);
        let [mut traction, mut load] = [0.0; 2];
        for (j, slope) in surface.slopes.iter().enumerate() {
            let [along, up] = pairs.on_node(j, *slope);
            traction += along;
            load += up;
        }
        let sheared = surface.slopes.iter().zip(&pairs.shears).zip(slip_speeds(level, state));
        let slip: f64 = sheared.map(|((h, shear), speed)| shear * (1.0 + h * h) * speed).sum();
        let nodes: Vec<ContactNode> = (0..n)
            .map(|j| ContactNode {
                x: j as f64 * spacing,
                profile_height: surface.heights[j] - surface.scale.mean,
                pressure: pairs.forces[j] / spacing,
                separation: pairs.gaps[j] + pairs.layer[j],
            })
            .collect();
        let touching: f64 = (0..n)
            .map(|j| touching_part(&pairs.forces, j, n - 1) + touching_part(&pairs.forces, j, 1))
            .sum();
        let above = pairs.gaps.iter().zip(&pairs.layer).map(|(gap, layer)| gap + layer);
        let heights = surface.heights.iter().zip(above).map(|(z, above)| z + above);
        let mean_height = heights.sum::<f64>() / n as f64;
        let power = level.block.dissipation(&state.displacements);
        Self {
            mean_pressure: state.pressure,
            friction_coefficient: traction / load,
            hysteretic_friction: power / (load * speed),
            interface_friction: slip / load,
            contact_area_fraction: touching / n as f64,
            mean_separation: mean_height - surface.scale.mean,
            shear: state.shear(grid),
            largest_invariant: level.block.largest_invariant(&state.displacements),
            residual,
            newton_steps: 0,
            krylov_iterations: 0,
            elements: [n, grid.rows()],
            coarser: None,
            nodes,
        }
    }

    /// The solution with that on a coarser grid.
    pub(super) fn above(self, coarser: &Self) -> Self {
        let &Self { friction_coefficient, contact_area_fraction, .. } = coarser;
        Self { coarser: Some(Coarser { friction_coefficient, contact_area_fraction }), ..self }
    }
}

/// Speed of the rubber along x at each contact node, over that of the block: `ds/dξ` with the label `ξ = s - q`.
fn slip_speeds(level: &Level, state: &State) -> Vec<f64> {
    let grid = level.grid();
    let (n, spacing) = (grid.contact_nodes(), grid.spacing(0));
    let contact = grid.row(&state.displacements, 0);
    let label = |j: usize| contact[2 * (j % n)].value();
    let stretch = |j: usize| 1.0 - (label(j + 1) - label(j + n - 1)) / (2.0 * spacing);
    (0..n).map(|j| 1.0 / stretch(j)).collect()
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
