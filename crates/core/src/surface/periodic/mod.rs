//! A scanned window as a periodic profile without waves shorter than a given one.
//!
//! A contact is solved on a period, and a window has none. Mirrored, the window and its mirror image are the period: all
//! heights stay, and both directions of sliding are the same. Blended, a share of the window at its end passes into its
//! beginning: the direction stays, and that share is no longer what was measured. The profile is then the sum of the waves
//! `L / k` of the period `L` down to the shortest wavelength, by a discrete Fourier transform, so that it can be sampled
//! on any grid.
//!
//! | module | what it holds |
//! |---|---|
//! | `matched` | profiles with the spectrum and the heights of another, and random phases besides |

mod matched;

pub use matched::{Matched, matched};
pub(super) use matched::{in_the_order_of, rms_difference};

use super::{LineScan, Wave};
use crate::error_kind::{ErrorKind, HasKind};
use realfft::RealFftPlanner;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// How a window is made periodic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Closure {
    /// The window and its mirror image.
    #[default]
    Mirror,
    /// The end of the window passes into its beginning over a twentieth of its length.
    Blend,
}

/// Share of the window over which its end passes into its beginning.
pub(super) const BLENDED: f64 = 0.05;
/// The same tolerance of wavelengths as elsewhere.
const ROUND_OFF: f64 = 1e-9;

/// A periodic profile of a window.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicProfile {
    /// Its waves by ascending wavelength, each a whole number of times in the period.
    pub waves: Vec<Wave>,
    /// Period in m.
    pub period: f64,
    /// Points of the window that had no height and were filled by straight lines.
    pub filled: usize,
    /// Mean square of the heights in m² that are shorter than the shortest wavelength, and left out.
    pub left_out: f64,
}

/// Why a window has no periodic profile.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PeriodicError {
    /// Too many heights are missing at one place.
    #[error(
        "window {window}: no heights over {gap_mm:.3} mm, and gaps are filled up to {longest_mm} mm"
    )]
    Gap {
        /// Name of the window.
        window: String,
        /// Length of the gap in mm.
        gap_mm: f64,
        /// Longest gap that is filled, in mm.
        longest_mm: f64,
    },
    /// The points are too far apart, or the window is too short.
    #[error(
        "window {window}: its points are {spacing_mm} mm apart over {length_mm} mm, and waves of {shortest_mm} mm and more \
         are asked for; a wave needs two points, and a window four waves"
    )]
    Unresolved {
        /// Name of the window.
        window: String,
        /// Spacing in mm.
        spacing_mm: f64,
        /// Length in mm.
        length_mm: f64,
        /// Shortest wavelength in mm.
        shortest_mm: f64,
    },
}

impl HasKind for PeriodicError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

impl PeriodicProfile {
    /// The profile of a window with waves of `shortest` metres and longer.
    ///
    /// Missing heights at the ends are cut off, others are filled by straight lines over gaps of up to `longest_gap`
    /// metres: gaps of half the shortest wavelength cannot show a wave that is kept, longer ones are road that was not
    /// seen.
    ///
    /// # Errors
    /// [`PeriodicError::Gap`], [`PeriodicError::Unresolved`].
    pub fn new(
        window: &LineScan,
        closure: Closure,
        shortest: f64,
        longest_gap: f64,
    ) -> Result<Self, PeriodicError> {
        let heights = without_ends(&window.heights);
        let length = heights.len() as f64 * window.spacing;
        let enough = heights.len() >= 8 && length >= 4.0 * shortest;
        if !enough || 2.0 * window.spacing > shortest * (1.0 + ROUND_OFF) {
            return Err(PeriodicError::Unresolved {
                window: window.name.clone(),
                spacing_mm: 1e3 * window.spacing,
                length_mm: 1e3 * length,
                shortest_mm: 1e3 * shortest,
            });
        }
        let (heights, filled) = fill(heights, |gap| {
            let length = gap as f64 * window.spacing;
            if length <= longest_gap * (1.0 + ROUND_OFF) {
                return Ok(());
            }
            Err(PeriodicError::Gap {
                window: window.name.clone(),
                gap_mm: 1e3 * length,
                longest_mm: 1e3 * longest_gap,
            })
        })?;
        let closed = match closure {
            Closure::Mirror => mirrored(heights),
            Closure::Blend => blended(&heights),
        };
        let period = closed.len() as f64 * window.spacing;
        let (waves, left_out) = waves_of(closed, period, shortest);
        Ok(Self { waves, period, filled, left_out })
    }

