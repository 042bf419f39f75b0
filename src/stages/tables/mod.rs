//! tables: friction over contact area, averaged over the realisations.
//!
//! | module | what it holds |
//! |---|---|
//! | `accuracy` | whether the averages have the accuracy that the recipe asks for |
//! | `basis` | what the averages rest on: windows, the shortest wavelength, and the errors by both |
//! | `budget` | what the error of every average is made of |
//! | `doubts` | what a reader of the averages should be told |
//! | `methods` | friction of the surfaces that stand for the road beside that of its measured profiles |
//! | `model_error` | how far the hybrid is from what it approximates |
//! | `models` | how far the models of a run are apart |
//! | `multilevel` | the averages of the stage multilevel as rows of the friction tables |
//! | `published` | published tables beside the computed ones |
//! | `rows` | the tables of the stage |
//! | `theories` | what older theories predict at the areas of the half-space |

mod accuracy;
mod basis;
mod budget;
mod doubts;
mod methods;
mod model_error;
mod models;
mod multilevel;
mod published;
mod rows;
mod theories;

use super::approximate::WAVES;
use super::areal::AREAL_CURVES;
use super::bem::{CURVES, Given};
use super::characterise::{RELIABLE_KEY, length_in};
use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::fem;
use super::friction::{Condition, FrictionAt};
use super::hybrid::{self, Hybrid};
use super::realise::{AREAL_SURFACES, read_surfaces};
use super::{Stage, StageError};
use crate::artifact::RunView;
use crate::numerics::statistics::MeanEstimate;
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::RubberModel;
use crate::scans::file::MapLines;
use crate::stages::realise::SurfaceKind;
use accuracy::missed;
use basis::Basis;
use budget::budget;
pub use budget::{BUDGET, BudgetRow, Part};
use doubts::doubts;
pub use methods::{METHODS, MethodRow};
use models::comparisons;
pub use models::{MODELS, ModelRow};
pub use published::{
    COMPARISON, CORRECTIONS, ComparisonRow, CorrectionRow, NOTE_KEY, Published,
    PublishedCorrections, inputs,
};
pub use rows::{FRICTION, FrictionRow, Model, schemas};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;
use theories::predictions;
pub use theories::{THEORIES, Theory, TheoryConstants, TheoryRow};

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 10;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "tables",
    summary: "Averaged friction tables",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let chain = request.chain()?;
    let (tables, rubber) = (chain.tables, request.rubber());
    let models = Models {
        hybrid: chain.micro.map(|micro| Corrected {
            rms_slope_threshold: micro.rms_slope_threshold,
            rules: chain.hybrid,
        }),
        fem: chain.fem.is_some(),
        multilevel: chain.multilevel.is_some(),
        scans: chain.ingest.is_some(),
        angle_deg: chain.areal.angles_deg.first().copied().filter(|_| chain.has_areal_surfaces()),
        layer_mm: chain.areal.thickness_mm,
        lines_deg: match chain.ingest.and_then(|ingest| ingest.map_lines) {
            Some(MapLines::Columns) => 90.0,
            _ => 0.0,
        },
    };
    let mut parameters = json!(tables);
    // Where the published tables are is no parameter: their names and digests are inputs.
    for key in ["published", "published_corrections"] {
        let tables = parameters.get_mut(key).and_then(serde_json::Value::as_array_mut);
        for table in tables.into_iter().flatten().filter_map(serde_json::Value::as_object_mut) {
            table.remove("file");
        }
    }
    parameters["rubber"] = json!(rubber);
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(tables, models, rubber, &inputs.results, context)
    };
    let planned = Planned::new(parameters, run)
        .reading(super::bem::CURVES)
        .reading(super::approximate::WAVES)
        .reading_if(chain.micro.is_some(), super::hybrid::HYBRID)
        .reading_if(chain.fem.is_some(), super::fem::FEM)
        .reading_if(chain.multilevel.is_some(), super::multilevel::AVERAGES)
        .reading_if(chain.multilevel.is_some(), super::multilevel::PAIRS)
        .reading(super::bem::SCAN_ERRORS)
        .reading(super::realise::SURFACES)
        .reading_if(chain.realise.has_windows(), super::realise::PROFILES)
        .reading_if(chain.ingest.is_some(), super::ingest::WINDOWS)
        .reading_if(models.angle_deg.is_some(), super::areal::AREAL_CURVES)
        .reading_if(models.angle_deg.is_some(), super::realise::AREAL_SURFACES)
        .reading_if(!tables.published_corrections.is_empty(), super::micro::SAMPLES);
    Some(planned.with_inputs(request.published.clone()))
}

