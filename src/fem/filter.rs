//! The flow rule of a steady field: a periodic first-order filter along a row.

use rustfft::num_complex::Complex64;

/// Solves `v τ dm_i/dξ = m - m_i` with period `N h` for values at equidistant points:
///
/// ```text
/// m_i(ξ) = ∫_0^∞ e^{-s} m(ξ - v τ s) ds
/// ```
///
/// with the cubic through four neighbouring values in place of `m`, integrated exactly. It is of
/// fourth order for any ratio `h / (v τ)`: no numerical loss where the relaxation length is far
/// below the spacing, none where it is far above. One sweep costs `O(N)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    /// `α = h / (v τ)`.
    alpha: f64,
    /// `e^{-α}`.
    decay: f64,
    /// Weights of the values at `n-2`, `n-1`, `n` and `n+1`.
    weights: [f64; 4],
    /// Points after which the memory is below round-off.
    memory: usize,
}

/// `e^{-36}` is below the round-off of a sum of terms of order one.
const FORGOTTEN: f64 = 36.0;

impl Filter {
    /// The filter for a `spacing` h and a relaxation length `v τ`, both in m and positive.
    pub fn new(spacing: f64, relaxation_length: f64) -> Self {
        let alpha = spacing / relaxation_length;
        // m[j] = ∫_0^1 α e^{-α(1-t)} t^j dt; t runs from point n-1 to point n.
        let m = moments(alpha);
        // Lagrange's cubics for the places -1, 0, 1, 2 in powers of t.
        let weights = [
            -m[1] / 3.0 + m[2] / 2.0 - m[3] / 6.0,
            m[0] - m[1] / 2.0 - m[2] + m[3] / 2.0,
            m[1] + m[2] / 2.0 - m[3] / 2.0,
            -m[1] / 6.0 + m[3] / 6.0,
        ];
        let memory = (FORGOTTEN / alpha).ceil().min(1e9) as usize + 1;
        Self { alpha, decay: (-alpha).exp(), weights, memory }
    }

    /// Value at the point before the first one of the values, from the values of one period.
    pub fn start(&self, values: impl Fn(usize) -> f64, points: usize) -> f64 {
        let used = self.memory.min(points);
        let mut state = 0.0;
        for n in points - used..points {
            state = self.step(
                state,
                values((n + points - 2) % points),
                values((n + points - 1) % points),
                values(n),
                values((n + 1) % points),
            );
        }
        // One period adds the same again, decayed: a geometric series.
        if used < points { state } else { state / self.whole_period(points) }
    }

    /// `1 - e^{-N α}`, without cancellation.
    fn whole_period(&self, points: usize) -> f64 {
        -(-self.alpha * points as f64).exp_m1()
    }

    /// Value at point `n` from that at `n-1` and the values at `n-2`, `n-1`, `n`, `n+1`.
    #[inline]
    pub fn step(&self, state: f64, c0: f64, c1: f64, c2: f64, c3: f64) -> f64 {
        let w = &self.weights;
        self.decay * state + (w[0] * c0 + w[1] * c1 + w[2] * c2 + w[3] * c3)
    }

    /// Response to `e^{iθn}`; tends to `1 / (1 + i q v τ)` for a small `θ = q h`.
    pub fn response(&self, angle: f64) -> Complex64 {
        if angle == 0.0 {
            return Complex64::ONE;
        }
        let back = Complex64::cis(-angle);
        let [w0, w1, w2, w3] = self.weights;
        (w0 * back * back + w1 * back + w2 + w3 * back.conj()) / (1.0 - self.decay * back)
    }
}

/// `∫_0^1 α e^{-α(1-t)} t^j dt` for `j = 0..4`.
fn moments(alpha: f64) -> [f64; 4] {
    let decay = (-alpha).exp();
    let mut m = [0.0; 4];
    if alpha > 1.0 {
        // By parts: m_j = 1 - (j / α) m_{j-1}, with m_0 = 1 - e^{-α}.
        m[0] = 1.0 - decay;
        for j in 1..4 {
            m[j] = 1.0 - j as f64 / alpha * m[j - 1];
        }
        return m;
    }
    // Series of e^{α t}: m_j = α e^{-α} Σ α^k / (k! (k + j + 1)).
    let mut power = 1.0;
    for k in 0..25 {
        for (j, m) in m.iter_mut().enumerate() {
            *m += power / (k + j + 1) as f64;
        }
        power *= alpha / f64::from(k as u32 + 1);
    }
    m.map(|sum| alpha * decay * sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// The whole periodic sweep.
    fn apply(filter: &Filter, values: &[f64]) -> Vec<f64> {
        let n = values.len();
        let mut state = filter.start(|i| values[i], n);
        (0..n)
            .map(|i| {
                let at = |k: usize| values[(i + n + k - 2) % n];
                state = filter.step(state, at(0), at(1), at(2), at(3));
                state
            })
            .collect()
    }

    /// Largest error of the response to a cosine with `points` points per wave.
    fn error(points: usize, relaxation_length_in_waves: f64) -> f64 {
        let filter = Filter::new(1.0 / points as f64, relaxation_length_in_waves);
        let angle = |i: usize| TAU * i as f64 / points as f64;
        let values: Vec<f64> = (0..points).map(|i| angle(i).cos()).collect();
        let response = 1.0 / Complex64::new(1.0, TAU * relaxation_length_in_waves);
        apply(&filter, &values)
            .iter()
            .enumerate()
            .map(|(i, c)| (c - (response * Complex64::cis(angle(i))).re).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn the_response_is_that_of_a_relaxation_and_of_fourth_order() {
        for length in [1e-5, 1e-3, 0.02, 0.3, 1.0, 50.0, 1e5] {
            let errors = [error(32, length), error(64, length), error(128, length)];
            let order = (errors[1] / errors[2]).log2();
            assert!(errors[2] < 1e-6, "{length}: {errors:?}");
            // Long memories err by less than round-off lets an order be seen.
            assert!(errors[2] < 1e-13 || order > 2.9, "{length}: {errors:?}, order {order}");
        }
    }

    #[test]
    fn a_constant_passes_unchanged() {
        for length in [1e-6, 0.1, 1e6] {
            let filter = Filter::new(0.01, length);
            for c in apply(&filter, &[2.5; 100]) {
                assert!((c - 2.5).abs() < 1e-9, "{length}: {c}");
            }
        }
    }

    #[test]
    fn both_ways_to_the_moments_agree() {
        let (below, above) = (moments(1.0), moments(1.0 + 1e-12));
        for j in 0..4 {
            assert!((below[j] - above[j]).abs() < 1e-11, "{below:?} {above:?}");
        }
    }
}
