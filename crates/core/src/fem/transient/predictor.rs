//! The state from which a step is iterated.

use super::step::State;
use crate::fem::mesh::Mesh;

/// The state carried along with the profile.
///
/// In steady sliding the field is constant in the frame of the profile: after a distance d a
/// rubber point has the displacement that the point a distance d ahead had before, plus d. The
/// lower edge moves by `contact_distance`, the upper edge by `edge_distance`, both in m; between
/// them the block shears.
pub fn carried(mesh: &Mesh, state: &State, contact_distance: f64, edge_distance: f64) -> State {
    let n = mesh.columns;
    let shift = contact_distance / mesh.spacing();
    let heights = mesh.node_heights();
    let mut nodes = Vec::with_capacity(state.nodes.len());
    for (row, height) in state.nodes.chunks_exact(2 * n).zip(&heights) {
        let shear = height / heights[heights.len() - 1];
        let moved = contact_distance + shear * (edge_distance - contact_distance);
        for node in 0..n {
            nodes.push(ahead(n, node, shift, |j| row[2 * j]) + moved);
            nodes.push(ahead(n, node, shift, |j| row[2 * j + 1]));
        }
    }
    let mut multipliers = state.multipliers.clone();
    let old = &state.multipliers.values;
    for (node, value) in multipliers.values.iter_mut().enumerate() {
        *value = ahead(n, node, shift, |j| old[j]);
    }
    State { nodes, multipliers }
}

/// Linear interpolation `shift` nodes ahead of a node of a periodic row.
fn ahead(n: usize, node: usize, shift: f64, value: impl Fn(usize) -> f64) -> f64 {
    let place = (node as f64 + shift).rem_euclid(n as f64);
    let left = place as usize % n;
    let weight = place.fract();
    (1.0 - weight) * value(left) + weight * value((left + 1) % n)
}
