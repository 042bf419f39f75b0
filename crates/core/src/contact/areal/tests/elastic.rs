//! Elastic contacts with known solutions.

use super::*;
use std::f64::consts::{PI, SQRT_2};

const MODULUS: f64 = 4e6;

fn elastic() -> Rubber {
    Rubber::elastic(MODULUS * 0.75, 0.5)
}

/// One paraboloid of radius 1 mm a period of 1 mm.
fn paraboloid(n: usize) -> Vec<f64> {
    // The crest lies between points, so that no symmetry of the grid helps.
    let from_crest = |i: usize| (i as f64 / n as f64 - 0.5123) * 1e-3;
    let height = |k: usize| -(from_crest(k % n).powi(2) + from_crest(k / n).powi(2)) / 2e-3;
    (0..n * n).map(height).collect()
}

#[test]
fn a_small_contact_of_a_paraboloid_converges_to_hertz() {
    // a³ = 3 F R / (4 E_r); the images a period away change a by less than (a/L)³ / 2 = 3e-4.
    let radius = 0.08e-3_f64;
    let pressure = 4.0 / 3.0 * MODULUS * radius.powi(3) / 1e-3 / 1e-6;
    let area = PI * radius.powi(2) / 1e-6;
    for n in [64, 128, 256] {
        let heights = paraboloid(n);
        let mut hertz = contact(&elastic(), 0.0, 0.0, &heights, [n, n], [1e-3, 1e-3]);
        let solution = hertz.solve(pressure).unwrap();
        assert_complementary(&solution);
        let error = (solution.contact_area_fraction / area - 1.0).abs();
        // Edges at odd angles to the grid are read with an error of up to 0.02 steps.
        let step = 1e-3 / n as f64;
        assert!(error < 2.0 * 0.02 * step / radius, "{n}: {error:e}");
        assert!(error < solution.contact_area_error / area, "{n}: {error:e}");
        let relative = 0.2 * (step / radius).powi(2) + 1e-3;
        // p_max = 3 F / (2 π a²)
        let highest = solution.pressure.iter().fold(0.0_f64, |a, t| a.max(*t));
        let exact = 1.5 * pressure * 1e-6 / (PI * radius.powi(2));
        assert!((highest / exact - 1.0).abs() < relative, "{n}: {}", highest / exact);
    }
}

#[test]
fn two_crossed_waves_are_in_full_contact_from_johnsons_pressure_on() {
    // z = D cos(2πx/λ) cos(2πy/λ): two waves of half the amplitude along the diagonals.
    // With z = Δ/2 (cos + cos) of Johnson turned by 45°: p* = π E_r Δ √2/λ_diagonal.
    let n = 48;
    let amplitude = 1e-5;
    let list = [(1.0, 1.0, 0.5 * amplitude, PI / 2.0), (1.0, -1.0, 0.5 * amplitude, PI / 2.0)];
    let heights = waves([n, n], &list);
    let mut contact = contact(&elastic(), 0.0, 0.0, &heights, [n, n], [1e-3, 1e-3]);
    let exact = SQRT_2 * PI * MODULUS * amplitude / 1e-3;
    let found = contact.smallest_full_contact_pressure();
    approx::assert_relative_eq!(found, exact, max_relative = 1e-12);
    let full = contact.solve(exact * (1.0 + 1e-9)).unwrap();
    assert_eq!(full.contact_area_fraction, 1.0);
    let nearly = contact.solve(exact * 0.999).unwrap();
    assert_complementary(&nearly);
    assert!(nearly.points_in_contact < 1.0);
    // The last gaps close as penny-shaped cracks do (Johnson, Greenwood & Higginson 1985,
    // doi:10.1016/0020-7403(85)90105-0): A = 1 - 3/(2π) (1 - p/p*), here within a twentieth for the next order and
    // the grid.
    let n = 192;
    let heights = waves([n, n], &list);
    let mut fine = super::contact(&elastic(), 0.0, 0.0, &heights, [n, n], [1e-3, 1e-3]);
    for part in [0.9, 0.97] {
        let gap = 1.0 - fine.solve(part * exact).unwrap().contact_area_fraction;
        approx::assert_relative_eq!(gap, 1.5 / PI * (1.0 - part), max_relative = 0.05);
    }
}
