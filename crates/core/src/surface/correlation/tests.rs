use super::*;
use approx::assert_relative_eq;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

fn scan(spacing: f64, heights: Vec<f64>) -> LineScan {
    LineScan { name: "07".into(), origin: 0.0, spacing, heights }
}

/// The definition, pair by pair; summed in blocks, as a plain sum of 1e5 terms is itself only good
/// to some 1e-14.
fn oracle(heights: &[f64], lag: usize) -> (f64, u64) {
    let squares: Vec<f64> = (0..heights.len() - lag)
        .map(|i| (heights[i + lag] - heights[i]).powi(2))
        .filter(|square| !square.is_nan())
        .collect();
    let sum: f64 = squares.chunks(300).map(|block| block.iter().sum::<f64>()).sum();
    (sum / squares.len() as f64, squares.len() as u64)
}

/// White noise with a share of missing points; a common height of 100 times the roughness tests
/// the subtraction of the mean.
fn gappy_noise(points: usize, missing: f64, seed: u64) -> Vec<f64> {
    let mut generator = Pcg64::seed_from_u64(seed);
    let mut draw = || generator.random::<f64>();
    (0..points).map(|_| if draw() < missing { f64::NAN } else { 100.0 + draw() }).collect()
}

fn assert_matches_oracle(heights: Vec<f64>, maximum_lag: usize) {
    let plan = CorrelationPlan::new(heights.len(), maximum_lag);
    let correlation = plan.correlate(&scan(1e-6, heights.clone())).unwrap();
    assert_eq!(correlation.values.len(), maximum_lag + 1);
    for lag in 0..=maximum_lag {
        let (value, pairs) = oracle(&heights, lag);
        assert_eq!(correlation.pairs[lag], pairs, "lag {lag}");
        if pairs == 0 {
            assert!(correlation.values[lag].is_nan());
        } else {
            // Round-off of the FFT form is 1e-15 of the variance; the mean of the heights (100 in
            // this test, eps 1e-14) is subtracted with its own round-off.
            let error = (correlation.values[lag] - value).abs();
            assert!(error < 1e-12 * correlation.variance, "lag {lag}: {error:e}");
        }
    }
}

#[test]
fn gappy_noise_agrees_with_the_definition_at_every_lag() {
    assert_matches_oracle(gappy_noise(700, 0.2, 1), 699);
    assert_matches_oracle(gappy_noise(512, 0.0, 2), 256);
}

proptest! {
    #[test]
    fn any_gaps_agree_with_the_definition(
        points in 2_usize..120, missing in 0.0..0.9, seed in any::<u64>(), share in 0.0..1.0,
    ) {
        let heights = gappy_noise(points, missing, seed);
        prop_assume!(heights.iter().filter(|z| !z.is_nan()).count() > 1);
        assert_matches_oracle(heights, ((points - 1) as f64 * share) as usize);
    }
}

#[test]
fn round_off_stays_below_its_stated_bound_on_a_long_smooth_scan() {
    // C at lag 17 is 1e-5 of the variance here, the hardest case for the FFT form.
    let (points, periods) = (160_000, 5.0);
    let step = TAU * periods / points as f64;
    let mut heights: Vec<f64> = (0..points).map(|i| 1e-3 * (step * i as f64).sin()).collect();
    heights[1000..3000].fill(f64::NAN);
    let plan = CorrelationPlan::new(points, points / 2);
    let correlation = plan.correlate(&scan(1e-6, heights.clone())).unwrap();
    for lag in [1, 16, 17, 20, 100, 1000, 40_000, 80_000] {
        let (value, pairs) = oracle(&heights, lag);
        assert_eq!(correlation.pairs[lag], pairs);
        let error = (correlation.values[lag] - value).abs() / correlation.variance;
        println!("lag {lag}: C {:e} Rq^2, error {error:e} Rq^2", value / correlation.variance);
        assert!(error < 1e-14, "lag {lag}: {error:e} of the variance");
        if lag <= DIRECT_LAGS {
            // Differences of heights rounded to eps; the mean subtracted.
            assert_relative_eq!(correlation.values[lag], value, max_relative = 1e-11);
        }
    }
}

#[test]
fn a_periodic_sine_follows_its_closed_form() {
    let (points, amplitude) = (6400, 3e-4);
    let step = TAU / 64.0;
    let heights = (0..points).map(|i| amplitude * (step * i as f64).sin()).collect();
    let correlation = CorrelationPlan::new(points, 640).correlate(&scan(1e-6, heights)).unwrap();
    for lag in (64..=640).step_by(64) {
        // A lag of whole periods: every difference vanishes.
        assert!(correlation.values[lag] < 1e-14 * amplitude * amplitude);
        // Half a period on, 99 or fewer whole periods less half a one are pooled: exact.
        let half = correlation.values[lag - 32];
        assert_relative_eq!(half, 2.0 * amplitude * amplitude, max_relative = 1e-12);
    }
}

#[test]
fn averaging_pools_the_pairs() {
    let (first, second) = (gappy_noise(300, 0.3, 3), gappy_noise(200, 0.1, 4));
    let scans = [scan(1e-6, first.clone()), scan(1e-6, second.clone())];
    let correlations = correlate_scans(&scans, None).unwrap();
    let average = HeightDifferenceCorrelation::average(&correlations).unwrap();
    assert_eq!(average.maximum_lag(), 100);
    for lag in 1..=100 {
        let ((a, n), (b, m)) = (oracle(&first, lag), oracle(&second, lag));
        let pooled = (a * n as f64 + b * m as f64) / (n + m) as f64;
        assert_eq!(average.pairs[lag], n + m);
        assert_relative_eq!(average.values[lag], pooled, max_relative = 1e-11);
    }
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let scans: Vec<LineScan> =
        (0..6).map(|seed| scan(1e-6, gappy_noise(5000, 0.05, seed))).collect();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let correlations = pool.install(|| correlate_scans(&scans, Some(1e-3))).unwrap();
        HeightDifferenceCorrelation::average(&correlations).unwrap()
    };
    assert_eq!(run(1), run(4));
}

#[test]
fn log_spaced_lags_ascend_without_duplicates() {
    let lags = log_spaced_lags(1000, 20);
    assert_eq!(lags[..6], [1, 2, 3, 4, 5, 6]);
    assert_eq!(lags.last(), Some(&1000));
    assert!(lags.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(log_spaced_lags(0, 20).is_empty());
}

#[test]
fn impossible_input_is_an_error() {
    let plan = CorrelationPlan::new(4, 2);
    let long = plan.correlate(&scan(1.0, vec![0.0; 5])).unwrap_err();
    assert!(matches!(long, CorrelationError::TooLong { points: 5, limit: 4, .. }));
    let empty = plan.correlate(&scan(1.0, vec![f64::NAN, 1.0, f64::NAN])).unwrap_err();
    assert!(matches!(empty, CorrelationError::TooFewHeights { valid: 1, .. }));
    let none = correlate_scans(&[scan(1.0, vec![])], None).unwrap_err();
    assert!(matches!(none, CorrelationError::TooFewHeights { valid: 0, .. }));
    let scans = [scan(1.0, vec![0.0, 1.0]), scan(1.1, vec![0.0, 1.0])];
    let unequal =
        HeightDifferenceCorrelation::average(&correlate_scans(&scans, None).unwrap()).unwrap_err();
    assert_eq!(unequal, CorrelationError::UnequalSpacing { first: 1.0, other: 1.1 });
    assert_eq!(HeightDifferenceCorrelation::average(&[]), Err(CorrelationError::NoScans));
}
