//! Laws that stiffen, by both routes: each is the check of the other, and neo-Hooke and the half-space are the checks of
//! both.

use super::error::{FemError, PathEnd};
use super::profile::RigidProfile;
use super::steady::solution::SteadySolution;
use super::steady::{BlockOptions, SteadyContact};
use super::transient::{StepFailure, TransientContact, TransientError, TransientOptions};
use crate::contact::SlidingContact;
use crate::rubber::{MaxwellBranch, Rheology, Rubber};
use crate::surface::Wave;
use approx::assert_relative_eq;

const PERIOD: f64 = 6.25e-5;
/// The steepest wave of the thesis, 0.01867 mm.
const STEEP: f64 = 1.867e-5;

const YEOH: Rheology = Rheology::Yeoh { c2_over_c1: -0.1, c3_over_c1: 0.01 };
const ARRUDA_BOYCE: Rheology = Rheology::ArrudaBoyce { locking_stretch: 3.0 };
const LAWS: [Rheology; 2] = [YEOH, ARRUDA_BOYCE];

fn sine(amplitude: f64) -> RigidProfile {
    RigidProfile::from_waves(&[Wave { wavelength: PERIOD, amplitude, phase: 0.0 }], PERIOD)
}

fn contact(law: Rheology, amplitude: f64, columns: usize) -> SteadyContact {
    let (profile, rubber) = (sine(amplitude), Rubber::table_2_1());
    let options = BlockOptions::of_profile(columns, &profile);
    SteadyContact::new(&rubber, law, 0.01, profile, options).unwrap()
}

fn solve(law: Rheology, amplitude: f64, columns: usize, pressure: f64) -> SteadySolution {
    let solution = contact(law, amplitude, columns).solve(pressure).unwrap();
    assert!(solution.residual <= 1e-9, "{law:?}: {}", solution.residual);
    solution
}

/// The whole solution, to the last bit, also through what the stiffening adds to the tangent.
#[test]
fn without_constants_the_contact_is_that_of_neo_hooke() {
    let neo_hooke = solve(Rheology::NeoHookean, STEEP, 64, 3e6);
    for law in [
        Rheology::Yeoh { c2_over_c1: 0.0, c3_over_c1: 0.0 },
        Rheology::ArrudaBoyce { locking_stretch: 1e9 },
    ] {
        assert_eq!(solve(law, STEEP, 64, 3e6), neo_hooke, "{law:?}");
    }
}

/// At small slopes no law matters: friction is that of the half-space, within what neo-Hooke has.
#[test]
fn small_slopes_have_the_friction_of_the_half_space() {
    let (amplitude, pressure) = (6.25e-7, 5.88e4);
    let heights = sine(amplitude).sample(4096);
    let mut half_space = SlidingContact::new(&Rubber::table_2_1(), 0.01, PERIOD, &heights).unwrap();
    let expected = half_space.solve(pressure).unwrap().friction_coefficient;
    for law in LAWS {
        let found = solve(law, amplitude, 64, pressure);
        assert_relative_eq!(found.friction_coefficient, expected, max_relative = 0.01);
        assert!(found.largest_invariant.unwrap() < 0.1, "{found:?}");
    }
}

/// Strongly strained: the laws differ, and cost no more steps than neo-Hooke is allowed to.
#[test]
fn steep_waves_are_solved_in_as_few_steps_as_under_neo_hooke() {
    let neo_hooke = solve(Rheology::NeoHookean, STEEP, 64, 8e6);
    for law in LAWS {
        let found = solve(law, STEEP, 64, 8e6);
        assert!(found.newton_steps < 100, "{law:?}: {}", found.newton_steps);
        let change = found.friction_coefficient / neo_hooke.friction_coefficient - 1.0;
        println!(
            "{law:?}: {:.4} against {:.4}, I1 - 3 up to {:.2} against {:.2}, {} steps against {}",
            found.friction_coefficient,
            neo_hooke.friction_coefficient,
            found.largest_invariant.unwrap(),
            neo_hooke.largest_invariant.unwrap(),
            found.newton_steps,
            neo_hooke.newton_steps
        );
        assert!(change.abs() > 0.01, "{law:?}: {change}");
        assert_relative_eq!(
            found.hysteretic_friction,
            found.friction_coefficient,
            max_relative = 0.015
        );
    }
}

