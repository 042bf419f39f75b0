//! Laplace's equation on the points of one gap.

use super::super::HeightMap;
use super::{NONE, neighbours};
use nalgebra::{DMatrix, DVector};

/// Points of a gap that is solved at once.
const DENSE: usize = 32;
/// Residual of larger ones, over the right side.
const TOLERANCE: f64 = 1e-12;

/// Heights of the points of a gap; `None` if the iteration does not converge. `places` holds the place of each point of
/// the gap in its list.
pub(super) fn solve(map: &HeightMap, gap: &[usize], places: &[u32]) -> Option<Vec<f64>> {
    let equations = Equations::new(map, gap, places);
    let heights = if gap.len() <= DENSE {
        equations.solve_at_once()
    } else {
        equations.conjugate_gradients()
    };
    Some(heights?.into_iter().map(|height| height + equations.level).collect())
}

/// Sums over the neighbours of `weight (z - z_neighbour) = 0`, with the known heights on the right side.
struct Equations {
    /// Places of the neighbours that are unknown, `NONE` for others: two along x, two along y.
    unknown: Vec<[u32; 4]>,
    weights: [f64; 4],
    diagonal: Vec<f64>,
    right_side: Vec<f64>,
    /// Mean of the known heights, from which all are counted: maps may lie far above zero.
    level: f64,
}

impl Equations {
    fn new(map: &HeightMap, gap: &[usize], places: &[u32]) -> Self {
        let ratio = map.spacing[1] / map.spacing[0];
        let weights = [ratio, ratio, 1.0 / ratio, 1.0 / ratio];
        let mut equations = Self {
            unknown: Vec::with_capacity(gap.len()),
            weights,
            diagonal: Vec::with_capacity(gap.len()),
            right_side: Vec::with_capacity(gap.len()),
            level: 0.0,
        };
        let (mut sum, mut count) = (0.0, 0.0);
        for &point in gap {
            for neighbour in neighbours(map.points, point).into_iter().flatten() {
                if !map.heights[neighbour].is_nan() {
                    sum += map.heights[neighbour];
                    count += 1.0;
                }
            }
        }
        equations.level = sum / count;
        for &point in gap {
            let (mut unknown, mut diagonal, mut right_side) = ([NONE; 4], 0.0, 0.0);
            for (side, neighbour) in neighbours(map.points, point).into_iter().enumerate() {
                let Some(neighbour) = neighbour else { continue };
                diagonal += weights[side];
                if map.heights[neighbour].is_nan() {
                    unknown[side] = places[neighbour];
                } else {
                    right_side += weights[side] * (map.heights[neighbour] - equations.level);
                }
            }
            equations.unknown.push(unknown);
            equations.diagonal.push(diagonal);
            equations.right_side.push(right_side);
        }
        equations
    }

    fn solve_at_once(&self) -> Option<Vec<f64>> {
        let n = self.diagonal.len();
        if n == 1 {
            return Some(vec![self.right_side[0] / self.diagonal[0]]);
        }
        let mut matrix = DMatrix::from_diagonal(&DVector::from_column_slice(&self.diagonal));
        for (row, unknown) in self.unknown.iter().enumerate() {
            for (&column, weight) in unknown.iter().zip(self.weights).filter(|(c, _)| **c != NONE) {
                matrix[(row, column as usize)] -= weight;
            }
        }
        let right_side = DVector::from_column_slice(&self.right_side);
        Some(matrix.cholesky()?.solve(&right_side).as_slice().to_vec())
    }

    /// `image = A z`.
    fn apply(&self, z: &[f64], image: &mut [f64]) {
        for (k, unknown) in self.unknown.iter().enumerate() {
            let mut sum = self.diagonal[k] * z[k];
            for (&place, weight) in unknown.iter().zip(self.weights) {
                if place != NONE {
                    sum -= weight * z[place as usize];
                }
            }
            image[k] = sum;
        }
    }

    /// Conjugate gradients; the diagonal is nearly constant, so nothing is gained by scaling with it.
    fn conjugate_gradients(&self) -> Option<Vec<f64>> {
        let n = self.diagonal.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut heights = vec![0.0; n];
        let mut residual = self.right_side.clone();
        let mut direction = residual.clone();
        let mut image = vec![0.0; n];
        let mut square = dot(&residual, &residual);
        let enough = TOLERANCE * TOLERANCE * square;
        // In exact arithmetic n steps are enough, in practice a few times the width of the gap.
        for _ in 0..4 * n + 100 {
            if square <= enough {
                return Some(heights);
            }
            self.apply(&direction, &mut image);
            let length = square / dot(&direction, &image);
            for k in 0..n {
                heights[k] += length * direction[k];
                residual[k] -= length * image[k];
            }
            let next = dot(&residual, &residual);
            let turn = next / square;
            direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + turn * *d);
            square = next;
        }
        None
    }
}
