//! Profile filters: the Gaussian of ISO 16610-21 and the Gaussian regression filters of
//! ISO 16610-31, linear and robust, over missing points and up to the ends.
//!
//! The weights are `s(x) = exp(-π (x / (α λc))²)`, normalised over the valid points in reach, with the filter constant
//! `α = sqrt(ln 2 / π) = 0.4697` for the mean and 0.7309 for the parabola: a sine of the cut-off wavelength
//! `λc` passes into the waviness by a half in both. They end where they have fallen to 7e-7.

use nalgebra::{Matrix3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use statrs::statistics::{Data, OrderStatistics};
use std::f64::consts::{LN_2, PI};

/// `π α²` of the Gaussian filter (ISO 16610-21): half transmission of the mean at the cut-off, `exp(-u) = 1/2`.
const PI_ALPHA_SQUARED_OF_MEAN: f64 = LN_2;
/// `π α²` of the Gaussian regression filter (ISO 16610-31): half transmission of the parabola, `(1 + u) exp(-u) = 1/2`.
const PI_ALPHA_SQUARED_OF_PARABOLA: f64 = 1.678_346_990_016_661;
/// `π (x / (α λc))²` at which the weights end; at `x = λc` for the mean, as the standard has it.
const LAST_EXPONENT: f64 = PI * PI / PI_ALPHA_SQUARED_OF_MEAN;
/// Scale of Tukey's biweight over the median absolute residual: three standard deviations.
const BIWEIGHT_SCALE: f64 = 4.4478;
/// Relative change of the scale at which the robust filter is settled.
const SETTLED: f64 = 1e-4;
const MOST_ITERATIONS: usize = 50;

/// Filter that parts waviness from roughness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProfileFilter {
    /// Weighted mean, ISO 16610-21; keeps constants.
    #[default]
    Gaussian,
    /// Weighted parabola, ISO 16610-31 without robustness; keeps parabolas, also at the ends.
    GaussianRegression,
    /// Weighted parabola with Tukey's biweight, ISO 16610-31; spikes do not count.
    RobustGaussian,
}

/// Waviness of equidistant heights at a cut-off wavelength, both in metres; NaN where no valid
/// point (for the parabolas: fewer than three) lies in reach.
///
/// Cost: points times the cut-off over the spacing, for the robust filter about ten times that.
pub fn waviness(heights: &[f64], spacing: f64, cutoff: f64, filter: ProfileFilter) -> Vec<f64> {
    let all = vec![1.0; heights.len()];
    match filter {
        ProfileFilter::Gaussian => {
            means(heights, &weights(spacing, cutoff, PI_ALPHA_SQUARED_OF_MEAN))
        }
        ProfileFilter::GaussianRegression => {
            parabolas(heights, &all, &weights(spacing, cutoff, PI_ALPHA_SQUARED_OF_PARABOLA))
        }
        ProfileFilter::RobustGaussian => {
            robust(heights, &weights(spacing, cutoff, PI_ALPHA_SQUARED_OF_PARABOLA))
        }
    }
}

/// Weights at distances of 0, 1, 2 ... spacings. The transform of the Gaussian of `α λc` is
/// `exp(-π α² (λc / λ)²)`.
fn weights(spacing: f64, cutoff: f64, pi_alpha_squared: f64) -> Vec<f64> {
    let exponent = PI * PI / pi_alpha_squared * (spacing / cutoff).powi(2);
    let last = (LAST_EXPONENT / exponent).sqrt().floor() as usize;
    (0..=last).map(|i| (-exponent * (i * i) as f64).exp()).collect()
}

/// Points in reach of point `i`: index, distance in spacings and weight.
fn in_reach(
    i: usize,
    count: usize,
    weights: &[f64],
) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
    let reach = weights.len() - 1;
    (i.saturating_sub(reach)..(i + reach + 1).min(count))
        .map(move |j| (j, j as f64 - i as f64, weights[j.abs_diff(i)]))
}

fn means(heights: &[f64], weights: &[f64]) -> Vec<f64> {
    let mean = |i: usize| {
        let (mut sum, mut norm) = (0.0, 0.0);
        for (j, _, weight) in in_reach(i, heights.len(), weights) {
            if !heights[j].is_nan() {
                sum += weight * heights[j];
                norm += weight;
            }
        }
        sum / norm
    };
    (0..heights.len()).map(mean).collect()
}

fn parabolas(heights: &[f64], trust: &[f64], weights: &[f64]) -> Vec<f64> {
    let reach = (weights.len() - 1).max(1) as f64;
    let parabola = |i: usize| {
        let (mut moments, mut right) = ([0.0; 5], Vector3::zeros());
        for (j, distance, weight) in in_reach(i, heights.len(), weights) {
            let weight = weight * trust[j];
            if weight > 0.0 && !heights[j].is_nan() {
                let x = distance / reach;
                let powers = [1.0, x, x * x, x * x * x, x * x * x * x];
                (0..5).for_each(|k| moments[k] += weight * powers[k]);
                (0..3).for_each(|k| right[k] += weight * powers[k] * heights[j]);
            }
        }
        let matrix = Matrix3::from_fn(|row, column| moments[row + column]);
        matrix.cholesky().map_or(f64::NAN, |factors| factors.solve(&right)[0])
    };
    (0..heights.len()).map(parabola).collect()
}

