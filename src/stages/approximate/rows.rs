//! The tables of the stage.

use crate::artifact::{Row, SchemaVersion, Table};
use crate::surface::correlation::CorrelationSample;
use crate::surface::sine_fit::{FitRule, SineFit, rms_height_of_correlation};
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

/// The amplitudes of the fits without halves of the windows: `replicates.arrow`.
pub const REPLICATES: Table<ReplicateRow> = Table::new("approximate", "replicates.arrow");

/// One sine of a fit to the scans without half of the groups of windows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReplicateRow {
    /// Number of waves asked for.
    pub waves: u32,
    /// Number of the half that is left out, from 1, in the order of
    /// [`balanced_halves`](crate::numerics::statistics::balanced_halves).
    pub replicate: u32,
    /// Groups that the windows are divided into, neighbours together.
    pub groups: u32,
    /// Number of this wave, from the shortest, starting at 1.
    pub scale: u32,
    /// Amplitude, not negative.
    #[schemars(extend("unit" = "mm"))]
    pub amplitude_mm: f64,
}

impl Row for ReplicateRow {
    const SCHEMA: &'static str = "asperity.approximate.replicates";
    const VERSION: u32 = 2;
}

/// How good a fit is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitRow {
    /// Number of waves asked for.
    pub waves: u32,
    /// Number of waves fitted, without those dropped as undetermined.
    pub waves_fitted: u32,
    /// Root mean square residual of log10 of the correlation, or of its mean over the lags up to each (rule `sines`).
    #[schemars(extend("unit" = "1"))]
    pub rms_residual_log10: f64,
    /// Root mean square height of a surface made of the waves, sqrt(sum of D²/2).
    #[schemars(extend("unit" = "mm"))]
    pub rms_height_mm: f64,
    /// Root mean square height of the scans by their correlation: sqrt(C/2), with the mean of C over the lags above half
    /// the longest.
    #[schemars(extend("unit" = "mm"))]
    pub scans_rms_height_mm: f64,
    /// The former over the latter: by the rule of the thesis about 0.71; by the rule `sines` 1, less what longer
    /// waves than the fitted ones contribute to the scans.
    #[schemars(extend("unit" = "1"))]
    pub rms_height_ratio: f64,
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
    const VERSION: u32 = 2;
}

/// Correlation of the scans and of the fitted waves at one lag, as the rule of the fit (metadata `rule`) compares
/// them: by the rule `sines`, means over the lags from 0 to this one, up to half the longest wavelength.
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
    vec![WAVES.schema(), REPLICATES.schema(), FITS.schema(), FITTED.schema()]
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

pub(super) fn fit_row(
    waves: u32,
    fit: &SineFit,
    average: &[CorrelationSample],
    warnings: String,
) -> FitRow {
    let (rms_height, of_scans) = (fit.rms_height(), rms_height_of_correlation(average));
    FitRow {
        waves,
        waves_fitted: fit.scales.len() as u32,
        rms_residual_log10: fit.rms_residual,
        rms_height_mm: rms_height.m_to_mm(),
        scans_rms_height_mm: of_scans.m_to_mm(),
        rms_height_ratio: rms_height / of_scans,
        condition_number: fit.condition_number,
        gradient_norm: fit.gradient_norm,
        iterations: fit.iterations,
        lags: fit.lags as u64,
        warnings,
    }
}

pub(super) fn fitted_rows(
    waves: u32,
    rule: FitRule,
    fit: &SineFit,
    average: &[CorrelationSample],
) -> Vec<FittedRow> {
    let scales = fit.sine_scales();
    let measured = rule.compared(average, scales.last().map_or(0.0, |scale| scale.wavelength));
    let lags: Vec<f64> = measured.iter().map(|sample| sample.lag).collect();
    let fitted = rule.superposed(&scales, &lags);
    let row = |(sample, fitted): (&CorrelationSample, f64)| FittedRow {
        waves,
        lag_mm: sample.lag.m_to_mm(),
        measured_mm2: sample.value.m2_to_mm2(),
        fitted_mm2: fitted.m2_to_mm2(),
    };
    measured.iter().zip(fitted).map(row).collect()
}
