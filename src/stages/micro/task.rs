//! One microscale at one speed: what it is pressed by, and its sampling, on any machine.

use super::curve::{MicroCurve, problem};
use super::{Micro, Parting, TaskResult, columns, monotony, partings, same_waves, stretches};
use crate::artifact::{Digest, SolveStore};
use crate::fem::cost::MeshCost;
use crate::fem::profile::RigidProfile;
use crate::multiscale::scales::Scales;
use crate::multiscale::{LocalLaw, SoftContact};
use crate::numerics::Interrupt;
use crate::rubber::RubberModel;
use crate::stages::bem::CurveRow;
use crate::stages::kept::SolveTask;
use crate::stages::realise::Surface;
use crate::stages::realise::{Method, SurfaceKind};
use crate::stages::{SolveError, StageError, Watch};
use crate::surface::Wave;
use crate::units::Units;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// One microscale at one speed, and the surfaces that have it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// The approximations, or the realisations of them, whose microscale this is.
    pub owners: Vec<Owner>,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// Its waves.
    pub micro: Vec<Wave>,
    /// Period in m of a stretch; that of its longest wave if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period_m: Option<f64>,
    /// Wavelength in m below which waves of the surfaces are the microscale; where absent those that are steep by
    /// themselves are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shorter_than_m: Option<f64>,
    /// The surfaces that press it.
    pub surfaces: Vec<PressedSurface>,
}

/// An approximation, or one realisation of it, as the tables name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Owner {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Number of the realisation; 0 for all of them.
    pub realisation: u32,
    /// Number of the stretch, from 1; 0 for sines.
    #[serde(default)]
    pub stretch: u32,
}

/// A surface with the largest mean pressure of its half-space contacts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PressedSurface {
    /// The surface.
    pub surface: Surface,
    /// Mean pressure in MPa.
    pub most_pressure_mpa: f64,
    /// Contact area fraction at that pressure.
    pub contact_area_fraction: f64,
}

/// The microscales of the surfaces at the speeds of the curves.
pub(super) fn tasks(
    parameters: &Micro,
    surfaces: &[Surface],
    curves: &[CurveRow],
) -> Result<Vec<Task>, StageError> {
    let mut speeds: Vec<f64> = curves.iter().map(|row| row.speed_mm_s).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let mut tasks: Vec<Task> = Vec::new();
    for (own, parting) in partings(surfaces, parameters.rms_slope_threshold) {
        match parting {
            Parting::Steep(_) => of_sines(parameters, own, curves, &speeds, &mut tasks)?,
            Parting::Shorter(0.0) => {}
            Parting::Shorter(limit) => {
                tasks.extend(of_stretches(parameters, own, limit, curves, &speeds)?);
            }
        }
    }
    Ok(tasks)
}

/// The microscale of windows: every stretch at every speed, pressed by all surfaces of the kind.
fn of_stretches(
    parameters: &Micro,
    surfaces: &[Surface],
    limit: f64,
    curves: &[CurveRow],
    speeds: &[f64],
) -> Result<Vec<Task>, StageError> {
    let mut tasks = Vec::new();
    for stretch in stretches(parameters, surfaces, limit)? {
        for &speed_mm_s in speeds {
            let pressed: Vec<PressedSurface> = surfaces
                .iter()
                .filter_map(|surface| PressedSurface::of(surface, curves, speed_mm_s))
                .collect();
            let Some(first) = pressed.first() else { continue };
            let kind = first.surface.kind;
            tasks.push(Task {
                owners: vec![Owner { kind, realisation: 0, stretch: stretch.number }],
                speed_mm_s,
                micro: stretch.waves.clone(),
                period_m: Some(stretch.period),
                shorter_than_m: Some(limit),
                surfaces: pressed,
            });
        }
    }
    Ok(tasks)
}

/// Adds the microscales of sines, which surfaces share where they are the same.
fn of_sines(
    parameters: &Micro,
    surfaces: &[Surface],
    curves: &[CurveRow],
    speeds: &[f64],
    tasks: &mut Vec<Task>,
) -> Result<(), StageError> {
    for surface in surfaces {
        let Scales { micro, macroscale } =
            Scales::part(&surface.profile, parameters.rms_slope_threshold);
        if micro.is_empty() {
            continue;
        }
        if macroscale.is_empty() {
            let (kind, threshold) = (surface.kind, parameters.rms_slope_threshold);
            return Err(StageError::NoMacroscale { kind, threshold });
        }
        for &speed_mm_s in speeds {
            let Some(pressed) = PressedSurface::of(surface, curves, speed_mm_s) else { continue };
            let realisation = if micro.len() == 1 { 0 } else { surface.realisation };
            let owner = Owner { kind: surface.kind, realisation, stretch: 0 };
            let shared = tasks
                .iter_mut()
                .find(|task| task.speed_mm_s == speed_mm_s && same_waves(&task.micro, &micro));
            if let Some(task) = shared {
                task.surfaces.push(pressed);
                if !task.owners.contains(&owner) {
                    task.owners.push(owner);
                }
                continue;
            }
            let (owners, surfaces, micro) = (vec![owner], vec![pressed], micro.clone());
            let (period_m, shorter_than_m) = (None, None);
            tasks.push(Task { owners, speed_mm_s, micro, period_m, shorter_than_m, surfaces });
        }
    }
    Ok(())
}

/// Whether a value of the half-space is of that surface and speed: not all surfaces that were drawn
/// are needed.
pub(crate) fn is_of(row: &CurveRow, surface: &Surface, speed_mm_s: f64) -> bool {
    row.curve() == surface.at(speed_mm_s)
}

