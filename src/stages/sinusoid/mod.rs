//! sinusoid: one sine wave under three models, over eight decades of speed (thesis, chapter 4).
//!
//! | module | what it does |
//! |---|---|
//! | `rows` | the tables |
//! | `problem` | one wave, model, speed and mesh: solved or read from the store |
//! | `points` | two meshes to a value with its mesh error |
//! | `conclusions` | friction maxima, and how far the models agree |

mod conclusions;
mod points;
mod problem;
mod rows;

pub use conclusions::Quantity;
pub use problem::Model;
pub use rows::{AgreementRow, AsymptoteRow, FieldRow, Limit, PeakRow, PointRow};

use super::contract::{Context, Contract, Inputs, Job, Planned, Request};
use super::kept::Tally;
use super::{Stage, StageError};
use crate::artifact::{SchemaVersion, SolveStore, Table};
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::{Rubber, RubberData, read_rubber};
use points::{Case, Scale};
use problem::{Outcome, Problem};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 5;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "sinusoid",
    summary: "Three models on one sine; no part of the chain",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let Job::Sinusoid(study) = request.job else { return None };
    // `rubber` refuses a table before this.
    let rubber = request.rubber().maxwell().ok()?;
    let run =
        move |inputs: &Inputs, context: &mut Context| run(study, rubber, &inputs.store()?, context);
    Some(Planned::new(study.resolved(rubber), run))
}

/// Section `[sinusoid]` of a recipe, which stands alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sinusoid {
    /// Rubber file.
    #[serde(with = "crate::files::name::path")]
    #[schemars(with = "String")]
    pub rubber: PathBuf,
    /// Wavelength L of the sine in mm; also the period of the block.
    pub wavelength_mm: f64,
    /// Aspect ratios D/L, amplitude over wavelength; the root mean square slope is √2 π D/L.
    pub aspect_ratios: Vec<f64>,
    /// Sliding speeds in mm/s, ascending.
    pub speeds_mm_s: Vec<f64>,
    /// Mean pressure in MPa.
    pub pressure_mpa: f64,
    /// Columns of the finer of two finite-element meshes; the coarser has half as many.
    #[serde(default = "default_columns")]
    pub columns: u32,
    /// Points of the finer of two grids of the half-space; the coarser has half as many.
    #[serde(default = "default_half_space_points")]
    pub half_space_points: u32,
    /// Relative differences up to which two models are said to agree.
    #[serde(default = "default_levels")]
    pub agreement_levels: Vec<f64>,
    /// Where pressure and separation are kept as fields; nowhere if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fields: Option<Fields>,
    /// Friction against pressure; none if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_dependence: Option<PressureDependence>,
}

/// Section `[sinusoid.fields]`: the points of the sweep at which fields are kept, for all models.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fields {
    /// Aspect ratios, each also in `sinusoid.aspect_ratios`.
    pub aspect_ratios: Vec<f64>,
    /// Speeds in mm/s, each also in `sinusoid.speeds_mm_s`.
    pub speeds_mm_s: Vec<f64>,
}

/// Section `[sinusoid.pressure_dependence]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressureDependence {
    /// Aspect ratio D/L.
    pub aspect_ratio: f64,
    /// Sliding speeds in mm/s.
    pub speeds_mm_s: Vec<f64>,
    /// Mean pressures in MPa, ascending.
    pub pressures_mpa: Vec<f64>,
}

fn default_columns() -> u32 {
    192
}

fn default_half_space_points() -> u32 {
    4096
}

fn default_levels() -> Vec<f64> {
    vec![0.05, 0.1]
}

fn ascending(values: &[f64], range: std::ops::RangeInclusive<f64>) -> bool {
    !values.is_empty()
        && values.iter().all(|value| range.contains(value))
        && values.windows(2).all(|pair| pair[0] < pair[1])
}

