//! bem: sliding contact of the viscoelastic half-space, for every realisation and speed.

mod curve;

use super::realise::{Surface, read_surfaces};
use super::{Context, StageError, schema_of};
use crate::artifact::{
    ArrayDataset, ArraysSchema, AttributeSchema, DatasetSchema, Metadata, Pending, Row, RunView,
    SchemaVersion, SolveStore, Storage,
};
use crate::contact::CurveValue;
use crate::recipe::{Violation, demand};
use crate::rubber::{Rubber, read_rubber};
use curve::{Curve, FieldSolution};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 3;

/// Section `[bem]` of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bem {
    /// Rubber file.
    pub rubber: PathBuf,
    /// Sliding speeds in mm/s.
    pub speeds_mm_s: Vec<f64>,
    /// Contact area fractions at which friction is wanted, ascending.
    #[serde(default = "published_area_fractions")]
    pub area_fractions: Vec<f64>,
    /// Relative accuracy of friction by interpolation between solved pressures; 1e-3 by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Relative accuracy of friction by the grid: every pressure is solved on doubled grids until their
    /// differences show it. Not set: one grid for all, as the next two keys say, whose error is
    /// estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid_tolerance: Option<f64>,
    /// Grid points per shortest wavelength, at least; the grid is the next power of two.
    #[serde(default = "default_points")]
    pub points_per_shortest_wavelength: u32,
    /// A contact of fewer grid points than this is solved again on twice as many, up to 16 times
    /// as many: small contacts are a few points on a grid that suits large ones.
    #[serde(default = "default_contact_points")]
    pub fewest_contact_points: u32,
    /// Contact area fractions at which pressure and separation are kept as fields; none by
    /// default.
    #[serde(default)]
    pub field_area_fractions: Vec<f64>,
}

fn published_area_fractions() -> Vec<f64> {
    vec![0.002, 0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1]
}

fn default_points() -> u32 {
    64
}

fn default_contact_points() -> u32 {
    100
}

/// Speeds that a recipe may ask for: from below any creep to above any vehicle, and well inside the
/// range of floating-point numbers.
const SPEEDS_MM_S: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

impl Bem {
    pub(crate) fn check(&self) -> Result<(), Violation> {
        let speeds = &self.speeds_mm_s;
        let possible = speeds.iter().all(|v| SPEEDS_MM_S.contains(v));
        let valid = !speeds.is_empty() && possible && no_repeats(speeds);
        demand(valid, "bem.speeds_mm_s", speeds, "speeds from 1e-9 to 1e9, each once")?;
        for (key, areas) in [
            ("bem.area_fractions", &self.area_fractions),
            ("bem.field_area_fractions", &self.field_area_fractions),
        ] {
            let ascending = areas.windows(2).all(|w| w[0] < w[1]);
            let inside = areas.iter().all(|a| *a > 0.0 && *a < 1.0);
            demand(ascending && inside, key, areas, "ascending, between 0 and 1")?;
        }
        let areas = &self.area_fractions;
        demand(!areas.is_empty(), "bem.area_fractions", areas, "at least one")?;
        let range = areas[0]..=areas[areas.len() - 1];
        let fields = &self.field_area_fractions;
        let within = fields.iter().all(|a| range.contains(a));
        demand(
            within,
            "bem.field_area_fractions",
            fields,
            "within the range of bem.area_fractions",
        )?;
        let tolerances = [
            ("bem.tolerance", Some(self.interpolation_tolerance())),
            ("bem.grid_tolerance", self.grid_tolerance),
        ];
        for (key, tolerance) in tolerances.into_iter().filter_map(|(key, t)| Some((key, t?))) {
            demand((1e-6..=0.2).contains(&tolerance), key, tolerance, "between 1e-6 and 0.2")?;
        }
        let points = self.points_per_shortest_wavelength;
        let key = "bem.points_per_shortest_wavelength";
        demand((4..=65536).contains(&points), key, points, "4 to 65536")
    }

    /// Relative accuracy of friction by interpolation.
    pub fn interpolation_tolerance(&self) -> f64 {
        self.tolerance.unwrap_or(1e-3)
    }

    /// The parameters with the rubber itself in place of its file: what the results depend on.
    pub fn resolved(&self, rubber: &Rubber) -> Value {
        let mut value = json!(self);
        value["rubber"] = json!(rubber);
        value
    }
}

fn no_repeats(values: &[f64]) -> bool {
    values.iter().enumerate().all(|(i, a)| values[..i].iter().all(|b| a != b))
}

/// Reads the rubber of a recipe.
///
/// # Errors
/// [`StageError::Rubber`].
pub fn rubber(parameters: &Bem) -> Result<Rubber, StageError> {
    Ok(read_rubber(&parameters.rubber)?)
}

/// All solves: `solves.arrow`.
pub const SOLVES_FILE: &str = "solves.arrow";
/// Friction at the wanted contact areas: `curves.arrow`.
pub const CURVES_FILE: &str = "curves.arrow";
/// Pressure and separation on request: `fields.h5`.
pub const FIELDS_FILE: &str = "fields.h5";
/// Schema name of [`FIELDS_FILE`].
pub const FIELDS_SCHEMA: &str = "asperity.bem.fields";
/// Schema version of [`FIELDS_FILE`].
pub const FIELDS_VERSION: u32 = 1;
const FIELDS_DESCRIPTION: &str = "pressure and separation over one period of the profile";

