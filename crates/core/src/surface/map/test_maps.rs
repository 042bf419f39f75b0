//! Maps that tests share.

use super::HeightMap;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// Heights `z(x, y)` on a grid.
pub(super) fn map(points: [usize; 2], spacing: [f64; 2], z: impl Fn(f64, f64) -> f64) -> HeightMap {
    let [nx, ny] = points;
    let at = |n: usize| z((n % nx) as f64 * spacing[0], (n / nx) as f64 * spacing[1]);
    HeightMap { name: "07".into(), points, spacing, heights: (0..nx * ny).map(at).collect() }
}

/// Independent heights, uniform between -0.4 and 0.6.
pub(super) fn noise(points: [usize; 2], spacing: [f64; 2], seed: u64) -> HeightMap {
    let mut generator = Pcg64::seed_from_u64(seed);
    let mut map = map(points, spacing, |_, _| 0.0);
    map.heights.iter_mut().for_each(|z| *z = generator.random::<f64>() - 0.4);
    map
}

/// A periodic Gaussian surface, `n` points in each direction `spacing` apart, with the given density `C(qx, qy)` in m⁴
/// (even in q): with the amplitudes of Gaussian numbers, or the expected ones and random phases alone.
pub(super) fn gaussian(
    n: usize,
    spacing: [f64; 2],
    density: impl Fn(f64, f64) -> f64,
    random_amplitudes: bool,
    seed: u64,
) -> HeightMap {
    let mut generator = Pcg64::seed_from_u64(seed);
    let step = spacing.map(|d| TAU / (n as f64 * d));
    let signed = |k: usize| if 2 * k > n { k as f64 - n as f64 } else { k as f64 };
    let mut field = vec![Complex64::ZERO; n * n];
    // A real field needs a(-q) to be the conjugate of a(q); q = 0 and the Nyquist wavenumbers stay empty.
    for l in 0..n {
        for k in 0..n {
            let opposite = ((n - l) % n) * n + (n - k) % n;
            let here = l * n + k;
            if here >= opposite || 2 * k == n || 2 * l == n {
                continue;
            }
            let power = density(signed(k) * step[0], signed(l) * step[1]) * step[0] * step[1];
            let share =
                if random_amplitudes { -(1.0 - generator.random::<f64>()).ln() } else { 1.0 };
            field[here] =
                Complex64::from_polar((power * share).sqrt(), TAU * generator.random::<f64>());
            field[opposite] = field[here].conj();
        }
    }
    let plan = FftPlanner::new().plan_fft_inverse(n);
    for _ in 0..2 {
        field.chunks_exact_mut(n).for_each(|row| plan.process(row));
        field = (0..n * n).map(|i| field[(i % n) * n + i / n]).collect();
    }
    let heights = field.iter().map(|z| z.re).collect();
    HeightMap { name: "07".into(), points: [n; 2], spacing, heights }
}

/// Marks about one in `one_in` points as missing, and a rectangle.
pub(super) fn with_gaps(mut map: HeightMap, one_in: usize) -> HeightMap {
    let [nx, _] = map.points;
    for n in 0..map.heights.len() {
        let (i, j) = (n % nx, n / nx);
        if (n * 7919 + 13) % (one_in * 31) < 31 || ((3..6).contains(&i) && (2..8).contains(&j)) {
            map.heights[n] = f64::NAN;
        }
    }
    map
}
