//! Symmetries of the model, on random surfaces.

use crate::surfaces::{Profile, superposed, table_2_1};
use asperity::contact::{ContactSolution, SlidingContact};
use asperity::rubber::Rubber;
use proptest::prelude::*;
use std::f64::consts::TAU;

const SPEED: f64 = 0.01;

fn solve(rubber: &Rubber, speed: f64, profile: &Profile, pressure: f64) -> ContactSolution {
    let mut contact = SlidingContact::new(rubber, speed, profile.period, &profile.heights).unwrap();
    contact.solve(pressure).unwrap()
}

/// Whether two solutions are one but for `friction_sign`. The solver stops at a residual of 1e-10
/// of the displacement; the pressures of islands of a few points amplify it.
fn assert_same(a: &ContactSolution, b: &ContactSolution, friction_sign: f64) {
    let tolerance = 1e-7;
    approx::assert_relative_eq!(
        a.contact_area_fraction,
        b.contact_area_fraction,
        max_relative = tolerance
    );
    approx::assert_relative_eq!(
        a.friction_coefficient,
        friction_sign * b.friction_coefficient,
        max_relative = tolerance
    );
    approx::assert_relative_eq!(a.mean_separation, b.mean_separation, max_relative = tolerance);
}

fn phases() -> impl Strategy<Value = [f64; 3]> {
    [0.0..TAU, 0.0..TAU, 0.0..TAU]
}

/// Pressures in Pa from tiny contacts (area 0.02) to large ones (0.7), log-uniform.
fn pressures() -> impl Strategy<Value = f64> {
    (11.5..16.0_f64).prop_map(f64::exp)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn pressure_and_moduli_scale_together(
        phases in phases(), p in pressures(), factor in 1e-3..1e3_f64,
    ) {
        let profile = superposed(&phases, 300);
        let mut scaled = table_2_1();
        scaled.equilibrium_modulus *= factor;
        scaled.branches.iter_mut().for_each(|branch| branch.modulus *= factor);
        let a = solve(&table_2_1(), SPEED, &profile, p);
        let b = solve(&scaled, SPEED, &profile, factor * p);
        assert_same(&a, &b, 1.0);
    }

    #[test]
    fn a_translated_profile_has_the_same_contact(
        phases in phases(), p in pressures(), shift in 1..300_usize,
    ) {
        let profile = superposed(&phases, 300);
        let mut moved = profile.clone();
        moved.heights.rotate_left(shift);
        let a = solve(&table_2_1(), SPEED, &profile, p);
        let b = solve(&table_2_1(), SPEED, &moved, p);
        assert_same(&a, &b, 1.0);
    }

    #[test]
    fn a_mirrored_profile_and_speed_mirror_the_friction(phases in phases(), p in pressures()) {
        let profile = superposed(&phases, 300);
        let mut mirrored = profile.clone();
        mirrored.heights.reverse();
        let a = solve(&table_2_1(), SPEED, &profile, p);
        let b = solve(&table_2_1(), -SPEED, &mirrored, p);
        assert_same(&a, &b, -1.0);
    }

    #[test]
    fn odd_and_even_grids_agree_to_the_discretisation(phases in phases(), p in pressures()) {
        let a = solve(&table_2_1(), SPEED, &superposed(&phases, 4096), p);
        let b = solve(&table_2_1(), SPEED, &superposed(&phases, 4095), p);
        // The smallest spots are 20 points wide; the error is about (1/20)² of their share.
        approx::assert_relative_eq!(
            a.contact_area_fraction, b.contact_area_fraction, max_relative = 1e-3
        );
        approx::assert_relative_eq!(
            a.friction_coefficient, b.friction_coefficient, max_relative = 1e-3
        );
    }
}