/// One solved contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SolveRow {
    /// Number of waves of the approximation.
    pub waves: u32,
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
    const VERSION: u32 = 2;
}

/// Friction of one realisation at one wanted contact area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CurveRow {
    /// Number of waves of the approximation.
    pub waves: u32,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
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
    /// The larger of the errors by the grid of the two solves that the friction lies between; absent
    /// where one of them is not known.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
}

impl Row for CurveRow {
    const SCHEMA: &'static str = "asperity.bem.curves";
    const VERSION: u32 = 2;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    let fields = SchemaVersion { schema: FIELDS_SCHEMA.into(), version: FIELDS_VERSION };
    vec![schema_of::<SolveRow>(), schema_of::<CurveRow>(), fields]
}

/// What [`FIELDS_FILE`] holds.
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
        schema: FIELDS_SCHEMA,
        version: FIELDS_VERSION,
        description: FIELDS_DESCRIPTION,
        datasets: vec![
            dataset(
                "waves_{waves}/realisation_{realisation}/speed_{speed}_mm_s/area_{area}/pressure",
                "Pa",
                "contact pressure, zero outside the contact",
            ),
            dataset(
                "waves_{waves}/realisation_{realisation}/speed_{speed}_mm_s/area_{area}/separation",
                "m",
                "separation of rubber and profile, zero in the contact",
            ),
        ],
    }
}

/// Solves the contacts that are not in the store and writes the results; returns warnings.
///
/// Realisations and speeds run side by side; each curve is computed by itself, so the numbers do
/// not depend on the number of threads.
///
/// # Errors
/// [`StageError::Contact`] for a curve that cannot be had, the one that failed first in time;
/// [`StageError::Interrupted`]. Solves that are done are kept in the store.
pub fn run(
    parameters: &Bem,
    rubber: &Rubber,
    run: &RunView,
    store: &SolveStore,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let surfaces = read_surfaces(run)?;
    let tasks: Vec<(&Surface, f64)> = surfaces
        .iter()
        .flat_map(|surface| parameters.speeds_mm_s.iter().map(move |speed| (surface, *speed)))
        .collect();
    let done = AtomicU64::new(0);
    let total = tasks.len() as u64;
    (context.progress)(0, total);
    let results: Vec<CurveResult> = tasks
        .par_iter()
        .map(|(surface, speed)| {
            context.check_interrupt()?;
            let result = one_curve(parameters, rubber, surface, *speed, store, context)?;
            (context.progress)(1 + done.fetch_add(1, Ordering::Relaxed), total);
            Ok(result)
        })
        .collect::<Result<_, StageError>>()?;
    write(&mut context.pending, &results)
}

/// The solves, the curve and the fields of one surface at one speed.
struct CurveResult {
    solves: Vec<SolveRow>,
    values: Vec<CurveRow>,
    fields: Vec<FieldSolution>,
}

fn one_curve(
    parameters: &Bem,
    rubber: &Rubber,
    surface: &Surface,
    speed_mm_s: f64,
    store: &SolveStore,
    context: &Context,
) -> Result<CurveResult, StageError> {
    let mut curve = Curve::new(parameters, rubber, surface, speed_mm_s, store, context.interrupted);
    let (values, fields) = curve.compute(parameters).map_err(|source| {
        if context.check_interrupt().is_err() {
            return StageError::Interrupted;
        }
        let (waves, realisation) = (surface.waves, surface.realisation);
        StageError::Contact { waves, realisation, speed_mm_s, source: Box::new(source) }
    })?;
    let row = |value: &CurveValue| CurveRow {
        waves: surface.waves,
        realisation: surface.realisation,
        speed_mm_s,
        contact_area_fraction: value.contact_area_fraction,
        pressure_mpa: value.mean_pressure / 1e6,
        friction_coefficient: value.friction_coefficient,
        interpolation_error: value.interpolation_error,
        discretisation_error: value.discretisation_error,
    };
    let values = values.iter().map(row).collect();
    Ok(CurveResult { solves: curve.into_solves(), values, fields })
}

fn write(pending: &mut Pending, results: &[CurveResult]) -> Result<Vec<String>, StageError> {
    let none = Metadata::new();
    let solves: Vec<_> = results.iter().flat_map(|r| r.solves.iter().cloned()).collect();
    pending.write_table(SOLVES_FILE, &solves, &none)?;
    let values: Vec<_> = results.iter().flat_map(|r| r.values.iter().cloned()).collect();
    pending.write_table(CURVES_FILE, &values, &none)?;
    let fields: Vec<ArrayDataset> =
        results.iter().flat_map(|r| r.fields.iter().flat_map(FieldSolution::datasets)).collect();
    if !fields.is_empty() {
        let (schema, description) = (FIELDS_SCHEMA, FIELDS_DESCRIPTION);
        let storage = Storage::Compressed;
        pending.write_arrays(FIELDS_FILE, schema, FIELDS_VERSION, description, storage, &fields)?;
    }
    Ok(Vec::new())
}
