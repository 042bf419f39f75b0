//! The tables of the stage.

use super::conclusions::Quantity;
use super::problem::Model;
use crate::artifact::Row;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One model at one aspect ratio, speed and pressure, on two meshes. Values are those of the finer
/// mesh; extrapolated ones assume the second order of the methods, the mesh error does not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PointRow {
    /// Amplitude over wavelength, D/L.
    #[schemars(extend("unit" = "1"))]
    pub aspect_ratio: f64,
    /// Root mean square slope √2 π D/L.
    #[schemars(extend("unit" = "1"))]
    pub rms_slope: f64,
    /// Model: `half-space` (linear viscoelastic half-space), `linear` (stress linear in the
    /// logarithmic strain), `neo-hookean` (finite viscoelasticity).
    pub model: Model,
    /// Sliding speed v.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Deborah number v/v* with v* = L/(2 π τ) and the mean relaxation time
    /// τ = Σ E_k τ_k / Σ E_k of the branches.
    #[schemars(extend("unit" = "1"))]
    pub deborah_number: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Columns of the finer mesh, or points of the finer grid of the half-space.
    pub columns: u64,
    /// Friction coefficient; absent where no solution was found.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: Option<f64>,
    /// Friction coefficient on half as many columns.
    #[schemars(extend("unit" = "1"))]
    pub friction_coarse: Option<f64>,
    /// Friction coefficient by Richardson extrapolation.
    #[schemars(extend("unit" = "1"))]
    pub friction_extrapolated: Option<f64>,
    /// Mesh error of the friction coefficient: its difference from that of the coarser mesh or from
    /// that by the dissipated power, whichever is more.
    #[schemars(extend("unit" = "1"))]
    pub friction_mesh_error: Option<f64>,
    /// Contact area fraction; absent where no solution was found.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: Option<f64>,
    /// Contact area fraction on half as many columns.
    #[schemars(extend("unit" = "1"))]
    pub area_coarse: Option<f64>,
    /// Contact area fraction by Richardson extrapolation.
    #[schemars(extend("unit" = "1"))]
    pub area_extrapolated: Option<f64>,
    /// Mesh error of the contact area fraction: its difference from that of the coarser mesh.
    #[schemars(extend("unit" = "1"))]
    pub area_mesh_error: Option<f64>,
    /// Mean separation; absent where no solution was found.
    #[schemars(extend("unit" = "mm"))]
    pub mean_separation_mm: Option<f64>,
    /// Mesh error of the mean separation: its difference from that of the coarser mesh.
    #[schemars(extend("unit" = "mm"))]
    pub separation_mesh_error_mm: Option<f64>,
    /// Residual of the solution, relative.
    #[schemars(extend("unit" = "1"))]
    pub residual: Option<f64>,
    /// Why there is no solution on the finer mesh; absent where there is one.
    pub why_missing: Option<String>,
    /// Pressure of the last solution on the finer mesh before its path ended.
    #[schemars(extend("unit" = "MPa"))]
    pub path_ended_at_mpa: Option<f64>,
    /// Pressure of the last solution on the coarser mesh before its path ended.
    #[schemars(extend("unit" = "MPa"))]
    pub coarse_path_ended_at_mpa: Option<f64>,
}

impl Row for PointRow {
    const SCHEMA: &'static str = "asperity.sinusoid.points";
    const VERSION: u32 = 1;
}

/// A limit of the speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Limit {
    /// Slow sliding: the relaxed modulus.
    Slow,
    /// Fast sliding: the glassy modulus.
    Fast,
}

impl std::fmt::Display for Limit {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(match self {
            Self::Slow => "slow",
            Self::Fast => "fast",
        })
    }
}

/// The elastic limits of slow sliding (relaxed modulus) and fast sliding (glassy modulus).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AsymptoteRow {
    /// Amplitude over wavelength, D/L.
    #[schemars(extend("unit" = "1"))]
    pub aspect_ratio: f64,
    /// Root mean square slope √2 π D/L.
    #[schemars(extend("unit" = "1"))]
    pub rms_slope: f64,
    /// Limit: `slow` or `fast`.
    pub limit: Limit,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Reduced modulus E/(1 - ν²) of the limit.
    #[schemars(extend("unit" = "MPa"))]
    pub reduced_modulus_mpa: f64,
    /// Contact area fraction of the Hertz contact with the crest; that of small contacts only.
    #[schemars(extend("unit" = "1"))]
    pub hertz_area_fraction: f64,
    /// Largest pressure of the Hertz contact.
    #[schemars(extend("unit" = "MPa"))]
    pub hertz_maximum_pressure_mpa: f64,
    /// Mean pressure p* of full contact of the half-space (Westergaard).
    #[schemars(extend("unit" = "MPa"))]
    pub full_contact_pressure_mpa: f64,
    /// Contact area fraction of the half-space at any pressure (Westergaard).
    #[schemars(extend("unit" = "1"))]
    pub westergaard_area_fraction: f64,
}