/// In full contact, where the field has no edges, work of the drag and heat of the branches agree to the accuracy of the
/// flow rule.
#[test]
fn the_work_of_the_drag_is_the_heat_of_the_branches() {
    for law in LAWS {
        let full = solve(law, 3e-6, 128, 3e6);
        assert_relative_eq!(full.contact_area_fraction, 1.0, max_relative = 1e-12);
        let [work, heat] = [full.friction_coefficient, full.hysteretic_friction];
        assert_relative_eq!(work, heat, max_relative = 2e-5);
    }
}

#[test]
fn a_flat_profile_and_an_elastic_block_have_no_friction() {
    for law in LAWS {
        let flat = solve(law, 0.0, 16, 5e6);
        assert!(flat.friction_coefficient.abs() < 1e-12, "{}", flat.friction_coefficient);
        let (rubber, profile) = (Rubber::elastic(4.17e6, 0.49), sine(6e-6));
        let options = BlockOptions::of_profile(64, &profile);
        let mut elastic = SteadyContact::new(&rubber, law, 0.01, profile, options).unwrap();
        let solution = elastic.solve(5e5).unwrap();
        assert!(solution.friction_coefficient.abs() < 1e-7, "{}", solution.friction_coefficient);
        assert_eq!(solution.hysteretic_friction, 0.0);
    }
}

/// One branch, so that the drag forgets its start within a few periods.
fn one_branch() -> Rubber {
    let relaxation_time = 0.35 * PERIOD / (std::f64::consts::TAU * 0.01);
    Rubber {
        branches: vec![MaxwellBranch { modulus: 4e6, relaxation_time }],
        ..Rubber::elastic(4e6, 0.49)
    }
}

fn drag(law: Rheology, amplitude: f64, columns: usize) -> TransientContact {
    let options = BlockOptions::new(columns);
    let drag =
        TransientOptions { drag_periods: 4, averaged_periods: 1, ..TransientOptions::default() };
    TransientContact::new(&one_branch(), law, 0.01, sine(amplitude), options.mesh(PERIOD), drag)
        .unwrap()
}

#[test]
fn both_routes_have_one_friction() {
    let (amplitude, pressure) = (1e-5, 8e5);
    // Constants that matter at the strains of this contact.
    let strong = [
        Rheology::Yeoh { c2_over_c1: 0.3, c3_over_c1: 0.1 },
        Rheology::ArrudaBoyce { locking_stretch: 1.5 },
    ];
    let friction = |law: Rheology| {
        let options = BlockOptions::new(128);
        SteadyContact::new(&one_branch(), law, 0.01, sine(amplitude), options)
            .unwrap()
            .solve(pressure)
            .unwrap()
            .friction_coefficient
    };
    let neo_hooke = friction(Rheology::NeoHookean);
    for law in strong {
        let transient = drag(law, amplitude, 64).run(pressure, |_| {}).unwrap();
        let steady = friction(law);
        let energy = &transient.samples[transient.samples.len() - 1].energy;
        println!(
            "{law:?}: {steady:.5} steady, {:.5} transient, {neo_hooke:.5} neo-Hooke",
            transient.friction_coefficient.mean
        );
        assert_relative_eq!(steady, transient.friction_coefficient.mean, max_relative = 5e-3);
        assert!((steady / neo_hooke - 1.0).abs() > 0.02, "{law:?}: {steady} {neo_hooke}");
        // What is put in is heat or stored, to the accuracy of the steps.
        assert!(energy.imbalance().abs() < 1e-2 * energy.dissipated, "{energy:?}");
    }
}

