//! The flow rule of a steady field along a row whose points have unequal distances.
//!
//! The internal measure of a branch follows `v τ dm_i/dξ = m - m_i` with the period of the row. From
//! one point to the next, `a = (ξ_n - ξ_{n-1}) / (v τ)` apart,
//!
//! ```text
//! y_n = e^{-a} y_{n-1} + w_0 c_{n-2} + w_1 c_{n-1} + w_2 c_n + w_3 c_{n+1}
//! ```
//!
//! where the weights integrate the cubic through four neighbouring values exactly, with a label ξ that
//! is linear in between. On equal intervals that is of fourth order for any `a`: no numerical loss where
//! the relaxation length is far below the spacing, none where it is far above. On unequal ones the change
//! of the spacing within an interval is left out, an error of the order of relaxation length times spacing.

use rustfft::num_complex::Complex64;

/// Weights of one interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Weights {
    /// `e^{-a}`.
    pub decay: f64,
    /// Weights of the values at `n-2`, `n-1`, `n` and `n+1`.
    pub of: [f64; 4],
}

impl Weights {
    /// The weights at `a > 0`, and their derivatives by it.
    pub fn with_slopes(a: f64) -> (Self, Self) {
        let m = moments(a);
        let decay = 1.0 - m[0];
        (Self { decay, of: cubic(&m) }, Self { decay: -decay, of: cubic(&slopes(a, &m)) })
    }

    /// Response to `e^{iθn}` on equal intervals.
    pub fn response(&self, angle: f64) -> Complex64 {
        let back = Complex64::cis(-angle);
        let [w0, w1, w2, w3] = self.of;
        (w0 * back * back + w1 * back + w2 + w3 * back.conj()) / (1.0 - self.decay * back)
    }
}

/// Weights of the four values from `m_j = ∫_0^1 a e^{-a(1-t)} t^j dt`: Lagrange's cubics for the abscissae -1, 0, 1, 2
/// in powers of t, which runs from point n-1 to point n.
fn cubic(m: &[f64; 4]) -> [f64; 4] {
    [
        -m[1] / 3.0 + m[2] / 2.0 - m[3] / 6.0,
        m[0] - m[1] / 2.0 - m[2] + m[3] / 2.0,
        m[1] + m[2] / 2.0 - m[3] / 2.0,
        -m[1] / 6.0 + m[3] / 6.0,
    ]
}

/// Terms of the series of `m_3` for `a <= 1`: the first one left out is below 1e-17.
const TERMS: usize = 16;

/// `∫_0^1 a e^{-a(1-t)} t^j dt` for `j = 0..4`, which satisfy `m_j = 1 - (j / a) m_{j-1}`.
fn moments(a: f64) -> [f64; 4] {
    if a > 1.0 {
        let m0 = -(-a).exp_m1();
        let m1 = 1.0 - m0 / a;
        let m2 = 1.0 - 2.0 * m1 / a;
        return [m0, m1, m2, 1.0 - 3.0 * m2 / a];
    }
    // Downwards the recursion damps its errors: m_{j-1} = (1 - m_j) a / j.
    let m3 = (4..4 + TERMS).rev().fold(0.0, |next, j| (1.0 - next) * a * RECIPROCALS[j]);
    let m2 = (1.0 - m3) * a * RECIPROCALS[3];
    let m1 = (1.0 - m2) * a * RECIPROCALS[2];
    [(1.0 - m1) * a, m1, m2, m3]
}

/// `d m_j / da` from the recursion of the moments. Above `a = 1` as `(j / a) (m_{j-1} / a - d m_{j-1} / da)`: what is
/// of the order `1 / a²` would be lost in `1 - m_j (1 + j / a)`.
fn slopes(a: f64, m: &[f64; 4]) -> [f64; 4] {
    if a > 1.0 {
        let mut slopes = [(-a).exp(), 0.0, 0.0, 0.0];
        for j in 1..4 {
            slopes[j] = j as f64 / a * (m[j - 1] / a - slopes[j - 1]);
        }
        return slopes;
    }
    [0.0, 1.0, 2.0, 3.0].map(|j| 1.0 - m[j as usize] * (1.0 + j / a))
}

const RECIPROCALS: [f64; 4 + TERMS] = {
    let mut values = [0.0; 4 + TERMS];
    let mut j = 1;
    while j < values.len() {
        values[j] = 1.0 / j as f64;
        j += 1;
    }
    values
};

/// `e^{-36}` is below the round-off of a sum of terms of order one.
const FORGOTTEN: f64 = 36.0;

/// The relaxation of one branch along a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Relaxation {
    /// `v τ` in m.
    pub length: f64,
    /// Length of the row in m.
    pub period: f64,
}

impl Relaxation {
    /// First point of a sweep whose state at the last point depends on the row alone, to round-off.
    pub fn start(&self, spacings: &[f64]) -> usize {
        let (mut travelled, far) = (0.0, FORGOTTEN * self.length);
        let start = spacings.iter().rposition(|spacing| {
            travelled += spacing;
            travelled > far
        });
        start.unwrap_or(0)
    }

