//! `asperity sweep`: many cases on many machines.
//!
//! | module | what it holds |
//! |---|---|
//! | `collect` | `asperity sweep collect` |
//! | `plan` | `asperity sweep plan` |
//! | `shard` | `asperity sweep run` |
//! | `status` | `asperity sweep status` |
//! | `submit` | `asperity sweep submit` |

mod collect;
mod plan;
mod shard;
mod status;
mod submit;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::interrupt::Interrupt;
use super::last_run::LastRun;
use super::output::note;
use super::progress::Bar;
use super::{CliError, threads};
use asperity::artifact::RunView;
use asperity::recipe::{Case, Recipe};
use asperity::stages::{Stage, Watch};
use asperity::sweep::{Layout, RECIPE_FILE, SweepError};

/// Spread the cases of a recipe over many machines: plan, submit or run shards, collect.
#[derive(Debug, Subcommand)]
pub(super) enum Sweep {
    Plan(plan::Plan),
    Submit(submit::Submit),
    Run(shard::Run),
    Status(status::Status),
    Collect(collect::Collect),
}

impl Sweep {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`].
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        match self {
            Self::Plan(command) => command.run(quiet),
            Self::Submit(command) => command.run(),
            Self::Run(command) => command.run(quiet),
            Self::Status(command) => command.run(),
            Self::Collect(command) => command.run(quiet),
        }
    }
}

/// The plan of a sweep.
#[derive(Debug, Args)]
struct PlanPath {
    /// The plan.json that `asperity sweep plan` printed.
    plan: PathBuf,
}

impl PlanPath {
    fn absolute(&self) -> Result<PathBuf, CliError> {
        std::path::absolute(&self.plan).map_err(CliError::failure)
    }
}

/// Runs work with a progress bar that Ctrl-C can interrupt.
fn watched<T>(
    quiet: bool,
    what: &str,
    work: impl FnOnce(Watch) -> Result<T, SweepError>,
) -> Result<T, CliError> {
    let interrupt = Interrupt::install()?;
    let bar = Bar::new(quiet, what);
    let result = work(Watch {
        progress: &|done, total| bar.advance(done, total),
        interrupted: interrupt.flag(),
    });
    bar.finish();
    Ok(result?)
}

/// The warnings of all stages of the cases, those of shared surfaces once: `(where, stage, warning)`.
///
/// # Errors
/// [`CliError`] for a manifest that cannot be read.
pub(super) fn warnings(
    layout: &Layout,
    cases: &[Case],
) -> Result<Vec<(String, Stage, String)>, CliError> {
    let mut seen = BTreeSet::new();
    let mut warnings = Vec::new();
    for case in cases {
        let folder = layout.case(case);
        let view = RunView::of(&folder);
        for stage in Stage::ALL {
            // Links of several cases lead to one result.
            let real = std::fs::canonicalize(folder.join(stage.name()));
            let Some(manifest) = view.stage_manifest(stage.name())? else { continue };
            if real.is_ok_and(|real| seen.insert(real)) {
                let told = manifest.warnings.into_iter();
                warnings.extend(told.map(|text| (case.folder.display().to_string(), stage, text)));
            }
        }
    }
    Ok(warnings)
}

/// Shows the warnings of all stages of the cases.
///
/// # Errors
/// As [`warnings`].
pub(super) fn tell(quiet: bool, layout: &Layout, cases: &[Case]) -> Result<(), CliError> {
    for (case, stage, warning) in warnings(layout, cases)? {
        note(quiet, format_args!("  warning: {case}, {stage}: {warning}"));
    }
    Ok(())
}

/// Marks a folder as that of the sweep of a recipe, after a check of what is in it.
pub(super) fn claim_sweep(
    recipe: &Recipe,
    last_run: &LastRun,
    out: &Path,
    take_over: bool,
) -> Result<(), CliError> {
    last_run.check(out, take_over)?;
    let layout = Layout::new(out);
    let cases = recipe.cases().map_err(CliError::input)?;
    layout.check(&cases)?;
    for case in &cases {
        LastRun::refuse_foreign(&layout.case(case))?;
    }
    std::fs::create_dir_all(out)
        .map_err(|error| CliError::failure(format!("cannot create {}: {error}", out.display())))?;
    last_run.write(out, take_over)
}

/// Writes the note of the last run into the folder of each case, as `asperity run` does.
pub(super) fn note_recipes(layout: &Layout, cases: &[Case]) -> Result<(), CliError> {
    for case in cases {
        let folder = layout.case(case);
        let path = folder.join(RECIPE_FILE);
        // A case that was left out has no recipe.
        if !path.exists() {
            continue;
        }
        let text = std::fs::read_to_string(&path).map_err(|error| {
            CliError::failure(format!("cannot read {}: {error}", path.display()))
        })?;
        LastRun::new(&path, text, &[], None)?.write(&folder, false)?;
    }
    Ok(())
}

/// Sets the number of threads: what was asked for, or what the scheduler gives this process.
fn set_threads(asked: Option<usize>) -> Result<usize, CliError> {
    let given = given_cores(|name| std::env::var(name).ok());
    threads::start(threads::checked(asked)?.or(given.map(|cores| cores.min(threads::MOST))))
}

/// Cores that a scheduler gives this process: Slurm states their number, HyperQueue lists them.
fn given_cores(variable: impl Fn(&str) -> Option<String>) -> Option<usize> {
    let listed = || Some(variable("HQ_CPUS")?.split(',').count());
    let number = variable("SLURM_CPUS_PER_TASK").and_then(|text| text.parse().ok());
    number.or_else(listed).filter(|cores| *cores > 0)
}

/// A duration such as "32 min".
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{s:.0} s"),
        s if s < 5400.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A path for people: relative to the working folder, if it is in it.
fn display(path: &Path) -> String {
    let here = std::env::current_dir().unwrap_or_default();
    path.strip_prefix(here).unwrap_or(path).display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scheduler_says_how_many_cores_there_are() {
        let given = |set: &'static str, value: &'static str| {
            given_cores(|name| (name == set).then(|| value.to_owned()))
        };
        assert_eq!(given("SLURM_CPUS_PER_TASK", "4"), Some(4));
        assert_eq!(given("SLURM_CPUS_PER_TASK", "0"), None);
        assert_eq!(given("HQ_CPUS", "2,3,7"), Some(3));
        assert_eq!(given("OTHER", "5"), None);
    }
}
