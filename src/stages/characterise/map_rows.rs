//! The tables of maps.

use super::AverageRow;
use crate::artifact::{Row, Table};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Areal parameters of each window of a map: `areal_parameters.arrow`, where maps are kept.
pub const AREAL_PARAMETERS: Table<ArealParametersRow> =
    Table::new("characterise", "areal_parameters.arrow");
/// Their averages: `areal_averages.arrow`, where maps are kept.
pub const AREAL_AVERAGES: Table<AverageRow> = Table::new("characterise", "areal_averages.arrow");
/// Correlation over lag and direction: `areal_correlation.arrow`, where maps are kept.
pub const AREAL_CORRELATION: Table<ArealCorrelationRow> =
    Table::new("characterise", "areal_correlation.arrow");
/// Radial mean of the spectrum over the plane: `areal_spectrum.arrow`, where maps are kept.
pub const AREAL_SPECTRUM: Table<ArealSpectrumRow> =
    Table::new("characterise", "areal_spectrum.arrow");
/// Power over direction: `areal_directions.arrow`, where maps are kept.
pub const AREAL_DIRECTIONS: Table<ArealDirectionRow> =
    Table::new("characterise", "areal_directions.arrow");

/// Areal roughness parameters of one window (ISO 25178-2), its form removed, not filtered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ArealParametersRow {
    /// Name of the window.
    pub map: String,
    /// Sa, mean absolute height.
    #[schemars(extend("unit" = "mm"))]
    pub sa_mm: f64,
    /// Sq, root mean square height.
    #[schemars(extend("unit" = "mm"))]
    pub sq_mm: f64,
    /// Ssk, skewness; negative for few deep valleys below a flattened top.
    #[schemars(extend("unit" = "1"))]
    pub ssk: f64,
    /// Sku, kurtosis; 3 for Gaussian heights.
    #[schemars(extend("unit" = "1"))]
    pub sku: f64,
    /// Sp, highest peak.
    #[schemars(extend("unit" = "mm"))]
    pub sp_mm: f64,
    /// Sv, depth of the deepest valley.
    #[schemars(extend("unit" = "mm"))]
    pub sv_mm: f64,
    /// Sz = Sp + Sv.
    #[schemars(extend("unit" = "mm"))]
    pub sz_mm: f64,
    /// Sdq, root mean square gradient from first differences.
    #[schemars(extend("unit" = "1"))]
    pub sdq: f64,
    /// Sdr, developed area over the projected one, less 1 (0.01 is 1 %).
    #[schemars(extend("unit" = "1"))]
    pub sdr: f64,
    /// Sal, shortest distance after which the autocorrelation falls to 0.2; absent if it does so nowhere within half the
    /// lengths of the window.
    #[schemars(extend("unit" = "mm"))]
    pub sal_mm: Option<f64>,
    /// Str, Sal over the longest such distance: 0 for ridges, 1 for an isotropic surface.
    #[schemars(extend("unit" = "1"))]
    pub str: Option<f64>,
    /// Whether Str is an upper bound, because the autocorrelation stays above 0.2 in some direction.
    pub str_is_upper_bound: bool,
    /// Std, direction of the waves with the most power, from x towards y; grooves run across it.
    #[schemars(extend("unit" = "deg"))]
    pub std_deg: f64,
    /// Sk, core height.
    #[schemars(extend("unit" = "mm"))]
    pub sk_mm: f64,
    /// Spk, reduced peak height.
    #[schemars(extend("unit" = "mm"))]
    pub spk_mm: f64,
    /// Svk, reduced valley depth.
    #[schemars(extend("unit" = "mm"))]
    pub svk_mm: f64,
    /// Smr1, material ratio of the peaks (0.1 is 10 %).
    #[schemars(extend("unit" = "1"))]
    pub smr1: f64,
    /// Smr2, material ratio above the valleys.
    #[schemars(extend("unit" = "1"))]
    pub smr2: f64,
    /// Vmp, material volume of the peaks over the area, at a material ratio of 10 %.
    #[schemars(extend("unit" = "mm"))]
    pub vmp_mm: f64,
    /// Vmc, material volume of the core over the area, from 10 to 80 %.
    #[schemars(extend("unit" = "mm"))]
    pub vmc_mm: f64,
    /// Vvc, void volume of the core over the area, from 10 to 80 %.
    #[schemars(extend("unit" = "mm"))]
    pub vvc_mm: f64,
    /// Vvv, void volume of the valleys over the area, below 80 %.
    #[schemars(extend("unit" = "mm"))]
    pub vvv_mm: f64,
    /// Direction of the longest correlation, from x towards y.
    #[schemars(extend("unit" = "deg"))]
    pub run_deg: Option<f64>,
    /// Length of the correlation across that direction over that along it: 1 for an isotropic surface.
    #[schemars(extend("unit" = "1"))]
    pub aspect: Option<f64>,
    /// Direction of the least gradients: the run of the shortest waves.
    #[schemars(extend("unit" = "deg"))]
    pub gradient_run_deg: Option<f64>,
    /// Root mean square gradient along that direction over that across it: 1 for an isotropic surface.
    #[schemars(extend("unit" = "1"))]
    pub gradient_ratio: Option<f64>,
}

impl Row for ArealParametersRow {
    const SCHEMA: &'static str = "asperity.characterise.areal_parameters";
    const VERSION: u32 = 1;
}

/// Height-difference correlation at one lag in one direction: mean of `(z(r + s) - z(r))²` over pairs of valid points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ArealCorrelationRow {
    /// Name of the window.
    pub map: String,
    /// Direction from x towards y.
    #[schemars(extend("unit" = "deg"))]
    pub angle_deg: f64,
    /// Lag s.
    #[schemars(extend("unit" = "mm"))]
    pub lag_mm: f64,
    /// Height-difference correlation C(s).
    #[schemars(extend("unit" = "mm^2"))]
    pub correlation_mm2: f64,
    /// Pairs of valid points at this lag.
    pub pairs: u64,
}

impl Row for ArealCorrelationRow {
    const SCHEMA: &'static str = "asperity.characterise.areal_correlation";
    const VERSION: u32 = 1;
}

/// Mean of the two-dimensional power spectral density over a ring of wavenumbers; its integral over the whole plane is the
/// mean square height.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ArealSpectrumRow {
    /// Name of the window, or `average` over all windows.
    pub map: String,
    /// Mean wavenumber q = 2 π / λ of the ring.
    #[schemars(extend("unit" = "rad/mm"))]
    pub wavenumber_rad_mm: f64,
    /// Mean density.
    #[schemars(extend("unit" = "mm^4"))]
    pub density_mm4: f64,
    /// Standard error of the mean density that a Gaussian surface has.
    #[schemars(extend("unit" = "mm^4"))]
    pub standard_error_mm4: f64,
    /// Waves in the ring.
    pub waves: u64,
}

impl Row for ArealSpectrumRow {
    const SCHEMA: &'static str = "asperity.characterise.areal_spectrum";
    const VERSION: u32 = 1;
}

/// Share of the power of the waves that run within five degrees of a direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ArealDirectionRow {
    /// Name of the window.
    pub map: String,
    /// Middle of the sector from x towards y.
    #[schemars(extend("unit" = "deg"))]
    pub angle_deg: f64,
    /// Share of the power; 1/18 for an isotropic surface.
    #[schemars(extend("unit" = "1"))]
    pub share: f64,
    /// Waves in the sector.
    pub waves: u64,
}

impl Row for ArealDirectionRow {
    const SCHEMA: &'static str = "asperity.characterise.areal_directions";
    const VERSION: u32 = 1;
}