    /// Divisor of the result of a sweep over one period from zero: each earlier period adds the same again, decayed.
    pub fn whole_period(&self) -> f64 {
        -(-self.period / self.length).exp_m1()
    }
}

/// The values at `n-2`, `n-1`, `n`, `n+1` of a periodic row.
#[inline]
pub(super) fn window<T: Copy>(row: &[T], n: usize) -> [T; 4] {
    let count = row.len();
    let back = |by: usize| row[if n >= by { n - by } else { n + count - by }];
    [back(2), back(1), row[n], row[if n + 1 == count { 0 } else { n + 1 }]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Largest error of the response to `1 + e^{i q ξ}` on points whose label is `x` displaced by a sine.
    fn error(points: usize, length: f64, displaced: f64) -> f64 {
        let relaxation = Relaxation { length, period: 1.0 };
        let label = |i: i64| {
            let x = i as f64 / points as f64;
            x + displaced / TAU * (TAU * x).sin()
        };
        let n = points as i64;
        let spacings: Vec<f64> = (0..n).map(|i| label(i) - label(i - 1)).collect();
        let values: Vec<f64> = (0..n).map(|i| 1.0 + (TAU * label(i)).cos()).collect();
        let weights: Vec<Weights> =
            spacings.iter().map(|d| Weights::with_slopes(d / length).0).collect();
        let step = |y: f64, i: usize| {
            let (w, c) = (&weights[i], window(&values, i));
            w.decay * y + (0..4).map(|k| w.of[k] * c[k]).sum::<f64>()
        };
        let mut y = (relaxation.start(&spacings)..points).fold(0.0, step);
        y /= relaxation.whole_period();
        let response = 1.0 / Complex64::new(1.0, TAU * length);
        (0..points)
            .map(|i| {
                y = step(y, i);
                let wave = Complex64::cis(TAU * label(i as i64));
                (y - 1.0 - (response * wave).re).abs()
            })
            .fold(0.0, f64::max)
    }

    const LENGTHS: [f64; 7] = [1e-5, 1e-3, 0.02, 0.3, 1.0, 50.0, 1e5];

    #[test]
    fn on_equal_intervals_the_response_is_of_fourth_order() {
        for length in LENGTHS {
            let errors = [32, 64, 128].map(|points| error(points, length, 0.0));
            let order = (errors[1] / errors[2]).log2();
            assert!(errors[2] < 1e-6, "{length}: {errors:?}");
            // For long relaxation lengths the error is below round-off, so no order can be observed.
            assert!(errors[2] < 1e-11 || order > 2.9, "{length}: {errors:?}, order {order}");
        }
    }

    #[test]
    fn on_unequal_intervals_the_response_converges() {
        for length in LENGTHS {
            let errors = [32, 64, 128].map(|points| error(points, length, 0.1));
            assert!(errors[2] < 2e-5, "{length}: {errors:?}");
            assert!(errors[2] < 1e-11 || errors[2] < 0.6 * errors[1], "{length}: {errors:?}");
        }
    }

    #[test]
    fn both_ways_to_the_moments_agree() {
        let (below, above) = (moments(1.0), moments(1.0 + 1e-12));
        for j in 0..4 {
            assert!((below[j] - above[j]).abs() < 1e-11, "{below:?} {above:?}");
        }
    }

    #[test]
    fn slopes_of_fast_branches_keep_their_digits() {
        // m_1 = 1 - 1/a + ..., m_2 = 1 - 2/a + 2/a² and m_3 = 1 - 3/a + 6/a² - 6/a³, the rest below 1e-40.
        for a in [1e2, 1e5, 1e10] {
            let found = slopes(a, &moments(a));
            let expected = [
                0.0,
                a.powi(-2),
                2.0 * a.powi(-2) - 4.0 * a.powi(-3),
                3.0 * a.powi(-2) - 12.0 * a.powi(-3) + 18.0 * a.powi(-4),
            ];
            for j in 0..4 {
                assert!((found[j] - expected[j]).abs() < 1e-14 * a.powi(-2), "{a}: {found:?}");
            }
        }
    }

    #[test]
    fn slopes_are_derivatives() {
        for a in [1e-6, 1e-3, 0.3, 0.999, 1.5, 7.0, 50.0] {
            let step = 1e-4 * a;
            let [after, before] = [a + step, a - step].map(|a| Weights::with_slopes(a).0);
            let slope = Weights::with_slopes(a).1;
            for k in 0..4 {
                let difference = (after.of[k] - before.of[k]) / (2.0 * step);
                assert!((slope.of[k] - difference).abs() < 1e-7, "{a}");
            }
            let difference = (after.decay - before.decay) / (2.0 * step);
            assert!((slope.decay - difference).abs() < 1e-7, "{a}");
        }
    }
}
