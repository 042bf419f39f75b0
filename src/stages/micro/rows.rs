//! The tables of the stage.

use crate::artifact::{Row, SchemaVersion, Table};
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The sampled microscale: `samples.arrow`.
pub const SAMPLES: Table<SampleRow> = Table::new("micro", "samples.arrow");

/// The microscale at one mean pressure, under both models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampleRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1; 0 for a single wave and for stretches, which all realisations share.
    pub realisation: u32,
    /// Number of the stretch of the microscale of windows, from 1; 0 for the microscale of sines.
    pub stretch: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient of the half-space.
    #[schemars(extend("unit" = "1"))]
    pub friction_half_space: f64,
    /// Friction coefficient at finite deformation.
    #[schemars(extend("unit" = "1"))]
    pub friction_finite_deformation: f64,
    /// The same from the heat of the branches; the difference measures the mesh.
    #[schemars(extend("unit" = "1"))]
    pub friction_from_heat: f64,
    /// Contact area fraction of the half-space.
    #[schemars(extend("unit" = "1"))]
    pub area_half_space: f64,
    /// Contact area fraction at finite deformation.
    #[schemars(extend("unit" = "1"))]
    pub area_finite_deformation: f64,
    /// Mean separation of the half-space.
    #[schemars(extend("unit" = "mm"))]
    pub separation_half_space_mm: f64,
    /// Mean separation at finite deformation.
    #[schemars(extend("unit" = "mm"))]
    pub separation_finite_deformation_mm: f64,
    /// Estimated error of the difference of both frictions by interpolation at this sample.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// Estimated error of the friction coefficient at finite deformation by the mesh; absent where the
    /// coarser mesh was not solved.
    #[schemars(extend("unit" = "1"))]
    #[serde(default)]
    pub discretisation_error: Option<f64>,
    /// Residual of the finite-deformation contact, relative.
    #[schemars(extend("unit" = "1"))]
    pub residual: f64,
    /// Newton steps since the sample before.
    pub newton_steps: u64,
    /// Wall time of the solve at finite deformation.
    #[schemars(extend("unit" = "s", "volatile" = true))]
    pub seconds: f64,
}

impl Row for SampleRow {
    const SCHEMA: &'static str = "asperity.micro.samples";
    const VERSION: u32 = 3;
}

/// The repulsive law of the half-space: `law.arrow`.
pub const LAW: Table<LawRow> = Table::new("micro", "law.arrow");

/// Mean separation of the microscale on the half-space at one mean pressure; the last one of a
/// curve is full contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LawRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1; 0 for a single wave and for stretches, which all realisations share.
    pub realisation: u32,
    /// Number of the stretch of the microscale of windows, from 1; 0 for the microscale of sines.
    pub stretch: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Separation at first touch: the largest height above the mean.
    #[schemars(extend("unit" = "m"))]
    pub touch_separation_m: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "Pa"))]
    pub pressure_pa: f64,
    /// Mean separation.
    #[schemars(extend("unit" = "m"))]
    pub separation_m: f64,
}

impl Row for LawRow {
    const SCHEMA: &'static str = "asperity.micro.law";
    const VERSION: u32 = 2;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![SAMPLES.schema(), LAW.schema()]
}
