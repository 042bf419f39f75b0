//! Sweeps over specimens, rubbers, temperatures, speeds and seeds, on one machine or many.
//!
//! The cases of a recipe ([`Recipe::cases`](crate::recipe::Recipe::cases)) share a folder. Its parts are these:
//!
//! - [`plan`] runs the cheap stages up to the realisations, lists the tasks whose solves are missing and deals
//!   them to shards by predicted cost;
//! - [`run_shard`] solves the tasks of one shard;
//! - [`collect`] checks that all are there and computes the remaining stages of every case, which find their
//!   solves in the store: its tables are those of one machine, to the bit;
//! - [`run`] does without plan and shards.
//!
//! A task is a curve of the half-space, a microscale or a curve at finite deformation: one surface or microscale, one
//! rubber, one speed, all its pressures. No two shards of a plan write the same file, results move by rename,
//! and no lock or clock is asked. What depends on results, microscales after the half-space or
//! realisations that a tolerance takes, is a plan of its own once they are there.
//!
//! | module | what it holds |
//! |---|---|
//! | `collect` | from the solves of all shards to the tables of all cases |
//! | `cost` | what a task is expected to cost, by rules that give the same everywhere: shares must not depend on how busy a machine was |
//! | `figure` | friction of the cases over speed |
//! | `layout` | where the files of a sweep are |
//! | `plan` | the plan of a sweep: which tasks are missing and which shard solves them |
//! | `prepare` | the cases of a sweep with their surfaces and rubbers: what is cheap, and is done before anything is dealt |
//! | `shard` | one shard of a plan, on any machine that sees the folder of the sweep |
//! | `shares` | tasks dealt to shards by their predicted cost |
//! | `slurm` | job scripts for Slurm: an array with an element for each shard, and a job that collects after it |
//! | `table` | the tables of all cases in one, keyed by what the sweep lists |
//! | `task` | what a shard computes: the tasks of the stages that solve |

mod collect;
mod cost;
mod figure;
mod layout;
mod plan;
mod prepare;
mod shard;
pub mod shares;
pub mod slurm;
mod table;
mod task;

pub use collect::{Cases, MissingTask, ShardState, check, collect, run, states};
pub use figure::sweep_speed_figure;
pub use layout::{CASES_FOLDER, Layout, RECIPE_FILE, SURFACES_FOLDER};
pub use plan::{PlannedShard, PlannedTask, ShardTasks, SweepPlan, plan, read_plan};
pub use prepare::Prepared;
pub use shard::{ShardReport, run_shard};
pub use table::{FRICTION, SweepFrictionRow};
pub use task::{Solvers, Task};

use crate::artifact::ArtifactError;
use crate::error_kind::{ErrorKind, HasKind};
use crate::pipeline::PipelineError;
use crate::requirement::InvalidRecipe;
use crate::stages::StageError;
use std::path::PathBuf;

/// Name of the folder and manifest of the tables of all cases.
pub const STAGE: &str = "sweep";

/// Why a sweep has no plan, no solves or no tables.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The recipe.
    #[error(transparent)]
    Recipe(#[from] InvalidRecipe),
    /// A case.
    #[error("case {case}: {source}")]
    Case {
        /// Its folder in that of the cases.
        case: String,
        /// Why.
        source: Box<PipelineError>,
    },
    /// A stage, while tasks are listed or tried.
    #[error(transparent)]
    Stage(Box<StageError>),
    /// A file of the sweep.
    #[error(transparent)]
    Artifact(#[from] ArtifactError),
    /// A file or link of the sweep.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was attempted, an infinitive.
        action: &'static str,
        /// The path.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A path that leads to no plan.
    #[error(
        "{} is no plan of a sweep: give the plan.json that `asperity sweep plan` named, in the folder of its sweep", path.display()
    )]
    NoPlan {
        /// The path.
        path: PathBuf,
    },
    /// A plan or a list of tasks that is not as it was written.
    #[error("{}: {reason}; plan again", path.display())]
    BadPlan {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A plan of another version of the tool.
    #[error(
        "{} was made by asperity {found}, this is {ours}: use that version, or plan again with this one", path.display()
    )]
    OtherVersion {
        /// The plan.
        path: PathBuf,
        /// Version that made it.
        found: String,
        /// This version.
        ours: &'static str,
    },
    /// A shard that the plan does not have.
    #[error("shard {shard} of a plan of {shards}: give 0 to {}", shards - 1)]
    NoSuchShard {
        /// The shard.
        shard: usize,
        /// Shards of the plan.
        shards: usize,
    },
    /// A rubber that is another since the plan.
    #[error("{} has changed since the plan was made: put it back, or plan again", path.display())]
    RubberChanged {
        /// The file of the rubber.
        path: PathBuf,
    },
    /// Scans that are others since the plan.
    #[error(
        "scans of {specimen} have changed since the plan was made: put them back, or plan again"
    )]
    ScansChanged {
        /// The specimen, or the recipe's own scans.
        specimen: String,
    },
    /// Shards that have not solved all their tasks.
    #[error("{missing} of {tasks} tasks are missing:\n{}", lines.join("\n"))]
    Incomplete {
        /// Tasks without their solves.
        missing: usize,
        /// Tasks of the plan.
        tasks: usize,
        /// A line for each shard, and what to do.
        lines: Vec<String>,
    },
    /// Not one case that could be in a table.
    #[error(
        "not one of {cases} cases has all its solves: run shards first (`asperity sweep status`)"
    )]
    NoCompleteCase {
        /// Their number.
        cases: usize,
    },
    /// No scheduler where one is asked for.
    #[error("{0}")]
    Slurm(String),
}

impl HasKind for SweepError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Recipe(source) => source.kind(),
            Self::Case { source, .. } => source.kind(),
            Self::Stage(source) => source.kind(),
            Self::Artifact(source) => source.kind(),
            Self::NoPlan { .. }
            | Self::BadPlan { .. }
            | Self::OtherVersion { .. }
            | Self::NoSuchShard { .. }
            | Self::RubberChanged { .. }
            | Self::ScansChanged { .. }
            | Self::Slurm(_) => ErrorKind::Input,
            Self::Io { .. } | Self::Incomplete { .. } | Self::NoCompleteCase { .. } => {
                ErrorKind::Failure
            }
        }
    }
}

impl From<StageError> for SweepError {
    fn from(error: StageError) -> Self {
        Self::Stage(Box::new(error))
    }
}
