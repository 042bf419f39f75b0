//! Areal contacts with known solutions.
//!
//! | module | what it compares with |
//! |---|---|
//! | `elastic` | Hertz, Johnson, Tamaas |
//! | `full` | full contact, exact at any angle |
//! | `lines` | the line solver on extruded profiles; symmetries |
//! | `hard` | nothing: extreme numbers, and input that has to be refused |

mod elastic;
mod full;
mod hard;
mod lines;

use super::*;
use crate::rubber::{Rubber, Viscoelastic};
use std::f64::consts::TAU;

/// Heights of a sum of waves `(m, n, amplitude, phase)` with `m` periods along `x` and `n` along `y`.
fn waves(points: [usize; 2], waves: &[(f64, f64, f64, f64)]) -> Vec<f64> {
    let mut heights = Vec::with_capacity(points[0] * points[1]);
    for j in 0..points[1] {
        for i in 0..points[0] {
            let (x, y) = (i as f64 / points[0] as f64, j as f64 / points[1] as f64);
            let wave = |(m, n, amplitude, phase): &(f64, f64, f64, f64)| {
                amplitude * (TAU * (m * x + n * y) + phase).sin()
            };
            heights.push(waves.iter().map(wave).sum());
        }
    }
    heights
}

/// Waves of a self-affine spectrum with random phases, up to `highest` periods, with a root mean square slope of about
/// `slope` on a period of 1 mm.
fn rough(points: [usize; 2], highest: i32, slope: f64) -> Vec<f64> {
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut list = Vec::new();
    for m in 0..=highest {
        for n in -highest..=highest {
            let k = f64::from(m).hypot(f64::from(n));
            if k > 0.0 && k <= f64::from(highest) && (m > 0 || n > 0) {
                list.push((f64::from(m), f64::from(n), k.powf(-1.8), TAU * random()));
            }
        }
    }
    let variance: f64 =
        list.iter().map(|(m, n, a, _)| 0.5 * (TAU * 1e3 * m.hypot(*n) * a).powi(2)).sum();
    list.iter_mut().for_each(|wave| wave.2 *= slope / variance.sqrt());
    waves(points, &list)
}

fn contact(
    rubber: &dyn Viscoelastic,
    speed: f64,
    angle: f64,
    heights: &[f64],
    points: [usize; 2],
    periods: [f64; 2],
) -> ArealContact {
    let sliding = Sliding { speed, angle };
    let surface = ArealSurface { heights, points, periods };
    let setup = ArealSetup { rubber, sliding, surface, thickness: None, memory_limit: None };
    ArealContact::new(&setup).unwrap()
}

/// Complementarity of pressures and gaps, of which `u t = 0` and `t >= 0` hold point by point.
fn assert_complementary(solution: &ArealSolution) {
    let mean = solution.pressure.iter().sum::<f64>() / solution.pressure.len() as f64;
    approx::assert_relative_eq!(mean, solution.mean_pressure, max_relative = 1e-10);
    assert!(solution.residual <= 1e-10);
    // In full contact of heights of some micrometres the separations are round-off.
    let scale = solution.separation.iter().fold(1e-9_f64, |a, u| a.max(u.abs()));
    let highest = solution.pressure.iter().fold(0.0_f64, |a, t| a.max(*t));
    for (t, u) in solution.pressure.iter().zip(&solution.separation) {
        assert!(*t >= 0.0 && *u >= -1e-9 * scale, "{t} {u}");
        assert!((t * u).abs() <= 1e-9 * scale * highest, "{t} {u}");
    }
}
