//! From the solves of all shards to the tables of all cases.

use super::layout::{Layout, RECIPE_FILE};
use super::plan::{PlannedTask, ShardTasks, SweepPlan, Wanted};
use super::prepare::{of_case, scan_digests, scans};
use super::slurm::shell_path;
use super::table::{FRICTION, SweepFrictionRow};
use super::{Prepared, STAGE, SweepError};
use crate::artifact::{
    ArtifactError, Digest, Identity, Input, Manifest, RunFolder, RunView, SolveStore, TOOL_VERSION,
    write_by_rename,
};
use crate::pipeline::{self, Selection};
use crate::recipe::{Case, Recipe};
use crate::stages;
use crate::stages::Watch;
use crate::stages::tables::{self};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Revision of the tables of a sweep.
const REVISION: u32 = 1;
/// Lines of an error that lists shards.
const MOST_LINES: usize = 20;

/// What of a shard is there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShardState {
    /// Number of the shard, from 0.
    pub shard: usize,
    /// Its tasks.
    pub tasks: usize,
    /// Those whose solves are not there.
    pub missing: Vec<MissingTask>,
}

/// A task whose solves are not there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MissingTask {
    /// Folder of the case that wants it, the first of several.
    pub case: String,
    /// What it is.
    pub task: String,
    /// Why its solves count as missing.
    pub why: String,
    /// Digest under which they are kept.
    pub problem: Digest,
}

impl std::fmt::Display for MissingTask {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}, {}: {}", self.case, self.task, self.why)
    }
}

/// Looks up the solves of every task of the plan at `path`.
///
/// # Errors
/// [`SweepError::BadPlan`]; those of the store for a file that cannot be read at all.
pub fn states(path: &Path, plan: &SweepPlan) -> Result<Vec<ShardState>, SweepError> {
    let cases = plan.recipe.cases()?;
    let store = SolveStore::open_packed(Layout::of_plan(path)?.solves())?;
    (0..plan.shards.len())
        .into_par_iter()
        .map(|shard| {
            let list = ShardTasks::read(path, plan, shard)?;
            let missing = list.tasks.iter().filter_map(|task| missing(task, &cases, &store));
            Ok(ShardState { shard, tasks: list.tasks.len(), missing: missing.collect() })
        })
        .collect()
}

/// Why the solves of a task are not there; none if they are.
fn missing(planned: &PlannedTask, cases: &[Case], store: &SolveStore) -> Option<MissingTask> {
    let why =
        refusal(&planned.problem, store).or_else(|| match store.pack_info(&planned.problem) {
            Ok(Some(pack)) if pack.finished.contains(&planned.key) => None,
            Ok(Some(_)) => Some("not finished".into()),
            _ => Some("not solved".into()),
        })?;
    let case = cases.get(planned.case).map(|case| case.folder.display().to_string());
    Some(MissingTask {
        case: case.unwrap_or_default(),
        task: planned.task.name(),
        why,
        problem: planned.problem,
    })
}

/// Fails unless the solves of all tasks of the plan are there.
///
/// # Errors
/// [`SweepError::Incomplete`] names shards and tasks without solves.
pub fn check(path: &Path, plan: &SweepPlan) -> Result<(), SweepError> {
    let states = states(path, plan)?;
    let missing: usize = states.iter().map(|state| state.missing.len()).sum();
    if missing == 0 {
        return Ok(());
    }
    let lines = lines(path, &states);
    Err(SweepError::Incomplete { missing, tasks: plan.tasks(), lines })
}

/// Checks that the solves of all tasks of the plan are there and computes the remaining stages of all cases and
/// the tables of the sweep; returns the manifest of these tables.
///
/// Tasks that follow from the results, as the microscales, are solved here; whoever wants them in shards
/// plans again before (the plan then lists them).
///
/// # Errors
/// Those of [`check`]; those of the stages.
pub fn collect(
    path: &Path,
    plan: &SweepPlan,
    cases: Cases,
    watch: Watch,
) -> Result<Manifest, SweepError> {
    if cases == Cases::All {
        check(path, plan)?;
    }
    let found = scan_digests(&scans(&plan.recipe.cases()?)?);
    if let Some((specimen, _)) =
        found.iter().find(|(name, digest)| plan.scans.get(*name) != Some(*digest))
    {
        let specimen = if specimen.is_empty() { "the recipe" } else { specimen }.to_owned();
        return Err(SweepError::ScansChanged { specimen });
    }
    let prepared = Prepared::new(&plan.recipe, Layout::of_plan(path)?, watch)?;
    for (case, material) in prepared.cases.iter().zip(&prepared.material_of) {
        if plan.rubbers.get(*material) != Some(&prepared.materials[*material].rubber) {
            let path = case.recipe.bem.as_ref().map(|bem| bem.rubber.clone()).unwrap_or_default();
            return Err(SweepError::RubberChanged { path });
        }
    }
    let store = SolveStore::open_packed(prepared.layout.solves())?;
    let missing = prepared.missing(&store, watch)?;
    if cases == Cases::All {
        refuse_foreign(&missing, &prepared.cases, &store)?;
    }
    let mut open = BTreeSet::new();
    if cases == Cases::Complete {
        // Of all cases, since one task may be that of several.
        open.extend(missing.into_iter().map(|wanted| wanted.case));
        if open.len() == prepared.cases.len() {
            return Err(SweepError::NoCompleteCase { cases: open.len() });
        }
    }
    finish(&prepared, &open, watch)
}

