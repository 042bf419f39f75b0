//! One curve as a task of a sweep, which any machine can solve.

use super::curve::{Curve, base_points, problem};
use super::ensemble::CurveResult;
use super::{Bem, CurveRow, Given};
use crate::artifact::{Digest, SolveStore};
use crate::contact::CurveValue;
use crate::contact::curve::CurveError;
use crate::rubber::RubberModel;
use crate::stages::kept::SolveTask;
use crate::stages::realise::Surface;
use crate::stages::{SolveError, StageError, Watch};
use crate::units::Units;
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

impl SolveTask for Task {
    type Parameters = Bem;
    type Output = CurveResult;

    fn problem(&self, _: &Bem, rubber: &RubberModel) -> Digest {
        Digest::of_value(&problem(rubber, &self.surface, self.speed_mm_s))
    }

    fn key(&self, parameters: &Bem, rubber: &RubberModel) -> Digest {
        let mut key = json!({
            "stage": ["bem", super::REVISION],
            "problem": self.problem(parameters, rubber),
            "area_fractions": parameters.area_fractions,
            "tolerance": parameters.interpolation_tolerance(),
            "grid_tolerance": parameters.grid_tolerance,
            "points_per_shortest_wavelength": parameters.points_per_shortest_wavelength,
            "fewest_contact_points": parameters.fewest_contact_points,
            "field_area_fractions": parameters.field_area_fractions,
        });
        if !parameters.pressures_mpa.is_empty() {
            key["pressures_mpa"] = json!(parameters.pressures_mpa);
        }
        Digest::of_value(&key)
    }

    fn name(&self) -> String {
        self.surface.name_at("bem", self.speed_mm_s)
    }

    fn solve(
        &self,
        parameters: &Bem,
        rubber: &RubberModel,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<CurveResult, StageError> {
        let Self { surface, speed_mm_s } = self;
        let mut curve =
            Curve::new(parameters, rubber, surface, *speed_mm_s, store, watch.interrupted)?;
        let (values, fields) = curve.compute(parameters).map_err(|source| self.failed(source))?;
        curve.finish(&self.key(parameters, rubber))?;
        let row = |(given, value): &(Given, CurveValue)| CurveRow {
            kind: surface.kind,
            realisation: surface.realisation,
            speed_mm_s: *speed_mm_s,
            given: *given,
            contact_area_fraction: value.contact_area_fraction,
            pressure_mpa: value.mean_pressure.pa_to_mpa(),
            friction_coefficient: value.friction_coefficient,
            interpolation_error: value.interpolation_error,
            discretisation_error: value.discretisation_error,
            left_out_error: 0.0,
            relative_area_error: value.relative_area_error,
        };
        let values = values.iter().map(row).collect();
        Ok(CurveResult { solves: curve.into_solves(), values, fields })
    }
}

impl Task {
    /// Points of the grid that most pressures are solved on.
    pub fn grid_points(&self, parameters: &Bem) -> usize {
        base_points(parameters, &self.surface)
    }

    fn failed(&self, source: CurveError<SolveError>) -> StageError {
        let (kind, realisation) = (self.surface.kind, self.surface.realisation);
        let speed_mm_s = self.speed_mm_s;
        let contact = |source| StageError::Contact { kind, realisation, speed_mm_s, source };
        match source {
            CurveError::Solve(error) => {
                error.in_stage(|error| contact(Box::new(CurveError::Solve(*error))))
            }
            source => contact(Box::new(source)),
        }
    }
}
