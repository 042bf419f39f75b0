//! One shard of a plan, on any machine that sees the folder of the sweep.

use super::SweepError;
use super::layout::Layout;
use super::plan::{PlannedTask, ShardTasks, read_plan};
use super::task::Solvers;
use crate::artifact::SolveStore;
use crate::stages::{StageError, Watch};
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Instant;

/// What a shard did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShardReport {
    /// Number of the shard, from 0.
    pub shard: usize,
    /// Its tasks.
    pub tasks: usize,
    /// Of these, those whose solves were there.
    pub there: usize,
    /// Tasks that cannot be solved, and why.
    pub failures: Vec<String>,
    /// Wall time in s.
    pub seconds: f64,
}

/// Solves the tasks of a shard whose solves are not there, on the threads of the global pool. A task that fails
/// does not stop the others.
///
/// Run twice, at once or one after the other, it does what it does once.
///
/// # Errors
/// [`SweepError`] for a plan that cannot be used, a store that cannot be written and an interrupt.
pub fn run_shard(path: &Path, shard: usize, watch: Watch) -> Result<ShardReport, SweepError> {
    let begin = Instant::now();
    let plan = read_plan(path)?;
    let list = ShardTasks::read(path, &plan, shard)?;
    let cases = plan.recipe.cases()?;
    let solvers = Solvers::of(&cases[0].recipe)?;
    let store = SolveStore::open_packed(Layout::of_plan(path)?.solves())?;
    let total = list.tasks.len();
    let (done, there) = (AtomicU64::new(0), AtomicUsize::new(0));
    (watch.progress)(0, total as u64);
    let silent = Watch { progress: &|_, _| (), interrupted: watch.interrupted };
    // Tasks of one problem share a file, so they follow each other on one thread.
    let problems: Vec<&[PlannedTask]> =
        list.tasks.chunk_by(|a, b| a.problem == b.problem).collect();
    let solve = |planned: &PlannedTask| -> Result<Option<String>, SweepError> {
        watch.check_interrupt()?;
        let rubber = plan.rubbers.get(planned.material).ok_or_else(|| SweepError::BadPlan {
            path: path.to_owned(),
            reason: format!("it has no rubber {}", planned.material),
        })?;
        let task = &planned.task;
        if store.problem(&planned.problem)?.is_finished(&planned.key) {
            there.fetch_add(1, Ordering::Relaxed);
        } else {
            match task.solve(&solvers, rubber, &store, silent) {
                Ok(()) => {}
                Err(StageError::Interrupted) => return Err(StageError::Interrupted.into()),
                Err(StageError::Artifact(error)) => return Err(error.into()),
                Err(error) => {
                    let case =
                        cases.get(planned.case).map(|case| case.folder.display().to_string());
                    return Ok(Some(format!("case {}: {error}", case.unwrap_or_default())));
                }
            }
        }
        (watch.progress)(1 + done.fetch_add(1, Ordering::Relaxed), total as u64);
        Ok(None)
    };
    let failures: Vec<Vec<Option<String>>> = problems
        .par_iter()
        .map(|tasks| tasks.iter().map(solve).collect::<Result<_, _>>())
        .collect::<Result<_, SweepError>>()?;
    Ok(ShardReport {
        shard,
        tasks: total,
        there: there.into_inner(),
        failures: failures.into_iter().flatten().flatten().collect(),
        seconds: begin.elapsed().as_secs_f64(),
    })
}
