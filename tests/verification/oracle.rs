//! The fast solver against Lemke's method on the dense matrix.

use crate::lemke::DenseContact;
use crate::surfaces::{Profile, random_phases, superposed, table_2_1, white_noise};
use asperity::contact::SlidingContact;
use asperity::rubber::Rubber;

/// Solves the contact at a given indentation `depth` (share of the height of the highest point) by
/// Lemke's method, then at the load found by the fast solver.
fn compare(rubber: &Rubber, speed: f64, profile: &Profile, depth: f64) {
    let n = profile.heights.len();
    let oracle = DenseContact::at_depth(rubber, speed, profile, depth);
    let mut contact = SlidingContact::new(rubber, speed, profile.period, &profile.heights).unwrap();
    let solution = contact.solve(oracle.mean_pressure).unwrap();
    let largest = oracle.pressure.max();
    // Gaps of 1e-10 of the displacement make pressures that differ by this times as much at most.
    assert!(oracle.condition_number < 1e4, "{}", oracle.condition_number);
    for (i, (fast, exact)) in solution.pressure.iter().zip(&oracle.pressure).enumerate() {
        assert!(
            (fast - exact).abs() <= 1e-8 * largest,
            "{n} points, depth {depth}, v = {speed}: t[{i}] = {fast}, {exact} by Lemke"
        );
    }
    approx::assert_relative_eq!(
        solution.mean_separation,
        oracle.mean_separation,
        max_relative = 1e-8
    );
}

#[test]
fn elastic_and_viscoelastic_contacts_are_those_of_lemke() {
    let elastic = Rubber::elastic(3e6, 0.5);
    for seed in 0..3 {
        for (waves, points) in [(1, 64), (3, 129), (8, 256)] {
            let profile = superposed(&random_phases(waves, seed), points);
            for depth in [0.1, 0.5, 1.5] {
                compare(&elastic, 0.01, &profile, depth);
                compare(&table_2_1(), 1e-4, &profile, depth);
                compare(&table_2_1(), 0.1, &profile, depth);
                compare(&table_2_1(), 10.0, &profile, depth);
            }
        }
        let noise = white_noise(128, seed);
        for depth in [0.2, 2.0] {
            compare(&elastic, 0.01, &noise, depth);
            compare(&table_2_1(), 0.01, &noise, depth);
        }
    }
}