impl PressedSurface {
    /// None without a curve at that speed.
    fn of(surface: &Surface, curves: &[CurveRow], speed_mm_s: f64) -> Option<Self> {
        let own = curves.iter().filter(|row| is_of(row, surface, speed_mm_s));
        let most = own.max_by(|a, b| a.pressure_mpa.total_cmp(&b.pressure_mpa))?;
        Some(Self {
            surface: surface.clone(),
            most_pressure_mpa: most.pressure_mpa,
            contact_area_fraction: most.contact_area_fraction,
        })
    }
}

impl SolveTask for Task {
    type Parameters = Micro;
    type Output = TaskResult;

    fn problem(&self, parameters: &Micro, rubber: &RubberModel) -> Digest {
        Digest::of_value(&problem(parameters, rubber, self, self.columns(parameters)))
    }

    fn key(&self, parameters: &Micro, rubber: &RubberModel) -> Digest {
        let surfaces: Vec<_> = self
            .surfaces
            .iter()
            .map(|pressed| json!([pressed.surface.profile, pressed.most_pressure_mpa]))
            .collect();
        Digest::of_value(&json!({
            "stage": ["micro", super::REVISION],
            "problem": self.problem(parameters, rubber),
            "parameters": parameters,
            "surfaces": surfaces,
        }))
    }

    fn name(&self) -> String {
        format!("micro, {}, {} mm/s", self.owner_names(), self.speed_mm_s)
    }

    fn solve(
        &self,
        parameters: &Micro,
        rubber: &RubberModel,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<TaskResult, StageError> {
        let failed = |source: SolveError| {
            let (owners, speed_mm_s) = (self.owner_names(), self.speed_mm_s);
            source.in_stage(|source| StageError::Microscale { owners, speed_mm_s, source })
        };
        let mut curve = MicroCurve::new(parameters, rubber, self, store, watch.interrupted)?;
        let (law, rows) = curve.law().map_err(failed)?;
        let largest =
            self.largest_pressure(parameters, rubber, &law, watch.interrupted).map_err(failed)?;
        let (mut samples, warning) = curve.sample(largest).map_err(failed)?;
        if parameters.estimate_mesh_error {
            curve.estimate_mesh_error(&mut samples).map_err(failed)?;
        }
        curve.finish(&self.key(parameters, rubber))?;
        let mut warnings: Vec<String> = warning.into_iter().collect();
        let odd = monotony::breaks(&samples, self.columns(parameters));
        let (owners, speed_mm_s) = (self.owner_names(), self.speed_mm_s);
        warnings.extend(odd.map(|what| format!("{owners}, {speed_mm_s} mm/s: {what}")));
        Ok(TaskResult { samples, law: rows, warnings })
    }
}

impl Task {
    /// Period of the microscale in m.
    pub fn period(&self) -> f64 {
        let longest = self.micro.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
        self.period_m.unwrap_or(longest)
    }

    /// Elements over the period of the microscale.
    pub fn columns(&self, parameters: &Micro) -> usize {
        let period = self.period();
        let shortest = self.micro.iter().map(|wave| wave.wavelength).fold(period, f64::min);
        columns(parameters.columns_per_shortest_wavelength, period, shortest)
    }

    /// What its samples cost.
    pub fn cost(&self, parameters: &Micro) -> MeshCost {
        let period = self.period();
        let profile = RigidProfile::from_waves(&self.micro, period);
        MeshCost::new(&profile, self.columns(parameters), parameters.estimate_mesh_error)
    }

    /// The largest local pressure in Pa that the macro contacts reach.
    fn largest_pressure(
        &self,
        parameters: &Micro,
        rubber: &RubberModel,
        law: &LocalLaw,
        interrupt: &Interrupt,
    ) -> Result<f64, SolveError> {
        let mut largest = 0.0_f64;
        for pressed in &self.surfaces {
            let PressedSurface { surface, most_pressure_mpa, .. } = pressed;
            let threshold = parameters.rms_slope_threshold;
            let parting = self.shorter_than_m.map_or(Parting::Steep(threshold), Parting::Shorter);
            let scales = parting.scales(&surface.profile);
            let (heights, period) = parameters.macro_heights(surface, &scales.macroscale);
            let speed = self.speed_mm_s.mm_to_m();
            let law = law.clone();
            let mut contact =
                SoftContact::new_interruptible(rubber, speed, period, &heights, law, interrupt)?;
            let solution = contact.solve(most_pressure_mpa.mpa_to_pa())?;
            largest = solution.pressure.into_iter().fold(largest, f64::max);
        }
        Ok(largest)
    }

    /// "8 and 9 waves" or "8 waves, realisation 3", for messages.
    pub fn owner_names(&self) -> String {
        let mut kinds: Vec<SurfaceKind> = self.owners.iter().map(|owner| owner.kind).collect();
        kinds.dedup();
        let all_sines = kinds.iter().all(|kind| kind.method == Method::Sines);
        let of = |kind: &SurfaceKind| {
            if all_sines { kind.waves.to_string() } else { kind.to_string() }
        };
        let names = kinds.iter().map(of).collect::<Vec<_>>().join(" and ");
        let names = if all_sines { format!("{names} waves") } else { names };
        match self.owners.first().map(|owner| owner.realisation) {
            None | Some(0) => match self.owners.first().map(|owner| owner.stretch) {
                None | Some(0) => names,
                Some(stretch) => format!("{names}, stretch {stretch}"),
            },
            Some(realisation) => format!("{names}, realisation {realisation}"),
        }
    }
}
