//! What a task is expected to cost, by rules that give the same everywhere: shares must not depend on how
//! busy a machine was.
//!
//! A curve of the half-space costs points times iterations, which two trial curves of each approximation tell, at the
//! lowest and the highest speed. Finite elements are too dear to try; their cost is that of the main job,
//! scaled. One measured time, that of the trials, turns the costs into the seconds of this machine.

use super::task::{Solvers, Task};
use super::{Prepared, SweepError};
use crate::artifact::SolveStore;
use crate::contact::areal::memory_bytes;
use crate::fem::cost::{MeshCost, solves_of_curve};
use crate::recipe::Case;
use crate::stages::areal;
use crate::stages::bem::{self, SolveRow};
use crate::stages::fem::{self, Fem};
use crate::stages::kept::SolveTask;
use crate::stages::realise::SurfaceKind;
use crate::stages::{StageError, Watch};
use crate::units::Units;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::time::Instant;

/// Seconds for a grid point and an iteration of the half-space with all that comes with it, error estimate and
/// set-up included: 60 curves of the recipe `pipelines/sweep.toml` in 4.7 s, 128 on four times the points in 47 s.
const SECONDS_PER_POINT_AND_ITERATION: f64 = 4.4e-7;
/// Iterations of a whole curve where no trial tells.
const TYPICAL_ITERATIONS: f64 = 22.0;
/// The largest local pressure over the mean pressure in the contacts: 2.1 and 1.4 in the main job.
const PEAK: f64 = 1.7;
/// Bytes for a grid point of a contact with its coarser grids, as in a forecast.
const BYTES_PER_POINT: f64 = 250.0;

/// Seconds and memory of one task.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Cost {
    pub seconds: f64,
    pub megabytes: f64,
}

/// Trial curves of one approximation of one specimen, at the lowest and the highest speed.
struct Trial {
    grid_points: f64,
    /// Speed in mm/s, seconds and points of the finest grid.
    ends: Vec<(f64, f64, f64)>,
}

/// What tasks cost.
pub(super) struct Costs<'a> {
    solvers: &'a Solvers,
    /// By specimen and number of waves.
    trials: BTreeMap<(Option<String>, SurfaceKind), Trial>,
    /// Seconds of this machine for one of the reference.
    pub slowness: f64,
}

impl<'a> Costs<'a> {
    /// Solves the trial curves, which are tasks of the sweep themselves.
    pub fn try_out(
        prepared: &Prepared,
        solvers: &'a Solvers,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<Self, SweepError> {
        let speeds = &solvers.bem.speeds_mm_s;
        let lowest = speeds.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = speeds.iter().copied().fold(0.0, f64::max);
        let ends = if lowest < highest { vec![lowest, highest] } else { vec![lowest] };
        let mut curves = Vec::new();
        for (case, surfaces) in prepared.first_cases() {
            for surface in surfaces.iter().filter(|surface| surface.realisation == 1) {
                for &speed_mm_s in &ends {
                    let task = bem::Task { surface: surface.clone(), speed_mm_s };
                    curves.push((case, task));
                }
            }
        }
        let solved: Vec<Option<(Vec<SolveRow>, f64, bool)>> = curves
            .par_iter()
            .map(|(case, task)| {
                watch.check_interrupt()?;
                let rubber = prepared.rubber(*case);
                let there = task.is_finished(&solvers.bem, rubber, store)?;
                let start = Instant::now();
                match task.solve(&solvers.bem, rubber, store, watch) {
                    Ok(curve) => Ok(Some((curve.solves, start.elapsed().as_secs_f64(), there))),
                    // The shard that gets it says so.
                    Err(StageError::Contact { .. }) => Ok(None),
                    Err(error) => Err(error.into()),
                }
            })
            .collect::<Result<_, SweepError>>()?;
        let mut trials: BTreeMap<(Option<String>, SurfaceKind), Trial> = BTreeMap::new();
        let (mut measured, mut expected) = (0.0, 0.0);
        for ((case, task), solved) in curves.iter().zip(solved) {
            let Some((rows, elapsed, there)) = solved else { continue };
            let work: f64 = rows.iter().map(|row| (row.iterations * row.grid_points) as f64).sum();
            let seconds = SECONDS_PER_POINT_AND_ITERATION * work;
            if !there {
                (measured, expected) = (measured + elapsed, expected + seconds);
            }
            let finest = rows.iter().map(|row| row.grid_points).max().unwrap_or(0) as f64;
            let key = (prepared.cases[*case].specimen.clone(), task.surface.kind);
            let grid_points = task.grid_points(&solvers.bem) as f64;
            let trial =
                trials.entry(key).or_insert_with(|| Trial { grid_points, ends: Vec::new() });
            trial.ends.push((task.speed_mm_s, seconds, finest));
        }
        let slowness = if expected > 0.0 { measured / expected } else { 1.0 };
        Ok(Self { solvers, trials, slowness })
    }

