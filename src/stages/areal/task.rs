//! One curve as a task of a sweep, which any machine can solve.

use super::curve::{Curve, CurveResult, problem};
use super::{Areal, ArealCurveRow, ArealUnsolvedRow};
use crate::artifact::{Digest, SolveStore};
use crate::contact::CurveValue;
use crate::contact::curve::CurveError;
use crate::rubber::RubberModel;
use crate::stages::bem::{Given, Wanted};
use crate::stages::kept::SolveTask;
use crate::stages::realise::ArealSurface;
use crate::stages::{SolveError, StageError, Watch, keys};
use crate::units::Units;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Friction over contact area of one areal surface at one speed in one direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// The surface.
    pub surface: ArealSurface,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// Direction of sliding in degrees from x towards y.
    pub angle_deg: f64,
}

/// The sections of a recipe that say how areal curves are solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Section `[areal]`.
    pub areal: Areal,
    /// Contact areas and pressures, those of the half-space.
    pub wanted: Wanted,
}

/// Seconds for a grid point of a solve with its coarser grids: 8.6 s for a lossy rubber on 1024 by 1024 points.
const SECONDS_PER_POINT: f64 = 8.2e-6;
/// Solves of a curve beside those of its areas and pressures.
const SEARCH_SOLVES: usize = 4;

impl Sweep {
    /// Expected wall time in s of a curve on a grid.
    pub(crate) fn seconds(&self, points: [usize; 2]) -> f64 {
        let solves = (self.wanted.count() + SEARCH_SOLVES) as f64;
        SECONDS_PER_POINT * (points[0] * points[1]) as f64 * solves
    }
}

impl SolveTask for Task {
    type Parameters = Sweep;
    type Output = CurveResult;

    fn problem(&self, sweep: &Sweep, rubber: &RubberModel) -> Digest {
        Digest::of_value(&problem(&sweep.areal, rubber, self))
    }

    fn key(&self, sweep: &Sweep, rubber: &RubberModel) -> Digest {
        Digest::of_value(&json!({
            "stage": ["areal", super::REVISION],
            "problem": self.problem(sweep, rubber),
            "area_fractions": sweep.wanted.area_fractions,
            "pressures_mpa": sweep.wanted.pressures_mpa,
            "tolerance": sweep.areal.tolerance,
            "field_area_fractions": sweep.areal.field_area_fractions,
        }))
    }

    fn name(&self) -> String {
        format!("{} at {} degrees", self.surface.name_at("areal", self.speed_mm_s), self.angle_deg)
    }

    fn solve(
        &self,
        sweep: &Sweep,
        rubber: &RubberModel,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<CurveResult, StageError> {
        let mut curve = Curve::new(sweep, rubber, self, store, watch.interrupted)?;
        let computed = curve.compute(sweep).map_err(|source| self.failed(source))?;
        curve.finish(&self.key(sweep, rubber))?;
        let row = |(given, value): &(Given, CurveValue)| ArealCurveRow {
            kind: self.surface.kind,
            realisation: self.surface.realisation,
            speed_mm_s: self.speed_mm_s,
            angle_deg: self.angle_deg,
            given: *given,
            contact_area_fraction: value.contact_area_fraction,
            pressure_mpa: value.mean_pressure.pa_to_mpa(),
            friction_coefficient: value.friction_coefficient,
            interpolation_error: value.interpolation_error,
            discretisation_error: value.discretisation_error,
            relative_area_error: value.relative_area_error,
        };
        let mut failure = None;
        let mut unsolved = Vec::new();
        for (given, asked, source) in computed.unsolved {
            let reason = format!("{source}{}", keys::of_areal_curve(&source));
            unsolved.push(self.unsolved(given, asked, reason));
            failure.get_or_insert_with(|| self.failed(source));
        }
        Ok(CurveResult {
            curve: computed.values.iter().map(row).collect(),
            unsolved,
            failure,
            fields: computed.fields,
            least_friction: curve.least_friction(),
            solves: curve.into_solves(),
        })
    }
}

impl Task {
    /// The row of an area, or a pressure in Pa, without a value.
    fn unsolved(&self, given: Given, asked: f64, reason: String) -> ArealUnsolvedRow {
        let of = |other: Given| (given == other).then_some(asked);
        ArealUnsolvedRow {
            kind: self.surface.kind,
            realisation: self.surface.realisation,
            speed_mm_s: self.speed_mm_s,
            angle_deg: self.angle_deg,
            given,
            contact_area_fraction: of(Given::Area),
            pressure_mpa: of(Given::Pressure).map(Units::pa_to_mpa),
            reason,
        }
    }

    fn failed(&self, source: CurveError<SolveError>) -> StageError {
        let (kind, realisation) = (self.surface.kind, self.surface.realisation);
        let (speed_mm_s, angle_deg) = (self.speed_mm_s, self.angle_deg);
        let contact =
            |source| StageError::ArealContact { kind, realisation, speed_mm_s, angle_deg, source };
        match source {
            CurveError::Solve(error) => {
                error.in_stage(|error| contact(Box::new(CurveError::Solve(*error))))
            }
            source => contact(Box::new(source)),
        }
    }
}