/// Fails if solves that an earlier plan asked for are damaged or of another version of the tool: solved anew
/// here they would do, but nobody expects that of a collection. What is not there at all follows from results.
fn refuse_foreign(
    missing: &[Wanted],
    cases: &[Case],
    store: &SolveStore,
) -> Result<(), SweepError> {
    let refused: Vec<String> = missing
        .iter()
        .filter_map(|wanted| {
            let why = refusal(&wanted.problem, store)?;
            let case = cases[wanted.case].folder.display();
            Some(format!("  {case}, {}: {why}", wanted.task.name()))
        })
        .collect();
    if refused.is_empty() {
        return Ok(());
    }
    let mut lines: Vec<String> = refused.iter().take(MOST_LINES).cloned().collect();
    lines.push("plan again: the plan lists them; run its shards, then collect".into());
    Err(SweepError::Incomplete { missing: refused.len(), tasks: missing.len(), lines })
}

/// Why the solves of a problem that are there are not to be used; none if they are or if there are none.
fn refusal(problem: &Digest, store: &SolveStore) -> Option<String> {
    match store.pack_info(problem) {
        Ok(Some(pack)) if pack.tool_version != TOOL_VERSION => Some(format!(
            "solved by asperity {}, this is {TOOL_VERSION}: {}",
            pack.tool_version,
            store.pack_path(problem).display()
        )),
        Ok(_) => None,
        Err(error) => Some(error.to_string()),
    }
}

/// Which cases the tables of a sweep are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cases {
    /// All of them, or there are no tables.
    All,
    /// Those whose solves are all there; a warning names the others.
    Complete,
}

/// A line for each shard that is not complete, and how to complete it.
fn lines(path: &Path, states: &[ShardState]) -> Vec<String> {
    let open: Vec<&ShardState> = states.iter().filter(|state| !state.missing.is_empty()).collect();
    let mut lines: Vec<String> = open
        .iter()
        .take(MOST_LINES)
        .map(|state| {
            let (count, tasks) = (state.missing.len(), state.tasks);
            format!("  shard {}: {count} of {tasks} ({})", state.shard, state.missing[0])
        })
        .collect();
    if open.len() > MOST_LINES {
        lines.push(format!("  and {} more shards", open.len() - MOST_LINES));
    }
    let shard = open.first().map_or(0, |state| state.shard);
    lines.push(format!(
        "run them again, such as `asperity sweep run {} --shard {shard}`, then collect",
        shell_path(path)
    ));
    lines
}

/// Computes all cases of a recipe in a folder, without plan and shards.
///
/// # Errors
/// [`SweepError`].
pub fn run(recipe: &Recipe, out: &Path, watch: Watch) -> Result<Manifest, SweepError> {
    let prepared = Prepared::new(recipe, Layout::new(out), watch)?;
    finish(&prepared, &BTreeSet::new(), watch)
}

