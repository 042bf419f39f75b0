//! Power spectral density of line scans, complete or with gaps.
//!
//! One-sided, over angular wavenumbers `q >= 0` in rad/m, in m³:
//!
//! ```text
//! sum over k of C1D(q_k) dq = mean of z^2,    q_k = k dq,  dq = 2 π / (N spacing),  k = 0 ... N/2
//! ```
//!
//! to round-off without a window, and with one for the weighted heights (see [`Window`]). Half of it is the two-sided
//! density of Persson's formulae. The heights are taken about the mean line: what is left of a mean is at `q = 0`.
//!
//! | module | what it holds |
//! |---|---|
//! | `window` | windows on the heights of a complete scan |
//! | `bins` | means over bins of equal width in the logarithm of the wavenumber |
//! | `hurst` | Hurst exponent from the slope |
//! | `isotropic` | the spectrum of an isotropic surface from that of a line across it |
//! | `tabulated` | the spectrum of an isotropic surface as a table, with its roughness |
//! | `agreement` | comparison with the height-difference correlation |

mod agreement;
mod bins;
mod hurst;
mod isotropic;
mod tabulated;
mod window;

pub use agreement::{Agreement, LENGTHS_PER_LAG, agreement};
pub use bins::SpectrumBin;
pub use hurst::{HurstError, SpectralHurst, fit_hurst_exponent};
pub use isotropic::{IsotropicError, abel_inverse, self_affine_isotropic};
pub use tabulated::IsotropicSpectrum;
pub use window::Window;

use super::{HeightDifferenceCorrelation, LineScan};
use crate::error_kind::{ErrorKind, HasKind};
use rayon::prelude::*;
use realfft::{RealFftPlanner, RealToComplex};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;
use thiserror::Error;

/// Lags of the Blackman-Tukey route for a share of the points of a scan, one in so many. The usual
/// compromise: longer lags have too few independent pairs, shorter ones blur long waves.
const POINTS_PER_LAG: usize = 10;

/// How a spectrum was obtained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Route {
    /// Squared Fourier transform of a scan without gaps.
    Periodogram(Window),
    /// Blackman and Tukey: cosine transform of the autocovariance of valid pairs, lags weighted by
    /// Parzen's window. It smooths over about `4 π` over the largest lag, and a density may come
    /// out negative where gaps leave the autocovariance not positive definite; it is left so.
    BlackmanTukey {
        /// The largest lag as a number of spacings.
        maximum_lag: usize,
    },
}

impl Route {
    /// Share of the autocovariance at a lag that the spectrum keeps; the lag as a share of the scan
    /// and as a number of spacings.
    fn kept_autocovariance(self, share: f64, spacings: f64) -> f64 {
        match self {
            Self::Periodogram(window) => window.autocorrelation(share),
            Self::BlackmanTukey { maximum_lag } => parzen((spacings / maximum_lag as f64).min(1.0)),
        }
    }
}

/// One-sided power spectral density, see the [module](self) for its normalisation.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerSpectrum {
    /// Distance dq between wavenumbers in rad/m.
    pub wavenumber_step: f64,
    /// Density in m³ at the wavenumbers `0, dq, 2 dq, ...`, N/2 + 1 of them.
    pub density: Vec<f64>,
    /// The route taken, one entry for each scan behind the spectrum.
    pub routes: Vec<Route>,
}

/// A spectrum that cannot be computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SpectrumError {
    /// A periodogram of a scan with gaps.
    #[error("scan {scan}: {missing} heights are missing; use the Blackman-Tukey route")]
    Gaps {
        /// Name of the scan.
        scan: String,
        /// Number of missing heights.
        missing: usize,
    },
    /// Other number of points than planned.
    #[error("a spectrum of {points} points was asked of a plan for {planned}; make a new plan")]
    OtherLength {
        /// Number of points of the scan.
        points: usize,
        /// Number of points of the plan.
        planned: usize,
    },
    /// The autocovariance reaches beyond half the period of the wavenumber grid.
    #[error("lags up to {maximum_lag} need at least {} points, not {points}", 2 * .maximum_lag)]
    LagTooLong {
        /// Largest lag as a number of spacings.
        maximum_lag: usize,
        /// Number of points of the plan.
        points: usize,
    },
    /// The autocovariance has a hole.
    #[error("no valid points are {lag} spacings apart; shorten the largest lag below it")]
    NoPairs {
        /// The first lag without pairs.
        lag: usize,
    },
    /// Spectra on different wavenumbers.
    #[error(
        "spectra with {first} and {other} wavenumbers, or different steps, cannot be averaged; cut scans to equal length"
    )]
    UnequalGrids {
        /// Number of wavenumbers of the first spectrum.
        first: usize,
        /// Number of wavenumbers of the one that differs.
        other: usize,
    },
    /// As many correlations as scans are needed.
    #[error("{scans} scans but {correlations} correlations; give one for each")]
    CountMismatch {
        /// Number of scans.
        scans: usize,
        /// Number of correlations.
        correlations: usize,
    },
    /// No points or no spectra.
    #[error("no heights or no spectra; give at least one scan of two points")]
    Empty,
}

