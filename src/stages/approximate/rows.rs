//! The tables of the stage.

use crate::artifact::{Row, SchemaVersion, Table};
use crate::surface::correlation::CorrelationSample;
use crate::surface::sine_fit::{SineFit, superposed_correlation};
use crate::units::Units;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The fitted waves: `waves.arrow`.
pub const WAVES: Table<ScaleRow> = Table::new("approximate", "waves.arrow");
/// How good each fit is: `fits.arrow`.
pub const FITS: Table<FitRow> = Table::new("approximate", "fits.arrow");
/// Measured and fitted correlation: `fitted_correlation.arrow`.
pub const FITTED: Table<FittedRow> = Table::new("approximate", "fitted_correlation.arrow");

/// One fitted sine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScaleRow {
    /// Number of waves asked for, which names the approximation.
    pub waves: u32,
    /// Number of this wave, from the shortest, starting at 1.
    pub scale: u32,
    /// Wavelength.
    #[schemars(extend("unit" = "mm"))]
    pub wavelength_mm: f64,
    /// Amplitude, not negative.
    #[schemars(extend("unit" = "mm"))]
    pub amplitude_mm: f64,
    /// Half width of the 95 % confidence interval of the amplitude: jackknife over the windows;
    /// absent for fewer than three windows.
    #[schemars(extend("unit" = "mm"))]
    pub amplitude_confidence_95_mm: Option<f64>,
    /// Root mean square slope of this wave (3.3.15).
    #[schemars(extend("unit" = "1"))]
    pub rms_slope: f64,
}

impl Row for ScaleRow {
    const SCHEMA: &'static str = "asperity.approximate.waves";
    const VERSION: u32 = 1;
}

/// How good a fit is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitRow {
    /// Number of waves asked for.
    pub waves: u32,
    /// Number of waves fitted, without those dropped as undetermined.
    pub waves_fitted: u32,
    /// Root mean square residual of log10 of the correlation.
    #[schemars(extend("unit" = "1"))]
    pub rms_residual_log10: f64,
    /// Condition number of the fit: by how much relative errors of the correlation can grow.
    #[schemars(extend("unit" = "1"))]
    pub condition_number: f64,
    /// Norm of the gradient at the solution.
    #[schemars(extend("unit" = "1"))]
    pub gradient_norm: f64,
    /// Iterations of the optimiser.
    pub iterations: u64,
    /// Lags fitted.
    pub lags: u64,
    /// What the scans do not determine; empty if they determine all waves.
    pub warnings: String,
}

impl Row for FitRow {
    const SCHEMA: &'static str = "asperity.approximate.fits";
    const VERSION: u32 = 1;
}

/// Correlation of the scans and of the fitted waves at one lag.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FittedRow {
    /// Number of waves asked for.
    pub waves: u32,
    /// Lag.
    #[schemars(extend("unit" = "mm"))]
    pub lag_mm: f64,
    /// Correlation of the scans.
    #[schemars(extend("unit" = "mm^2"))]
    pub measured_mm2: f64,
    /// Correlation of the superposed sines.
    #[schemars(extend("unit" = "mm^2"))]
    pub fitted_mm2: f64,
}

impl Row for FittedRow {
    const SCHEMA: &'static str = "asperity.approximate.fitted_correlation";
    const VERSION: u32 = 1;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![WAVES.schema(), FITS.schema(), FITTED.schema()]
}

pub(super) fn scale_rows(waves: u32, fit: &SineFit, intervals: &[Option<f64>]) -> Vec<ScaleRow> {
    (1..)
        .zip(fit.sine_scales())
        .zip(intervals)
        .map(|((number, scale), interval)| ScaleRow {
            waves,
            scale: number,
            wavelength_mm: scale.wavelength.m_to_mm(),
            amplitude_mm: scale.amplitude.m_to_mm(),
            amplitude_confidence_95_mm: interval.map(crate::units::Units::m_to_mm),
            rms_slope: scale.rms_slope(),
        })
        .collect()
}

pub(super) fn fit_row(waves: u32, fit: &SineFit, warnings: String) -> FitRow {
    FitRow {
        waves,
        waves_fitted: fit.scales.len() as u32,
        rms_residual_log10: fit.rms_residual,
        condition_number: fit.condition_number,
        gradient_norm: fit.gradient_norm,
        iterations: fit.iterations,
        lags: fit.lags as u64,
        warnings,
    }
}

pub(super) fn fitted_rows(
    waves: u32,
    fit: &SineFit,
    average: &[CorrelationSample],
) -> Vec<FittedRow> {
    let scales = fit.sine_scales();
    let row = |sample: &CorrelationSample| FittedRow {
        waves,
        lag_mm: sample.lag.m_to_mm(),
        measured_mm2: sample.value.m2_to_mm2(),
        fitted_mm2: superposed_correlation(&scales, sample.lag).m2_to_mm2(),
    };
    average.iter().map(row).collect()
}