/// Computes all cases but those left out, which are named in a warning, and writes the tables.
fn finish(
    prepared: &Prepared,
    left_out: &BTreeSet<usize>,
    watch: Watch,
) -> Result<Manifest, SweepError> {
    let begin = Instant::now();
    let (done, total) = (AtomicU64::new(0), prepared.cases.len() as u64);
    SolveStore::open(prepared.layout.solves())?;
    let of_cases: Vec<(Input, Vec<SweepFrictionRow>)> = prepared
        .cases
        .par_iter()
        .enumerate()
        .filter(|(number, _)| !left_out.contains(number))
        .map(|(_, case)| {
            watch.check_interrupt()?;
            let result = one_case(prepared, case, watch)?;
            (watch.progress)(1 + done.fetch_add(1, Ordering::Relaxed), total);
            Ok(result)
        })
        .collect::<Result<_, SweepError>>()?;
    let (inputs, rows): (Vec<Input>, Vec<Vec<SweepFrictionRow>>) = of_cases.into_iter().unzip();
    let identity = Identity {
        stage: STAGE.to_owned(),
        stage_revision: REVISION,
        output_schemas: vec![FRICTION.schema()],
        parameters: parameters(&prepared.cases[0].recipe),
        inputs,
    };
    let folder = RunFolder::share(prepared.layout.out())?;
    let mut pending = folder.begin(STAGE)?;
    pending.write_rows(FRICTION, &rows.concat())?;
    let seconds = begin.elapsed().as_secs_f64();
    let name = |number: &usize| prepared.cases[*number].folder.display().to_string();
    let warnings =
        left_out.iter().map(|case| format!("left out, its solves are missing: {}", name(case)));
    let warnings = warnings.collect();
    let manifest = Manifest::new(&identity, pending.outputs().to_vec(), warnings, seconds)?;
    pending.commit(&manifest)?;
    Ok(manifest)
}

/// What captions of the collected table say of all cases.
fn parameters(recipe: &Recipe) -> Value {
    let areal = &recipe.areal;
    json!({
        "tolerance": recipe.tolerance,
        // The friction tables have the first direction.
        "angle_deg": areal.angles_deg.first(),
        "thickness_mm": areal.thickness_mm,
    })
}

/// Brings the stages after the surfaces up to date; returns the friction table and its rows.
fn one_case(
    prepared: &Prepared,
    case: &Case,
    watch: Watch,
) -> Result<(Input, Vec<SweepFrictionRow>), SweepError> {
    let folder = prepared.make_case(case)?;
    write_recipe(case, &folder)?;
    let selection = Selection { from: Some(stages::bem::STAGE), ..Selection::default() };
    let scans = prepared.scans(case);
    pipeline::run_shared(&case.recipe, scans, &folder, selection, watch.interrupted, &|_| ())
        .map_err(of_case(case))?;
    let view = RunView::of(folder);
    let name = stages::tables::STAGE.name();
    let rows = view.rows(tables::FRICTION)?;
    let manifest = view.stage_manifest(name)?;
    let input = manifest.and_then(|manifest| manifest.input(tables::FRICTION.name()));
    let input = input
        .map(|input| Input { name: format!("{}/{}", case.folder.display(), input.name), ..input });
    let input = input.ok_or_else(|| ArtifactError::NoResult {
        path: view.path().to_owned(),
        stage: name.to_owned(),
    })?;
    Ok((input, rows.into_iter().map(|row| SweepFrictionRow::new(case, row)).collect()))
}

/// First line of the recipe of a case, before the digest of the lines below.
const RECIPE_HEAD: &str =
    "# Written by asperity from the recipe of the sweep, where it is to be edited. Lines below: ";

/// The recipe of the case alone, for `asperity status`, `run` and `report` of its folder.
fn write_recipe(case: &Case, folder: &Path) -> Result<(), SweepError> {
    let path = folder.join(RECIPE_FILE);
    let text = case
        .recipe
        .to_toml()
        .map_err(|reason| SweepError::BadPlan { path: path.clone(), reason })?;
    let text = format!("{RECIPE_HEAD}{}\n{text}", Digest::of_bytes(text.as_bytes()));
    if std::fs::read_to_string(&path).is_ok_and(|there| there == text) {
        return Ok(());
    }
    check_recipe(folder)?;
    Ok(write_by_rename(&path, text.as_bytes())?)
}

/// Fails for a recipe in the folder of a case that is not as asperity wrote it.
pub(super) fn check_recipe(folder: &Path) -> Result<(), SweepError> {
    let path = folder.join(RECIPE_FILE);
    if !path.exists() && !path.is_symlink() {
        return Ok(());
    }
    let text = std::fs::read_to_string(&path).unwrap_or_default();
    let lines = text.strip_prefix(RECIPE_HEAD).and_then(|rest| rest.split_once('\n'));
    let own = lines.is_some_and(|(digest, lines)| {
        digest == Digest::of_bytes(lines.as_bytes()).to_string() && !path.is_symlink()
    });
    if own {
        return Ok(());
    }
    Err(SweepError::Artifact(ArtifactError::Foreign {
        path,
        what: "is not as asperity writes it for a case, and would be replaced".into(),
        remedy: "move it away (what a case asks for is said in the recipe of the sweep)".into(),
    }))
}
