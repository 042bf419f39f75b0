//! What the stage writes.

use crate::artifact::{Row, SchemaVersion, Table};
use crate::stages::bem::CurveRow;
use crate::stages::fem::FemSolveRow;
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The averages at finite deformation: `averages.arrow`.
pub const AVERAGES: Table<AverageRow> = Table::new("multilevel", "averages.arrow");
/// The realisations solved under both models: `pairs.arrow`.
pub const PAIRS: Table<PairRow> = Table::new("multilevel", "pairs.arrow");
/// Curves of the half-space beyond those of `bem`, with the columns of `bem/curves.arrow`:
/// `half_space.arrow`.
pub const FURTHER: Table<CurveRow> = Table::new("multilevel", "half_space.arrow");
/// All solves with finite elements, with the columns of `fem/solves.arrow`: `solves.arrow`.
pub const SOLVES: Table<FemSolveRow> = Table::new("multilevel", "solves.arrow");

/// Average friction at finite deformation at one contact area, from both models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AverageRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Average pressure at finite deformation, estimated as the friction is.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Average friction coefficient at finite deformation: mean of the half-space plus mean difference
    /// of the pairs.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// Realisations solved on the half-space.
    pub half_space_realisations: u32,
    /// Of these solved with finite elements too: the first ones.
    pub pairs: u32,
    /// Mean friction coefficient of the half-space.
    #[schemars(extend("unit" = "1"))]
    pub half_space_mean: f64,
    /// Mean over the pairs of finite deformation less half-space; absent without pairs.
    #[schemars(extend("unit" = "1"))]
    pub mean_difference: Option<f64>,
    /// Standard deviation of the half-space over its realisations; absent for fewer than two.
    #[schemars(extend("unit" = "1"))]
    pub half_space_deviation: Option<f64>,
    /// Standard deviation of the differences over the pairs; absent for fewer than two.
    #[schemars(extend("unit" = "1"))]
    pub difference_deviation: Option<f64>,
    /// Half width of the 95 % confidence interval of the average, of both parts and their covariance,
    /// Student's t with the degrees of freedom of Welch and Satterthwaite; absent for fewer than two pairs.
    #[schemars(extend("unit" = "1"))]
    pub confidence_95: Option<f64>,
    /// Degrees of freedom of the interval.
    #[schemars(extend("unit" = "1"))]
    pub degrees_of_freedom: Option<f64>,
    /// Estimated error by interpolation of the finite-element curves, mean over the pairs. Those of the
    /// half-space cancel: they are in its mean and, with the other sign, in the differences. Without pairs
    /// those of the half-space.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// Estimated error by the mesh, mean over the pairs; without pairs by the grid of the half-space.
    /// Absent where it is not known.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Bound of the error by waves that some half-space curves were solved without: the share that does
    /// not cancel in the differences.
    #[schemars(extend("unit" = "1"))]
    pub left_out_error: f64,
    /// Bound of the difference of the models where no finite elements were solved; 0 with pairs.
    #[schemars(extend("unit" = "1"))]
    pub model_error: f64,
    /// Sum of `confidence_95` and the four errors; absent where one of them is not known.
    #[schemars(extend("unit" = "1"))]
    pub error_estimate: Option<f64>,
}

impl Row for AverageRow {
    const SCHEMA: &'static str = "asperity.multilevel.averages";
    const VERSION: u32 = 2;
}

/// One realisation under both models at one contact area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PairRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure of the half-space.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_half_space_mpa: f64,
    /// Mean pressure with all waves at finite deformation.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_finite_deformation_mpa: f64,
    /// Friction coefficient of the half-space.
    #[schemars(extend("unit" = "1"))]
    pub friction_half_space: f64,
    /// Friction coefficient with all waves at finite deformation.
    #[schemars(extend("unit" = "1"))]
    pub friction_finite_deformation: f64,
    /// Finite deformation less half-space.
    #[schemars(extend("unit" = "1"))]
    pub difference: f64,
    /// Estimated error at finite deformation by interpolation.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// Estimated error at finite deformation by the mesh; absent where it is not known.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
}

impl Row for PairRow {
    const SCHEMA: &'static str = "asperity.multilevel.pairs";
    const VERSION: u32 = 2;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![AVERAGES.schema(), PAIRS.schema(), FURTHER.schema(), SOLVES.schema()]
}
