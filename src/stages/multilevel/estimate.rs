//! The two-level estimate of a mean, its confidence interval, and what the interval will be for other
//! numbers of realisations.
//!
//! With `b_i` the half-space and `f_i` all waves at finite deformation, `i` the realisation, the
//! estimate from `N` values of the first and `n` of the second is
//!
//! ```text
//! m = (1/N) Σ_{i<=N} b_i + (1/n) Σ_{i<=n} (f_i - b_i)
//! ```
//!
//! The pairs are among the `N`, so that both sums are correlated. Sorted by realisation instead of by
//! model the estimate is the sum of two independent means,
//!
//! ```text
//! m = (1/n) Σ_{i<=n} g_i + w (1/(N-n)) Σ_{i>n} b_i,    g_i = f_i - b_i + (n/N) b_i,    w = (N-n)/N
//! Var m = Var(g)/n + w² Var(b)/(N-n)
//! ```
//!
//! whose variances are estimated apart and whose degrees of freedom are those of Welch and
//! Satterthwaite (doi:10.2307/3002019). For `N = n` it is the mean of the `f_i` with Student's interval.

use crate::numerics::statistics::student_t_975;

/// A mean with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Mean at finite deformation.
    pub mean: f64,
    /// Half width of the two-sided 95 % confidence interval; NaN for fewer than two pairs.
    pub confidence_95: f64,
    /// Degrees of freedom of the interval.
    pub degrees_of_freedom: f64,
}

impl Estimate {
    /// From the half-space of `N` realisations and the finite deformation of the first `n` of them;
    /// for `n = 0` that of the half-space alone.
    ///
    /// # Panics
    /// If there are more values at finite deformation than of the half-space.
    pub fn new(half_space: &[f64], full: &[f64]) -> Self {
        let (pairs, rest) = half_space.split_at(full.len());
        let share = full.len() as f64 / half_space.len() as f64;
        let paired: Vec<f64> = full.iter().zip(pairs).map(|(f, b)| f - b + share * b).collect();
        // The spread of a single further realisation is that of all.
        let spread = if rest.len() == 1 { half_space } else { rest };
        let parts = [
            Part {
                mean: mean(&paired),
                variance: variance(&paired),
                count: paired.len(),
                sample: paired.len(),
            },
            Part {
                mean: (1.0 - share) * mean(rest),
                variance: (1.0 - share).powi(2) * variance(spread),
                count: rest.len(),
                sample: spread.len(),
            },
        ];
        let (confidence_95, degrees_of_freedom) = interval(&parts);
        let present = parts.iter().filter(|part| part.count > 0);
        Self { mean: present.map(|part| part.mean).sum(), confidence_95, degrees_of_freedom }
    }
}

/// A mean of independent values.
struct Part {
    mean: f64,
    /// Of one value.
    variance: f64,
    /// Values that the mean is of.
    count: usize,
    /// Values that the variance was estimated from.
    sample: usize,
}

/// Half width and degrees of freedom of the 95 % interval of a sum of independent means.
fn interval(parts: &[Part]) -> (f64, f64) {
    let present = || parts.iter().filter(|part| part.count > 0);
    let square = |part: &Part| part.variance / part.count as f64;
    let total: f64 = present().map(square).sum();
    if total == 0.0 {
        let freedom = present().map(|part| part.sample as f64 - 1.0).sum();
        return (0.0, freedom);
    }
    let weights: f64 =
        present().map(|part| square(part).powi(2) / (part.sample as f64 - 1.0)).sum();
    let freedom = total.powi(2) / weights;
    if !(freedom.is_finite() && freedom > 0.0) {
        return (f64::NAN, f64::NAN);
    }
    (student_t_975(freedom) * total.sqrt(), freedom)
}

/// Spread of both models and of their differences.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Variance of the half-space, over all its realisations.
    pub half_space: f64,
    /// Variance of the differences; zero without pairs.
    pub difference: f64,
    /// Correlation of the half-space and the differences over the pairs; zero where one of them does
    /// not vary.
    pub correlation: f64,
}

impl Spread {
    /// From the values of [`Estimate::new`].
    pub fn new(half_space: &[f64], full: &[f64]) -> Self {
        let pairs = &half_space[..full.len()];
        let differences = differences(half_space, full);
        let (variance_b, variance_d) = (variance(pairs), variance(&differences));
        let (mean_b, mean_d) = (mean(pairs), mean(&differences));
        let products = pairs.iter().zip(&differences).map(|(b, d)| (b - mean_b) * (d - mean_d));
        let covariance = products.sum::<f64>() / (pairs.len() as f64 - 1.0);
        let correlation = covariance / (variance_b * variance_d).sqrt();
        Self {
            half_space: variance(half_space),
            difference: if variance_d.is_finite() { variance_d } else { 0.0 },
            correlation: if correlation.is_finite() { correlation.clamp(-1.0, 1.0) } else { 0.0 },
        }
    }

