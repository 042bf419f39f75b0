//! A bound of the difference between half-space and finite deformation on gentle surfaces, where no
//! finite elements are needed to know that the difference is small.

use crate::stages::realise::Surface;
use std::f64::consts::TAU;

/// Bound of the relative difference of friction at equal contact area, over the rms slope: three times the
/// largest of 64 measured ones (docs/stages/multilevel.md).
const DIFFERENCE_OVER_SLOPE: f64 = 0.2;
/// Largest rms slope that it was measured for.
const LARGEST_SLOPE: f64 = 0.1;
/// Of the tolerance that the bound may take.
const SHARE: f64 = 0.125;

/// Rms slope `√(Σ (q D)²/2)` of superposed sines.
fn rms_slope(surface: &Surface) -> f64 {
    let square = |(wavelength, amplitude): (f64, f64)| (TAU * amplitude / wavelength).powi(2) / 2.0;
    surface.profile.iter().map(|wave| square((wave.wavelength, wave.amplitude))).sum::<f64>().sqrt()
}

/// Bound of `|μ_finite - μ_half-space| / μ_half-space` at equal contact area, if it is known and below its
/// share of the relative `tolerance`.
pub(super) fn negligible(surface: &Surface, tolerance: f64) -> Option<f64> {
    let slope = rms_slope(surface);
    let bound = DIFFERENCE_OVER_SLOPE * slope;
    (slope <= LARGEST_SLOPE && bound <= SHARE * tolerance).then_some(bound)
}

/// Whether a recipe with that tolerance solves no finite elements for the surface.
pub(crate) fn is_negligible(surface: &Surface, tolerance: f64) -> bool {
    negligible(surface, tolerance).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::realise::SurfaceKind;
    use crate::surface::Wave;

    fn surface(rms_slope: f64) -> Surface {
        let wavelength = 1e-3;
        let amplitude = rms_slope * 2.0_f64.sqrt() * wavelength / TAU;
        let wave = Wave { wavelength, amplitude, phase: 0.0 };
        Surface { kind: SurfaceKind::sines(1), realisation: 1, profile: vec![wave] }
    }

    #[test]
    fn the_bound_follows_the_slope_and_is_given_where_it_is_small_beside_the_tolerance() {
        approx::assert_relative_eq!(rms_slope(&surface(0.1)), 0.1, max_relative = 1e-14);
        // 0.2 * 0.05 = 0.01 is an eighth of 0.08.
        let bound = negligible(&surface(0.05), 0.081).unwrap();
        approx::assert_relative_eq!(bound, 0.01, max_relative = 1e-12);
        assert_eq!(negligible(&surface(0.05), 0.079), None);
        // Beyond what was measured there is no bound.
        assert_eq!(negligible(&surface(0.11), 0.5), None);
    }
}
