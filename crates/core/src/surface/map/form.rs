//! Form of a map: a polynomial surface by least squares.

use super::HeightMap;
use crate::error_kind::{ErrorKind, HasKind};
use crate::surface::form::legendre;
use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest total degree of a polynomial form; above it the fit begins to remove texture.
pub const LARGEST_DEGREE: usize = 8;

/// Largest condition number of the normal equations, scaled to a unit diagonal. A complete map of
/// 20 x 20 points or more has one below 10 at any degree in use; without 40 % of it at one side it is 1e9 at degree 8.
const LARGEST_CONDITION: f64 = 1e10;

/// The form to remove from a map or a window, by least squares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum FormOfMap {
    /// The mean height.
    Mean,
    /// The plane.
    Plane,
    /// The polynomial in x and y of this total degree, at most 8.
    Polynomial(usize),
}

impl FormOfMap {
    /// Total degree of the polynomial: 0 for the mean, 1 for the plane.
    pub fn degree(self) -> usize {
        match self {
            Self::Mean => 0,
            Self::Plane => 1,
            Self::Polynomial(degree) => degree,
        }
    }
}

/// A form that was removed from a map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RemovedMapForm {
    /// Coefficients in millimetres of the products `P_a(x) P_b(y)` of Legendre polynomials, on the centres of the first
    /// and the last point along each axis mapped to -1 and 1. Ordered by total degree, then by falling degree in x: 1,
    /// x, y, P_2(x), x y, P_2(y) ... The first is the mean level.
    pub legendre_coefficients_mm: Vec<f64>,
    /// Root mean square over the valid points of the form without its mean level, in millimetres.
    pub rms_mm: f64,
    /// Slope along x and y of the least-squares plane, in mm/mm, whatever form was removed. None where the valid points
    /// lie on one line.
    pub tilt: Option<[f64; 2]>,
}

/// Valid points that do not determine a form.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapFormError {
    /// There are fewer valid heights than coefficients.
    #[error(
        "{valid} valid points do not determine the {coefficients} coefficients of a form of degree {degree}"
    )]
    TooFew {
        /// Number of valid heights.
        valid: usize,
        /// Number of coefficients.
        coefficients: usize,
        /// Total degree.
        degree: usize,
    },
    /// The valid points lie on a curve or in a corner.
    #[error(
        "the valid points do not determine a form of degree {degree} (condition number {condition:.1e}, \
         the limit is {LARGEST_CONDITION:.0e}); lower the degree"
    )]
    Undetermined {
        /// Total degree.
        degree: usize,
        /// Condition number of the scaled normal equations.
        condition: f64,
    },
}

impl HasKind for MapFormError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooFew { .. } | Self::Undetermined { .. } => ErrorKind::Input,
        }
    }
}

/// Subtracts the least-squares form of the valid heights; missing ones stay NaN and do not count.
///
/// The normal equations are accumulated row by row, so that the work is about `4 (degree + 1)` multiplications per point
/// and no matrix has a row per point. Products of Legendre polynomials keep the equations close to diagonal, and what
/// their solution leaves is fitted once more. An exact polynomial surface leaves less than 1e-13 of its largest height at
/// any condition number that is accepted.
///
/// # Errors
/// [`MapFormError`] when the valid heights do not determine the coefficients.
pub fn remove_form(map: &mut HeightMap, form: FormOfMap) -> Result<RemovedMapForm, MapFormError> {
    let degree = form.degree();
    let basis = Basis::new(map.points, degree);
    let gram = basis.gram(&map.heights);
    let solve = NormalEquations::new(&gram, basis.terms.len(), map, degree)?;
    let tilt = tilt(map);
    let mut coefficients = DVector::zeros(basis.terms.len());
    // The second pass fits what round-off of the first has left.
    for _ in 0..2 {
        let found = solve.solve(&basis.projections(&map.heights));
        basis.subtract(&mut map.heights, &found);
        coefficients += found;
    }
    let mut varying = coefficients.clone();
    varying[0] = 0.0;
    let valid = map.heights.len() - map.missing();
    let rms = (varying.dot(&(&gram * &varying)).max(0.0) / valid as f64).sqrt();
    let legendre_coefficients_mm = coefficients.iter().map(|c| c * 1e3).collect();
    Ok(RemovedMapForm { legendre_coefficients_mm, rms_mm: rms * 1e3, tilt })
}

/// Slopes `[dz/dx, dz/dy]` of the least-squares plane of the valid heights; `None` if they lie on one line.
pub fn tilt(map: &HeightMap) -> Option<[f64; 2]> {
    let basis = Basis::new(map.points, 1);
    let equations =
        NormalEquations::new(&basis.gram(&map.heights), basis.terms.len(), map, 1).ok()?;
    let plane = equations.solve(&basis.projections(&map.heights));
    let slope = |axis: usize| plane[1 + axis] / (half_length(map.points[axis]) * map.spacing[axis]);
    Some([slope(0), slope(1)])
}

/// Half the distance between the first and the last of so many points, in points.
fn half_length(points: usize) -> f64 {
    (0.5 * (points.max(1) - 1) as f64).max(0.5)
}

/// Products of Legendre polynomials on the points of a map.
struct Basis {
    /// Degrees in x and y of each product.
    terms: Vec<[usize; 2]>,
    /// `values[axis][a][i]`: the polynomial of degree a at the point i.
    values: [Vec<Vec<f64>>; 2],
    columns: usize,
}

