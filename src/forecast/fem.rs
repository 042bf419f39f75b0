//! What all waves at finite deformation will ask for.

use super::{CurveForecast, Trial};
use crate::fem::cost::solves_of_curve;
use crate::stages::Chain;
use crate::stages::fem::{self, Fem};
use crate::stages::realise::SurfaceKind;
use serde::Serialize;

/// Curves with all waves at finite deformation, of one approximation at one speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FemForecast {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// Realisations.
    pub realisations: u32,
    /// Elements over the period.
    pub columns: usize,
    /// Pressures of a curve.
    pub solves: usize,
    /// Expected seconds of one curve, on one thread.
    pub seconds_each: f64,
    /// Memory of one curve in MB.
    pub megabytes_each: f64,
}

/// Those of all approximations that the stage solves.
pub(super) fn curves(
    parameters: &Fem,
    chain: &Chain,
    trial: &Trial,
    curves: &[CurveForecast],
) -> Vec<FemForecast> {
    let solves = solves_of_curve(chain.bem.wanted().range(), parameters.pressure_ratio);
    let of_curve = |curve: &CurveForecast| {
        let surface = trial.first_surfaces().find(|surface| surface.kind == curve.kind)?;
        let mesh = fem::cost(parameters, surface);
        Some(FemForecast {
            kind: curve.kind,
            speed_mm_s: curve.speed_mm_s,
            realisations: curve.realisations,
            columns: mesh.columns,
            solves: solves.ceil() as usize,
            seconds_each: mesh.seconds_of_solves(solves),
            megabytes_each: mesh.megabytes(),
        })
    };
    curves.iter().filter(|curve| parameters.solves(curve.kind)).filter_map(of_curve).collect()
}

/// Wall time of the stage: its curves run side by side.
pub(super) fn seconds(forecasts: &[FemForecast], threads: usize) -> f64 {
    let total: f64 = forecasts.iter().map(|f| f64::from(f.realisations) * f.seconds_each).sum();
    let longest = forecasts.iter().map(|forecast| forecast.seconds_each).fold(0.0, f64::max);
    longest.max(total / threads as f64)
}
