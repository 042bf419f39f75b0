//! Height-difference correlation of line scans with gaps (thesis 3.3.1).
//!
//! ```text
//! C(s) = mean over all pairs of valid points a distance s apart of (z(x + s) - z(x))^2
//! ```
//!
//! With `m` the mask of valid points and `y = m z`, the sum over pairs at lag `k` is
//! `sum_i m_i m_(i+k) (z_i - z_(i+k))^2`: three cyclic correlations of zero-padded sequences, so
//! gaps need no filling and all lags cost five real FFTs. Without gaps, running sums of squares and
//! two FFTs do.

use super::LineScan;
use crate::error_kind::{ErrorKind, HasKind};
use crate::numerics::plane::fast_length;
use rayon::prelude::*;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex, num_complex::Complex};
use std::collections::BTreeMap;
use std::sync::Arc;
use thiserror::Error;

/// Lags from 0 to this one are summed directly. The FFT form is the difference of sums of about
/// `2 Rq^2` per pair, so its relative error is some 1e-16 `Rq^2 / C(s)`: largest at the shortest
/// lags of a finely sampled scan, where `C` grows like `s^2`.
const DIRECT_LAGS: usize = 16;

/// Height-difference correlation of one scan or an average over scans.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightDifferenceCorrelation {
    /// Distance between neighbouring lags in metres.
    pub spacing: f64,
    /// Mean square in m² of the valid heights about their mean; half the plateau of `values`.
    pub variance: f64,
    /// C in m² at the lags `0, spacing, 2 spacing, ...`; NaN where no pair of valid points exists.
    pub values: Vec<f64>,
    /// Number of pairs behind each value, same length; at lag 0 the number of valid points.
    pub pairs: Vec<u64>,
}

/// One point of a height-difference correlation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrelationSample {
    /// Lag s in metres.
    pub lag: f64,
    /// C(s) in m².
    pub value: f64,
    /// Number of pairs behind the value.
    pub pairs: u64,
}

/// A correlation that cannot be computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CorrelationError {
    /// Fewer than two heights.
    #[error("scan {scan}: {valid} of its points have heights, at least 2 are needed; leave it out")]
    TooFewHeights {
        /// Name of the scan.
        scan: String,
        /// Number of valid points.
        valid: usize,
    },
    /// More points than the plan was made for.
    #[error("scan {scan}: {points} points, the plan was made for at most {limit}; make a new one")]
    TooLong {
        /// Name of the scan.
        scan: String,
        /// Number of points of the scan.
        points: usize,
        /// Largest number of points of the plan.
        limit: usize,
    },
    /// Scans on different grids.
    #[error("scans with spacings {first} m and {other} m cannot be averaged; resample to one")]
    UnequalSpacing {
        /// Spacing of the first scan in metres.
        first: f64,
        /// The spacing that differs, in metres.
        other: f64,
    },
    /// An average over nothing.
    #[error("no correlations to average; give at least one scan")]
    NoScans,
}

impl HasKind for CorrelationError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooFewHeights { .. } | Self::UnequalSpacing { .. } | Self::NoScans => {
                ErrorKind::Input
            }
            Self::TooLong { .. } => ErrorKind::Failure,
        }
    }
}

impl HeightDifferenceCorrelation {
    /// Largest lag as a number of spacings.
    pub fn maximum_lag(&self) -> usize {
        self.values.len() - 1
    }

    /// The values at some lags (numbers of spacings, at most [`Self::maximum_lag`]), without those
    /// that no pair supports.
    ///
    /// # Panics
    /// If a lag is beyond the largest.
    pub fn sample(&self, lags: &[usize]) -> Vec<CorrelationSample> {
        let at = |&lag: &usize| CorrelationSample {
            lag: lag as f64 * self.spacing,
            value: self.values[lag],
            pairs: self.pairs[lag],
        };
        lags.iter().filter(|&&lag| self.pairs[lag] > 0).map(at).collect()
    }

    /// The values at [`log_spaced_lags`].
    pub fn sample_log_spaced(&self, per_decade: usize) -> Vec<CorrelationSample> {
        self.sample(&log_spaced_lags(self.maximum_lag(), per_decade))
    }

    /// Average over scans of equal spacing, each lag weighted by its pairs: the correlation of all pairs pooled. It
    /// ends at the shortest of the largest lags, so that every scan contributes to every lag and the average has no
    /// steps where a scan ends.
    ///
    /// # Errors
    /// No correlations; spacings that differ by more than 1e-9 of the first.
    pub fn average(scans: &[Self]) -> Result<Self, CorrelationError> {
        let first = scans.first().ok_or(CorrelationError::NoScans)?;
        check_equal_spacing(scans)?;
        let count = scans.iter().map(|scan| scan.values.len()).min().unwrap_or(0);
        let pairs: Vec<u64> =
            (0..count).map(|lag| scans.iter().map(|scan| scan.pairs[lag]).sum()).collect();
        let values = (0..count).map(|lag| pooled_value(scans, lag)).collect();
        let points: f64 = scans.iter().map(|scan| scan.pairs[0] as f64).sum();
        let squares: f64 = scans.iter().map(|scan| scan.pairs[0] as f64 * scan.variance).sum();
        Ok(Self { spacing: first.spacing, variance: squares / points, values, pairs })
    }
}

