//! The one function that wires the stages, and the comparison of what is there with what the
//! recipe asks for.

mod plan;

use crate::artifact::{ArtifactError, Identity, Manifest, RunFolder, RunView};
use crate::error_kind::{ErrorKind, HasKind};
use crate::numerics::Interrupt;
use crate::recipe::Recipe;
use crate::requirement::InvalidRecipe;
use crate::stages::ingest::ScanFile;
use crate::stages::{Context, Request, Stage, StageError, Watch};
use plan::Plan;
use serde_json::Value;
use std::path::Path;
use std::time::Instant;

/// Why a stage without any result is stale.
const NOT_COMPUTED: &str = "not computed yet";

/// Which stages to bring up to date.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Selection {
    /// Only this stage; what it reads must be up to date.
    pub only: Option<Stage>,
    /// This stage and those after it; what it reads must be up to date.
    pub from: Option<Stage>,
    /// Compute this stage even if it is up to date.
    pub force: Option<Stage>,
}

/// What happens during a run.
#[derive(Debug)]
pub enum Event<'a> {
    /// A stage is computed.
    Started(Stage),
    /// Pieces of work done, of those known so far.
    Progress(Stage, u64, u64),
    /// A stage has its result.
    Finished(Stage, &'a Manifest),
    /// A stage was up to date; this is the result that is there.
    Fresh(Stage, &'a Manifest),
}

/// Whether a stage has the result that the recipe asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum State {
    /// It has.
    Fresh,
    /// It has none, or another one: why.
    Stale(Vec<String>),
}

/// Why a run ended without its results.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    /// A stage.
    #[error("{stage}: {source}")]
    Stage {
        /// The stage.
        stage: Stage,
        /// Why.
        source: Box<StageError>,
    },
    /// Sections of the recipe that do not go together.
    #[error(transparent)]
    Recipe(#[from] InvalidRecipe),
    /// A selected stage that the recipe does not have.
    #[error("the recipe has no stage {selected}: it has {}", .stages.join(", "))]
    NoSuchStage {
        /// The stage that was asked for.
        selected: Stage,
        /// Those of the recipe.
        stages: Vec<&'static str>,
    },
    /// A stage to be computed in any case that is not to be computed at all.
    #[error(
        "--force {forced} does nothing beside --only and --from that leave {forced} out: give one \
         or the other"
    )]
    ForcedOutside {
        /// The stage that was to be forced.
        forced: Stage,
    },
    /// The run folder.
    #[error(transparent)]
    Artifact(#[from] ArtifactError),
    /// A stage that a selected one reads, through others or not, is not up to date.
    #[error(
        "{selected} needs the results of {stage}, which is stale ({reason}); run without --only \
         and --from, or with --from {stage}"
    )]
    StaleInput {
        /// The first selected stage that needs it.
        selected: Stage,
        /// The stage that is stale.
        stage: Stage,
        /// Why it is.
        reason: String,
    },
}

impl HasKind for PipelineError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Stage { source, .. } => source.kind(),
            Self::Recipe(source) => source.kind(),
            Self::Artifact(source) => source.kind(),
            Self::NoSuchStage { .. } | Self::ForcedOutside { .. } | Self::StaleInput { .. } => {
                ErrorKind::Input
            }
        }
    }
}

impl PipelineError {
    /// Whether the user interrupted.
    pub fn is_interrupt(&self) -> bool {
        self.kind() == ErrorKind::Interrupted
    }
}

/// Brings the selected stages in the folder `out` up to date with the recipe.
///
/// A stage is computed if its key differs from that of the result that is there (see
/// [`Identity::key`]), or a file of that result is damaged. The solves of `bem` are kept one by
/// one, so a stopped run continues where it stopped.
///
/// # Errors
/// [`PipelineError`]; the results of finished stages and single solves are kept.
pub fn run(
    recipe: &Recipe,
    out: &Path,
    selection: Selection,
    interrupted: &Interrupt,
    observer: &(dyn Fn(Event) + Sync),
) -> Result<(), PipelineError> {
    let ready = Ready::new(recipe, out, selection)?;
    ready.run(&RunFolder::open(out)?, interrupted, observer)
}

/// A run that nothing speaks against so far, before it leaves anything behind.
pub struct Ready<'a> {
    plan: Plan<'a>,
    selection: Selection,
}

impl<'a> Ready<'a> {
    /// Reads what the recipe refers to and looks at what is in the folder `out`, which need not be there.
    ///
    /// # Errors
    /// [`PipelineError`], among them [`ArtifactError::Foreign`] for what asperity did not write where a result would go.
    pub fn new(
        recipe: &'a Recipe,
        out: &Path,
        selection: Selection,
    ) -> Result<Self, PipelineError> {
        Self::with_stages(recipe, out, selection, &Stage::ALL)
    }

