//! Faults of the sampling: the digit of the heights, repeated positions, uneven steps.

use super::smallest_step;
use crate::surface::RawScan;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Steps smaller than this share of the largest height are round-off of a unit conversion.
const ROUND_OFF: f64 = 1e-12;

/// Stair-steps of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantisation {
    /// Height resolution in metres: the smallest step between neighbours; 0 where all are equal.
    pub step: f64,
    /// Share of the pairs of neighbouring heights that are equal, between 0 and 1.
    pub equal_share: f64,
}

/// Height resolution of a scan and the share of equal neighbours.
///
/// Rounding to a digit `d` adds an error of variance `d^2 / 12`, and so `d^2 / 6` over the squared
/// spacing to the mean square slope, as long as few neighbours are equal.
pub fn quantisation(heights: &[f64]) -> Quantisation {
    let largest = heights.iter().filter(|z| !z.is_nan()).fold(0.0_f64, |most, z| most.max(z.abs()));
    let least = ROUND_OFF * largest;
    let (mut equal, mut pairs, mut step) = (0_usize, 0_usize, f64::INFINITY);
    for size in heights.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|s| !s.is_nan()) {
        pairs += 1;
        if size <= least {
            equal += 1;
        } else {
            step = step.min(size);
        }
    }
    let step = if step.is_finite() { step } else { smallest_step(heights) };
    Quantisation { step, equal_share: equal as f64 / pairs.max(1) as f64 }
}

/// What to do with points at the position of the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RepeatedPositions {
    /// Refuse the scan.
    Refuse,
    /// Take the mean of their valid heights.
    Mean,
}

/// Merges neighbouring points of the same position into one with the mean of their valid heights;
/// returns the number of points that went.
pub fn merge_repeated(scan: &RawScan) -> (RawScan, usize) {
    let (mut positions, mut heights) = (Vec::new(), Vec::new());
    let indices: Vec<usize> = (0..scan.positions.len().min(scan.heights.len())).collect();
    for run in indices.chunk_by(|&a, &b| scan.positions[a] == scan.positions[b]) {
        let valid = run.iter().map(|&i| scan.heights[i]).filter(|z| !z.is_nan());
        let (sum, count) = valid.fold((0.0, 0.0), |(sum, count), z| (sum + z, count + 1.0));
        positions.push(scan.positions[run[0]]);
        // No valid height is 0 / 0, the NaN that marks it as missing.
        heights.push(sum / count);
    }
    let merged = scan.positions.len() - positions.len();
    (RawScan { name: scan.name.clone(), positions, heights }, merged)
}

/// Coefficient of variation of the steps between positions that are no gaps, below 1.5 times the
/// mean step; 0 for fewer than three points.
///
/// Positions printed with a digit `d` have at least that of the rounding, `d / sqrt(6)` over the
/// spacing.
pub fn position_jitter(positions: &[f64]) -> f64 {
    let steps = || positions.windows(2).map(|pair| pair[1] - pair[0]);
    let mean = steps().sum::<f64>() / (positions.len().max(2) - 1) as f64;
    let regular: Vec<f64> = steps().filter(|&step| step < 1.5 * mean).collect();
    if regular.len() < 2 {
        return 0.0;
    }
    let count = regular.len() as f64;
    let mean = regular.iter().sum::<f64>() / count;
    let variance = regular.iter().map(|step| (step - mean).powi(2)).sum::<f64>() / count;
    variance.sqrt() / mean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digit_and_the_equal_neighbours_are_counted() {
        let found = quantisation(&[0.0, 0.5, 0.5, f64::NAN, 3.0, 3.0, 2.0]);
        assert_eq!(found, Quantisation { step: 0.5, equal_share: 0.5 });
        // 0.1 + 0.2 is 0.3 but for round-off.
        assert_eq!(quantisation(&[0.3, 0.1 + 0.2, 0.4]).equal_share, 0.5);
        assert_eq!(quantisation(&[1.0; 3]), Quantisation { step: 0.0, equal_share: 1.0 });
        assert_eq!(quantisation(&[]), Quantisation { step: 0.0, equal_share: 0.0 });
    }

    #[test]
    fn repeated_positions_become_one_with_the_mean_of_their_heights() {
        let scan = RawScan {
            name: "07".into(),
            positions: vec![0.0, 1.0, 1.0, 1.0, 2.0, 2.0],
            heights: vec![5.0, 1.0, f64::NAN, 3.0, f64::NAN, f64::NAN],
        };
        let (merged, count) = merge_repeated(&scan);
        assert_eq!((merged.positions, count), (vec![0.0, 1.0, 2.0], 3));
        assert_eq!(merged.heights[..2], [5.0, 2.0]);
        assert!(merged.heights[2].is_nan());
    }

    #[test]
    fn jitter_is_the_spread_of_the_steps_without_gaps() {
        assert_eq!(position_jitter(&[0.0, 1.0, 2.0, 3.0, 10.0, 11.0]), 0.0);
        // Steps 0.9 and 1.1 by turns.
        let positions: Vec<f64> =
            (0..101).map(|i| f64::from(i) + if i % 2 == 1 { -0.1 } else { 0.0 }).collect();
        approx::assert_relative_eq!(position_jitter(&positions), 0.1, max_relative = 1e-12);
        assert_eq!(position_jitter(&[0.0]), 0.0);
    }
}
