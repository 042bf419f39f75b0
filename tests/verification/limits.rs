//! Very slow and very fast sliding are elastic.

use crate::surfaces::{random_phases, shortest_wave, superposed, table_2_1};
use asperity::contact::{ContactSolution, SlidingContact};
use asperity::reference::{SineCrest, Westergaard};
use asperity::rubber::Rubber;

const POINTS: usize = 1024;

/// Slow against the longest relaxation time on the shortest wave of the grid: 1e-7 of loss.
const SLOW: f64 = 1e-13;
/// Fast against the shortest relaxation time on a wave of 0.25 mm.
const FAST: f64 = 1e13;

fn solve(rubber: &Rubber, speed: f64, waves: usize, pressure: f64) -> ContactSolution {
    let profile = superposed(&random_phases(waves, 11), POINTS);
    let mut contact = SlidingContact::new(rubber, speed, profile.period, &profile.heights).unwrap();
    contact.solve(pressure).unwrap()
}

#[test]
fn both_limits_are_elastic_and_without_friction() {
    let rubber = table_2_1();
    for (speed, modulus) in [(SLOW, rubber.equilibrium_modulus), (FAST, rubber.glassy_modulus())] {
        let elastic = Rubber::elastic(modulus, rubber.poisson_ratio);
        for load in [0.01, 0.2] {
            let p = load * modulus;
            let viscoelastic = solve(&rubber, speed, 3, p);
            let limit = solve(&elastic, 1.0, 3, p);
            // The loss left is 1e-6 at most, and a contact edge moves with it in proportion.
            approx::assert_relative_eq!(
                viscoelastic.contact_area_fraction,
                limit.contact_area_fraction,
                max_relative = 1e-5
            );
            approx::assert_relative_eq!(
                viscoelastic.mean_separation,
                limit.mean_separation,
                max_relative = 1e-5
            );
            assert!(viscoelastic.hysteretic_friction.abs() < 1e-5);
        }
    }
}

#[test]
fn the_areas_of_both_limits_coincide_at_equal_mean_separation() {
    let rubber = table_2_1();
    for area in [0.03, 0.2, 0.6] {
        let profile = superposed(&random_phases(3, 12), POINTS);
        let mut slow =
            SlidingContact::new(&rubber, SLOW, profile.period, &profile.heights).unwrap();
        let mut fast =
            SlidingContact::new(&rubber, FAST, profile.period, &profile.heights).unwrap();
        let slow = slow.solve_for_area(area, 1e-9).unwrap();
        let fast = fast.solve_for_area(area, 1e-9).unwrap();
        approx::assert_relative_eq!(
            slow.mean_separation,
            fast.mean_separation,
            max_relative = 1e-5
        );
        assert!(fast.mean_pressure > 100.0 * slow.mean_pressure);
    }
}

#[test]
fn fast_sliding_at_small_load_is_the_hertz_contact_of_the_crest() {
    let rubber = table_2_1();
    let reduced_modulus = rubber.glassy_modulus() / (1.0 - rubber.poisson_ratio.powi(2));
    let hertz = SineCrest { reduced_modulus, wave: shortest_wave() };
    let full = Westergaard { reduced_modulus, wave: shortest_wave() }.full_contact_pressure();
    let profile = superposed(&[0.0], 65536);
    let mut contact = SlidingContact::new(&rubber, FAST, profile.period, &profile.heights).unwrap();
    let p = 1e-3 * full;
    let solution = contact.solve(p).unwrap();
    // The crest of a sine is a parabola but for p / (6 p*) = 1.7e-4 of the width.
    approx::assert_relative_eq!(
        solution.contact_area_fraction,
        hertz.contact_area_fraction(p),
        max_relative = 2e-4
    );
}
