//! Extruded profiles, and symmetries of the plane.

use super::*;
use crate::contact::SlidingContact;
use std::f64::consts::FRAC_PI_2;

fn profile(n: usize) -> Vec<f64> {
    waves([n, 1], &[(1.0, 0.0, 3e-5, 0.3), (3.0, 0.0, 1e-5, 1.0), (8.0, 0.0, 3e-6, 2.0)])
}

#[test]
fn an_extruded_profile_is_the_contact_of_its_line() {
    let rubber = Rubber::table_2_1();
    for (nx, ny, speed, pressure) in
        [(256, 8, 0.01, 1e6), (256, 8, 10.0, 2e7), (135, 7, 0.3, 3e5), (256, 2, -0.05, 1e5)]
    {
        let line = profile(nx);
        let heights: Vec<f64> = (0..ny).flat_map(|_| line.clone()).collect();
        let expected =
            SlidingContact::new(&rubber, speed, 1e-3, &line).unwrap().solve(pressure).unwrap();
        let mut areal = contact(&rubber, speed, 0.0, &heights, [nx, ny], [1e-3, 0.4e-3]);
        let found = areal.solve(pressure).unwrap();
        assert_complementary(&found);
        assert!(expected.contact_area_fraction < 0.9, "{}", expected.contact_area_fraction);
        for (a, b) in [
            (found.friction_coefficient, expected.friction_coefficient),
            (found.hysteretic_friction, expected.hysteretic_friction),
            (found.mean_separation, expected.mean_separation),
        ] {
            approx::assert_relative_eq!(a, b, max_relative = 1e-10);
        }
        // Read from few pressures next to the edges, which amplify the tolerance of the solve.
        let area = (found.contact_area_fraction, expected.contact_area_fraction);
        approx::assert_relative_eq!(area.0, area.1, max_relative = 1e-8);
        assert!(found.lateral_coefficient.abs() < 1e-12);
        let highest = expected.pressure.iter().fold(0.0_f64, |a, t| a.max(*t));
        for (i, t) in found.pressure.iter().enumerate() {
            let line = expected.pressure[i % nx];
            assert!((t - line).abs() < 1e-8 * highest, "{i}: {t} {line}");
        }
    }
}

#[test]
fn turning_surface_and_velocity_together_changes_nothing() {
    let rubber = Rubber::table_2_1();
    let [nx, ny] = [48, 40];
    let heights = rough([nx, ny], 5, 0.3);
    let (speed, angle, pressure) = (0.05, 0.4, 3e5);
    let straight =
        contact(&rubber, speed, angle, &heights, [nx, ny], [1e-3, 0.8e-3]).solve(pressure).unwrap();
    // A quarter turn: the point (i, j) goes to (-j, i).
    let mut turned = vec![0.0; nx * ny];
    for j in 0..ny {
        for i in 0..nx {
            turned[i * ny + (ny - j) % ny] = heights[j * nx + i];
        }
    }
    let turned = contact(&rubber, speed, angle + FRAC_PI_2, &turned, [ny, nx], [0.8e-3, 1e-3])
        .solve(pressure)
        .unwrap();
    // Mirrored at the diagonal: x and y change places.
    let mut mirrored = vec![0.0; nx * ny];
    for j in 0..ny {
        for i in 0..nx {
            mirrored[i * ny + j] = heights[j * nx + i];
        }
    }
    let mirrored = contact(&rubber, speed, FRAC_PI_2 - angle, &mirrored, [ny, nx], [0.8e-3, 1e-3])
        .solve(pressure)
        .unwrap();
    assert!(straight.contact_area_fraction > 0.02 && straight.contact_area_fraction < 0.9);
    assert!(straight.lateral_coefficient.abs() > 1e-4);
    for (other, side) in [(&turned, 1.0), (&mirrored, -1.0)] {
        for (a, b) in [
            (other.friction_coefficient, straight.friction_coefficient),
            (other.hysteretic_friction, straight.hysteretic_friction),
            (side * other.lateral_coefficient, straight.lateral_coefficient),
            (other.points_in_contact, straight.points_in_contact),
        ] {
            approx::assert_relative_eq!(a, b, max_relative = 1e-8);
        }
        let areas = (other.contact_area_fraction, straight.contact_area_fraction);
        approx::assert_relative_eq!(areas.0, areas.1, max_relative = 1e-6);
    }
}

#[test]
fn sliding_back_and_forth_on_a_mirrored_surface_is_the_same() {
    let rubber = Rubber::table_2_1();
    let points = [36, 36];
    let heights = rough(points, 5, 0.3);
    // Both axes reversed is half a turn.
    let reversed: Vec<f64> = (0..points[0] * points[1])
        .map(|k| {
            let (i, j) = (k % 36, k / 36);
            heights[(36 - j) % 36 * 36 + (36 - i) % 36]
        })
        .collect();
    let solve = |speed, angle, heights: &[f64]| {
        contact(&rubber, speed, angle, heights, points, [1e-3, 1e-3]).solve(1e6).unwrap()
    };
    let forth = solve(0.02, 0.7, &heights);
    for back in [solve(-0.02, 0.7, &reversed), solve(0.02, 0.7 + 2.0 * FRAC_PI_2, &reversed)] {
        let friction = (back.hysteretic_friction.abs(), forth.hysteretic_friction);
        approx::assert_relative_eq!(friction.0, friction.1, max_relative = 1e-8);
        approx::assert_relative_eq!(
            back.mean_separation,
            forth.mean_separation,
            max_relative = 1e-8
        );
    }
}
