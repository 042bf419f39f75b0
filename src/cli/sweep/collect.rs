//! `asperity sweep collect`.

use clap::Args;

use super::super::output::note;
use super::super::{CliError, values};
use super::plan::describe;
use super::submit::{SlurmOptions, submit};
use super::{PlanPath, display, note_recipes, set_threads, tell, watched};
use asperity::artifact::Manifest;
use asperity::sweep::{Cases, Layout, STAGE, SweepPlan, check, collect, plan, read_plan};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  The tables of all cases, once every shard has run:
    asperity sweep collect $PLAN
  Microscales and further realisations as a further array, as the submitted job does:
    asperity sweep collect $PLAN --submit-next";

/// Check that all solves are there and compute the remaining stages of all cases.
///
/// Names the shards of solves that are missing, damaged or from another version of the tool. The tables of all cases, keyed
/// by specimen, rubber, temperature and seed, are sweep/friction.arrow in the folder of the sweep; each case is a
/// run folder of its own.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Collect {
    #[command(flatten)]
    plan: PlanPath,
    /// If the solves ask for further tasks (micro, fem, multilevel, realisations for a tolerance), plan and submit these
    /// as a further array instead of solving them here.
    #[arg(long)]
    submit_next: bool,
    /// Make the tables of the cases whose solves are all there and leave out the others, for a sweep in which
    /// some tasks cannot be solved. A warning names them.
    #[arg(long, conflicts_with = "submit_next")]
    complete_cases: bool,
    #[command(flatten)]
    slurm: SlurmOptions,
    /// Number of threads; what the scheduler gives, or all cores.
    #[arg(long, value_name = "N", value_parser = values::count::<usize>)]
    threads: Option<usize>,
}

/// Result of a collection.
enum Outcome {
    /// Further tasks, and the plan that deals them.
    Next(PathBuf, Box<SweepPlan>),
    /// The tables.
    Tables(Box<Manifest>),
}

impl Collect {
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        set_threads(self.threads)?;
        let path = self.plan.absolute()?;
        let planned = read_plan(&path)?;
        let layout = Layout::of_plan(&path)?;
        let cases = planned.recipe.cases()?;
        let outcome = watched(quiet, "collecting", |watch| {
            if self.submit_next {
                check(&path, &planned)?;
                let shards = planned.shards.len();
                let next = plan(&planned.recipe, layout.out(), shards, watch)?;
                if next.1.tasks() > 0 {
                    return Ok(Outcome::Next(next.0, Box::new(next.1)));
                }
            }
            let of = if self.complete_cases { Cases::Complete } else { Cases::All };
            collect(&path, &planned, of, watch).map(Box::new).map(Outcome::Tables)
        })?;
        let manifest = match outcome {
            Outcome::Next(path, next) => {
                describe(quiet, &next);
                return submit(&path, &next, &self.slurm);
            }
            Outcome::Tables(manifest) => manifest,
        };
        tell(quiet, &layout, &cases)?;
        for warning in &manifest.warnings {
            note(quiet, format_args!("  warning: {warning}"));
        }
        let collected = manifest.inputs.len();
        note_recipes(&layout, &cases)?;
        let tables = layout.out().join(STAGE);
        note(
            quiet,
            format_args!("{collected} of {} cases, tables in {}", cases.len(), display(&tables)),
        );
        Ok(())
    }
}
