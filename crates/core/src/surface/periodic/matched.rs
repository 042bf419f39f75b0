//! Profiles with the spectrum and the heights of another, and random phases besides: iterated amplitude adjustment
//! (Schreiber & Schmitz, Phys. Rev. Lett. 77, 635, 1996, doi:10.1103/PhysRevLett.77.635).
//!
//! What such a profile lacks of a road is what its phases have in common besides the heights: how pits and plateaus follow
//! each other.

use crate::surface::realisation::random_phases;
use crate::surface::wave::sample;
use crate::surface::{SineScale, Wave};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use std::f64::consts::PI;

/// Points on the shortest wave, so that the heights between them are known too.
const POINTS_PER_WAVE: usize = 8;
/// Iterations end here at the latest; most profiles need some tens.
const MOST_ITERATIONS: usize = 500;
/// Iterations end where the heights change by less than this share of their root mean square.
const STILL: f64 = 1e-6;

/// A profile of a given spectrum and nearly given heights.
#[derive(Debug, Clone, PartialEq)]
pub struct Matched {
    /// Its waves, with the amplitudes of the original.
    pub waves: Vec<Wave>,
    /// Root mean square difference of its sorted heights to those of the original, over their root mean square.
    pub mismatch: f64,
    /// Iterations.
    pub iterations: usize,
}

/// A profile with the amplitudes of `waves`, which all divide the period, and their heights; phases begin random, by seed
/// and number of the realisation.
///
/// Ends with the spectrum, which is exact; the heights are what the iteration reaches.
pub fn matched(waves: &[Wave], period: f64, seed: u64, realisation: u64) -> Matched {
    let orders: Vec<usize> =
        waves.iter().map(|wave| (period / wave.wavelength).round() as usize).collect();
    let highest = orders.iter().copied().max().unwrap_or(1);
    let points = (POINTS_PER_WAVE * highest).next_power_of_two();
    let mut target = sample(waves, period, points);
    let rms = (target.iter().map(|z| z * z).sum::<f64>() / points as f64).sqrt();
    target.sort_by(f64::total_cmp);
    let scale = |wave: &Wave| SineScale { wavelength: wave.wavelength, amplitude: wave.amplitude };
    let scales: Vec<SineScale> = waves.iter().map(scale).collect();
    let mut found = random_phases(&scales, seed, realisation);
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(points);
    let mut spectrum = forward.make_output_vec();
    let mut heights = sample(&found, period, points);
    let mut iterations = 0;
    while iterations < MOST_ITERATIONS {
        iterations += 1;
        let mut ranked = in_the_order_of(&heights, &target);
        // The phases of that, with the amplitudes of the original. Buffers of the plan's own lengths cannot be refused.
        let _ = forward.process(&mut ranked, &mut spectrum);
        for (wave, order) in found.iter_mut().zip(&orders) {
            wave.phase = spectrum[*order].arg() + 0.5 * PI;
        }
        let next = sample(&found, period, points);
        let change = rms_difference(&next, &heights);
        heights = next;
        if change <= STILL * rms {
            break;
        }
    }
    heights.sort_by(f64::total_cmp);
    let apart = rms_difference(&heights, &target);
    let mismatch = if rms > 0.0 { apart / rms } else { 0.0 };
    Matched { waves: found, mismatch, iterations }
}

/// The `sorted` heights in the order of others: the lowest where the lowest of those is, and so on.
pub(in crate::surface) fn in_the_order_of(heights: &[f64], sorted: &[f64]) -> Vec<f64> {
    let mut places: Vec<usize> = (0..heights.len()).collect();
    places.par_sort_by(|a, b| heights[*a].total_cmp(&heights[*b]));
    let mut ranked = vec![0.0; heights.len()];
    for (place, height) in places.iter().zip(sorted) {
        ranked[*place] = *height;
    }
    ranked
}

/// Root mean square difference of two fields.
pub(in crate::surface) fn rms_difference(a: &[f64], b: &[f64]) -> f64 {
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (square / a.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Closure, LineScan, PeriodicProfile};

    /// Plateaus with pits: a road that was rolled.
    fn pitted() -> PeriodicProfile {
        let height = |i: usize| {
            let x = i as f64 * 0.02;
            let rough = (x.sin() + (2.7 * x + 1.0).sin() + 0.5 * (9.1 * x).cos()) * 1e-4;
            rough.min(0.3e-4)
        };
        let heights = (0..2000).map(height).collect();
        let window = LineScan { name: "w".into(), origin: 0.0, spacing: 1e-5, heights };
        PeriodicProfile::new(&window, Closure::Mirror, 1e-4, 5e-5).unwrap()
    }

    fn skewness(waves: &[Wave], period: f64) -> f64 {
        let heights = sample(waves, period, 8192);
        let moment = |k: i32| heights.iter().map(|z| z.powi(k)).sum::<f64>() / 8192.0;
        moment(3) / moment(2).powf(1.5)
    }

    #[test]
    fn spectrum_and_heights_are_those_of_the_original_and_random_phases_have_the_spectrum_alone() {
        let original = pitted();
        let (waves, period) = (&original.waves, original.period);
        let scale =
            |wave: &Wave| SineScale { wavelength: wave.wavelength, amplitude: wave.amplitude };
        let scales: Vec<SineScale> = waves.iter().map(scale).collect();
        let known = skewness(waves, period);
        assert!(known < -0.7, "{known}");
        for realisation in 1..=3 {
            let found = matched(waves, period, 1, realisation);
            for (a, b) in found.waves.iter().zip(waves) {
                assert_eq!((a.amplitude, a.wavelength), (b.amplitude, b.wavelength));
            }
            assert!(found.mismatch < 0.05, "{found:?}");
            assert!((skewness(&found.waves, period) - known).abs() < 0.1);
            let random = random_phases(&scales, 1, realisation);
            assert!(skewness(&random, period).abs() < 0.5, "{realisation}");
        }
        assert_eq!(matched(waves, period, 1, 2), matched(waves, period, 1, 2));
        assert_ne!(matched(waves, period, 1, 2).waves, matched(waves, period, 2, 2).waves);
    }
}
