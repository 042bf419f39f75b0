//! The tables of the stage.

use crate::artifact::{
    ArrayFile, ArraysSchema, AttributeSchema, DatasetSchema, ResultFile, Row, SchemaVersion, Table,
};
use crate::stages::bem::Given;
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// All solves: `solves.arrow`.
pub const AREAL_SOLVES: Table<ArealSolveRow> = Table::new("areal", "solves.arrow");
/// Friction at the contact areas and pressures of the recipe: `curves.arrow`.
pub const AREAL_CURVES: Table<ArealCurveRow> = Table::new("areal", "curves.arrow");
/// Contact areas and pressures of the recipe that a curve has no value for: `unsolved.arrow`.
pub const AREAL_UNSOLVED: Table<ArealUnsolvedRow> = Table::new("areal", "unsolved.arrow");
/// Pressure and separation on request: `fields.h5`.
pub const AREAL_FIELDS: ArrayFile = ArrayFile {
    file: ResultFile { stage: "areal", name: "fields.h5" },
    schema: "asperity.areal.fields",
    version: 1,
    description: "pressure and separation over one period of areal surfaces",
};

/// One solved contact of an areal surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ArealSolveRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Direction of sliding from x towards y.
    #[schemars(extend("unit" = "deg"))]
    pub angle_deg: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient, against the direction of sliding.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// Force across the direction of sliding over the load, positive to its left.
    #[schemars(extend("unit" = "1"))]
    pub lateral_coefficient: f64,
    /// Friction coefficient from the hysteretic power of the pressure spectrum; the difference to the friction coefficient
    /// measures the grid.
    #[schemars(extend("unit" = "1"))]
    pub hysteretic_friction: f64,
    /// Contact area fraction, with edges between the grid points.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean separation.
    #[schemars(extend("unit" = "mm"))]
    pub mean_separation_mm: f64,
    /// Estimated error of the friction coefficient by the grid, absolute; absent where coarser grids do not resolve the
    /// contact.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Residual of the contact conditions, relative.
    #[schemars(extend("unit" = "1"))]
    pub residual: f64,
    /// Active-set iterations on the finest grid.
    pub iterations: u64,
    /// Points along x.
    pub points_x: u64,
    /// Points along y.
    pub points_y: u64,
    /// Wall time of the solve.
    #[schemars(extend("unit" = "s", "volatile" = true))]
    pub seconds: f64,
}

impl Row for ArealSolveRow {
    const SCHEMA: &'static str = "asperity.areal.solves";
    const VERSION: u32 = 1;
}

/// Friction of one areal surface at one contact area or pressure of the recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ArealCurveRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Direction of sliding from x towards y.
    #[schemars(extend("unit" = "deg"))]
    pub angle_deg: f64,
    /// What the value is for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure; interpolated where the area is given.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient; interpolated where the area is given.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// Estimated error of the friction coefficient by interpolation, absolute.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// The larger of the errors by the grid of the two solves that the friction lies between; absent where one of them is
    /// not known.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Estimated error by the grid of contact area over pressure, relative; absent where it is not known. Friction by a shear
    /// stress of the contact area has it.
    #[schemars(extend("unit" = "1"))]
    pub relative_area_error: Option<f64>,
}

impl Row for ArealCurveRow {
    const SCHEMA: &'static str = "asperity.areal.curves";
    const VERSION: u32 = 2;
}

/// A contact area or pressure of the recipe at which one areal surface has no friction, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ArealUnsolvedRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Direction of sliding from x towards y.
    #[schemars(extend("unit" = "deg"))]
    pub angle_deg: f64,
    /// What was asked for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction that was asked for; absent where it was a pressure.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: Option<f64>,
    /// Mean pressure that was asked for; absent where it was an area.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: Option<f64>,
    /// Why there is no value.
    pub reason: String,
}

impl Row for ArealUnsolvedRow {
    const SCHEMA: &'static str = "asperity.areal.unsolved";
    const VERSION: u32 = 1;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![
        AREAL_SOLVES.schema(),
        AREAL_CURVES.schema(),
        AREAL_UNSOLVED.schema(),
        AREAL_FIELDS.schema(),
    ]
}

/// What [`AREAL_FIELDS`] holds.
pub fn areal_fields_schema() -> ArraysSchema {
    let attribute = |name, kind, description| AttributeSchema { name, kind, description };
    let attributes = vec![
        attribute("points_x", "i64", "points along x"),
        attribute("points_y", "i64", "points along y"),
        attribute("period_x_m", "f64", "period along x"),
        attribute("period_y_m", "f64", "period along y"),
        attribute("angle_deg", "f64", "direction of sliding from x towards y"),
        attribute("speed_mm_s", "f64", "sliding speed"),
        attribute("method", "string", "how the surface is made of the road"),
        attribute("realisation", "i64", "number of the realisation"),
        attribute("mean_pressure_pa", "f64", "mean pressure of the solve"),
        attribute("contact_area_fraction", "f64", "contact area fraction of the solve"),
        attribute("friction_coefficient", "f64", "friction coefficient of the solve"),
    ];
    let dataset = |path, unit, description| DatasetSchema {
        path,
        unit,
        description,
        attributes: attributes.clone(),
    };
    ArraysSchema {
        schema: AREAL_FIELDS.schema,
        version: AREAL_FIELDS.version,
        description: AREAL_FIELDS.description,
        datasets: vec![
            dataset(
                "{surfaces}/realisation_{realisation}/speed_{speed}_mm_s/angle_{angle}/area_{area}/pressure",
                "Pa",
                "contact pressure row by row, x fastest, zero outside the contact",
            ),
            dataset(
                "{surfaces}/realisation_{realisation}/speed_{speed}_mm_s/angle_{angle}/area_{area}/separation",
                "m",
                "separation of rubber and surface row by row, zero in the contact",
            ),
        ],
    }
}
