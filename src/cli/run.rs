//! `asperity run`: a recipe from scans to tables.

use asperity::stages;
use clap::Args;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Mutex;

use super::interrupt::Interrupt;
use super::last_run::LastRun;
use super::output::{json, note, print};
use super::progress::{Bar, Progress};
use super::recipe_options::{RecipeOptions, TakeOver};
use super::sweep::{claim_sweep, note_recipes, tell, warnings};
use super::{CliError, threads, values};
use asperity::artifact::{Manifest, RunFolder, RunView};
use asperity::files::name::path_text;
use asperity::pipeline::{Event, PipelineError, Ready, Selection};
use asperity::recipe::Recipe;
use asperity::stages::ingest::{CLEANING_FILE, FAULTS, FaultRow, MAP_WINDOWS};
use asperity::stages::{Stage, Watch};
use asperity::sweep;

const EXAMPLES: &str = "\
Examples:
  The bundled scans, from raw text to averaged friction tables in runs/asphalt:
    asperity run pipelines/asphalt.toml
  Your own scans, read as the recipe says:
    asperity run pipelines/asphalt.toml --scans measured/*.txt --out runs/mine
  One stage again, its inputs as they are:
    asperity run pipelines/asphalt.toml --only tables
  All from one stage on, computed again even if nothing changed:
    asperity run pipelines/asphalt.toml --from bem --force bem";

/// Bring the results of a recipe up to date.
///
/// A stage whose parameters, inputs and code are unchanged is not computed again. A stopped run
/// continues where it stopped, solve by solve.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Run {
    #[command(flatten)]
    recipe: RecipeOptions,
    /// Only this stage; what it reads must be up to date.
    #[arg(long, value_name = "STAGE", conflicts_with = "from")]
    only: Option<Stage>,
    /// This stage and those after it; what it reads must be up to date.
    #[arg(long, value_name = "STAGE")]
    from: Option<Stage>,
    /// Compute this stage even if it is up to date.
    #[arg(long, value_name = "STAGE")]
    force: Option<Stage>,
    #[command(flatten)]
    folder: TakeOver,
    /// Number of threads; all cores if not given. The numbers do not depend on it.
    #[arg(long, value_name = "N", value_parser = values::count::<usize>, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Print what was done as JSON.
    #[arg(long)]
    json: bool,
}

/// What a run did about a stage.
#[derive(Serialize)]
pub(super) struct StageSummary {
    stage: Stage,
    computed: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
}

impl Run {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`].
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        let (recipe, last_run) = self.recipe.recipe_and_origin()?;
        threads::start(self.threads)?;
        let out = self.recipe.out();
        refuse_among_scans(&recipe, &out)?;
        let selection = Selection { only: self.only, from: self.from, force: self.force };
        if recipe.sweep.is_some() {
            return self.run_cases(&recipe, &last_run, &out, quiet);
        }
        let summaries =
            bring_up_to_date(&recipe, &last_run, &out, selection, self.folder.take_over, quiet)?;
        if self.json {
            return print(&json(
                &serde_json::json!({ "out": path_text(&out), "stages": summaries }),
            )?);
        }
        note(quiet, format_args!("results in {}", out.display()));
        Ok(())
    }

    /// All cases of a recipe with a section `[sweep]`, on this machine.
    fn run_cases(
        &self,
        recipe: &Recipe,
        last_run: &LastRun,
        out: &Path,
        quiet: bool,
    ) -> Result<(), CliError> {
        if self.only.is_some() || self.from.is_some() || self.force.is_some() {
            return Err(CliError::input(
                "the recipe has a section [sweep]: --only, --from and --force are for one case, whose folder \
                 has a recipe of its own",
            ));
        }
        let interrupt = Interrupt::install()?;
        let bar = Bar::new(quiet, "cases");
        let watch = Watch {
            progress: &|done, total| bar.advance(done, total),
            interrupted: interrupt.flag(),
        };
        // The recipes of the cases are read from other folders, so their paths are absolute.
        let recipe = recipe.clone().absolute().map_err(CliError::failure)?;
        let out = &std::path::absolute(out).map_err(CliError::failure)?;
        claim_sweep(&recipe, last_run, out, self.folder.take_over)?;
        let manifest = sweep::run(&recipe, out, watch);
        bar.finish();
        let manifest = manifest?;
        let cases = recipe.cases()?;
        let layout = sweep::Layout::new(out);
        note_recipes(&layout, &cases)?;
        if self.json {
            let told = warnings(&layout, &cases)?.into_iter();
            let told: Vec<_> = told
                .map(|(case, stage, warning)| serde_json::json!({ "case": case, "stage": stage, "warning": warning }))
                .collect();
            return print(&json(&serde_json::json!({
                "out": path_text(out),
                "cases": cases.len(),
                "seconds": manifest.seconds,
                "warnings": told,
            }))?);
        }
        tell(quiet, &layout, &cases)?;
        let (count, tables) = (cases.len(), out.join(sweep::STAGE));
        note(
            quiet,
            format_args!(
                "{count} cases {:>8.2} s, tables in {}",
                manifest.seconds,
                tables.display()
            ),
        );
        Ok(())
    }
}

/// Brings the stages of one case up to date in a run folder, with progress and warnings on standard error.
///
/// # Errors
/// [`CliError`].
pub(super) fn bring_up_to_date(
    recipe: &Recipe,
    last_run: &LastRun,
    out: &Path,
    selection: Selection,
    take_over: bool,
    quiet: bool,
) -> Result<Vec<StageSummary>, CliError> {
    refuse_among_scans(recipe, out)?;
    let interrupt = Interrupt::install()?;
    let progress = Progress::new(quiet);
    let summaries = Mutex::new(Vec::new());
    let record = |summary: StageSummary| {
        if let Ok(mut summaries) = summaries.lock() {
            summaries.push(summary);
        }
    };
    let ready = Ready::new(recipe, out, selection)?;
    last_run.check(out, take_over)?;
    let folder = RunFolder::open(out).map_err(PipelineError::from)?;
    // At the start: the folder of an interrupted run is that of this recipe, too.
    last_run.write(out, take_over)?;
    ready
        .run(&folder, interrupt.flag(), &|event| match event {
            Event::Started(stage) => progress.start(stage),
            Event::Progress(_, done, total) => progress.advance(done, total),
            Event::Finished(stage, manifest) => {
                progress.finish();
                note(quiet, format_args!("{stage:<13} {:>8.2} s", manifest.seconds));
                if stage == stages::ingest::STAGE {
                    cleaned(quiet, out);
                }
                warn(quiet, manifest);
                let (seconds, warnings) = (Some(manifest.seconds), manifest.warnings.clone());
                record(StageSummary { stage, computed: true, seconds, warnings });
            }
            Event::Fresh(stage, manifest) => {
                note(quiet, format_args!("{stage:<13} up to date"));
                warn(quiet, manifest);
                let warnings = manifest.warnings.clone();
                record(StageSummary { stage, computed: false, seconds: None, warnings });
            }
        })
        .inspect_err(|error| {
            progress.finish();
            if error.is_interrupt() {
                note(quiet, "results so far are kept: the same command continues");
            }
        })?;
    Ok(summaries.into_inner().unwrap_or_default())
}

/// Refuses a run folder that is a folder of scans: its files would be taken for scans by the next run.
fn refuse_among_scans(recipe: &Recipe, out: &Path) -> Result<(), CliError> {
    let ingest = recipe.ingest.iter().flat_map(|ingest| &ingest.scans);
    let specimens = recipe.sweep.iter().flat_map(|sweep| &sweep.specimens);
    let scans = ingest.chain(specimens.flat_map(|specimen| &specimen.scans));
    let Ok(real) = std::fs::canonicalize(out) else { return Ok(()) };
    match scans
        .filter(|scans| scans.is_dir())
        .find(|scans| scans.canonicalize().is_ok_and(|s| s == real))
    {
        None => Ok(()),
        Some(scans) => Err(CliError::input(format!(
            "--out {}: this is the folder {} of the scans, and results in it would be taken for scans; give another",
            out.display(),
            scans.display()
        ))),
    }
}

/// What a user should know about a result, as long as it is the one in use.
fn warn(quiet: bool, manifest: &Manifest) {
    for warning in &manifest.warnings {
        note(quiet, format_args!("  warning: {warning}"));
    }
}

/// Whether a scan is a line of one of the maps: `map_row_0012`, `map_column_0003`.
fn is_line_of(scan: &str, maps: &BTreeSet<&str>) -> bool {
    let map = |line: &'static str| scan.rsplit_once(line).map(|(map, _)| map);
    ["_row_", "_column_"].into_iter().filter_map(map).any(|map| maps.contains(map))
}

/// One line on what was cleaned from the scans, and the file with the details.
fn cleaned(quiet: bool, out: &Path) {
    let view = RunView::of(out);
    // An unreadable table must not fail a finished run; the next command that reads it says why.
    let Ok((rows, _)) = view.read_table(FAULTS) else { return };
    let taken = |row: &&FaultRow| {
        row.count > 0 && matches!(row.decision.as_str(), "missing" | "cut" | "averaged")
    };
    // The faults of a map are there again in the lines that are taken of it.
    let maps = view.rows(MAP_WINDOWS).unwrap_or_default();
    let has_faults = |map: &str| rows.iter().any(|row| row.scan == map);
    let maps = maps.iter().map(|row| row.map.as_str()).filter(|map| has_faults(map));
    let maps: BTreeSet<&str> = maps.collect();
    let of_map = |row: &&FaultRow| is_line_of(&row.scan, &maps);
    let mut counts: BTreeMap<&str, u64> = BTreeMap::new();
    let mut scans = BTreeSet::new();
    for row in rows.iter().filter(taken).filter(|row| !of_map(row)) {
        *counts.entry(&row.fault).or_default() += row.count;
        scans.insert(&row.scan);
    }
    if counts.is_empty() {
        return;
    }
    let counts: Vec<String> =
        counts.iter().map(|(fault, count)| format!("{count} {fault}")).collect();
    let report = view.file("ingest", CLEANING_FILE);
    note(
        quiet,
        format_args!(
            "  cleaned: {} in {} scans, see {}",
            counts.join(", "),
            scans.len(),
            report.display()
        ),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_maps_are_told_from_scans() {
        let maps = BTreeSet::from(["road", "a_row_b"]);
        for line in ["road_row_0000", "road_column_0012", "a_row_b_row_0001"] {
            assert!(is_line_of(line, &maps), "{line}");
        }
        for scan in ["road", "a_row_b", "track_row_0000", "road_2"] {
            assert!(!is_line_of(scan, &maps), "{scan}");
        }
    }
}
