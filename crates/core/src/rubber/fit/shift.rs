//! First shift factors between sweeps.
//!
//! Of two sweeps at neighbouring temperatures, the range of storage moduli that both have is
//! taken; the area between the two curves over it, divided by its height in ln E', is the
//! shift (Gergesova, Zupančič, Saprunov & Emri, J. Rheol. 55, 1, 2011, doi:10.1122/1.3503529):
//!
//! ```text
//! ln a_B - ln a_A = integral (ln ω_A(E') - ln ω_B(E')) d ln E' / (ln E'_high - ln E'_low)
//! ```
//!
//! Neighbours without common storage moduli are joined by E'' and tan δ ([`join`](super::join)).

use super::join::{best_place, ln_loss, ln_loss_factor, mean_difference};
use super::verticals::Start;
use super::{Sweep, SweepPoint};
use std::ops::Range;

/// Points of each of two sweeps that must lie in the moduli of the other.
const LEAST_COMMON_POINTS: usize = 2;
/// Least change of ln E' over a sweep that determines its shift: samples of one rubber differ by some per cent from
/// clamping to clamping.
const LEAST_CHANGE: f64 = 0.05;

/// Least standard deviation of ln tan δ over two sweeps, in units of its scatter, that distinguishes a shift from a
/// vertical factor.
const LEAST_CONTRAST: f64 = 2.0;

/// Difference in ln a up to which E'' and tan δ confirm a shift by E': a tenth of a decade.
const AGREEMENT: f64 = 0.1 * std::f64::consts::LN_10;

/// First shifts of all sweeps, sorted by temperature.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FirstShifts {
    /// ln a of every sweep relative to the first one of its group.
    pub ln_shifts: Vec<f64>,
    /// Groups of connected sweeps, in order.
    pub groups: Vec<Range<usize>>,
    /// The colder one of each pair joined by E'' and tan δ, since they have no common E'.
    pub by_loss: Vec<usize>,
    /// The colder one of each pair with a poorly determined shift: E' changes by little more than it scatters, and E''
    /// and tan δ are flat or give another shift.
    pub uncertain: Vec<usize>,
}

/// How the hotter of two neighbours is joined.
struct Pair {
    ln_shift: f64,
    by_loss: bool,
    uncertain: bool,
}

/// Joins neighbours, and begins a new group where they cannot be joined.
pub(super) fn first_shifts(sweeps: &[Sweep]) -> FirstShifts {
    let mut first = FirstShifts {
        ln_shifts: vec![0.0],
        groups: Vec::new(),
        by_loss: Vec::new(),
        uncertain: Vec::new(),
    };
    let mut start = 0;
    for (k, pair) in sweeps.windows(2).enumerate() {
        match joined(&pair[0], &pair[1]) {
            Some(pair) => {
                first.ln_shifts.push(first.ln_shifts[k] + pair.ln_shift);
                first.by_loss.extend(pair.by_loss.then_some(k));
                first.uncertain.extend(pair.uncertain.then_some(k));
            }
            None => {
                first.groups.push(start..k + 1);
                start = k + 1;
                first.ln_shifts.push(0.0);
            }
        }
    }
    first.groups.push(start..sweeps.len());
    first
}

fn joined(colder: &Sweep, hotter: &Sweep) -> Option<Pair> {
    let by_loss = || best_place(colder, hotter, &[ln_loss, ln_loss_factor]);
    let plain = |ln_shift: f64| {
        let confirmed = || by_loss().is_some_and(|loss: f64| (loss - ln_shift).abs() < AGREEMENT);
        let uncertain = change(colder).max(change(hotter)) < LEAST_CHANGE && !confirmed();
        Pair { ln_shift, by_loss: false, uncertain }
    };
    by_storage(colder, hotter)
        .map(plain)
        .or_else(|| Some(Pair { ln_shift: by_loss()?, by_loss: true, uncertain: false }))
}

/// ln a of every sweep by E' as it is, by given ones where neighbours have too few common moduli.
pub(super) fn by_storage_from(sweeps: &[Sweep], ln_shifts: &[f64]) -> Vec<f64> {
    let mut ln = vec![0.0];
    for (k, pair) in sweeps.windows(2).enumerate() {
        let given = ln_shifts[k + 1] - ln_shifts[k];
        ln.push(ln[k] + by_storage(&pair[0], &pair[1]).unwrap_or(given));
    }
    ln
}

/// ln a of every sweep by tan δ and ln b by the storage moduli that then differ; the given shift and
/// no factor where tan δ does not join neighbours.
pub(super) fn by_loss_factor_from(sweeps: &[Sweep], ln_shifts: &[f64]) -> Start {
    let ln_storage = |point: &SweepPoint| point.storage_modulus.ln();
    let mut start = Start { ln_shifts: vec![0.0], ln_verticals: vec![0.0] };
    for (k, pair) in sweeps.windows(2).enumerate() {
        let joined = best_place(&pair[0], &pair[1], &[ln_loss_factor])
            .and_then(|ln| Some([ln, mean_difference(&pair[0], &pair[1], ln, ln_storage)?]));
        let [shift, vertical] = joined.unwrap_or([ln_shifts[k + 1] - ln_shifts[k], 0.0]);
        start.ln_shifts.push(start.ln_shifts[k] + shift);
        start.ln_verticals.push(start.ln_verticals[k] + vertical);
    }
    start
}