impl HasKind for SpectrumError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::LagTooLong { .. } | Self::UnequalGrids { .. } | Self::Empty => ErrorKind::Input,
            Self::Gaps { .. }
            | Self::OtherLength { .. }
            | Self::NoPairs { .. }
            | Self::CountMismatch { .. } => ErrorKind::Failure,
        }
    }
}

/// FFT plan for spectra of scans of one number of points.
pub struct SpectrumPlan {
    points: usize,
    forward: Arc<dyn RealToComplex<f64>>,
}

impl SpectrumPlan {
    /// Plan for scans of `points` points, any number above one.
    ///
    /// # Errors
    /// Fewer than two points.
    pub fn new(points: usize) -> Result<Self, SpectrumError> {
        if points < 2 {
            return Err(SpectrumError::Empty);
        }
        Ok(Self { points, forward: RealFftPlanner::new().plan_fft_forward(points) })
    }

    /// Periodogram of a scan without gaps: `C1D(q_k) = 2 |sum_i w_i z_i exp(-i q_k x_i)|^2 /
    /// (N^2 mean(w^2) dq)`, half of it at `q = 0` and at the Nyquist wavenumber.
    ///
    /// # Errors
    /// Gaps, or another number of points than planned.
    pub fn periodogram(
        &self,
        scan: &LineScan,
        window: Window,
    ) -> Result<PowerSpectrum, SpectrumError> {
        let (points, planned) = (scan.heights.len(), self.points);
        if points != planned {
            return Err(SpectrumError::OtherLength { points, planned });
        }
        let missing = scan.heights.iter().filter(|z| z.is_nan()).count();
        if missing > 0 {
            return Err(SpectrumError::Gaps { scan: scan.name.clone(), missing });
        }
        let mut input = scan.heights.clone();
        let mean_square = window.apply(&mut input);
        let step = TAU / scan.length();
        let mut output = self.forward.make_output_vec();
        self.forward.process(&mut input, &mut output).expect("buffers come from the plan");
        let scale = 1.0 / ((points as f64).powi(2) * mean_square * step);
        let density = output.iter().enumerate();
        let density = density.map(|(k, z)| self.sides(k) * scale * z.norm_sqr()).collect();
        let routes = vec![Route::Periodogram(window)];
        Ok(PowerSpectrum { wavenumber_step: step, density, routes })
    }

    /// Spectrum from the autocovariance `R(s) = variance - C(s) / 2` of valid pairs,
    /// on the wavenumbers of the plan:
    /// `C1D(q) = (spacing / π) (R_0 + 2 sum_k w_k R_k cos(q k spacing))`, half of it at `q = 0`
    /// and at the Nyquist wavenumber, with Parzen's window `w` up to `maximum_lag` spacings (cut to
    /// that of the correlation). Its sum times dq is the variance.
    ///
    /// # Errors
    /// A largest lag of zero or beyond half the points, or a lag without pairs.
    pub fn blackman_tukey(
        &self,
        correlation: &HeightDifferenceCorrelation,
        maximum_lag: usize,
    ) -> Result<PowerSpectrum, SpectrumError> {
        let (points, maximum_lag) = (self.points, maximum_lag.min(correlation.maximum_lag()));
        if maximum_lag == 0 {
            return Err(SpectrumError::Empty);
        }
        if 2 * maximum_lag > points {
            return Err(SpectrumError::LagTooLong { maximum_lag, points });
        }
        if let Some(lag) = correlation.pairs[..=maximum_lag].iter().position(|&pairs| pairs == 0) {
            return Err(SpectrumError::NoPairs { lag });
        }
        let mut even = self.forward.make_input_vec();
        for (lag, value) in correlation.values[..=maximum_lag].iter().enumerate() {
            let weight = parzen(lag as f64 / maximum_lag as f64);
            let covariance = weight * (correlation.variance - value / 2.0);
            even[lag] = covariance;
            even[(points - lag) % points] = covariance;
        }
        let mut output = self.forward.make_output_vec();
        self.forward.process(&mut even, &mut output).expect("buffers come from the plan");
        let scale = correlation.spacing / TAU;
        let density = output.iter().enumerate();
        let density = density.map(|(k, r)| self.sides(k) * scale * r.re).collect();
        let wavenumber_step = TAU / (points as f64 * correlation.spacing);
        let routes = vec![Route::BlackmanTukey { maximum_lag }];
        Ok(PowerSpectrum { wavenumber_step, density, routes })
    }

