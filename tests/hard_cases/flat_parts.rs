//! Heights that are exactly equal: nothing decides which point touches first.

use crate::case::{Case, grid_condition};
use crate::surfaces::{Profile, superposed, table_2_1};
use asperity::contact::SlidingContact;
use asperity::rubber::Rubber;
use std::f64::consts::PI;

fn contact(rubber: &Rubber, profile: &Profile) -> SlidingContact {
    SlidingContact::new(rubber, 0.01, profile.period, &profile.heights).unwrap()
}

/// Plateaus of equal height and width, and valleys between them.
fn plateaus(points: usize, count: usize, share: f64) -> Profile {
    let cell = points / count;
    let width = (share * cell as f64).round() as usize;
    let heights = (0..points).map(|i| if i % cell < width { 1e-5 } else { 0.0 }).collect();
    Profile { period: 1e-3, heights }
}

#[test]
fn a_flat_profile_presses_uniformly_at_any_pressure() {
    let mut case = Case::new(
        "exactly flat profile",
        "1000 and 1009 points, 1e-3 to 1e9 Pa",
        "t = p, ubar = 0, friction 0",
    );
    for points in [1000, 1009] {
        // A height far from zero whose mean has round-off.
        let profile = Profile { period: 1e-3, heights: vec![0.1 + 1e-7 / 3.0; points] };
        let mut contact = contact(&table_2_1(), &profile);
        case.conditioned(grid_condition(&table_2_1(), 0.01, &profile));
        for p in [1e-3, 1.0, 1e6, 1e9] {
            let solution = contact.solve(p).unwrap();
            case.solved(&solution);
            assert_eq!(solution.contact_area_fraction, 1.0);
            assert_eq!(solution.mean_separation, 0.0);
            for t in &solution.pressure {
                case.agrees(*t, p, 1e-15);
            }
            case.differs(solution.friction_coefficient.abs(), 0.0);
        }
    }
    case.enter();
}

/// One flat punch a period, `t = p cos(πx/L) / sqrt(sin²(πa/L) - sin²(πx/L))` within `|x| < a`, from
/// the condition that the displacement is uniform there.
#[test]
fn an_elastic_plateau_is_a_flat_punch() {
    let rubber = Rubber::elastic(3e6, 0.5);
    // The pressure is singular at the edges, which a grid puts within a spacing of where they are.
    for (points, tolerance) in [(1024, 1e-3), (16384, 7e-5)] {
        let mut case = Case::new(
            "plateau, elastic",
            format!("{points} points"),
            "pressure of a flat punch in its middle half",
        );
        let profile = plateaus(points, 1, 0.5);
        // Low enough for the valley to stay open.
        let (p, width) = (1e2, points / 2);
        let solution = contact(&rubber, &profile).solve(p).unwrap();
        case.solved(&solution);
        case.conditioned(grid_condition(&rubber, 0.01, &profile));
        assert_eq!(solution.pressure.iter().filter(|t| **t > 0.0).count(), width);
        let half_angle = 0.5 * PI * width as f64 / points as f64;
        for i in width / 4..3 * width / 4 {
            let angle = PI * (i as f64 - 0.5 * (width as f64 - 1.0)) / points as f64;
            let root = (half_angle.sin().powi(2) - angle.sin().powi(2)).sqrt();
            case.agrees(solution.pressure[i], p * angle.cos() / root, tolerance);
        }
        case.enter();
    }
}

#[test]
fn plateaus_of_one_height_share_the_load_as_lemke_says() {
    let mut case = Case::new("1, 4 and 7 equal plateaus, lossy", "252 points", "Lemke");
    for count in [1, 4, 7] {
        for share in [0.1, 0.5] {
            for depth in [1e-3, 0.5, 1.5, 4.0] {
                let profile = plateaus(252, count, share);
                case.compare_with_lemke(&table_2_1(), 0.01, &profile, depth);
            }
        }
    }
    case.enter();
}

/// Five equal waves are one wave five times over: a grid of a fifth of the period has the same
/// contact. Five periods are no power of two, so that the nested grids of the two differ.
#[test]
fn equal_peaks_carry_equal_loads() {
    let rubber = table_2_1();
    let one = superposed(&[0.0], 800);
    let five = Profile { period: 5.0 * one.period, heights: one.heights.repeat(5) };
    let mut case =
        Case::new("5 exactly equal peaks", "4000 points, area 0.002 to 0.9", "one of them alone");
    let (mut alone, mut together) = (contact(&rubber, &one), contact(&rubber, &five));
    case.conditioned(grid_condition(&rubber, 0.01, &five));
    for p in [1e3, 1e5, 1e6, 4e6] {
        let (a, b) = (alone.solve(p).unwrap(), together.solve(p).unwrap());
        case.solved(&a);
        case.solved(&b);
        // Pressures of a residual of 1e-10, amplified by the 100 points of a contact.
        case.agrees(b.contact_area_fraction, a.contact_area_fraction, 1e-8);
        case.agrees(b.friction_coefficient, a.friction_coefficient, 1e-8);
        case.agrees(b.mean_separation, a.mean_separation, 1e-8);
        let largest = a.pressure.iter().copied().fold(0.0, f64::max);
        for (i, t) in b.pressure.iter().enumerate() {
            case.differs((t - a.pressure[i % 800]).abs() / largest, 1e-8);
        }
    }
    case.enter();
}

/// A tie broken by less than the residual can see does not matter.
#[test]
fn peaks_that_differ_by_a_rounding_error_carry_equal_loads() {
    let rubber = table_2_1();
    let mut heights = vec![0.0; 300];
    (heights[50], heights[200]) = (1e-6, 1e-6 * (1.0 + f64::EPSILON));
    let profile = Profile { period: 1e-3, heights };
    let mut case = Case::new(
        "two spikes that differ by 2e-16",
        "300 points, 1 Pa to 1 kPa",
        "equal halves of N p",
    );
    let mut contact = contact(&rubber, &profile);
    case.conditioned(grid_condition(&rubber, 0.01, &profile));
    for p in [1.0, 10.0, 1e3] {
        let solution = contact.solve(p).unwrap();
        case.solved(&solution);
        let [a, b] = [solution.pressure[50], solution.pressure[200]];
        // A height of 2e-22 m over a displacement of at least 3e-12 m, both spikes alone.
        case.agrees(a, b, 1e-9);
    }
    case.enter();
}
