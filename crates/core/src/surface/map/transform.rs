//! Fourier transforms of real fields over a plane, padded with zeros, in two steps: rows, then columns.
//!
//! What is done with a column is done while it is in the cache, and only what is kept of it is stored: the padded plane
//! itself is never held.

use rayon::prelude::*;
use realfft::RealFftPlanner;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;

/// Columns that one task transforms together: eight complex numbers fill two cache lines, so that the rows are read in
/// whole cache lines.
const BLOCK: usize = 8;

/// Transforms of the rows of a field of `points` values `value(j * nx + i)`, each row padded to `length` with zeros:
/// `ny` rows of `length / 2 + 1` coefficients.
pub(super) fn transform_rows(
    [nx, ny]: [usize; 2],
    length: usize,
    value: impl Fn(usize) -> f64 + Sync,
) -> Vec<Complex64> {
    let plan = RealFftPlanner::new().plan_fft_forward(length);
    let bins = length / 2 + 1;
    let mut rows = vec![Complex64::ZERO; bins * ny];
    rows.par_chunks_mut(bins).enumerate().for_each_init(
        || (plan.make_input_vec(), plan.make_scratch_vec()),
        |(input, scratch), (j, row)| {
            input[..nx].iter_mut().enumerate().for_each(|(i, slot)| *slot = value(j * nx + i));
            input[nx..].fill(0.0);
            plan.process_with_scratch(input, row, scratch).expect("buffers come from the plan");
        },
    );
    rows
}

/// Transforms the columns of fields whose rows are transformed, each padded to `length` with zeros, and hands them on:
/// `finish(k, columns, kept)` gets the columns `k` of all fields one after the other and fills the part of `output`
/// that belongs to `k`, one of `bins` equal parts.
pub(super) fn transform_columns<T: Send>(
    fields: &[Vec<Complex64>],
    bins: usize,
    length: usize,
    output: &mut [T],
    finish: impl Fn(usize, &mut [Complex64], &mut [T]) + Sync,
) {
    let plan = FftPlanner::new().plan_fft_forward(length);
    let (kept, each) = (output.len() / bins, fields.len() * length);
    output.par_chunks_mut(kept * BLOCK).enumerate().for_each_init(
        || {
            (
                vec![Complex64::ZERO; BLOCK * each],
                vec![Complex64::ZERO; plan.get_inplace_scratch_len()],
            )
        },
        |(columns, scratch), (block, output)| {
            let first = block * BLOCK;
            let count = output.len() / kept;
            columns.fill(Complex64::ZERO);
            for (f, field) in fields.iter().enumerate() {
                for (j, row) in field.chunks_exact(bins).enumerate() {
                    for (c, value) in row[first..first + count].iter().enumerate() {
                        columns[c * each + f * length + j] = *value;
                    }
                }
            }
            let own = columns.chunks_exact_mut(each).zip(output.chunks_exact_mut(kept));
            for (c, (columns, output)) in own.enumerate() {
                plan.process_with_scratch(columns, scratch);
                finish(first + c, columns, output);
            }
        },
    );
}

/// Inverse transforms along `x` of columns that are transformed back along `y`: real rows of `length` values, not
/// normalised. `columns` holds `stride` values for each of the `length / 2 + 1` wavenumbers along `x`; the rows are made
/// of those from `offset` on, one row after the other. `finish(row, kept)` fills the part of `output`, `kept` long, that
/// belongs to the row.
pub(super) fn invert_rows(
    columns: &[Complex64],
    [offset, stride]: [usize; 2],
    length: usize,
    kept: usize,
    output: &mut [f64],
    finish: impl Fn(&[f64], &mut [f64]) + Sync,
) {
    let plan = RealFftPlanner::new().plan_fft_inverse(length);
    let bins = length / 2 + 1;
    output.par_chunks_mut(kept * BLOCK).enumerate().for_each_init(
        || (vec![Complex64::ZERO; bins * BLOCK], plan.make_output_vec(), plan.make_scratch_vec()),
        |(lines, values, scratch), (block, output)| {
            let (first, count) = (offset + block * BLOCK, output.len() / kept);
            for k in 0..bins {
                let column = &columns[k * stride + first..][..count];
                for (r, value) in column.iter().enumerate() {
                    lines[r * bins + k] = *value;
                }
            }
            for (line, kept) in lines.chunks_exact_mut(bins).zip(output.chunks_exact_mut(kept)) {
                // Real for a real field: round-off alone, which realfft refuses.
                line[0].im = 0.0;
                if length.is_multiple_of(2) {
                    line[bins - 1].im = 0.0;
                }
                plan.process_with_scratch(line, values, scratch)
                    .expect("buffers come from the plan");
                finish(values, kept);
            }
        },
    );
}