/// A solution of the equations beyond the law is none, and the error says where the law ends.
#[test]
fn what_is_beyond_the_law_is_refused_with_its_range() {
    let short = Rheology::Yeoh { c2_over_c1: -0.1, c3_over_c1: 0.0 };
    let straight = Rheology::ArrudaBoyce { locking_stretch: 1.2 };
    for (law, words) in [(short, "has a maximum there"), (straight, "chains are straight")] {
        let mut contact = contact(law, STEEP, 64);
        let error = contact.solve(8e6).unwrap_err();
        let text = error.to_string();
        assert!(text.contains(words), "{text}");
        assert!(text.contains(&format!("holds up to {:.4}", law.limit())), "{text}");
        let FemError::PathEnded { reached, beyond: Some(beyond), .. } = error else {
            panic!("{text}")
        };
        assert!(beyond.invariant > law.limit() && beyond.law == law, "{text}");
        // The last point that the law allows is below, and a solution.
        let PathEnd::At { pressure, friction_coefficient, .. } = reached else { panic!("{text}") };
        assert!(pressure < 8e6 && friction_coefficient.is_finite(), "{text}");
        // What is within the law is solved after that.
        let slight = contact.solve(2e4).unwrap();
        assert!(slight.largest_invariant.unwrap() <= law.limit(), "{slight:?}");
    }
    // Shorter chains: one branch strains the rubber less.
    let straight = Rheology::ArrudaBoyce { locking_stretch: 1.05 };
    let error = drag(straight, STEEP, 32).run(8e5, |_| {}).unwrap_err();
    let TransientError::Stopped { failure: StepFailure::BeyondLaw(beyond), .. } = &error else {
        panic!("{error}")
    };
    assert!(beyond.invariant > straight.limit(), "{error}");
    assert!(error.to_string().contains("chains are straight"), "{error}");
}

/// A contact that lasts adds a branch of negative modulus, whose sign the stiffening must keep: the tangent is then still
/// exact, so that a solution is found.
#[test]
fn a_contact_that_lasts_is_solved_under_laws_that_stiffen() {
    for law in LAWS {
        let lasting = contact(law, STEEP, 64).lasting(PERIOD).solve(3e6).unwrap();
        assert!(lasting.residual <= 1e-9 && lasting.newton_steps < 100, "{lasting:?}");
    }
}

/// Friction, contact area and largest invariant of the steepest wave of the thesis over pressure: the table of
/// docs/finite_deformation.md.
#[test]
#[ignore = "prints a table; takes a minute"]
fn friction_of_the_steepest_wave_under_each_law() {
    let laws = [
        Rheology::NeoHookean,
        Rheology::Yeoh { c2_over_c1: -0.1, c3_over_c1: 0.01 },
        Rheology::Yeoh { c2_over_c1: -0.1, c3_over_c1: 0.04 },
        Rheology::ArrudaBoyce { locking_stretch: 5.12 },
        Rheology::ArrudaBoyce { locking_stretch: 3.0 },
        Rheology::ArrudaBoyce { locking_stretch: 2.0 },
    ];
    for (speed, pressures) in [
        (0.01, [0.3, 1.1, 3.31, 5.27, 8.07, 12.0, 18.0, 25.0]),
        (0.05, [0.3, 1.0, 2.0, 4.0, 8.0, 12.0, 16.0, 25.0]),
    ] {
        for law in laws {
            let profile = sine(STEEP);
            let options = BlockOptions::of_profile(96, &profile);
            let rubber = Rubber::table_2_1();
            let mut contact = SteadyContact::new(&rubber, law, speed, profile, options).unwrap();
            println!("{speed} m/s, {law:?}");
            for pressure in pressures {
                match contact.solve(1e6 * pressure) {
                    Ok(s) => println!(
                        "  {pressure} MPa: {:.4} ({:.4}), area {:.3}, I1 - 3 {:.2}, shear {:.2}, {} steps",
                        s.friction_coefficient,
                        s.hysteretic_friction,
                        s.contact_area_fraction,
                        s.largest_invariant.unwrap(),
                        s.shear,
                        s.newton_steps
                    ),
                    Err(error) => println!("  {pressure} MPa: {error}"),
                }
            }
        }
    }
}
