//! Taking a state to another mesh.

use super::super::mesh::Mesh;
use super::state::State;

/// The state on another mesh of the same block: displacements by cubics along and across
/// the rows, forces per length and gaps of the contact nodes likewise.
pub(super) fn transfer(state: &State, from: &Mesh, to: &Mesh) -> State {
    let (old, new) = (from.node_heights(), to.node_heights());
    let mut displacements = Vec::with_capacity(2 * to.columns * new.len());
    for height in &new {
        let rows = stencil(&old, *height);
        for column in 0..to.columns {
            let position = column as f64 * to.spacing() + to.skew * height;
            for component in 0..2 {
                let along = |r: usize| {
                    let place = (position - from.skew * old[r]) / from.spacing();
                    let value =
                        |j: usize| state.displacements[2 * (r * from.columns + j) + component];
                    cubic(from.columns, place, value)
                };
                displacements.push(rows.iter().map(|(r, weight)| weight * along(*r)).sum());
            }
        }
    }
    let ratio = to.spacing() / from.spacing();
    let place = |column: usize| column as f64 * ratio;
    // Straight lines keep forces and gaps positive.
    let forces = (0..to.columns)
        .map(|j| ratio * linear(from.columns, place(j), |j| state.forces[j]))
        .collect();
    let gaps = (0..to.columns).map(|j| linear(from.columns, place(j), |j| state.gaps[j])).collect();
    State { displacements, forces, gaps }
}

/// The rows around a height and their weights in the polynomial through them (Lagrange); a row
/// that is met exactly stands alone.
fn stencil(rows: &[f64], height: f64) -> Vec<(usize, f64)> {
    let near = |z: f64| (z - height).abs() < 1e-9 * rows[rows.len() - 1];
    if let Some(row) = rows.iter().position(|z| near(*z)) {
        return vec![(row, 1.0)];
    }
    let above = rows.iter().position(|z| *z > height).unwrap_or(rows.len() - 1);
    let first = above.saturating_sub(2).min(rows.len().saturating_sub(4));
    let last = (first + 4).min(rows.len());
    let weight = |r: usize| {
        let others = (first..last).filter(|other| *other != r);
        others.map(|other| (height - rows[other]) / (rows[r] - rows[other])).product()
    };
    (first..last).map(|r| (r, weight(r))).collect()
}

/// Periodic interpolation by the straight line through the two neighbours.
fn linear(n: usize, place: f64, value: impl Fn(usize) -> f64) -> f64 {
    let left = place.floor();
    let t = place - left;
    let at = |offset: i64| value((left as i64 + offset).rem_euclid(n as i64) as usize);
    (1.0 - t) * at(0) + t * at(1)
}

/// Periodic interpolation by the cubic through the four neighbours.
fn cubic(n: usize, place: f64, value: impl Fn(usize) -> f64) -> f64 {
    let left = place.floor();
    let t = place - left;
    let at = |offset: i64| value((left as i64 + offset).rem_euclid(n as i64) as usize);
    let weights = [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ];
    weights.iter().zip(-1..).map(|(weight, offset)| weight * at(offset)).sum()
}
