//! The tables of the stage.

use super::section::{OlderMethod, ScaleMechanics};
use crate::artifact::{Row, SchemaVersion, Table};
use crate::stages::bem::Given;
use crate::stages::friction::Condition;
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Friction of each realisation under each method: `curves.arrow`.
pub const METHOD_CURVES: Table<MethodCurveRow> = Table::new("methods", "curves.arrow");
/// Averages of all methods and models in one table: `friction.arrow`.
pub const METHOD_FRICTION: Table<MethodFrictionRow> = Table::new("methods", "friction.arrow");

/// Friction of one realisation at one contact area under one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MethodCurveRow {
    /// Multiscale method: `recursive`, `split`, `particles` or `projection`.
    pub model: OlderMethod,
    /// How each scale is solved: `half-space` or `finite-deformation`.
    pub mechanics: ScaleMechanics,
    /// Number of the shortest waves below the split; absent for methods without a choice.
    pub split_waves: Option<u32>,
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1. Where single waves are solved, all have the same friction.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// What the value is for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction, with that of all scales: the mean of the area of the shorter ones over the local pressures.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient of all scales.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// Estimated error of the friction coefficient by interpolation along the curve, absolute.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// Estimated error of the friction coefficient by the grid or mesh of every scale and the pressures of every law: the
    /// difference to half of both; absent where that has no value.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Share of the load on points whose pressure is beyond the law of the scale below.
    #[schemars(extend("unit" = "1"))]
    pub load_beyond_law: f64,
}

impl MethodCurveRow {
    /// What it is given for.
    pub(super) fn condition(&self) -> Condition {
        Condition::of(self.given, self.contact_area_fraction, self.pressure_mpa)
    }
}

impl Row for MethodCurveRow {
    const SCHEMA: &'static str = "asperity.methods.curves";
    const VERSION: u32 = 1;
}

/// Average friction at one contact area under one method or model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MethodFrictionRow {
    /// Multiscale method, `recursive`, `split`, `particles` or `projection`, or a model of `tables/friction.arrow`.
    pub model: String,
    /// How each scale is solved, `half-space` or `finite-deformation`; absent for the models of `tables/friction.arrow`.
    pub mechanics: Option<String>,
    /// Number of the shortest waves below the split; absent for methods without a choice.
    pub split_waves: Option<u32>,
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// What friction is given for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction, averaged over the realisations where the pressure is given.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure, averaged over the realisations where the area is given.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Realisations.
    pub realisations: u32,
    /// Mean friction coefficient.
    #[schemars(extend("unit" = "1"))]
    pub mean: f64,
    /// Half width of the 95 % confidence interval of the mean over the realisations; absent for fewer than two.
    #[schemars(extend("unit" = "1"))]
    pub confidence_95: Option<f64>,
    /// Estimated error of the mean by grid or mesh, the mean of those of the realisations; absent where one is not known.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// `μ / μ_fem - 1` with the mean of all waves at finite deformation; absent where the run does not have it.
    #[schemars(extend("unit" = "1"))]
    pub from_all_waves: Option<f64>,
    /// Half width of the 95 % confidence interval of `from_all_waves` over the realisations, one by one; absent for fewer
    /// than two.
    #[schemars(extend("unit" = "1"))]
    pub from_all_waves_95: Option<f64>,
    /// Wall time of the curve of one realisation at this speed, the mean over the realisations, with the solves that
    /// estimate its error where a model is of `tables/friction.arrow`, and without them for the methods; absent where it is not kept.
    #[schemars(extend("unit" = "s", "volatile" = true))]
    pub seconds: Option<f64>,
}

impl Row for MethodFrictionRow {
    const SCHEMA: &'static str = "asperity.methods.friction";
    const VERSION: u32 = 1;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![METHOD_CURVES.schema(), METHOD_FRICTION.schema()]
}
