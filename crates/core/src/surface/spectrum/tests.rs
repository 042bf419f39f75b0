use super::*;
use crate::surface::correlation::CorrelationPlan;
use approx::assert_relative_eq;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;

const SPACING: f64 = 1e-5;

fn noise(points: usize, seed: u64) -> LineScan {
    let mut generator = Pcg64::seed_from_u64(seed);
    let heights = (0..points).map(|_| generator.random::<f64>() - 0.4).collect();
    LineScan { name: "07".into(), origin: 0.0, spacing: SPACING, heights }
}

fn correlate(scan: &LineScan, lag: usize) -> HeightDifferenceCorrelation {
    CorrelationPlan::new(scan.heights.len(), lag).correlate(scan).unwrap()
}

fn power(spectrum: &PowerSpectrum) -> f64 {
    spectrum.density.iter().sum::<f64>() * spectrum.wavenumber_step
}

#[test]
fn parseval_holds_without_a_window_for_even_odd_and_prime_lengths() {
    for points in [2, 3, 4000, 4001, 4007] {
        let scan = noise(points, 1);
        let spectrum = SpectrumPlan::new(points).unwrap().periodogram(&scan, Window::None).unwrap();
        let mean_square = scan.heights.iter().map(|z| z * z).sum::<f64>() / points as f64;
        assert_relative_eq!(power(&spectrum), mean_square, max_relative = 1e-12);
    }
}

#[test]
fn a_sine_on_the_grid_keeps_its_power_under_either_window() {
    let (points, periods, amplitude) = (1000, 50, 2e-4);
    let step = TAU * periods as f64 / points as f64;
    let mut scan = noise(points, 1);
    scan.heights = (0..points).map(|i| amplitude * (step * i as f64).sin()).collect();
    let plan = SpectrumPlan::new(points).unwrap();
    for window in [Window::None, Window::Hann] {
        let spectrum = plan.periodogram(&scan, window).unwrap();
        // mean of sin^2 is 1/2 with or without the weight of the Hann window.
        assert_relative_eq!(power(&spectrum), amplitude.powi(2) / 2.0, max_relative = 1e-12);
        let peak = spectrum.density.iter().copied().fold(0.0, f64::max);
        assert_eq!(spectrum.density[periods], peak);
        assert_relative_eq!(spectrum.wavenumber(periods), step / SPACING, max_relative = 1e-14);
    }
}

#[test]
fn the_cosine_transform_agrees_with_its_definition_and_keeps_the_variance() {
    let mut scan = noise(400, 2);
    scan.heights[100..130].fill(f64::NAN);
    let correlation = correlate(&scan, 120);
    let spectrum = SpectrumPlan::new(400).unwrap().blackman_tukey(&correlation, 90).unwrap();
    assert_relative_eq!(power(&spectrum), correlation.variance, max_relative = 1e-12);
    for k in [1, 7, 100, 199] {
        let term = |lag: usize| {
            let covariance = correlation.variance - correlation.values[lag] / 2.0;
            let angle = spectrum.wavenumber(k) * lag as f64 * SPACING;
            2.0 * parzen(lag as f64 / 90.0) * covariance * angle.cos()
        };
        let sum = correlation.variance + (1..=90).map(term).sum::<f64>();
        let exact = SPACING / PI * sum;
        // Terms of the size of the density at white noise cancel; no more than 1e-12 of it.
        let white = SPACING / PI * correlation.variance;
        assert_relative_eq!(spectrum.density[k], exact, epsilon = 1e-12 * white);
    }
}

