//! From a Gaussian field to heights with skewness: the shifted lognormal translation process.
//!
//! A translation process (Grigoriu 1984, doi:10.1061/(ASCE)0733-9399(1984)110:4(610)) applies one
//! monotone function to every point of a Gaussian field. For the shifted lognormal
//!
//! ```text
//! z/Rq = ± (exp(a Y - a²/2) - 1) / t,   t² = exp(a²) - 1
//! ```
//!
//! mean 0 and variance 1 hold exactly, the skewness is `± (t³ + 3 t)`, and the autocorrelations R of
//! z and ρ of Y are related in closed form (Matalas 1967, doi:10.1029/WR003i004p00937; the Hermite
//! series of the exponential sums to it):
//!
//! ```text
//! R = (exp(a² ρ) - 1) / t²,   ρ = ln(1 + t² R) / ln(1 + t²)
//! ```
//!
//! The lower sign bounds the heights by `z < Rq/t`: flattened tops above few deep valleys, negative
//! skewness, as on rolled asphalt.

/// Second to fourth cumulant of heights of mean zero; those of independent heights add.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cumulants {
    /// Variance in m².
    pub(super) second: f64,
    /// Third central moment in m³.
    pub(super) third: f64,
    /// Fourth central moment less three squares of the variance, in m⁴.
    pub(super) fourth: f64,
}

/// The map from a standard Gaussian field to heights of unit variance and given skewness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Translation {
    /// +1 or -1, the sign of the skewness.
    sign: f64,
    /// Coefficient of variation t of the lognormal law; 0 for the identity.
    variation: f64,
}

impl Translation {
    /// The map that gives `skewness`; 0 gives the identity.
    ///
    /// `t³ + 3 t = γ` has the single real root `t = 2 sinh(asinh(γ/2)/3)`.
    pub(super) fn with_skewness(skewness: f64) -> Self {
        let variation = 2.0 * ((skewness.abs() / 2.0).asinh() / 3.0).sinh();
        Self { sign: 1_f64.copysign(skewness), variation }
    }

    /// Autocorrelation of the Gaussian field under heights of autocorrelation `heights`.
    pub(super) fn gaussian_autocorrelation(&self, heights: f64) -> f64 {
        let square = self.variation * self.variation;
        if square == 0.0 { heights } else { (square * heights).ln_1p() / square.ln_1p() }
    }

    /// Cumulants of heights of the given rms height in metres.
    ///
    /// With `w = 1 + t²` the excess kurtosis of the lognormal law is `w⁴ + 2 w³ + 3 w² - 6`.
    pub(super) fn cumulants(&self, rms_height: f64) -> Cumulants {
        let t = self.variation;
        let w = 1.0 + t * t;
        Cumulants {
            second: rms_height.powi(2),
            third: self.sign * (t.powi(3) + 3.0 * t) * rms_height.powi(3),
            fourth: (w.powi(4) + 2.0 * w.powi(3) + 3.0 * w * w - 6.0) * rms_height.powi(4),
        }
    }

    /// Height, in units of Rq, of a standard Gaussian value.
    pub(super) fn height(&self, gaussian: f64) -> f64 {
        let log_variance = (self.variation * self.variation).ln_1p();
        if log_variance == 0.0 {
            return gaussian;
        }
        let exponent = log_variance.sqrt() * gaussian * self.sign - log_variance / 2.0;
        self.sign * exponent.exp_m1() / self.variation
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Expectation of `f(Y)` by the trapezoidal rule, which converges geometrically here: the error
    /// of step 0.1 on ±14 is below 1e-13 for the exponentials of these tests.
    fn expectation(f: impl Fn(f64) -> f64) -> f64 {
        let step = 0.1;
        let density = |y: f64| (-0.5 * y * y).exp() / (2.0 * PI).sqrt();
        (-140..=140).map(|i| f64::from(i) * step).map(|y| f(y) * density(y) * step).sum()
    }

    #[test]
    fn moments_are_the_prescribed_ones() {
        for skewness in [-2.0, -1.0, -1e-3, 0.0, 0.7] {
            let map = Translation::with_skewness(skewness);
            // 1e-11: the exponentials lose a few digits where a is small.
            assert!(expectation(|y| map.height(y)).abs() < 1e-11);
            assert!((expectation(|y| map.height(y).powi(2)) - 1.0).abs() < 1e-11);
            assert!((expectation(|y| map.height(y).powi(3)) - skewness).abs() < 1e-11);
            let cumulants = map.cumulants(1.0);
            assert!((cumulants.third - skewness).abs() < 1e-11);
            let excess = expectation(|y| map.height(y).powi(4)) - 3.0;
            // The excess of skewness -2 is 7.6.
            assert!((cumulants.fourth - excess).abs() < 1e-10, "{skewness}: {excess}");
        }
    }

    #[test]
    fn heights_have_the_autocorrelation_asked_for() {
        for (skewness, given) in [(-1.0, 0.3), (-1.5, 0.95), (0.5, -0.2), (0.0, 0.6)] {
            let map = Translation::with_skewness(skewness);
            let rho = map.gaussian_autocorrelation(given);
            let rest = (1.0 - rho * rho).sqrt();
            let found =
                expectation(|u| map.height(u) * expectation(|v| map.height(rho * u + rest * v)));
            assert!((found - given).abs() < 1e-11, "skewness {skewness}: {found} for {given}");
        }
    }

    #[test]
    fn the_map_grows_and_flattens_the_tops() {
        let map = Translation::with_skewness(-1.0);
        let heights: Vec<f64> = (-40..=40).map(|i| map.height(f64::from(i) * 0.1)).collect();
        assert!(heights.windows(2).all(|pair| pair[1] > pair[0]));
        assert!(heights[80] < -heights[0] / 2.0);
    }
}
