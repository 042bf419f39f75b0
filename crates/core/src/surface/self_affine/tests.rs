use super::*;
use approx::assert_relative_eq;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const SPACING: f64 = 1e-5;

/// Exact model, with a relative deviation at each lag.
fn model(
    hurst: f64,
    lateral: f64,
    vertical: f64,
    mut deviation: impl FnMut(usize) -> f64,
) -> HeightDifferenceCorrelation {
    let mut value = |lag: usize| {
        let ratio = (lag as f64 * SPACING / lateral).min(1.0);
        vertical * vertical * ratio.powf(2.0 * hurst) * (1.0 + deviation(lag))
    };
    let values: Vec<f64> = (0..4000).map(&mut value).collect();
    let pairs = (0..4000).map(|lag| 8000 - lag).collect();
    let variance = vertical * vertical / 2.0;
    HeightDifferenceCorrelation { spacing: SPACING, variance, values, pairs }
}

#[test]
fn the_exact_model_is_recovered() {
    let fit = fit_self_affine(&[model(0.65, 2.34e-3, 8e-4, |_| 0.0)], None).unwrap();
    assert_relative_eq!(fit.hurst_exponent, 0.65, max_relative = 1e-12);
    assert_relative_eq!(fit.lateral_length, 2.34e-3, max_relative = 1e-11);
    assert_relative_eq!(fit.vertical_length, 8e-4, max_relative = 1e-12);
    assert!(fit.plateau_found && fit.rms_residual < 1e-12);
    assert_eq!((fit.hurst_exponent_95, fit.scans), (None, 1));
    assert_relative_eq!(fit.range.shortest, SPACING);
}

