//! Form of a scan: waves too long to be texture.

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest order of a polynomial form; above it the fit begins to remove texture.
pub const LARGEST_ORDER: usize = 12;

/// The form to remove from a scan or a window, by least squares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// The mean height.
    Mean,
    /// The straight line.
    Slope,
    /// The polynomial of this order, at most 12.
    Polynomial(usize),
}

impl Form {
    /// Order of the polynomial: 0 for the mean, 1 for the line.
    pub fn order(self) -> usize {
        match self {
            Self::Mean => 0,
            Self::Slope => 1,
            Self::Polynomial(order) => order,
        }
    }
}

/// A form that was removed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RemovedForm {
    /// Coefficients of the Legendre polynomials `P_0, P_1, ...` in millimetres, on the centres of
    /// the first and the last point mapped to -1 and 1. The first is the mean level, twice the
    /// second the rise of the line over the track.
    pub legendre_coefficients_mm: Vec<f64>,
    /// Root mean square over the valid points of the form without its mean level, in millimetres.
    pub rms_mm: f64,
}

/// Too few valid points for a form.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{valid} valid points do not determine a form of order {order}")]
pub struct FormError {
    /// Number of valid heights.
    pub valid: usize,
    /// Order of the polynomial.
    pub order: usize,
}

/// Subtracts the least-squares form of the valid heights from equidistant `heights` (metres);
/// missing ones stay NaN and do not count.
///
/// Legendre polynomials keep the columns of the problem nearly orthogonal, so that a QR
/// factorisation solves it to round-off at any order in use.
///
/// # Errors
/// [`FormError`] when there are fewer valid heights than coefficients.
pub fn remove_form(heights: &mut [f64], form: Form) -> Result<RemovedForm, FormError> {
    let order = form.order();
    let valid: Vec<usize> = (0..heights.len()).filter(|&i| !heights[i].is_nan()).collect();
    if valid.len() <= order {
        return Err(FormError { valid: valid.len(), order });
    }
    let half_length = (0.5 * (heights.len() - 1) as f64).max(0.5);
    let mut basis = DMatrix::zeros(valid.len(), order + 1);
    for (row, &i) in valid.iter().enumerate() {
        let x = i as f64 / half_length - 1.0;
        legendre(x, order).for_each(|(column, value)| basis[(row, column)] = value);
    }
    let measured = DVector::from_iterator(valid.len(), valid.iter().map(|&i| heights[i]));
    let coefficients =
        least_squares(basis.clone(), measured).ok_or(FormError { valid: valid.len(), order })?;
    let fitted = basis * &coefficients;
    for (&i, form) in valid.iter().zip(&fitted) {
        heights[i] -= form;
    }
    let rms = (fitted.map(|z| (z - coefficients[0]).powi(2)).sum() / valid.len() as f64).sqrt();
    let legendre_coefficients_mm = coefficients.iter().map(|c| c * 1e3).collect();
    Ok(RemovedForm { legendre_coefficients_mm, rms_mm: rms * 1e3 })
}

fn least_squares(basis: DMatrix<f64>, mut right_side: DVector<f64>) -> Option<DVector<f64>> {
    let columns = basis.ncols();
    let factors = basis.qr();
    factors.q_tr_mul(&mut right_side);
    factors.r().solve_upper_triangular(&right_side.rows(0, columns).into_owned())
}

