//! Measured moduli without a Maxwell fit, in contact and in the theories.

use approx::assert_relative_eq;
use asperity_core::contact::{ContactError, SlidingContact};
use asperity_core::reference::FullContact;
use asperity_core::rubber::Rubber;
use asperity_core::rubber::fit::SweepPoint;
use asperity_core::rubber::{MeasuredModuli, RubberError, Viscoelastic};
use asperity_core::surface::{SineScale, Wave, wave};
use asperity_core::theory::{KlueppelHeinrich, Persson};
use std::f64::consts::TAU;

const PERIOD: f64 = 1e-3;
const SPEED: f64 = 0.01;
const POINTS: usize = 512;
const WAVE: SineScale = SineScale { wavelength: PERIOD, amplitude: 1e-5 };

/// Table 2.1 as if measured from the frequency `v / L` over a number of decades.
fn sampled(per_decade: usize, decades: usize) -> MeasuredModuli {
    let rubber = Rubber::table_2_1();
    let point = |k: usize| {
        let angular_frequency = TAU * SPEED / PERIOD * 10_f64.powf(k as f64 / per_decade as f64);
        let modulus = rubber.complex_modulus(angular_frequency);
        SweepPoint { angular_frequency, storage_modulus: modulus.re, loss_modulus: modulus.im }
    };
    let points: Vec<SweepPoint> = (0..=decades * per_decade).map(point).collect();
    MeasuredModuli::new("sampled", rubber.poisson_ratio, &points).unwrap()
}

fn contact(rubber: &dyn Viscoelastic) -> SlidingContact {
    let second = Wave { wavelength: 0.25 * PERIOD, amplitude: 4e-6, phase: 1.0 };
    let first = Wave { wavelength: PERIOD, amplitude: WAVE.amplitude, phase: 0.0 };
    let heights = wave::sample(&[first, second], PERIOD, POINTS);
    SlidingContact::new(rubber, SPEED, PERIOD, &heights).unwrap()
}

#[test]
fn friction_converges_to_that_of_the_rubber_it_was_measured_on() {
    let pressure = 2e5;
    let exact = contact(&Rubber::table_2_1()).solve(pressure).unwrap().friction_coefficient;
    let error = |per_decade| {
        let friction = contact(&sampled(per_decade, 6)).solve(pressure).unwrap();
        (friction.friction_coefficient / exact - 1.0).abs()
    };
    let errors = [2, 4, 8, 16].map(error);
    assert!(errors[3] < 1e-4, "{errors:?}");
    assert!(errors.windows(2).all(|pair| pair[1] < pair[0] / 2.0), "{errors:?}");
}

#[test]
fn full_contact_with_a_wave_at_a_measured_frequency_is_exact() {
    let rubber = Rubber::table_2_1();
    let exact = FullContact { rubber: &rubber, wave: WAVE, speed: SPEED };
    let pressure = 2.0 * exact.smallest_pressure();
    let wave = Wave { wavelength: PERIOD, amplitude: WAVE.amplitude, phase: 0.3 };
    let heights = wave::sample(&[wave], PERIOD, POINTS);
    let mut contact = SlidingContact::new(&sampled(2, 6), SPEED, PERIOD, &heights).unwrap();
    let friction = contact.solve(pressure).unwrap().friction_coefficient;
    let expected = exact.friction_coefficient(pressure).unwrap();
    // The phase is tapered by (π²/4) (2/512)^4, moduli pass through a logarithm.
    assert_relative_eq!(friction, expected, max_relative = 1e-9);
}

#[test]
fn only_edges_ask_for_moduli_beyond_the_waves_of_the_grid() {
    // log10 of 256 waves is 2.4.
    let (narrow, wide) = (sampled(10, 3), sampled(10, 9));
    let [narrow, wide] = [&narrow, &wide].map(|rubber| contact(rubber).solve(2e5).unwrap());
    assert_relative_eq!(
        narrow.friction_coefficient,
        wide.friction_coefficient,
        max_relative = 1e-9
    );
    // Two contacts with two edges each, read to some hundredths of a grid step.
    let steps = (narrow.contact_area_fraction - wide.contact_area_fraction).abs() * POINTS as f64;
    assert!(steps < 4.0 * 0.05, "{steps}");
}

#[test]
fn a_frequency_that_was_not_measured_is_refused() {
    let rubber = sampled(4, 3);
    let heights = wave::sample(&[], PERIOD, POINTS);
    let refused = |speed| {
        let error = SlidingContact::new(&rubber, speed, PERIOD, &heights).err().unwrap();
        assert!(matches!(error, ContactError::Rubber(RubberError::NotMeasured { .. })));
        error.to_string()
    };
    // Waves from L to L / 256; measured are 10 Hz to 10 kHz.
    for (speed, frequency) in [(1.0, "2.560e5"), (-1.0, "2.560e5"), (1e-3, "1.000e0")] {
        let message = refused(speed);
        assert!(message.contains(&format!("at {frequency} Hz")), "{message}");
        assert!(message.contains("from 1.000e1 to 1.000e4 Hz"), "{message}");
    }
    assert!(refused(0.0).contains("at 0.000e0 Hz"));
    let persson = |speed| Persson::new(&[WAVE], &rubber, speed, 0.5);
    assert!(persson(SPEED).is_ok());
    assert!(matches!(persson(0.5 * SPEED), Err(RubberError::NotMeasured { .. })));
    let klueppel = KlueppelHeinrich::new(&[WAVE], &heights, &rubber, 1e4 * SPEED, 1.0);
    assert!(matches!(klueppel, Err(RubberError::NotMeasured { .. })));
}

#[test]
fn the_points_are_met_and_a_negative_frequency_is_the_conjugate() {
    let (rubber, measured) = (Rubber::table_2_1(), sampled(1, 4));
    for k in 0..=4 {
        let frequency = TAU * SPEED / PERIOD * 10_f64.powi(k);
        let (ours, exact) =
            (measured.complex_modulus(frequency), rubber.complex_modulus(frequency));
        assert_relative_eq!(ours.re, exact.re, max_relative = 1e-13);
        assert_relative_eq!(ours.im, exact.im, max_relative = 1e-13);
        assert_eq!(measured.complex_modulus(-frequency), ours.conj());
    }
}

#[test]
fn bad_points_are_refused_by_name() {
    let point = SweepPoint { angular_frequency: 1.0, storage_modulus: 2e6, loss_modulus: 1e5 };
    let later = SweepPoint { angular_frequency: 10.0, ..point };
    let refused = |poisson_ratio, points: &[SweepPoint]| {
        MeasuredModuli::new("m", poisson_ratio, points).unwrap_err().to_string()
    };
    assert!(refused(0.5, &[point]).contains("1 point"));
    assert!(refused(0.6, &[point, later]).contains("poisson_ratio is 0.6"));
    assert!(refused(0.5, &[later, point]).contains("ascend"));
    assert!(refused(0.5, &[point, point]).contains("ascend"));
    let lossless = SweepPoint { loss_modulus: 0.0, ..later };
    assert!(refused(0.5, &[point, lossless]).contains("the loss modulus of point 2 is 0"));
    let missing = SweepPoint { storage_modulus: f64::NAN, ..later };
    assert!(refused(0.5, &[missing, later]).contains("the storage modulus of point 1 is NaN"));
}
