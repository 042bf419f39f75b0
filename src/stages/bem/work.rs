//! The curves of all ensembles: those that are missing, solved side by side.

use super::ensemble::{CurveResult, Ensemble};
use super::reduction::LeftOut;
use super::{Bem, CurveRow, Task};
use crate::artifact::SolveStore;
use crate::rubber::RubberModel;
use crate::stages::kept::{SolveTask, Tally};
use crate::stages::realise::Surface;
use crate::stages::{StageError, Watch};
use rayon::prelude::*;

/// What the curves are made of.
pub(super) struct Work<'a> {
    parameters: &'a Bem,
    rubber: &'a RubberModel,
    store: &'a SolveStore,
    watch: Watch<'a>,
    tally: Tally<'a>,
}

impl<'a> Work<'a> {
    pub fn new(
        parameters: &'a Bem,
        rubber: &'a RubberModel,
        store: &'a SolveStore,
        watch: Watch<'a>,
    ) -> Self {
        Self { parameters, rubber, store, watch, tally: Tally::new(watch) }
    }

    /// Solves the curves of all ensembles, as many as their averages need.
    pub fn solve_all(&self, ensembles: &mut [Ensemble]) -> Result<(), StageError> {
        while ensembles.iter().any(|ensemble| !ensemble.open().is_empty()) {
            self.solve_open(ensembles)?;
            self.extend_all(ensembles)?;
        }
        Ok(())
    }

    /// The curves that are wanted next and that the store does not have; none if it has all. How many
    /// realisations an accuracy needs follows from those it has.
    pub fn missing(&self, ensembles: &mut [Ensemble]) -> Result<Vec<Task>, StageError> {
        while ensembles.iter().any(|ensemble| !ensemble.open().is_empty()) {
            let missing = self.missing_of_open(ensembles)?;
            if !missing.is_empty() {
                return Ok(missing);
            }
            if self.parameters.average_tolerance.is_none() {
                break;
            }
            self.solve_open(ensembles)?;
            self.extend_all(ensembles)?;
        }
        Ok(Vec::new())
    }

    /// The curves that are open now and that the store does not have.
    pub fn missing_of_open(&self, ensembles: &[Ensemble]) -> Result<Vec<Task>, StageError> {
        let mut missing = Vec::new();
        for ensemble in ensembles {
            for surface in ensemble.open() {
                let task =
                    Task { surface: ensemble.to_solve(surface), speed_mm_s: ensemble.speed_mm_s };
                if !task.is_finished(self.parameters, self.rubber, self.store)? {
                    missing.push(task);
                }
            }
        }
        Ok(missing)
    }

    fn extend_all(&self, ensembles: &mut [Ensemble]) -> Result<(), StageError> {
        let Some(tolerance) = self.parameters.average_tolerance else { return Ok(()) };
        ensembles.par_iter_mut().try_for_each(|ensemble| self.extend(ensemble, tolerance))
    }

    /// Solves all curves that are wanted, side by side.
    fn solve_open(&self, ensembles: &mut [Ensemble]) -> Result<(), StageError> {
        let total: usize = ensembles.iter().map(|ensemble| ensemble.wanted).sum();
        let tasks: Vec<(&Ensemble, &Surface)> = ensembles
            .iter()
            .flat_map(|ensemble| ensemble.open().iter().map(move |surface| (ensemble, surface)))
            .collect();
        let solve =
            |&(ensemble, surface): &(&Ensemble, &Surface)| self.of_ensemble(ensemble, surface);
        let results: Vec<CurveResult> = self.tally.side_by_side(&tasks, total as u64, solve)?;
        let mut results = results.into_iter();
        for ensemble in ensembles {
            let count = ensemble.open().len();
            ensemble.results.extend(results.by_ref().take(count));
        }
        Ok(())
    }

    /// The curve of one surface of an ensemble, without the waves that the ensemble leaves out of it.
    fn of_ensemble(
        &self,
        ensemble: &Ensemble,
        surface: &Surface,
    ) -> Result<CurveResult, StageError> {
        let mut result = self.one_curve(&ensemble.to_solve(surface), ensemble.speed_mm_s)?;
        if !ensemble.with_all_waves_of(surface) {
            ensemble.left_out.complete(self.rubber, surface, &mut result.values);
        }
        Ok(result)
    }

    /// How many realisations an ensemble needs; if many more, which waves they can do without.
    fn extend(&self, ensemble: &mut Ensemble, tolerance: f64) -> Result<(), StageError> {
        let solved = ensemble.results.len();
        ensemble.extend(tolerance);
        // Fields show the whole surface, and the waves of windows have no scales in common.
        let of_windows = ensemble.surfaces.iter().any(|surface| surface.kind.method.of_a_window());
        let whole = of_windows || !self.parameters.field_area_fractions.is_empty();
        if whole || !LeftOut::pays(solved, ensemble.wanted) {
            return Ok(());
        }
        let full: Vec<&[CurveRow]> =
            ensemble.results.iter().map(|result| &result.values[..]).collect();
        let surfaces = &ensemble.surfaces[..solved];
        let left_out =
            LeftOut::find(self.rubber, surfaces, &full, tolerance, |surface| {
                match self.one_curve(surface, ensemble.speed_mm_s) {
                    Ok(result) => Ok(Some(result.values)),
                    Err(StageError::Contact { .. }) => Ok(None),
                    Err(error) => Err(error),
                }
            })?;
        if left_out != LeftOut::default() {
            (ensemble.left_out, ensemble.with_all_waves) = (left_out, solved);
        }
        Ok(())
    }

    pub fn one_curve(&self, surface: &Surface, speed_mm_s: f64) -> Result<CurveResult, StageError> {
        let task = Task { surface: surface.clone(), speed_mm_s };
        task.solve(self.parameters, self.rubber, self.store, self.watch)
    }
}
