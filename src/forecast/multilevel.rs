//! How many realisations the stage multilevel will solve with finite elements, and what they cost.

use super::{CurveForecast, Trial};
use crate::fem::cost::solves_of_curve;
use crate::stages::Chain;
use crate::stages::fem;
use crate::stages::multilevel::{Multilevel, is_negligible};
use crate::stages::realise::SurfaceKind;
use serde::Serialize;

/// The realisations of one approximation at one speed that are solved under both models.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MultilevelForecast {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// How many: the first realisations; 0 where the surface is so gentle that the models hardly differ.
    pub pairs: u32,
    /// The number that it may grow to if the differences of the first ones vary too much for the tolerance.
    pub most_pairs: u32,
    /// Elements over the period.
    pub columns: usize,
    /// Expected seconds of one of them, on one thread.
    pub seconds_each: f64,
}

/// Those of all approximations and speeds.
pub(super) fn pairs(
    parameters: &Multilevel,
    chain: &Chain,
    trial: &Trial,
    curves: &[CurveForecast],
) -> Vec<MultilevelForecast> {
    let fem = parameters.fem();
    let solves = solves_of_curve(chain.bem.wanted().range(), fem.pressure_ratio);
    let tolerance = chain.bem.average_tolerance;
    let of_curve = |curve: &CurveForecast| {
        let surface = trial.first_surfaces().find(|surface| surface.kind == curve.kind)?;
        let columns = fem::columns(&fem, surface);
        let negligible = tolerance.is_some_and(|tolerance| is_negligible(surface, tolerance));
        let limited = |count: u32| if negligible { 0 } else { count.min(chain.realise.drawn()) };
        let pairs = limited(parameters.first_realisations);
        let most_pairs =
            if tolerance.is_some() { limited(parameters.most_realisations) } else { pairs };
        Some(MultilevelForecast {
            kind: curve.kind,
            speed_mm_s: curve.speed_mm_s,
            pairs,
            most_pairs,
            columns,
            seconds_each: fem::cost(&fem, surface).seconds_of_solves(solves),
        })
    };
    curves.iter().filter_map(of_curve).collect()
}

/// Wall time of the first pairs, which run side by side.
pub(super) fn seconds(forecasts: &[MultilevelForecast], threads: usize) -> f64 {
    let total: f64 = forecasts.iter().map(|f| f64::from(f.pairs) * f.seconds_each).sum();
    let present = forecasts.iter().filter(|forecast| forecast.pairs > 0);
    let longest = present.map(|forecast| forecast.seconds_each).fold(0.0, f64::max);
    longest.max(total / threads as f64)
}
