//! Solves that are kept: what the store has is taken from it, the rest is solved and put there.
//!
//! | item | what it does |
//! |---|---|
//! | [`problem`], [`problem_at_finite_deformation`] | what determines all solves of one rubber: the identity under which they are kept |
//! | [`Kept`] | single solves of one problem |
//! | [`KeptPath`] | solves at finite deformation, each of which begins from the one before |
//! | [`SolveTask`] | a curve or a microscale as one piece of work, which any machine can do |
//! | [`Tally`] | pieces of work side by side, counted for who looks on |

use super::{SolveError, StageError, Watch};
use crate::artifact::{ArtifactError, Digest, SolveStore, Solves};
use crate::fem::error::{BeyondLaw, FemError, PathEnd};
use crate::fem::steady::SteadyContact;
use crate::fem::steady::solution::SteadySolution;
use crate::numerics::Interrupt;
use crate::rubber::{RubberModel, Viscoelastic};
use rayon::prelude::*;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// What determines the solves of a solver for a rubber, to which its caller adds what it solves. The name of the
/// rubber is no part of it; the revision of the solver is, which is raised when the same problem gives another number.
pub(super) fn problem(solver: &str, revision: u32, rubber: &RubberModel) -> Value {
    match rubber {
        RubberModel::Maxwell(rubber) => json!({
            "solver": [solver, revision],
            "equilibrium_modulus": rubber.equilibrium_modulus,
            "branches": rubber.branches,
            "poisson_ratio": rubber.poisson_ratio,
        }),
        RubberModel::Table(table) => json!({
            "solver": [solver, revision],
            "moduli": table.points(),
            "extrapolation": table.extrapolation(),
            "poisson_ratio": table.poisson_ratio(),
        }),
    }
}

/// The same of a solver at finite deformation, which the law of the rubber determines too; a law that is not named is no
/// part of it.
pub(super) fn problem_at_finite_deformation(
    solver: &str,
    revision: u32,
    rubber: &RubberModel,
) -> Value {
    let mut problem = problem(solver, revision, rubber);
    // A table of moduli has no solution at finite deformation, and so no law.
    if let Ok(rubber) = rubber.maxwell()
        && !rubber.finite_strain.is_default()
    {
        problem["finite_strain"] = json!(rubber.finite_strain);
    }
    problem
}

/// The kept solves of one problem.
pub(super) struct Kept<'a> {
    problem: Value,
    solves: Solves<'a>,
    interrupt: &'a Interrupt,
}

impl<'a> Kept<'a> {
    /// The solves of a problem, which its digest names.
    pub fn open(
        store: &'a SolveStore,
        problem: Value,
        interrupt: &'a Interrupt,
    ) -> Result<Self, ArtifactError> {
        let solves = store.problem(&Digest::of_value(&problem))?;
        Ok(Self { problem, solves, interrupt })
    }

    /// The solve that differs from others of the problem by these values: from the store, or made and put there.
    pub fn take_or<T: Serialize + DeserializeOwned>(
        &mut self,
        values: &[(&str, Value)],
        make: impl FnOnce() -> Result<T, SolveError>,
    ) -> Result<T, SolveError> {
        let key = self.key(values);
        if let Some(kept) = self.get(&key)? {
            return Ok(kept);
        }
        let made = make()?;
        self.solves.put(&key, &made)?;
        Ok(made)
    }

    /// Notes that the store has every solve of a task.
    pub fn finish(&mut self, task: &Digest) -> Result<(), ArtifactError> {
        self.solves.finish(task)
    }

    fn key(&self, values: &[(&str, Value)]) -> Digest {
        let mut all = self.problem.clone();
        for (name, value) in values {
            all[*name] = value.clone();
        }
        Digest::of_value(&all)
    }

    /// Every solve begins here, kept or not.
    fn get<T: DeserializeOwned>(&self, key: &Digest) -> Result<Option<T>, SolveError> {
        if self.interrupt.is_set() {
            return Err(SolveError::Interrupted);
        }
        Ok(self.solves.get(key)?)
    }
}

/// What the store has of a pressure. That there is no solution is kept like one: it takes longer to find out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
enum Stored<T> {
    Solved(T),
    Refused {
        refused: PathEnd,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        beyond: Option<BeyondLaw>,
    },
}

/// A contact at finite deformation along pressures, whose solutions are kept.
///
/// Each solution begins from the one before. The contact therefore passes the pressures that the store knew before it
/// goes on, so that a run that was stopped gives the numbers of one that was not, to the last bit.
pub(super) struct KeptPath<'a, F> {
    kept: Kept<'a>,
    columns: usize,
    set_up: F,
    /// Set up when first needed.
    contact: Option<SteadyContact>,
    /// Pressures in Pa that the store knew and the contact did not pass.
    known: Vec<f64>,
}

impl<'a, F: Fn() -> Result<SteadyContact, FemError>> KeptPath<'a, F> {
    /// The path of the contact that `set_up` makes, on a mesh of so many columns.
    pub fn new(kept: Kept<'a>, columns: usize, set_up: F) -> Self {
        Self { kept, columns, set_up, contact: None, known: Vec::new() }
    }

