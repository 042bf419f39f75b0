//! Carrying a change of the surface into the block.
//!
//! Where the profile changes, Newton's method would have to carry the change up row by row. The
//! incompressible half-plane whose surface is displaced vertically by `d_k e^{ikx}` without shear
//! traction is a good first guess at it:
//!
//! ```text
//! w_k(Z) = (1 + |k| Z) e^{-|k| Z} d_k,   q_k(Z) = -i k Z e^{-|k| Z} d_k
//! ```

use super::grid::Grid;
use super::long::Long;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// `|k| Z` above which the displacement is zero.
const FAR: f64 = 40.0;

/// Adds the displacements of the block that belong to vertical ones of the surface in m.
pub(super) fn lift(grid: &Grid, surface: &[f64], displacements: &mut [Long]) {
    let count = surface.len();
    let mut planner = FftPlanner::new();
    let mut spectrum: Vec<Complex64> = surface.iter().map(|d| Complex64::from(*d)).collect();
    planner.plan_fft_forward(count).process(&mut spectrum);
    for row in 1..=grid.rows() {
        let nodes = grid.nodes_in(row);
        // q + i w, so that one transform does for both.
        let mut both = vec![Complex64::ZERO; nodes];
        for (k, surface) in spectrum.iter().enumerate().take(nodes.div_ceil(2)) {
            let depth = TAU * k as f64 / grid.period * grid.levels[row];
            if depth > FAR {
                break;
            }
            let d = surface * (-depth).exp() / count as f64;
            let (w, q) = ((1.0 + depth) * d, -Complex64::I * depth * d);
            both[k] += q + Complex64::I * w;
            if k > 0 {
                both[nodes - k] += q.conj() + Complex64::I * w.conj();
            }
        }
        planner.plan_fft_inverse(nodes).process(&mut both);
        let first = grid.first_node(row);
        let upper = row == grid.rows();
        for (node, value) in displacements[2 * first..].chunks_exact_mut(2).zip(&both) {
            node[0] += if upper { 0.0 } else { value.re };
            node[1] += value.im;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::BlockOptions;
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_wave_decays_as_in_the_half_plane() {
        let grid = Grid::new(&BlockOptions::new(64), 1.0);
        let surface: Vec<f64> = (0..64).map(|j| 0.1 + (TAU * f64::from(j) / 32.0).cos()).collect();
        let mut displacements = vec![Long::default(); 2 * grid.nodes()];
        lift(&grid, &surface, &mut displacements);
        for row in 1..grid.rows() {
            let depth = 2.0 * TAU * grid.levels[row];
            let amplitude = (-depth).exp();
            for (j, node) in grid.row(&displacements, row).chunks_exact(2).enumerate() {
                let (sine, cosine) = (TAU * j as f64 / 32.0).sin_cos();
                assert_relative_eq!(node[0].value(), depth * amplitude * sine, epsilon = 1e-12);
                let w = 0.1 + (1.0 + depth) * amplitude * cosine;
                assert_relative_eq!(node[1].value(), w, epsilon = 1e-12);
            }
        }
    }
}