/// `(n, P_n(x))` for `n = 0, ..., order`, by `(n + 1) P_{n+1} = (2 n + 1) x P_n - n P_{n-1}`.
pub(super) fn legendre(x: f64, order: usize) -> impl Iterator<Item = (usize, f64)> {
    let mut pair = (1.0, x);
    (0..=order).map(move |n| {
        let value = pair.0;
        let k = (n + 1) as f64;
        pair = (pair.1, ((2.0 * k + 1.0) * x * pair.1 - k * pair.0) / (k + 1.0));
        (n, value)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn legendre_polynomials_are_those_of_the_tables() {
        for x in [-1.0, -0.3, 0.0, 0.7, 1.0_f64] {
            let values: Vec<f64> = legendre(x, 4).map(|(_, value)| value).collect();
            let tabulated = [
                1.0,
                x,
                (3.0 * x * x - 1.0) / 2.0,
                (5.0 * x.powi(3) - 3.0 * x) / 2.0,
                (35.0 * x.powi(4) - 30.0 * x * x + 3.0) / 8.0,
            ];
            for (value, expected) in values.iter().zip(tabulated) {
                approx::assert_abs_diff_eq!(*value, expected, epsilon = 1e-15);
            }
        }
    }

    #[test]
    fn mean_and_slope_of_a_line_are_exact() {
        let line = [1.0, 2.0, f64::NAN, 4.0, 5.0];
        let mut heights = line;
        let removed = remove_form(&mut heights, Form::Mean).unwrap();
        approx::assert_abs_diff_eq!(removed.legendre_coefficients_mm[0], 3000.0, epsilon = 1e-9);
        assert_eq!(removed.rms_mm, 0.0);
        approx::assert_abs_diff_eq!(heights[0], -2.0, epsilon = 1e-14);

        let mut heights = line;
        let removed = remove_form(&mut heights, Form::Slope).unwrap();
        approx::assert_abs_diff_eq!(removed.legendre_coefficients_mm[1], 2000.0, epsilon = 1e-9);
        approx::assert_abs_diff_eq!(removed.rms_mm, 1e3 * 2.5_f64.sqrt(), epsilon = 1e-9);
        assert!(heights[2].is_nan());
        assert!(heights.iter().filter(|z| !z.is_nan()).all(|z| z.abs() < 1e-14));
    }

    #[test]
    fn order_eight_over_a_long_scan_is_removed_to_round_off() {
        let n = 160_000;
        let polynomial = |x: f64| 3.0 - x + 2.0 * x.powi(3) - 4.0 * x.powi(5) + 5.0 * x.powi(8);
        let mut heights: Vec<f64> =
            (0..n).map(|i| polynomial(f64::from(i) / f64::from(n))).collect();
        heights[50_000..52_000].fill(f64::NAN);
        remove_form(&mut heights, Form::Polynomial(8)).unwrap();
        // The factorisation sums n terms one after the other, which errs by at most n units of
        // round-off relative to heights of order 1.
        let bound = f64::from(n) * f64::EPSILON;
        assert!(heights.iter().all(|z| z.is_nan() || z.abs() < bound));
    }

    #[test]
    fn too_few_points_are_told() {
        let error = remove_form(&mut [1.0, f64::NAN, 2.0], Form::Polynomial(2)).unwrap_err();
        assert_eq!(error, FormError { valid: 2, order: 2 });
        assert!(remove_form(&mut [], Form::Mean).is_err());
        assert!(remove_form(&mut [1.0], Form::Mean).is_ok());
    }

    #[test]
    fn forms_read_from_a_recipe() {
        #[derive(Deserialize)]
        struct Recipe {
            form: Form,
        }
        let read = |text| toml::from_str::<Recipe>(text).unwrap().form;
        assert_eq!(read("form = 'mean'"), Form::Mean);
        assert_eq!(read("form = 'slope'"), Form::Slope);
        assert_eq!(read("form = { polynomial = 3 }"), Form::Polynomial(3));
    }

    proptest! {
        /// Least squares: what is left is orthogonal to every power up to the order.
        #[test]
        fn the_remainder_is_orthogonal_to_the_form(
            mut heights in prop::collection::vec(
                prop_oneof![4 => -1.0..1.0_f64, 1 => Just(f64::NAN)], 40..100),
            order in 0..5_usize,
        ) {
            remove_form(&mut heights, Form::Polynomial(order)).unwrap();
            let n = heights.len() as f64;
            for power in 0..=order as i32 {
                let moment: f64 = heights.iter().enumerate().filter(|(_, z)| !z.is_nan())
                    .map(|(i, z)| z * (i as f64 / n).powi(power)).sum();
                // A hundred terms of order 1: round-off with a factor of 100 to spare.
                prop_assert!(moment.abs() < 1e-12, "{moment}");
            }
        }
    }
}