    /// The same with other stages than those of the program, in the order of the data.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_stages(
        recipe: &'a Recipe,
        out: &Path,
        selection: Selection,
        stages: &'a [Stage],
    ) -> Result<Self, PipelineError> {
        let plan = Plan::new(recipe, None, stages)?;
        plan.check(selection)?;
        check_places(out, selected(&plan, selection))?;
        Ok(Self { plan, selection })
    }

    /// Brings the folder up to date, as [`run`] does.
    ///
    /// # Errors
    /// As [`run`].
    pub fn run(
        &self,
        folder: &RunFolder,
        interrupted: &Interrupt,
        observer: &(dyn Fn(Event) + Sync),
    ) -> Result<(), PipelineError> {
        bring_up_to_date(&self.plan, folder, self.selection, interrupted, observer)
    }
}

/// Fails for what asperity did not write where the results of stages that have none would go. Another result is
/// looked at when it is known that it must give way.
///
/// # Errors
/// [`ArtifactError::Foreign`].
pub fn check_places(
    out: &Path,
    stages: impl IntoIterator<Item = Stage>,
) -> Result<(), ArtifactError> {
    let view = RunView::of(out);
    view.check_solves()?;
    for stage in stages {
        if !matches!(view.stage_manifest(stage.name()), Ok(Some(_))) {
            view.check_place(stage.name())?;
        }
    }
    Ok(())
}

/// The same for a folder that other processes, also on other machines, may bring up to the same recipe at the
/// same time. `scans` are those of the recipe, which are not looked up again.
///
/// # Errors
/// As [`run`].
pub fn run_shared(
    recipe: &Recipe,
    scans: &[ScanFile],
    out: &Path,
    selection: Selection,
    interrupted: &Interrupt,
    observer: &(dyn Fn(Event) + Sync),
) -> Result<(), PipelineError> {
    let plan = Plan::new(recipe, Some(scans), &Stage::ALL)?;
    plan.check(selection)?;
    check_places(out, selected(&plan, selection))?;
    let folder = RunFolder::share(out)?;
    bring_up_to_date(&plan, &folder, selection, interrupted, observer)
}

/// Reads what a recipe refers to, its rubber for one; fails where a run would.
///
/// # Errors
/// As [`run`].
pub fn check(recipe: &Recipe, scans: &[ScanFile]) -> Result<(), PipelineError> {
    Plan::new(recipe, Some(scans), &Stage::ALL).map(drop)
}

/// The stages of a recipe, in the order of the data.
///
/// # Errors
/// [`InvalidRecipe`] for a recipe that is none.
pub fn stages(recipe: &Recipe) -> Result<Vec<Stage>, InvalidRecipe> {
    Ok(plan::stages(&Request::without_files(recipe.job()?), &Stage::ALL))
}

fn selected(plan: &Plan, selection: Selection) -> Vec<Stage> {
    plan.stages().into_iter().filter(|stage| plan.selects(selection, *stage)).collect()
}

fn bring_up_to_date(
    plan: &Plan,
    folder: &RunFolder,
    selection: Selection,
    interrupted: &Interrupt,
    observer: &(dyn Fn(Event) + Sync),
) -> Result<(), PipelineError> {
    let mut checked = false;
    for stage in plan.stages() {
        let in_stage = |source| PipelineError::Stage { stage, source: Box::new(source) };
        let Some(planned) = plan.planned(stage) else { continue };
        let identity = plan.identity(stage, &planned, folder)?;
        let state = state(stage, &identity, folder)?;
        if !plan.selects(selection, stage) {
            let mut selected = selected(plan, selection).into_iter();
            let reader = selected.find(|selected| plan.upstream(*selected).contains(stage.name()));
            if let (State::Stale(reasons), Some(selected)) = (&state, reader) {
                let reason = reasons.join("; ");
                return Err(PipelineError::StaleInput { selected, stage, reason });
            }
            continue;
        }
        if state == State::Fresh
            && selection.force != Some(stage)
            && let Some(manifest) = folder.stage_manifest(stage.name())?
        {
            observer(Event::Fresh(stage, &manifest));
            continue;
        }
        if !checked {
            // Before anything is computed: this stage and those that may follow from it.
            for later in selected(plan, selection) {
                if plan.is_up_to(stage, later) {
                    folder.check_place(later.name())?;
                }
            }
            checked = true;
        }
        observer(Event::Started(stage));
        let start = Instant::now();
        let mut context = Context {
            pending: folder.begin(stage.name())?,
            watch: Watch {
                progress: &|done, total| observer(Event::Progress(stage, done, total)),
                interrupted,
            },
        };
        let afresh = selection.force == Some(stage);
        let warnings = planned.compute(folder, afresh, &mut context).map_err(in_stage)?;
        context.check_interrupt().map_err(in_stage)?;
        let outputs = context.pending.outputs().to_vec();
        let seconds = start.elapsed().as_secs_f64();
        let manifest = Manifest::new(&identity, outputs, warnings, seconds)?;
        context.pending.commit(&manifest)?;
        observer(Event::Finished(stage, &manifest));
    }
    Ok(())
}

