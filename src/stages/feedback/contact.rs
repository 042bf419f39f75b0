//! The contacts of one surface at one speed, under every effect.

use super::laws::Laws;
use super::{ContactRow, Effect, Task};
use crate::artifact::{ArtifactError, SolveStore};
use crate::contact::effective::{
    EffectiveContact, EffectiveError, FeedbackContact, FeedbackSetup, WaveFactors,
};
use crate::contact::refine::{GridError, OnGrid};
use crate::error_kind::{ErrorKind, HasKind};
use crate::numerics::Interrupt;
use crate::rubber::RubberModel;
use crate::rubber::payne::elongation_of_tensor_shear;
use crate::stages::SolveError;
use crate::stages::bem::{Bem, Curve, GridRule};
use crate::stages::kept::{self, Kept};
use crate::stages::realise::Surface;
use crate::surface::wave;
use crate::units::Units;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeMap;
use std::time::Instant;

/// Revision of the contacts with feedback: part of the key of every stored one. To be raised when the same problem gives another
/// number.
const SOLVER_REVISION: u32 = 1;

/// A contact, or why there is none: that takes longest to find out, and is kept like a solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Outcome {
    Solved(ContactRow),
    Unsolved(String),
}

/// What the contacts of a recipe have in common.
pub(super) struct Common<'a> {
    pub bem: &'a Bem,
    pub rubber: &'a RubberModel,
    pub laws: &'a Laws<'a>,
    pub store: &'a SolveStore,
    pub interrupted: &'a Interrupt,
}

/// Solves one surface at one speed and keeps what it solved.
pub(super) struct Contacts<'a> {
    common: &'a Common<'a>,
    task: &'a Task<'a>,
    /// Shear stress in Pa that heats the contact, if it is heated.
    shear_stress: Option<f64>,
    cold: Curve<'a>,
    rule: GridRule,
    kept: Kept<'a>,
}

impl<'a> Contacts<'a> {
    pub fn new(
        common: &'a Common<'a>,
        task: &'a Task<'a>,
        shear_stress: Option<f64>,
    ) -> Result<Self, ArtifactError> {
        let Common { bem, rubber, store, interrupted, .. } = *common;
        let Task { surface, speed_mm_s } = *task;
        let mut problem = kept::problem("feedback", SOLVER_REVISION, rubber);
        problem["profile"] = json!(surface.profile);
        problem["speed_mm_s"] = json!(speed_mm_s);
        Ok(Self {
            common,
            task,
            shear_stress,
            cold: Curve::new(bem, rubber, surface, speed_mm_s, store, interrupted)?,
            rule: GridRule::new(bem, surface),
            kept: Kept::open(store, problem, interrupted)?,
        })
    }

    /// The contact at a pressure in MPa under an effect; the cold one is that of the stage `bem`.
    ///
    /// # Errors
    /// Those that more than this contact would have: the interrupt, the store, a problem that is none.
    pub fn at(&mut self, pressure_mpa: f64, effect: Effect) -> Result<Outcome, SolveError> {
        let pressure = pressure_mpa.mpa_to_pa();
        if effect == Effect::Cold {
            return outcome(self.cold_at(pressure, pressure_mpa));
        }
        let (common, task, rule) = (self.common, self.task, self.rule);
        let stress = self.shear_stress.unwrap_or(0.0);
        let shear_mpa = self.shear_stress.filter(|_| effect.has_heat()).map(Units::pa_to_mpa);
        let values = [
            ("pressure", json!(pressure)),
            ("effect", json!(effect)),
            ("laws", common.laws.identity(effect, stress)),
            ("grid", json!(rule)),
        ];
        let found = self.kept.take_or(&values, || {
            let start = Instant::now();
            let mut ladder = Ladder::new(common, task, &rule, (pressure, effect, stress));
            let refined = rule.refined(pressure, |points| ladder.at(points), Found::view);
            outcome(refined.map(|refined| {
                let found = refined.solution;
                ContactRow {
                    contact_rise_k: found.contact_rise_k,
                    highest_rise_k: found.highest_rise_k,
                    shear_mpa,
                    largest_strain: found.largest_strain,
                    steps: found.steps,
                    residual: found.residual,
                    seconds: start.elapsed().as_secs_f64(),
                    ..row(task, (effect, pressure_mpa), found.grid, refined.error)
                }
            }))
        })?;
        // The name of the approximation and the number of the realisation are no part of the problem.
        Ok(match found {
            Outcome::Solved(row) => {
                let Surface { kind, realisation, .. } = *task.surface;
                Outcome::Solved(ContactRow { kind, realisation, ..row })
            }
            unsolved @ Outcome::Unsolved(_) => unsolved,
        })
    }

    fn cold_at(&mut self, pressure: f64, pressure_mpa: f64) -> Result<ContactRow, SolveError> {
        let (solved, error) = self.cold.contact(pressure)?;
        let grid = OnGrid {
            points: solved.grid_points as usize,
            friction_coefficient: solved.friction_coefficient,
            contact_area_fraction: solved.contact_area_fraction,
        };
        let (residual, seconds) = (solved.residual, solved.seconds);
        let row = row(self.task, (Effect::Cold, pressure_mpa), grid, error);
        Ok(ContactRow { residual, seconds, ..row })
    }
}