/// Section `[tables]` of a recipe.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Tables {
    /// Published tables to stand beside the computed ones.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub published: Vec<Published>,
    /// Published corrections of the microscale to stand beside the computed ones.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub published_corrections: Vec<PublishedCorrections>,
    /// What a reader of the comparison should know, in Markdown.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
    /// Older theories to stand beside the models that are solved.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub theories: Vec<Theory>,
    /// What these theories leave to be chosen.
    #[serde(skip_serializing_if = "TheoryConstants::is_default")]
    pub theory_constants: TheoryConstants,
    /// Wanted relative accuracy of the averages, set by the key `tolerance` of the recipe: averages that
    /// miss it are warned of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
}

impl Tables {
    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        let theories = &self.theories;
        let once = theories.iter().enumerate().all(|(i, a)| !theories[..i].contains(a));
        require(once, "tables.theories", theories, "a list without repeats")?;
        self.theory_constants.check()
    }
}

/// The models of a run besides the half-space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Models {
    /// How friction is corrected, if the recipe has a section `[micro]`.
    pub hybrid: Option<Corrected>,
    /// The recipe has a section `[fem]`.
    pub fem: bool,
    /// The recipe has a section `[multilevel]`.
    pub multilevel: bool,
    /// The recipe has scans.
    pub scans: bool,
    /// The first direction of sliding over areal surfaces, if there are any.
    pub angle_deg: Option<f64>,
    /// Thickness in mm of the layer that slides over them; a half-space if there is none.
    pub layer_mm: Option<f64>,
    /// Direction of the lines that are taken from maps.
    pub lines_deg: f64,
}

impl Models {
    /// A warning where maps and profiles that stand beside each other do not slide alike.
    fn unlike_lines(self, compared: &[MethodRow]) -> Option<String> {
        let angle = self.angle_deg?;
        let has = |areal| compared.iter().any(|row| row.kind.method.is_areal() == areal);
        let turned = (angle - self.lines_deg).rem_euclid(180.0) != 0.0;
        if !(has(true) && has(false)) || !turned && self.layer_mm.is_none() {
            return None;
        }
        let layer = self.layer_mm.map_or_else(String::new, |mm| format!(" as a layer of {mm} mm"));
        Some(format!(
            "the rubber slides over areal surfaces at {angle} degrees{layer}, and over profiles at {} degrees as a half-space: \
             ratio_to_measured compares both",
            self.lines_deg
        ))
    }

    /// Above this root mean square slope waves are corrected.
    fn threshold(self) -> Option<f64> {
        self.hybrid.map(|corrected| corrected.rms_slope_threshold)
    }
}

/// How the half-space is corrected by its steepest waves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corrected {
    /// Waves of at most this root mean square slope are left to the half-space.
    pub rms_slope_threshold: f64,
    /// The rules of the correction.
    pub rules: Hybrid,
}

