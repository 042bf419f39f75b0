//! The tables of the stage.

use crate::artifact::{Row, SchemaVersion, Table};
use crate::stages::bem::Given;
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Corrected friction: `curves.arrow`.
pub const HYBRID: Table<HybridRow> = Table::new("hybrid", "curves.arrow");
/// The local corrections one by one, in the layout of Table 5.3: `local.arrow`.
pub const LOCAL: Table<LocalRow> = Table::new("hybrid", "local.arrow");

/// Corrected friction of one realisation at one contact area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HybridRow {
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
    /// Contact area fraction of the half-space.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient of the half-space with all waves.
    #[schemars(extend("unit" = "1"))]
    pub friction_half_space: f64,
    /// Corrected friction coefficient by the rule of the recipe; absent where a local pressure is
    /// beyond the sampled microscale.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: Option<f64>,
    /// Friction of the microscale at finite deformation less that on the half-space, the plain mean over the
    /// contact points.
    #[schemars(extend("unit" = "1"))]
    pub correction_points: Option<f64>,
    /// The same by the mean weighted with the local pressures, which conserves force.
    #[schemars(extend("unit" = "1"))]
    pub correction_force: Option<f64>,
    /// Change of the contact area fraction by finite deformation, the mean over all points.
    #[schemars(extend("unit" = "1"))]
    pub correction_of_area: Option<f64>,
    /// Estimated error of the correction by interpolation between the samples.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// Estimated error by the grid of the half-space and the mesh of the microscale; absent where one
    /// of them is not known.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Bound of the change of the mean half-space friction by waves that were left out.
    #[schemars(extend("unit" = "1"))]
    pub left_out_error: f64,
    /// Half width of the 95 % confidence interval of the friction coefficient by the stretches of the microscale, whose
    /// mean it is; 0 for the microscale of sines, absent for a single stretch.
    #[schemars(extend("unit" = "1"))]
    pub microscale_error: Option<f64>,
    /// Share of the macro points that count as contact points: their local pressure is at least
    /// the smallest one sampled.
    #[schemars(extend("unit" = "1"))]
    pub contact_points_fraction: f64,
    /// Share of the load on macro points whose local pressure is beyond full contact of the microscale on
    /// the half-space, where its waves are pressed flat and the correction says least.
    #[schemars(extend("unit" = "1"))]
    pub load_beyond_full_contact: f64,
    /// Largest local pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub largest_pressure_mpa: f64,
    /// Largest sampled pressure of the microscale.
    #[schemars(extend("unit" = "MPa"))]
    pub largest_sample_mpa: f64,
    /// Residual of the macro contact, relative.
    #[schemars(extend("unit" = "1"))]
    pub residual: f64,
}

impl Row for HybridRow {
    const SCHEMA: &'static str = "asperity.hybrid.curves";
    const VERSION: u32 = 4;
}

/// One local correction: the macro points over one period of the microscale, averaged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LocalRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Number of the stretch of the microscale of windows, from 1; 0 for the microscale of sines.
    pub stretch: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// What the value is for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction of the half-space.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Position of the middle.
    #[schemars(extend("unit" = "mm"))]
    pub x_mm: f64,
    /// Local mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient of the microscale at finite deformation.
    #[schemars(extend("unit" = "1"))]
    pub friction_finite_deformation: f64,
    /// Friction coefficient of the microscale on the half-space.
    #[schemars(extend("unit" = "1"))]
    pub friction_half_space: f64,
    /// Their difference.
    #[schemars(extend("unit" = "1"))]
    pub correction: f64,
}

impl Row for LocalRow {
    const SCHEMA: &'static str = "asperity.hybrid.local";
    const VERSION: u32 = 2;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![HYBRID.schema(), LOCAL.schema()]
}
