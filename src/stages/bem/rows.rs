//! What the stage writes.

use super::Given;
use crate::artifact::{
    ArrayFile, ArraysSchema, AttributeSchema, DatasetSchema, ResultFile, Row, SchemaVersion, Table,
};
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// All solves, of the waves that were not left out: `solves.arrow`.
pub const SOLVES: Table<SolveRow> = Table::new("bem", "solves.arrow");
/// Friction at the wanted contact areas and pressures: `curves.arrow`.
pub const CURVES: Table<CurveRow> = Table::new("bem", "curves.arrow");
/// Pressure and separation on request: `fields.h5`.
pub const FIELDS: ArrayFile = ArrayFile {
    file: ResultFile { stage: "bem", name: "fields.h5" },
    schema: "asperity.bem.fields",
    version: 2,
    description: "pressure and separation over one period of the profile",
};

/// One solved contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SolveRow {
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
    /// Friction coefficient from the hysteretic power of the pressure spectrum; the difference to
    /// the friction coefficient measures the grid.
    #[schemars(extend("unit" = "1"))]
    pub hysteretic_friction: f64,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean separation.
    #[schemars(extend("unit" = "mm"))]
    pub mean_separation_mm: f64,
    /// Estimated error of the friction coefficient by the grid, absolute; absent where coarser grids
    /// do not resolve the contact.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Residual of the contact conditions, relative.
    #[schemars(extend("unit" = "1"))]
    pub residual: f64,
    /// Active-set iterations on the finest grid.
    pub iterations: u64,
    /// Grid points.
    pub grid_points: u64,
    /// Wall time of the solve.
    #[schemars(extend("unit" = "s", "volatile" = true))]
    pub seconds: f64,
}

impl Row for SolveRow {
    const SCHEMA: &'static str = "asperity.bem.solves";
    const VERSION: u32 = 3;
}

/// Friction of one realisation at one wanted contact area or pressure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CurveRow {
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
    /// Mean pressure; interpolated where the area is given.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient; interpolated where the area is given.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// Estimated error of the friction coefficient by interpolation, absolute.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// The larger of the errors by the grid of the two solves that the friction lies between; absent
    /// where one of them is not known.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
    /// Bound of the change of the mean friction by waves that were left out of this realisation; 0
    /// where all are there.
    #[schemars(extend("unit" = "1"))]
    pub left_out_error: f64,
    /// Estimated error by the grid of contact area over pressure, relative; absent where it is not known. Friction by a shear
    /// stress of the contact area has it.
    #[schemars(extend("unit" = "1"))]
    pub relative_area_error: Option<f64>,
}

impl Row for CurveRow {
    const SCHEMA: &'static str = "asperity.bem.curves";
    const VERSION: u32 = 5;
}

/// How many realisations were solved, and of which waves: `realisations.arrow`.
pub const REALISATIONS: Table<RealisationsRow> = Table::new("bem", "realisations.arrow");

/// What the average of one approximation at one speed rests on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RealisationsRow {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Realisations that were solved.
    pub realisations: u32,
    /// Of these with all waves.
    pub with_all_waves: u32,
    /// Wavelengths that the others do without.
    #[schemars(extend("unit" = "mm"))]
    pub left_out_wavelengths_mm: Vec<f64>,
}

impl Row for RealisationsRow {
    const SCHEMA: &'static str = "asperity.bem.realisations";
    const VERSION: u32 = 2;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![
        SOLVES.schema(),
        CURVES.schema(),
        REALISATIONS.schema(),
        super::SCAN_ERRORS.schema(),
        FIELDS.schema(),
    ]
}

/// What [`FIELDS`] holds.
pub fn fields_schema() -> ArraysSchema {
    let attribute = |name, description| AttributeSchema { name, kind: "f64", description };
    let attributes = vec![
        attribute("spacing_m", "distance between neighbouring points"),
        attribute("mean_pressure_pa", "mean pressure of the solve"),
        attribute("wanted_area_fraction", "contact area fraction that the recipe asks for"),
        attribute("contact_area_fraction", "contact area fraction of the solve"),
        attribute("friction_coefficient", "friction coefficient of the solve"),
        attribute("mean_separation_m", "mean separation of the solve"),
    ];
    let dataset = |path, unit, description| DatasetSchema {
        path,
        unit,
        description,
        attributes: attributes.clone(),
    };
    ArraysSchema {
        schema: FIELDS.schema,
        version: FIELDS.version,
        description: FIELDS.description,
        datasets: vec![
            dataset(
                "{surfaces}/realisation_{realisation}/speed_{speed}_mm_s/area_{area}/pressure",
                "Pa",
                "contact pressure, zero outside the contact",
            ),
            dataset(
                "{surfaces}/realisation_{realisation}/speed_{speed}_mm_s/area_{area}/separation",
                "m",
                "separation of rubber and profile, zero in the contact",
            ),
        ],
    }
}
