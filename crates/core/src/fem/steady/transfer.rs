//! Taking a state to another grid of the same block.

use super::level::Level;
use super::long::Long;
use super::state::State;

/// The state on another grid: displacements by cubics along and across the rows, forces per length and
/// gaps of the contact nodes by straight lines, which keep them positive.
pub(super) fn transfer(state: &State, barrier: f64, from: &Level, to: &Level) -> State {
    let (old, new) = (from.grid(), to.grid());
    let mut displacements = Vec::with_capacity(2 * new.nodes());
    for (row, height) in new.levels.iter().enumerate() {
        let rows = stencil(&old.levels, *height);
        let columns = new.nodes_in(row);
        for column in 0..columns {
            let position = column as f64 / columns as f64;
            for component in 0..2 {
                let along = |r: usize| {
                    let nodes = old.row(&state.displacements, r);
                    let count = old.nodes_in(r);
                    cubic(count, position * count as f64, |j| nodes[2 * j + component].value())
                };
                let value: f64 = rows.iter().map(|(r, weight)| weight * along(*r)).sum();
                displacements.push(value.into());
            }
        }
    }
    let upper = to.upper_edge();
    displacements[upper].iter_mut().step_by(2).for_each(|x| *x = Long::default());
    let pairs = from.pairs(state, barrier);
    let (coarse, fine) = (old.contact_nodes(), new.contact_nodes());
    let ratio = coarse as f64 / fine as f64;
    let unknown = |j: usize| {
        let force = linear(coarse, j as f64 * ratio, |j| pairs.forces[j]);
        let gap = linear(coarse, j as f64 * ratio, |j| pairs.gaps[j]);
        to.unknown(ratio * force, gap).into()
    };
    State { displacements, contact: (0..fine).map(unknown).collect(), pressure: state.pressure }
}

/// The rows around a height and their weights in the polynomial through them (Lagrange); at a row exactly, that row alone.
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