#[test]
fn both_routes_see_the_flat_spectrum_of_white_noise() {
    let points = 20_000;
    let complete = noise(points, 3);
    let mut gappy = complete.clone();
    gappy.heights.iter_mut().step_by(10).for_each(|z| *z = f64::NAN);
    let scans = [complete, gappy];
    let correlations = scans.each_ref().map(|scan| correlate(scan, 200));
    let spectra = power_spectra(&scans, &correlations, Window::Hann).unwrap();
    assert_eq!(spectra[0].routes, [Route::Periodogram(Window::Hann)]);
    assert_eq!(spectra[1].routes, [Route::BlackmanTukey { maximum_lag: 200 }]);
    // Variance 1/12 over wavenumbers 0 to π / spacing.
    let white = SPACING / PI / 12.0;
    for spectrum in &spectra {
        for bin in spectrum.log_binned(4).iter().filter(|bin| bin.count > 2000) {
            // Some 2000 independent exponential values at least: 2.2 %, four times that;
            // smoothing over 100 wavenumbers averages them, it does not shift them.
            assert_relative_eq!(bin.density, white, max_relative = 0.09);
        }
    }
    let average = PowerSpectrum::average(&spectra).unwrap();
    assert_eq!(average.routes.len(), 2);
    let expected = f64::midpoint(spectra[0].density[77], spectra[1].density[77]);
    assert_eq!(average.density[77], expected);
}

#[test]
fn bins_share_their_edges_and_hold_every_wavenumber_but_zero() {
    let plan = SpectrumPlan::new(3000).unwrap();
    let spectrum = plan.periodogram(&noise(3000, 4), Window::None).unwrap();
    let bins = spectrum.log_binned(10);
    assert_eq!(bins.iter().map(|bin| bin.count).sum::<usize>(), 1500);
    let total: f64 = bins.iter().map(|bin| bin.density * bin.count as f64).sum();
    let expected: f64 = spectrum.density[1..].iter().sum();
    assert_relative_eq!(total, expected, max_relative = 1e-12);
    let index = |q: f64| (q.log10() * 10.0).floor();
    assert!(bins.windows(2).all(|b| index(b[0].wavenumber) < index(b[1].wavenumber)));
}

#[test]
fn impossible_input_is_an_error() {
    let plan = SpectrumPlan::new(100).unwrap();
    let mut scan = noise(100, 5);
    scan.heights[3] = f64::NAN;
    let gaps = plan.periodogram(&scan, Window::None).unwrap_err();
    assert_eq!(gaps, SpectrumError::Gaps { scan: "07".into(), missing: 1 });
    let other = plan.periodogram(&noise(99, 5), Window::None).unwrap_err();
    assert_eq!(other, SpectrumError::OtherLength { points: 99, planned: 100 });
    let long = plan.blackman_tukey(&correlate(&scan, 60), 51).unwrap_err();
    assert_eq!(long, SpectrumError::LagTooLong { maximum_lag: 51, points: 100 });
    scan.heights[1..60].fill(f64::NAN);
    let hole = plan.blackman_tukey(&correlate(&scan, 60), 50).unwrap_err();
    assert_eq!(hole, SpectrumError::NoPairs { lag: 40 });
    assert!(matches!(SpectrumPlan::new(1), Err(SpectrumError::Empty)));
    assert_eq!(PowerSpectrum::average(&[]), Err(SpectrumError::Empty));
}

#[test]
fn parseval_holds_for_the_weighted_heights_under_every_window() {
    for window in [Window::None, Window::Hann, Window::Welch] {
        for points in [2, 3, 4000, 4001] {
            let scan = noise(points, 6);
            let spectrum = SpectrumPlan::new(points).unwrap().periodogram(&scan, window).unwrap();
            let (mut weighted, mut weights) = (scan.heights.clone(), vec![1.0; points]);
            window.apply(&mut weighted);
            window.apply(&mut weights);
            let squares = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
            let expected = squares(&weighted) / squares(&weights);
            assert_relative_eq!(power(&spectrum), expected, max_relative = 1e-12);
        }
    }
}