/// Mean of C over all pairs of all scans at one lag in m²; NaN without pairs.
pub(super) fn pooled_value<'a>(
    scans: impl IntoIterator<Item = &'a HeightDifferenceCorrelation>,
    lag: usize,
) -> f64 {
    let (mut sum, mut pairs) = (0.0, 0.0);
    for scan in scans.into_iter().filter(|scan| scan.pairs[lag] > 0) {
        sum += scan.pairs[lag] as f64 * scan.values[lag];
        pairs += scan.pairs[lag] as f64;
    }
    sum / pairs
}

/// Round-off of positions read from text is allowed for; nothing more.
pub(super) fn check_equal_spacing(
    scans: &[HeightDifferenceCorrelation],
) -> Result<(), CorrelationError> {
    let Some(first) = scans.first().map(|scan| scan.spacing) else { return Ok(()) };
    match scans.iter().find(|scan| (scan.spacing - first).abs() > 1e-9 * first) {
        Some(scan) => Err(CorrelationError::UnequalSpacing { first, other: scan.spacing }),
        None => Ok(()),
    }
}

/// Whole numbers from 1 to `maximum` nearest to `10^(j / per_decade)`, without duplicates,
/// ascending.
pub fn log_spaced_lags(maximum: usize, per_decade: usize) -> Vec<usize> {
    let mut lags: Vec<usize> = (0..)
        .map(|j| 10_f64.powf(f64::from(j) / per_decade.max(1) as f64).round() as usize)
        .take_while(|&lag| lag <= maximum)
        .collect();
    lags.dedup();
    lags
}