impl Sinusoid {
    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        let wavelength = self.wavelength_mm;
        let key = "sinusoid.wavelength_mm";
        require((1e-6..=1e6).contains(&wavelength), key, wavelength, "between 1e-6 and 1e6")?;
        check_list("sinusoid.aspect_ratios", &self.aspect_ratios, 1e-4..=1.0, RATIOS)?;
        check_list("sinusoid.speeds_mm_s", &self.speeds_mm_s, 1e-9..=1e9, SPEEDS)?;
        let pressure = self.pressure_mpa;
        let key = "sinusoid.pressure_mpa";
        require((1e-6..=1e4).contains(&pressure), key, pressure, "between 1e-6 and 1e4")?;
        let columns = self.columns;
        let even = columns.is_multiple_of(2) && (16..=4096).contains(&columns);
        require(even, "sinusoid.columns", columns, "even, 16 to 4096")?;
        let points = self.half_space_points;
        let even = points.is_multiple_of(2) && (64..=1 << 20).contains(&points);
        require(even, "sinusoid.half_space_points", points, "even, 64 to 1048576")?;
        let levels = "at least one, ascending, from 1e-4 to 1";
        check_list("sinusoid.agreement_levels", &self.agreement_levels, 1e-4..=1.0, levels)?;
        self.fields.as_ref().map_or(Ok(()), |fields| self.check_fields(fields))?;
        self.pressure_dependence.as_ref().map_or(Ok(()), PressureDependence::check)
    }

    fn check_fields(&self, fields: &Fields) -> Result<(), InvalidRecipe> {
        for (key, wanted, swept) in [
            ("sinusoid.fields.aspect_ratios", &fields.aspect_ratios, &self.aspect_ratios),
            ("sinusoid.fields.speeds_mm_s", &fields.speeds_mm_s, &self.speeds_mm_s),
        ] {
            let known = wanted.iter().all(|value| swept.contains(value));
            require(known, key, wanted, "values of the same key of [sinusoid]")?;
        }
        Ok(())
    }

    /// The parameters with the rubber itself in place of its file: what the results depend on.
    pub fn resolved(&self, rubber: &Rubber) -> Value {
        let mut value = json!(self);
        value["rubber"] = json!(rubber);
        value
    }

    fn keeps_fields(&self, aspect_ratio: f64, speed_mm_s: f64) -> bool {
        self.fields.as_ref().is_some_and(|fields| {
            fields.aspect_ratios.contains(&aspect_ratio) && fields.speeds_mm_s.contains(&speed_mm_s)
        })
    }
}

const RATIOS: &str = "at least one, ascending, from 1e-4 to 1";
const SPEEDS: &str = "at least one, ascending, from 1e-9 to 1e9";

impl PressureDependence {
    fn check(&self) -> Result<(), InvalidRecipe> {
        let ratio = [self.aspect_ratio];
        let key = "sinusoid.pressure_dependence.aspect_ratio";
        check_list(key, &ratio, 1e-4..=1.0, "between 1e-4 and 1")?;
        let key = "sinusoid.pressure_dependence.speeds_mm_s";
        check_list(key, &self.speeds_mm_s, 1e-9..=1e9, SPEEDS)?;
        let key = "sinusoid.pressure_dependence.pressures_mpa";
        let pressures = "at least one, ascending, from 1e-6 to 1e4";
        check_list(key, &self.pressures_mpa, 1e-6..=1e4, pressures)
    }
}

fn check_list(
    key: &'static str,
    values: &[f64],
    range: std::ops::RangeInclusive<f64>,
    wanted: &'static str,
) -> Result<(), InvalidRecipe> {
    require(ascending(values, range), key, values, wanted)
}

/// Reads the rubber of a recipe.
///
/// # Errors
/// [`StageError::Rubber`]; [`StageError::NoRelaxation`] for an elastic one.
pub fn rubber(parameters: &Sinusoid) -> Result<Rubber, StageError> {
    let rubber = read_rubber(&parameters.rubber)?;
    if rubber.branches.is_empty() {
        return Err(StageError::NoRelaxation { rubber: rubber.name });
    }
    Ok(rubber)
}

