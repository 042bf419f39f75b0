//! Windows on the heights of a complete scan.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Window on the heights of a complete scan, `u = (i + 1/2) / N` or `i / N` along it.
///
/// The power is divided by the mean square of the window, so that Parseval's theorem holds to
/// round-off for the weighted heights: `sum of C1D dq = mean((w z)^2) / mean(w^2)`. Without a window
/// that is the mean square height itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Window {
    /// None: the power is the mean square height, but the step between the ends of the scan leaks
    /// like `1/q^2`.
    None,
    /// `w = (1 - cos(2 π i / N)) / 2`; leaks like `1/q^6`.
    #[default]
    Hann,
    /// `w = 1 - (2 u - 1)^2`, `u = (i + 1/2) / N`; leaks like `1/q^4`, and loses less of the scan
    /// than Hann's.
    Welch,
}

impl Window {
    /// Name in recipes and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Hann => "hann",
            Self::Welch => "welch",
        }
    }

    /// Its weights at so many points.
    pub(in crate::surface) fn weights(self, points: usize) -> Vec<f64> {
        let count = points as f64;
        let weight = |i: usize| match self {
            Self::None => 1.0,
            // (1 - cos 2a) / 2 = sin^2 a
            Self::Hann => (PI * i as f64 / count).sin().powi(2),
            Self::Welch => 1.0 - (2.0 * (i as f64 + 0.5) / count - 1.0).powi(2),
        };
        (0..points).map(weight).collect()
    }

    /// Multiplies heights by the window and returns its mean square.
    pub(super) fn apply(self, heights: &mut [f64]) -> f64 {
        if self == Self::None {
            return 1.0;
        }
        let points = heights.len();
        let mut squares = 0.0;
        for (height, weight) in heights.iter_mut().zip(self.weights(points)) {
            *height *= weight;
            squares += weight * weight;
        }
        squares / points as f64
    }

    /// By how much the window raises the variance of a mean over many neighbouring wavenumbers,
    /// since it makes neighbours depend on each other: `mean(w^4) / mean(w^2)^2`.
    pub fn variance_inflation(self) -> f64 {
        match self {
            Self::None => 1.0,
            Self::Hann => 35.0 / 18.0,
            Self::Welch => 10.0 / 7.0,
        }
    }

    /// Share of the autocovariance at a lag that the spectrum keeps, for a lag of `share` times the
    /// length of the scan: `sum of w_i w_(i+k) / sum of w_i^2` of a fine grid.
    pub fn autocorrelation(self, share: f64) -> f64 {
        let t = share.clamp(0.0, 1.0);
        match self {
            Self::None => 1.0 - t,
            Self::Hann => {
                let (sin, cos) = (TAU * t).sin_cos();
                ((1.0 - t) * (2.0 + cos) + 1.5 * sin / PI) / 3.0
            }
            Self::Welch => (1.0 - t).powi(3) * (1.0 + 3.0 * t + t * t),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const WINDOWS: [Window; 3] = [Window::None, Window::Hann, Window::Welch];

    #[test]
    fn the_closed_forms_are_the_sums_over_a_fine_grid() {
        let points = 20_000;
        for window in WINDOWS {
            let mut weights = vec![1.0; points];
            let mean_square = window.apply(&mut weights);
            let fourth = weights.iter().map(|w| w.powi(4)).sum::<f64>() / points as f64;
            let inflation = fourth / mean_square.powi(2);
            // The sums are midpoint or trapezoidal rules: an error of the order 1/N^2.
            assert_relative_eq!(window.variance_inflation(), inflation, max_relative = 1e-7);
            for lag in [0, 7, 1_000, 9_000, 19_000] {
                let sum: f64 = weights.iter().zip(&weights[lag..]).map(|(a, b)| a * b).sum();
                let expected = sum / (mean_square * points as f64);
                let found = window.autocorrelation(lag as f64 / points as f64);
                assert_relative_eq!(found, expected, epsilon = 1e-7);
            }
        }
    }
}
