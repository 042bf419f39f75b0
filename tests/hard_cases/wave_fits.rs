//! Fits of sines to correlations that do not determine them.

use crate::case::{Case, enter_refusal};
use asperity::surface::condition::ConditioningError;
use asperity::surface::correlation::{CorrelationError, correlate_scans};
use asperity::surface::parameters::ParameterError;
use asperity::surface::sine_fit::{SineFit, SineFitError, fit_sines, superposed_correlation};
use asperity::surface::{
    Conditioning, CorrelationSample, LineScan, RawScan, RoughnessParameters, SineScale, condition,
};
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Gradient that a fit is promised to end at.
const GRADIENT: f64 = 1e-11;

fn scale(wavelength: f64, amplitude: f64) -> SineScale {
    SineScale { wavelength, amplitude }
}

/// 20 lags a decade from 0.01 mm to 20 mm.
fn exact_correlation(scales: &[SineScale]) -> Vec<CorrelationSample> {
    let at = |j: i32| {
        let lag = 1e-5 * 10_f64.powf(f64::from(j) / 20.0);
        CorrelationSample { lag, value: superposed_correlation(scales, lag), pairs: 1 }
    };
    (0..=66).map(at).collect()
}

fn solved(case: &mut Case, fit: &SineFit) {
    case.solved_to(GRADIENT, fit.gradient_norm, fit.iterations);
    case.conditioned(fit.condition_number);
}

/// Condition number of `d log10 C / d ln D` by central differences of the public formula.
fn condition_by_differences(samples: &[CorrelationSample], scales: &[SineScale]) -> f64 {
    let step = 1e-4;
    let logarithm = |lag: f64, changed: usize, factor: f64| {
        let mut scales = scales.to_vec();
        scales[changed].amplitude *= factor;
        superposed_correlation(&scales, lag).log10()
    };
    let jacobian = DMatrix::from_fn(samples.len(), scales.len(), |j, i| {
        let lag = samples[j].lag;
        (logarithm(lag, i, f64::exp(step)) - logarithm(lag, i, f64::exp(-step))) / (2.0 * step)
    });
    let singular = jacobian.singular_values();
    singular.max() / singular.min()
}

/// Two waves closer and closer together: the power of both is known ever so well, its parts less and
/// less, and the condition number says so.
#[test]
fn waves_closer_than_the_scan_tells_apart() {
    for apart in [1e-1, 1e-2, 1e-3] {
        let mut case = Case::new(
            "two waves that the scan cannot resolve",
            format!("67 lags, wavelengths {apart:e} apart"),
            "power of one wave of the same amplitude",
        );
        let samples = exact_correlation(&[scale(5e-4, 1e-5), scale(4e-3, 5e-5)]);
        let fit = fit_sines(&samples, &[5e-4, 4e-3, 4e-3 * (1.0 + apart)]).unwrap();
        solved(&mut case, &fit);
        let power: f64 = fit.scales[1..].iter().map(|s| s.scale.amplitude.powi(2)).sum();
        // Wavelengths that differ by a share change the correlation by as much at most.
        case.agrees(power.sqrt(), 5e-5, 0.1 * apart.max(1e-9));
        case.enter();
    }
}

/// Closer still the valley is flat to round-off: its bottom is not found, and the error says so.
#[test]
fn waves_a_ten_thousandth_apart_are_refused() {
    let samples = exact_correlation(&[scale(5e-4, 1e-5), scale(4e-3, 5e-5)]);
    let error = fit_sines(&samples, &[5e-4, 4e-3, 4e-3 * (1.0 + 1e-4)]).unwrap_err();
    assert!(matches!(error, SineFitError::NotConverged { waves: 3, .. }), "{error}");
    assert!(error.to_string().ends_with("fit fewer waves or more lags"));
    enter_refusal(
        "two waves that the scan cannot resolve",
        "67 lags, wavelengths 1e-4 apart",
        error,
    );
}

/// Round-off of the correlation is the least that a measurement has. What it makes of amplitudes is
/// within the condition number, which two routes find.
#[test]
fn the_condition_number_is_that_of_the_differences() {
    let mut previous = 0.0;
    for apart in [0.3, 1e-1, 1e-2, 1e-3] {
        let mut case = Case::new(
            "two close waves, both in the correlation",
            format!("67 lags, wavelengths {apart:e} apart"),
            "condition number from differences of the correlation",
        );
        let truth = [scale(5e-4, 1e-5), scale(4e-3, 5e-5), scale(4e-3 * (1.0 + apart), 4e-5)];
        let samples = exact_correlation(&truth);
        let wavelengths = truth.map(|s| s.wavelength);
        let fit = fit_sines(&samples, &wavelengths).unwrap();
        solved(&mut case, &fit);
        let fitted = fit.sine_scales();
        let differences = condition_by_differences(&samples, &fitted);
        // Differences of step 1e-4 err by 1e-8, and the smallest singular value by the condition
        // times that.
        case.agrees(fit.condition_number, differences, 1e-8 * differences.max(10.0));
        // The gradient tolerance 1e-11 over the square of the smallest singular value.
        for (a, b) in fitted.iter().zip(&truth) {
            let error = (a.amplitude / b.amplitude - 1.0).abs();
            assert!(error < 1e-10 * differences.powi(2), "{error:e}, {differences:e}");
        }
        assert!(fit.condition_number > previous);
        previous = fit.condition_number;
        case.enter();
    }
}

