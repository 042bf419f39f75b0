//! The curves of all ensembles: those that are missing, solved side by side.

use super::Multilevel;
use super::ensemble::Ensemble;
use crate::artifact::SolveStore;
use crate::rubber::RubberModel;
use crate::stages::bem::{self, Bem, CurveRow};
use crate::stages::fem::{self, FemCurve};
use crate::stages::kept::{SolveTask, Tally};
use crate::stages::realise::Surface;
use crate::stages::{StageError, Watch};
use rayon::prelude::*;

/// What is to be solved next.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Missing {
    /// Further curves of the half-space.
    pub half_space: Vec<bem::Task>,
    /// Curves at finite deformation.
    pub full: Vec<fem::Task>,
}

impl Missing {
    /// Whether nothing is.
    pub fn is_empty(&self) -> bool {
        self.half_space.is_empty() && self.full.is_empty()
    }
}

/// What the curves are made of.
pub(super) struct Work<'a> {
    sweep: fem::Sweep,
    bem: &'a Bem,
    rubber: &'a RubberModel,
    store: &'a SolveStore,
    watch: Watch<'a>,
    tally: Tally<'a>,
}

impl<'a> Work<'a> {
    pub fn new(
        parameters: &Multilevel,
        bem: &'a Bem,
        rubber: &'a RubberModel,
        store: &'a SolveStore,
        watch: Watch<'a>,
    ) -> Self {
        let sweep = parameters.sweep(bem);
        Self { sweep, bem, rubber, store, watch, tally: Tally::new(watch) }
    }

    /// Solves the curves of all ensembles, as many as their averages need.
    pub fn solve_all(&self, ensembles: &mut [Ensemble]) -> Result<(), StageError> {
        loop {
            self.solve_open(ensembles)?;
            // Without pairs nothing is open at first, and the half-space may still be too little.
            ensembles.par_iter_mut().for_each(Ensemble::extend);
            if ensembles.iter().all(Ensemble::is_complete) {
                return Ok(());
            }
        }
    }

    /// The curves that are wanted next and that the store does not have. How many an accuracy needs follows
    /// from those it has. Pairs wait for the half-space, whose pressures they begin at.
    pub fn missing(&self, ensembles: &mut [Ensemble]) -> Result<Missing, StageError> {
        loop {
            let mut missing = Missing::default();
            for ensemble in &*ensembles {
                for surface in ensemble.open_half_space() {
                    let (surface, speed_mm_s) = (surface.clone(), ensemble.speed_mm_s);
                    let task = bem::Task { surface, speed_mm_s };
                    if !task.is_finished(self.bem, self.rubber, self.store)? {
                        missing.half_space.push(task);
                    }
                }
                let pairs = ensemble.open_pairs().iter();
                for task in pairs.filter_map(|surface| ensemble.fem_task(surface)) {
                    if !task.is_finished(&self.sweep, self.rubber, self.store)? {
                        missing.full.push(task);
                    }
                }
            }
            if !missing.is_empty() {
                return Ok(missing);
            }
            self.solve_open(ensembles)?;
            ensembles.par_iter_mut().for_each(Ensemble::extend);
            if ensembles.iter().all(Ensemble::is_complete) {
                return Ok(Missing::default());
            }
        }
    }

    /// Solves all curves that are wanted, side by side: the half-space first.
    fn solve_open(&self, ensembles: &mut [Ensemble]) -> Result<(), StageError> {
        let wanted = |e: &Ensemble| e.open_half_space().len() + e.open_pairs().len();
        let open: usize = ensembles.iter().map(wanted).sum();
        let total = self.tally.done() + open as u64;
        let half_space: Vec<bem::Task> = ensembles
            .iter()
            .flat_map(|e| {
                let speed_mm_s = e.speed_mm_s;
                let task =
                    move |surface: &Surface| bem::Task { surface: surface.clone(), speed_mm_s };
                e.open_half_space().iter().map(task)
            })
            .collect();
        let Self { sweep, bem, rubber, store, watch, .. } = self;
        let curves: Vec<Vec<CurveRow>> = self.tally.side_by_side(&half_space, total, |task| {
            Ok::<_, StageError>(task.solve(bem, rubber, store, *watch)?.values)
        })?;
        let mut curves = curves.into_iter();
        for ensemble in &mut *ensembles {
            let count = ensemble.open_half_space().len();
            ensemble.half_space.extend(curves.by_ref().take(count));
        }
        let pairs: Vec<Vec<fem::Task>> = ensembles
            .iter()
            .map(|e| e.open_pairs().iter().filter_map(|surface| e.fem_task(surface)).collect())
            .collect();
        let tasks: Vec<&fem::Task> = pairs.iter().flatten().collect();
        let solve = |task: &&fem::Task| task.solve(sweep, rubber, store, *watch);
        let curves: Vec<FemCurve> = self.tally.side_by_side(&tasks, total, solve)?;
        let mut curves = curves.into_iter();
        for (ensemble, pairs) in ensembles.iter_mut().zip(&pairs) {
            ensemble.full.extend(curves.by_ref().take(pairs.len()));
        }
        Ok(())
    }
}