    /// The same profile as the rubber meets it that slides the other way.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { waves: reversed(&self.waves), ..self.clone() }
    }
}

/// `z(-x)`: `sin(-q x + φ) = sin(q x + π - φ)`.
fn reversed(waves: &[Wave]) -> Vec<Wave> {
    waves.iter().map(|wave| Wave { phase: PI - wave.phase, ..*wave }).collect()
}

fn without_ends(heights: &[f64]) -> &[f64] {
    let there = |z: &f64| !z.is_nan();
    let first = heights.iter().position(there).unwrap_or(heights.len());
    let end = heights.iter().rposition(there).map_or(first, |last| last + 1);
    &heights[first..end]
}

/// Straight lines across gaps whose numbers of points are admitted.
fn fill<E>(
    heights: &[f64],
    admitted: impl Fn(usize) -> Result<(), E>,
) -> Result<(Vec<f64>, usize), E> {
    let mut full = heights.to_vec();
    let (mut filled, mut i) = (0, 0);
    while i < full.len() {
        if !full[i].is_nan() {
            i += 1;
            continue;
        }
        // The ends are there, so that each gap has two sides.
        let gap = full[i..].iter().take_while(|z| z.is_nan()).count();
        admitted(gap)?;
        let (left, right) = (full[i - 1], full[i + gap]);
        for (k, z) in full[i..i + gap].iter_mut().enumerate() {
            *z = left + (right - left) * (k + 1) as f64 / (gap + 1) as f64;
        }
        filled += gap;
        i += gap;
    }
    Ok((full, filled))
}

fn mirrored(mut heights: Vec<f64>) -> Vec<f64> {
    heights.extend_from_within(..);
    let half = heights.len() / 2;
    heights[half..].reverse();
    heights
}

/// The last points pass into the first ones by weights of a raised cosine, and are left out at the end.
fn blended(heights: &[f64]) -> Vec<f64> {
    let count = heights.len();
    let overlap = blended_points(count);
    let mut closed = heights[..count - overlap].to_vec();
    for (i, z) in closed.iter_mut().enumerate().take(overlap) {
        let weight = blend_weight(i, overlap);
        *z = weight * *z + (1.0 - weight) * heights[count - overlap + i];
    }
    closed
}

/// Points at the end of a window of `count` that pass into as many at its beginning.
pub(super) fn blended_points(count: usize) -> usize {
    ((BLENDED * count as f64) as usize).max(1)
}

/// Weight of the beginning at its point `i` of `overlap`; the end has the rest.
pub(super) fn blend_weight(i: usize, overlap: usize) -> f64 {
    0.5 - 0.5 * (PI * (i as f64 + 0.5) / overlap as f64).cos()
}

