//! What an instrument got wrong: detectors with a stated criterion, and points turned into missing
//! ones.
//!
//! | module | what it holds |
//! |---|---|
//! | `spikes`, `jumps`, `plates`, `far` | single heights, level jumps, end plates, heights that no road has |
//! | `sampling` | resolution of the heights, repeated positions, uneven steps |
//! | `effect` | what a fault changes of the texture, and its report |
//! | `overview` | where the faults of a scan are, to be drawn |

mod effect;
mod far;
mod jumps;
mod overview;
mod plates;
mod sampling;
mod spikes;

pub use effect::{FaultReport, Texture};
pub use far::FarHeights;
pub use jumps::{find_jumps, remove_jumps};
pub use overview::{Closeup, FaultOverview, FoundPoints, Marks, Stretch};
pub use plates::end_plates;
pub use sampling::{
    Quantisation, RepeatedPositions, merge_repeated, position_jitter, quantisation,
};
pub use spikes::{SPIKE_HALF_WINDOW, remove_spikes};

use statrs::statistics::{Data, OrderStatistics};

/// Ratio of the standard deviation of a normal distribution to its median absolute deviation.
pub(super) const DEVIATION_PER_MAD: f64 = 1.482_602_218_505_602;

/// Sets heights outside `range`, in metres about the median height, to NaN; returns their indices.
pub fn remove_out_of_range(heights: &mut [f64], range: [f64; 2]) -> Vec<usize> {
    let median = median_of_valid(heights.iter().copied());
    let outside = |height: f64| height - median < range[0] || height - median > range[1];
    replace_where(heights, |_, height| outside(height))
}

/// Median without the NaN; 0 where nothing is left.
pub(super) fn median_of_valid(values: impl Iterator<Item = f64>) -> f64 {
    let valid: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
    if valid.is_empty() { 0.0 } else { Data::new(valid).median() }
}

/// Smallest difference other than 0 between neighbouring heights; 0 where there is none.
pub(super) fn smallest_step(heights: &[f64]) -> f64 {
    let steps = heights.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let smallest = steps.filter(|&step| step > 0.0).fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}

/// Sets the heights that are faults to NaN; returns their indices.
fn replace_where(heights: &mut [f64], is_fault: impl Fn(usize, f64) -> bool) -> Vec<usize> {
    let found: Vec<usize> = (0..heights.len()).filter(|&i| is_fault(i, heights[i])).collect();
    found.iter().for_each(|&i| heights[i] = f64::NAN);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_counts_from_the_median() {
        let mut heights = vec![10.0, 11.0, f64::NAN, 12.0, 47.0, 9.0, 5.0];
        assert_eq!(remove_out_of_range(&mut heights, [-5.0, 10.0]), [4, 6]);
        assert!([2, 4, 6].iter().all(|&i: &usize| heights[i].is_nan()));
    }

    #[test]
    fn nothing_is_done_where_nothing_is_known() {
        assert!(remove_spikes(&mut [], 6.0).is_empty());
        assert!(remove_spikes(&mut [f64::NAN; 5], 6.0).is_empty());
        assert!(remove_spikes(&mut [1.0, 5.0, 1.0], 6.0).is_empty());
        assert!(remove_out_of_range(&mut [f64::NAN; 5], [-1.0, 1.0]).is_empty());
    }
}