    /// The solution at a pressure in Pa as `row` makes it of the solution and the seconds that it took.
    ///
    /// # Errors
    /// [`FemError::PathEnded`] also where the store knows that there is none.
    pub fn at<T: Serialize + DeserializeOwned>(
        &mut self,
        pressure: f64,
        row: impl FnOnce(&SteadySolution, f64) -> Result<T, SolveError>,
    ) -> Result<T, SolveError> {
        let key = self.kept.key(&[("pressure", json!(pressure))]);
        match self.kept.get(&key)? {
            Some(Stored::Solved(kept)) => {
                self.known.push(pressure);
                return Ok(kept);
            }
            Some(Stored::Refused { refused: reached, beyond }) => {
                if !self.contact()?.refusals_leave_no_trace() {
                    self.known.push(pressure);
                }
                let (wanted, columns) = (pressure, self.columns);
                return Err(FemError::PathEnded { wanted, columns, reached, beyond }.into());
            }
            None => {}
        }
        self.pass_known()?;
        let start = Instant::now();
        match self.contact()?.solve(pressure) {
            Ok(solution) => {
                let made = row(&solution, start.elapsed().as_secs_f64())?;
                self.kept.solves.put(&key, &made)?;
                Ok(made)
            }
            Err(error) => {
                if let FemError::PathEnded { reached, beyond, .. } = &error {
                    let refused = Stored::<T>::Refused { refused: *reached, beyond: *beyond };
                    self.kept.solves.put(&key, &refused)?;
                }
                Err(error.into())
            }
        }
    }

    /// Notes that the store has every solve of a task.
    pub fn finish(&mut self, task: &Digest) -> Result<(), ArtifactError> {
        self.kept.finish(task)
    }

    fn pass_known(&mut self) -> Result<(), SolveError> {
        for pressure in std::mem::take(&mut self.known) {
            match self.contact()?.solve(pressure) {
                Ok(_) | Err(FemError::PathEnded { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    fn contact(&mut self) -> Result<&mut SteadyContact, SolveError> {
        let contact = match self.contact.take() {
            Some(contact) => contact,
            None => (self.set_up)()?,
        };
        Ok(self.contact.insert(contact))
    }
}

/// A piece of work whose solves are kept: a curve of one surface at one speed, or a microscale.
pub(crate) trait SolveTask: Sync + Sized {
    /// The sections of a recipe that say how it is solved.
    type Parameters: Sync;
    /// What it gives.
    type Output: Send;

    /// Digest of what all its solves have in common, under which they are kept; tasks of one problem belong into one
    /// shard of a sweep.
    fn problem(&self, parameters: &Self::Parameters, rubber: &RubberModel) -> Digest;

    /// Digest of all that determines which solves it asks for.
    fn key(&self, parameters: &Self::Parameters, rubber: &RubberModel) -> Digest;

    /// What it is, for messages: `bem, 8 waves, realisation 3, 10 mm/s`.
    fn name(&self) -> String;

    /// Solves what the store does not have, and notes that it has all then.
    ///
    /// # Errors
    /// [`StageError`] of a contact that cannot be solved; [`StageError::Interrupted`]; those of the store.
    fn solve(
        &self,
        parameters: &Self::Parameters,
        rubber: &RubberModel,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<Self::Output, StageError>;

    /// Whether a packed store has all its solves.
    ///
    /// # Errors
    /// [`ArtifactError::Io`].
    fn is_finished(
        &self,
        parameters: &Self::Parameters,
        rubber: &RubberModel,
        store: &SolveStore,
    ) -> Result<bool, ArtifactError> {
        let solves = store.problem(&self.problem(parameters, rubber))?;
        Ok(solves.is_finished(&self.key(parameters, rubber)))
    }
}

/// The tasks that a packed store does not have.
///
/// # Errors
/// [`ArtifactError::Io`].
pub(crate) fn unfinished<T: SolveTask>(
    tasks: Vec<T>,
    parameters: &T::Parameters,
    rubber: &RubberModel,
    store: &SolveStore,
) -> Result<Vec<T>, ArtifactError> {
    let mut missing = Vec::new();
    for task in tasks {
        if !task.is_finished(parameters, rubber, store)? {
            missing.push(task);
        }
    }
    Ok(missing)
}

/// Counts pieces of work for who looks on.
pub(crate) struct Tally<'a> {
    watch: Watch<'a>,
    done: AtomicU64,
}

impl<'a> Tally<'a> {
    /// Nothing is done yet.
    pub fn new(watch: Watch<'a>) -> Self {
        Self { watch, done: AtomicU64::new(0) }
    }

    /// Pieces that are done.
    pub fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    /// Does the work for each item, side by side, and counts it; results in the order of the items. `total` is what
    /// this and earlier calls amount to, as far as it is known.
    ///
    /// # Errors
    /// The first in time of `work`; [`StageError::Interrupted`].
    pub fn side_by_side<T: Sync, R: Send, E: From<StageError> + Send>(
        &self,
        items: &[T],
        total: u64,
        work: impl Fn(&T) -> Result<R, E> + Sync,
    ) -> Result<Vec<R>, E> {
        (self.watch.progress)(self.done(), total);
        items
            .par_iter()
            .map(|item| {
                self.watch.check_interrupt()?;
                let result = work(item)?;
                (self.watch.progress)(1 + self.done.fetch_add(1, Ordering::Relaxed), total);
                Ok(result)
            })
            .collect()
    }
}