/// Averages the curves and writes the tables; returns warnings.
///
/// # Errors
/// [`StageError::Published`] for a published table that cannot be read; those of the store.
pub fn run(
    parameters: &Tables,
    models: Models,
    rubber: &RubberModel,
    run: &RunView,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let (fitted, metadata) = run.read_table(WAVES)?;
    let half_space = run.rows(CURVES)?;
    let surfaces = read_surfaces(run)?;
    let areal = if models.angle_deg.is_some() { run.rows(AREAL_SURFACES)? } else { Vec::new() };
    let basis = Basis::read(run, &surfaces, &areal, models.scans)?;
    let bem: Vec<FrictionAt> = half_space.iter().map(FrictionAt::from).collect();
    let mut rows = average(Model::Bem, bem.clone());
    if let Some(angle_deg) = models.angle_deg {
        let curves = run.rows(AREAL_CURVES)?;
        let first = curves.iter().filter(|row| row.angle_deg == angle_deg);
        rows.extend(average(Model::Bem, first.map(FrictionAt::from).collect()));
    }
    if models.hybrid.is_some() {
        let hybrid = run.rows(hybrid::HYBRID)?;
        let values = hybrid.iter().filter_map(FrictionAt::corrected).collect();
        rows.extend(average(Model::Hybrid, complete(values, &bem)));
    }
    if models.fem {
        let fem = run.rows(fem::FEM)?;
        let values = fem.iter().map(FrictionAt::from).collect();
        rows.extend(average(Model::Fem, complete(values, &bem)));
    }
    if let Some(corrected) = models.hybrid {
        model_error::add(&mut rows, &fitted, &surfaces, corrected);
    }
    if models.multilevel {
        rows.extend(multilevel::read(run)?);
    }
    let (theories, constants) = (&parameters.theories, &parameters.theory_constants);
    let mut warnings = constants.warnings(theories);
    if !theories.is_empty() {
        let predictions = predictions(theories, constants, rubber, &half_space, run)?;
        for of_one in predictions.chunk_by(|a, b| a.model == b.model) {
            rows.extend(average(of_one[0].model, of_one.iter().map(FrictionAt::from).collect()));
        }
        context.pending.write_rows(THEORIES, &predictions)?;
    }
    basis.complete(&mut rows);
    warnings.extend(doubts(&rows, &surfaces, rubber, models.threshold()));
    warnings.extend(doubts::steep_maps(&areal));
    let reliable = length_in(&metadata, RELIABLE_KEY)?;
    rows.iter_mut().for_each(|row| row.shortest_reliable_wavelength_mm = reliable);
    warnings
        .extend(parameters.tolerance.map_or_else(Vec::new, |tolerance| missed(tolerance, &rows)));
    context.pending.write_rows(FRICTION, &rows)?;
    context.pending.write_rows(BUDGET, &budget(&rows))?;
    let methods = methods::compared(&rows);
    warnings.extend(models.unlike_lines(&methods));
    if methods::differ(&methods) {
        context.pending.write_rows(METHODS, &methods)?;
    }
    if models.hybrid.is_some() || models.fem || models.multilevel || !theories.is_empty() {
        context.pending.write_rows(MODELS, &comparisons(&rows))?;
    }
    published::write(parameters, &rows, &fitted, run, context)?;
    Ok(warnings)
}

/// The values at areas for which every realisation of the half-space has one: an average over some of
/// them would be one over the less pressed ones.
fn complete(values: Vec<FrictionAt>, half_space: &[FrictionAt]) -> Vec<FrictionAt> {
    let counts = |values: &[FrictionAt]| {
        let mut counts = BTreeMap::new();
        values.iter().for_each(|value| *counts.entry(key(value)).or_insert(0) += 1);
        counts
    };
    let (present, wanted): (BTreeMap<_, u32>, _) = (counts(&values), counts(half_space));
    let full = |value: &FrictionAt| Some(&present[&key(value)]) == wanted.get(&key(value));
    values.into_iter().filter(full).collect()
}

/// What the values of one average have in common.
fn key(value: &FrictionAt) -> (SurfaceKind, u64, Condition) {
    (value.curve.kind, value.curve.speed_mm_s.to_bits(), value.condition())
}

/// One row for each kind of surfaces, speed and area or pressure, ascending.
fn average(model: Model, mut curves: Vec<FrictionAt>) -> Vec<FrictionRow> {
    let order = |a: &FrictionAt, b: &FrictionAt| {
        a.curve
            .kind
            .cmp(&b.curve.kind)
            .then(a.curve.speed_mm_s.total_cmp(&b.curve.speed_mm_s))
            .then(a.condition().cmp(&b.condition()))
    };
    curves.sort_by(|a, b| order(a, b).then(a.curve.realisation.cmp(&b.curve.realisation)));
    curves.chunk_by(|a, b| order(a, b).is_eq()).map(|values| row(model, values)).collect()
}

