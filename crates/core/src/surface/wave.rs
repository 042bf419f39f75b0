//! Superposed sine waves: the surface that meets the rubber.

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
pub fn sample(waves: &[Wave], period: f64, points: usize) -> Vec<f64> {
    heights(waves, period, points).collect()
}

/// As [`sample`], as long as `goes_on` says so, which is asked at each point: tens of waves on millions of points take
/// seconds.
pub fn sample_while(
    waves: &[Wave],
    period: f64,
    points: usize,
    goes_on: impl Fn() -> bool,
) -> Option<Vec<f64>> {
    heights(waves, period, points).map(|height| goes_on().then_some(height)).collect()
}

fn heights(waves: &[Wave], period: f64, points: usize) -> impl Iterator<Item = f64> {
    let spacing = period / points as f64;
    (0..points).map(move |i| waves.iter().map(|wave| wave.height(i as f64 * spacing)).sum())
}
