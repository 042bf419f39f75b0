//! Road texture: mean profile depth (ISO 13473-1) and texture levels (ISO 13473-4).

use super::form::{Form, remove_form};
use super::spectrum::PowerSpectrum;
use std::f64::consts::{PI, SQRT_2, TAU};
use thiserror::Error;

/// Largest sampling interval in metres of a profile whose mean profile depth ISO 13473-1 defines.
pub const LARGEST_DEPTH_SPACING: f64 = 1e-3;
/// Fitted spacings of one millimetre may be off by this share.
const SPACING_ROUND_OFF: f64 = 1e-3;
/// Fewest points of a segment, two for each half.
const FEWEST_SEGMENT_POINTS: usize = 4;

/// What ISO 13473-1 leaves open or fixes by a number; the default is its usual choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthOptions {
    /// Length in metres of a segment.
    pub segment: f64,
    /// Largest share of drop-outs in a segment.
    pub most_drop_outs: f64,
    /// Slope to both neighbours at which a height is a spike.
    pub spike_slope: f64,
    /// Cut-off in metres of the low-pass filter, applied forwards and backwards: 2.4 mm are -3 dB
    /// at 3 mm.
    pub low_pass: f64,
    /// Cut-off in metres of the high-pass filter, applied forwards and backwards: 174.2 mm are -3 dB
    /// at 140 mm. Without it each segment loses its line (slope suppression).
    pub high_pass: Option<f64>,
}

impl Default for DepthOptions {
    fn default() -> Self {
        Self {
            segment: 0.1,
            most_drop_outs: 0.1,
            spike_slope: 3.0,
            low_pass: 2.4e-3,
            high_pass: None,
        }
    }
}

/// Mean profile depth of one segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentDepth {
    /// Position in metres of the segment in the scan.
    pub start: f64,
    /// Share of the points that were interpolated, drop-outs and spikes.
    pub interpolated: f64,
    /// Mean of the peaks of both halves above the mean level, in metres; none where too many of
    /// the points had no height.
    pub depth: Option<f64>,
}

/// A profile without mean profile depths.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DepthError {
    /// Sampled too coarsely: this is a profile for evenness, with no texture in it.
    #[error(
        "its points are {:.4} mm apart and ISO 13473-1 asks for at most 1 mm: a profile for evenness \
         does not hold the texture; measure with a finer spacing",
        spacing * 1e3
    )]
    Spacing {
        /// Distance between neighbouring points in metres.
        spacing: f64,
    },
    /// The low-pass filter has no effect.
    #[error(
        "the low-pass filter of {:.4} mm needs points less than half of that apart, they are {:.4} mm \
         apart",
        low_pass * 1e3, spacing * 1e3
    )]
    LowPass {
        /// Cut-off in metres.
        low_pass: f64,
        /// Distance between neighbouring points in metres.
        spacing: f64,
    },
    /// A segment of a few points has no peaks in its halves.
    #[error(
        "a segment of {:.1} mm has {points} of at least {FEWEST_SEGMENT_POINTS} points",
        segment * 1e3
    )]
    FewPoints {
        /// Length in metres of a segment.
        segment: f64,
        /// Its number of points.
        points: usize,
    },
    /// Shorter than a segment.
    #[error(
        "its {:.1} mm are shorter than a segment of {} mm",
        length * 1e3, segment * 1e3
    )]
    Short {
        /// Length in metres of the profile.
        length: f64,
        /// Length in metres of a segment.
        segment: f64,
    },
    /// Nothing but gaps.
    #[error("none of its points has a height that is not a spike; leave the scan out")]
    NoHeights,
}

