//! Viscoelastic full contact with one sine wave.

use crate::surfaces::{shortest_wave, superposed, table_2_1};
use asperity::contact::SlidingContact;
use asperity::reference::FullContact;

#[test]
fn friction_from_slopes_and_from_power_is_exact() {
    let rubber = table_2_1();
    let profile = superposed(&[0.4], 1024);
    for speed in [1e-4, 1e-2, 1.0, 1e2] {
        let exact = FullContact { rubber: &rubber, wave: shortest_wave(), speed };
        let mut contact =
            SlidingContact::new(&rubber, speed, profile.period, &profile.heights).unwrap();
        for load in [1.0, 1.5, 30.0] {
            let p = load * exact.smallest_pressure();
            let solution = contact.solve(p).unwrap();
            assert_eq!(solution.contact_area_fraction, 1.0);
            // The taper of the phase changes that of one wave on 1024 points by 4e-11.
            let friction = exact.friction_coefficient(p).unwrap();
            let tolerance = 1e-9;
            approx::assert_relative_eq!(
                solution.friction_coefficient,
                friction,
                max_relative = tolerance
            );
            approx::assert_relative_eq!(
                solution.hysteretic_friction,
                friction,
                max_relative = tolerance
            );
            assert!(solution.mean_separation.abs() < 1e-12 * exact.wave.amplitude);
        }
    }
}

#[test]
fn full_contact_begins_where_the_formula_says() {
    let rubber = table_2_1();
    let speed = 0.01;
    let exact = FullContact { rubber: &rubber, wave: shortest_wave(), speed };
    let profile = superposed(&[0.0], 4096);
    let mut contact =
        SlidingContact::new(&rubber, speed, profile.period, &profile.heights).unwrap();
    let p = contact.smallest_full_contact_pressure();
    // A grid misses the deepest tension by at most half a step: (π / 4096)² / 2 = 3e-7.
    approx::assert_relative_eq!(p, exact.smallest_pressure(), max_relative = 3e-7);
    let below = contact.solve(0.999 * p).unwrap();
    assert!(below.contact_area_fraction < 1.0 && below.contact_area_fraction > 0.97);
}
