//! Self-affine description of a height-difference correlation (thesis 3.3.2-3):
//!
//! ```text
//! C(s) = xi_perp^2 (s / xi_par)^(2 H)  for s <= xi_par,   xi_perp^2  above
//! ```
//!
//! In `x = log10 s`, `y = log10 C` this is a hinge, `y = a + 2 H min(0, x - c)`. For every pair of
//! neighbouring lags that may hold the hinge `c` the rest is linear, so the global least-squares
//! solution is the best of all pairs, without a start or an iteration.

use super::correlation::{
    CorrelationError, CorrelationSample, HeightDifferenceCorrelation, check_equal_spacing,
    log_spaced_lags,
};
use crate::numerics::statistics::jackknife_95;
use rayon::prelude::*;
use thiserror::Error;

/// Fewest lags on the slope, and in all: two would meet any slope exactly.
const FEWEST_ON_SLOPE: usize = 3;

/// Limits of a two-sided 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConfidenceInterval {
    /// Lower limit.
    pub lower: f64,
    /// Upper limit.
    pub upper: f64,
}

/// The lags a fit takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LagRange {
    /// Shortest lag in metres.
    pub shortest: f64,
    /// Longest lag in metres.
    pub longest: f64,
    /// Lags a decade; fewer where the scan has no more.
    pub per_decade: usize,
}

/// Self-affine parameters of an average correlation.
///
/// Neighbouring lags of a scan are correlated, so their residuals do not show the uncertainty.
/// The intervals come from the spread over scans: a jackknife that leaves out one scan at a time,
/// Student's t with one degree of freedom less than scans, in `log10` for the two lengths. `None`
/// for fewer than three scans.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfAffineFit {
    /// Hurst exponent H; the fractal dimension of the profile is `2 - H`.
    pub hurst_exponent: f64,
    /// Interval of H.
    pub hurst_exponent_95: Option<ConfidenceInterval>,
    /// Lateral correlation length ξ∥ in metres: the lag of the hinge.
    pub lateral_length: f64,
    /// Interval of ξ∥ in metres.
    pub lateral_length_95: Option<ConfidenceInterval>,
    /// Vertical correlation length ξ⊥ in metres: the root of the plateau.
    pub vertical_length: f64,
    /// Interval of ξ⊥ in metres.
    pub vertical_length_95: Option<ConfidenceInterval>,
    /// Whether a plateau was found: two lags at least lie above ξ∥. If not, both lengths are lower
    /// bounds.
    pub plateau_found: bool,
    /// Root mean square of the residuals in `log10 C`.
    pub rms_residual: f64,
    /// The lags taken: the shortest and the longest, and how many.
    pub range: LagRange,
    /// Number of lags taken.
    pub lags: usize,
    /// Number of scans.
    pub scans: usize,
}

/// A self-affine fit that is not possible.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SelfAffineError {
    /// Too few lags.
    #[error(
        "{lags} lags between {:.4} and {:.4} mm, at least {FEWEST_ON_SLOPE} are needed",
        shortest * 1e3, longest * 1e3
    )]
    TooFewLags {
        /// Number of lags in the range.
        lags: usize,
        /// Shortest lag asked for in metres.
        shortest: f64,
        /// Longest lag asked for in metres.
        longest: f64,
    },
    /// No logarithm.
    #[error(
        "the correlation at a lag of {:.4} mm is {value} m2, no positive number: the scan is flat or \
         repeats itself there",
        lag * 1e3
    )]
    NotPositive {
        /// The lag in metres.
        lag: f64,
        /// The correlation in m².
        value: f64,
    },
    /// The correlation does not grow with the lag.
    #[error("the fit gave H = {hurst_exponent}, the correlation does not grow with the lag")]
    NotGrowing {
        /// The Hurst exponent found.
        hurst_exponent: f64,
    },
    /// The scans cannot be pooled.
    #[error(transparent)]
    Correlation(#[from] CorrelationError),
}

