//! Correlation and spectrum of a scan: by FFT and by their definition, against compensated sums.

use super::{Case, Failure, Method, Prepared, Reference};
use asperity::surface::LineScan;
use asperity::surface::correlation::{CorrelationPlan, log_spaced_lags};
use asperity::surface::spectrum::{SpectrumPlan, Window};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// Distance between points in m.
const SPACING: f64 = 1e-6;
/// Lags and wavenumbers at which results are compared, a decade.
const COMPARED_PER_DECADE: usize = 20;
/// A direct sum over all pairs of more points takes seconds.
const DIRECT_POINTS: &[u32] = &[1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14];
const FFT_POINTS: &[u32] =
    &[1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15, 1 << 16, 1 << 17, 1 << 18];

pub(super) const CASES: &[Case] = &[
    Case {
        name: "correlation",
        problem: "height-difference correlation of a random walk at all lags up to half of it",
        reference_text: "compensated direct sum at 20 lags a decade",
        reference: Reference::Exact(compensated_correlation),
        methods: &[
            Method {
                name: "correlation, FFT",
                knob: POINTS,
                values: FFT_POINTS,
                prepare: correlation_by_fft,
            },
            Method {
                name: "correlation, direct sum",
                knob: POINTS,
                values: DIRECT_POINTS,
                prepare: correlation_by_sums,
            },
        ],
    },
    Case {
        name: "spectrum",
        problem: "periodogram of a random walk, no window, all wavenumbers",
        reference_text: "compensated direct sum at 20 wavenumbers a decade",
        reference: Reference::Exact(compensated_spectrum),
        methods: &[
            Method {
                name: "spectrum, FFT",
                knob: POINTS,
                values: FFT_POINTS,
                prepare: spectrum_by_fft,
            },
            Method {
                name: "spectrum, direct sum",
                knob: POINTS,
                values: DIRECT_POINTS,
                prepare: spectrum_by_sums,
            },
        ],
    },
];

const POINTS: &str = "points";

/// A random walk: rough on all scales, with a mean of next to nothing.
fn scan(points: u32) -> LineScan {
    let mut generator = Pcg64::seed_from_u64(3);
    let mut height = 0.0;
    let mut heights: Vec<f64> = (0..points)
        .map(|_| {
            height += 1e-6 * (generator.random::<f64>() - 0.5);
            height
        })
        .collect();
    let mean = compensated(heights.iter().copied()) / f64::from(points);
    heights.iter_mut().for_each(|z| *z -= mean);
    LineScan { name: "random walk".into(), origin: 0.0, spacing: SPACING, heights }
}

/// The numbers at which a result of `points` points is compared.
fn compared(points: usize) -> Vec<usize> {
    log_spaced_lags(points / 2, COMPARED_PER_DECADE)
}

fn at(values: &[f64], places: &[usize]) -> Vec<f64> {
    places.iter().map(|place| values[*place]).collect()
}

fn correlation_by_fft(points: u32) -> Result<Prepared, Failure> {
    let scan = scan(points);
    Ok(Box::new(move || {
        let n = scan.heights.len();
        let correlation = CorrelationPlan::new(n, n / 2).correlate(&scan)?;
        Ok(at(&correlation.values, &compared(n)))
    }))
}

fn correlation_by_sums(points: u32) -> Result<Prepared, Failure> {
    let heights = scan(points).heights;
    Ok(Box::new(move || {
        let n = heights.len();
        let values: Vec<f64> = (0..=n / 2)
            .map(|lag| squared_differences(&heights, lag).sum::<f64>() / (n - lag) as f64)
            .collect();
        Ok(at(&values, &compared(n)))
    }))
}

fn compensated_correlation(points: u32) -> Result<Prepared, Failure> {
    let heights = scan(points).heights;
    let n = heights.len();
    let value = move |lag| compensated(squared_differences(&heights, lag)) / (n - lag) as f64;
    Ok(Box::new(move || Ok(compared(n).into_iter().map(&value).collect())))
}

fn squared_differences(heights: &[f64], lag: usize) -> impl Iterator<Item = f64> {
    heights.iter().zip(&heights[lag..]).map(|(a, b)| (b - a) * (b - a))
}

fn spectrum_by_fft(points: u32) -> Result<Prepared, Failure> {
    let scan = scan(points);
    Ok(Box::new(move || {
        let n = scan.heights.len();
        let spectrum = SpectrumPlan::new(n)?.periodogram(&scan, Window::None)?;
        Ok(at(&spectrum.density, &compared(n)))
    }))
}

fn spectrum_by_sums(points: u32) -> Result<Prepared, Failure> {
    let heights = scan(points).heights;
    Ok(Box::new(move || {
        let n = heights.len();
        let turn = turn(n);
        let sum = |terms: &mut dyn Iterator<Item = f64>| terms.sum::<f64>();
        let values: Vec<f64> = (0..=n / 2).map(|k| density(&heights, &turn, k, sum)).collect();
        Ok(at(&values, &compared(n)))
    }))
}

fn compensated_spectrum(points: u32) -> Result<Prepared, Failure> {
    let heights = scan(points).heights;
    Ok(Box::new(move || {
        let n = heights.len();
        let turn = turn(n);
        let sum = |terms: &mut dyn Iterator<Item = f64>| compensated(terms);
        Ok(compared(n).into_iter().map(|k| density(&heights, &turn, k, sum)).collect())
    }))
}

/// Cosine and sine of the angles `2 π j / n`.
fn turn(n: usize) -> Vec<(f64, f64)> {
    (0..n).map(|j| (TAU * j as f64 / n as f64).sin_cos()).map(|(sin, cos)| (cos, sin)).collect()
}

/// One-sided density in m³ at wavenumber `k` of an even number of heights by its definition.
fn density(
    heights: &[f64],
    turn: &[(f64, f64)],
    k: usize,
    sum: impl Fn(&mut dyn Iterator<Item = f64>) -> f64,
) -> f64 {
    let n = heights.len();
    let angles = || (0..n).map(|i| turn[i * k % n]);
    let cosine = sum(&mut heights.iter().zip(angles()).map(|(z, (cos, _))| z * cos));
    let sine = sum(&mut heights.iter().zip(angles()).map(|(z, (_, sin))| z * sin));
    let sides = if k == 0 || 2 * k == n { 1.0 } else { 2.0 };
    sides * SPACING / (TAU * n as f64) * (cosine * cosine + sine * sine)
}

/// Sum with the round-off of every addition carried along (Neumaier 1974,
/// doi:10.1002/zamm.19740540106).
fn compensated(terms: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut lost) = (0.0_f64, 0.0);
    for term in terms {
        let next = sum + term;
        lost += if sum.abs() >= term.abs() { (sum - next) + term } else { (term - next) + sum };
        sum = next;
    }
    sum + lost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_compensated_sum_keeps_what_cancels() {
        assert_eq!(compensated([1.0, 1e100, 1.0, -1e100].into_iter()), 2.0);
    }
}
