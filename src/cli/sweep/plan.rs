//! `asperity sweep plan`.

use clap::Args;
use serde_json::json;

use super::super::output::{json as json_text, note, print};
use super::super::recipe_options::{RecipeOptions, TakeOver};
use super::super::{CliError, values};
use super::{claim_sweep, duration, watched};
use asperity::sweep::{SweepPlan, plan};

const EXAMPLES: &str = "\
Examples:
  Deal what is missing to 40 shards; standard output is the path of the plan:
    PLAN=$(asperity sweep plan study.toml --shards 40 --out /shared/study)";

/// List the tasks that are missing and deal them to shards.
///
/// Runs the stages up to the realisations, tries two curves of each approximation to predict costs, and writes
/// a plan into the folder of the sweep; standard output is its path. The same recipe, folder and number of shards
/// give the same plan. Where the half-space is solved, the tasks of micro, fem and multilevel are listed.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Plan {
    #[command(flatten)]
    recipe: RecipeOptions,
    #[command(flatten)]
    folder: TakeOver,
    /// Number of shards; best are shards of some minutes of work.
    #[arg(long, value_name = "N", value_parser = values::count::<usize>)]
    shards: usize,
    /// Print what is planned as JSON.
    #[arg(long)]
    json: bool,
}

/// Largest number of shards; Slurm's own limit of an array is some four million.
const MOST_SHARDS: usize = 100_000;
/// Less work than this in a shard is mostly overhead of the scheduler.
const LEAST_SECONDS: f64 = 60.0;

impl Plan {
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        let shards = self.shards;
        if !(1..=MOST_SHARDS).contains(&shards) {
            return Err(CliError::input(format!("--shards {shards}: give 1 to {MOST_SHARDS}")));
        }
        let (recipe, last_run) = self.recipe.recipe_and_origin()?;
        let recipe = recipe.absolute().map_err(CliError::failure)?;
        let out = std::path::absolute(self.recipe.out()).map_err(CliError::failure)?;
        claim_sweep(&recipe, &last_run, &out, self.folder.take_over)?;
        let (path, plan) = watched(quiet, "planning", |watch| plan(&recipe, &out, shards, watch))?;
        describe(quiet, &plan);
        if self.json {
            let seconds: Vec<f64> = plan.seconds().collect();
            let tasks: Vec<usize> = plan.shards.iter().map(|shard| shard.tasks).collect();
            return print(&json_text(&json!({
                "plan": asperity::files::name::path_text(&path),
                "cases": plan.cases,
                "tasks": tasks,
                "seconds": seconds,
                "megabytes": plan.megabytes(1),
            }))?);
        }
        print(&format!("{}\n", path.display()))
    }
}

/// Prints what is planned in a line or two.
pub(super) fn describe(quiet: bool, plan: &SweepPlan) {
    let (tasks, shards) = (plan.tasks(), plan.shards.len());
    if tasks == 0 {
        note(
            quiet,
            format_args!(
                "{} cases, no task is missing: `asperity sweep collect` makes the tables",
                plan.cases
            ),
        );
        return;
    }
    let longest = plan.seconds().fold(0.0, f64::max);
    let total: f64 = plan.seconds().sum();
    note(
        quiet,
        format_args!(
            "{} cases, {tasks} tasks in {shards} shards: {} of work, at most {} and {:.0} MB a shard, on one thread",
            plan.cases,
            duration(total),
            duration(longest),
            plan.megabytes(1)
        ),
    );
    if shards > 1 && total / (shards as f64) < LEAST_SECONDS {
        let fewer = (total / (5.0 * LEAST_SECONDS)).ceil().max(1.0);
        note(
            quiet,
            format_args!(
                "  warning: {} a shard is short compared with the time that a scheduler takes to start it: --shards {fewer} would be enough",
                duration(total / shards as f64)
            ),
        );
    }
}
