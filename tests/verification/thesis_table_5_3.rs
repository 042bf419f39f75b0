//! Column `friction_bem` of thesis Table 5.3: one sine wave, 10 mm/s.

use crate::surfaces::{superposed, table_2_1};
use asperity::contact::SlidingContact;

/// Pressure in MPa and friction coefficient, thesis Table 5.3.
const FRICTION_BEM: [(f64, f64); 14] = [
    (8.46180, 0.49823),
    (8.07463, 0.51772),
    (8.00526, 0.52114),
    (7.68399, 0.53675),
    (7.36913, 0.55154),
    (6.59313, 0.58548),
    (6.22233, 0.60025),
    (6.05398, 0.60659),
    (5.26714, 0.63293),
    (4.64028, 0.64927),
    (3.30858, 0.66455),
    (3.24604, 0.66438),
    (1.75708, 0.61885),
    (0.86548, 0.50974),
];

#[test]
fn every_row_within_5e_4() {
    let profile = superposed(&[0.0], 4096);
    let mut contact =
        SlidingContact::new(&table_2_1(), 0.01, profile.period, &profile.heights).unwrap();
    for (pressure_mpa, friction) in FRICTION_BEM {
        let solution = contact.solve(1e6 * pressure_mpa).unwrap();
        // The thesis' grid and its interpolation between pressures leave 4e-4.
        approx::assert_abs_diff_eq!(solution.friction_coefficient, friction, epsilon = 5e-4);
    }
}
