//! Surfaces with the spectrum of a map and other phases, and isotropic ones with the spectrum of lines.

use super::periodic::{PeriodicMap, is_kept, resolving, signed};
use crate::numerics::plane::Transform;
use crate::surface::periodic::{in_the_order_of, rms_difference};
use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// Points on the shortest wave along each direction, so that the heights between them are known too.
const POINTS_PER_WAVE: f64 = 4.0;
/// Iterations end here at the latest.
const MOST_ITERATIONS: usize = 200;
/// Iterations end where the heights change by less than this share of their root mean square.
const STILL: f64 = 1e-5;

/// A surface with the spectrum of `map` and independent phases, uniform on `[0, 2π)`: seed and number of the realisation
/// are a stream of their own, as those of [`crate::surface::realisation`].
pub fn random_phase_map(map: &PeriodicMap, seed: u64, realisation: u64) -> PeriodicMap {
    let mut transform = transform_of(map);
    draw_phases(&mut transform, map.points, seed, realisation);
    PeriodicMap { heights: back(&mut transform), ..map.clone() }
}

/// A surface with the spectrum of `map`, its heights as far as the iteration reaches, and random phases besides, as
/// [`crate::surface::periodic::matched`] makes profiles; and the root mean square difference of its sorted heights to those of
/// `map`, over their root mean square.
pub fn matched_map(map: &PeriodicMap, seed: u64, realisation: u64) -> (PeriodicMap, f64) {
    let points = map.grid(POINTS_PER_WAVE);
    let original = PeriodicMap { heights: map.sample(points), points, ..map.clone() };
    let mut target = original.heights.clone();
    let rms = (target.iter().map(|z| z * z).sum::<f64>() / target.len() as f64).sqrt();
    target.par_sort_unstable_by(f64::total_cmp);
    let amplitudes: Vec<f64> = transform_of(&original).spectrum.iter().map(|c| c.norm()).collect();
    let mut transform = transform_of(&original);
    draw_phases(&mut transform, points, seed, realisation);
    let mut heights = back(&mut transform);
    for _ in 0..MOST_ITERATIONS {
        transform.real = in_the_order_of(&heights, &target);
        transform.forward();
        for (coefficient, amplitude) in transform.spectrum.iter_mut().zip(&amplitudes) {
            let norm = coefficient.norm();
            // A wave that the heights do not have keeps no phase to take.
            *coefficient *= if norm > 0.0 { amplitude / norm } else { 0.0 };
        }
        let next = back(&mut transform);
        let change = rms_difference(&next, &heights);
        heights = next;
        if change <= STILL * rms {
            break;
        }
    }
    let found = PeriodicMap { heights: heights.clone(), points, ..map.clone() };
    heights.par_sort_unstable_by(f64::total_cmp);
    let apart = rms_difference(&heights, &target);
    let mismatch = if rms > 0.0 { apart / rms } else { 0.0 };
    (PeriodicMap { heights: found.sample(map.points), ..map.clone() }, mismatch)
}

/// A square surface of random phases with the isotropic power spectral density `density(q)` in m⁴ at the wavenumber `q` in
/// rad/m, normalised over the whole plane (`integral of C d²q = mean of z²`), with waves of `shortest` metres to one `period`.
pub fn isotropic_map(
    density: impl Fn(f64) -> f64,
    period: f64,
    shortest: f64,
    seed: u64,
    realisation: u64,
) -> PeriodicMap {
    random_map(|[qx, qy]| density(qx.hypot(qy)), period, shortest, seed, realisation)
}

/// As [`isotropic_map`], with a density that depends on the direction of `[q_x, q_y]` too; it must be the same at `-q`.
pub fn random_map(
    density: impl Fn([f64; 2]) -> f64,
    period: f64,
    shortest: f64,
    seed: u64,
    realisation: u64,
) -> PeriodicMap {
    let periods = [period; 2];
    let points = resolving(periods, shortest);
    let [nx, ny] = points;
    let mut transform = Transform::new(points);
    let cell = (TAU / period).powi(2);
    for (bin, column) in transform.spectrum.chunks_exact_mut(ny).enumerate() {
        for (j, coefficient) in column.iter_mut().enumerate() {
            let (kx, ky) = (bin as f64, signed(j, ny));
            let is_mean = bin == 0 && j == 0;
            let resolved = 2 * bin < nx && 2.0 * ky.abs() < ny as f64;
            if is_mean || !resolved || !is_kept([kx, ky], periods, shortest) {
                continue;
            }
            let power = density([kx, ky].map(|k| TAU / period * k)) * cell;
            *coefficient = Complex64::new(power.max(0.0).sqrt() * (nx * ny) as f64, 0.0);
        }
    }
    draw_phases(&mut transform, points, seed, realisation);
    PeriodicMap { heights: back(&mut transform), points, periods, shortest }
}