    /// The cost of a task of a case.
    pub fn of(&self, task: &Task, case: &Case) -> Cost {
        match task {
            Task::Bem(task) => {
                let grid_points = task.grid_points(&self.solvers.bem) as f64;
                let trial = self.trials.get(&(case.specimen.clone(), task.surface.kind));
                trial.map_or_else(
                    || Cost {
                        seconds: SECONDS_PER_POINT_AND_ITERATION * TYPICAL_ITERATIONS * grid_points,
                        megabytes: (2.0 * grid_points * BYTES_PER_POINT).bytes_to_megabytes(),
                    },
                    |trial| trial.scaled(task.speed_mm_s, grid_points),
                )
            }
            Task::Areal(task) => areal(task, &self.solvers.areal),
            Task::Micro(task) => {
                let local = |pressed: &crate::stages::micro::PressedSurface| {
                    PEAK * pressed.most_pressure_mpa / pressed.contact_area_fraction
                };
                let most = task.surfaces.iter().map(local).fold(0.0, f64::max);
                let mesh = task.cost(&self.solvers.micro);
                finite(mesh, mesh.seconds_pressed_to(most))
            }
            Task::Fem(task) => self.all_waves(task, &self.solvers.fem.fem),
            Task::Multilevel(task) => self.all_waves(task, &self.solvers.pairs.fem),
        }
    }

    fn all_waves(&self, task: &fem::Task, parameters: &Fem) -> Cost {
        let solves = solves_of_curve(self.solvers.bem.wanted().range(), parameters.pressure_ratio);
        let mesh = fem::cost(parameters, &task.surface);
        finite(mesh, mesh.seconds_of_solves(solves))
    }
}

/// A curve of an areal surface: points times the solves of a curve, and what a solve holds.
fn areal(task: &areal::Task, sweep: &areal::Sweep) -> Cost {
    let points = sweep.areal.grid(&task.surface);
    Cost {
        seconds: sweep.seconds(points),
        megabytes: (memory_bytes(points[0], points[1]) as f64).bytes_to_megabytes(),
    }
}

fn finite(mesh: MeshCost, seconds: f64) -> Cost {
    Cost { seconds, megabytes: mesh.megabytes() }
}

impl Trial {
    /// Between the speeds of the trials in their logarithm, in proportion to the points of the grid.
    fn scaled(&self, speed_mm_s: f64, grid_points: f64) -> Cost {
        let (first, last) = (self.ends[0], self.ends[self.ends.len() - 1]);
        let range = (last.0 / first.0).ln();
        let part = if range > 0.0 { (speed_mm_s / first.0).ln() / range } else { 0.0 };
        let between = |low: f64, high: f64| low + part * (high - low);
        let scale = grid_points / self.grid_points;
        Cost {
            seconds: scale * between(first.1, last.1),
            // A contact is kept on all of its grids: twice the finest one.
            megabytes: (2.0 * scale * first.2.max(last.2) * BYTES_PER_POINT).bytes_to_megabytes(),
        }
    }
}