/// The state of every stage in the folder `out`, without touching it.
///
/// # Errors
/// [`PipelineError`] for scans, a rubber or a manifest that cannot be read.
pub fn status(recipe: &Recipe, out: &Path) -> Result<Vec<(Stage, State)>, PipelineError> {
    let view = RunView::of(out);
    let plan = Plan::new(recipe, None, &Stage::ALL)?;
    let mut states: Vec<(Stage, State)> = Vec::new();
    for stage in plan.stages() {
        let Some(planned) = plan.planned(stage) else { continue };
        let upstream = plan.upstream(stage);
        let before = states
            .iter()
            .find(|(before, state)| *state != State::Fresh && upstream.contains(before.name()));
        let state = match before {
            // What a stage would read is not known before those it reads from are up to date.
            Some((before, _)) => State::Stale(vec![match view.stage_manifest(stage.name()) {
                Ok(Some(_)) => format!("{before} is stale"),
                Ok(None) => NOT_COMPUTED.into(),
                Err(error) => error.to_string(),
            }]),
            None => state(stage, &plan.identity(stage, &planned, &view)?, &view)?,
        };
        states.push((stage, state));
    }
    Ok(states)
}

/// All that determines the result of every stage, given the results in the folder `out`.
///
/// # Errors
/// As [`status`].
pub fn identities(recipe: &Recipe, out: &Path) -> Result<Vec<Identity>, PipelineError> {
    let view = RunView::of(out);
    let plan = Plan::new(recipe, None, &Stage::ALL)?;
    let planned = plan.stages().into_iter().filter_map(|stage| Some((stage, plan.planned(stage)?)));
    planned.map(|(stage, planned)| Ok(plan.identity(stage, &planned, &view)?)).collect()
}

/// Compares the result that is there with what is asked for.
fn state(stage: Stage, wanted: &Identity, view: &RunView) -> Result<State, ArtifactError> {
    let manifest = match view.stage_manifest(stage.name()) {
        Ok(Some(manifest)) => manifest,
        Ok(None) => return Ok(State::Stale(vec![NOT_COMPUTED.into()])),
        // A manifest that cannot be read is as good as none: the stage is computed again.
        Err(error) => return Ok(State::Stale(vec![error.to_string()])),
    };
    if manifest.key != wanted.key() {
        return Ok(State::Stale(differences(&manifest, wanted)));
    }
    match view.verify(stage.name()) {
        Ok(()) => Ok(State::Fresh),
        Err(error) => Ok(State::Stale(vec![error.to_string()])),
    }
}

/// Why the keys differ, in the words of the recipe.
fn differences(there: &Manifest, wanted: &Identity) -> Vec<String> {
    let mut reasons = Vec::new();
    compare(&wanted.stage, &there.parameters, &wanted.parameters, &mut reasons);
    for input in &wanted.inputs {
        match there.inputs.iter().find(|other| other.name == input.name) {
            None => reasons.push(format!("{} is new", input.name)),
            Some(other) if other.digest != input.digest => {
                reasons.push(format!("{} has changed", input.name));
            }
            Some(_) => {}
        }
    }
    for input in &there.inputs {
        if wanted.inputs.iter().all(|other| other.name != input.name) {
            reasons.push(format!("{} is gone", input.name));
        }
    }
    if there.stage_revision != wanted.stage_revision {
        reasons.push(format!(
            "the stage was revised ({} -> {})",
            there.stage_revision, wanted.stage_revision
        ));
    }
    if reasons.is_empty() {
        reasons.push("the layout of its results has changed".into());
    }
    reasons
}

/// Adds `path: old -> new` for every leaf that differs.
fn compare(path: &str, old: &Value, new: &Value, reasons: &mut Vec<String>) {
    let (Value::Object(old_keys), Value::Object(new_keys)) = (old, new) else {
        if old != new {
            reasons.push(format!("{path}: {} -> {}", shorten(old), shorten(new)));
        }
        return;
    };
    let mut keys: Vec<&String> = old_keys.keys().chain(new_keys.keys()).collect();
    keys.sort_unstable();
    keys.dedup();
    for key in keys {
        let part = |keys: &serde_json::Map<String, Value>| keys.get(key).cloned();
        let (old, new) = (part(old_keys).unwrap_or_default(), part(new_keys).unwrap_or_default());
        // Stages that depend on several sections have their own among their parameters.
        let path = if key == path { path.to_owned() } else { format!("{path}.{key}") };
        compare(&path, &old, &new, reasons);
    }
}

fn shorten(value: &Value) -> String {
    let text = match value {
        Value::Null => return "not set".into(),
        value => value.to_string(),
    };
    if text.chars().count() <= 60 {
        return text;
    }
    text.chars().take(57).chain("...".chars()).collect()
}