impl Basis {
    fn new(points: [usize; 2], degree: usize) -> Self {
        let terms = (0..=degree).flat_map(|n| (0..=n).map(move |b| [n - b, b])).collect();
        let values = points.map(|count| {
            let at = |i: usize| i as f64 / half_length(count) - 1.0;
            let polynomials = |i: usize| legendre(at(i), degree).map(|(_, value)| value);
            let by_point: Vec<Vec<f64>> = (0..count).map(|i| polynomials(i).collect()).collect();
            (0..=degree).map(|a| by_point.iter().map(|values| values[a]).collect()).collect()
        });
        Self { terms, values, columns: points[0] }
    }

    /// Sums of the products of each two functions over the valid points.
    fn gram(&self, heights: &[f64]) -> DMatrix<f64> {
        let [x, y] = &self.values;
        let along_x = |columns: &[usize]| -> DMatrix<f64> {
            DMatrix::from_fn(x.len(), x.len(), |a, c| {
                columns.iter().map(|&i| x[a][i] * x[c][i]).sum()
            })
        };
        let complete = along_x(&(0..self.columns).collect::<Vec<_>>());
        let mut gram = DMatrix::zeros(self.terms.len(), self.terms.len());
        for (j, row) in heights.chunks_exact(self.columns.max(1)).enumerate() {
            let columns = |missing: bool| -> Vec<usize> {
                (0..row.len()).filter(|&i| row[i].is_nan() == missing).collect()
            };
            // From the smaller of the two lists.
            let missing = columns(true);
            let row_gram = if 2 * missing.len() < row.len() {
                &complete - along_x(&missing)
            } else {
                along_x(&columns(false))
            };
            for (p, &[a, b]) in self.terms.iter().enumerate() {
                for (q, &[c, d]) in self.terms[..=p].iter().enumerate() {
                    gram[(p, q)] += row_gram[(a, c)] * y[b][j] * y[d][j];
                }
            }
        }
        gram.fill_upper_triangle_with_lower_triangle();
        gram
    }

    /// Sums of the products of each function with the valid heights.
    fn projections(&self, heights: &[f64]) -> DVector<f64> {
        let [x, y] = &self.values;
        let mut projections = DVector::zeros(self.terms.len());
        let mut present = vec![0.0; self.columns];
        for (j, row) in heights.chunks_exact(self.columns.max(1)).enumerate() {
            present.iter_mut().zip(row).for_each(|(to, &z)| *to = if z.is_nan() { 0.0 } else { z });
            let along_x: Vec<f64> = x
                .iter()
                .map(|values| values.iter().zip(&present).map(|(p, z)| p * z).sum())
                .collect();
            for (sum, &[a, b]) in projections.iter_mut().zip(&self.terms) {
                *sum += along_x[a] * y[b][j];
            }
        }
        projections
    }

    fn subtract(&self, heights: &mut [f64], coefficients: &DVector<f64>) {
        let [x, y] = &self.values;
        for (j, row) in heights.chunks_exact_mut(self.columns.max(1)).enumerate() {
            let mut along_x = vec![0.0; x.len()];
            for (coefficient, &[a, b]) in coefficients.iter().zip(&self.terms) {
                along_x[a] += coefficient * y[b][j];
            }
            for (factor, values) in along_x.iter().zip(x) {
                row.iter_mut().zip(values).for_each(|(z, value)| *z -= factor * value);
            }
        }
    }
}

/// Condition number of a symmetric matrix; infinite for one that is not positive definite.
fn condition(matrix: &DMatrix<f64>) -> f64 {
    let eigenvalues = matrix.symmetric_eigenvalues();
    eigenvalues.max() / eigenvalues.min().max(0.0)
}

/// The normal equations of a fit, scaled to a unit diagonal and factorised.
struct NormalEquations {
    scale: DVector<f64>,
    factors: nalgebra::Cholesky<f64, nalgebra::Dyn>,
}

impl NormalEquations {
    fn new(
        gram: &DMatrix<f64>,
        coefficients: usize,
        map: &HeightMap,
        degree: usize,
    ) -> Result<Self, MapFormError> {
        let valid = map.heights.len() - map.missing();
        if valid < coefficients {
            return Err(MapFormError::TooFew { valid, coefficients, degree });
        }
        let scale = gram.diagonal().map(|square| 1.0 / square.sqrt());
        let scaled =
            DMatrix::from_fn(coefficients, coefficients, |p, q| gram[(p, q)] * scale[p] * scale[q]);
        let unsolvable = |condition| MapFormError::Undetermined { degree, condition };
        if scaled.iter().any(|value| !value.is_finite()) {
            return Err(unsolvable(f64::INFINITY));
        }
        let condition = condition(&scaled);
        if condition > LARGEST_CONDITION {
            return Err(unsolvable(condition));
        }
        let factors = scaled.cholesky().ok_or(unsolvable(condition))?;
        Ok(Self { scale, factors })
    }

    fn solve(&self, right_side: &DVector<f64>) -> DVector<f64> {
        self.factors.solve(&right_side.component_mul(&self.scale)).component_mul(&self.scale)
    }
}

#[cfg(test)]
mod tests;