/// Fit the average of the scans' correlations over log-spaced lags; intervals by jackknife.
///
/// `range` limits the lags; all lags that every scan has, 20 a decade, without it.
///
/// # Errors
/// No scans, scans of unequal spacing, too few lags or a correlation that is not positive or does
/// not grow.
pub fn fit_self_affine(
    scans: &[HeightDifferenceCorrelation],
    range: Option<LagRange>,
) -> Result<SelfAffineFit, SelfAffineError> {
    check_equal_spacing(scans)?;
    let first = scans.first().ok_or(CorrelationError::NoScans)?;
    let longest = scans
        .iter()
        .map(super::correlation::HeightDifferenceCorrelation::maximum_lag)
        .min()
        .unwrap_or(0);
    let range = range.unwrap_or(LagRange {
        shortest: first.spacing,
        longest: longest as f64 * first.spacing,
        per_decade: 20,
    });
    let lags = lags_within(range, longest, first.spacing);
    let sums = PooledSums::new(scans, &lags);
    let points = sums.samples();
    let hinge = Hinge::fit(&points, range)?;
    let intervals = match scans.len() {
        0..3 => None,
        _ => {
            let fits =
                scans.par_iter().map(|scan| Hinge::fit(&sums.without(scan).samples(), range));
            // Collected first: a parallel search for an error finds any.
            let fits: Vec<Result<Hinge, SelfAffineError>> = fits.collect();
            Some(jackknife(&fits.into_iter().collect::<Result<Vec<_>, _>>()?))
        }
    };
    let around = |which: usize, centre: f64, map: fn(f64) -> f64| {
        let half = intervals?[which];
        Some(ConfidenceInterval { lower: map(centre - half), upper: map(centre + half) })
    };
    let length = |logarithm: f64| 10_f64.powf(logarithm);
    let [hurst, lateral, vertical] = hinge.parameters();
    Ok(SelfAffineFit {
        hurst_exponent: hurst,
        hurst_exponent_95: around(0, hurst, |h| h),
        lateral_length: length(lateral),
        lateral_length_95: around(1, lateral, length),
        vertical_length: length(vertical),
        vertical_length_95: around(2, vertical, length),
        plateau_found: points[points.len() - 2].lag.log10() > lateral,
        rms_residual: (hinge.squares / points.len() as f64).sqrt(),
        range: LagRange {
            shortest: points[0].lag,
            longest: points[points.len() - 1].lag,
            per_decade: range.per_decade,
        },
        lags: points.len(),
        scans: scans.len(),
    })
}

fn lags_within(range: LagRange, longest: usize, spacing: f64) -> Vec<usize> {
    // Half a spacing either way keeps a limit that falls on a lag.
    let within = |lag: &usize| {
        let s = *lag as f64 * spacing;
        s > range.shortest - spacing / 2.0 && s < range.longest + spacing / 2.0
    };
    log_spaced_lags(longest, range.per_decade).into_iter().filter(within).collect()
}

/// Sums over the pairs of all scans at some lags. A scan is left out by subtraction, so that the
/// jackknife of n scans costs n times what one fit does, and not n² sums.
struct PooledSums<'a> {
    lags: &'a [usize],
    spacing: f64,
    /// Sum of the squared differences of the pairs at each lag in m².
    squares: Vec<f64>,
    pairs: Vec<u64>,
}

impl<'a> PooledSums<'a> {
    fn new(scans: &[HeightDifferenceCorrelation], lags: &'a [usize]) -> Self {
        let squares = |&lag: &usize| scans.iter().map(|scan| sum_of_squares(scan, lag)).sum();
        let pairs = |&lag: &usize| scans.iter().map(|scan| scan.pairs[lag]).sum();
        Self {
            lags,
            spacing: scans[0].spacing,
            squares: lags.iter().map(squares).collect(),
            pairs: lags.iter().map(pairs).collect(),
        }
    }

    /// The sums of all scans but one of them. A sum of n positive terms loses `n 1e-16` of the remaining ones if they
    /// have similar sizes; a correlation that is decided by the scan that is left out loses more.
    fn without(&self, scan: &HeightDifferenceCorrelation) -> Self {
        let squares = |(&lag, sum): (&usize, &f64)| sum - sum_of_squares(scan, lag);
        let pairs = |(&lag, sum): (&usize, &u64)| sum - scan.pairs[lag];
        Self {
            squares: self.lags.iter().zip(&self.squares).map(squares).collect(),
            pairs: self.lags.iter().zip(&self.pairs).map(pairs).collect(),
            ..*self
        }
    }

