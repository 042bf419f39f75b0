//! Contacts by Lemke's method on the dense matrix: the slow second route.

use crate::surfaces::Profile;
use asperity::rubber::Rubber;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A contact solved without transforms, iterations or nested grids.
pub struct DenseContact {
    /// Mean pressure in Pa that the indentation takes.
    pub mean_pressure: f64,
    /// Mean separation in m.
    pub mean_separation: f64,
    /// Pressure in Pa at the points.
    pub pressure: DVector<f64>,
    /// Ratio of the largest to the smallest singular value of the matrix on the contact set.
    pub condition_number: f64,
}

impl DenseContact {
    /// The contact at an indentation `depth`, the share of the height of the highest point above
    /// the mean. Mean pressure and mean separation follow from it.
    pub fn at_depth(rubber: &Rubber, speed: f64, profile: &Profile, depth: f64) -> Self {
        let n = profile.heights.len();
        let kernel = kernel(rubber, speed, profile.period, n);
        let mean = profile.heights.iter().sum::<f64>() / n as f64;
        let heights: Vec<f64> = profile.heights.iter().map(|z| z - mean).collect();
        let top = heights.iter().copied().fold(0.0, f64::max);
        // The load is not given but follows from a rigid displacement in proportion to it, which
        // makes the matrix positive definite.
        let softness = kernel[0].abs();
        let matrix = DMatrix::from_fn(n, n, |i, j| kernel[(i + n - j) % n] / softness + 1.0);
        let q = DVector::from_fn(n, |i, _| (1.0 - depth) - heights[i] / top);
        let pressure = lemke(&matrix, &q) * (top / softness);
        let set: Vec<usize> = (0..n).filter(|i| pressure[*i] > 0.0).collect();
        let singular = matrix.select_rows(&set).select_columns(&set).singular_values();
        Self {
            mean_pressure: pressure.mean(),
            mean_separation: (1.0 - depth) * top + softness * pressure.sum(),
            pressure,
            condition_number: singular.max() / singular.min(),
        }
    }
}

/// Displacement at point `j` by a unit pressure at point 0: the sum of `2 / (|q| E_r(q v))` over
/// the waves of the grid, with the phase taken back towards the highest.
fn kernel(rubber: &Rubber, speed: f64, period: f64, points: usize) -> Vec<f64> {
    (0..points)
        .map(|j| {
            let waves = (1..=points / 2).map(|k| {
                let q = TAU * k as f64 / period;
                let relative = 2.0 * k as f64 / points as f64;
                let modulus = rubber.reduced_modulus(q * speed);
                let lag = -modulus.arg() * (FRAC_PI_2 * relative.powi(2)).cos().powi(2);
                let both_signs = if 2 * k == points { 1.0 } else { 2.0 };
                let angle = TAU * ((k * j) % points) as f64 / points as f64;
                both_signs * 2.0 / (q * modulus.norm()) * (angle + lag).cos()
            });
            waves.sum::<f64>() / points as f64
        })
        .collect()
}

/// Solves `u = M t + q`, `u >= 0`, `t >= 0`, `u t = 0` by complementary pivoting (Lemke 1965,
/// doi:10.1287/mnsc.11.7.681) and the found basis once more by an LU factorisation.
fn lemke(matrix: &DMatrix<f64>, q: &DVector<f64>) -> DVector<f64> {
    let n = q.len();
    // Columns: u, t, the artificial variable, the right-hand side.
    let mut tableau = DMatrix::<f64>::zeros(n, 2 * n + 2);
    for i in 0..n {
        tableau[(i, i)] = 1.0;
        for j in 0..n {
            tableau[(i, n + j)] = -matrix[(i, j)];
        }
        tableau[(i, 2 * n)] = -1.0;
        tableau[(i, 2 * n + 1)] = q[i];
    }
    let artificial = 2 * n;
    let mut basis: Vec<usize> = (0..n).collect();
    let mut row = (0..n).min_by(|a, b| q[*a].total_cmp(&q[*b])).unwrap();
    let mut entering = artificial;
    loop {
        let leaving = std::mem::replace(&mut basis[row], entering);
        pivot(&mut tableau, row, entering);
        if leaving == artificial {
            break;
        }
        entering = if leaving < n { leaving + n } else { leaving - n };
        row = (0..n)
            .filter(|i| tableau[(*i, entering)] > 1e-11)
            .min_by(|a, b| {
                let ratio = |i: usize| tableau[(i, 2 * n + 1)] / tableau[(i, entering)];
                ratio(*a).total_cmp(&ratio(*b))
            })
            .expect("a positive definite matrix leaves no ray");
    }
    let set: Vec<usize> = (0..n).filter(|i| basis.contains(&(n + i))).collect();
    let restricted = DMatrix::from_fn(set.len(), set.len(), |i, j| matrix[(set[i], set[j])]);
    let rhs = DVector::from_fn(set.len(), |i, _| -q[set[i]]);
    let on_set = restricted.lu().solve(&rhs).unwrap();
    let mut t = DVector::zeros(n);
    set.iter().zip(on_set.iter()).for_each(|(i, value)| t[*i] = *value);
    t
}

fn pivot(tableau: &mut DMatrix<f64>, row: usize, column: usize) {
    let pivot_row = tableau.row(row) / tableau[(row, column)];
    let factors = tableau.column(column).into_owned();
    for i in 0..tableau.nrows() {
        if i == row {
            tableau.set_row(i, &pivot_row);
        } else {
            let mut target = tableau.row_mut(i);
            target -= factors[i] * &pivot_row;
        }
    }
}
