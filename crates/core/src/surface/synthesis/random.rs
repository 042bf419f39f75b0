//! Random numbers that are the same on every machine and in every version of the generators.

use rand::Rng;
use std::f64::consts::TAU;

/// Uniform on (0, 1], from the top 53 bits of one draw; never zero, so its logarithm is finite.
pub(super) fn uniform(rng: &mut impl Rng) -> f64 {
    const STEP: f64 = 1.0 / (1_u64 << 53) as f64;
    ((rng.next_u64() >> 11) + 1) as f64 * STEP
}

/// Two independent standard normal numbers by the Box-Muller transform (doi:10.1214/aoms/1177706645).
pub(super) fn normal_pair(rng: &mut impl Rng) -> (f64, f64) {
    let radius = (-2.0 * uniform(rng).ln()).sqrt();
    let (sine, cosine) = (TAU * uniform(rng)).sin_cos();
    (radius * cosine, radius * sine)
}

/// Sum of `shape` exponential numbers over the shape: the Erlang law of mean 1 and variance 1/shape.
pub(super) fn erlang(shape: u32, rng: &mut impl Rng) -> f64 {
    (0..shape).map(|_| -uniform(rng).ln()).sum::<f64>() / f64::from(shape)
}

/// Length of a run, geometric on 1, 2, ... with the given mean (at least 1).
pub(super) fn run_length(mean: f64, rng: &mut impl Rng) -> usize {
    // A mean of 1 divides by minus infinity, which gives the required run of one point.
    1 + (uniform(rng).ln() / (-1.0 / mean).ln_1p()).floor() as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_pcg::Pcg64;

    const DRAWS: usize = 100_000;

    #[test]
    fn normal_numbers_have_the_moments_of_the_normal_law() {
        let mut rng = Pcg64::new(1, 2);
        let pairs: Vec<_> = (0..DRAWS).map(|_| normal_pair(&mut rng)).collect();
        let moment = |f: &dyn Fn((f64, f64)) -> f64| {
            pairs.iter().map(|&pair| f(pair)).sum::<f64>() / DRAWS as f64
        };
        // Four standard errors: the variances of y, y^2, y^4 and y1 y2 are 1, 2, 96 and 1.
        let four = 4.0 / (DRAWS as f64).sqrt();
        assert!(moment(&|(a, _)| a).abs() < four);
        assert!((moment(&|(_, b)| b * b) - 1.0).abs() < four * 2_f64.sqrt());
        assert!((moment(&|(a, _)| a.powi(4)) - 3.0).abs() < four * 96_f64.sqrt());
        assert!(moment(&|(a, b)| a * b).abs() < four);
    }

    #[test]
    fn erlang_numbers_have_mean_and_variance() {
        let mut rng = Pcg64::new(2, 3);
        let numbers: Vec<f64> = (0..DRAWS).map(|_| erlang(9, &mut rng)).collect();
        let mean = numbers.iter().sum::<f64>() / DRAWS as f64;
        let squares = numbers.iter().map(|x| (x - 1.0).powi(2)).sum::<f64>() / DRAWS as f64;
        // Four standard errors: variance 1/9; that of the squares is (2 + 6/9)/81, the excess kurtosis being 6/9.
        let four = 4.0 / (DRAWS as f64).sqrt();
        assert!((mean - 1.0).abs() < four / 3.0);
        assert!((squares - 1.0 / 9.0).abs() < four * (8.0_f64 / 3.0).sqrt() / 9.0);
    }

    #[test]
    fn run_lengths_have_the_given_mean() {
        let mut rng = Pcg64::new(3, 4);
        assert!((0..100).all(|_| run_length(1.0, &mut rng) == 1));
        let mean = 20.0;
        let total: usize = (0..DRAWS).map(|_| run_length(mean, &mut rng)).sum();
        // Standard deviation of the geometric law: sqrt(m (m - 1)); four standard errors.
        let tolerance = 4.0 * (mean * (mean - 1.0) / DRAWS as f64).sqrt();
        assert!((total as f64 / DRAWS as f64 - mean).abs() < tolerance);
    }
}
