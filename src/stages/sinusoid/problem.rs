//! One wave, model, speed and mesh under a list of pressures: the unit of the store.

use crate::artifact::SolveStore;
use crate::contact::{ContactError, ContactSolution, SlidingContact};
use crate::fem::error::{FemError, PathEnd};
use crate::fem::profile::RigidProfile;
use crate::fem::steady::solution::SteadySolution;
use crate::fem::steady::{BlockOptions, SteadyContact};
use crate::numerics::Interrupt;
use crate::rubber::{Rheology, Rubber};
use crate::stages::SolveError;
use crate::stages::kept::{self, Kept};
use crate::surface::{Wave, wave};
use crate::units::Units;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Revision of the contact solvers: part of the key of every stored solve. To be raised when the
/// same problem gives another number.
const SOLVER_REVISION: u32 = 7;

/// A contact model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// Linear viscoelastic half-space (VHS).
    HalfSpace,
    /// Linear viscoelastic stress in the logarithmic strain.
    Linear,
    /// Neo-Hooke in finite viscoelasticity.
    NeoHookean,
}

impl Model {
    /// All models.
    pub const ALL: [Self; 3] = [Self::HalfSpace, Self::Linear, Self::NeoHookean];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::HalfSpace => "half-space",
            Self::Linear => "linear",
            Self::NeoHookean => "neo-hookean",
        }
    }
}

impl std::fmt::Display for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// What is solved as one: pressures follow each other, so that a path goes on from one to the next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Problem {
    pub model: Model,
    pub wavelength_mm: f64,
    pub aspect_ratio: f64,
    pub speed_mm_s: f64,
    /// Ascending.
    pub pressures_mpa: Vec<f64>,
    /// Columns of the mesh or points of the grid.
    pub columns: usize,
    pub keeps_fields: bool,
}

/// What came of one pressure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum Outcome {
    Solved(Solved),
    NoSolution { why: String, path_ended_at_mpa: Option<f64> },
}

/// A converged solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Solved {
    pub friction_coefficient: f64,
    pub hysteretic_friction: f64,
    pub contact_area_fraction: f64,
    pub mean_separation_mm: f64,
    pub residual: f64,
    /// Empty where the fields are not kept.
    pub nodes: Vec<FieldPoint>,
}

/// A point of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct FieldPoint {
    pub x_mm: f64,
    pub profile_height_mm: f64,
    pub pressure_mpa: f64,
    pub separation_mm: f64,
}

impl Outcome {
    pub fn solved(&self) -> Option<&Solved> {
        match self {
            Self::Solved(solved) => Some(solved),
            Self::NoSolution { .. } => None,
        }
    }

    pub fn path_ended_at_mpa(&self) -> Option<f64> {
        match self {
            Self::Solved(_) => None,
            Self::NoSolution { path_ended_at_mpa, .. } => *path_ended_at_mpa,
        }
    }
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self { aspect_ratio, speed_mm_s, columns, .. } = self;
        let model = self.model;
        write!(f, "{model}, D/L = {aspect_ratio}, {speed_mm_s} mm/s, {columns} columns")
    }
}

impl Problem {
    /// The outcome of each pressure, from the store if it is there. Where the path from the pressure
    /// before ends, one from the first contact is tried.
    pub fn outcomes(
        &self,
        rubber: &Rubber,
        store: &SolveStore,
        interrupt: &Interrupt,
    ) -> Result<Vec<Outcome>, SolveError> {
        let mut problem = kept::problem("sinusoid", SOLVER_REVISION, &rubber.clone().into());
        problem["problem"] = json!(self);
        Kept::open(store, problem, interrupt)?.take_or(&[], || match self.model {
            Model::HalfSpace => self.half_space(rubber, interrupt),
            Model::Linear => self.finite_deformation(rubber, Rheology::Linear, interrupt),
            Model::NeoHookean => self.finite_deformation(rubber, Rheology::NeoHookean, interrupt),
        })
    }

    fn wave(&self) -> Wave {
        let wavelength = self.wavelength_mm.mm_to_m();
        Wave { wavelength, amplitude: self.aspect_ratio * wavelength, phase: 0.0 }
    }