/// A row without what an effect adds to it.
fn row(
    task: &Task,
    (effect, pressure_mpa): (Effect, f64),
    grid: OnGrid,
    error: Option<GridError>,
) -> ContactRow {
    ContactRow {
        kind: task.surface.kind,
        realisation: task.surface.realisation,
        effect,
        speed_mm_s: task.speed_mm_s,
        pressure_mpa,
        friction_coefficient: grid.friction_coefficient,
        contact_area_fraction: grid.contact_area_fraction,
        discretisation_error: error.map(|error| error.friction_coefficient),
        relative_area_error: error
            .map(|error| error.contact_area_fraction / grid.contact_area_fraction),
        contact_rise_k: None,
        highest_rise_k: None,
        shear_mpa: None,
        largest_strain: None,
        steps: 1,
        grid_points: grid.points as u64,
        residual: 0.0,
        seconds: 0.0,
    }
}

fn outcome(found: Result<ContactRow, SolveError>) -> Result<Outcome, SolveError> {
    match found {
        Ok(row) => Ok(Outcome::Solved(row)),
        Err(error) if error.is_no_solution() => Ok(Outcome::Unsolved(error.to_string())),
        Err(error) => Err(error),
    }
}

/// One contact on one grid.
#[derive(Debug, Clone, Copy)]
struct Found {
    grid: OnGrid,
    contact_rise_k: Option<f64>,
    highest_rise_k: Option<f64>,
    largest_strain: Option<f64>,
    steps: u64,
    residual: f64,
}

impl Found {
    fn view(&self) -> OnGrid {
        self.grid
    }

    fn new(contact: &EffectiveContact, has_strain: bool) -> Self {
        let EffectiveContact { solution, heat, strain, .. } = contact;
        let largest = strain.iter().copied().fold(0.0, f64::max);
        Self {
            grid: OnGrid {
                points: solution.pressure.len(),
                friction_coefficient: solution.friction_coefficient,
                contact_area_fraction: solution.contact_area_fraction,
            },
            contact_rise_k: heat.as_ref().map(|heat| heat.contact_mean),
            highest_rise_k: heat.as_ref().map(|heat| heat.highest),
            largest_strain: has_strain.then(|| elongation_of_tensor_shear(largest)),
            steps: contact.steps as u64,
            residual: solution.residual,
        }
    }
}

/// A contact on one grid with its moduli, or why there is none.
type OnOneGrid = Result<(Found, WaveFactors), EffectiveError>;

/// One contact on grids from the coarsest on: the moduli of each are sought from those of the grid before, which takes half the
/// contacts that a search from the cold ones takes, and the coarser grids are solved for the error anyway.
struct Ladder<'a> {
    common: &'a Common<'a>,
    task: &'a Task<'a>,
    coarsest: usize,
    pressure: f64,
    effect: Effect,
    shear_stress: f64,
    /// By their points.
    solved: BTreeMap<usize, OnOneGrid>,
}

impl<'a> Ladder<'a> {
    fn new(
        common: &'a Common<'a>,
        task: &'a Task<'a>,
        rule: &GridRule,
        (pressure, effect, shear_stress): (f64, Effect, f64),
    ) -> Self {
        let coarsest = rule.coarsest_points();
        let solved = BTreeMap::new();
        Self { common, task, coarsest, pressure, effect, shear_stress, solved }
    }

    /// The contact on so many points, each number of them solved once.
    fn at(&mut self, points: usize) -> Result<Found, SolveError> {
        if !self.solved.contains_key(&points) {
            if points / 2 >= self.coarsest {
                match self.at(points / 2) {
                    Err(error) if !error.is_no_solution() => return Err(error),
                    _ => {}
                }
            }
            let finest = self.solved.values().rev().find_map(|found| found.as_ref().ok());
            let found = self.solve(points, finest.map(|(_, factors)| factors))?;
            self.solved.insert(points, found);
        }
        match &self.solved[&points] {
            Ok((found, _)) => Ok(*found),
            Err(error) => Err(error.clone().into()),
        }
    }

    /// The error is the interrupt.
    fn solve(&self, points: usize, start: Option<&WaveFactors>) -> Result<OnOneGrid, SolveError> {
        let Common { rubber, laws, interrupted, .. } = *self.common;
        let Task { surface, speed_mm_s } = *self.task;
        let period = surface.period();
        let goes_on = || !interrupted.is_set();
        let heights = wave::sample_while(&surface.profile, period, points, goes_on)
            .ok_or(SolveError::Interrupted)?;
        let setup = FeedbackSetup {
            interrupt: Some(interrupted),
            ..FeedbackSetup::new(rubber, speed_mm_s.mm_to_m(), period, &heights)
        };
        let setup = laws.apply(setup, self.effect, self.shear_stress);
        match effective(setup, self.pressure, start) {
            Err(error) if error.kind() == ErrorKind::Interrupted => Err(SolveError::Interrupted),
            Err(error) => Ok(Err(error)),
            Ok(contact) => {
                let found = Found::new(&contact, self.effect.has_strain());
                Ok(Ok((found, contact.factors)))
            }
        }
    }
}

/// Solves the fixed point from given factors; if that does not converge, starts again from the rubber without factors.
fn effective(
    setup: FeedbackSetup,
    pressure: f64,
    start: Option<&WaveFactors>,
) -> Result<EffectiveContact, EffectiveError> {
    let mut contact = FeedbackContact::new(setup)?;
    if let Some(start) = start {
        match contact.solve_from(pressure, start) {
            Err(error) if error.is_no_solution() => {}
            found => return found,
        }
    }
    contact.solve_effective(pressure)
}