/// An average without what it rests on, see [`Basis::complete`].
fn row(model: Model, curves: &[FrictionAt]) -> FrictionRow {
    let realisations: Vec<f64> = curves.iter().map(|c| c.friction_coefficient).collect();
    let estimate = MeanEstimate::of(&realisations);
    let present = |value: f64| value.is_finite().then_some(value);
    let first = &curves[0];
    let count = curves.len() as f64;
    let mean = |error: fn(&FrictionAt) -> f64| curves.iter().map(error).sum::<f64>() / count;
    let discretisation_error = curves
        .iter()
        .map(|curve| curve.discretisation_error)
        .try_fold(0.0, |sum, error| Some(sum + error? / count));
    let interpolation_error = mean(|curve| curve.interpolation_error);
    let left_out_error = mean(|curve| curve.left_out_error);
    let statistical_error = present(estimate.confidence_95);
    let microscale_error = curves
        .iter()
        .map(|curve| curve.microscale_error)
        .try_fold(0.0, |sum, error| Some(sum + error? / count));
    FrictionRow {
        model,
        kind: first.curve.kind,
        speed_mm_s: first.curve.speed_mm_s,
        given: first.given,
        contact_area_fraction: match first.given {
            Given::Area => first.contact_area_fraction,
            Given::Pressure => mean(|curve| curve.contact_area_fraction),
        },
        shortest_wavelength_mm: 0.0,
        windows: 0,
        realisations,
        half_space_realisations: None,
        mean: estimate.mean,
        standard_deviation: present(estimate.standard_deviation),
        confidence_95: statistical_error,
        scan_error: None,
        interpolation_error,
        discretisation_error,
        left_out_error,
        microscale_error: microscale_error.filter(|_| model == Model::Hybrid),
        model_error: None,
        error_estimate: None,
        pressure_mpa: match first.given {
            Given::Area => mean(|curve| curve.pressure_mpa),
            Given::Pressure => first.pressure_mpa,
        },
        shortest_reliable_wavelength_mm: None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::friction::CurveId;
    use super::*;

    pub(super) fn curve(waves: u32, realisation: u32, area: f64, friction: f64) -> FrictionAt {
        FrictionAt {
            curve: CurveId { kind: SurfaceKind::sines(waves), realisation, speed_mm_s: 10.0 },
            given: Given::Area,
            contact_area_fraction: area,
            pressure_mpa: friction,
            friction_coefficient: friction,
            interpolation_error: friction / 1e3,
            discretisation_error: (realisation < 9).then_some(friction / 2e3),
            left_out_error: 0.0,
            microscale_error: Some(0.0),
        }
    }

    #[test]
    fn an_average_needs_every_realisation() {
        let values = vec![curve(8, 1, 0.05, 1.0), curve(8, 2, 0.05, 2.0), curve(8, 1, 0.1, 1.0)];
        let half_space = [values.clone(), vec![curve(8, 2, 0.1, 1.0)]].concat();
        let complete = complete(values, &half_space);
        assert_eq!(complete.len(), 2);
        assert!(complete.iter().all(|value| value.contact_area_fraction == 0.05));
    }

    #[test]
    fn rows_are_averaged_over_realisations_whatever_their_order() {
        let mut rows = average(
            Model::Bem,
            vec![
                curve(9, 1, 0.1, 7.0),
                curve(8, 2, 0.1, 3.0),
                curve(8, 1, 0.05, 1.5),
                curve(8, 1, 0.1, 1.0),
                curve(8, 2, 0.05, 2.5),
            ],
        );
        assert_eq!(rows.len(), 3);
        assert_eq!(rows[0].realisations, [1.5, 2.5]);
        assert_eq!((rows[1].mean, rows[1].interpolation_error), (2.0, 2e-3));
        // t(0.975, 1) = 12.7062 in every table.
        let expected = 12.7062 * 2.0_f64.sqrt() / 2.0_f64.sqrt();
        approx::assert_relative_eq!(rows[1].confidence_95.unwrap(), expected, max_relative = 1e-5);
        // Means of grid 1e-3 and of interpolation 2e-3, statistics.
        for row in &mut rows {
            row.scan_error = Some(0.0);
            row.error_estimate = basis::sum_of_errors(row);
        }
        approx::assert_relative_eq!(
            rows[1].error_estimate.unwrap(),
            3e-3 + rows[1].confidence_95.unwrap(),
            max_relative = 1e-12
        );
        assert_eq!((rows[2].kind.waves, rows[2].confidence_95), (9, None));
        assert_eq!((rows[2].discretisation_error, rows[2].error_estimate), (Some(3.5e-3), None));
        let unknown = row(Model::Bem, &[curve(8, 1, 0.1, 1.0), curve(8, 9, 0.1, 1.1)]);
        assert_eq!((unknown.discretisation_error, unknown.error_estimate), (None, None));
    }
}