    /// Half width of the 95 % interval that `half_space` and `full` realisations are expected to have.
    pub fn half_width(&self, half_space: usize, full: usize) -> f64 {
        let share = full as f64 / half_space as f64;
        let (b, d) = (share * self.half_space.sqrt(), self.difference.sqrt());
        let paired = b * b + 2.0 * self.correlation * b * d + d * d;
        let rest = half_space - full;
        let sample = if rest == 1 { half_space } else { rest };
        let variance = (1.0 - share).powi(2) * self.half_space;
        let parts = [
            Part { mean: 0.0, variance: paired, count: full, sample: full },
            Part { mean: 0.0, variance, count: rest, sample },
        ];
        interval(&parts).0
    }
}

/// Finite deformation less the half-space, pair by pair.
pub fn differences(half_space: &[f64], full: &[f64]) -> Vec<f64> {
    full.iter().zip(half_space).map(|(f, b)| f - b).collect()
}

/// Arithmetic mean; NaN of nothing.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Sample variance with divisor n - 1; NaN for fewer than two values.
pub fn variance(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return f64::NAN;
    }
    let centre = mean(values);
    values.iter().map(|v| (v - centre).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::statistics::MeanEstimate;

    #[test]
    fn two_pairs_among_four_are_as_by_hand() {
        let half_space = [1.0, 3.0, 2.0, 6.0];
        let full = [0.5, 3.5];
        let estimate = Estimate::new(&half_space, &full);
        // Means 3 and (-0.5 + 0.5)/2 = 0.
        approx::assert_relative_eq!(estimate.mean, 3.0, epsilon = 1e-15);
        // g = d + b/2: 0, 2, variance 2, over n 1. Rest 2, 6: variance 8, w² = 1/4, over two 1.
        // Degrees of freedom (1 + 1)²/(1/1 + 1/1) = 2, t = 4.302653 in every table.
        approx::assert_relative_eq!(estimate.degrees_of_freedom, 2.0, max_relative = 1e-12);
        let expected = 4.302_652_73 * 2.0_f64.sqrt();
        approx::assert_relative_eq!(estimate.confidence_95, expected, max_relative = 1e-8);
    }

    #[test]
    fn all_pairs_are_the_mean_at_finite_deformation_and_no_pairs_that_of_the_half_space() {
        let half_space = [1.0, 3.0, 2.0, 6.0];
        let full = [0.5, 3.5, 1.0, 4.0];
        for (estimate, alone) in [
            (Estimate::new(&half_space, &full), MeanEstimate::of(&full)),
            (Estimate::new(&half_space, &[]), MeanEstimate::of(&half_space)),
        ] {
            approx::assert_relative_eq!(estimate.mean, alone.mean, max_relative = 1e-14);
            approx::assert_relative_eq!(
                estimate.confidence_95,
                alone.confidence_95,
                max_relative = 1e-12
            );
        }
        assert!(Estimate::new(&half_space, &full[..1]).confidence_95.is_nan());
    }

    #[test]
    fn the_forecast_of_the_interval_is_the_interval_where_the_spread_is_that_of_the_parts() {
        // The half-space has variance 4/3 within the pairs, within the rest and nearly so over all.
        let half_space = [1.0, 3.0, 3.0, 1.0, 1.0, 3.0, 3.0, 1.0];
        let full = [0.7, 2.9, 2.6, 0.6];
        let spread = Spread { half_space: 4.0 / 3.0, ..Spread::new(&half_space, &full) };
        let estimate = Estimate::new(&half_space, &full);
        approx::assert_relative_eq!(
            spread.half_width(8, 4),
            estimate.confidence_95,
            max_relative = 1e-12
        );
        assert!(spread.half_width(16, 4) < spread.half_width(8, 4));
        assert_eq!(Spread::new(&[1.0, 1.0], &[1.0, 1.0]).half_width(2, 2), 0.0);
    }

    /// 95 of 100 intervals hold the mean, of pairs that are skewed and correlated, whatever the shares.
    #[test]
    fn intervals_hold_the_mean_of_skewed_correlated_pairs() {
        let mut draw = super::super::shares::tests::Draw::new(7);
        // So many that the share is known to 0.4 %.
        let (families, truth) = (4000, super::super::shares::tests::MEAN);
        for (many, few) in [(40, 5), (100, 5), (24, 8), (12, 11), (200, 4), (15, 15)] {
            let mut inside = 0;
            for _ in 0..families {
                let pairs: Vec<(f64, f64)> = (0..many).map(|_| draw.pair()).collect();
                let half_space: Vec<f64> = pairs.iter().map(|pair| pair.0).collect();
                let full: Vec<f64> = pairs[..few].iter().map(|pair| pair.1).collect();
                let estimate = Estimate::new(&half_space, &full);
                inside += usize::from((estimate.mean - truth).abs() <= estimate.confidence_95);
            }
            let share = f64::from(inside as u32) / f64::from(families);
            eprintln!("{many} and {few}: {share}");
            assert!((0.93..=0.97).contains(&share), "{many} and {few}: {share}");
        }
    }
}
