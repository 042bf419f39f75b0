//! One curve as a task of a sweep, which any machine can solve.

use super::curve::{base_points, problem};
use super::work::Work;
use super::{Bem, SolveRow};
use crate::artifact::{ArtifactError, Digest, SolveStore};
use crate::rubber::Rubber;
use crate::stages::realise::Surface;
use crate::stages::{StageError, Watch};
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Friction over contact area of one surface at one speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// The surface; waves that are left out have no amplitude.
    pub surface: Surface,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
}

impl Task {
    /// Digest of surface, rubber and speed: under which the solves are kept.
    pub fn problem(&self, rubber: &Rubber) -> Digest {
        problem(rubber, &self.surface, self.speed_mm_s)
    }

    /// Digest of all that determines which solves the task asks for.
    pub fn key(&self, parameters: &Bem, rubber: &Rubber) -> Digest {
        Self::key_of(parameters, rubber, &self.surface, self.speed_mm_s)
    }

    pub(super) fn key_of(
        parameters: &Bem,
        rubber: &Rubber,
        surface: &Surface,
        speed_mm_s: f64,
    ) -> Digest {
        Digest::of_value(&json!({
            "stage": ["bem", super::REVISION],
            "problem": problem(rubber, surface, speed_mm_s),
            "area_fractions": parameters.area_fractions,
            "tolerance": parameters.interpolation_tolerance(),
            "grid_tolerance": parameters.grid_tolerance,
            "points_per_shortest_wavelength": parameters.points_per_shortest_wavelength,
            "fewest_contact_points": parameters.fewest_contact_points,
            "field_area_fractions": parameters.field_area_fractions,
        }))
    }

    /// Whether a packed store has all solves of the task.
    ///
    /// # Errors
    /// [`ArtifactError::Io`].
    pub fn is_finished(
        &self,
        parameters: &Bem,
        rubber: &Rubber,
        store: &SolveStore,
    ) -> Result<bool, ArtifactError> {
        Ok(store.problem(&self.problem(rubber))?.is_finished(&self.key(parameters, rubber)))
    }

    /// Solves what a packed store does not have; returns all solves.
    ///
    /// # Errors
    /// [`StageError::Contact`], [`StageError::Interrupted`], those of the store.
    pub fn solve(
        &self,
        parameters: &Bem,
        rubber: &Rubber,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<Vec<SolveRow>, StageError> {
        let work = Work::new(parameters, rubber, store, watch);
        Ok(work.one_curve(&self.surface, self.speed_mm_s)?.solves)
    }

    /// Points of the grid that most pressures are solved on.
    pub fn grid_points(&self, parameters: &Bem) -> usize {
        base_points(parameters, &self.surface)
    }
}