/// Sum of squares over a fine grid of hinges.
fn oracle_squares(correlation: &HeightDifferenceCorrelation) -> f64 {
    let samples = correlation.sample_log_spaced(20);
    let x: Vec<f64> = samples.iter().map(|sample| sample.lag.log10()).collect();
    let y: Vec<f64> = samples.iter().map(|sample| sample.value.log10()).collect();
    let grid = (0..=30_000).map(|i| x[2] + (x[x.len() - 1] - x[2]) * f64::from(i) / 30_000.0);
    grid.map(|c| Hinge::at(c, &x, &y).squares).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_jackknife_by_subtraction_is_that_of_fits_without_each_scan() {
    let mut generator = Pcg64::seed_from_u64(5);
    let mut scans: Vec<_> = (0..12)
        .map(|i| {
            let vertical = 8e-4 * (1.0 + 0.05 * f64::from(i));
            model(0.7, 1e-3, vertical, |_| 0.3 * (generator.random::<f64>() - 0.5))
        })
        .collect();
    // A lag without pairs in one scan, as gaps leave it.
    (scans[4].values[100], scans[4].pairs[100]) = (f64::NAN, 0);
    let fit = fit_self_affine(&scans, None).unwrap();
    let without: Vec<[f64; 3]> = (0..scans.len())
        .map(|left_out| {
            let mut rest = scans.clone();
            rest.remove(left_out);
            let fit = fit_self_affine(&rest, None).unwrap();
            [fit.hurst_exponent, fit.lateral_length.log10(), fit.vertical_length.log10()]
        })
        .collect();
    let half = |which: usize| jackknife_95(&without.iter().map(|e| e[which]).collect::<Vec<_>>());
    let found = fit.hurst_exponent_95.unwrap();
    // Spreads of 1e-3 of estimates with a round-off of 1e-14.
    assert_relative_eq!((found.upper - found.lower) / 2.0, half(0), max_relative = 1e-9);
    let found = fit.lateral_length_95.unwrap();
    assert_relative_eq!((found.upper / found.lower).log10() / 2.0, half(1), max_relative = 1e-9);
    let found = fit.vertical_length_95.unwrap();
    assert_relative_eq!((found.upper / found.lower).log10() / 2.0, half(2), max_relative = 1e-9);
}

#[test]
fn no_hinge_on_a_fine_grid_does_better() {
    let mut generator = Pcg64::seed_from_u64(1);
    for lateral in [1e-4, 1e-3, 2e-2] {
        let noise = |_| 0.3 * (generator.random::<f64>() - 0.5);
        let correlation = model(0.7, lateral, 8e-4, noise);
        let fit = fit_self_affine(std::slice::from_ref(&correlation), None).unwrap();
        let squares = fit.rms_residual.powi(2) * fit.lags as f64;
        let grid = oracle_squares(&correlation);
        // The grid is finite, so it may be worse but not better than the exact minimum.
        assert!(squares <= grid * (1.0 + 1e-12), "{squares} against {grid}");
        assert!(squares >= grid * (1.0 - 1e-4), "{squares} against {grid}");
    }
}

#[test]
fn without_a_plateau_the_lengths_are_bounds_and_say_so() {
    let fit = fit_self_affine(&[model(0.8, 1.0, 1.0, |_| 0.0)], None).unwrap();
    assert_relative_eq!(fit.hurst_exponent, 0.8, max_relative = 1e-12);
    assert!(!fit.plateau_found);
    assert_relative_eq!(fit.lateral_length, fit.range.longest, max_relative = 1e-12);
}

#[test]
fn the_jackknife_of_a_plateau_is_the_interval_of_its_mean() {
    // Scans that differ by a factor only: log10 of the pooled plateau is a smooth function of
    // the mean of the factors, for which the jackknife tends to the interval of the mean.
    let factors = [0.98, 1.0, 1.01, 1.02, 0.99];
    let scans = factors.map(|factor| model(0.65, 2e-3, 8e-4, |_| factor - 1.0));
    let fit = fit_self_affine(&scans, None).unwrap();
    let mean = crate::numerics::statistics::MeanEstimate::of(&factors);
    // d log10(xi_perp) = d factor / (2 ln 10)
    let half = mean.confidence_95 / (2.0 * 10_f64.ln());
    let interval = fit.vertical_length_95.unwrap();
    // Second order in factors that spread by 1 %.
    assert_relative_eq!((interval.upper / interval.lower).log10(), 2.0 * half, max_relative = 1e-2);
    let hurst = fit.hurst_exponent_95.unwrap();
    assert!(hurst.upper - hurst.lower < 1e-10);
}

#[test]
fn the_range_limits_the_lags() {
    let scan = [model(0.65, 2e-3, 8e-4, |lag| if lag < 10 { 1.0 } else { 0.0 })];
    let range = LagRange { shortest: 10.0 * SPACING, longest: 1e-2, per_decade: 10 };
    let fit = fit_self_affine(&scan, Some(range)).unwrap();
    assert_relative_eq!(fit.hurst_exponent, 0.65, max_relative = 1e-11);
    assert_eq!((fit.lags, fit.range.shortest), (21, 10.0 * SPACING));
}

#[test]
fn impossible_input_is_an_error() {
    let scan = model(0.65, 2e-3, 8e-4, |_| 0.0);
    let narrow = LagRange { shortest: 1e-4, longest: 1.1e-4, per_decade: 10 };
    let few = fit_self_affine(std::slice::from_ref(&scan), Some(narrow)).unwrap_err();
    assert!(matches!(few, SelfAffineError::TooFewLags { lags: 1, .. }));
    let zero = fit_self_affine(&[model(0.6, 1e-3, 0.0, |_| 0.0)], None).unwrap_err();
    assert!(matches!(zero, SelfAffineError::NotPositive { value: 0.0, .. }));
    let falling = fit_self_affine(&[model(-0.5, 1.0, 8e-4, |_| 0.0)], None);
    assert!(falling.is_err());
    let mut other = scan.clone();
    other.spacing *= 2.0;
    assert!(matches!(
        fit_self_affine(&[scan, other], None),
        Err(SelfAffineError::Correlation(CorrelationError::UnequalSpacing { .. }))
    ));
    assert!(fit_self_affine(&[], None).is_err());
}
