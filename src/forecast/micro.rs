//! What the microscales will ask of the finite elements.

use super::{CurveForecast, ForecastError, Trial};
use crate::contact::SlidingContact;
use crate::fem::cost::MeshCost;
use crate::fem::profile::RigidProfile;
use crate::multiscale::scales::Scales;
use crate::numerics::Interrupt;
use crate::stages::micro::{Micro, Parting, stretches};
use crate::stages::realise::SurfaceKind;
use crate::stages::{SolveError, StageError};
use crate::units::Units;
use serde::Serialize;

/// A microscale at one speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MicroForecast {
    /// Which surfaces, the first of those that have it.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// Waves that it has.
    pub micro_waves: usize,
    /// Elements over its period.
    pub columns: usize,
    /// Largest pressure of the macro contact, to which it is pressed, in MPa.
    pub most_pressure_mpa: f64,
    /// Expected seconds, on one thread.
    pub seconds: f64,
}

/// The microscales of the surfaces, from the macro contact of the first realisation at the largest
/// area. Several micro waves have phases, and so a microscale of their own in each realisation.
pub(super) fn microscales(
    parameters: &Micro,
    trial: &Trial,
    forecasts: &[CurveForecast],
    interrupt: &Interrupt,
) -> Result<Vec<MicroForecast>, ForecastError> {
    let rubber = &trial.rubber;
    let mut found: Vec<(MicroForecast, Scales)> = Vec::new();
    for surface in trial.first_surfaces() {
        let own = std::slice::from_ref(surface);
        let parting = Parting::of(own, parameters.rms_slope_threshold);
        let mut scales = parting.scales(&surface.profile);
        if scales.micro.is_empty() || scales.macroscale.is_empty() {
            continue;
        }
        let mut micro_period = scales.micro.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
        let mut of_stretches = 1.0;
        if let Parting::Shorter(limit) = parting {
            let found = stretches(parameters, own, limit)?;
            let Some(first) = found.first() else { continue };
            of_stretches = found.len() as f64;
            (scales.micro, micro_period) = (first.waves.clone(), first.period);
        }
        let shared = |other: &(MicroForecast, Scales)| {
            crate::stages::micro::same_waves(&other.1.micro, &scales.micro)
        };
        for rows in trial.first_curves().filter(|rows| rows[0].kind == surface.kind) {
            let most = rows.iter().max_by(|a, b| a.pressure_mpa.total_cmp(&b.pressure_mpa));
            let (row, speed_mm_s) = (most.unwrap_or(&rows[0]), rows[0].speed_mm_s);
            if found.iter().any(|other| other.0.speed_mm_s == speed_mm_s && shared(other)) {
                continue;
            }
            let same = |curve: &&CurveForecast| {
                (curve.kind, curve.speed_mm_s) == (surface.kind, speed_mm_s)
            };
            let realisations =
                forecasts.iter().find(same).map_or(1.0, |curve| f64::from(curve.realisations));
            let (heights, period) = parameters.macro_heights(surface, &scales.macroscale);
            let solve = || -> Result<f64, SolveError> {
                let speed = speed_mm_s.mm_to_m();
                let mut contact =
                    SlidingContact::new_interruptible(rubber, speed, period, &heights, interrupt)?;
                let solution = contact.solve(row.pressure_mpa.mpa_to_pa())?;
                Ok(solution.pressure.iter().copied().fold(0.0, f64::max))
            };
            let most = solve().map_err(|error| {
                let (kind, realisation) = (surface.kind, surface.realisation);
                error.in_stage(|source| {
                    let source = Box::new(crate::contact::curve::CurveError::Solve(*source));
                    StageError::Contact { kind, realisation, speed_mm_s, source }
                })
            })?;
            let shortest = scales.micro[0].wavelength;
            let columns = crate::stages::micro::columns(
                parameters.columns_per_shortest_wavelength,
                micro_period,
                shortest,
            );
            let most_pressure_mpa = most.pa_to_mpa();
            let profile = RigidProfile::from_waves(&scales.micro, micro_period);
            let mesh = MeshCost::new(&profile, columns, parameters.estimate_mesh_error);
            let each = match parting {
                Parting::Shorter(_) => of_stretches,
                Parting::Steep(_) if scales.micro.len() == 1 => 1.0,
                Parting::Steep(_) => realisations,
            };
            let forecast = MicroForecast {
                kind: surface.kind,
                speed_mm_s,
                micro_waves: scales.micro.len(),
                columns,
                most_pressure_mpa,
                seconds: each * mesh.seconds_pressed_to(most_pressure_mpa),
            };
            found.push((forecast, scales.clone()));
        }
    }
    Ok(found.into_iter().map(|(forecast, _)| forecast).collect())
}

/// Wall time of the stage: its microscales run side by side.
pub(super) fn seconds(microscales: &[MicroForecast], threads: usize) -> f64 {
    let total: f64 = microscales.iter().map(|micro| micro.seconds).sum();
    let longest = microscales.iter().map(|micro| micro.seconds).fold(0.0, f64::max);
    longest.max(total / threads as f64)
}