fn robust(heights: &[f64], weights: &[f64]) -> Vec<f64> {
    let mut trust = vec![1.0; heights.len()];
    let mut line = parabolas(heights, &trust, weights);
    let mut scale = 0.0;
    for _ in 0..MOST_ITERATIONS {
        let residuals: Vec<f64> = heights.iter().zip(&line).map(|(z, w)| (z - w).abs()).collect();
        let valid: Vec<f64> = residuals.iter().copied().filter(|r| !r.is_nan()).collect();
        let next = if valid.is_empty() { 0.0 } else { BIWEIGHT_SCALE * Data::new(valid).median() };
        if next <= 0.0 || (next - scale).abs() <= SETTLED * next {
            break;
        }
        scale = next;
        for (trust, residual) in trust.iter_mut().zip(&residuals) {
            *trust =
                if *residual < scale { (1.0 - (residual / scale).powi(2)).powi(2) } else { 0.0 };
        }
        line = parabolas(heights, &trust, weights);
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const CUTOFF: f64 = 64.0;
    /// What is lost where the weights end at 7e-7: 2e-7 of their mass, but 3e-5 of the fourth moment
    /// that the parabola takes.
    const ENDING: f64 = 3e-5;

    fn sine(wavelength: f64, points: usize) -> Vec<f64> {
        (0..points).map(|i| (TAU * i as f64 / wavelength).cos()).collect()
    }

    /// Transmission in the middle, at a crest, far from both ends.
    fn transmission(wavelength: f64, filter: ProfileFilter) -> f64 {
        waviness(&sine(wavelength, 1025), 1.0, CUTOFF, filter)[512]
    }

    #[test]
    fn the_cut_off_passes_by_a_half() {
        for filter in [ProfileFilter::Gaussian, ProfileFilter::GaussianRegression] {
            approx::assert_abs_diff_eq!(transmission(CUTOFF, filter), 0.5, epsilon = ENDING);
        }
    }

    #[test]
    fn other_waves_pass_as_the_formulae_say() {
        for wavelength in [32.0, 128.0, 256.0] {
            let r2 = (CUTOFF / wavelength).powi(2);
            let gaussian = (-LN_2 * r2).exp();
            let found = transmission(wavelength, ProfileFilter::Gaussian);
            approx::assert_abs_diff_eq!(found, gaussian, epsilon = ENDING);
            let u = PI_ALPHA_SQUARED_OF_PARABOLA * r2;
            let found = transmission(wavelength, ProfileFilter::GaussianRegression);
            approx::assert_abs_diff_eq!(found, (1.0 + u) * (-u).exp(), epsilon = ENDING);
        }
    }

    #[test]
    fn the_discrete_transmission_is_the_sum_over_the_weights() {
        let weights = weights(1.0, CUTOFF, LN_2);
        assert_eq!(weights.len(), 65);
        let both = |f: &dyn Fn(usize) -> f64| f(0) + 2.0 * (1..65).map(f).sum::<f64>();
        let sum = both(&|i| weights[i] * (TAU * i as f64 / 40.0).cos()) / both(&|i| weights[i]);
        // At a crest, 520 = 13 * 40.
        let found = waviness(&sine(40.0, 1041), 1.0, CUTOFF, ProfileFilter::Gaussian)[520];
        approx::assert_abs_diff_eq!(found, sum, epsilon = 1e-13);
    }

    #[test]
    fn parabolas_pass_up_to_the_ends_and_over_gaps() {
        let parabola = |i: usize| 3.0 - 0.2 * i as f64 + 1e-3 * (i * i) as f64;
        let mut heights: Vec<f64> = (0..300).map(parabola).collect();
        heights[40..60].fill(f64::NAN);
        for filter in [ProfileFilter::GaussianRegression, ProfileFilter::RobustGaussian] {
            for (i, w) in waviness(&heights, 1.0, CUTOFF, filter).into_iter().enumerate() {
                // A condition of about 1e4 on heights up to 30.
                approx::assert_abs_diff_eq!(w, parabola(i), epsilon = 1e-9);
            }
        }
    }

    #[test]
    fn constants_pass_the_mean_exactly() {
        let mut heights = vec![2.0; 200];
        heights[10..50].fill(f64::NAN);
        let line = waviness(&heights, 1.0, CUTOFF, ProfileFilter::Gaussian);
        assert!(line.iter().all(|w| (w - 2.0).abs() < 1e-14));
    }

    #[test]
    fn spikes_do_not_move_the_robust_line() {
        let noise = |i: usize| ((i * 7919) % 101) as f64 / 101.0 - 0.5;
        let clean: Vec<f64> = (0..600).map(noise).collect();
        let mut spiked = clean.clone();
        (0..600).step_by(20).for_each(|i| spiked[i] = 50.0);
        let shift = |filter| {
            let lines = [&clean, &spiked].map(|z| waviness(z, 1.0, CUTOFF, filter));
            lines[0].iter().zip(&lines[1]).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()))
        };
        // One point in twenty at 50 lifts the mean by 2.5; for the robust line those points are
        // merely missing, which moves it by no more than noise of 0.3 over some 40 points.
        assert!(shift(ProfileFilter::GaussianRegression) > 2.0);
        assert!(shift(ProfileFilter::RobustGaussian) < 0.1);
    }

    #[test]
    fn nothing_in_reach_gives_nothing() {
        let heights = [f64::NAN; 5];
        for filter in [ProfileFilter::Gaussian, ProfileFilter::RobustGaussian] {
            assert!(waviness(&heights, 1.0, 2.0, filter).iter().all(|w| w.is_nan()));
            assert!(waviness(&[], 1.0, 2.0, filter).is_empty());
        }
    }
}
