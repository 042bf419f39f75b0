//! What a shard computes: the tasks of the stages that solve.

use crate::artifact::{Digest, SolveStore};
use crate::recipe::Recipe;
use crate::requirement::InvalidRecipe;
use crate::rubber::Rubber;
use crate::stages::bem::{self, Bem};
use crate::stages::fem::{self, Fem};
use crate::stages::micro::{self, Micro};
use crate::stages::multilevel::Multilevel;
use crate::stages::{Chain, Job};
use crate::stages::{StageError, Watch};
use serde::{Deserialize, Serialize};

/// A curve of the half-space, a microscale or a curve at finite deformation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "stage", content = "task", rename_all = "lowercase")]
pub enum Task {
    /// Of the stage `bem`.
    Bem(bem::Task),
    /// Of the stage `micro`.
    Micro(micro::Task),
    /// Of the stage `fem`.
    Fem(fem::Task),
    /// A curve at finite deformation of the stage `multilevel`.
    Multilevel(fem::Task),
}

/// The sections of a recipe that say how tasks are solved, the same in all cases.
#[derive(Debug, Clone)]
pub struct Solvers {
    /// Section `[bem]`.
    pub bem: Bem,
    /// Section `[micro]`.
    pub micro: Micro,
    /// Section `[fem]`.
    pub fem: Fem,
    /// Section `[multilevel]`.
    pub multilevel: Multilevel,
}

impl Solvers {
    /// Those of a case.
    ///
    /// # Errors
    /// [`InvalidRecipe`] for the study of one sine.
    pub fn of(case: &Recipe) -> Result<Self, InvalidRecipe> {
        match case.job()? {
            Job::Chain(Chain { bem, micro, fem, multilevel, .. }) => Ok(Self {
                bem: bem.clone(),
                micro: micro.cloned().unwrap_or_default(),
                fem: fem.cloned().unwrap_or_default(),
                multilevel: multilevel.copied().unwrap_or_default(),
            }),
            Job::Sinusoid(_) => Err(InvalidRecipe::SweepOfSinusoid),
        }
    }
}

impl Task {
    /// Digest under which its solves are kept; tasks of one problem belong into one shard.
    pub fn problem(&self, solvers: &Solvers, rubber: &Rubber) -> Digest {
        match self {
            Self::Bem(task) => task.problem(rubber),
            Self::Micro(task) => task.problem(&solvers.micro, rubber),
            Self::Fem(task) => task.problem(&solvers.fem, rubber),
            Self::Multilevel(task) => task.problem(&solvers.multilevel.fem(), rubber),
        }
    }

    /// Digest of all that determines its solves.
    pub fn key(&self, solvers: &Solvers, rubber: &Rubber) -> Digest {
        match self {
            Self::Bem(task) => task.key(&solvers.bem, rubber),
            Self::Micro(task) => task.key(&solvers.micro, rubber),
            Self::Fem(task) => task.key(&solvers.fem, &solvers.bem.area_fractions, rubber),
            Self::Multilevel(task) => {
                task.key(&solvers.multilevel.fem(), &solvers.bem.area_fractions, rubber)
            }
        }
    }

    /// Solves what a packed store does not have.
    ///
    /// # Errors
    /// Those of its stage.
    pub fn solve(
        &self,
        solvers: &Solvers,
        rubber: &Rubber,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<(), StageError> {
        match self {
            Self::Bem(task) => task.solve(&solvers.bem, rubber, store, watch).map(drop),
            Self::Micro(task) => task.solve(&solvers.micro, rubber, store, watch),
            Self::Fem(task) => {
                task.solve(&solvers.fem, &solvers.bem.area_fractions, rubber, store, watch)
            }
            Self::Multilevel(task) => {
                let (fem, areas) = (solvers.multilevel.fem(), &solvers.bem.area_fractions);
                task.solve(&fem, areas, rubber, store, watch)
            }
        }
    }

    /// What it is, for messages: `bem, 8 waves, realisation 3, 10 mm/s`.
    pub fn name(&self) -> String {
        let surface = |stage, surface: &crate::stages::realise::Surface, speed| {
            let (waves, realisation) = (surface.waves, surface.realisation);
            format!("{stage}, {waves} waves, realisation {realisation}, {speed} mm/s")
        };
        match self {
            Self::Bem(task) => surface("bem", &task.surface, task.speed_mm_s),
            Self::Fem(task) => surface("fem", &task.surface, task.speed_mm_s),
            Self::Multilevel(task) => surface("multilevel", &task.surface, task.speed_mm_s),
            Self::Micro(task) => format!("micro, {}, {} mm/s", task.owner_names(), task.speed_mm_s),
        }
    }
}