    /// The average correlation at the lags that have pairs.
    fn samples(&self) -> Vec<CorrelationSample> {
        let sums = self.squares.iter().zip(&self.pairs);
        let at = |(&lag, (sum, &pairs)): (&usize, (&f64, &u64))| CorrelationSample {
            lag: lag as f64 * self.spacing,
            value: sum / pairs as f64,
            pairs,
        };
        self.lags.iter().zip(sums).map(at).filter(|sample| sample.pairs > 0).collect()
    }
}

fn sum_of_squares(scan: &HeightDifferenceCorrelation, lag: usize) -> f64 {
    match scan.pairs[lag] {
        0 => 0.0,
        pairs => pairs as f64 * scan.values[lag],
    }
}

/// Half widths of the 95 % intervals from the estimates without one scan each.
fn jackknife(fits: &[Hinge]) -> [f64; 3] {
    let estimates: Vec<[f64; 3]> = fits.iter().map(Hinge::parameters).collect();
    std::array::from_fn(|which| {
        jackknife_95(&estimates.iter().map(|e| e[which]).collect::<Vec<_>>())
    })
}

/// `y = level + slope min(0, x - hinge)` with its sum of squared residuals.
#[derive(Debug, Clone, Copy)]
struct Hinge {
    level: f64,
    slope: f64,
    hinge: f64,
    squares: f64,
}

impl Hinge {
    /// H, log10 ξ∥, log10 ξ⊥.
    fn parameters(&self) -> [f64; 3] {
        [self.slope / 2.0, self.hinge, self.level / 2.0]
    }

    fn fit(samples: &[CorrelationSample], range: LagRange) -> Result<Self, SelfAffineError> {
        if samples.len() < FEWEST_ON_SLOPE {
            let LagRange { shortest, longest, .. } = range;
            return Err(SelfAffineError::TooFewLags { lags: samples.len(), shortest, longest });
        }
        if let Some(&CorrelationSample { lag, value, .. }) =
            samples.iter().find(|sample| sample.value.is_nan() || sample.value <= 0.0)
        {
            return Err(SelfAffineError::NotPositive { lag, value });
        }
        let x: Vec<f64> = samples.iter().map(|sample| sample.lag.log10()).collect();
        let y: Vec<f64> = samples.iter().map(|sample| sample.value.log10()).collect();
        let on_a_lag = (FEWEST_ON_SLOPE..=x.len()).map(|left| Self::at(x[left - 1], &x, &y));
        // A single lag above the hinge is always met exactly, which does not show a plateau.
        let in_between = FEWEST_ON_SLOPE..(x.len() - 1).max(FEWEST_ON_SLOPE);
        let candidates = on_a_lag.chain(in_between.map(|left| Self::between(left, &x, &y)));
        let best = candidates
            .filter(|candidate| candidate.squares.is_finite())
            .min_by(|a, b| a.squares.total_cmp(&b.squares))
            .filter(|best| best.slope > 0.0);
        best.ok_or_else(|| SelfAffineError::NotGrowing {
            hurst_exponent: Self::at(x[x.len() - 1], &x, &y).slope / 2.0,
        })
    }

    /// Best fit with the hinge at a given lag.
    fn at(hinge: f64, x: &[f64], y: &[f64]) -> Self {
        let u: Vec<f64> = x.iter().map(|x| (x - hinge).min(0.0)).collect();
        let (level, slope) = line(&u, y);
        Self::with_squares(level, slope, hinge, x, y)
    }

    /// Best fit with the first `left` points on the slope and the others on the plateau. Their
    /// free fits are independent; the residual counts the points as the hinge assigns them, so a
    /// crossing outside its interval is compared as it is.
    fn between(left: usize, x: &[f64], y: &[f64]) -> Self {
        let (offset, slope) = line(&x[..left], &y[..left]);
        let level = y[left..].iter().sum::<f64>() / (y.len() - left) as f64;
        Self::with_squares(level, slope, (level - offset) / slope, x, y)
    }

    fn with_squares(level: f64, slope: f64, hinge: f64, x: &[f64], y: &[f64]) -> Self {
        let residual = |(x, y): (&f64, &f64)| (level + slope * (x - hinge).min(0.0) - y).powi(2);
        let squares = x.iter().zip(y).map(residual).sum();
        Self { level, slope, hinge, squares }
    }
}

/// Intercept and slope of the least-squares line.
pub(super) fn line(x: &[f64], y: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let xx: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    let xy: f64 = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    (mean_y - xy / xx * mean_x, xy / xx)
}

#[cfg(test)]
mod tests;
