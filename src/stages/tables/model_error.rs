//! How far the hybrid is from what it approximates.

use super::{Corrected, FrictionRow, Model};
use crate::stages::approximate::ScaleRow;
use crate::stages::hybrid::Hybrid;
use crate::stages::micro::{partings, steepest_octave_left};
use crate::stages::realise::{Surface, SurfaceKind};

/// Error of the hybrid where the run does not have all waves at finite deformation, as a share of friction, by the rms
/// slope of the steepest wave that is left to the half-space: the largest of the averages that were measured on
/// surfaces of eight waves with three, two and one waves in the microscale, and on the half-space alone
/// (docs/hybrid.md).
type Measured = [(f64, f64); 4];

/// With the default rules of the correction.
const BY_DEFAULT: Measured =
    [(0.523, 0.085), (0.751, 0.097), (0.899, 0.174), (f64::INFINITY, 0.345)];

/// The largest of all other rules.
const BY_OTHER_RULES: Measured =
    [(0.523, 0.171), (0.751, 0.220), (0.899, 0.279), (f64::INFINITY, 0.345)];

/// Gives every average of the hybrid its model error: the difference to all
/// waves at finite deformation of the same realisations, or the share measured elsewhere.
pub(super) fn add(
    rows: &mut [FrictionRow],
    fitted: &[ScaleRow],
    surfaces: &[Surface],
    corrected: Corrected,
) {
    let known: Vec<FrictionRow> =
        rows.iter().filter(|row| row.model == Model::Fem).cloned().collect();
    for row in rows.iter_mut().filter(|row| row.model == Model::Hybrid) {
        let same = known.iter().find(|fem| {
            fem.kind == row.kind
                && fem.speed_mm_s == row.speed_mm_s
                && fem.condition() == row.condition()
        });
        let error = match same {
            Some(fem) => (row.mean - fem.mean).abs() + fem.discretisation_error.unwrap_or(0.0),
            None => {
                share(steepest_left(row.kind, fitted, surfaces, corrected), corrected)
                    * row.mean.abs()
            }
        };
        row.model_error = Some(error);
    }
}

/// Root mean square slope of the steepest wave that is left to the half-space; of windows that of the steepest octave,
/// which is what one sine stands for.
fn steepest_left(
    kind: SurfaceKind,
    fitted: &[ScaleRow],
    surfaces: &[Surface],
    corrected: Corrected,
) -> f64 {
    let threshold = corrected.rms_slope_threshold;
    if kind.method.of_a_window() {
        let mut kinds = partings(surfaces, threshold);
        return kinds
            .find(|(own, _)| own[0].kind == kind)
            .map_or(f64::INFINITY, |(own, parting)| steepest_octave_left(own, parting));
    }
    let slopes = fitted.iter().filter(|row| row.waves == kind.waves).map(|row| row.rms_slope);
    slopes.filter(|slope| *slope <= threshold).fold(0.0, f64::max)
}

/// The share of the measured surface whose steepest wave on the half-space is the next steeper one.
fn share(steepest: f64, corrected: Corrected) -> f64 {
    let rules = corrected.rules;
    let measured = if rules == Hybrid::default() { BY_DEFAULT } else { BY_OTHER_RULES };
    let [.., half_space] = measured;
    measured.into_iter().find(|(slope, _)| steepest <= *slope).unwrap_or(half_space).1
}

#[cfg(test)]
mod tests {
    use super::super::average::average;
    use super::super::average::tests::curve;
    use super::*;
    use crate::multiscale::correction::MeanRule;

    fn measured_elsewhere(fitted: &[ScaleRow], corrected: Corrected) -> f64 {
        share(steepest_left(SurfaceKind::sines(8), fitted, &[], corrected), corrected)
    }

    #[test]
    fn the_difference_of_this_run_counts_and_elsewhere_the_measured_share() {
        let values = |friction: f64, areas: &[f64]| {
            let of = |area: &f64| [curve(8, 1, *area, friction), curve(8, 2, *area, friction)];
            areas.iter().flat_map(of).collect::<Vec<_>>()
        };
        let mut rows = average(Model::Hybrid, values(1.0, &[0.05, 0.1]));
        rows.extend(average(Model::Fem, values(0.8, &[0.05])));
        rows.extend(average(Model::Bem, values(1.1, &[0.05])));
        let before = rows.clone();
        let scale = |wavelength_mm, rms_slope| ScaleRow {
            waves: 8,
            scale: 0,
            wavelength_mm,
            amplitude_mm: 0.1,
            amplitude_confidence_95_mm: None,
            rms_slope,
        };
        let fitted = [scale(0.1, 1.4), scale(0.2, 0.8), scale(0.4, 0.3)];
        let corrected = Corrected { rms_slope_threshold: 1.0, rules: Hybrid::default() };
        add(&mut rows, &fitted, &[], corrected);
        // The mesh error of a value is a two thousandth of it.
        approx::assert_relative_eq!(rows[0].model_error.unwrap(), 0.2 + 4e-4, max_relative = 1e-12);
        assert_eq!(rows[1].model_error, Some(measured_elsewhere(&fitted, corrected)));
        assert_eq!(rows[2..], before[2..]);
    }

    #[test]
    fn the_steeper_the_wave_on_the_half_space_the_larger_the_error() {
        let scale = |waves, rms_slope| ScaleRow {
            waves,
            scale: 0,
            wavelength_mm: 0.1,
            amplitude_mm: 0.1,
            amplitude_confidence_95_mm: None,
            rms_slope,
        };
        let fitted = [scale(8, 1.4), scale(8, 0.8), scale(8, 0.3), scale(9, 0.85)];
        let by = |rms_slope_threshold, rules| {
            measured_elsewhere(&fitted, Corrected { rms_slope_threshold, rules })
        };
        let share = |threshold| by(threshold, Hybrid::default());
        let shares = [0.3, 0.8, 1.4].map(share);
        assert!(shares.is_sorted() && shares[0] < shares[1] && shares[1] < shares[2], "{shares:?}");
        // A slope equal to the threshold is left to the half-space.
        assert_eq!(share(0.2), share(0.3));
        assert_eq!(share(0.79), share(0.3));
        let plain = Hybrid { mean: MeanRule::Points, ..Hybrid::default() };
        assert!(by(0.8, plain) > share(0.8));
    }
}
