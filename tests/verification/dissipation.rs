//! The work done on the rubber is the power that it dissipates.

use crate::surfaces::{random_phases, superposed, table_2_1};
use asperity::contact::SlidingContact;
use asperity::contact::half_space::HalfSpace;
use realfft::RealFftPlanner;

#[test]
fn the_work_on_the_slope_of_the_displacement_is_the_power_of_the_pressure() {
    let rubber = table_2_1();
    for (waves, points) in [(1, 100), (1, 257), (3, 1000), (3, 1025), (8, 4096)] {
        let profile = superposed(&random_phases(waves, 5), points);
        let speed = 0.01;
        let mut contact =
            SlidingContact::new(&rubber, speed, profile.period, &profile.heights).unwrap();
        let mut planner = RealFftPlanner::new();
        let mut space =
            HalfSpace::new(&mut planner, &rubber, speed, profile.period, points).unwrap();
        for p in [1e5, 1e6] {
            let solution = contact.solve(p).unwrap();
            let mean = profile.heights.iter().sum::<f64>() / points as f64;
            let displacement: Vec<f64> = solution
                .separation
                .iter()
                .zip(&profile.heights)
                .map(|(u, z)| u - solution.mean_separation + (z - mean))
                .collect();
            let work = space.mean_of_product_with_slope(&solution.pressure, &displacement);
            approx::assert_relative_eq!(
                work,
                solution.hysteretic_friction * p,
                max_relative = 1e-9
            );
        }
    }
}

/// In partial contact the slope of the profile is not that of the displacement beyond the edges,
/// so the two frictions differ by the grid: 2e-6 of the friction on 16384 points for an area of
/// 0.15, 3e-7 on 65536 (the order is in `tests/convergence`).
#[test]
fn friction_from_the_slopes_of_the_profile_tends_to_the_power() {
    let profile = superposed(&[0.0], 65536);
    let mut contact =
        SlidingContact::new(&table_2_1(), 0.01, profile.period, &profile.heights).unwrap();
    for p in [0.3e6, 1e6, 3.3e6, 8e6] {
        let solution = contact.solve(p).unwrap();
        approx::assert_relative_eq!(
            solution.friction_coefficient,
            solution.hysteretic_friction,
            max_relative = 1e-6
        );
    }
}
