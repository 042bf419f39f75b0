//! Hurst exponent from the slope of a spectrum: `C1D ~ q^(-1 - 2 H)`.

use super::bins::{SpectrumBin, unbiased_log};
use super::{PowerSpectrum, SpectrumError};
use crate::numerics::statistics::jackknife_95;
use crate::surface::self_affine::{ConfidenceInterval, line};
use std::f64::consts::{LN_10, TAU};
use thiserror::Error;

/// Fewest bins of a fit: two would meet any slope exactly.
const FEWEST_BINS: usize = 3;

/// Hurst exponent of the average spectrum of some scans.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralHurst {
    /// H. No bound is put on it: outside 0 to 1 the spectrum is not that of a self-affine line, or
    /// the window leaks.
    pub hurst_exponent: f64,
    /// Its 95 % interval: a jackknife that leaves out one scan at a time; `None` for fewer than
    /// three scans.
    pub hurst_exponent_95: Option<ConfidenceInterval>,
    /// Root mean square of the residuals in `log10 C1D`.
    pub rms_residual: f64,
    /// Wavelength in metres of the last bin taken.
    pub shortest_wavelength: f64,
    /// Wavelength in metres of the first bin taken.
    pub longest_wavelength: f64,
    /// Number of bins taken.
    pub bins: usize,
}

/// A slope that cannot be fitted.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum HurstError {
    /// Too few bins.
    #[error(
        "the spectrum has {bins} bins with power at wavelengths from {shortest} m to {longest} m, at least {FEWEST_BINS} are needed; widen the range"
    )]
    TooFewBins {
        /// Number of bins in the range.
        bins: usize,
        /// Shortest wavelength asked for in metres.
        shortest: f64,
        /// Longest wavelength asked for in metres.
        longest: f64,
    },
    /// The spectra cannot be averaged.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
}

/// Fits a straight line to `log10` of the average spectrum in bins, `per_decade` a decade, at
/// wavelengths from `shortest` to `longest` (metres).
///
/// Every bin counts the same, as every octave does. The logarithm of a bin of few densities lies low
/// by `ψ(ν/2) - ln(ν/2)`, which is added back. Bins without power, as gaps may leave them, do not
/// count.
///
/// # Errors
/// Fewer than three bins, spectra on different wavenumbers.
pub fn fit_hurst_exponent(
    spectra: &[PowerSpectrum],
    per_decade: usize,
    shortest: f64,
    longest: f64,
) -> Result<SpectralHurst, HurstError> {
    let within = |bin: &SpectrumBin| {
        let wavelength = TAU / bin.wavenumber;
        shortest <= wavelength && wavelength <= longest && bin.density > 0.0
    };
    let mut bins = PowerSpectrum::log_binned_over(spectra, per_decade)?;
    bins.retain(within);
    if bins.len() < FEWEST_BINS {
        return Err(HurstError::TooFewBins { bins: bins.len(), shortest, longest });
    }
    let x: Vec<f64> = bins.iter().map(|bin| bin.wavenumber.log10()).collect();
    let y: Vec<f64> = bins.iter().map(|bin| unbiased_log(spectra, bin) / LN_10).collect();
    let (level, slope) = line(&x, &y);
    let squares: f64 = x.iter().zip(&y).map(|(x, y)| (level + slope * x - y).powi(2)).sum();
    let hurst_exponent = (-slope - 1.0) / 2.0;
    let half_width = jackknife(spectra, per_decade, &bins, &x);
    let interval = |half: f64| ConfidenceInterval {
        lower: hurst_exponent - half,
        upper: hurst_exponent + half,
    };
    Ok(SpectralHurst {
        hurst_exponent,
        hurst_exponent_95: half_width.map(interval),
        rms_residual: (squares / x.len() as f64).sqrt(),
        shortest_wavelength: TAU / bins[bins.len() - 1].wavenumber,
        longest_wavelength: TAU / bins[0].wavenumber,
        bins: bins.len(),
    })
}

/// Half width of the interval; `None` for fewer than three scans, or where a scan left out leaves a
/// bin without power.
fn jackknife(
    spectra: &[PowerSpectrum],
    per_decade: usize,
    bins: &[SpectrumBin],
    x: &[f64],
) -> Option<f64> {
    if spectra.len() < 3 {
        return None;
    }
    let count = spectra.len() as f64;
    let of_scan = |spectrum: &PowerSpectrum| -> Vec<f64> {
        let mut own = spectrum.log_binned(per_decade);
        own.retain(|bin| bins.iter().any(|kept| kept.wavenumber == bin.wavenumber));
        own.iter().map(|bin| bin.density).collect()
    };
    let without = |spectrum: &PowerSpectrum| {
        let own = of_scan(spectrum);
        let rest =
            bins.iter().zip(own).map(|(bin, own)| (count * bin.density - own) / (count - 1.0));
        let y: Vec<f64> = rest.map(f64::log10).collect();
        (-line(x, &y).1 - 1.0) / 2.0
    };
    let half = jackknife_95(&spectra.iter().map(without).collect::<Vec<_>>());
    half.is_finite().then_some(half)
}