impl Row for AsymptoteRow {
    const SCHEMA: &'static str = "asperity.sinusoid.asymptotes";
    const VERSION: u32 = 1;
}

/// Pressure and separation at one point of the surface, on the finer mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FieldRow {
    /// Amplitude over wavelength, D/L.
    #[schemars(extend("unit" = "1"))]
    pub aspect_ratio: f64,
    /// Root mean square slope √2 π D/L.
    #[schemars(extend("unit" = "1"))]
    pub rms_slope: f64,
    /// Model, as in the points.
    pub model: Model,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Deborah number, as in the points.
    #[schemars(extend("unit" = "1"))]
    pub deborah_number: f64,
    /// Position in the frame of the profile; the crest is at a quarter of the wavelength.
    #[schemars(extend("unit" = "mm"))]
    pub x_mm: f64,
    /// Height of the profile about its mean.
    #[schemars(extend("unit" = "mm"))]
    pub profile_height_mm: f64,
    /// Contact pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Separation of rubber and profile.
    #[schemars(extend("unit" = "mm"))]
    pub separation_mm: f64,
}

impl Row for FieldRow {
    const SCHEMA: &'static str = "asperity.sinusoid.fields";
    const VERSION: u32 = 1;
}

/// The maximum of friction over speed of one curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PeakRow {
    /// Amplitude over wavelength, D/L.
    #[schemars(extend("unit" = "1"))]
    pub aspect_ratio: f64,
    /// Root mean square slope √2 π D/L.
    #[schemars(extend("unit" = "1"))]
    pub rms_slope: f64,
    /// Model, as in the points.
    pub model: Model,
    /// Largest friction coefficient: of the parabola over log v through the highest point and its
    /// neighbours, or of the highest point where it is not bracketed.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// Mesh error of the highest point.
    #[schemars(extend("unit" = "1"))]
    pub friction_mesh_error: Option<f64>,
    /// Speed of the maximum.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Deborah number of the maximum.
    #[schemars(extend("unit" = "1"))]
    pub deborah_number: f64,
    /// Whether the points at the next lower and the next higher speed have solutions; otherwise the
    /// true maximum may lie beyond.
    pub bracketed: bool,
    /// Largest friction coefficient over that of the neo-Hookean model, less one; absent where one
    /// of both maxima is not bracketed.
    #[schemars(extend("unit" = "1"))]
    pub relative_to_neo_hookean: Option<f64>,
}

impl Row for PeakRow {
    const SCHEMA: &'static str = "asperity.sinusoid.peaks";
    const VERSION: u32 = 1;
}

/// How far one model agrees with the neo-Hookean one along a curve over speed.
///
/// A point agrees where the difference and the mesh errors of both together are within the level;
/// the curves part where the difference less the mesh errors is beyond it; the meshes leave the
/// others undecided.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AgreementRow {
    /// Amplitude over wavelength, D/L.
    #[schemars(extend("unit" = "1"))]
    pub aspect_ratio: f64,
    /// Root mean square slope √2 π D/L.
    #[schemars(extend("unit" = "1"))]
    pub rms_slope: f64,
    /// Model that is compared, as in the points.
    pub model: Model,
    /// What is compared: `friction` and `area` as differences over the value of the neo-Hookean
    /// model at the same speed, `friction of peak` as difference over its largest friction.
    pub quantity: Quantity,
    /// Relative difference that counts as agreement.
    #[schemars(extend("unit" = "1"))]
    pub level: f64,
    /// Speeds at which both models have a solution.
    pub compared: u32,
    /// Speeds at which one of them has none.
    pub missing: u32,
    /// Of the compared, those that agree.
    pub agree: u32,
    /// Of the compared, those that part.
    pub part: u32,
    /// Of the compared, those that the meshes leave undecided.
    pub undecided: u32,
    /// Lowest Deborah number at which the curves part.
    #[schemars(extend("unit" = "1"))]
    pub parts_from_deborah_number: Option<f64>,
    /// Highest Deborah number at which the curves part.
    #[schemars(extend("unit" = "1"))]
    pub parts_to_deborah_number: Option<f64>,
    /// Largest difference in magnitude of the compared that agree or part, with its sign; absent
    /// if there is none.
    #[schemars(extend("unit" = "1"))]
    pub largest_difference: Option<f64>,
    /// Deborah number of the largest difference.
    #[schemars(extend("unit" = "1"))]
    pub largest_at_deborah_number: Option<f64>,
}

impl Row for AgreementRow {
    const SCHEMA: &'static str = "asperity.sinusoid.agreement";
    const VERSION: u32 = 1;
}