/// Whether tan δ changes by too little over two sweeps for its scatter: along a power law of the
/// moduli, where a vertical factor is as good as a shift.
pub(super) fn featureless(colder: &Sweep, hotter: &Sweep) -> bool {
    let values: Vec<f64> = colder.points.iter().chain(&hotter.points).map(ln_loss_factor).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    // The difference of a point and the mean of its neighbours has 3/2 of the variance of a point.
    let middle = |three: &[SweepPoint]| {
        let [a, b, c] = [&three[0], &three[1], &three[2]].map(ln_loss_factor);
        (b - 0.5 * (a + c)).powi(2) / 1.5
    };
    let of = |sweep: &Sweep| sweep.points.windows(3).map(middle).collect::<Vec<_>>();
    let scatter = [of(colder), of(hotter)].concat();
    let variance = scatter.iter().sum::<f64>() / scatter.len() as f64;
    // Sweeps of fewer than three points have no known scatter.
    scatter.is_empty() || squares / values.len() as f64 <= LEAST_CONTRAST.powi(2) * variance
}

/// Slope of ln E' over ln ω between the ends of two sweeps, the smaller one.
pub(super) fn slope(colder: &Sweep, hotter: &Sweep) -> f64 {
    let of = |sweep: &Sweep| {
        let ends = [&sweep.points[0], &sweep.points[sweep.points.len() - 1]];
        let [from, to] =
            ends.map(|point| [point.storage_modulus.ln(), point.angular_frequency.ln()]);
        (to[0] - from[0]) / (to[1] - from[1])
    };
    of(colder).min(of(hotter))
}

/// Change of ln E' over a sweep.
fn change(sweep: &Sweep) -> f64 {
    let moduli = || sweep.points.iter().map(|point| point.storage_modulus);
    (moduli().fold(0.0, f64::max) / moduli().fold(f64::INFINITY, f64::min)).ln()
}

/// The shift by the area between the curves of E'; `None` without common moduli.
fn by_storage(colder: &Sweep, hotter: &Sweep) -> Option<f64> {
    let curves = [rising(colder), rising(hotter)];
    let low = curves.iter().map(|curve| curve[0][1]).fold(f64::NEG_INFINITY, f64::max);
    let high = curves.iter().map(|curve| curve[curve.len() - 1][1]).fold(f64::INFINITY, f64::min);
    let common = |sweep: &Sweep| {
        let inside = |modulus: f64| (low..=high).contains(&modulus.ln());
        sweep.points.iter().filter(|point| inside(point.storage_modulus)).count()
    };
    if high <= low || common(colder).min(common(hotter)) < LEAST_COMMON_POINTS {
        return None;
    }
    let area = |curve: &[[f64; 2]]| integral(curve, low, high);
    Some((area(&curves[0]) - area(&curves[1])) / (high - low))
}

/// ln ω and ln E' by ascending frequency; where noise lets E' fall, its running maximum.
fn rising(sweep: &Sweep) -> Vec<[f64; 2]> {
    let mut highest = f64::NEG_INFINITY;
    let point = |point: &super::SweepPoint| {
        highest = highest.max(point.storage_modulus.ln());
        [point.angular_frequency.ln(), highest]
    };
    sweep.points.iter().map(point).collect()
}

/// `integral of x dy` along a rising polyline of points (x, y), between two y.
fn integral(curve: &[[f64; 2]], low: f64, high: f64) -> f64 {
    let piece = |pair: &[[f64; 2]]| {
        let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
        let (from, to) = (y0.max(low), y1.min(high));
        if to <= from {
            return 0.0;
        }
        let at = |y: f64| x0 + (x1 - x0) * (y - y0) / (y1 - y0);
        0.5 * (at(from) + at(to)) * (to - from)
    };
    curve.windows(2).map(piece).sum()
}

#[cfg(test)]
mod tests {
    use super::super::SweepPoint;
    use super::*;

    fn sweep(temperature_c: f64, shift: f64, frequencies: std::ops::Range<i32>) -> Sweep {
        let point = |k: i32| {
            let angular_frequency = 10_f64.powf(f64::from(k) / 4.0);
            // Linear in the logarithms, so that interpolation is exact.
            let storage_modulus = 1e6 * (angular_frequency * shift).powf(0.3);
            SweepPoint { angular_frequency, storage_modulus, loss_modulus: 1e5 }
        };
        Sweep { temperature_c: Some(temperature_c), points: frequencies.map(point).collect() }
    }

    #[test]
    fn the_shift_of_straight_lines_is_exact() {
        let sweeps = [sweep(0.0, 50.0, -4..9), sweep(20.0, 1.0, -4..9), sweep(40.0, 0.1, -4..9)];
        let first = first_shifts(&sweeps);
        let expected = [0.0, -50_f64.ln(), (0.1_f64 / 50.0).ln()];
        for (shift, expected) in first.ln_shifts.iter().zip(expected) {
            approx::assert_abs_diff_eq!(*shift, expected, epsilon = 1e-12);
        }
    }

    #[test]
    fn sweeps_apart_are_groups() {
        let sweeps = [sweep(0.0, 1e4, 0..9), sweep(20.0, 1.0, 0..9), sweep(40.0, 0.5, 0..9)];
        let first = first_shifts(&sweeps);
        assert_eq!(first.groups, [0..1, 1..3]);
        approx::assert_relative_eq!(first.ln_shifts[2], 0.5_f64.ln(), max_relative = 1e-9);
    }
}
