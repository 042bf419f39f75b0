//! Near full contact, and what lies just past it.

use crate::case::{Case, grid_condition};
use crate::lemke::DenseContact;
use crate::surfaces::{Profile, random_phases, shortest_wave, superposed, table_2_1};
use asperity::contact::SlidingContact;
use asperity::reference::{FullContact, Westergaard};
use asperity::rubber::Rubber;
use realfft::RealFftPlanner;

fn contact(rubber: &Rubber, speed: f64, profile: &Profile) -> SlidingContact {
    SlidingContact::new(rubber, speed, profile.period, &profile.heights).unwrap()
}

#[test]
fn the_last_1e_6_of_an_elastic_sine() {
    let rubber = Rubber::elastic(3e6, 0.5);
    let exact = Westergaard { reduced_modulus: 4e6, wave: shortest_wave() };
    let full = exact.full_contact_pressure();
    for (points, tolerance) in [(4096, 0.15), (65536, 1e-3)] {
        let mut case = Case::new(
            "p = (1 - 1e-6) p*, elastic sine",
            format!("{points} points"),
            "non-contact width of Westergaard",
        );
        let profile = superposed(&[0.0], points);
        let mut contact = contact(&rubber, 0.01, &profile);
        case.conditioned(grid_condition(&rubber, 0.01, &profile));
        let solution = contact.solve((1.0 - 1e-6) * full).unwrap();
        case.solved(&solution);
        // The gap is 6.4e-4 of the period wide, 3 and 42 points; its edges are read to a fifth and
        // to a fiftieth of a spacing.
        let gap = 1.0 - exact.contact_area_fraction((1.0 - 1e-6) * full);
        case.agrees(1.0 - solution.contact_area_fraction, gap, tolerance);
        case.enter();

        let mut case = Case::new(
            "p = (1 + 1e-6) p*, elastic sine",
            format!("{points} points"),
            "largest pressure 2 p*",
        );
        case.conditioned(grid_condition(&rubber, 0.01, &profile));
        let solution = contact.solve((1.0 + 1e-6) * full).unwrap();
        case.solved(&solution);
        assert_eq!(solution.contact_area_fraction, 1.0);
        assert_eq!(solution.mean_separation, 0.0);
        let largest = solution.pressure.iter().copied().fold(0.0, f64::max);
        // The sum over a spectrum of one wave: round-off times the condition of the grid.
        case.agrees(largest, exact.maximum_pressure((1.0 + 1e-6) * full), 1e-11);
        case.enter();
    }
}

/// At the last gap the friction has the value of full contact but for terms of the gap.
#[test]
fn friction_is_continuous_where_the_last_gap_closes() {
    let rubber = table_2_1();
    let speed = 0.01;
    let exact = FullContact { rubber: &rubber, wave: shortest_wave(), speed };
    let profile = superposed(&[0.0], 4096);
    let mut contact = contact(&rubber, speed, &profile);
    let full = contact.smallest_full_contact_pressure();
    let mut case = Case::new(
        "p = (1 -+ 1e-6) p*, lossy sine",
        "4096 points",
        "friction of the Fourier formula",
    );
    case.conditioned(grid_condition(&rubber, speed, &profile));
    for side in [-1e-6, 1e-6] {
        let p = (1.0 + side) * full;
        let solution = contact.solve(p).unwrap();
        case.solved(&solution);
        assert_eq!(solution.contact_area_fraction == 1.0, side > 0.0);
        // The formula has none below full contact; it falls with the pressure.
        let friction = 2.0 * exact.friction_coefficient(2.0 * p).unwrap();
        // What the gap misses is a tension of 1e-6 of the mean pressure on 1e-3 of the period.
        case.agrees(solution.friction_coefficient, friction, 1e-8);
    }
    case.enter();
}

/// The depth at which Lemke's method meets full contact follows from the load: the separation is
/// the rigid displacement plus the own displacement of a point times the load.
#[test]
fn the_last_gap_of_rough_profiles_is_that_of_lemke() {
    let mut case = Case::new(
        "p = (1 - 1e-6) p*, 1, 3 and 8 waves",
        "128 and 129 points, elastic and lossy",
        "Lemke",
    );
    for rubber in [Rubber::elastic(3e6, 0.5), table_2_1()] {
        for waves in [1, 3, 8] {
            for points in [128, 129] {
                let profile = superposed(&random_phases(waves, 4), points);
                let depth = depth_of_full_contact(&rubber, 0.01, &profile);
                for share in [1.0 - 1e-3, 1.0 - 1e-6] {
                    let depth = 1.0 + (depth - 1.0) * share;
                    let dense = DenseContact::at_depth(&rubber, 0.01, &profile, depth);
                    let touching = dense.pressure.iter().filter(|t| **t > 0.0).count();
                    assert!(touching < points, "the last gap is open");
                    case.compare_with_lemke(&rubber, 0.01, &profile, depth);
                }
            }
        }
    }
    case.enter();
}

fn depth_of_full_contact(rubber: &Rubber, speed: f64, profile: &Profile) -> f64 {
    let n = profile.heights.len();
    let mut space = asperity::contact::half_space::HalfSpace::new(
        &mut RealFftPlanner::new(),
        rubber,
        speed,
        profile.period,
        n,
    )
    .unwrap();
    let (mut unit, mut displacement) = (vec![0.0; n], vec![0.0; n]);
    unit[0] = 1.0;
    space.displacement(&unit, &mut displacement);
    let full = contact(rubber, speed, profile).smallest_full_contact_pressure();
    let mean = profile.heights.iter().sum::<f64>() / n as f64;
    let top = profile.heights.iter().map(|z| z - mean).fold(0.0, f64::max);
    1.0 + n as f64 * full * displacement[0].abs() / top
}
