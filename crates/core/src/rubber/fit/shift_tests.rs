//! Vertical shifts, sweeps that E' does not join, given factors.

use super::tests::{broad, normal};
use super::*;
use crate::rubber::{Rubber, ShiftLaw, TemperatureDependence, VerticalShift, Viscoelastic};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use std::f64::consts::{LN_10, TAU};

/// Polyisoprene, Hevea rubber (Ferry, Viscoelastic Properties of Polymers, 3rd edition, Wiley 1980,
/// table 11-II): c1 = 8.86 and c2 = 101.6 K about 248 K, here about 25 °C.
fn polyisoprene() -> TemperatureDependence {
    let law = ShiftLaw::Wlf { c1: 8.86, c2_k: 101.6 };
    let vertical = Some(VerticalShift::RhoT { expansion_per_k: 6.6e-4 });
    let about_248 = TemperatureDependence { reference_c: -25.15, law, measured_c: None, vertical };
    about_248.about(25.0)
}

const FREE: VerticalChoice = VerticalChoice::Free { expansion_per_k: 6.6e-4 };

/// Sweeps from 0.1 to 100 Hz of a soft rubber, moduli growing with density times temperature.
fn polyisoprene_sweeps(noise: f64, seed: u64) -> Vec<Sweep> {
    let mut random = Pcg64::seed_from_u64(seed);
    let dependence = polyisoprene();
    let rubber = broad().scaled(0.1);
    [-45.0, -40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 25.0, 40.0, 50.0]
        .into_iter()
        .map(|temperature_c| {
            let at = rubber
                .shifted(dependence.shift_factor(temperature_c).unwrap())
                .scaled(dependence.vertical_factor(temperature_c));
            let point = |k: i32| {
                let angular_frequency = TAU * 10_f64.powf(f64::from(k) / 6.0 - 1.0);
                let modulus = at.complex_modulus(angular_frequency);
                SweepPoint {
                    angular_frequency,
                    storage_modulus: modulus.re * (noise * normal(&mut random)).exp(),
                    loss_modulus: modulus.im * (noise * normal(&mut random)).exp(),
                }
            };
            Sweep { temperature_c: Some(temperature_c), points: (0..=18).map(point).collect() }
        })
        .collect()
}

fn options(vertical: VerticalChoice) -> FitOptions {
    FitOptions { reference_c: Some(25.0), vertical, ..FitOptions::default() }
}

/// Largest deviation of the shift factors from the law, in decades.
fn miss(fit: &MasterCurve) -> f64 {
    let law = polyisoprene();
    let of = |shift: &ShiftFactor| {
        (shift.log10_shift - law.shift_factor(shift.temperature_c).unwrap().log10()).abs()
    };
    fit.shifts.iter().map(of).fold(0.0, f64::max)
}

/// Largest relative deviation of E' and E'' of the fitted rubber at the measured temperatures.
fn modulus_miss(data: &crate::rubber::RubberData) -> f64 {
    let dependence = polyisoprene();
    let rubber = broad().scaled(0.1);
    let mut largest = 0.0_f64;
    for temperature_c in [-30.0, 0.0, 40.0] {
        let truth = rubber
            .shifted(dependence.shift_factor(temperature_c).unwrap())
            .scaled(dependence.vertical_factor(temperature_c));
        let found = data.at_temperature(temperature_c).unwrap().rubber;
        for k in 0..=6 {
            let w = TAU * 10_f64.powf(f64::from(k) / 2.0 - 1.0);
            let (found, truth) = (found.complex_modulus(w), truth.complex_modulus(w));
            largest = largest.max((found.re / truth.re - 1.0).abs());
            largest = largest.max((found.im / truth.im - 1.0).abs());
        }
    }
    largest
}

#[test]
fn polyisoprene_comes_back_with_density_times_temperature() {
    let rho_t = VerticalChoice::RhoT { expansion_per_k: 6.6e-4 / (1.0 + 6.6e-4 * 50.15) };
    let exact = fit_sweeps(&polyisoprene_sweeps(0.0, 0), &options(rho_t)).unwrap();
    assert!(miss(&exact) < 1e-5, "{}", miss(&exact));
    assert!(modulus_miss(&exact.rubber("pi", 0.49)) < 1e-4);
    let noisy = fit_sweeps(&polyisoprene_sweeps(0.02, 1), &options(rho_t)).unwrap();
    assert!(miss(&noisy) < 0.1, "{}", miss(&noisy));
    // 2 % noise, less what 19 points a sweep average out; the law adds its own miss.
    let miss = modulus_miss(&noisy.rubber("pi", 0.49));
    assert!(miss < 0.04, "{miss}");
}

#[test]
fn polyisoprene_comes_back_with_free_vertical_factors() {
    let exact = fit_sweeps(&polyisoprene_sweeps(0.0, 0), &options(FREE)).unwrap();
    assert!(miss(&exact) < 1e-4, "{}", miss(&exact));
    for shift in &exact.shifts {
        let truth = polyisoprene().vertical_factor(shift.temperature_c);
        approx::assert_relative_eq!(shift.vertical.unwrap().factor, truth, max_relative = 1e-4);
    }
    let vertical = exact.vertical.as_ref().map(|fitted| fitted.law);
    let Some(VerticalShift::Power { exponent }) = vertical else { panic!("{vertical:?}") };
    // Density takes a fifth of the growth with temperature: 1 - 6.6e-4 * 298.
    assert!((exponent - 0.8).abs() < 0.05, "{exponent}");
}

