//! The shift between two sweeps by curves that need not rise: loss modulus and loss factor.
//!
//! In a glass, or a rubber on its plateau, E' changes by no more than it scatters while E'' changes by an order of
//! magnitude. The hotter sweep is moved along the frequency to the shift at which the two curves differ least (root
//! mean square of logarithms at the points that overlap). This minimum must be far below other values, or the curves
//! are flat and do not determine the shift.

use super::{Sweep, SweepPoint};
use std::f64::consts::LN_10;

/// Shifts tried per decade.
const TRIALS_PER_DECADE: f64 = 40.0;
/// Points of each sweep that must overlap the other.
const LEAST_POINTS: usize = 2;
/// Root mean square difference (relative) above which two curves are not the same.
const LARGEST_MISFIT: f64 = 0.15;
/// Least ratio of the largest misfit to the smallest.
const CONTRAST: f64 = 3.0;

/// A curve: ln of a measured quantity over ln of the frequency.
pub(super) type Quantity = fn(&SweepPoint) -> f64;

/// `ln E''`.
pub(super) fn ln_loss(point: &SweepPoint) -> f64 {
    point.loss_modulus.ln()
}

/// `ln tan δ`, which no vertical shift changes.
pub(super) fn ln_loss_factor(point: &SweepPoint) -> f64 {
    (point.loss_modulus / point.storage_modulus).ln()
}

/// `ln a_hotter - ln a_colder`, never positive; `None` if the curves do not determine it.
pub(super) fn best_place(colder: &Sweep, hotter: &Sweep, quantities: &[Quantity]) -> Option<f64> {
    let [from, to] = ends(hotter);
    let [cold_from, _] = ends(colder);
    // The hotter sweep may move left until its last point leaves the colder one.
    let furthest = (to - cold_from).max(0.0);
    let trials = (furthest / LN_10 * TRIALS_PER_DECADE).floor() as usize;
    let place = |k: usize| -LN_10 * k as f64 / TRIALS_PER_DECADE;
    let misfits: Vec<(f64, f64)> = (0..=trials)
        .filter_map(|k| Some((place(k), misfit(colder, hotter, place(k), quantities)?)))
        .collect();
    let best = misfits.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let worst = misfits.iter().map(|(_, misfit)| *misfit).fold(0.0, f64::max);
    let joined = to > from && best.1 < LARGEST_MISFIT && worst > CONTRAST * best.1;
    joined.then_some(best.0)
}

/// Mean of a quantity of the hotter sweep less that of the colder one where they overlap after a
/// shift of the hotter one; `None` without an overlap.
pub(super) fn mean_difference(
    colder: &Sweep,
    hotter: &Sweep,
    shift: f64,
    quantity: Quantity,
) -> Option<f64> {
    let differences = differences(colder, hotter, shift, quantity)?;
    Some(differences.iter().sum::<f64>() / differences.len() as f64)
}

fn misfit(colder: &Sweep, hotter: &Sweep, shift: f64, quantities: &[Quantity]) -> Option<f64> {
    let mut squares = 0.0;
    let mut count = 0;
    for quantity in quantities {
        let differences = differences(colder, hotter, shift, *quantity)?;
        squares += differences.iter().map(|difference| difference * difference).sum::<f64>();
        count += differences.len();
    }
    (count > 0).then(|| (squares / count as f64).sqrt())
}

/// Hotter less colder at every point of either that lies within the other.
fn differences(colder: &Sweep, hotter: &Sweep, shift: f64, quantity: Quantity) -> Option<Vec<f64>> {
    let of = |sweep: &Sweep, other: &Sweep, by: f64, sign: f64| -> Vec<f64> {
        let difference = |point: &SweepPoint| {
            Some(sign * (quantity(point) - at(other, ln(point) + by, quantity)?))
        };
        sweep.points.iter().filter_map(difference).collect()
    };
    let mut of_hotter = of(hotter, colder, shift, 1.0);
    let of_colder = of(colder, hotter, -shift, -1.0);
    if of_hotter.len().min(of_colder.len()) < LEAST_POINTS {
        return None;
    }
    of_hotter.extend(of_colder);
    Some(of_hotter)
}

fn ln(point: &SweepPoint) -> f64 {
    point.angular_frequency.ln()
}

/// ln of the lowest and the highest frequency.
fn ends(sweep: &Sweep) -> [f64; 2] {
    let frequencies = || sweep.points.iter().map(ln);
    [frequencies().fold(f64::INFINITY, f64::min), frequencies().fold(f64::NEG_INFINITY, f64::max)]
}

/// The quantity between two neighbouring points, linear in ln of the frequency.
fn at(sweep: &Sweep, ln_frequency: f64, quantity: Quantity) -> Option<f64> {
    let between = |pair: &[SweepPoint]| (ln(&pair[0])..=ln(&pair[1])).contains(&ln_frequency);
    let pair = sweep.points.windows(2).find(|pair| between(pair))?;
    let [x0, x1] = [ln(&pair[0]), ln(&pair[1])];
    let part = (ln_frequency - x0) / (x1 - x0);
    Some(quantity(&pair[0]) + part * (quantity(&pair[1]) - quantity(&pair[0])))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A loss peak over a flat storage modulus.
    fn sweep(shift: f64, peak: f64) -> Sweep {
        let point = |k: i32| {
            let angular_frequency = 10_f64.powf(f64::from(k) / 4.0);
            let from_peak = (angular_frequency * shift).log10() - 1.0;
            let loss_modulus = 1e7 * (peak * (-from_peak * from_peak).exp() + 1.0);
            SweepPoint { angular_frequency, storage_modulus: 1e9, loss_modulus }
        };
        Sweep { temperature_c: None, points: (-4..9).map(point).collect() }
    }

    #[test]
    fn a_peak_tells_the_shift_and_a_flat_curve_does_not() {
        let quantities: [Quantity; 2] = [ln_loss, ln_loss_factor];
        let place = best_place(&sweep(30.0, 5.0), &sweep(1.0, 5.0), &quantities).unwrap();
        // A step of the search, and interpolation between four points a decade.
        assert!((place + 30_f64.ln()).abs() < 0.05 * LN_10, "{}", place / LN_10);
        assert_eq!(best_place(&sweep(30.0, 0.0), &sweep(1.0, 0.0), &quantities), None);
        assert_eq!(best_place(&sweep(1.0, 5.0), &sweep(1.0, 50.0), &quantities), None);
    }

    #[test]
    fn differences_are_the_vertical_shift() {
        let mut higher = sweep(1.0, 5.0);
        higher.points.iter_mut().for_each(|point| point.loss_modulus *= 1.3);
        let ln = mean_difference(&sweep(1.0, 5.0), &higher, 0.0, ln_loss).unwrap();
        approx::assert_relative_eq!(ln, 1.3_f64.ln(), max_relative = 1e-12);
    }
}
