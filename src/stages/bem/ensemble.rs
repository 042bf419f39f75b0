//! The curves of one approximation at one speed, of as many realisations as their average needs.

use super::reduction::LeftOut;
use super::worth::Worth;
use super::{CurveRow, FieldSolution, SolveRow};
use crate::stages::realise::Surface;

/// Realisations from whose spread the number that is needed is judged first.
pub(crate) const FIRST_REALISATIONS: usize = 8;
/// Their number is at most multiplied by this at once: it follows from a spread that is not well known yet.
const MOST_GROWTH: usize = 4;
/// And grows by this share at least, so that the last few do not come one by one.
const LEAST_GROWTH: f64 = 0.1;

/// The solves, the curve and the fields of one surface at one speed.
pub(crate) struct CurveResult {
    pub solves: Vec<SolveRow>,
    pub values: Vec<CurveRow>,
    pub(super) fields: Vec<FieldSolution>,
}

/// One approximation at one speed.
pub(super) struct Ensemble<'a> {
    pub speed_mm_s: f64,
    /// All its surfaces.
    pub surfaces: &'a [Surface],
    /// The curves of the first of them.
    pub results: Vec<CurveResult>,
    /// Number of curves that are wanted.
    pub wanted: usize,
    /// Of these with all waves.
    pub with_all_waves: usize,
    /// What the others do without.
    pub left_out: LeftOut,
    /// What more curves cannot mend.
    worth: Worth,
}

impl<'a> Ensemble<'a> {
    /// All realisations of the surfaces, or the first ones if an accuracy of the average is asked for. Of measured windows
    /// all: which of them are left out must not depend on their order.
    pub fn new(
        surfaces: &'a [Surface],
        speed_mm_s: f64,
        tolerance: Option<f64>,
        worth: Worth,
    ) -> Self {
        let all = surfaces.len();
        let measured = surfaces.first().is_some_and(|surface| surface.kind.method.is_measured());
        let first = worth.whole_rounds(FIRST_REALISATIONS);
        let wanted = if tolerance.is_some() && !measured { all.min(first) } else { all };
        Self {
            speed_mm_s,
            surfaces,
            results: Vec::new(),
            wanted,
            with_all_waves: all,
            left_out: LeftOut::default(),
            worth,
        }
    }

    /// The surfaces whose curves are wanted and not solved.
    pub fn open(&self) -> &'a [Surface] {
        &self.surfaces[self.results.len()..self.wanted]
    }

    /// Whether the curve of that surface is solved with all waves.
    pub fn with_all_waves_of(&self, surface: &Surface) -> bool {
        surface.realisation as usize <= self.with_all_waves
    }

    /// The surface as it is solved, without the waves that are left out of it.
    pub fn to_solve(&self, surface: &Surface) -> Surface {
        if self.with_all_waves_of(surface) {
            surface.clone()
        } else {
            self.left_out.reduce(surface)
        }
    }

    /// The wanted number from the curves so far; it stays if they will do or if there are no more.
    pub fn extend(&mut self, tolerance: f64) {
        let solved = self.results.len();
        let curves: Vec<&[CurveRow]> =
            self.results.iter().map(|result| &result.values[..]).collect();
        let needed = self.worth.realisations_needed(&curves, tolerance).unwrap_or(solved);
        if needed > solved {
            let least = solved + (LEAST_GROWTH * solved as f64).ceil() as usize;
            let wanted = needed.max(least).min(MOST_GROWTH * solved);
            self.wanted = self.worth.whole_rounds(wanted).min(self.surfaces.len());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::worth::tests::row;
    use super::*;
    use crate::numerics::statistics::MeanEstimate;
    use crate::stages::realise::SurfaceKind;
    use crate::surface::SineScale;
    use crate::surface::realisation::random_phases;
    use std::f64::consts::TAU;

    /// 95 of 100 intervals hold the true mean where the number is given beforehand. Here it follows
    /// from the same sample, which stops early when its spread is small by chance: a few less.
    #[test]
    fn averages_that_stop_when_they_are_good_enough_still_hold_the_mean() {
        let (mut inside, ensembles) = (0, 400);
        for seed in 0..ensembles {
            // Skewed, with a mean of 2/3 and a spread of 0.9 times that; of phase differences, which
            // friction depends on.
            let friction = |k: usize| {
                let scales = [SineScale { wavelength: 1.0, amplitude: 1.0 }; 2];
                let waves = random_phases(&scales, seed, k as u64);
                2.0 * ((waves[1].phase - waves[0].phase) / TAU).rem_euclid(1.0).powi(2)
            };
            let mut count = FIRST_REALISATIONS;
            let surface =
                Surface { kind: SurfaceKind::sines(1), realisation: 1, profile: Vec::new() };
            let surfaces = vec![surface; 5000];
            let mut ensemble = Ensemble::new(&surfaces, 1.0, Some(0.1), Worth::UNLIMITED);
            loop {
                for k in ensemble.results.len()..count {
                    let values = vec![row(friction(k), 0.0)];
                    ensemble.results.push(CurveResult { solves: vec![], values, fields: vec![] });
                }
                ensemble.extend(0.1);
                if ensemble.wanted == count {
                    break;
                }
                assert!(ensemble.wanted > count && ensemble.wanted <= MOST_GROWTH * count);
                count = ensemble.wanted;
            }
            let values: Vec<f64> = (0..count).map(friction).collect();
            let estimate = MeanEstimate::of(&values);
            assert!(estimate.confidence_95 <= 0.1 * estimate.mean);
            inside += usize::from((estimate.mean - 2.0 / 3.0).abs() <= estimate.confidence_95);
        }
        let share = inside as f64 / ensembles as f64;
        assert!(share >= 0.92, "{share}");
    }
}