    /// Number of wavenumbers of the two-sided spectrum for one of the one-sided spectrum.
    fn sides(&self, k: usize) -> f64 {
        if k == 0 || 2 * k == self.points { 1.0 } else { 2.0 }
    }
}

impl PowerSpectrum {
    /// Wavenumber in rad/m of entry `k`.
    pub fn wavenumber(&self, k: usize) -> f64 {
        k as f64 * self.wavenumber_step
    }

    /// The first of some spectra, if all are on its wavenumbers.
    fn check_equal_grids(spectra: &[Self]) -> Result<&Self, SpectrumError> {
        let first = spectra.first().ok_or(SpectrumError::Empty)?;
        let (count, step) = (first.density.len(), first.wavenumber_step);
        let differs =
            |s: &&Self| s.density.len() != count || (s.wavenumber_step - step).abs() > 1e-9 * step;
        if let Some(other) = spectra.iter().find(differs) {
            return Err(SpectrumError::UnequalGrids { first: count, other: other.density.len() });
        }
        Ok(first)
    }

    /// Mean over scans, entry by entry.
    ///
    /// # Errors
    /// No spectra, or different wavenumbers.
    pub fn average(spectra: &[Self]) -> Result<Self, SpectrumError> {
        let first = Self::check_equal_grids(spectra)?;
        let (count, step) = (first.density.len(), first.wavenumber_step);
        let mean = |k: usize| spectra.iter().map(|s| s.density[k]).sum::<f64>();
        let density = (0..count).map(|k| mean(k) / spectra.len() as f64).collect();
        let routes = spectra.iter().flat_map(|s| s.routes.iter().copied()).collect();
        Ok(Self { wavenumber_step: step, density, routes })
    }
}

/// Spectra of scans, in parallel, in their order: the periodogram of a complete scan, the
/// Blackman-Tukey spectrum of one with gaps, from lags up to a tenth of the scan. Both are on the same wavenumbers, and
/// [`PowerSpectrum::routes`] says which it was.
///
/// `correlations` are those of the scans.
///
/// # Errors
/// The first scan that fails, see [`SpectrumPlan`].
pub fn power_spectra(
    scans: &[LineScan],
    correlations: &[HeightDifferenceCorrelation],
    window: Window,
) -> Result<Vec<PowerSpectrum>, SpectrumError> {
    let (count, given) = (scans.len(), correlations.len());
    if count != given {
        return Err(SpectrumError::CountMismatch { scans: count, correlations: given });
    }
    let mut plans = BTreeMap::new();
    for points in scans.iter().map(|scan| scan.heights.len()) {
        plans.entry(points).or_insert(SpectrumPlan::new(points)?);
    }
    let spectrum = |(scan, correlation): (&LineScan, &HeightDifferenceCorrelation)| {
        let plan = &plans[&scan.heights.len()];
        match scan.heights.iter().any(|z| z.is_nan()) {
            true => plan.blackman_tukey(correlation, scan.heights.len() / POINTS_PER_LAG),
            false => plan.periodogram(scan, window),
        }
    };
    scans.par_iter().zip(correlations).map(spectrum).collect()
}

/// Parzen's lag window at `0 <= u <= 1`; its spectral window is nowhere negative.
fn parzen(u: f64) -> f64 {
    if u <= 0.5 { 1.0 - 6.0 * u * u * (1.0 - u) } else { 2.0 * (1.0 - u).powi(3) }
}

#[cfg(test)]
mod tests;
