//! Laws that change nothing, laws that soften, laws that end.

use super::*;
use crate::contact::areal::{ArealContact, ArealSetup, ArealSurface, Sliding};
use crate::rubber::Viscoelastic;

/// Softening by `1 / (1 + (e / e_c))` of the storage modulus, and by `depth` as much of the loss modulus.
pub(super) struct Softening {
    pub critical: f64,
    pub depth: f64,
}

impl StrainLaw for Softening {
    fn storage_factor(&self, strain: f64) -> Result<f64, String> {
        Ok(1.0 / (1.0 + strain / self.critical))
    }

    fn loss_factor(&self, strain: f64) -> Result<f64, String> {
        Ok(1.0 / (1.0 + self.depth * strain / self.critical))
    }
}

struct Broken;

impl StrainLaw for Broken {
    fn storage_factor(&self, _: f64) -> Result<f64, String> {
        Ok(f64::NAN)
    }

    fn loss_factor(&self, _: f64) -> Result<f64, String> {
        Ok(1.0)
    }
}

struct Unchanged;

impl StrainLaw for Unchanged {
    fn storage_factor(&self, _: f64) -> Result<f64, String> {
        Ok(1.0)
    }

    fn loss_factor(&self, _: f64) -> Result<f64, String> {
        Ok(1.0)
    }
}

fn setup<'a>(rubber: &'a Rubber, speed: f64, heights: &'a [f64]) -> FeedbackSetup<'a> {
    FeedbackSetup::new(rubber, speed, PERIOD, heights)
}

#[test]
fn laws_that_change_nothing_give_the_plain_contact_to_the_last_digit() {
    let rubber = Rubber::table_2_1();
    let heights = five_waves(512);
    let constant = |_: f64| -> Result<f64, String> { Ok(0.3) };
    let heat = HeatFeedback { thermal: thermal(), law: &constant, temperature_c: 20.0 };
    for speed in [1e-3, 0.1] {
        let expected = plain(&rubber, speed, &heights, 3e5);
        let plain = setup(&rubber, speed, &heights);
        for changed in [
            FeedbackSetup { strain: Some(&Unchanged), ..plain },
            FeedbackSetup { heat: Some(heat), ..plain },
            FeedbackSetup { heat: Some(heat), strain: Some(&Unchanged), ..plain },
            plain,
        ] {
            let found = FeedbackContact::new(changed).unwrap().solve(3e5).unwrap();
            assert_eq!(found.with, expected);
            assert_eq!(found.without, expected);
            assert_eq!(found.steps, 1);
        }
        // The operator of a rubber with factors of one is the operator of the rubber.
        let factors = WaveFactors::none(vec![1e3, 1e4, 1e5]);
        let effective = EffectiveRubber { rubber: &rubber, factors: &factors, speed };
        let mut contact = SlidingContact::new(&effective, speed, PERIOD, &heights).unwrap();
        assert_eq!(contact.solve(3e5).unwrap(), expected);
    }
}

#[test]
fn softer_rubber_has_more_contact() {
    let rubber = Rubber::table_2_1();
    let heights = five_waves(512);
    let mut last = 0.0;
    for critical in [1e9, 1.0, 0.1, 0.03] {
        let law = Softening { critical, depth: 1.0 };
        let softened = FeedbackSetup { strain: Some(&law), ..setup(&rubber, 0.01, &heights) };
        let found = FeedbackContact::new(softened).unwrap().solve(3e5).unwrap();
        assert!(found.with.contact_area_fraction > last, "{critical}");
        assert!(found.change.iter().all(|c| *c <= 1e-6));
        last = found.with.contact_area_fraction;
        // The fixed point: factors of the law at the strains that the contact with them makes.
        for (k, strain) in found.strain.iter().enumerate() {
            let f = law.storage_factor(*strain).unwrap();
            approx::assert_abs_diff_eq!(found.factors.storage[k], f, epsilon = 2e-6);
        }
    }
}

#[test]
fn a_start_from_a_near_contact_has_the_same_solution() {
    let rubber = Rubber::table_2_1();
    let heights = five_waves(1024);
    let mut contact = SlidingContact::new(&rubber, 0.1, PERIOD, &heights).unwrap();
    let expected = contact.solve(3e5).unwrap();
    let other = contact.solve(5e5).unwrap();
    let found = contact.solve_near(3e5, &other.pressure).unwrap();
    let friction = (found.friction_coefficient, expected.friction_coefficient);
    approx::assert_relative_eq!(friction.0, friction.1, max_relative = 1e-8);
    let area = (found.contact_area_fraction, expected.contact_area_fraction);
    approx::assert_relative_eq!(area.0, area.1, max_relative = 1e-6);
    // Nothing to start from: from scratch.
    assert_eq!(contact.solve_near(3e5, &vec![0.0; 1024]).unwrap(), expected);
    assert!(contact.solve_near(3e5, &[1.0]).is_err());
    assert!(contact.solve_near(-1.0, &other.pressure).is_err());
}