    fn half_space(
        &self,
        rubber: &Rubber,
        interrupt: &Interrupt,
    ) -> Result<Vec<Outcome>, SolveError> {
        let wave = self.wave();
        let heights = wave::sample(&[wave], wave.wavelength, self.columns);
        let speed = self.speed_mm_s.mm_to_m();
        let mut contact =
            SlidingContact::new_interruptible(rubber, speed, wave.wavelength, &heights, interrupt)?;
        // Every pressure is solved from scratch, so one that fails is no end.
        let outcome = |pressure: &f64| match contact.solve(pressure.mpa_to_pa()) {
            Ok(solution) => Ok(Outcome::Solved(self.read_half_space(&solution, &heights))),
            Err(error @ ContactError::NotConverged { .. }) => {
                Ok(Outcome::NoSolution { why: error.to_string(), path_ended_at_mpa: None })
            }
            Err(error) => Err(error.into()),
        };
        self.pressures_mpa.iter().map(outcome).collect()
    }

    fn read_half_space(&self, solution: &ContactSolution, heights: &[f64]) -> Solved {
        let spacing_mm = self.wavelength_mm / self.columns as f64;
        let point = |i: usize| FieldPoint {
            x_mm: i as f64 * spacing_mm,
            profile_height_mm: heights[i].m_to_mm(),
            pressure_mpa: solution.pressure[i].pa_to_mpa(),
            separation_mm: solution.separation[i].m_to_mm(),
        };
        let kept = if self.keeps_fields { self.columns } else { 0 };
        Solved {
            friction_coefficient: solution.friction_coefficient,
            hysteretic_friction: solution.hysteretic_friction,
            contact_area_fraction: solution.contact_area_fraction,
            mean_separation_mm: solution.mean_separation.m_to_mm(),
            residual: solution.residual,
            nodes: (0..kept).map(point).collect(),
        }
    }

    fn finite_deformation(
        &self,
        rubber: &Rubber,
        rheology: Rheology,
        interrupt: &Interrupt,
    ) -> Result<Vec<Outcome>, SolveError> {
        let wave = self.wave();
        let speed = self.speed_mm_s.mm_to_m();
        let set_up = || {
            let profile = RigidProfile::from_waves(&[wave], wave.wavelength);
            let options = BlockOptions::of_profile(self.columns, &profile);
            SteadyContact::new(rubber, rheology, speed, profile, options)
                .map(|contact| contact.interruptible(interrupt))
        };
        // The contact at the pressure before, if it has a solution.
        let mut last: Option<SteadyContact> = None;
        let solve = |pressure: &f64| {
            if let Some(mut contact) = last.take() {
                match contact.solve(pressure.mpa_to_pa()) {
                    Ok(solution) => {
                        last = Some(contact);
                        return Ok(Outcome::Solved(self.read_block(&solution)));
                    }
                    Err(error) if error.is_no_solution() => {}
                    Err(error) => return Err(error.into()),
                }
            }
            let mut contact = set_up()?;
            match contact.solve(pressure.mpa_to_pa()) {
                Ok(solution) => {
                    last = Some(contact);
                    Ok(Outcome::Solved(self.read_block(&solution)))
                }
                Err(error @ FemError::PathEnded { .. }) => Ok(no_solution(&error)),
                Err(error) => Err(error.into()),
            }
        };
        self.pressures_mpa.iter().map(solve).collect()
    }

    fn read_block(&self, solution: &SteadySolution) -> Solved {
        let kept = if self.keeps_fields { solution.nodes.as_slice() } else { &[] };
        let mut nodes: Vec<FieldPoint> = kept
            .iter()
            .map(|node| FieldPoint {
                // Nodes are carried along by the rubber, out of the period they began in.
                x_mm: node.x.m_to_mm().rem_euclid(self.wavelength_mm),
                profile_height_mm: node.profile_height.m_to_mm(),
                pressure_mpa: node.pressure.pa_to_mpa(),
                separation_mm: node.separation.m_to_mm(),
            })
            .collect();
        nodes.sort_by(|a, b| a.x_mm.total_cmp(&b.x_mm));
        Solved {
            friction_coefficient: solution.friction_coefficient,
            hysteretic_friction: solution.hysteretic_friction,
            contact_area_fraction: solution.contact_area_fraction,
            mean_separation_mm: solution.mean_separation.m_to_mm(),
            residual: solution.residual,
            nodes,
        }
    }
}

fn no_solution(error: &FemError) -> Outcome {
    let path_ended_at_mpa = match error {
        FemError::PathEnded { reached: PathEnd::At { pressure, .. }, .. } => {
            Some(pressure.pa_to_mpa())
        }
        _ => None,
    };
    Outcome::NoSolution { why: error.to_string(), path_ended_at_mpa }
}