fn transform_of(map: &PeriodicMap) -> Transform {
    let mut transform = Transform::new(map.points);
    transform.real.copy_from_slice(&map.heights);
    transform.forward();
    transform
}

/// Heights of the coefficients.
fn back(transform: &mut Transform) -> Vec<f64> {
    transform.backward();
    let scale = 1.0 / transform.real.len() as f64;
    transform.real.iter().map(|z| z * scale).collect()
}

/// Gives all coefficients other phases; those of opposite waves are conjugate, as the heights are real.
fn draw_phases(transform: &mut Transform, [nx, ny]: [usize; 2], seed: u64, realisation: u64) {
    let mut generator = Pcg64::new(u128::from(seed), u128::from(realisation));
    let mut draw = || {
        // The top 53 bits, so that the number does not depend on a library's conversion.
        TAU * (generator.random::<u64>() >> 11) as f64 / (1_u64 << 53) as f64
    };
    for (bin, column) in transform.spectrum.chunks_exact_mut(ny).enumerate() {
        let is_own_opposite = bin == 0 || 2 * bin == nx;
        for j in 0..ny {
            let opposite = (ny - j) % ny;
            if is_own_opposite && opposite < j {
                column[j] = column[opposite].conj();
                continue;
            }
            // A wave that is its own opposite is a cosine of either sign.
            let phase = draw();
            let is_real = is_own_opposite && opposite == j;
            let turned = if is_real { phase.cos().signum().into() } else { Complex64::cis(phase) };
            column[j] = turned * column[j].norm();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Closure;
    use crate::surface::map::HeightMap;

    /// Plateaus with pits, as of a rolled road.
    fn pitted() -> PeriodicMap {
        let height = |k: usize| {
            let (x, y) = ((k % 96) as f64 * 0.11, (k / 96) as f64 * 0.11);
            let rough = (x + 0.3 * y).sin() + (1.9 * y - x).sin() + 0.5 * (2.3 * x + 1.7 * y).cos();
            (rough * 1e-4).min(0.3e-4)
        };
        let heights = (0..96 * 96).map(height).collect();
        let map = HeightMap { name: "m".into(), points: [96; 2], spacing: [1e-5; 2], heights };
        PeriodicMap::new(&map, Closure::Blend, 6e-5).unwrap().0
    }

    #[test]
    fn random_phases_keep_every_amplitude_and_lose_the_heights() {
        let original = pitted();
        let of = |map: &PeriodicMap| -> Vec<f64> {
            transform_of(map).spectrum.iter().map(|c| c.norm()).collect()
        };
        let found = random_phase_map(&original, 1, 1);
        let scale = of(&original).into_iter().fold(0.0, f64::max);
        for (a, b) in of(&original).iter().zip(of(&found)) {
            assert!((a - b).abs() < 1e-12 * scale, "{a} {b}");
        }
        assert!(original.roughness().skewness < -0.5, "{:?}", original.roughness());
        assert!(found.roughness().skewness.abs() < 0.4, "{:?}", found.roughness());
        assert_eq!(found, random_phase_map(&original, 1, 1));
        assert_ne!(found, random_phase_map(&original, 1, 2));
        assert_ne!(found, random_phase_map(&original, 2, 1));
    }

    #[test]
    fn matched_surfaces_have_spectrum_and_heights() {
        let original = pitted();
        let (found, mismatch) = matched_map(&original, 3, 1);
        assert!(mismatch < 0.05, "{mismatch}");
        let (a, b) = (original.roughness(), found.roughness());
        approx::assert_relative_eq!(a.rms_height, b.rms_height, max_relative = 1e-9);
        approx::assert_relative_eq!(a.rms_gradient, b.rms_gradient, max_relative = 1e-9);
        assert!((a.skewness - b.skewness).abs() < 0.1, "{a:?} {b:?}");
    }

    #[test]
    fn isotropic_surfaces_have_the_integral_of_their_density() {
        // C = a q^-3.3 between one and eight waves in the period: 2 pi times the integral of q C.
        let (period, shortest, a) = (2e-3, 2.5e-5, 1e-9);
        let surface = isotropic_map(|q: f64| a * q.powf(-3.3), period, shortest, 5, 2);
        let (from, to) = (TAU / period, TAU / shortest);
        let slope = TAU * a / 0.7 * (to.powf(0.7) - from.powf(0.7));
        // The gradient lives on the short waves, where the sum over 80 waves is close to the integral.
        let found = surface.roughness().rms_gradient.powi(2);
        assert!((found / slope - 1.0).abs() < 0.03, "{found} {slope}");
        let rows: f64 = surface.heights.iter().sum();
        assert!(rows.abs() < 1e-12);
    }
}
