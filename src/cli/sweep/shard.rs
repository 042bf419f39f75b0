//! `asperity sweep run`.

use clap::Args;

use super::super::output::{json, note, print};
use super::super::{CliError, values};
use super::{PlanPath, set_threads, watched};
use asperity::sweep::run_shard;

const EXAMPLES: &str = "\
Examples:
  A shard by hand, on any machine that sees the folder:
    asperity sweep run $PLAN --shard 3
  In an element of a job array the number is that of the element:
    sbatch --array=0-39 --requeue --wrap \"asperity sweep run $PLAN\"
  With HyperQueue:
    hq submit --array=0-39 -- asperity sweep run $PLAN";

/// Solve the tasks of one shard.
///
/// Existing solves are not repeated, so a shard may be run any number of times, also several times at once. Exit
/// code 1 if a task cannot be solved; the others are solved nevertheless.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Run {
    #[command(flatten)]
    plan: PlanPath,
    /// Number of the shard, from 0; that of the element in a job array of Slurm or HyperQueue if not given.
    #[arg(long, value_name = "I", value_parser = values::count::<usize>)]
    shard: Option<usize>,
    /// Number of threads; what the scheduler gives, or all cores.
    #[arg(long, value_name = "N", value_parser = values::count::<usize>)]
    threads: Option<usize>,
    /// Print what was done as JSON.
    #[arg(long)]
    json: bool,
}

/// Variables in which schedulers state the element of the array.
const ELEMENTS: [&str; 2] = ["SLURM_ARRAY_TASK_ID", "HQ_TASK_ID"];

impl Run {
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        let shard = match self.shard {
            Some(shard) => shard,
            None => element()?,
        };
        set_threads(self.threads)?;
        let path = self.plan.absolute()?;
        let name = format!("shard {shard}");
        let report = watched(quiet, &name, |watch| run_shard(&path, shard, watch))?;
        for failure in &report.failures {
            note(false, format_args!("  failed: {failure}"));
        }
        if self.json {
            print(&json(&report)?)?;
        } else {
            let solved = report.tasks - report.there - report.failures.len();
            let (tasks, there, seconds) = (report.tasks, report.there, report.seconds);
            note(
                quiet,
                format_args!(
                    "shard {shard}: {solved} of {tasks} tasks solved in {seconds:.1} s, {there} were solved before"
                ),
            );
        }
        match report.failures.len() {
            0 => Ok(()),
            failed => Err(CliError::failure(format!(
                "{failed} of {} tasks of shard {shard} cannot be solved",
                report.tasks
            ))),
        }
    }
}

fn element() -> Result<usize, CliError> {
    let given = ELEMENTS.iter().find_map(|name| Some((name, std::env::var(name).ok()?)));
    match given {
        Some((name, text)) => text
            .parse()
            .map_err(|_| CliError::input(format!("{name} is `{text}`, which is not a number"))),
        None => Err(CliError::input(
            "which shard? Give --shard, or run in an element of a job array (SLURM_ARRAY_TASK_ID, HQ_TASK_ID)",
        )),
    }
}