/// Friction, contact area and separation against speed: `points.arrow`.
pub const POINTS: Table<PointRow> = Table::new("sinusoid", "points.arrow");
/// The same against pressure, where the recipe asks for it: `pressures.arrow`.
pub const PRESSURES: Table<PointRow> = Table::new("sinusoid", "pressures.arrow");
/// Elastic limits of slow and fast sliding: `asymptotes.arrow`.
pub const ASYMPTOTES: Table<AsymptoteRow> = Table::new("sinusoid", "asymptotes.arrow");
/// Pressure and separation, where the recipe asks for them: `fields.arrow`.
pub const FIELDS: Table<FieldRow> = Table::new("sinusoid", "fields.arrow");
/// The maximum of friction over speed: `peaks.arrow`.
pub const PEAKS: Table<PeakRow> = Table::new("sinusoid", "peaks.arrow");
/// How far the models agree with the neo-Hookean one: `agreement.arrow`.
pub const AGREEMENT: Table<AgreementRow> = Table::new("sinusoid", "agreement.arrow");

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![POINTS.schema(), ASYMPTOTES.schema(), FIELDS.schema(), PEAKS.schema(), AGREEMENT.schema()]
}

/// Solves what is not in the store and writes the tables; returns warnings.
///
/// All solves are independent of each other, so the numbers depend neither on the number of
/// threads nor on interruptions.
///
/// # Errors
/// [`StageError::Solve`] for a problem that is not well posed; one that has no solution is a row
/// that says so. [`StageError::Interrupted`]; solves that are done are kept in the store.
pub fn run(
    parameters: &Sinusoid,
    rubber: &Rubber,
    store: &SolveStore,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let sweep = Case::sweep(parameters);
    let pressures = Case::pressures(parameters);
    let cases: Vec<&Case> = sweep.iter().chain(&pressures).collect();
    let outcomes = solve_all(&cases, rubber, store, context)?;
    let (swept, pressed) = outcomes.split_at(sweep.len());

    let scale = Scale::of(rubber, parameters.wavelength_mm);
    let points = points::rows(&sweep, swept, &scale);
    let asymptotes = points::asymptotes(parameters, rubber);
    let peaks = conclusions::peaks(&points);
    let agreement = conclusions::agreement(&points, &parameters.agreement_levels);
    let pending = &mut context.pending;
    pending.write_rows(POINTS, &points)?;
    pending.write_rows(ASYMPTOTES, &asymptotes)?;
    pending.write_rows(PEAKS, &peaks)?;
    pending.write_rows(AGREEMENT, &agreement)?;
    if parameters.fields.is_some() {
        let fields = points::fields(&sweep, swept, &scale);
        pending.write_rows(FIELDS, &fields)?;
    }
    let mut warnings = RubberData::from(rubber.clone()).oddities();
    if !rubber.finite_strain.is_default() {
        warnings.push(format!(
            "rubber {}: its law at finite strain, {}, is left out, since this study compares the half-space, the \
             linear law and neo-Hooke; `solve fem` and the stages micro, fem and multilevel use it",
            rubber.name,
            rubber.finite_strain.name()
        ));
    }
    warnings.extend(warning("the sweep", &points));
    if parameters.pressure_dependence.is_some() {
        let rows = points::rows(&pressures, pressed, &scale);
        pending.write_rows(PRESSURES, &rows)?;
        warnings.extend(warning("the dependence on pressure", &rows));
    }
    Ok(warnings)
}

/// The outcomes of each case on the finer and the coarser mesh.
type TwoMeshes = [Vec<Outcome>; 2];

fn solve_all(
    cases: &[&Case],
    rubber: &Rubber,
    store: &SolveStore,
    context: &Context,
) -> Result<Vec<TwoMeshes>, StageError> {
    let solve = |problem: &&Problem| {
        problem.outcomes(rubber, store, context.watch.interrupted).map_err(|error| {
            let problem = problem.to_string();
            error.in_stage(|source| StageError::Solve { problem, source })
        })
    };
    let problems: Vec<&Problem> =
        cases.iter().flat_map(|case| [&case.finer, &case.coarser]).collect();
    let tally = Tally::new(context.watch);
    let outcomes = tally.side_by_side(&problems, problems.len() as u64, solve)?;
    let mut outcomes = outcomes.into_iter();
    Ok(std::iter::from_fn(|| Some([outcomes.next()?, outcomes.next()?])).collect())
}

/// How many points have no solution, if any.
fn warning(what: &str, rows: &[PointRow]) -> Option<String> {
    let missing = rows.iter().filter(|row| row.friction_coefficient.is_none()).count();
    (missing > 0).then(|| format!("{missing} of {} points of {what} have no solution", rows.len()))
}
