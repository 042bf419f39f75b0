//! The tables of the stage.

use super::{BUDGET, COMPARISON, CORRECTIONS, EFFECTS, METHODS, MODELS, THEORIES, TOTAL};
use crate::artifact::{Row, SchemaVersion, Table};
use crate::stages::bem::Given;
use crate::stages::friction::Condition;
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A contact model.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// The viscoelastic half-space.
    #[default]
    Bem,
    /// The half-space corrected by its steepest waves at finite deformation.
    Hybrid,
    /// All waves at finite deformation.
    Fem,
    /// The half-space with the mean difference to all waves at finite deformation.
    Multilevel,
    /// Persson's theory.
    Persson,
    /// The theory of Klüppel and Heinrich.
    KlueppelHeinrich,
}

impl Model {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bem => "bem",
            Self::Hybrid => "hybrid",
            Self::Fem => "fem",
            Self::Multilevel => "multilevel",
            Self::Persson => "persson",
            Self::KlueppelHeinrich => "klueppel-heinrich",
        }
    }
}

impl std::fmt::Display for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// The averaged friction: `friction.arrow`.
pub const FRICTION: Table<FrictionRow> = Table::new("tables", "friction.arrow");

/// Friction at one contact area: each realisation and their average.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrictionRow {
    /// Contact model: `bem`, the viscoelastic half-space; `hybrid`, corrected by its steepest
    /// waves; `fem`, all waves at finite deformation; `multilevel`, the half-space with the mean difference
    /// to all waves at finite deformation; `persson` and `klueppel-heinrich`, the theories.
    pub model: Model,
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// What the value is for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction, averaged over the realisations where the pressure is given.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Shortest wavelength of the surfaces.
    #[schemars(extend("unit" = "mm"))]
    pub shortest_wavelength_mm: f64,
    /// Windows of the scans that the surfaces are made of; 0 where the recipe states the waves.
    pub windows: u32,
    /// Friction coefficient of each realisation, in their order; of `multilevel` those that were solved at
    /// finite deformation.
    #[schemars(extend("unit" = "1"))]
    pub realisations: Vec<f64>,
    /// Realisations of the half-space that the mean of `multilevel` rests on; absent for other models.
    pub half_space_realisations: Option<u32>,
    /// Mean over the realisations; of `multilevel` the mean of the half-space plus the mean difference of
    /// the realisations solved under both models.
    #[schemars(extend("unit" = "1"))]
    pub mean: f64,
    /// Standard deviation over the realisations; absent for fewer than two.
    #[schemars(extend("unit" = "1"))]
    pub standard_deviation: Option<f64>,
    /// Half width of the 95 % confidence interval of the mean, Student's t; absent for fewer than
    /// two. Draws of one window count once, by their mean. Of `multilevel` it holds the spread of the half-space and of the differences.
    #[schemars(extend("unit" = "1"))]
    pub confidence_95: Option<f64>,
    /// Half width of the 95 % confidence interval of the mean by the choice of scans, of `sines`; 0 for other surfaces, whose
    /// scatter holds it, and where the recipe states the waves. Absent where it is not known, as for a single window.
    #[schemars(extend("unit" = "1"))]
    pub scan_error: Option<f64>,
    /// Estimated error of the mean by interpolation: the mean of those of the realisations.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// Estimated error of the mean by the grid, the mean of those of the realisations; absent where one
    /// is not known, as for `hybrid` and `fem` where the recipe sets `estimate_mesh_error` to false.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Bound of the change of the mean by waves that most realisations were solved without.
    #[schemars(extend("unit" = "1"))]
    pub left_out_error: f64,
    /// Of `hybrid` the half width of the 95 % confidence interval of the mean by the stretches of the microscale, which all
    /// realisations share: 0 for the microscale of sines. Absent for other models, and for a single stretch.
    #[schemars(extend("unit" = "1"))]
    pub microscale_error: Option<f64>,
    /// Of `multilevel` the bound of the difference to all waves at finite deformation where it solved none, 0
    /// where it did. Of `hybrid` the difference to all waves at finite deformation that this run has, or where
    /// it has none the share of friction that was measured on other surfaces. Absent for other models.
    #[schemars(extend("unit" = "1"))]
    pub model_error: Option<f64>,
    /// Error of the mean, all parts: the half width of the 95 % interval by realisations and scans together, whose variances
    /// add (`combined_95`), `microscale_error` added to it in squares, plus the errors by interpolation, by discretisation, by
    /// waves left out and of the model; absent where one of them is not known.
    #[schemars(extend("unit" = "1"))]
    pub error_estimate: Option<f64>,
    /// Mean pressure, averaged over the realisations where the area is given.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Shortest wavelength that the scans show as it is: two spacings, or what spot or tip of the
    /// instrument resolve; absent where the recipe states the waves. Friction of shorter waves
    /// rests on no measurement.
    #[schemars(extend("unit" = "mm"))]
    pub shortest_reliable_wavelength_mm: Option<f64>,
}

impl FrictionRow {
    /// What it is given for.
    pub(crate) fn condition(&self) -> Condition {
        Condition::of(self.given, self.contact_area_fraction, self.pressure_mpa)
    }
}

impl Row for FrictionRow {
    const SCHEMA: &'static str = "asperity.tables.friction";
    const VERSION: u32 = 7;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![
        FRICTION.schema(),
        BUDGET.schema(),
        COMPARISON.schema(),
        CORRECTIONS.schema(),
        EFFECTS.schema(),
        METHODS.schema(),
        MODELS.schema(),
        THEORIES.schema(),
        TOTAL.schema(),
    ]
}
