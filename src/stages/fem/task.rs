//! One curve as a task, which any machine can solve.

use super::curve::{CurveResult, Solver, problem};
use super::{Fem, FemCurveRow};
use crate::artifact::{Digest, SolveStore};
use crate::fem::cost::MeshCost;
use crate::fem::error::FemError;
use crate::fem::profile::RigidProfile;
use crate::fem::steady::COLUMNS_RANGE;
use crate::rubber::RubberModel;
use crate::stages::bem::{Bem, CurveRow, Wanted};
use crate::stages::kept::SolveTask;
use crate::stages::micro::{columns, is_of};
use crate::stages::realise::Surface;
use crate::stages::{SolveError, StageError, Watch};
use crate::units::Units;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Friction over contact area of one surface at one speed, with all waves at finite deformation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// The surface.
    pub surface: Surface,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// Pressure in Pa of the smallest wanted area on the half-space: where the sweep begins.
    pub first_guess: f64,
}

/// How a curve is swept: the sections of a recipe, or what stands for them.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// Mesh and steps of pressure.
    pub fem: Fem,
    /// Contact areas and pressures at which the recipe asks for friction.
    pub wanted: Wanted,
}

/// The surfaces and speeds that the half-space has curves of, as far as they are wanted.
pub(super) fn tasks(
    parameters: &Fem,
    bem: &Bem,
    surfaces: &[Surface],
    half_space: &[CurveRow],
) -> Vec<Task> {
    let mut tasks = Vec::new();
    for surface in surfaces.iter().filter(|surface| parameters.solves(surface.kind)) {
        for &speed_mm_s in &bem.speeds_mm_s {
            let first = half_space.iter().find(|row| is_of(row, surface, speed_mm_s));
            tasks.extend(first.map(|row| Task {
                surface: surface.clone(),
                speed_mm_s,
                first_guess: row.pressure_mpa.mpa_to_pa(),
            }));
        }
    }
    tasks
}

impl SolveTask for Task {
    type Parameters = Sweep;
    type Output = CurveResult;

    fn problem(&self, parameters: &Sweep, rubber: &RubberModel) -> Digest {
        let columns = self.columns(&parameters.fem);
        Digest::of_value(&problem(rubber, &self.surface, self.speed_mm_s, columns))
    }

    fn key(&self, parameters: &Sweep, rubber: &RubberModel) -> Digest {
        let mut key = json!({
            "stage": ["fem", super::REVISION],
            "problem": self.problem(parameters, rubber),
            "parameters": parameters.fem,
            "area_fractions": parameters.wanted.area_fractions,
            "first_guess": self.first_guess,
        });
        if !parameters.wanted.pressures_mpa.is_empty() {
            key["pressures_mpa"] = json!(parameters.wanted.pressures_mpa);
        }
        Digest::of_value(&key)
    }

    fn name(&self) -> String {
        self.surface.name_at("fem", self.speed_mm_s)
    }

    fn solve(
        &self,
        parameters: &Sweep,
        rubber: &RubberModel,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<CurveResult, StageError> {
        let Self { surface, speed_mm_s, first_guess } = self;
        let Sweep { fem, wanted } = parameters;
        let (kind, realisation) = (surface.kind, surface.realisation);
        let failed = |source: SolveError| {
            let speed_mm_s = *speed_mm_s;
            source.in_stage(|source| StageError::FiniteDeformation {
                kind,
                realisation,
                speed_mm_s,
                source,
            })
        };
        let columns = self.columns(fem);
        let new = |columns| Solver::new(columns, fem, rubber, surface, *speed_mm_s, store, watch);
        let mut solver = new(columns).map_err(failed)?;
        let ended = match solver.sweep(wanted, *first_guess) {
            Err(SolveError::FiniteDeformation(error @ FemError::PathEnded { .. })) => Some(error),
            other => other.map_err(failed)?,
        };
        let mut rows = solver.values(wanted);
        if let Some(coarser) = solver.coarser_values(wanted) {
            add_mesh_errors(&mut rows, &coarser);
        } else if fem.estimate_mesh_error {
            let mut coarser = new((columns / 2).max(*COLUMNS_RANGE.start())).map_err(failed)?;
            match coarser.sweep(wanted, *first_guess) {
                Ok(_) | Err(SolveError::FiniteDeformation(FemError::PathEnded { .. })) => {}
                Err(error) => return Err(failed(error)),
            }
            add_mesh_errors(&mut rows, &coarser.values(wanted));
        }
        solver.finish(&self.key(parameters, rubber))?;
        let missing = wanted.count() - rows.len();
        let warning = (missing > 0).then(|| {
            let why = ended.map_or_else(
                || "its area does not get there".into(),
                |error| format!("{error}; try another fem.columns_per_shortest_wavelength"),
            );
            format!(
                "{kind}, realisation {realisation}, {speed_mm_s} mm/s: {missing} of the \
                 contact areas and pressures are not reached: {why}"
            )
        });
        let coarse = solver.coarse_mesh();
        let warnings = warning.into_iter().chain(coarse).collect();
        Ok(CurveResult { rows, solves: solver.into_solves(), warnings })
    }
}

impl Task {
    /// Elements over the period of the surface.
    pub fn columns(&self, parameters: &Fem) -> usize {
        columns_of(parameters, &self.surface)
    }
}

/// Writes the differences to the values of a coarser mesh, where it has them.
fn add_mesh_errors(rows: &mut [FemCurveRow], coarser: &[FemCurveRow]) {
    for row in rows {
        let same = coarser.iter().find(|other| other.condition() == row.condition());
        row.discretisation_error =
            same.map(|other| (row.friction_coefficient - other.friction_coefficient).abs());
    }
}

/// Columns of the mesh of a surface.
pub(super) fn columns_of(parameters: &Fem, surface: &Surface) -> usize {
    let waves = &surface.profile;
    let period = waves.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
    let present = waves.iter().filter(|wave| wave.amplitude != 0.0);
    let shortest = present.map(|wave| wave.wavelength).fold(period, f64::min);
    columns(parameters.columns_per_shortest_wavelength, period, shortest)
}

/// What a contact of a surface costs.
pub(super) fn cost_of(parameters: &Fem, surface: &Surface) -> MeshCost {
    let period = surface.profile.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
    let profile = RigidProfile::from_waves(&surface.profile, period);
    MeshCost::new(&profile, columns_of(parameters, surface), parameters.estimate_mesh_error)
}
