//! The local law and the contact under it, against exact results and slow direct solutions.

mod interior_point;

use super::layer::LayeredSpace;
use super::*;
use crate::contact::SlidingContact;
use crate::contact::half_space::HalfSpace;
use crate::contact::preconditioner::SetOperator;
use crate::rubber::Rubber;
use crate::surface::{Wave, wave};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The law of a sine wave of amplitude `d` on an elastic body in full contact at `full` Pa
/// (Westergaard): `g = d (1 - s (1 - ln s))`, `s = p / full`, sampled at logarithmic steps.
fn westergaard(d: f64, full: f64, samples: usize) -> LocalLaw {
    let pressures: Vec<f64> =
        (0..samples).map(|i| full * 1e-4_f64.powf(1.0 - i as f64 / (samples - 1) as f64)).collect();
    let separation = |p: &f64| d * (1.0 - p / full * (1.0 - (p / full).ln()));
    let separations: Vec<f64> = pressures.iter().map(separation).collect();
    LocalLaw::new(d, &pressures, &separations, LawEnd::FullContact).unwrap()
}

/// `g = touch - c p` up to `largest` Pa.
fn linear(touch: f64, c: f64, largest: f64) -> LocalLaw {
    let pressures = [0.01 * largest, 0.3 * largest, largest];
    LocalLaw::new(touch, &pressures, &pressures.map(|p| touch - c * p), LawEnd::PartialContact)
        .unwrap()
}

fn two_waves(points: usize) -> Vec<f64> {
    let waves = [(0.125e-3, 0.02648e-3, 0.4), (0.25e-3, 0.02939e-3, 1.7)]
        .map(|(wavelength, amplitude, phase)| Wave { wavelength, amplitude, phase });
    wave::sample(&waves, 0.25e-3, points)
}

#[test]
fn a_linear_law_is_a_straight_line_everywhere() {
    let law = linear(2e-5, 1e-12, 1e7);
    for p in [0.0, 1.0, 3e4, 1e5, 2e6, 1e7] {
        // Logarithms of round-off accuracy, and back.
        approx::assert_relative_eq!(
            law.separation(p).unwrap(),
            2e-5 - 1e-12 * p,
            max_relative = 1e-13
        );
        approx::assert_relative_eq!(law.slope(p).unwrap(), -1e-12, max_relative = 1e-12);
    }
}

#[test]
fn a_single_sample_makes_a_straight_line() {
    let law = LocalLaw::new(2e-5, &[1e6], &[1e-5], LawEnd::FullContact).unwrap();
    approx::assert_relative_eq!(law.separation(5e5).unwrap(), 1.5e-5, max_relative = 1e-14);
    approx::assert_relative_eq!(law.slope(5e5).unwrap(), -1e-11, max_relative = 1e-14);
    assert_eq!(law.separation(5e6).unwrap(), 1e-5);
    assert_eq!(law.slope(5e6).unwrap(), 0.0);
}

#[test]
fn the_law_of_an_elastic_wave_is_met_between_and_below_its_samples() {
    let (d, full) = (1e-5, 1e7);
    let exact = |s: f64| d * (1.0 - s * (1.0 - s.ln()));
    let error = |samples: usize| {
        let law = westergaard(d, full, samples);
        (1..=2000)
            .map(|i| 1e-6_f64.powf(1.0 - f64::from(i) / 2000.0))
            .map(|s| (law.separation(s * full).unwrap() - exact(s)).abs() / d)
            .fold(0.0_f64, f64::max)
    };
    // The rule for the slopes is of second order at least: four times smaller for half the step.
    let (coarse, fine) = (error(25), error(49));
    assert!(coarse < 5e-3 && fine < 0.3 * coarse, "{coarse:.1e} {fine:.1e}");
    let law = westergaard(d, full, 25);
    for s in [1e-8, 1e-6, 5e-5] {
        let indentation = d - law.separation(s * full).unwrap();
        // The logarithmic slope at the first sample is known to a per cent.
        approx::assert_relative_eq!(indentation, d - exact(s), max_relative = 0.05);
    }
}

#[test]
fn the_slope_is_the_derivative_and_the_start_is_the_separation_at_touch() {
    let law = westergaard(1e-5, 1e7, 25);
    for p in [2.0, 900.0, 1.2e3, 4e4, 3e6, 9e6] {
        let h = 1e-4 * p;
        let difference =
            (law.separation(p + h).unwrap() - law.separation(p - h).unwrap()) / (2.0 * h);
        // Differences are of second order in the step, their round-off is 1e-5 g / (p dg/dp) 1e-16.
        approx::assert_relative_eq!(law.slope(p).unwrap(), difference, max_relative = 1e-6);
    }
    assert_eq!(law.separation(0.0).unwrap(), law.touch_separation());
    assert_eq!(law.slope(0.0).unwrap(), f64::NEG_INFINITY);
    assert_eq!(law.slope(1e7).unwrap(), 0.0);
}

