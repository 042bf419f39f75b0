//! Westergaard's solution for an elastic half-plane and one sine wave.

use crate::surfaces::{shortest_wave, superposed};
use asperity::contact::SlidingContact;
use asperity::reference::Westergaard;
use asperity::rubber::Rubber;

/// On 16384 points the error, which falls with the square of the spacing, is 8e-7 for the
/// smallest of these contacts (3 % of the period) and below 6e-8 for those above 10 %.
const POINTS: usize = 16384;

#[test]
fn area_pressure_and_separation_of_an_elastic_sine() {
    let rubber = Rubber::elastic(3e6, 0.5);
    let exact = Westergaard { reduced_modulus: 4e6, wave: shortest_wave() };
    let profile = superposed(&[0.0], POINTS);
    let mut contact = SlidingContact::new(&rubber, 0.01, profile.period, &profile.heights).unwrap();
    for load in [0.003, 0.03, 0.1, 0.2, 0.5, 0.8, 0.95, 0.999] {
        let p = load * exact.full_contact_pressure();
        let solution = contact.solve(p).unwrap();
        approx::assert_relative_eq!(
            solution.contact_area_fraction,
            exact.contact_area_fraction(p),
            max_relative = 1e-6
        );
        let maximum = solution.pressure.iter().copied().fold(0.0, f64::max);
        approx::assert_relative_eq!(maximum, exact.maximum_pressure(p), max_relative = 1e-6);
        approx::assert_abs_diff_eq!(
            solution.mean_separation,
            exact.mean_separation(p),
            epsilon = 1e-6 * exact.wave.amplitude
        );
        // An elastic body loses nothing; what is left is round-off of sums over the points.
        assert!(solution.hysteretic_friction.abs() < 1e-12, "{}", solution.hysteretic_friction);
    }
}

#[test]
fn the_pressure_between_the_edges_is_that_of_the_formula() {
    let rubber = Rubber::elastic(3e6, 0.5);
    let exact = Westergaard { reduced_modulus: 4e6, wave: shortest_wave() };
    let profile = superposed(&[0.0], POINTS);
    let p = 0.2 * exact.full_contact_pressure();
    let mut contact = SlidingContact::new(&rubber, 0.01, profile.period, &profile.heights).unwrap();
    let solution = contact.solve(p).unwrap();
    let half_width = 0.5 * exact.contact_area_fraction(p) * profile.period;
    let maximum = exact.maximum_pressure(p);
    for (i, t) in solution.pressure.iter().enumerate() {
        let distance = (i as f64 / POINTS as f64 - 0.25) * profile.period;
        // Next to an edge the grid's operator is not the half-plane's.
        let steps = (distance.abs() - half_width).abs() / profile.period * POINTS as f64;
        if steps > 50.0 {
            let expected = exact.pressure(p, distance);
            approx::assert_abs_diff_eq!(*t, expected, epsilon = 1e-6 * maximum);
        }
    }
}