/// Waves below twice the shortest lag look alike, a plateau each: the interval is infinite, not large.
#[test]
fn waves_that_look_alike_have_no_interval() {
    let mut case =
        Case::new("three waves seen as one plateau", "67 lags", "rms amplitude of the true wave");
    let samples = exact_correlation(&[scale(1e-5, 2e-6), scale(4e-3, 5e-5)]);
    let fit = fit_sines(&samples, &[5e-6, 1e-5, 2e-5, 4e-3]).unwrap();
    // Singular values of 1e-17 are round-off: the number itself is none.
    case.solved_to(GRADIENT, fit.gradient_norm, fit.iterations);
    assert!(fit.condition_number > 1e14, "{}", fit.condition_number);
    case.conditioned(fit.condition_number);
    for fitted in &fit.scales[..3] {
        assert!(matches!(fitted.confidence_95, None | Some(f64::INFINITY)));
    }
    let power: f64 = fit.scales[..3].iter().map(|s| s.scale.amplitude.powi(2)).sum();
    case.agrees(power.sqrt(), 2e-6, 1e-6);
    case.enter();
}

fn scan(heights: Vec<f64>) -> LineScan {
    LineScan { name: "one".into(), origin: 0.0, spacing: 1e-5, heights }
}

/// One scan of whole periods: its correlation is that of its sines, `sum D^2 (1 - cos(q s))`, but for
/// pairs that end within a wave.
#[test]
fn one_scan_is_enough_for_a_fit() {
    let mut case =
        Case::new("one scan", "8000 points, 3 waves", "fit to the closed form of its correlation");
    let waves = [(1e-3, 1e-5, 0.3), (2e-3, 2e-5, 1.1), (4e-3, 3e-5, 2.5)];
    let height = |i: i32| {
        let x = 1e-5 * f64::from(i);
        let wave = |(l, d, phase): &(f64, f64, f64)| d * (TAU * x / l + phase).sin();
        waves.iter().map(wave).sum::<f64>()
    };
    let scans = [scan((0..8000).map(height).collect())];
    let correlation = correlate_scans(&scans, Some(2e-3)).unwrap();
    let wavelengths = waves.map(|wave| wave.0);
    let samples = correlation[0].sample_log_spaced(20);
    let fit = fit_sines(&samples, &wavelengths).unwrap();
    solved(&mut case, &fit);
    let closed_form = |lag: f64| {
        let wave = |(l, d, _): &(f64, f64, f64)| d * d * (1.0 - (TAU * lag / l).cos());
        waves.iter().map(wave).sum::<f64>()
    };
    let exact: Vec<_> = samples
        .iter()
        .map(|sample| CorrelationSample { value: closed_form(sample.lag), ..*sample })
        .collect();
    let expected = fit_sines(&exact, &wavelengths).unwrap();
    solved(&mut case, &expected);
    for (a, b) in fit.scales.iter().zip(&expected.scales) {
        // The pairs of a lag end within a wave: a share of the longest wave over the scan, 1/20,
        // of the products of different waves is left.
        case.agrees(a.scale.amplitude, b.scale.amplitude, 0.05);
        assert!(a.confidence_95.unwrap().is_finite());
    }
    case.enter();
}

#[test]
fn constant_heights_are_refused() {
    let flat = scan(vec![0.0123; 4000]);
    let error = RoughnessParameters::of(&flat, 0.0123).unwrap_err();
    assert_eq!(error, ParameterError::Flat { scan: "one".into(), height: 0.0123 });
    enter_refusal("constant heights, roughness parameters", "4000 points", error);

    let correlation = correlate_scans(&[flat], Some(2e-3)).unwrap();
    let samples = correlation[0].sample_log_spaced(20);
    let error = fit_sines(&samples, &[1e-3, 2e-3]).unwrap_err();
    assert_eq!(error, SineFitError::NotPositive { lag: 1e-5, value: 0.0 });
    enter_refusal("constant heights, wave fit", "4000 points", error);
}

#[test]
fn two_heights_out_of_thousands_are_refused() {
    let mut heights = vec![f64::NAN; 4000];
    (heights[100], heights[140]) = (1e-5, 3e-5);
    let sparse = scan(heights);

    let raw = RawScan {
        name: "one".into(),
        positions: (0..4000).map(|i| 1e-5 * f64::from(i)).collect(),
        heights: sparse.heights.clone(),
    };
    let error = condition(&raw, &Conditioning::default()).unwrap_err();
    let ConditioningError::NothingLeft { windows: 1, .. } = &error else { panic!("{error}") };
    assert!(error.to_string().contains("are missing, the limit is 10.0 % (max_missing)"));
    enter_refusal("all points missing but two, ingest", "4000 points", error);

    let error = RoughnessParameters::of(&sparse, 0.0).unwrap_err();
    assert_eq!(error, ParameterError::NoNeighbours { scan: "one".into() });
    enter_refusal("all points missing but two, roughness parameters", "4000 points", error);

    // One pair, whose correlation is the square of its difference.
    let correlation = correlate_scans(&[sparse], Some(2e-2)).unwrap();
    let samples = correlation[0].sample(&(1..=2000).collect::<Vec<_>>());
    assert_eq!(samples.len(), 1);
    approx::assert_relative_eq!(samples[0].lag, 4e-4, max_relative = 1e-12);
    // The transform errs by 2e-15 of the mean square height.
    approx::assert_relative_eq!(samples[0].value, 4e-10, max_relative = 1e-12);
    let error = fit_sines(&samples, &[1e-3]).unwrap_err();
    assert_eq!(error, SineFitError::TooFewLags { lags: 1, waves: 1 });
    enter_refusal("all points missing but two, wave fit", "4000 points", error);
}

#[test]
fn one_height_is_refused() {
    let mut heights = vec![f64::NAN; 4000];
    heights[100] = 1e-5;
    let error = correlate_scans(&[scan(heights)], None).unwrap_err();
    assert_eq!(error, CorrelationError::TooFewHeights { scan: "one".into(), valid: 1 });
    enter_refusal("all points missing but one", "4000 points", error);
}