#[test]
fn samples_that_are_no_law_are_refused() {
    let law = |p: &[f64], g: &[f64]| LocalLaw::new(1.0, p, g, LawEnd::PartialContact);
    let (index, value, before) = (1, 2.0, 3.0);
    assert_eq!(law(&[], &[]), Err(LawError::Length { pressures: 0, separations: 0 }));
    assert_eq!(law(&[1.0], &[0.5, 0.4]), Err(LawError::Length { pressures: 1, separations: 2 }));
    assert_eq!(law(&[3.0, 2.0], &[0.5, 0.4]), Err(LawError::Pressure { index, value, before }));
    assert_eq!(law(&[0.0], &[0.5]), Err(LawError::Pressure { index: 0, value: 0.0, before: 0.0 }));
    assert_eq!(
        law(&[1.0, 2.0], &[0.5, 0.5]),
        Err(LawError::Separation { index: 1, value: 0.5, before: 0.5 })
    );
    assert!(matches!(law(&[1.0], &[f64::NAN]), Err(LawError::Separation { index: 0, .. })));
    assert!(matches!(
        LocalLaw::new(f64::INFINITY, &[1.0], &[0.5], LawEnd::PartialContact),
        Err(LawError::Touch { .. })
    ));
}

#[test]
fn pressures_beyond_the_samples_are_refused_unless_contact_is_full() {
    let law = linear(2e-5, 1e-12, 1e7);
    let error = law.separation(1.1e7).unwrap_err();
    assert_eq!(error, LawError::BeyondSamples { pressure: 1.1e7, largest: 1e7 });
    assert!(error.to_string().contains("1.1e7 Pa, its samples end at 1e7 Pa"), "{error}");
    assert!(matches!(law.slope(-1.0), Err(LawError::NotAPressure { .. })));
    assert!(matches!(law.slope(f64::NAN), Err(LawError::NotAPressure { .. })));
    let mut contact =
        SoftContact::new(&Rubber::table_2_1(), 0.01, 0.25e-3, &two_waves(64), law).unwrap();
    let error = contact.solve(9e6).unwrap_err();
    let SoftContactError::Law { source: LawError::BeyondSamples { pressure, .. }, .. } = error
    else {
        panic!("{error}");
    };
    assert!(pressure > 1e7);
    assert!(westergaard(1e-5, 1e7, 9).separation(1e9).unwrap() < 1e-20);
}

#[test]
fn numbers_out_of_range_are_refused() {
    let law = linear(2e-5, 1e-12, 1e7);
    let rubber = Rubber::table_2_1();
    let mut contact =
        SoftContact::new(&rubber, 0.01, 0.25e-3, &two_waves(64), law.clone()).unwrap();
    for p in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(contact.solve(p), Err(SoftContactError::Contact(_))), "{p}");
    }
    assert!(SoftContact::new(&rubber, 0.01, 0.0, &two_waves(64), law.clone()).is_err());
    assert!(SoftContact::new(&rubber, 0.01, 0.25e-3, &[f64::NAN; 16], law).is_err());
}

/// Full contact under a linear law `g = g0 - c p`: `(C(q) + c) p_hat = z_hat`.
#[test]
fn full_contact_of_a_wave_under_a_linear_law_is_exact() {
    let (period, d, p, points) = (1e-3, 1e-5, 2e6, 256);
    let (touch, c) = (2e-5, 3e-12);
    let rubber = Rubber::table_2_1();
    let heights: Vec<f64> =
        (0..points).map(|i| d * (TAU * i as f64 / points as f64).cos()).collect();
    for speed in [1e-4, 1e-2, 1.0] {
        let q = TAU / period;
        let compliance = 2.0 / (q * rubber.reduced_modulus(q * speed));
        let amplitude = d / (compliance + c);
        assert!(amplitude.norm() < p, "the example is one of full contact");
        let law = linear(touch, c, 1e8);
        let mut contact = SoftContact::new(&rubber, speed, period, &heights, law).unwrap();
        let solution = contact.solve(p).unwrap();
        assert_eq!(solution.contact_points, points);
        // Residual 1e-10 of displacements; the operator's taper changes the phase of the longest
        // wave by (π²/4) (2/256)^4 = 9e-9.
        let friction = 0.5 * q * d * amplitude.im / p;
        approx::assert_relative_eq!(solution.friction_coefficient, friction, max_relative = 1e-7);
        approx::assert_relative_eq!(solution.hysteretic_friction, friction, max_relative = 1e-7);
        approx::assert_relative_eq!(solution.mean_separation, touch - c * p, max_relative = 1e-9);
        for (i, pressure) in solution.pressure.iter().enumerate() {
            let angle = TAU * i as f64 / points as f64;
            let exact = p + amplitude.re * angle.cos() - amplitude.im * angle.sin();
            approx::assert_relative_eq!(*pressure, exact, max_relative = 1e-7);
            approx::assert_relative_eq!(
                solution.separation[i],
                touch - c * pressure,
                max_relative = 1e-9
            );
        }
    }
}

