use super::*;
use crate::surface::correlation::CorrelationPlan;
use approx::assert_relative_eq;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

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
    let expected = (spectra[0].density[77] + spectra[1].density[77]) / 2.0;
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
