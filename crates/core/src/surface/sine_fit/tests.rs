use super::cost::LogarithmicCost;
use super::*;
use crate::surface::TABLE_3_1_MM;
use approx::assert_relative_eq;
use argmin::core::{CostFunction, Gradient, Hessian};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Amplitudes in mm of Table 3.1.
fn amplitudes_mm() -> [f64; 8] {
    TABLE_3_1_MM.map(|(_, amplitude)| amplitude)
}

fn ladder(waves: usize) -> Vec<f64> {
    (0..waves).map(|i| 6.25e-5 * 2_f64.powi(i as i32)).collect()
}

fn scales(amplitudes_mm: &[f64]) -> Vec<SineScale> {
    let pairs = ladder(amplitudes_mm.len()).into_iter().zip(amplitudes_mm);
    pairs.map(|(wavelength, d)| SineScale { wavelength, amplitude: d * 1e-3 }).collect()
}

/// 20 lags a decade from 0.01 mm to 20 mm.
fn synthetic(scales: &[SineScale], mut factor: impl FnMut(usize) -> f64) -> Vec<CorrelationSample> {
    let mut at = |j: usize| {
        let lag = 1e-5 * 10_f64.powf(j as f64 / 20.0);
        CorrelationSample { lag, value: superposed_correlation(scales, lag) * factor(j), pairs: 1 }
    };
    (0..=66).map(&mut at).collect()
}

fn assert_recovered(amplitudes_mm: &[f64]) {
    let truth = scales(amplitudes_mm);
    let fit = fit_sines(&synthetic(&truth, |_| 1.0), &ladder(truth.len())).unwrap();
    println!(
        "{} waves: {} iterations, condition {}, gradient {:e}, residual {:e}",
        truth.len(),
        fit.iterations,
        fit.condition_number,
        fit.gradient_norm,
        fit.rms_residual
    );
    for (fitted, truth) in fit.scales.iter().zip(&truth) {
        assert_relative_eq!(fitted.scale.amplitude, truth.amplitude, max_relative = 1e-6);
        // The residual is that of the iteration; its interval is as small.
        assert!(fitted.confidence_95.unwrap() < 1e-6 * truth.amplitude);
    }
}

#[test]
fn the_amplitudes_of_table_3_1_are_recovered() {
    assert_recovered(&amplitudes_mm());
}

#[test]
fn nine_waves_of_table_3_2_are_recovered() {
    // Thesis, Table 3.2: 0.0625 mm to 16 mm.
    assert_recovered(&[
        0.01876, 0.02608, 0.03111, 0.06250, 0.07684, 0.19695, 0.21748, 0.43148, 0.21994,
    ]);
}

#[test]
fn seven_waves_up_to_four_millimetres_do_worse_than_eight() {
    let samples = synthetic(&scales(&amplitudes_mm()), |_| 1.0);
    let residual = |waves: usize| fit_sines(&samples, &ladder(waves)).unwrap().rms_residual;
    println!("rms residual in log10 C of 7, 8 waves: {}, {:e}", residual(7), residual(8));
    // 0.49 mm of 8 mm wavelength cannot be had from waves up to 4 mm: some 10 % of C.
    assert!(residual(7) > 0.02 && residual(8) < 1e-8);
}

/// Multiplicative noise, uniform within a share.
fn noisy(share: f64, seed: u64) -> impl FnMut(usize) -> f64 {
    let mut generator = Pcg64::seed_from_u64(seed);
    move |_| 1.0 + share * (2.0 * generator.random::<f64>() - 1.0)
}

#[test]
fn twenty_random_starts_lead_to_the_same_minimum() {
    let (wavelengths, mut generator) = (ladder(8), Pcg64::seed_from_u64(1));
    for seed in 0..5 {
        let samples = synthetic(&scales(&amplitudes_mm()), noisy(0.3, seed));
        let reference = fit_sines(&samples, &wavelengths).unwrap();
        let mut most = reference.iterations;
        for _ in 0..20 {
            // Two decades around half a millimetre, whatever the wave.
            let start: Vec<f64> =
                (0..8).map(|_| 5e-6 * 10_f64.powf(2.0 * generator.random::<f64>())).collect();
            let fit = fit_from(&samples, &wavelengths, &start).unwrap();
            most = most.max(fit.iterations);
            for (a, b) in fit.scales.iter().zip(&reference.scales) {
                // Gradient 1e-11 times a condition of some 100, squared.
                let difference = (a.scale.amplitude - b.scale.amplitude).abs();
                assert!(difference < 1e-6 * 5e-4, "{a:?} {b:?}");
            }
        }
        println!("seed {seed}: at most {most} iterations, residual {}", reference.rms_residual);
    }
}

/// Coordinate descent by golden sections over `D >= 0`: slow, without derivatives.
fn oracle_cost(samples: &[CorrelationSample], wavelengths: &[f64]) -> f64 {
    let unit =
        |s: &CorrelationSample| wavelengths.iter().map(|&w| unit_correlation(w, s.lag)).collect();
    let rows: Vec<(Vec<f64>, f64)> = samples.iter().map(|s| (unit(s), s.value.log10())).collect();
    let cost = |amplitudes: &[f64]| {
        let sum = |row: &[f64]| row.iter().zip(amplitudes).map(|(g, d)| g * d * d).sum::<f64>();
        let squares = rows.iter().map(|(row, measured)| (sum(row).log10() - measured).powi(2));
        squares.sum::<f64>() / rows.len() as f64
    };
    let mut amplitudes = vec![1e-4; wavelengths.len()];
    for _ in 0..2000 {
        for i in 0..amplitudes.len() {
            let (mut low, mut high) = (0.0, 1e-3);
            let mut at = |d: f64| {
                amplitudes[i] = d;
                cost(&amplitudes)
            };
            while high - low > 1e-11 {
                let (a, b) = (high - 0.618 * (high - low), low + 0.618 * (high - low));
                if at(a) < at(b) { high = b } else { low = a }
            }
            amplitudes[i] = f64::midpoint(low, high);
        }
    }
    cost(&amplitudes)
}