#[test]
fn a_law_that_hardens_tends_to_the_hard_wall() {
    let (period, points, touch, p) = (0.25e-3, 512, 2e-5, 4e5);
    let rubber = Rubber::table_2_1();
    let heights = two_waves(points);
    for speed in [1e-4, 1e-2, 1.0] {
        let p = p * (1.0 + 30.0 * speed);
        let hard = SlidingContact::new(&rubber, speed, period, &heights).unwrap().solve(p).unwrap();
        let difference = |indentation: f64| {
            let law = linear(touch, indentation / p, 1e3 * p);
            let mut contact = SoftContact::new(&rubber, speed, period, &heights, law).unwrap();
            let soft = contact.solve(p).unwrap();
            let friction = (soft.friction_coefficient - hard.friction_coefficient).abs();
            let separation = (soft.mean_separation - touch - hard.mean_separation).abs();
            (friction, separation)
        };
        // The indentation at the mean pressure is 1e-6 of the heights, that at the highest some
        // twenty times as much: so is the distance from the hard wall.
        let (friction, separation) = difference(3e-11);
        assert!(friction < 1e-4, "{speed}: {friction:.1e}");
        assert!(separation < 3e-9, "{speed}: {separation:.1e}");
        let (nearer, _) = difference(3e-13);
        assert!(nearer < 0.02 * friction.max(1e-9), "{speed}: {nearer:.1e} {friction:.1e}");
    }
}

#[test]
fn the_result_does_not_depend_on_what_was_solved_before() {
    let law = westergaard(1.867e-5, 9e6, 25);
    let rubber = Rubber::table_2_1();
    let contact =
        || SoftContact::new(&rubber, 0.01, 0.25e-3, &two_waves(256), law.clone()).unwrap();
    let mut used = contact();
    for p in [1e3, 5e6, 2e5] {
        used.solve(p).unwrap();
    }
    assert_eq!(used.solve(6e5).unwrap(), contact().solve(6e5).unwrap());
}

/// A profile and a law to be put under load: waves of random lengths, heights and phases, or one
/// random height a point; a law that is hard or soft by orders of magnitude, with or without an
/// end in full contact.
#[derive(Debug, Clone)]
struct Case {
    heights: Vec<f64>,
    law: LocalLaw,
    speed: f64,
    pressure: f64,
}

const PERIOD: f64 = 1e-3;

