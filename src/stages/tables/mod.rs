//! tables: friction over contact area, averaged over the realisations.
//!
//! | module | what it holds |
//! |---|---|
//! | `adhesion` | the shear stress of the contact area: section `[adhesion]` |
//! | `accuracy` | whether the averages have the accuracy that the recipe asks for |
//! | `average` | values of friction of every model, and their averages over the realisations |
//! | `basis` | what the averages rest on: windows, the shortest wavelength, and the errors by both |
//! | `budget` | what the error of every average is made of |
//! | `doubts` | what a reader of the averages should be told |
//! | `effects` | friction with the heat and the strain of the contact beside that without |
//! | `methods` | friction of the surfaces that stand for the road beside that of its measured profiles |
//! | `model_error` | how far the hybrid is from what it approximates |
//! | `models` | how far the models of a run are apart |
//! | `multilevel` | the averages of the stage multilevel as rows of the friction tables |
//! | `published` | published tables beside the computed ones |
//! | `rows` | the tables of the stage |
//! | `theories` | what older theories predict at the areas of the half-space |
//! | `total` | hysteresis and the shear of the contact area together |

mod accuracy;
mod adhesion;
mod average;
mod basis;
mod budget;
mod doubts;
mod effects;
mod methods;
mod model_error;
mod models;
mod multilevel;
mod published;
mod rows;
mod theories;
mod total;

use super::approximate::WAVES;
use super::bem::CURVES;
use super::characterise::{AREAL_PARAMETERS, RELIABLE_KEY, length_in};
use super::contract::{Context, Contract, Inputs, Planned, Request};
pub use super::feedback::Effect;
use super::feedback::{CONTACTS, UNSOLVED};
use super::friction::FrictionAt;
use super::hybrid::Hybrid;
use super::realise::{AREAL_SURFACES, read_surfaces};
use super::{Stage, StageError};
use crate::artifact::RunView;
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::RubberModel;
use crate::scans::file::MapLines;
use accuracy::missed;
pub use adhesion::{Adhesion, Law};
use average::{average, solved};
use basis::Basis;
use budget::budget;
pub use budget::{BUDGET, BudgetRow, Part};
use doubts::doubts;
pub use effects::{EFFECTS, EffectRow};
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
use theories::predictions;
pub use theories::{THEORIES, Theory, TheoryConstants, TheoryRow};
use total::Shear;
pub use total::{TOTAL, TotalRow};

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
        effects: chain.feedback.map(|feedback| feedback.heat.is_some()),
        scans: match (chain.ingest, chain.has_lines()) {
            (None, _) => Scans::None,
            (Some(_), true) => Scans::Lines,
            (Some(_), false) => Scans::MapsAlone,
        },
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
    let adhesion = chain.adhesion.map(|section| (section, chain.bem.temperature_c));
    if let Some((section, temperature_c)) = adhesion {
        parameters["adhesion"] = json!(section);
        parameters["temperature_c"] = json!(temperature_c);
    }
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(tables, models, (rubber, adhesion), &inputs.results, context)
    };
    let planned = Planned::new(parameters, run)
        .reading(super::bem::CURVES)
        .reading_if(!models.maps_alone(), super::approximate::WAVES)
        .reading_if(models.maps_alone(), AREAL_PARAMETERS)
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
        .reading_if(models.effects.is_some(), CONTACTS)
        .reading_if(models.effects.is_some(), UNSOLVED)
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
    /// Whether the contacts of the section `[feedback]` are heated, if the recipe has one.
    pub effects: Option<bool>,
    /// What the recipe has measured of the road.
    pub scans: Scans,
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

    /// Nothing was fitted to lines.
    fn maps_alone(self) -> bool {
        self.scans == Scans::MapsAlone
    }

    /// Above this root mean square slope waves are corrected.
    fn threshold(self) -> Option<f64> {
        self.hybrid.map(|corrected| corrected.rms_slope_threshold)
    }
}

/// What a recipe has measured of the road.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scans {
    /// Nothing: it states the waves.
    None,
    /// Line scans, with or without maps.
    Lines,
    /// Maps, of which no lines are taken.
    MapsAlone,
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
    (rubber, adhesion): (&RubberModel, Option<(&Adhesion, Option<f64>)>),
    run: &RunView,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let (fitted, metadata) = if models.maps_alone() {
        (Vec::new(), run.read_table(AREAL_PARAMETERS)?.1)
    } else {
        run.read_table(WAVES)?
    };
    let half_space = run.rows(CURVES)?;
    let surfaces = read_surfaces(run)?;
    let areal = if models.angle_deg.is_some() { run.rows(AREAL_SURFACES)? } else { Vec::new() };
    let basis = Basis::read(run, &surfaces, &areal, models.scans != Scans::None)?;
    let bem: Vec<FrictionAt> = half_space.iter().map(FrictionAt::from).collect();
    let mut values = solved(models, &bem, &areal, run)?;
    let mut rows: Vec<FrictionRow> =
        values.iter().flat_map(|(model, values)| average(*model, values.clone())).collect();
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
            let predicted: Vec<FrictionAt> = of_one.iter().map(FrictionAt::from).collect();
            rows.extend(average(of_one[0].model, predicted.clone()));
            values.push((of_one[0].model, predicted));
        }
        context.pending.write_rows(THEORIES, &predictions)?;
    }
    basis.complete(&mut rows);
    warnings.extend(doubts(&rows, &surfaces, rubber, models.threshold()));
    warnings.extend(doubts::steep_maps(&areal));
    warnings.extend(doubts::isothermal(&rows, rubber).filter(|_| models.effects != Some(true)));
    let reliable = length_in(&metadata, RELIABLE_KEY)?;
    rows.iter_mut().for_each(|row| row.shortest_reliable_wavelength_mm = reliable);
    warnings
        .extend(parameters.tolerance.map_or_else(Vec::new, |tolerance| missed(tolerance, &rows)));
    context.pending.write_rows(FRICTION, &rows)?;
    context.pending.write_rows(BUDGET, &budget(&rows))?;
    let shear = adhesion.map(|(section, celsius)| Shear::new(section, celsius)).transpose()?;
    if let Some(shear) = &shear {
        let totals = shear.totals(&values, &rows, &basis)?;
        warnings.extend(shear.warnings(&totals));
        context.pending.write_rows(TOTAL, &totals)?;
    }
    if models.effects.is_some() {
        context.pending.write_rows(EFFECTS, &effects::effects(run, shear.as_ref(), &basis)?)?;
    }
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