/// Mean profile depths of the whole segments of equidistant heights (metres, NaN where
/// missing), as ISO 13473-1 has it: spikes, too steep to their neighbours on the left and the
/// right, become drop-outs; drop-outs are interpolated linearly; a Butterworth low-pass of second
/// order, forwards and backwards; a high-pass likewise, or the line of each segment taken off.
///
/// # Errors
/// [`DepthError`]: points more than 1 mm apart or too far apart for the low-pass, a profile shorter
/// than a segment or without heights.
pub fn mean_profile_depths(
    heights: &[f64],
    spacing: f64,
    options: &DepthOptions,
) -> Result<Vec<SegmentDepth>, DepthError> {
    let points = segment_points(heights, spacing, options)?;
    let mut valid = heights.to_vec();
    drop_spikes(&mut valid, options.spike_slope * spacing);
    let mut smooth = interpolated(&valid).ok_or(DepthError::NoHeights)?;
    smooth = both_ways(&smooth, &Butterworth::low_pass(spacing / options.low_pass));
    if let Some(cut_off) = options.high_pass {
        smooth = both_ways(&smooth, &Butterworth::high_pass(spacing / cut_off));
    }
    let segments = smooth.chunks_exact(points).zip(heights.chunks_exact(points));
    let depth = |(i, (segment, measured)): (usize, (&[f64], &[f64]))| {
        let missing = |z: &[f64]| z.iter().filter(|z| z.is_nan()).count() as f64 / points as f64;
        let interpolated = missing(&valid[i * points..(i + 1) * points]);
        let most = options.most_drop_outs;
        let judged = missing(measured) <= most && interpolated <= most;
        let start = (i * points) as f64 * spacing;
        let form = if options.high_pass.is_some() { Form::Mean } else { Form::Slope };
        SegmentDepth { start, interpolated, depth: judged.then(|| segment_depth(segment, form)) }
    };
    Ok(segments.enumerate().map(depth).collect())
}

/// Points of a segment, where the profile has what the standard asks for.
fn segment_points(
    heights: &[f64],
    spacing: f64,
    options: &DepthOptions,
) -> Result<usize, DepthError> {
    let DepthOptions { segment, low_pass, .. } = *options;
    if spacing > LARGEST_DEPTH_SPACING * (1.0 + SPACING_ROUND_OFF) {
        return Err(DepthError::Spacing { spacing });
    }
    if low_pass <= 2.0 * spacing {
        return Err(DepthError::LowPass { low_pass, spacing });
    }
    // A segment of an integer number of points must not lose one to round-off.
    let points = (segment / spacing * (1.0 + 1e-9)).floor() as usize;
    if points < FEWEST_SEGMENT_POINTS {
        return Err(DepthError::FewPoints { segment, points });
    }
    if heights.len() < points {
        return Err(DepthError::Short { length: heights.len() as f64 * spacing, segment });
    }
    Ok(points)
}

fn segment_depth(segment: &[f64], form: Form) -> f64 {
    let mut heights = segment.to_vec();
    // Four points or more determine a line.
    if remove_form(&mut heights, form).is_err() {
        return f64::NAN;
    }
    let peak = |half: &[f64]| half.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (first, second) = heights.split_at(heights.len() / 2);
    0.5 * (peak(first) + peak(second))
}

/// Heights that stick out by `limit` or more from both neighbours are no heights.
fn drop_spikes(heights: &mut [f64], limit: f64) {
    let is_spike = |z: &[f64]| {
        let (left, right) = (z[1] - z[0], z[1] - z[2]);
        left.abs() >= limit && right.abs() >= limit && left * right > 0.0
    };
    let spikes: Vec<usize> =
        (1..heights.len().max(1) - 1).filter(|&i| is_spike(&heights[i - 1..=i + 1])).collect();
    spikes.into_iter().for_each(|i| heights[i] = f64::NAN);
}

/// Linear interpolation over the missing points, the nearest height at the ends; none where all
/// are missing.
fn interpolated(heights: &[f64]) -> Option<Vec<f64>> {
    let mut filled = heights.to_vec();
    let valid: Vec<usize> = (0..heights.len()).filter(|&i| !heights[i].is_nan()).collect();
    let (&first, &last) = (valid.first()?, valid.last()?);
    filled[..first].fill(heights[first]);
    filled[last..].fill(heights[last]);
    for pair in valid.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let slope = (heights[b] - heights[a]) / (b - a) as f64;
        (a + 1..b).for_each(|i| filled[i] = heights[a] + slope * (i - a) as f64);
    }
    Some(filled)
}

/// Digital Butterworth filter of second order, by the bilinear transform with its cut-off in place.
struct Butterworth {
    forward: [f64; 3],
    back: [f64; 2],
    /// Points after which the response to an edge has decayed.
    settled: usize,
}

impl Butterworth {
    /// `ratio`: spacing over cut-off wavelength, below 1/2.
    fn low_pass(ratio: f64) -> Self {
        let k = (PI * ratio).tan();
        Self::with(k, [k * k, 2.0 * k * k, k * k], ratio)
    }

