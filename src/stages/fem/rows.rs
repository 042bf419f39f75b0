//! The tables of the stage.

use crate::artifact::{Row, SchemaVersion, Table};
use crate::stages::bem::Given;
use crate::stages::friction::Condition;
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Friction at the wanted contact areas: `curves.arrow`.
pub const FEM: Table<FemCurveRow> = Table::new("fem", "curves.arrow");
/// All solves: `solves.arrow`.
pub const FEM_SOLVES: Table<FemSolveRow> = Table::new("fem", "solves.arrow");

/// Friction of one realisation at one wanted contact area, at finite deformation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FemCurveRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// What the value is for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure, interpolated.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient, interpolated.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// Estimated error of the friction coefficient by interpolation, absolute.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// Estimated error of the friction coefficient by the mesh: its difference to that on half the
    /// columns at the same area, three times the error where friction converges with their square; absent
    /// where that is not solved.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
}

impl FemCurveRow {
    /// What it is given for.
    pub(super) fn condition(&self) -> Condition {
        Condition::of(self.given, self.contact_area_fraction, self.pressure_mpa)
    }
}

impl Row for FemCurveRow {
    const SCHEMA: &'static str = "asperity.fem.curves";
    const VERSION: u32 = 3;
}

/// One solved contact at finite deformation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FemSolveRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// The same from the heat of the branches; the difference measures the mesh.
    #[schemars(extend("unit" = "1"))]
    pub friction_from_heat: f64,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean separation.
    #[schemars(extend("unit" = "mm"))]
    pub mean_separation_mm: f64,
    /// Friction coefficient on half the columns, where the solution was reached from there.
    #[schemars(extend("unit" = "1"))]
    pub coarser_friction_coefficient: Option<f64>,
    /// Contact area fraction on half the columns, likewise.
    #[schemars(extend("unit" = "1"))]
    pub coarser_contact_area_fraction: Option<f64>,
    /// Residual, relative.
    #[schemars(extend("unit" = "1"))]
    pub residual: f64,
    /// Newton steps since the solve before.
    pub newton_steps: u64,
    /// Columns of the mesh.
    pub columns: u64,
    /// Wall time of the solve.
    #[schemars(extend("unit" = "s", "volatile" = true))]
    pub seconds: f64,
}

impl Row for FemSolveRow {
    const SCHEMA: &'static str = "asperity.fem.solves";
    const VERSION: u32 = 3;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![FEM.schema(), FEM_SOLVES.schema()]
}
