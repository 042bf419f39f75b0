//! The tables of the stage.

use super::StageError;
use super::{AGREEMENT, DEPTH, HURST, ISOTROPIC, PROFILE, SPECTRUM, TEXTURE};
use super::{AREAL_CORRELATION, AREAL_DIRECTIONS, AREAL_PARAMETERS, AREAL_SPECTRUM};
use crate::artifact::{Row, SchemaVersion, Table};
use crate::numerics::statistics::MeanEstimate;
use crate::surface::correlation::HeightDifferenceCorrelation;
use crate::surface::parameters::{AverageRoughness, RoughnessParameters};
use crate::surface::self_affine::{ConfidenceInterval, SelfAffineFit};
use crate::units::Units;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parameters of each window: `parameters.arrow`.
pub const PARAMETERS: Table<ParametersRow> = Table::new("characterise", "parameters.arrow");
/// Averages of the parameters: `averages.arrow`.
pub const AVERAGES: Table<AverageRow> = Table::new("characterise", "averages.arrow");
/// Correlation at log-spaced lags, per window and averaged: `correlation.arrow`.
pub const CORRELATION: Table<CorrelationRow> = Table::new("characterise", "correlation.arrow");
/// Self-affine fit, per window and averaged: `self_affine.arrow`.
pub const SELF_AFFINE: Table<SelfAffineRow> = Table::new("characterise", "self_affine.arrow");
/// What stands in the column `scan` for the average over all windows.
pub const AVERAGE: &str = "average";

/// Roughness parameters of one window (thesis 3.2.1-7).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParametersRow {
    /// Name of the window.
    pub scan: String,
    /// Ra, mean absolute height.
    #[schemars(extend("unit" = "mm"))]
    pub ra_mm: f64,
    /// Rq, root mean square height.
    #[schemars(extend("unit" = "mm"))]
    pub rq_mm: f64,
    /// Rp, highest peak.
    #[schemars(extend("unit" = "mm"))]
    pub rp_mm: f64,
    /// Rv, depth of the deepest valley, positive as in ISO 21920-2; the thesis (3.2.4) has it negative.
    #[schemars(extend("unit" = "mm"))]
    pub rv_mm: f64,
    /// Rt = Rp + Rv, total height.
    #[schemars(extend("unit" = "mm"))]
    pub rt_mm: f64,
    /// Rsk, skewness; negative for few deep valleys below a flattened top.
    #[schemars(extend("unit" = "1"))]
    pub rsk: f64,
    /// Rku, kurtosis; 3 for Gaussian heights.
    #[schemars(extend("unit" = "1"))]
    pub rku: f64,
    /// Root mean square slope from first differences.
    #[schemars(extend("unit" = "1"))]
    pub rms_slope: f64,
}

impl Row for ParametersRow {
    const SCHEMA: &'static str = "asperity.characterise.parameters";
    const VERSION: u32 = 2;
}

/// Average of one roughness parameter over the windows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AverageRow {
    /// Name of the parameter, with its unit.
    pub parameter: String,
    /// Mean over the windows, in the unit of the parameter. Rv is a depth, positive as in ISO 21920-2;
    /// the thesis (3.2.4) has it negative.
    #[schemars(extend("unit" = "see parameter"))]
    pub mean: f64,
    /// Standard deviation over the windows; absent for fewer than two.
    #[schemars(extend("unit" = "see parameter"))]
    pub standard_deviation: Option<f64>,
    /// Half width of the 95 % confidence interval of the mean; absent for fewer than two.
    #[schemars(extend("unit" = "see parameter"))]
    pub confidence_95: Option<f64>,
    /// Number of windows.
    pub windows: u64,
}

impl Row for AverageRow {
    const SCHEMA: &'static str = "asperity.characterise.averages";
    const VERSION: u32 = 2;
}

/// Height-difference correlation at one lag: mean of `(z(x + s) - z(x))²` over pairs of valid
/// points (3.3.1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrelationRow {
    /// Name of the window, or `average` over all pairs of all windows.
    pub scan: String,
    /// Lag s.
    #[schemars(extend("unit" = "mm"))]
    pub lag_mm: f64,
    /// Height-difference correlation C(s).
    #[schemars(extend("unit" = "mm^2"))]
    pub correlation_mm2: f64,
    /// Pairs of valid points at this lag.
    pub pairs: u64,
}

impl Row for CorrelationRow {
    const SCHEMA: &'static str = "asperity.characterise.correlation";
    const VERSION: u32 = 1;
}

/// Self-affine fit of the correlation (3.3.2-3).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SelfAffineRow {
    /// Name of the window, or `average`.
    pub scan: String,
    /// Hurst exponent H.
    #[schemars(extend("unit" = "1"))]
    pub hurst_exponent: f64,
    /// Lower limit of the 95 % interval of H, jackknife over windows; absent for one window.
    #[schemars(extend("unit" = "1"))]
    pub hurst_exponent_lower: Option<f64>,
    /// Upper limit of the 95 % interval of H.
    #[schemars(extend("unit" = "1"))]
    pub hurst_exponent_upper: Option<f64>,
    /// Lateral correlation length, the lag of the bend.
    #[schemars(extend("unit" = "mm"))]
    pub parallel_length_mm: f64,
    /// Lower limit of its 95 % interval.
    #[schemars(extend("unit" = "mm"))]
    pub parallel_length_lower_mm: Option<f64>,
    /// Upper limit of its 95 % interval.
    #[schemars(extend("unit" = "mm"))]
    pub parallel_length_upper_mm: Option<f64>,
    /// Vertical correlation length, the root of the plateau.
    #[schemars(extend("unit" = "mm"))]
    pub perpendicular_length_mm: f64,
    /// Lower limit of its 95 % interval.
    #[schemars(extend("unit" = "mm"))]
    pub perpendicular_length_lower_mm: Option<f64>,
    /// Upper limit of its 95 % interval.
    #[schemars(extend("unit" = "mm"))]
    pub perpendicular_length_upper_mm: Option<f64>,
    /// Whether the plateau lies within the lags; if not, both lengths are lower bounds.
    pub plateau_found: bool,
    /// Root mean square residual of log10 C.
    #[schemars(extend("unit" = "1"))]
    pub rms_residual_log10: f64,
}