#[test]
fn waves_the_correlation_has_no_place_for_become_zero() {
    let truth = scales(&[0.02, 0.0, 0.03, 0.0]);
    let mut zeros = 0;
    for seed in 0..4 {
        let samples: Vec<_> = synthetic(&truth, noisy(0.2, seed)).split_off(5);
        let fit = fit_sines(&samples, &ladder(4)).unwrap();
        let cost = fit.rms_residual.powi(2);
        let oracle = oracle_cost(&samples, &ladder(4));
        assert!(cost <= oracle * (1.0 + 1e-12), "{cost} {oracle}");
        // Coordinate descent ends close to the minimum, not at it.
        assert!(cost >= oracle * (1.0 - 1e-4), "{cost} {oracle}");
        for fitted in &fit.scales {
            assert_eq!(fitted.scale.amplitude == 0.0, fitted.confidence_95.is_none());
            zeros += usize::from(fitted.scale.amplitude == 0.0);
        }
    }
    // Noise leaves an amplitude of zero at the bound about every other time, 8 of them here.
    assert!(zeros >= 2, "{zeros}");
}

#[test]
fn the_interval_covers_the_truth_in_95_of_100_fits_with_independent_residuals() {
    let truth = scales(&amplitudes_mm());
    let mut covered = 0;
    for seed in 0..100 {
        let fit = fit_sines(&synthetic(&truth, noisy(0.005, seed)), &ladder(8)).unwrap();
        let inside = |(fitted, truth): (&FittedScale, &SineScale)| {
            (fitted.scale.amplitude - truth.amplitude).abs() < fitted.confidence_95.unwrap()
        };
        covered += fit.scales.iter().zip(&truth).filter(|pair| inside(*pair)).count();
    }
    println!("{covered} of 800 intervals cover the amplitude");
    // 760 of 800 expected, standard deviation 6 if independent, up to 17 if the 8 go together.
    assert!((710..=795).contains(&covered), "{covered}");
}

#[test]
fn derivatives_agree_with_differences() {
    let samples = synthetic(&scales(&amplitudes_mm()), noisy(0.3, 7));
    let shapes =
        DMatrix::from_fn(samples.len(), 8, |j, i| unit_correlation(ladder(8)[i], samples[j].lag));
    let measured = DVector::from_iterator(samples.len(), samples.iter().map(|s| s.value.log10()));
    let cost = LogarithmicCost::new(&shapes, &measured, &[1e-4; 8]);
    let x = DVector::from_fn(8, |i, _| 0.3 + 0.2 * i as f64);
    let (gradient, hessian) = (cost.gradient(&x).unwrap(), cost.hessian(&x).unwrap());
    let h = 1e-5;
    for i in 0..8 {
        let moved = |step: f64| {
            let mut moved = x.clone();
            moved[i] += step;
            moved
        };
        let (up, down) = (moved(h), moved(-h));
        let slope = (cost.cost(&up).unwrap() - cost.cost(&down).unwrap()) / (2.0 * h);
        // Central differences: h^2 and eps / h, both 1e-10.
        assert_relative_eq!(gradient[i], slope, epsilon = 1e-8);
        let column = (cost.gradient(&up).unwrap() - cost.gradient(&down).unwrap()) / (2.0 * h);
        assert!((hessian.column(i) - column).norm() < 1e-8);
    }
}

#[test]
fn waves_that_look_alike_have_infinite_intervals() {
    // Both wavelengths are below twice the shortest lag: constants, and only their sum is known.
    let samples = synthetic(&scales(&amplitudes_mm()), noisy(0.1, 3));
    let fit = fit_sines(&samples, &[1e-5, 2e-5, 1e-3, 8e-3]).unwrap();
    assert!(fit.condition_number > SINGULAR);
    assert_eq!(fit.scales[0].confidence_95, Some(f64::INFINITY));
}

#[test]
fn impossible_input_is_an_error() {
    let samples = synthetic(&scales(&amplitudes_mm()), |_| 1.0);
    let few = fit_sines(&samples[..8], &ladder(8)).unwrap_err();
    assert_eq!(few, SineFitError::TooFewLags { lags: 8, waves: 8 });
    assert!(matches!(fit_sines(&samples, &[]), Err(SineFitError::TooFewLags { .. })));
    for wavelengths in [[2e-3, 1e-3], [0.0, 1e-3], [1e-3, f64::NAN]] {
        let error = fit_sines(&samples, &wavelengths).unwrap_err();
        assert!(matches!(error, SineFitError::Wavelength { .. }));
    }
    for value in [0.0, -1.0, f64::NAN] {
        let mut bad = samples.clone();
        bad[3].value = value;
        let error = fit_sines(&bad, &ladder(8)).unwrap_err();
        assert!(matches!(error, SineFitError::NotPositive { .. }));
    }
}
