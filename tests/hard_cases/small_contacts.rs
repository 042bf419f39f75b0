//! Contacts of one point, and one point that stands out.

use crate::case::{Case, grid_condition};
use crate::surfaces::{
    Profile, random_phases, shortest_wave, single_peak, superposed, table_2_1, white_noise,
};
use asperity::contact::SlidingContact;
use asperity::contact::half_space::HalfSpace;
use asperity::reference::Westergaard;
use asperity::rubber::Rubber;
use realfft::RealFftPlanner;

/// Displacement of the loaded point by a unit pressure there: a sum over the waves.
fn own_displacement(rubber: &Rubber, speed: f64, profile: &Profile) -> f64 {
    let n = profile.heights.len();
    let mut space =
        HalfSpace::new(&mut RealFftPlanner::new(), rubber, speed, profile.period, n).unwrap();
    let (mut unit, mut displacement) = (vec![0.0; n], vec![0.0; n]);
    unit[0] = 1.0;
    space.displacement(&unit, &mut displacement);
    displacement[0]
}

#[test]
fn the_highest_point_alone_carries_the_load() {
    let rubber = table_2_1();
    for (points, seed) in [(256, 1), (257, 2), (4096, 3)] {
        let mut case = Case::new(
            "one-point contact of white noise",
            format!("{points} points, p over the E_r D / L of one point 1e-9 to 1e-2"),
            "ubar = z_max - N p C_0",
        );
        let profile = white_noise(points, seed);
        let own = own_displacement(&rubber, 0.01, &profile);
        let mean = profile.heights.iter().sum::<f64>() / points as f64;
        let top = profile.heights.iter().map(|z| z - mean).fold(0.0, f64::max);
        let mut contact =
            SlidingContact::new(&rubber, 0.01, profile.period, &profile.heights).unwrap();
        // The second highest of N uniform heights is 1/N of the range lower on average.
        for share in [1e-9, 1e-6, 1e-4, 1e-2].map(|share| share / points as f64) {
            let p = share * top / (points as f64 * own);
            let solution = contact.solve(p).unwrap();
            case.solved(&solution);
            assert_eq!(solution.pressure.iter().filter(|t| **t > 0.0).count(), 1);
            assert!(solution.contact_area_fraction <= 2.0 / points as f64);
            let expected = top - points as f64 * p * own;
            // Both are sums of N terms of the size of the heights.
            case.agrees(solution.mean_separation, expected, 1e-13);
        }
        // One unknown: its own displacement.
        case.conditioned(1.0);
        case.enter();
    }
}

/// The area of Westergaard at 1e-4 of the period, from a contact of six points to one of less than
/// half a point.
#[test]
fn an_area_of_1e_4_is_found() {
    let rubber = Rubber::elastic(3e6, 0.5);
    let exact = Westergaard { reduced_modulus: 4e6, wave: shortest_wave() };
    for (points, tolerance) in [
        // A crest that lies on a point; the area of one point is an estimate between that of two
        // and none, whose pressure is within 8 % of the exact one.
        (4096, 0.1),
        // 3.3 and 13.1 points, edges read to a fifth and to a fiftieth of a spacing: the area errs
        // by twice that share of the points, the pressure, its square, by twice as much again.
        (32768, 0.3),
        (131072, 6e-3),
    ] {
        let mut case = Case::new(
            "requested area fraction 1e-4, one elastic sine",
            format!("{points} points"),
            "pressure of Westergaard",
        );
        let profile = superposed(&[0.0], points);
        let mut contact =
            SlidingContact::new(&rubber, 0.01, profile.period, &profile.heights).unwrap();
        let solution = contact.solve_for_area(1e-4, 1e-6).unwrap();
        case.solved(&solution);
        assert!((solution.contact_area_fraction / 1e-4 - 1.0).abs() <= 1e-6);
        case.conditioned(grid_condition(&rubber, 0.01, &profile));
        case.agrees(solution.mean_pressure, exact.mean_pressure(1e-4), tolerance);
        case.enter();
    }
}

#[test]
fn the_first_points_of_a_rough_contact_are_those_of_lemke() {
    let mut case = Case::new(
        "first points of a lossy contact, 3 and 8 waves",
        "256 points, depth 1e-6 to 1e-2",
        "Lemke",
    );
    for waves in [3, 8] {
        for seed in 0..3 {
            let profile = superposed(&random_phases(waves, seed), 256);
            for depth in [1e-6, 1e-4, 1e-2] {
                case.compare_with_lemke(&table_2_1(), 0.01, &profile, depth);
            }
        }
    }
    case.enter();
}

#[test]
fn a_spike_carries_the_load_until_the_plane_touches() {
    let rubber = table_2_1();
    let mut case =
        Case::new("single spike on a plane", "255 and 256 points, depth 0.1 to 300", "Lemke");
    for points in [255, 256] {
        // From the spike alone to the plane in contact up to the foot of the spike.
        for depth in [0.1, 0.9, 1.0, 1.01, 3.0, 300.0] {
            case.compare_with_lemke(&rubber, 0.01, &single_peak(points), depth);
        }
    }
    case.enter();
}