/// Waves of at least the shortest wavelength by ascending wavelength, and the mean square of the others.
fn waves_of(mut heights: Vec<f64>, period: f64, shortest: f64) -> (Vec<Wave>, f64) {
    let count = heights.len();
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(count);
    let mut spectrum = forward.make_output_vec();
    // Buffers of the plan's own lengths cannot be refused.
    let _ = forward.process(&mut heights, &mut spectrum);
    let (mut waves, mut left_out) = (Vec::new(), 0.0);
    for (k, value) in spectrum.iter().enumerate().skip(1) {
        let nyquist = 2 * k == count;
        let amplitude = value.norm() / count as f64 * if nyquist { 1.0 } else { 2.0 };
        let wavelength = period / k as f64;
        if nyquist || wavelength < shortest * (1.0 - ROUND_OFF) {
            left_out += amplitude * amplitude * if nyquist { 1.0 } else { 0.5 };
        } else {
            waves.push(Wave { wavelength, amplitude, phase: value.arg() + 0.5 * PI });
        }
    }
    waves.reverse();
    (waves, left_out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::wave::sample;

    const SPACING: f64 = 1e-5;

    fn window(heights: Vec<f64>) -> LineScan {
        LineScan { name: "w".into(), origin: 0.0, spacing: SPACING, heights }
    }

    fn road(count: usize) -> Vec<f64> {
        let height = |i: usize| {
            let x = i as f64;
            1e-4 * (0.01 * x).sin() + 2e-5 * (0.3 * x + 1.0).cos() + 1e-6 * (x * x * 1e-3).sin()
        };
        (0..count).map(height).collect()
    }

    #[test]
    fn a_mirrored_window_keeps_its_heights() {
        let heights = road(400);
        let profile =
            PeriodicProfile::new(&window(heights.clone()), Closure::Mirror, 2.0 * SPACING, 5e-5)
                .unwrap();
        assert_eq!(profile.period, 800.0 * SPACING);
        let mean = heights.iter().sum::<f64>() / 400.0;
        let sampled = sample(&profile.waves, profile.period, 800);
        // The mirror image has no wave of two points, so that all is kept.
        assert!(profile.left_out < 1e-24, "{}", profile.left_out);
        for (i, z) in heights.iter().enumerate() {
            assert!((sampled[i] + mean - z).abs() < 1e-17, "{i}");
            assert!((sampled[799 - i] + mean - z).abs() < 1e-17, "{i}");
        }
        // Both directions are the same, half a point on.
        let back = sample(&profile.reversed().waves, profile.period, 800);
        for i in 0..800 {
            assert!((back[i] - sampled[(800 - i) % 800]).abs() < 1e-17);
            assert!((back[i] - sampled[(i + 799) % 800]).abs() < 1e-17);
        }
    }

    #[test]
    fn a_blended_window_keeps_its_middle_and_closes_without_a_step() {
        let heights = road(400);
        let profile =
            PeriodicProfile::new(&window(heights.clone()), Closure::Blend, 2.0 * SPACING, 5e-5)
                .unwrap();
        let count = 380;
        assert_eq!(profile.period, 380.0 * SPACING);
        let closed = blended(&heights);
        assert_eq!(closed[20..], heights[20..count]);
        let step = (closed[0] - closed[count - 1]).abs();
        let largest = heights.windows(2).map(|z| (z[1] - z[0]).abs()).fold(0.0, f64::max);
        assert!(step < 1.5 * largest, "{step} {largest}");
        assert!((heights[0] - heights[399]).abs() > 5.0 * largest, "the window itself has one");
        // The blended end is road too: in it the heights are between those of both ends.
        let mean = closed.iter().sum::<f64>() / 380.0;
        let sampled = sample(&profile.waves, profile.period, count);
        let nyquist = profile.left_out.sqrt();
        for (a, b) in sampled.iter().zip(&closed) {
            assert!((a + mean - b).abs() < 1e-17 + nyquist, "{a} {b}");
        }
    }

    #[test]
    fn no_wave_is_shorter_than_asked_for_and_what_is_left_out_is_stated() {
        let heights = road(400);
        let all =
            PeriodicProfile::new(&window(heights.clone()), Closure::Mirror, 2e-5, 5e-5).unwrap();
        let some = PeriodicProfile::new(&window(heights), Closure::Mirror, 1e-4, 5e-5).unwrap();
        assert!(some.waves.iter().all(|wave| wave.wavelength >= 1e-4 * (1.0 - 1e-9)));
        assert!(some.waves.windows(2).all(|pair| pair[0].wavelength < pair[1].wavelength));
        let power = |waves: &[Wave]| waves.iter().map(|w| 0.5 * w.amplitude.powi(2)).sum::<f64>();
        let gone = power(&all.waves) - power(&some.waves) + all.left_out;
        assert!((some.left_out / gone - 1.0).abs() < 1e-9);
    }

    #[test]
    fn short_gaps_are_filled_and_long_ones_refused() {
        let mut heights = road(400);
        heights[..7].fill(f64::NAN);
        heights[100..104].fill(f64::NAN);
        let profile =
            PeriodicProfile::new(&window(heights.clone()), Closure::Mirror, 1e-4, 5e-5).unwrap();
        assert_eq!((profile.filled, profile.period), (4, 786.0 * SPACING));
        heights[200..206].fill(f64::NAN);
        let error =
            PeriodicProfile::new(&window(heights), Closure::Mirror, 1e-4, 5e-5).unwrap_err();
        assert!(error.to_string().contains("no heights over 0.060 mm"), "{error}");
        let empty = PeriodicProfile::new(&window(vec![f64::NAN; 50]), Closure::Mirror, 1e-4, 5e-5);
        assert!(matches!(empty, Err(PeriodicError::Unresolved { .. })));
        let coarse = PeriodicProfile::new(&window(road(400)), Closure::Mirror, 1.5 * SPACING, 5e-5);
        assert!(coarse.unwrap_err().to_string().contains("0.01 mm apart"));
    }
}
