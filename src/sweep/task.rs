//! What a shard computes: the tasks of the stages that solve.

use crate::artifact::{Digest, SolveStore};
use crate::recipe::Recipe;
use crate::requirement::InvalidRecipe;
use crate::rubber::RubberModel;
use crate::stages::areal;
use crate::stages::bem::{self, Bem};
use crate::stages::fem;
use crate::stages::kept::SolveTask;
use crate::stages::micro::{self, Micro};
use crate::stages::multilevel::Multilevel;
use crate::stages::{Chain, Job};
use crate::stages::{StageError, Watch};
use serde::{Deserialize, Serialize};

/// A curve of the half-space, on profiles or areal surfaces, a microscale or a curve at finite deformation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "stage", content = "task", rename_all = "lowercase")]
pub enum Task {
    /// Of the stage `bem`.
    Bem(bem::Task),
    /// Of the stage `areal`.
    Areal(areal::Task),
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
    /// Section `[areal]` with the areas of the half-space.
    pub areal: areal::Sweep,
    /// Section `[micro]`.
    pub micro: Micro,
    /// Section `[fem]` with the areas of the half-space.
    pub fem: fem::Sweep,
    /// Section `[multilevel]`.
    pub multilevel: Multilevel,
    /// What it says about curves at finite deformation.
    pub pairs: fem::Sweep,
}

impl Solvers {
    /// Those of a case.
    ///
    /// # Errors
    /// [`InvalidRecipe`] for the study of one sine.
    pub fn of(case: &Recipe) -> Result<Self, InvalidRecipe> {
        match case.job()? {
            Job::Chain(Chain { bem, areal, micro, fem, multilevel, .. }) => {
                let multilevel = multilevel.copied().unwrap_or_default();
                let wanted = bem.wanted();
                Ok(Self {
                    bem: bem.clone(),
                    areal: areal::Sweep { areal: areal.clone(), wanted: wanted.clone() },
                    micro: micro.cloned().unwrap_or_default(),
                    fem: fem::Sweep { fem: fem.cloned().unwrap_or_default(), wanted },
                    multilevel,
                    pairs: multilevel.sweep(bem),
                })
            }
            Job::Sinusoid(_) => Err(InvalidRecipe::SweepOfSinusoid),
        }
    }
}

impl Task {
    /// Digest under which its solves are kept; tasks of one problem belong into one shard.
    pub fn problem(&self, solvers: &Solvers, rubber: &RubberModel) -> Digest {
        match self {
            Self::Bem(task) => task.problem(&solvers.bem, rubber),
            Self::Areal(task) => task.problem(&solvers.areal, rubber),
            Self::Micro(task) => task.problem(&solvers.micro, rubber),
            Self::Fem(task) => task.problem(&solvers.fem, rubber),
            Self::Multilevel(task) => task.problem(&solvers.pairs, rubber),
        }
    }

    /// Digest of all that determines its solves.
    pub fn key(&self, solvers: &Solvers, rubber: &RubberModel) -> Digest {
        match self {
            Self::Bem(task) => task.key(&solvers.bem, rubber),
            Self::Areal(task) => task.key(&solvers.areal, rubber),
            Self::Micro(task) => task.key(&solvers.micro, rubber),
            Self::Fem(task) => task.key(&solvers.fem, rubber),
            Self::Multilevel(task) => task.key(&solvers.pairs, rubber),
        }
    }

    /// Solves what a packed store does not have.
    ///
    /// # Errors
    /// Those of its stage.
    pub fn solve(
        &self,
        solvers: &Solvers,
        rubber: &RubberModel,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<(), StageError> {
        match self {
            Self::Bem(task) => task.solve(&solvers.bem, rubber, store, watch).map(drop),
            Self::Areal(task) => task.solve(&solvers.areal, rubber, store, watch).map(drop),
            Self::Micro(task) => task.solve(&solvers.micro, rubber, store, watch).map(drop),
            Self::Fem(task) => task.solve(&solvers.fem, rubber, store, watch).map(drop),
            Self::Multilevel(task) => task.solve(&solvers.pairs, rubber, store, watch).map(drop),
        }
    }

    /// What it is, for messages: `bem, 8 waves, realisation 3, 10 mm/s`.
    pub fn name(&self) -> String {
        match self {
            Self::Bem(task) => task.name(),
            Self::Fem(task) => task.name(),
            Self::Multilevel(task) => task.surface.name_at("multilevel", task.speed_mm_s),
            Self::Areal(task) => task.name(),
            Self::Micro(task) => task.name(),
        }
    }
}
