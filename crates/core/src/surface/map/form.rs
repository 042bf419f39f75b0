//! Form of a map: a polynomial surface by least squares.

use super::HeightMap;
use crate::error_kind::{ErrorKind, HasKind};
use crate::surface::form::legendre;
use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest total degree of a polynomial form; above it the fit begins to remove texture.
pub const LARGEST_DEGREE: usize = 8;

/// Largest condition number of the normal equations, scaled to a unit diagonal. A complete map has one below 10 at any
/// degree in use; missing points at a border raise it.
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
/// The normal equations are accumulated row by row, so that the work is about `2 (degree + 1)` multiplications per point
/// and no matrix has a row per point. Products of Legendre polynomials keep the equations close to diagonal, and what
/// their solution leaves is fitted once more. An exact polynomial surface leaves less than 1e-13 of its largest height,
/// unless so many points are missing at a border that the condition number exceeds 1e6.
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

/// Slopes `[dz/dx, dz/dy]` of the least-squares plane of the valid heights; none where they lie on one line.
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
            let mut values = vec![vec![0.0; count]; degree + 1];
            for i in 0..count {
                let x = i as f64 / half_length(count) - 1.0;
                legendre(x, degree).for_each(|(a, value)| values[a][i] = value);
            }
            values
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
        let eigenvalues = scaled.symmetric_eigenvalues();
        let condition = eigenvalues.max() / eigenvalues.min().max(0.0);
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
mod tests {
    use super::*;

    /// Every monomial up to a degree with a coefficient of its own, in units of the half lengths; some 7 % of the points
    /// are missing.
    fn polynomial(points: [usize; 2], degree: i32, unit: f64) -> HeightMap {
        let mut heights = Vec::new();
        for (j, i) in (0..points[1]).flat_map(|j| (0..points[0]).map(move |i| (j, i))) {
            let [x, y] = [(i, points[0]), (j, points[1])]
                .map(|(k, count)| k as f64 / half_length(count) - 1.0);
            let mut z = 0.0;
            for (n, b) in (0..=degree).flat_map(|n| (0..=n).map(move |b| (n, b))) {
                z += (1.0 + f64::from(n) - 0.3 * f64::from(b)) * x.powi(n - b) * y.powi(b);
            }
            heights.push(if (7 * i + 11 * j * j) % 14 == 3 { f64::NAN } else { unit * z });
        }
        HeightMap { name: "map".into(), points, spacing: [2e-5, 5e-5], heights }
    }

    fn largest(map: &HeightMap) -> f64 {
        map.heights.iter().fold(0.0, |most, z| most.max(z.abs()))
    }

    #[test]
    fn a_polynomial_surface_with_missing_points_leaves_nothing() {
        for degree in 0..=LARGEST_DEGREE {
            let mut map = polynomial([90, 61], degree as i32, 1.0);
            map.heights[..90 * 4].fill(f64::NAN);
            let (before, missing) = (largest(&map), map.missing());
            remove_form(&mut map, FormOfMap::Polynomial(degree)).unwrap();
            assert!(largest(&map) < 1e-13 * before, "{degree}: {} of {before}", largest(&map));
            assert_eq!(map.missing(), missing);
        }
    }

    #[test]
    fn a_tilted_plane_has_its_slopes_level_and_rms() {
        let (points, spacing) = ([40, 25], [2e-5, 5e-5]);
        let mut heights = Vec::new();
        for (j, i) in (0..25).flat_map(|j| (0..40).map(move |i| (j, i))) {
            heights.push(3e-3 + 0.2 * f64::from(i) * 2e-5 - 0.1 * f64::from(j) * 5e-5);
        }
        let mut map = HeightMap { name: "map".into(), points, spacing, heights };
        for form in [FormOfMap::Mean, FormOfMap::Plane] {
            let removed = remove_form(&mut map.clone(), form).unwrap();
            let tilt = removed.tilt.unwrap();
            approx::assert_relative_eq!(tilt[0], 0.2, max_relative = 1e-12);
            approx::assert_relative_eq!(tilt[1], -0.1, max_relative = 1e-12);
        }
        let removed = remove_form(&mut map, FormOfMap::Plane).unwrap();
        // The middle of the map: half the rise along either axis above the corner.
        let level = 3.0 + 0.2 * 19.5 * 0.02 - 0.1 * 12.0 * 0.05;
        approx::assert_relative_eq!(
            removed.legendre_coefficients_mm[0],
            level,
            max_relative = 1e-13
        );
        // The variance of n equidistant points is (n^2 - 1) / 12 steps squared.
        let variance = |slope_step: f64, n: f64| slope_step.powi(2) * (n * n - 1.0) / 12.0;
        let rms = (variance(0.2 * 0.02, 40.0) + variance(0.1 * 0.05, 25.0)).sqrt();
        approx::assert_relative_eq!(removed.rms_mm, rms, max_relative = 1e-12);
    }

    #[test]
    fn the_result_is_independent_of_units() {
        let waves = |unit: f64| {
            let mut map = polynomial([50, 70], 3, unit);
            map.heights.iter_mut().enumerate().for_each(|(k, z)| *z += unit * (k as f64).sin());
            let removed = remove_form(&mut map, FormOfMap::Polynomial(2)).unwrap();
            (map, removed)
        };
        let ((metres, in_m), (nanometres, in_nm)) = (waves(1e-3), waves(1e6));
        let largest = largest(&metres);
        for (a, b) in metres.heights.iter().zip(&nanometres.heights).filter(|(a, _)| !a.is_nan()) {
            assert!((a - b * 1e-9).abs() < 1e-12 * largest);
        }
        approx::assert_relative_eq!(in_m.rms_mm, in_nm.rms_mm * 1e-9, max_relative = 1e-12);
    }

    /// Least squares: what is left is orthogonal to every monomial up to the degree.
    #[test]
    fn the_remainder_is_orthogonal_to_the_form() {
        let mut map = polynomial([50, 70], 6, 1.0);
        remove_form(&mut map, FormOfMap::Polynomial(4)).unwrap();
        for (n, b) in (0..=4).flat_map(|n| (0..=n).map(move |b| (n, b))) {
            let monomial = |k: usize| (k % 50) as f64 / 50.0;
            let moment: f64 = (0..map.heights.len())
                .filter(|&k| !map.heights[k].is_nan())
                .map(|k| {
                    map.heights[k] * monomial(k).powi(n - b) * ((k / 50) as f64 / 70.0).powi(b)
                })
                .sum();
            // 3500 terms of order 1 to 10.
            assert!(moment.abs() < 1e-10, "{n} {b}: {moment}");
        }
    }

    #[test]
    fn points_that_do_not_determine_the_form_are_told() {
        let mut few = polynomial([3, 1], 1, 1.0);
        let error = remove_form(&mut few, FormOfMap::Polynomial(2)).unwrap_err();
        assert!(
            matches!(error, MapFormError::TooFew { coefficients: 6, degree: 2, .. }),
            "{error}"
        );
        // One row determines no slope across it.
        let mut row = polynomial([300, 1], 1, 1.0);
        let error = remove_form(&mut row, FormOfMap::Plane).unwrap_err();
        assert!(matches!(error, MapFormError::Undetermined { degree: 1, .. }), "{error}");
        assert_eq!(remove_form(&mut row, FormOfMap::Mean).unwrap().tilt, None);
        let mut corner = polynomial([100, 100], 8, 1.0);
        (0..10_000).filter(|k| k % 100 > 9).for_each(|k| corner.heights[k] = f64::NAN);
        assert!(remove_form(&mut corner, FormOfMap::Polynomial(8)).is_err());
    }
}