#[test]
fn an_areal_contact_takes_the_factors_of_the_whole_wavenumber() {
    let rubber = Rubber::table_2_1();
    let (nx, ny, speed) = (128, 4, 0.1);
    let line = five_waves(nx);
    let mut factors = WaveFactors::none((1..64).map(|k| 6283.0 * f64::from(k)).collect());
    for (k, shift) in factors.ln_shift.iter_mut().enumerate() {
        *shift = -1.0 - 0.02 * k as f64;
        factors.storage[k] = 0.7;
        factors.loss[k] = 0.9;
    }
    let effective = EffectiveRubber { rubber: &rubber, factors: &factors, speed };
    let solve = |heights: &[f64], points, periods, angle| {
        let sliding = Sliding { speed, angle };
        let surface = ArealSurface { heights, points, periods };
        let setup = ArealSetup {
            rubber: &effective,
            sliding,
            surface,
            thickness: None,
            memory_limit: None,
        };
        ArealContact::new(&setup).unwrap().solve(3e5).unwrap()
    };
    let expected =
        SlidingContact::new(&effective, speed, PERIOD, &line).unwrap().solve(3e5).unwrap();
    let cold = plain(&rubber, speed, &line, 3e5).friction_coefficient;
    assert!((expected.friction_coefficient / cold - 1.0).abs() > 0.05);
    let heights: Vec<f64> = (0..ny).flat_map(|_| line.clone()).collect();
    let found = solve(&heights, [nx, ny], [PERIOD, 0.4e-3], 0.0);
    let friction = (found.hysteretic_friction, expected.hysteretic_friction);
    approx::assert_relative_eq!(friction.0, friction.1, max_relative = 1e-9);
    // A wave along the diagonal, in full contact: friction q_s |q| D² E'' / (4 (1-ν²) p), with the moduli of |q| at q_s v.
    let n = 32;
    let wave =
        |i: usize| 2e-7 * (std::f64::consts::TAU * ((i % n) + (i / n)) as f64 / n as f64).sin();
    let heights: Vec<f64> = (0..n * n).map(wave).collect();
    let found = solve(&heights, [n, n], [PERIOD, PERIOD], 0.0);
    let along = std::f64::consts::TAU / PERIOD;
    let whole = along * std::f64::consts::SQRT_2;
    let loss = effective.reduced_modulus_of_wave(whole, along * speed).im;
    let exact = along * whole * 4e-14 * loss / (4.0 * 3e5);
    approx::assert_relative_eq!(found.hysteretic_friction, exact, max_relative = 2e-4);
    let of_component = effective.reduced_modulus_of_wave(along, along * speed).im;
    assert!((of_component / loss - 1.0).abs() > 2e-3, "{of_component} {loss}");
}

#[test]
fn what_the_laws_do_not_know_is_refused() {
    let rubber = Rubber::table_2_1();
    let heights = five_waves(256);
    let ends = |temperature_c: f64| {
        if temperature_c > 22.0 { Err("the table ends at 22 °C".into()) } else { Ok(0.0) }
    };
    let heat = HeatFeedback { thermal: thermal(), law: &ends, temperature_c: 20.0 };
    let hot = FeedbackSetup { heat: Some(heat), ..setup(&rubber, 1.0, &heights) };
    let error = FeedbackContact::new(hot).unwrap().solve(3e5).unwrap_err();
    let message = error.to_string();
    assert!(matches!(error, EffectiveError::Temperature { .. }), "{message}");
    assert!(message.contains("the table ends at 22 °C"), "{message}");

    let wlf = wlf();
    let heat = HeatFeedback { law: &wlf, ..heat };
    let few = FeedbackSetup { most_steps: 2, heat: Some(heat), ..hot };
    let error = FeedbackContact::new(few).unwrap().solve(3e5).unwrap_err();
    assert!(matches!(error, EffectiveError::NotConverged { steps: 2, .. }), "{error}");

    let refused = |setup: FeedbackSetup| FeedbackContact::new(setup).err().unwrap().to_string();
    assert!(refused(FeedbackSetup { speed: 0.0, ..hot }).contains("the speed in m/s is 0"));
    assert!(refused(FeedbackSetup { tolerance: f64::NAN, ..hot }).contains("tolerance"));
    let cold = HeatFeedback { temperature_c: -300.0, ..heat };
    assert!(refused(FeedbackSetup { heat: Some(cold), ..hot }).contains("before sliding"));
    let broken = FeedbackSetup { strain: Some(&Broken), ..setup(&rubber, 0.01, &heights) };
    let error = FeedbackContact::new(broken).unwrap().solve(3e5).unwrap_err().to_string();
    assert!(error.contains("strain factors") && error.contains("factor is NaN"), "{error}");
}
