//! Whether the realisations that may be drawn can have the accuracy that is asked for, before grids are
//! refined to it.
//!
//! The statistical error of an average falls with the root of the number of realisations, that of a grid
//! with the square of its points: an accuracy of 1e-6 is a matter of seconds for one contact, and of 10^9
//! realisations for the average of a road. Grids that fine would take hours for the first curve alone, and the
//! average would miss the accuracy all the same.

use super::ensemble::FIRST_REALISATIONS;
use super::work::Work;
use super::{Bem, CurveRow};
use crate::artifact::SolveStore;
use crate::contact::refine::LEAST_FRICTION;
use crate::numerics::statistics::MeanEstimate;
use crate::rubber::RubberModel;
use crate::stages::realise::Surface;
use crate::stages::{StageError, Watch};
use rayon::prelude::*;

/// Accuracies from this on are tried without asking: grids for them take seconds.
const EASY: f64 = 0.01;
/// Of friction on the grids, and between the pressures, from which the spread is judged.
const TRIAL: f64 = EASY / 4.0;
/// The spread of eight is known to a factor of two, the number that is needed to one of four: only what
/// exceeds the realisations that there are by more than this is out of reach for certain.
const CERTAINLY_TOO_MANY: usize = 10;
/// A spread below this many times the errors of the trial may be theirs, as that of a single wave is,
/// whose friction does not depend on its phase.
const LEAST_SPREAD: f64 = 4.0;

/// What the first realisations of one approximation at one speed tell.
struct Verdict {
    /// Number of realisations that the accuracy asks for.
    needed: usize,
    /// Relative statistical error of the average over as many as may be drawn.
    attainable: f64,
}

/// Refuses an accuracy of the averages that `most` realisations are far from giving. The `surfaces` are
/// of any number of approximations, each by its realisations from the first.
///
/// # Errors
/// [`StageError::TooFewRealisations`]; those of the solves.
pub(crate) fn require_attainable(
    parameters: &Bem,
    rubber: &RubberModel,
    surfaces: &[Surface],
    most: usize,
    store: &SolveStore,
    watch: Watch,
) -> Result<(), StageError> {
    let Some(tolerance) = parameters.average_tolerance.filter(|tolerance| *tolerance < EASY) else {
        return Ok(());
    };
    let trial = Bem {
        tolerance: Some(TRIAL),
        grid_tolerance: Some(TRIAL),
        field_area_fractions: Vec::new(),
        ..parameters.clone()
    };
    let work = Work::new(&trial, rubber, store, watch);
    for of_one in surfaces.chunk_by(|a, b| a.kind == b.kind) {
        let first = &of_one[..of_one.len().min(FIRST_REALISATIONS)];
        for &speed_mm_s in &parameters.speeds_mm_s {
            let curves: Vec<Vec<CurveRow>> = first
                .par_iter()
                .map(|surface| Ok(work.one_curve(surface, speed_mm_s)?.values))
                .collect::<Result<_, StageError>>()?;
            if let Some(Verdict { needed, attainable }) = verdict(&curves, tolerance, most) {
                let kind = of_one[0].kind;
                return Err(StageError::TooFewRealisations {
                    kind,
                    speed_mm_s,
                    tolerance,
                    needed,
                    most,
                    attainable,
                });
            }
        }
    }
    Ok(())
}

/// The verdict at the area that asks for most, if that is certainly too many.
fn verdict(curves: &[Vec<CurveRow>], tolerance: f64, most: usize) -> Option<Verdict> {
    let areas = curves.first().map_or(0, Vec::len);
    let at_area = |k: usize| {
        let friction: Vec<f64> = curves.iter().map(|curve| curve[k].friction_coefficient).collect();
        let estimate = MeanEstimate::of(&friction);
        let error =
            |row: &CurveRow| row.interpolation_error + row.discretisation_error.unwrap_or(0.0);
        let largest = curves.iter().map(|curve| error(&curve[k])).fold(0.0, f64::max);
        let known = estimate.standard_deviation > LEAST_SPREAD * largest;
        let mean = estimate.mean.abs().max(LEAST_FRICTION);
        let needed = estimate.count_for(tolerance * mean).filter(|_| known)?;
        let attainable = tolerance * (needed as f64 / most as f64).sqrt();
        Some(Verdict { needed, attainable })
    };
    (0..areas)
        .filter_map(at_area)
        .max_by_key(|verdict| verdict.needed)
        .filter(|verdict| verdict.needed > CERTAINLY_TOO_MANY.saturating_mul(most))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::bem::Given;
    use crate::stages::realise::SurfaceKind;

    fn curves(friction: [f64; 4], error: f64) -> Vec<Vec<CurveRow>> {
        let row = |friction_coefficient| CurveRow {
            kind: SurfaceKind::sines(1),
            realisation: 1,
            speed_mm_s: 1.0,
            given: Given::Area,
            contact_area_fraction: 0.1,
            pressure_mpa: 1.0,
            friction_coefficient,
            interpolation_error: 0.0,
            discretisation_error: Some(error),
            left_out_error: 0.0,
            relative_area_error: None,
        };
        friction.map(|friction| vec![row(friction)]).to_vec()
    }

    #[test]
    fn only_what_is_certainly_out_of_reach_is_refused() {
        let spread = curves([0.9, 1.0, 1.1, 1.0], 1e-3);
        // 1.96 x 0.0816 / 1e-4, squared.
        let found = verdict(&spread, 1e-4, 1000).unwrap();
        assert!((2_550_000..2_570_000).contains(&found.needed), "{}", found.needed);
        approx::assert_relative_eq!(found.attainable, 5.06e-3, max_relative = 1e-2);
        assert!(verdict(&spread, 5e-3, 1000).is_none());
        assert!(verdict(&spread, 1e-8, 1000).is_some());
    }

    #[test]
    fn a_spread_that_may_be_that_of_the_grids_tells_nothing() {
        let of_the_grids = curves([0.999, 1.0, 1.001, 1.0], 1e-3);
        assert!(verdict(&of_the_grids, 1e-8, 1000).is_none());
        assert!(verdict(&curves([1.0; 4], 1e-3)[..1], 1e-8, 1000).is_none());
    }
}
