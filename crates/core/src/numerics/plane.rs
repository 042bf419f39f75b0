//! Fourier transform of real fields over a plane, on a grid and on all threads of rayon.

use rayon::prelude::*;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// Lines that one task transforms together: eight complex numbers fill two cache lines, so that a transposition reads
/// whole cache lines.
const BLOCK: usize = 8;

/// Transform of `nx` by `ny` real values, `x` fastest, to the `nx/2 + 1` by `ny` coefficients with wavenumbers
/// `k_x >= 0`, `y` fastest, and back. It owns its buffers, so that an application allocates little.
pub(crate) struct Transform {
    nx: usize,
    ny: usize,
    row_forward: Arc<dyn RealToComplex<f64>>,
    row_backward: Arc<dyn ComplexToReal<f64>>,
    column_forward: Arc<dyn Fft<f64>>,
    column_backward: Arc<dyn Fft<f64>>,
    /// Values on the grid; the forward transform destroys them.
    pub real: Vec<f64>,
    /// Transformed rows, `k_x` fastest.
    rows: Vec<Complex64>,
    /// Coefficients, `k_y` fastest.
    pub spectrum: Vec<Complex64>,
}

impl Transform {
    pub fn new([nx, ny]: [usize; 2]) -> Self {
        let mut real_planner = RealFftPlanner::new();
        let mut planner = FftPlanner::new();
        let bins = nx / 2 + 1;
        Self {
            nx,
            ny,
            row_forward: real_planner.plan_fft_forward(nx),
            row_backward: real_planner.plan_fft_inverse(nx),
            column_forward: planner.plan_fft_forward(ny),
            column_backward: planner.plan_fft_inverse(ny),
            real: vec![0.0; nx * ny],
            rows: vec![Complex64::ZERO; bins * ny],
            spectrum: vec![Complex64::ZERO; bins * ny],
        }
    }

    /// Coefficients along `x`.
    pub fn bins(&self) -> usize {
        self.nx / 2 + 1
    }

    /// From `real` to `spectrum`, not normalised.
    pub fn forward(&mut self) {
        self.forward_rows();
        let column_forward = Arc::clone(&self.column_forward);
        self.spectrum_from_rows(|_, column, scratch| {
            column_forward.process_with_scratch(column, scratch);
        });
    }

    /// From `spectrum`, which is destroyed, to `real`, not normalised.
    pub fn backward(&mut self) {
        let column_backward = &self.column_backward;
        let length = column_backward.get_inplace_scratch_len();
        self.spectrum.par_chunks_mut(self.ny).for_each_init(
            || vec![Complex64::ZERO; length],
            |scratch, column| column_backward.process_with_scratch(column, scratch),
        );
        self.backward_rows();
    }

    /// Applies a filter to `real`: `change(k_x, coefficients over k_y)` is called on each column of the spectrum between
    /// the two transforms, while it is in the cache.
    pub fn filter(&mut self, change: impl Fn(usize, &mut [Complex64]) + Sync) {
        self.forward_rows();
        let column_forward = Arc::clone(&self.column_forward);
        let column_backward = Arc::clone(&self.column_backward);
        self.spectrum_from_rows(|bin, column, scratch| {
            column_forward.process_with_scratch(column, scratch);
            change(bin, column);
            column_backward.process_with_scratch(column, scratch);
        });
        self.backward_rows();
    }

    fn forward_rows(&mut self) {
        let (row_forward, bins) = (&self.row_forward, self.bins());
        let lines = self.real.par_chunks_mut(self.nx).zip(self.rows.par_chunks_mut(bins));
        lines.for_each_init(
            || row_forward.make_scratch_vec(),
            |scratch, (values, coefficients)| {
                // Small contacts leave most of the rows empty.
                if values.iter().all(|x| *x == 0.0) {
                    coefficients.fill(Complex64::ZERO);
                } else {
                    row_forward
                        .process_with_scratch(values, coefficients, scratch)
                        .expect("buffers are made for this plan");
                }
            },
        );
    }

