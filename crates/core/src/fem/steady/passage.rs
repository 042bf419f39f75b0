//! The internal measures of a branch along a row, from one point to the next.

use super::flow::{Relaxation, Weights, window};
use super::point::History;
use crate::rubber::finite_strain::{Symmetric, difference};

/// Measures of a kind of points and the distances of their labels from the points before.
pub(super) struct Line {
    pub measures: Vec<Symmetric>,
    pub spacings: Vec<f64>,
}

/// The internal measure from one point to the next.
pub(super) struct Passage<'a> {
    weights: &'a (Weights, Weights),
    measures: [Symmetric; 4],
    before: Symmetric,
    pub after: Symmetric,
    /// The measure less the internal one after it.
    pub lag: Symmetric,
}

impl Passage<'_> {
    /// What the tangent needs of the flow rule.
    pub fn history(&self, length: f64) -> History {
        let (weights, slopes) = self.weights;
        History {
            relaxed: 1.0 - weights.decay,
            weights: weights.of,
            source: step(slopes, &self.before, &self.measures).map(|source| source / length),
            ..History::default()
        }
    }
}

#[inline]
fn step(weights: &Weights, before: &Symmetric, measures: &[Symmetric; 4]) -> Symmetric {
    [0, 1, 2].map(|i| {
        let of: f64 = (0..4).map(|k| weights.of[k] * measures[k][i]).sum();
        weights.decay * before[i] + of
    })
}

/// Integrates the flow rule of a branch over the period and visits each column.
pub(super) fn relax(
    relaxation: &Relaxation,
    line: &Line,
    mut visit: impl FnMut(usize, &Passage<'_>),
) {
    let weights: Vec<(Weights, Weights)> = line
        .spacings
        .iter()
        .map(|spacing| Weights::with_slopes(spacing / relaxation.length))
        .collect();
    let mut state = [0.0; 3];
    let start = relaxation.start(&line.spacings);
    for (column, weights) in weights.iter().enumerate().skip(start) {
        state = step(&weights.0, &state, &window(&line.measures, column));
    }
    let whole = relaxation.whole_period();
    let last = line.measures[line.measures.len() - 1];
    let mut lag = [0, 1, 2].map(|i| last[i] - state[i] / whole);
    for (column, weights) in weights.iter().enumerate() {
        let measures = window(&line.measures, column);
        let before = difference(&measures[1], &lag);
        lag = follow(&weights.0, &lag, &measures);
        let after = difference(&measures[2], &lag);
        visit(column, &Passage { weights, measures, before, after, lag });
    }
}

/// The measure less the internal one at the next point. As a difference of the two it would have the round-off of both;
/// times the glassy modulus of a branch that relaxes fast, this is a force of 1e-9 of the contact force on 8192
/// columns.
#[inline]
fn follow(weights: &Weights, lag: &Symmetric, measures: &[Symmetric; 4]) -> Symmetric {
    let [w0, w1, _, w3] = weights.of;
    [0, 1, 2].map(|i| {
        let [m0, m1, m2, m3] = measures.map(|measure| measure[i]);
        let less = m2 - m1;
        weights.decay * (lag[i] + less) + (w0 * (m2 - m0) + w1 * less + w3 * (m2 - m3))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lags do not depend on the mean of the measures. As differences of two strains they would, by 1e-16 of it: for a
    /// branch that relaxes within 1e-5 of a point, 1e-8 of the lag.
    #[test]
    fn lags_of_fast_branches_keep_their_digits_beside_a_large_strain() {
        let columns = 64;
        let lags = |mean: f64, length: f64| -> Vec<Symmetric> {
            // Multiples of 2^-30, so that a mean of 4096 changes no digit of them.
            let digit = 2_f64.powi(-30);
            let measure = |n: usize| {
                let angle = std::f64::consts::TAU * n as f64 / columns as f64;
                let value = (1e-3 * angle.sin() / digit).round() * digit;
                [mean + value, mean - value, mean + 2.0 * value]
            };
            let line = Line {
                measures: (0..columns).map(measure).collect(),
                spacings: vec![1.0 / columns as f64; columns],
            };
            let mut lags = Vec::new();
            relax(&Relaxation { length, period: 1.0 }, &line, |_, passage| lags.push(passage.lag));
            lags
        };
        for length in [1e-7, 1e-5] {
            let (still, sheared) = (lags(0.0, length), lags(4096.0, length));
            let largest = still.iter().map(|lag| lag[0].abs()).fold(0.0, f64::max);
            // The first points still contain the round-off of the start.
            for (still, sheared) in still.iter().zip(&sheared).skip(4) {
                for i in 0..3 {
                    let difference = (still[i] - sheared[i]).abs();
                    assert!(difference < 1e-13 * largest, "{length}: {still:?} {sheared:?}");
                }
            }
        }
    }
}