/// FFT plans for scans of up to a number of points and lags up to a largest one.
pub struct CorrelationPlan {
    points: usize,
    maximum_lag: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl CorrelationPlan {
    /// Plan for up to `points` points and lags up to `maximum_lag` spacings (cut to `points - 1`).
    pub fn new(points: usize, maximum_lag: usize) -> Self {
        let maximum_lag = maximum_lag.min(points.saturating_sub(1));
        // Padding by the largest lag keeps the wrap-around of the cyclic correlation beyond it.
        let length = fast_length(points + maximum_lag);
        let mut planner = RealFftPlanner::new();
        let (forward, inverse) =
            (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
        Self { points, maximum_lag, forward, inverse }
    }

    /// Height-difference correlation of a scan, at lags from 0 to the plan's largest.
    ///
    /// Lags up to 16 spacings are summed directly. Above, the absolute error is about
    /// `2e-15 Rq^2`.
    ///
    /// # Errors
    /// Fewer than two valid heights, or more points than the plan allows.
    pub fn correlate(
        &self,
        scan: &LineScan,
    ) -> Result<HeightDifferenceCorrelation, CorrelationError> {
        let heights = &scan.heights;
        if heights.len() > self.points {
            let (scan, points) = (scan.name.clone(), heights.len());
            return Err(CorrelationError::TooLong { scan, points, limit: self.points });
        }
        let valid = heights.iter().filter(|z| !z.is_nan()).count();
        if valid < 2 {
            return Err(CorrelationError::TooFewHeights { scan: scan.name.clone(), valid });
        }
        let (deviations, variance) = about_the_mean(heights, valid);
        let (mut values, mut pairs) = match valid == heights.len() {
            true => self.complete_lags(&deviations),
            false => self.all_lags(&deviations),
        };
        let longest = self.maximum_lag.min(heights.len() - 1);
        values.truncate(longest + 1);
        pairs.truncate(longest + 1);
        for (lag, value) in values.iter_mut().enumerate().take(DIRECT_LAGS + 1) {
            *value = direct_value(&deviations, lag);
        }
        Ok(HeightDifferenceCorrelation { spacing: scan.spacing, variance, values, pairs })
    }

    /// C and the number of pairs without gaps: `sum of z_i^2 + z_(i+k)^2` loses a height at either end
    /// from one lag to the next, so that the transform of the heights alone is left.
    fn complete_lags(&self, heights: &[f64]) -> (Vec<f64>, Vec<u64>) {
        let points = heights.len();
        let transform = self.spectrum(heights, |z| z);
        let products = self.even_sequence(transform.iter().map(Complex::norm_sqr).collect());
        // Compensated, as many small subtractions would cost digits of the small differences.
        let (mut squares, mut lost) = (2.0 * products[0], 0.0);
        let mut values = Vec::with_capacity(points);
        for (lag, product) in products.iter().enumerate().take(points.min(self.maximum_lag + 1)) {
            let sum = squares - 2.0 * product + lost;
            values.push((sum / (points - lag) as f64).max(0.0));
            let ends = heights[lag].powi(2) + heights[points - 1 - lag].powi(2);
            let rest = squares - ends;
            lost += squares - rest - ends;
            squares = rest;
        }
        let pairs = (0..values.len()).map(|lag| (points - lag) as u64).collect();
        (values, pairs)
    }

    /// C and the number of pairs from the spectra M, Y and W of `m`, `m z` and `m z^2`.
    fn all_lags(&self, deviations: &[f64]) -> (Vec<f64>, Vec<u64>) {
        let or_zero = |z: f64| if z.is_nan() { 0.0 } else { z };
        let mask = self.spectrum(deviations, |z| if z.is_nan() { 0.0 } else { 1.0 });
        let heights = self.spectrum(deviations, or_zero);
        let squares = self.spectrum(deviations, |z| or_zero(z * z));
        let differences = mask.iter().zip(&heights).zip(&squares);
        let sums = self.even_sequence(
            differences.map(|((m, y), w)| 2.0 * ((w * m.conj()).re - y.norm_sqr())).collect(),
        );
        let counts = self.even_sequence(mask.iter().map(Complex::norm_sqr).collect());
        let pairs: Vec<u64> = counts.iter().map(|count| count.round() as u64).collect();
        let values = sums.iter().zip(&pairs).map(|(sum, &n)| (sum / n as f64).max(0.0));
        let values = values.zip(&pairs).map(|(c, &n)| if n == 0 { f64::NAN } else { c }).collect();
        (values, pairs)
    }

    fn spectrum(&self, deviations: &[f64], entry: impl Fn(f64) -> f64) -> Vec<Complex<f64>> {
        let (mut input, mut output) =
            (self.forward.make_input_vec(), self.forward.make_output_vec());
        input.iter_mut().zip(deviations).for_each(|(slot, &z)| *slot = entry(z));
        self.forward.process(&mut input, &mut output).expect("buffers come from the plan");
        output
    }

    /// Inverse transform of a real spectrum.
    fn even_sequence(&self, spectrum: Vec<f64>) -> Vec<f64> {
        let mut input: Vec<Complex<f64>> = spectrum.into_iter().map(Complex::from).collect();
        let mut output = self.inverse.make_output_vec();
        self.inverse.process(&mut input, &mut output).expect("buffers come from the plan");
        let scale = 1.0 / output.len() as f64;
        output.iter_mut().for_each(|value| *value *= scale);
        output
    }
}

/// Heights about the mean of the valid ones (a common height would cost digits), and their
/// mean square.
fn about_the_mean(heights: &[f64], valid: usize) -> (Vec<f64>, f64) {
    let mean = heights.iter().filter(|z| !z.is_nan()).sum::<f64>() / valid as f64;
    let deviations: Vec<f64> = heights.iter().map(|z| z - mean).collect();
    let squares = deviations.iter().filter(|z| !z.is_nan()).map(|z| z * z).sum::<f64>();
    (deviations, squares / valid as f64)
}

fn direct_value(heights: &[f64], lag: usize) -> f64 {
    let (mut sum, mut pairs) = (0.0, 0_usize);
    for (a, b) in heights.iter().zip(&heights[lag..]) {
        let difference = b - a;
        if !difference.is_nan() {
            sum += difference * difference;
            pairs += 1;
        }
    }
    sum / pairs as f64
}

/// Correlations of scans, in parallel, in the order of the scans.
///
/// `maximum_lag` in metres; half the length of each scan without it. Each scan is transformed separately, so the result
/// does not depend on the number of threads or on the other scans.
///
/// # Errors
/// The first scan that cannot be correlated, see [`CorrelationPlan::correlate`].
pub fn correlate_scans(
    scans: &[LineScan],
    maximum_lag: Option<f64>,
) -> Result<Vec<HeightDifferenceCorrelation>, CorrelationError> {
    let size = |scan: &LineScan| {
        let points = scan.heights.len();
        let lag = maximum_lag.map_or(points / 2, |lag| (lag / scan.spacing).round() as usize);
        (points, lag)
    };
    let mut plans = BTreeMap::new();
    for (points, lag) in scans.iter().map(size) {
        plans.entry((points, lag)).or_insert_with(|| CorrelationPlan::new(points, lag));
    }
    scans.par_iter().map(|scan| plans[&size(scan)].correlate(scan)).collect()
}

#[cfg(test)]
mod tests;
