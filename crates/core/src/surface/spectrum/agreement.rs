//! Whether a spectrum and a height-difference correlation tell the same (Wiener and Khinchin):
//!
//! ```text
//! C(s) = 2 (R(0) - R(s)),    R(s) = integral over q of C1D(q) cos(q s)
//! ```
//!
//! A spectrum of a finite scan holds `R(s) r(s)`, with the autocorrelation r of its window, which is
//! divided out. The remaining difference has legitimate causes: the window weighs the middle of
//! a scan more than its ends, so that the two see different mean squares, the less so the more scans
//! are averaged; the correlation leaves out the wrap-around that a transform makes; pairs beside
//! gaps, and a trend, count differently, by about the lag over the length of a scan. Therefore the
//! lags compared end at a twentieth of a scan.

use super::PowerSpectrum;
use crate::surface::HeightDifferenceCorrelation;
use crate::surface::correlation::log_spaced_lags;

/// The longest lag compared is the length of a scan over this.
pub const LENGTHS_PER_LAG: usize = 20;

/// The correlation by either route at one lag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Lag s in metres.
    pub lag: f64,
    /// C(s) in m², from pairs.
    pub correlation: f64,
    /// C(s) in m², from the spectrum.
    pub from_spectrum: f64,
}

impl Agreement {
    /// `from_spectrum / correlation - 1`.
    pub fn relative_difference(&self) -> f64 {
        self.from_spectrum / self.correlation - 1.0
    }
}

/// Both at lags from `shortest_lag` (metres) to a twentieth of a scan, `per_decade` a decade. Lags
/// without pairs or power are left out.
pub fn agreement(
    spectrum: &PowerSpectrum,
    correlation: &HeightDifferenceCorrelation,
    shortest_lag: f64,
    per_decade: usize,
) -> Vec<Agreement> {
    let points = (std::f64::consts::TAU / (spectrum.wavenumber_step * correlation.spacing)).round();
    let longest = (points as usize / LENGTHS_PER_LAG).min(correlation.maximum_lag());
    let power = spectrum.autocovariance(0.0);
    let samples = correlation.sample(&log_spaced_lags(longest, per_decade));
    let compared = samples
        .iter()
        .filter(|sample| sample.lag >= shortest_lag * (1.0 - 1e-9) && sample.value > 0.0);
    compared
        .map(|sample| {
            let kept = spectrum.kept_autocovariance(sample.lag, correlation.spacing);
            let covariance = spectrum.autocovariance(sample.lag) / kept;
            let from_spectrum = 2.0 * (power - covariance);
            Agreement { lag: sample.lag, correlation: sample.value, from_spectrum }
        })
        .collect()
}

impl PowerSpectrum {
    /// Autocovariance in m² at a lag in metres, from the spectrum: the sum over
    /// wavenumbers of `C1D cos(q s) dq`.
    pub fn autocovariance(&self, lag: f64) -> f64 {
        // A rotation from one wavenumber to the next instead of a cosine for each; its round-off
        // grows like that of a sum.
        let (sin, cos) = (self.wavenumber_step * lag).sin_cos();
        let (mut x, mut y, mut sum) = (1.0, 0.0, 0.0);
        for density in &self.density {
            sum += density * x;
            (x, y) = (x * cos - y * sin, x * sin + y * cos);
        }
        sum * self.wavenumber_step
    }

    /// Share of the autocovariance at a lag that is in the spectrum, averaged over its scans.
    fn kept_autocovariance(&self, lag: f64, spacing: f64) -> f64 {
        let share = lag * self.wavenumber_step / std::f64::consts::TAU;
        let kept = self.routes.iter().map(|route| route.kept_autocovariance(share, lag / spacing));
        kept.sum::<f64>() / self.routes.len() as f64
    }
}
