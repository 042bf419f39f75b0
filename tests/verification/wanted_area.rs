//! The pressure for a wanted contact area.

use crate::surfaces::{random_phases, shortest_wave, superposed, table_2_1};
use asperity::contact::{ContactError, SlidingContact};
use asperity::reference::Westergaard;
use asperity::rubber::Rubber;

#[test]
fn the_pressure_of_an_elastic_sine_is_westergaards() {
    let exact = Westergaard { reduced_modulus: 4e6, wave: shortest_wave() };
    let profile = superposed(&[0.0], 16384);
    let rubber = Rubber::elastic(3e6, 0.5);
    let mut contact = SlidingContact::new(&rubber, 0.01, profile.period, &profile.heights).unwrap();
    for area in [0.02, 0.3, 0.9, 1.0] {
        let solution = contact.solve_for_area(area, 1e-8).unwrap();
        approx::assert_relative_eq!(solution.contact_area_fraction, area, max_relative = 1e-8);
        // Twice the 1e-6 of the area: p ~ area² for small contacts.
        approx::assert_relative_eq!(
            solution.mean_pressure,
            exact.mean_pressure(area),
            max_relative = 2e-6
        );
    }
}

#[test]
fn areas_from_a_thousandth_to_full_contact_are_found_on_rough_surfaces() {
    for seed in 0..4 {
        let profile = superposed(&random_phases(8, seed), 8192);
        let mut contact =
            SlidingContact::new(&table_2_1(), 0.01, profile.period, &profile.heights).unwrap();
        for area in [0.001, 0.002, 0.01, 0.05, 0.1, 0.5, 0.95, 0.999, 1.0] {
            let solution = contact.solve_for_area(area, 1e-4).unwrap();
            approx::assert_relative_eq!(solution.contact_area_fraction, area, max_relative = 1e-4);
        }
    }
}

#[test]
fn what_cannot_be_is_said() {
    let mut flat = SlidingContact::new(&table_2_1(), 0.01, 1e-3, &[1.0; 64]).unwrap();
    assert!(matches!(
        flat.solve_for_area(0.5, 1e-4),
        Err(ContactError::AreaNotReached { found: 1.0, .. })
    ));
    let profile = superposed(&[0.0], 64);
    let mut contact =
        SlidingContact::new(&table_2_1(), 0.01, profile.period, &profile.heights).unwrap();
    for (fraction, tolerance) in [(0.0, 0.1), (1.1, 0.1), (f64::NAN, 0.1), (0.5, 0.0), (0.5, 1.0)] {
        assert!(matches!(
            contact.solve_for_area(fraction, tolerance),
            Err(ContactError::OutOfRange { .. })
        ));
    }
}
