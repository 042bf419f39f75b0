//! Superposed sine waves: the surface that meets the rubber.

use realfft::RealFftPlanner;
use rustfft::num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, SQRT_2, TAU};

/// One length scale of a surface, without a phase.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SineScale {
    /// Wavelength λ in metres.
    pub wavelength: f64,
    /// Amplitude D in metres, not negative.
    pub amplitude: f64,
}

impl SineScale {
    /// Root mean square slope `sqrt(2) π D / λ` (thesis 3.3.15), dimensionless.
    pub fn rms_slope(&self) -> f64 {
        SQRT_2 * PI * self.amplitude / self.wavelength
    }
}

/// One sine wave `D sin(2 π x / λ + φ)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Wave {
    /// Wavelength λ in metres.
    pub wavelength: f64,
    /// Amplitude D in metres.
    pub amplitude: f64,
    /// Phase φ in radians.
    pub phase: f64,
}

impl Wave {
    /// Height in metres at `x` metres.
    pub fn height(&self, x: f64) -> f64 {
        self.amplitude * (TAU * x / self.wavelength + self.phase).sin()
    }
}

/// Heights in metres of superposed waves on `points` equidistant points of one period (metres).
///
/// Many waves that all divide the period, as a measured profile has, are summed by a Fourier transform.
pub fn sample(waves: &[Wave], period: f64, points: usize) -> Vec<f64> {
    by_transform(waves, period, points).unwrap_or_else(|| heights(waves, period, points).collect())
}

/// As [`sample`], as long as `goes_on` says so, which is asked at each point: tens of waves on millions of points take
/// seconds.
pub fn sample_while(
    waves: &[Wave],
    period: f64,
    points: usize,
    goes_on: impl Fn() -> bool,
) -> Option<Vec<f64>> {
    if let Some(heights) = by_transform(waves, period, points) {
        return goes_on().then_some(heights);
    }
    heights(waves, period, points).map(|height| goes_on().then_some(height)).collect()
}

fn heights(waves: &[Wave], period: f64, points: usize) -> impl Iterator<Item = f64> {
    let spacing = period / points as f64;
    (0..points).map(move |i| waves.iter().map(|wave| wave.height(i as f64 * spacing)).sum())
}

/// From this number of waves on a Fourier transform is faster; below, sums keep their bits.
const MANY: usize = 64;
/// Relative distance of a number of waves on the period from a whole one.
const ROUND_OFF: f64 = 1e-9;

/// `None` for few waves, or where one does not fit into the period or is too short for the points.
fn by_transform(waves: &[Wave], period: f64, points: usize) -> Option<Vec<f64>> {
    if waves.len() < MANY {
        return None;
    }
    let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(points);
    let mut spectrum = inverse.make_input_vec();
    for wave in waves {
        let count = period / wave.wavelength;
        let order = count.round();
        if (count - order).abs() > ROUND_OFF * count || order < 1.0 || 2.0 * order >= points as f64
        {
            return None;
        }
        // D sin(q x + φ) is twice the real part of D/2 exp(i (q x + φ - π/2)).
        spectrum[order as usize] +=
            Complex64::from_polar(0.5 * wave.amplitude, wave.phase - 0.5 * PI);
    }
    let mut heights = inverse.make_output_vec();
    // Only buffers of other lengths are refused, and these are of the plan; the sum would be taken then.
    inverse.process(&mut spectrum, &mut heights).ok()?;
    Some(heights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_gives_the_heights_of_the_sum() {
        let (period, points) = (1.3e-3, 1000);
        let wave = |k: u32| Wave {
            wavelength: period / f64::from(k),
            amplitude: 1e-6 / f64::from(k),
            phase: f64::from(k * k % 7),
        };
        let waves: Vec<Wave> = (1..=200).map(wave).collect();
        let summed: Vec<f64> = heights(&waves, period, points).collect();
        let transformed = by_transform(&waves, period, points).unwrap();
        for (a, b) in summed.iter().zip(&transformed) {
            assert!((a - b).abs() < 1e-19, "{a} {b}");
        }
        // Too short for the points, and not a divisor of the period: the sum knows what to do.
        assert_eq!(by_transform(&waves, period, 400), None);
        let mut odd = waves;
        odd[3].wavelength *= 1.001;
        assert_eq!(by_transform(&odd, period, points), None);
    }
}