    fn high_pass(ratio: f64) -> Self {
        Self::with((PI * ratio).tan(), [1.0, -2.0, 1.0], ratio)
    }

    fn with(k: f64, numerator: [f64; 3], ratio: f64) -> Self {
        let norm = 1.0 + SQRT_2 * k + k * k;
        Self {
            forward: numerator.map(|b| b / norm),
            back: [2.0 * (k * k - 1.0) / norm, (1.0 - SQRT_2 * k + k * k) / norm],
            settled: (3.0 / ratio).ceil() as usize,
        }
    }

    fn apply(&self, values: &mut [f64]) {
        let ([b0, b1, b2], [a1, a2]) = (self.forward, self.back);
        let (mut s1, mut s2) = (0.0, 0.0);
        for value in values {
            let output = b0 * *value + s1;
            s1 = b1 * *value - a1 * output + s2;
            s2 = b2 * *value - a2 * output;
            *value = output;
        }
    }
}

/// Forwards and backwards, so without shift, on the series continued at both ends by its reflection
/// in the end point.
fn both_ways(heights: &[f64], filter: &Butterworth) -> Vec<f64> {
    let pad = filter.settled.min(heights.len() - 1);
    let (first, last) = (heights[0], heights[heights.len() - 1]);
    let before = (1..=pad).rev().map(|i| 2.0 * first - heights[i]);
    let after = (1..=pad).map(|i| 2.0 * last - heights[heights.len() - 1 - i]);
    let mut padded: Vec<f64> = before.chain(heights.iter().copied()).chain(after).collect();
    for _ in 0..2 {
        // The level of the first point is taken off, or the filter would start with a step.
        let level = padded[0];
        padded.iter_mut().for_each(|z| *z -= level);
        filter.apply(&mut padded);
        let kept = filter.forward.iter().sum::<f64>() / (1.0 + filter.back.iter().sum::<f64>());
        padded.iter_mut().for_each(|z| *z += level * kept);
        padded.reverse();
    }
    padded[pad..pad + heights.len()].to_vec()
}

/// Texture level of one third-octave band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureBand {
    /// Centre wavelength in metres, `10^(j / 10)`.
    pub wavelength: f64,
    /// Mean square height of the band in m².
    pub mean_square: f64,
}

impl TextureBand {
    /// Texture level in dB: `10 log10(mean square / (1e-6 m)²)`.
    pub fn level(&self) -> f64 {
        10.0 * (self.mean_square / 1e-12).log10()
    }
}

/// Third-octave bands of a one-sided spectrum, from long to short, that lie between its first
/// wavenumber and its last and are at least one wavenumber wide. A wavenumber stands for `dq`
/// around it and counts in each band with the part of that which lies there: over neighbouring
/// bands no power is lost or counted twice.
pub fn texture_bands(spectrum: &PowerSpectrum) -> Vec<TextureBand> {
    let step = spectrum.wavenumber_step;
    let highest = (spectrum.density.len().max(1) - 1) as f64;
    let edge = |j: f64| TAU / 10_f64.powf(j / 10.0) / step;
    // Band j reaches from edge(j + 1/2) to edge(j - 1/2) in wavenumber steps.
    let longest = (10.0 * (TAU / step).log10() - 0.5).floor() as i64;
    let fits = |j: &i64| edge(*j as f64 - 0.5) <= highest;
    let wide = |j: &i64| edge(*j as f64 - 0.5) - edge(*j as f64 + 0.5) >= 1.0;
    let band = |j: i64| TextureBand {
        wavelength: 10_f64.powf(j as f64 / 10.0),
        mean_square: power(spectrum, edge(j as f64 + 0.5), edge(j as f64 - 0.5)),
    };
    (0..).map(|i| longest - i).take_while(fits).filter(wide).map(band).collect()
}

/// Integral of the density between two wavenumbers, given in steps.
fn power(spectrum: &PowerSpectrum, from: f64, to: f64) -> f64 {
    let cells = (from + 0.5).floor() as usize..=(to + 0.5).floor() as usize;
    let part = |k: usize| {
        let overlap = to.min(k as f64 + 0.5) - from.max(k as f64 - 0.5);
        spectrum.density.get(k).unwrap_or(&0.0) * overlap.max(0.0)
    };
    cells.map(part).sum::<f64>() * spectrum.wavenumber_step
}

#[cfg(test)]
mod tests;