/// Normal heights, independent of each other, by Box and Muller.
fn normal_noise(points: usize, seed: u64) -> LineScan {
    let mut generator = Pcg64::seed_from_u64(seed);
    let mut scan = noise(points, seed);
    scan.heights.fill_with(|| {
        let (u, v): (f64, f64) = (generator.random(), generator.random());
        (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
    });
    scan
}

#[test]
fn the_geometric_mean_is_freed_of_its_bias_and_errors_are_as_large_as_they_say() {
    let (points, scans) = (2000, 200);
    let plan = SpectrumPlan::new(points).unwrap();
    let white = SPACING / PI;
    for window in [Window::None, Window::Hann, Window::Welch] {
        let spectra: Vec<PowerSpectrum> = (0..scans)
            .map(|seed| plan.periodogram(&normal_noise(points, seed), window).unwrap())
            .collect();
        let bins = PowerSpectrum::log_binned_over(&spectra, 5).unwrap();
        // exp(-γ) in every table.
        assert_relative_eq!(bins[0].geometric_bias, 0.561_459_483_566_885, max_relative = 1e-12);
        for (i, bin) in bins.iter().enumerate().skip(5).filter(|(_, bin)| bin.count > 30) {
            // Some 200 x 30 / 1.9 values at least, standard deviation 1 of one of them and
            // π/sqrt(6) = 1.28 of its logarithm: 2.3 %, four times that.
            assert_relative_eq!(bin.density, white, max_relative = 0.08);
            assert_relative_eq!(bin.geometric_density.unwrap(), white, max_relative = 0.1);
            // The spread of 200 scans is known to 5 %, four times that.
            let one = spectra[0].log_binned(5)[i];
            let of_one = one.standard_error / one.density * bin.density;
            let of_all = bin.standard_error * f64::from(scans as u32).sqrt();
            assert_relative_eq!(of_one, of_all, max_relative = 0.2);
        }
    }
}

#[test]
fn the_mean_over_scans_is_that_of_their_average() {
    let plan = SpectrumPlan::new(900).unwrap();
    let spectra: Vec<PowerSpectrum> =
        (0..3).map(|seed| plan.periodogram(&noise(900, seed), Window::Welch).unwrap()).collect();
    let over = PowerSpectrum::log_binned_over(&spectra, 10).unwrap();
    let average = PowerSpectrum::average(&spectra).unwrap().log_binned(10);
    assert_eq!(over.len(), average.len());
    for (a, b) in over.iter().zip(&average) {
        assert_eq!((a.wavenumber, a.count), (b.wavenumber, b.count));
        assert_relative_eq!(a.density, b.density, max_relative = 1e-12);
    }
    assert_eq!(PowerSpectrum::log_binned_over(&[], 10), Err(SpectrumError::Empty));
}

#[test]
fn the_slope_of_a_power_law_is_its_hurst_exponent() {
    let law = |k: usize| if k == 0 { 0.0 } else { (k as f64).powf(-2.4) };
    let one = |factor: f64| PowerSpectrum {
        wavenumber_step: 10.0,
        density: (0..20_000).map(|k| factor * law(k)).collect(),
        routes: vec![Route::Periodogram(Window::None)],
    };
    let spectra = [one(1.0), one(2.0), one(5.0)];
    let fit = fit_hurst_exponent(&spectra, 10, 1e-4, 1e-2).unwrap();
    assert!(fit.shortest_wavelength >= 1e-4 && fit.longest_wavelength <= 1e-2);
    // Bins of few wavenumbers: their mean over a power law is not that at their middle, and the
    // bias taken off belongs to scatter that a power law does not have; both some per cent of a
    // density over two decades.
    assert_relative_eq!(fit.hurst_exponent, 0.7, epsilon = 5e-3);
    // All scans have one slope.
    let interval = fit.hurst_exponent_95.unwrap();
    assert!(interval.upper - interval.lower < 1e-9);
    assert_eq!(fit_hurst_exponent(&spectra[..1], 10, 1e-4, 1e-2).unwrap().hurst_exponent_95, None);
    let narrow = fit_hurst_exponent(&spectra, 10, 1e-3, 1.3e-3).unwrap_err();
    assert!(matches!(narrow, HurstError::TooFewBins { bins: 1 | 2, .. }));
}

/// What docs/characterise.md says of the two Hurst exponents.
#[test]
fn the_correlation_of_one_power_law_bends_over_a_decade_of_lags() {
    // H = 0.8 from 0.05 to 8 mm, level beyond up to 64 mm.
    let (longest, rolled_off, shortest) = (64e-3, 8, 1280);
    let law = |k: usize| if k == 0 { 0.0 } else { (k.max(rolled_off) as f64).powf(-2.6) };
    let spectrum = PowerSpectrum {
        wavenumber_step: TAU / longest,
        density: (0..=shortest).map(law).collect(),
        routes: vec![Route::Periodogram(Window::None)],
    };
    let fit = fit_hurst_exponent(std::slice::from_ref(&spectrum), 10, 5e-5, 5e-3).unwrap();
    // Bins of few wavenumbers, as above.
    assert_relative_eq!(fit.hurst_exponent, 0.8, epsilon = 2e-2);
    let correlation =
        |lag: f64| 2.0 * (spectrum.autocovariance(0.0) - spectrum.autocovariance(lag));
    let step = 1.05_f64;
    let half_slope = |lag: f64| (correlation(lag * step) / correlation(lag)).ln() / step.ln() / 2.0;
    // Figures of the page have two digits.
    for (lag, expected) in [(2e-5, 0.91), (1e-4, 0.75), (6e-4, 0.65), (1.6e-3, 0.48)] {
        assert_relative_eq!(half_slope(lag), expected, epsilon = 5e-3);
    }
}

#[test]
fn spectrum_and_correlation_agree_where_both_are_exact() {
    let (points, periods) = (4000, 40);
    let mut scan = noise(points, 1);
    let step = TAU * f64::from(periods) / points as f64;
    scan.heights = (0..points).map(|i| 2e-4 * (step * i as f64).sin()).collect();
    let correlation = correlate(&scan, points / 2);
    let plan = SpectrumPlan::new(points).unwrap();
    // Whole waves: the wrap-around that r(s) takes off is not there, so it must be left in.
    let spectrum = plan.periodogram(&scan, Window::None).unwrap();
    for lag in [0_usize, 1, 30, 50, 170] {
        let from_spectrum =
            2.0 * (spectrum.autocovariance(0.0) - spectrum.autocovariance(lag as f64 * SPACING));
        // Round-off is that of 4000 rotations.
        let exact = 2.0 * 2e-4_f64.powi(2) * (step * lag as f64 / 2.0).sin().powi(2);
        assert_relative_eq!(from_spectrum, exact, epsilon = 1e-10 * 2e-4_f64.powi(2));
    }
    // Windows that fall to zero at the ends: an error of the order of the leakage.
    for window in [Window::Hann, Window::Welch] {
        let spectrum = plan.periodogram(&scan, window).unwrap();
        let compared = agreement(&spectrum, &correlation, SPACING, 20);
        assert!(compared.last().unwrap().lag <= 0.05 * scan.length() * (1.0 + 1e-12));
        let scale = 2.0 * 2e-4_f64.powi(2);
        for Agreement { lag, correlation, from_spectrum } in compared {
            let error = (from_spectrum - correlation).abs() / scale;
            assert!(error < 0.02, "{window:?} {lag}: {correlation} {from_spectrum}");
        }
    }
}

#[test]
fn the_window_of_either_route_is_divided_out() {
    // A moving average of white noise, of which the correlation is known to rise over ten lags.
    let points = 40_000;
    let white = normal_noise(points + 10, 9).heights;
    let mut scan = noise(points, 9);
    scan.heights = (0..points).map(|i| white[i..i + 10].iter().sum::<f64>()).collect();
    let correlation = correlate(&scan, points / 2);
    let plan = SpectrumPlan::new(points).unwrap();
    let spectra = [
        plan.periodogram(&scan, Window::None).unwrap(),
        plan.periodogram(&scan, Window::Hann).unwrap(),
        plan.periodogram(&scan, Window::Welch).unwrap(),
        plan.blackman_tukey(&correlation, points / 10).unwrap(),
    ];
    for spectrum in spectra {
        for compared in agreement(&spectrum, &correlation, SPACING, 10) {
            // 4000 independent heights: mean squares by two windows differ by some 3 %, thrice that.
            let difference = compared.relative_difference();
            assert!(difference.abs() < 0.1, "{:?} {compared:?}", spectrum.routes);
        }
    }
}