    /// Transposes the rows into the spectrum and transforms its columns.
    fn spectrum_from_rows(
        &mut self,
        transform: impl Fn(usize, &mut [Complex64], &mut [Complex64]) + Sync,
    ) {
        let (ny, bins, rows) = (self.ny, self.bins(), &self.rows);
        let scratch = self
            .column_forward
            .get_inplace_scratch_len()
            .max(self.column_backward.get_inplace_scratch_len());
        self.spectrum.par_chunks_mut(ny * BLOCK).enumerate().for_each_init(
            || vec![Complex64::ZERO; scratch],
            |scratch, (block, columns)| {
                let first = block * BLOCK;
                let count = columns.len() / ny;
                for j in 0..ny {
                    let row = &rows[j * bins + first..][..count];
                    for (c, value) in row.iter().enumerate() {
                        columns[c * ny + j] = *value;
                    }
                }
                for (c, column) in columns.chunks_exact_mut(ny).enumerate() {
                    transform(first + c, column, scratch);
                }
            },
        );
    }

    fn backward_rows(&mut self) {
        let (nx, ny, bins) = (self.nx, self.ny, self.bins());
        let (row_backward, spectrum) = (&self.row_backward, &self.spectrum);
        self.real.par_chunks_mut(nx * BLOCK).enumerate().for_each_init(
            || (row_backward.make_scratch_vec(), vec![Complex64::ZERO; bins * BLOCK]),
            |(scratch, lines), (block, rows)| {
                let first = block * BLOCK;
                let count = rows.len() / nx;
                for k in 0..bins {
                    let column = &spectrum[k * ny + first..][..count];
                    for (r, value) in column.iter().enumerate() {
                        lines[r * bins + k] = *value;
                    }
                }
                for (line, values) in lines.chunks_exact_mut(bins).zip(rows.chunks_exact_mut(nx)) {
                    // Real where the symbols are those of real operators: round-off alone, which realfft refuses.
                    line[0].im = 0.0;
                    if nx.is_multiple_of(2) {
                        line[bins - 1].im = 0.0;
                    }
                    row_backward
                        .process_with_scratch(line, values, scratch)
                        .expect("buffers are made for this plan");
                }
            },
        );
    }
}

/// The smallest product of 2, 3 and 5 from `least` on: the lengths at which transforms are fast.
pub(crate) fn fast_length(least: usize) -> usize {
    let is_smooth = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    (least.max(1)..).find(|n| is_smooth(*n)).unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn coefficients_are_those_of_the_sum_on_all_kinds_of_grids() {
        for [nx, ny] in [[8, 8], [9, 7], [12, 5], [7, 16], [1, 6], [6, 1]] {
            let mut transform = Transform::new([nx, ny]);
            let field: Vec<f64> = (0..nx * ny).map(|i| ((i * i) as f64 * 0.37).sin()).collect();
            transform.real.copy_from_slice(&field);
            transform.forward();
            for kx in 0..transform.bins() {
                for ky in 0..ny {
                    let sum: Complex64 = (0..nx * ny)
                        .map(|i| {
                            let phase = (kx * (i % nx)) as f64 / nx as f64
                                + (ky * (i / nx)) as f64 / ny as f64;
                            field[i] * Complex64::from_polar(1.0, -TAU * phase)
                        })
                        .sum();
                    let found = transform.spectrum[kx * ny + ky];
                    // Round-off of a sum of a hundred numbers below one.
                    assert!((found - sum).norm() < 1e-12, "{nx} {ny}: {found} {sum}");
                }
            }
            transform.backward();
            for (back, value) in transform.real.iter().zip(&field) {
                approx::assert_abs_diff_eq!(*back / (nx * ny) as f64, *value, epsilon = 1e-14);
            }
        }
    }

    #[test]
    fn fast_lengths_have_small_factors() {
        let found: Vec<usize> = [0, 1, 7, 8, 11, 97, 1025].map(fast_length).into();
        assert_eq!(found, [1, 1, 8, 8, 12, 100, 1080]);
    }

    #[test]
    fn a_filter_that_keeps_everything_returns_the_field() {
        let mut transform = Transform::new([20, 13]);
        let field: Vec<f64> = (0..260).map(|i| f64::from(i).cos()).collect();
        transform.real.copy_from_slice(&field);
        transform.filter(|_, column| column.iter_mut().for_each(|c| *c /= 260.0));
        for (back, value) in transform.real.iter().zip(&field) {
            approx::assert_abs_diff_eq!(*back, *value, epsilon = 1e-14);
        }
    }
}
