//! Against a dense interior-point solution of the same conditions.

use super::*;
use nalgebra::{DMatrix, DVector};

/// Displacement at point `j` by a unit pressure at point 0, wave by wave.
fn kernel(rubber: &Rubber, speed: f64, period: f64, points: usize) -> Vec<f64> {
    let wave = |k: usize, j: usize| {
        let q = TAU * k as f64 / period;
        let relative = 2.0 * k as f64 / points as f64;
        let modulus = rubber.reduced_modulus(q * speed);
        let lag = -modulus.arg() * (FRAC_PI_2 * relative.powi(2)).cos().powi(2);
        let both_signs = if 2 * k == points { 1.0 } else { 2.0 };
        let angle = TAU * ((k * j) % points) as f64 / points as f64;
        both_signs * 2.0 / (q * modulus.norm()) * (angle + lag).cos()
    };
    (0..points).map(|j| (1..=points / 2).map(|k| wave(k, j)).sum::<f64>() / points as f64).collect()
}

/// Dense interior-point solution of `y = ubar + A p - z - g(p) >= 0`, `p >= 0`, `y p = 0` at the
/// given mean of `p`: pressures and `ubar`.
fn interior_point(
    kernel: &[f64],
    heights: &[f64],
    law: &LocalLaw,
    mean: f64,
) -> (DVector<f64>, f64) {
    let n = heights.len();
    let mut p = DVector::from_element(n, mean);
    let length = heights.iter().fold(0.0_f64, |a, z| a.max(z.abs()));
    let mut y = DVector::from_element(n, length);
    let mut ubar = law.touch_separation();
    let matrix = DMatrix::from_fn(n, n, |i, j| kernel[(n + i - j) % n]);
    for _ in 0..300 {
        let w = &matrix * &p;
        let barrier = 0.1 * p.dot(&y) / n as f64;
        let mut jacobian = DMatrix::zeros(n + 1, n + 1);
        let mut rhs = DVector::zeros(n + 1);
        for i in 0..n {
            // y + dy = barrier / p - (y / p) dp, put into the linearised gap.
            let gap = ubar + w[i] - heights[i] - law.separation(p[i]).unwrap();
            rhs[i] = barrier / p[i] - gap;
            for j in 0..n {
                jacobian[(i, j)] = matrix[(i, j)];
            }
            jacobian[(i, i)] += y[i] / p[i] - law.slope(p[i]).unwrap();
            jacobian[(i, n)] = 1.0;
            jacobian[(n, i)] = 1.0 / n as f64;
        }
        rhs[n] = mean - p.mean();
        let step = jacobian.lu().solve(&rhs).unwrap();
        let dp = step.rows(0, n).into_owned();
        let dy = DVector::from_fn(n, |i, _| barrier / p[i] - y[i] - y[i] / p[i] * dp[i]);
        let share = (0..n).fold(1.0_f64, |share, i| {
            let limit = |x: f64, dx: f64| if dx < 0.0 { -0.9 * x / dx } else { 1.0 };
            share.min(limit(p[i], dp[i])).min(limit(y[i], dy[i]))
        });
        p += share * &dp;
        y += share * &dy;
        ubar += share * step[n];
        if share > 0.89 && barrier < 1e-17 * mean * length {
            return (p, ubar);
        }
    }
    panic!("the interior point did not settle");
}

#[test]
fn pressures_agree_with_a_dense_interior_point() {
    let rubber = Rubber::table_2_1();
    for points in [64, 95, 128] {
        let heights = two_waves(points);
        let mean_height = heights.iter().sum::<f64>() / points as f64;
        let centred: Vec<f64> = heights.iter().map(|z| z - mean_height).collect();
        for (speed, full) in [(1e-3, 5e6), (1e-2, 9e6), (1.0, 1.6e8)] {
            let kernel = kernel(&rubber, speed, 0.25e-3, points);
            for p in [0.003 * full, 0.1 * full, 0.6 * full] {
                for law in
                    [westergaard(1.867e-5, full, 25), linear(2e-5, 1e-6 / full, 100.0 * full)]
                {
                    let (dense, ubar) = interior_point(&kernel, &centred, &law, p);
                    let mut contact =
                        SoftContact::new(&rubber, speed, 0.25e-3, &heights, law).unwrap();
                    let solution = contact.solve(p).unwrap();
                    let worst = (0..points)
                        .map(|i| (dense[i] - solution.pressure[i]).abs())
                        .fold(0.0_f64, f64::max);
                    // The barrier ends at 1e-17 of pressure times height: a point at which
                    // pressure and gap both vanish keeps the root of it.
                    assert!(worst < 1e-7 * dense.max(), "{points} {speed} {p}: {worst:e}");
                    approx::assert_abs_diff_eq!(
                        solution.mean_separation,
                        ubar,
                        epsilon = 1e-8 * 3e-5
                    );
                }
            }
        }
    }
}