fn case() -> impl Strategy<Value = Case> {
    let points = prop::sample::select(vec![8_usize, 33, 64, 100, 250, 512, 1000, 2048]);
    let waves = prop::collection::vec((1..24_u32, -3.0..0.0_f64, 0.0..TAU), 1..6);
    let noise = prop::collection::vec(-1.0..1.0_f64, 2048);
    let law = (-6.0..2.0_f64, 0.4..2.5_f64, prop::bool::ANY);
    (points, waves, noise, prop::bool::weighted(0.2), law, -4.0..0.0_f64, -5.0..0.5_f64).prop_map(
        |(points, waves, noise, rough, (softness, exponent, full), speed, load)| {
            let heights: Vec<f64> = if rough {
                noise[..points].iter().map(|x| 1e-5 * x).collect()
            } else {
                let wave = |(k, slope, phase): &(u32, f64, f64)| {
                    let wavelength = PERIOD / f64::from(*k);
                    Wave {
                        wavelength,
                        amplitude: 0.1 * 10_f64.powf(*slope) * wavelength,
                        phase: *phase,
                    }
                };
                wave::sample(&waves.iter().map(wave).collect::<Vec<_>>(), PERIOD, points)
            };
            let speed = 10_f64.powf(speed);
            let stiff = Rubber::table_2_1().reduced_modulus(TAU / PERIOD * speed).norm();
            let largest = if full { 0.3 * stiff } else { 1e4 * stiff };
            let pressures: Vec<f64> = (0..20).map(|i| largest * 2e-1_f64.powi(19 - i)).collect();
            let depth = 1e-5 * 10_f64.powf(softness);
            let separations: Vec<f64> = pressures
                .iter()
                .map(|p| depth * (1.0 - (p / (0.3 * stiff)).powf(exponent)))
                .collect();
            let end = if full { LawEnd::FullContact } else { LawEnd::PartialContact };
            // Where the first indentations are round-off of the separation they are left out.
            let first =
                (0..20).rfind(|i| separations[*i] > depth * (1.0 - 1e-12)).map_or(0, |i| i + 1);
            let law =
                LocalLaw::new(depth, &pressures[first..], &separations[first..], end).unwrap();
            Case { heights, law, speed, pressure: 0.3 * stiff * 10_f64.powf(load) }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_profile_is_solved_under_any_law(case in case()) {
        let rubber = Rubber::table_2_1();
        let Case { heights, law, speed, pressure } = case;
        let mut contact = SoftContact::new(&rubber, speed, PERIOD, &heights, law.clone()).unwrap();
        let solution = contact.solve(pressure);
        prop_assert!(solution.is_ok(), "{}", solution.unwrap_err());
        let solution = solution.unwrap();
        prop_assert!(solution.residual <= 1e-10);
        prop_assert!(solution.pressure.iter().all(|p| *p >= 0.0));
        prop_assert!(solution.hysteretic_friction >= 0.0);
        prop_assert_eq!(
            solution.contact_points,
            solution.pressure.iter().filter(|p| **p > 0.0).count()
        );
    }
}

/// The round-off of the law must not show: with indentations computed from the logarithms of
/// pressure and indentation it was 1e-10 of what counts here, as much as a solution may lack.
#[test]
fn a_law_ten_thousand_times_deeper_than_the_profile_is_solved() {
    let rubber = Rubber::table_2_1();
    let heights: Vec<f64> =
        (0..2048).map(|i| 1.09e-7 * (TAU * 17.0 * f64::from(i) / 2048.0).sin()).collect();
    let pressures: Vec<f64> = (0..20).map(|i| 1e7 * 0.2_f64.powi(19 - i)).collect();
    for exponent in [0.4, 0.9, 1.4, 1.9, 2.4] {
        for depth in [1e-5, 1e-4, 1e-3] {
            let indentation = |p: &f64| depth * (p / 1e7).powf(exponent);
            let samples: Vec<f64> =
                pressures.iter().copied().filter(|p| indentation(p) > 1e-12 * depth).collect();
            let separations: Vec<f64> = samples.iter().map(|p| depth - indentation(p)).collect();
            let law = LocalLaw::new(depth, &samples, &separations, LawEnd::PartialContact).unwrap();
            let mut contact = SoftContact::new(&rubber, 1.2e-3, PERIOD, &heights, law).unwrap();
            for pressure in [1e5, 5.5e5, 3e6] {
                let solution = contact.solve(pressure).unwrap();
                assert!(solution.residual < 3e-11, "{exponent} {depth} {pressure}");
            }
        }
    }
}

/// Compliances that differ by round-off had levels between which no blend was: not a number.
#[test]
fn a_layer_that_is_uniform_but_for_round_off_is_uniform() {
    let rubber = Rubber::table_2_1();
    let mut planner = realfft::RealFftPlanner::new();
    let mut space = HalfSpace::new(&mut planner, &rubber, 1e-3, PERIOD, 64).unwrap();
    let set: Vec<u32> = (0..16).map(|i| 4 * i).collect();
    let compliance = space.compliance_range().1;
    let mut under = |other: f64| {
        let mut compliances = vec![compliance; 16];
        compliances[7] = other;
        let mut layered = LayeredSpace::new(&mut space, &compliances);
        let mut pressure = vec![0.0; 16];
        layered.punch_on(&set, &mut pressure);
        pressure
    };
    let uniform = under(compliance);
    let nearly = under(compliance * (1.0 + 3.0 * f64::EPSILON));
    for (a, b) in uniform.iter().zip(&nearly) {
        approx::assert_relative_eq!(a, b, max_relative = 1e-8);
    }
}

#[test]
fn an_elastic_body_has_no_friction() {
    let law = westergaard(1e-5, PI * 1e5, 25);
    let rubber = Rubber::elastic(3e6, 0.5);
    let mut contact = SoftContact::new(&rubber, 0.01, 0.25e-3, &two_waves(512), law).unwrap();
    let solution = contact.solve(3e5).unwrap();
    assert!(solution.hysteretic_friction.abs() < 1e-12, "{}", solution.hysteretic_friction);
    // The slopes at the points are those of the band-limited profile; the edges of the contact
    // are not, and leave an error of the grid.
    assert!(solution.friction_coefficient.abs() < 1e-3, "{}", solution.friction_coefficient);
}
