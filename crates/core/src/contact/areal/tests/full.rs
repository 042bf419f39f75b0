//! Full contact, where everything is known in closed form.

use super::*;
use crate::rubber::MaxwellBranch;

/// Friction of the wave `z = D sin(q · r)` in full contact: `q_s |q| D² E''(q_s v) / (4 (1-ν²) p)`.
fn exact_friction(
    rubber: &Rubber,
    (m, n, amplitude): (f64, f64, f64),
    periods: [f64; 2],
    sliding: Sliding,
    pressure: f64,
) -> f64 {
    let [qx, qy] = [TAU * m / periods[0], TAU * n / periods[1]];
    let along = qx * sliding.angle.cos() + qy * sliding.angle.sin();
    let loss = rubber.reduced_modulus(along * sliding.speed).im;
    along * qx.hypot(qy) * amplitude.powi(2) * loss / (4.0 * pressure)
}

#[test]
fn one_wave_at_any_angle_has_its_friction_to_ten_digits() {
    let rubber = Rubber::table_2_1();
    let (amplitude, pressure) = (2e-6, 1e9);
    for (m, n) in [(1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (0.0, 1.0), (1.0, 3.0)] {
        // So many points that the taper of the highest waves, (π²/4) (2 m/nx)^4, is below 2e-11.
        let count = |k: f64| if k == 0.0 { 4 } else { (2.0 * k * 600.0) as usize };
        let points = [count(m), count(n)];
        for (angle, periods) in [(0.0, [1e-3, 1e-3]), (0.3, [1e-3, 1.7e-3]), (-2.0, [2e-3, 1e-3])] {
            let heights = waves(points, &[(m, n, amplitude, 0.7)]);
            let sliding = Sliding { speed: 0.01, angle };
            let mut areal = contact(&rubber, 0.01, angle, &heights, points, periods);
            let solution = areal.solve(pressure).unwrap();
            let exact = exact_friction(&rubber, (m, n, amplitude), periods, sliding, pressure);
            for found in [solution.friction_coefficient, solution.hysteretic_friction] {
                // Across the waves nothing is left but round-off of the slopes.
                let error = (found - exact).abs();
                assert!(
                    error <= 1e-10 * exact.abs() + 1e-17,
                    "{m} {n} {angle}: {found:e} {exact:e}"
                );
            }
            assert_eq!(solution.contact_area_fraction, 1.0);
            assert_eq!(solution.mean_separation, 0.0);
        }
    }
}

#[test]
fn frictions_of_waves_in_full_contact_add_up() {
    let rubber = Rubber {
        name: "one branch".into(),
        equilibrium_modulus: 2e6,
        branches: vec![MaxwellBranch { modulus: 2e10, relaxation_time: 1e-4 }],
        poisson_ratio: 0.45,
        finite_strain: Default::default(),
    };
    // Slow convergence with the fourth power of points a wave: 2e-5 of that of (3, 2).
    let points = [180, 150];
    let list = [(1.0, 0.0, 3e-6, 0.1), (2.0, -1.0, 1e-6, 0.4), (3.0, 2.0, 5e-7, 0.9)];
    let heights = waves(points, &list);
    let (periods, pressure) = ([1e-3, 0.9e-3], 1e9);
    let sliding = Sliding { speed: 0.1, angle: 0.3 };
    let found = contact(&rubber, 0.1, 0.3, &heights, points, periods).solve(pressure).unwrap();
    let exact: f64 = list
        .iter()
        .map(|(m, n, a, _)| exact_friction(&rubber, (*m, *n, *a), periods, sliding, pressure))
        .sum();
    approx::assert_relative_eq!(found.friction_coefficient, exact, max_relative = 2e-5);
    let (work, power) = (found.friction_coefficient, found.hysteretic_friction);
    approx::assert_relative_eq!(work, power, max_relative = 1e-11);
}

/// For waves of one modulus of loss an isotropic surface has `G(H) G(H+1) / G(H+1/2)²` times the friction of its cuts.
#[test]
fn an_isotropic_surface_has_more_friction_than_its_cuts_by_the_ratio_of_theory() {
    // Loss E''(ω) ∝ ω, far below the one relaxation: friction of a wave (m, n) is ∝ m² |q| D².
    let rubber = Rubber {
        name: "dashpot".into(),
        equilibrium_modulus: 1e6,
        branches: vec![MaxwellBranch { modulus: 1e6, relaxation_time: 1e-9 }],
        poisson_ratio: 0.5,
        finite_strain: Default::default(),
    };
    let friction = |list: &[(f64, f64, f64, f64)], points: [usize; 2]| {
        let heights = waves(points, list);
        let mut areal = contact(&rubber, 0.01, 0.0, &heights, points, [1e-3, 1e-3]);
        areal.solve(1e8).unwrap().friction_coefficient
    };
    let hurst = 0.8;
    // All waves with 4 periods along x: their sum over y is the cut's. Per frequency the ratio is that of the sums
    // of |q| C and q_x C over q_y; the spectrum C ~ |q|^(-2-2H) is summed as far as the grid goes.
    let list: Vec<_> = (-40..=40)
        .map(|n| {
            let q = 4.0_f64.hypot(f64::from(n));
            (4.0, f64::from(n), 1e-7 * q.powf(-1.0 - hurst), f64::from(n * n))
        })
        .collect();
    let cut = list.iter().map(|wave| wave.2.powi(2)).sum::<f64>().sqrt();
    let points = [64, 2048];
    let ratio = friction(&list, points) / friction(&[(4.0, 0.0, cut, 0.0)], points);
    // What is left out beyond 40 periods: a part (4/40)^(2H) of the one sum, and sums for integrals.
    approx::assert_relative_eq!(ratio, 1.3463, max_relative = 2e-2);
}

#[test]
fn a_layer_compresses_and_is_stiffer_than_the_half_space() {
    let rubber = Rubber::elastic(3e6, 0.3);
    let points = [32, 24];
    let heights = waves(points, &[(1.0, 0.0, 1e-6, 0.0)]);
    let solve = |thickness| {
        let surface = ArealSurface { heights: &heights, points, periods: [1e-3, 1e-3] };
        let sliding = Sliding { speed: 0.0, angle: 0.0 };
        let setup = ArealSetup { rubber: &rubber, sliding, surface, thickness, memory_limit: None };
        ArealContact::new(&setup).unwrap().solve(1e6).unwrap()
    };
    let deviation = |s: &ArealSolution| s.pressure.iter().fold(0.0_f64, |a, t| a.max(t - 1e6));
    let half_space = solve(None);
    assert_eq!(half_space.mean_compression, 0.0);
    let stiffness = 0.5 * TAU / 1e-3 * 3e6 / (1.0 - 0.09);
    // 24 points along y and 32 along x hold a crest of the wave.
    approx::assert_relative_eq!(deviation(&half_space), stiffness * 1e-6, max_relative = 1e-12);
    let thickness = 1e-3 / TAU;
    let layer = solve(Some(thickness));
    let (nu, x) = (0.3_f64, 1.0_f64);
    let factor = ((3.0 - 4.0 * nu) * (2.0 * x).sinh() - 2.0 * x)
        / ((3.0 - 4.0 * nu) * (2.0 * x).cosh() + 2.0 * x * x + 5.0 - 12.0 * nu + 8.0 * nu * nu);
    approx::assert_relative_eq!(deviation(&layer), stiffness * 1e-6 / factor, max_relative = 1e-12);
    // Oedometer: M = E (1-ν) / ((1+ν)(1-2ν)).
    let oedometric = 3e6 * 0.7 / (1.3 * 0.4);
    let compression = 1e6 * thickness / oedometric;
    approx::assert_relative_eq!(layer.mean_compression, compression, max_relative = 1e-12);
}