/// What the option is for: without it the same sweeps miss.
#[test]
fn a_vertical_shift_that_is_left_out_costs_misfit() {
    let sweeps = polyisoprene_sweeps(0.0, 0);
    let none = fit_sweeps(&sweeps, &options(VerticalChoice::None)).unwrap();
    assert!(none.vertical.is_none() && none.shifts[0].vertical.is_none());
    assert!(none.misfit.storage_modulus.rms > 0.01, "{:?}", none.misfit);
    let one = fit_sweeps(&sweeps[..1], &options(FREE));
    assert_eq!(one.unwrap_err(), FitError::VerticalWithoutTemperature);
}

#[test]
fn given_factors_are_taken_as_they_are() {
    let law = polyisoprene();
    let given = |temperature_c: f64| GivenShift {
        temperature_c,
        // About another reference: only differences count.
        log10_shift: law.shift_factor(temperature_c).unwrap().log10() + 2.0,
    };
    let temperatures = [-45.0, -40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 25.0, 40.0, 50.0];
    let factors: Vec<GivenShift> = temperatures.into_iter().map(given).collect();
    let sweeps = polyisoprene_sweeps(0.0, 0);
    let rho_t = VerticalChoice::RhoT { expansion_per_k: 6.6e-4 / (1.0 + 6.6e-4 * 50.15) };
    let with = |factors: &[GivenShift]| {
        fit_sweeps(&sweeps, &FitOptions { shift_factors: Some(factors.to_vec()), ..options(rho_t) })
    };
    let fit = with(&factors).unwrap();
    assert!(miss(&fit) < 1e-12, "{}", miss(&fit));
    assert!(fit.shifts.iter().all(|shift| shift.confidence_95.is_none()));
    assert!(fit.misfit.storage_modulus.rms < 1e-6, "{:?}", fit.misfit);
    let error = with(&factors[1..]).unwrap_err().to_string();
    assert!(error.contains("the sweep at -45 °C"), "{error}");

    // A master curve without temperature.
    let curve = Sweep { temperature_c: None, ..sweeps[7].clone() };
    let fit_curve = |reference_c| {
        let shift_factors = Some(factors.clone());
        fit_sweeps(
            std::slice::from_ref(&curve),
            &FitOptions { reference_c, shift_factors, ..FitOptions::default() },
        )
    };
    assert_eq!(fit_curve(None).unwrap_err(), FitError::NoReference);
    let fit = fit_curve(Some(25.0)).unwrap();
    let ShiftLaw::Wlf { c2_k, .. } = fit.laws[0].law else { panic!("{:?}", fit.laws) };
    approx::assert_relative_eq!(c2_k, 101.6 + 50.15, max_relative = 1e-6);
    assert_eq!(fit.rubber("pi", 0.49).temperature.unwrap().measured_c, Some([-45.0, 50.0]));
}

/// A glass whose storage moduli scatter by more than they change from sweep to sweep.
fn glassy_sweeps(temperatures: &[f64]) -> Vec<Sweep> {
    let rubber = broad();
    let log10_shift = |temperature_c: f64| 0.2 * (25.0 - temperature_c);
    let scatter = [1.0, 0.993, 1.007];
    let sweep = |(k, temperature_c): (usize, &f64)| {
        let at: Rubber = rubber.shifted((LN_10 * log10_shift(*temperature_c)).exp());
        let factor = scatter[k % 3];
        let point = |k: i32| {
            let angular_frequency = TAU * 10_f64.powf(f64::from(k) / 4.0 - 1.0);
            let modulus = at.complex_modulus(angular_frequency) * factor;
            SweepPoint { angular_frequency, storage_modulus: modulus.re, loss_modulus: modulus.im }
        };
        Sweep { temperature_c: Some(*temperature_c), points: (0..=12).map(point).collect() }
    };
    temperatures.iter().enumerate().map(sweep).collect()
}

#[test]
fn loss_joins_what_storage_does_not() {
    // The glass of `broad` at 1e6 rad/s and beyond: two sweeps without common E'.
    let sweeps = glassy_sweeps(&[-20.0, -13.0, -6.0, 1.0, 8.0, 16.0, 25.0]);
    let first = shift::first_shifts(&sweeps);
    assert!(!first.by_loss.is_empty(), "{first:?}");
    let fit = fit_sweeps(&sweeps, &FitOptions { reference_c: Some(25.0), ..Default::default() });
    let fit = fit.unwrap();
    assert!(fit.left_out.is_empty() && !fit.joined_by_loss_c.is_empty());
    for shift in &fit.shifts {
        let miss = (shift.log10_shift - 0.2 * (25.0 - shift.temperature_c)).abs();
        assert!(miss < 0.2, "{shift:?}");
    }
}

#[test]
fn what_nothing_joins_is_left_out_and_told() {
    // Five decades lie between the first two.
    let sweeps = glassy_sweeps(&[-40.0, -15.0, -5.0, 5.0, 15.0, 25.0]);
    let fit =
        |reference_c| fit_sweeps(&sweeps, &FitOptions { reference_c, ..FitOptions::default() });
    let joined = fit(None).unwrap();
    assert_eq!(joined.left_out.len(), 1);
    assert_eq!(joined.left_out[0].temperature_c, -40.0);
    assert_eq!((joined.shifts.len(), joined.reference_c), (5, Some(5.0)));
    let error = fit(Some(-40.0)).unwrap_err();
    assert!(matches!(error, FitError::NoOverlap { .. }), "{error}");
}