impl Row for SelfAffineRow {
    const SCHEMA: &'static str = "asperity.characterise.self_affine";
    const VERSION: u32 = 1;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![
        PARAMETERS.schema(),
        AVERAGES.schema(),
        CORRELATION.schema(),
        SPECTRUM.schema(),
        ISOTROPIC.schema(),
        HURST.schema(),
        AGREEMENT.schema(),
        SELF_AFFINE.schema(),
        PROFILE.schema(),
        DEPTH.schema(),
        TEXTURE.schema(),
        AREAL_PARAMETERS.schema(),
        AREAL_CORRELATION.schema(),
        AREAL_SPECTRUM.schema(),
        AREAL_DIRECTIONS.schema(),
    ]
}

/// Name of a window and its parameters.
pub(super) type NamedParameters = (String, RoughnessParameters);

pub(super) fn parameters_row((scan, roughness): &NamedParameters) -> ParametersRow {
    ParametersRow {
        scan: scan.clone(),
        ra_mm: roughness.mean_absolute_height.m_to_mm(),
        rq_mm: roughness.rms_height.m_to_mm(),
        rp_mm: roughness.highest_peak.m_to_mm(),
        rv_mm: roughness.deepest_valley.m_to_mm(),
        rt_mm: roughness.total_height.m_to_mm(),
        rsk: roughness.skewness,
        rku: roughness.kurtosis,
        rms_slope: roughness.rms_slope,
    }
}

pub(super) fn average_rows(roughness: &[NamedParameters]) -> Result<Vec<AverageRow>, StageError> {
    if roughness.is_empty() {
        return Ok(Vec::new());
    }
    let parameters: Vec<_> = roughness.iter().map(|(_, parameters)| *parameters).collect();
    let average = AverageRoughness::of(&parameters)?;
    let row = |parameter: &str, estimate: MeanEstimate, unit: fn(f64) -> f64| AverageRow {
        parameter: parameter.to_owned(),
        mean: unit(estimate.mean),
        standard_deviation: finite(unit(estimate.standard_deviation)),
        confidence_95: finite(unit(estimate.confidence_95)),
        windows: estimate.count as u64,
    };
    Ok(vec![
        row("Ra [mm]", average.mean_absolute_height, Units::m_to_mm),
        row("Rq [mm]", average.rms_height, Units::m_to_mm),
        row("Rp [mm]", average.highest_peak, Units::m_to_mm),
        row("Rv [mm]", average.deepest_valley, Units::m_to_mm),
        row("Rt [mm]", average.total_height, Units::m_to_mm),
        row("Rsk", average.skewness, pure),
        row("Rku", average.kurtosis, pure),
        row("rms slope", average.rms_slope, pure),
    ])
}

pub(super) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

pub(super) fn correlation_rows(
    scan: &str,
    correlation: &HeightDifferenceCorrelation,
    per_decade: usize,
) -> Vec<CorrelationRow> {
    let samples = correlation.sample_log_spaced(per_decade);
    let row = |sample: crate::surface::CorrelationSample| CorrelationRow {
        scan: scan.to_owned(),
        lag_mm: sample.lag.m_to_mm(),
        correlation_mm2: sample.value.m2_to_mm2(),
        pairs: sample.pairs,
    };
    samples.into_iter().map(row).collect()
}

/// A pure number, which has no unit to change.
pub(super) fn pure(value: f64) -> f64 {
    value
}

pub(super) fn self_affine_row(scan: &str, fit: &SelfAffineFit) -> SelfAffineRow {
    let lower = |i: &Option<ConfidenceInterval>, unit: fn(f64) -> f64| {
        i.and_then(|i| finite(unit(i.lower)))
    };
    let upper = |i: &Option<ConfidenceInterval>, unit: fn(f64) -> f64| {
        i.and_then(|i| finite(unit(i.upper)))
    };
    SelfAffineRow {
        scan: scan.to_owned(),
        hurst_exponent: fit.hurst_exponent,
        hurst_exponent_lower: lower(&fit.hurst_exponent_95, pure),
        hurst_exponent_upper: upper(&fit.hurst_exponent_95, pure),
        parallel_length_mm: fit.lateral_length.m_to_mm(),
        parallel_length_lower_mm: lower(&fit.lateral_length_95, Units::m_to_mm),
        parallel_length_upper_mm: upper(&fit.lateral_length_95, Units::m_to_mm),
        perpendicular_length_mm: fit.vertical_length.m_to_mm(),
        perpendicular_length_lower_mm: lower(&fit.vertical_length_95, Units::m_to_mm),
        perpendicular_length_upper_mm: upper(&fit.vertical_length_95, Units::m_to_mm),
        plateau_found: fit.plateau_found,
        rms_residual_log10: fit.rms_residual,
    }
}
