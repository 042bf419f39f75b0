//! `asperity sweep status`.

use clap::Args;

use super::super::CliError;
use super::super::output::{json, print};
use super::PlanPath;
use asperity::sweep::{ShardState, read_plan, states};

const EXAMPLES: &str = "\
Examples:
  How far the shards are:
    asperity sweep status $PLAN";

/// Show how many tasks of each shard are solved.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Status {
    #[command(flatten)]
    plan: PlanPath,
    /// Print JSON, with every missing task and why.
    #[arg(long)]
    json: bool,
}

impl Status {
    pub(super) fn run(self) -> Result<(), CliError> {
        let path = self.plan.absolute()?;
        let states = states(&path, &read_plan(&path)?)?;
        if self.json {
            return print(&json(&states)?);
        }
        let tasks: usize = states.iter().map(|state| state.tasks).sum();
        let missing: usize = states.iter().map(|state| state.missing.len()).sum();
        let complete = states.iter().filter(|state| state.missing.is_empty()).count();
        let line = |state: &ShardState| {
            let solved = state.tasks - state.missing.len();
            format!("shard {:>5}: {solved} of {} tasks solved\n", state.shard, state.tasks)
        };
        let open: String =
            states.iter().filter(|state| !state.missing.is_empty()).map(line).collect();
        print(&format!(
            "{open}{} of {tasks} tasks solved, {complete} of {} shards complete\n",
            tasks - missing,
            states.len()
        ))
    }
}
