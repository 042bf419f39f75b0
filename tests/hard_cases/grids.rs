//! Odd, prime and very fine grids, and grids that do not meet the profile where others do.

use crate::case::{Case, grid_condition};
use crate::surfaces::{Profile, random_phases, shortest_wave, superposed, table_2_1};
use asperity::contact::{ContactSolution, SlidingContact};
use asperity::reference::Westergaard;
use asperity::rubber::Rubber;
use std::f64::consts::TAU;

fn solve(rubber: &Rubber, profile: &Profile, pressure: f64) -> ContactSolution {
    let mut contact = SlidingContact::new(rubber, 0.01, profile.period, &profile.heights).unwrap();
    contact.solve(pressure).unwrap()
}

#[test]
fn odd_and_prime_grids_of_a_few_points_are_those_of_lemke() {
    let mut case = Case::new("odd and prime grids", "9, 11, 63, 97, 131, 251, 255 points", "Lemke");
    for points in [9, 11, 63, 97, 131, 251, 255] {
        for seed in 0..2 {
            // On nine points every wave but the longest is aliased: white noise to the solver.
            let profile = superposed(&random_phases(4, seed), points);
            for depth in [0.05, 0.5, 1.5] {
                case.compare_with_lemke(&table_2_1(), 0.01, &profile, depth);
            }
        }
    }
    case.enter();
}

#[test]
fn a_prime_and_a_fermat_grid_have_the_area_of_westergaard() {
    let rubber = Rubber::elastic(3e6, 0.5);
    let exact = Westergaard { reduced_modulus: 4e6, wave: shortest_wave() };
    for (points, tolerance) in [(16381, 1e-6), (65537, 1e-7), (65535, 1e-7)] {
        let mut case = Case::new(
            "odd and prime grids, elastic sine",
            format!("{points} points"),
            "area of Westergaard",
        );
        let profile = superposed(&[0.0], points);
        case.conditioned(grid_condition(&rubber, 0.01, &profile));
        for share in [0.03, 0.5] {
            let p = share * exact.full_contact_pressure();
            let solution = solve(&rubber, &profile, p);
            case.solved(&solution);
            // Second order in the spacing, see `tests/verification/westergaard.rs`.
            let area = exact.contact_area_fraction(p);
            case.agrees(solution.contact_area_fraction, area, tolerance);
        }
        case.enter();
    }
}

/// 2^20 points on one sine: Westergaard to the residual. 2^20 points on eight waves: the grid of half
/// as many, from which it differs by its error of second order.
#[test]
fn a_million_points() {
    let rubber = Rubber::elastic(3e6, 0.5);
    let exact = Westergaard { reduced_modulus: 4e6, wave: shortest_wave() };
    let profile = superposed(&[0.0], 1 << 20);
    let p = 0.03 * exact.full_contact_pressure();
    let mut case = Case::new("2^20 points, elastic sine", "1048576 points", "area of Westergaard");
    case.conditioned(grid_condition(&rubber, 0.01, &profile));
    let solution = solve(&rubber, &profile, p);
    case.solved(&solution);
    // The error of the grid is 1e-11; the edge is read from pressures with a residual of 1e-10 of the
    // displacement of the period, 1e5 points in contact.
    case.agrees(solution.contact_area_fraction, exact.contact_area_fraction(p), 1e-8);
    case.enter();

    let mut case =
        Case::new("2^20 points, 8 waves, lossy", "1048576 points", "friction on 524288 points");
    let phases = random_phases(8, 10);
    let profile = superposed(&phases, 1 << 20);
    case.conditioned(grid_condition(&table_2_1(), 0.01, &profile));
    let fine = solve(&table_2_1(), &profile, 1e6);
    let coarse = solve(&table_2_1(), &superposed(&phases, 1 << 19), 1e6);
    case.solved(&fine);
    case.solved(&coarse);
    // 4096 points on the shortest wave, and an order of two.
    case.agrees(coarse.friction_coefficient, fine.friction_coefficient, 1e-5);
    case.enter();
}

/// A profile that is moved by a part of a spacing has another highest point and other contact points,
/// but the same contact. Its error is that of the grid and falls with it.
#[test]
fn a_translation_by_a_part_of_a_cell_changes_no_more_than_the_grid() {
    let rubber = table_2_1();
    let phases = [0.3, 2.0, 4.4];
    let moved = |points: usize, cells: f64| {
        let shift = cells / points as f64;
        // Waves of 4, 2 and 1 a period.
        let phases: Vec<f64> =
            (0..3).map(|i| phases[i] - TAU * shift * 2_f64.powi(2 - i as i32)).collect();
        superposed(&phases, points)
    };
    let largest_difference = |case: &mut Case, points: usize, cells: f64, tolerance: f64| {
        let reference = moved(points, 0.0);
        case.conditioned(grid_condition(&rubber, 0.01, &reference));
        let translated = moved(points, cells);
        for p in [1e5, 1e6, 5e6] {
            let (a, b) = (solve(&rubber, &reference, p), solve(&rubber, &translated, p));
            case.solved(&a);
            case.solved(&b);
            case.agrees(b.friction_coefficient, a.friction_coefficient, tolerance);
            case.agrees(b.contact_area_fraction, a.contact_area_fraction, tolerance);
            case.agrees(b.mean_separation, a.mean_separation, tolerance);
        }
    };
    // Second order: a fourth and four times the points, a sixteenth of the error. Areas of small
    // spots converge with more scatter.
    for (points, tolerance) in [(1024, 2e-2), (4096, 2e-3), (16384, 2e-4)] {
        let mut case = Case::new(
            "translated by 0.25, 0.5 and 1/3 of a cell",
            format!("{points} points"),
            "the untranslated profile",
        );
        for cells in [0.25, 0.5, 1.0 / 3.0] {
            largest_difference(&mut case, points, cells, tolerance);
        }
        case.enter();
    }
    let mut case =
        Case::new("translated by 7 whole cells", "4096 points", "the untranslated profile");
    // The same heights but for the round-off of their phases.
    largest_difference(&mut case, 4096, 7.0, 1e-7);
    case.enter();
}
