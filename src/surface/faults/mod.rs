//! What an instrument got wrong: detectors with a stated criterion, and points turned into missing
//! ones.

mod effect;
mod jumps;
mod plates;
mod sampling;

pub use effect::{FaultReport, Texture};
pub use jumps::{find_jumps, remove_jumps};
pub use plates::end_plates;
pub use sampling::{
    Quantisation, RepeatedPositions, merge_repeated, position_jitter, quantisation,
};

use statrs::statistics::{Data, OrderStatistics};

/// Points on each side of the one that [`remove_spikes`] looks at. Seven points in all see one to
/// three bad neighbours as a spike; a wider window would also take real valleys of that width.
pub const SPIKE_HALF_WINDOW: usize = 3;

/// Ratio of the standard deviation of a normal distribution to its median absolute deviation.
const DEVIATION_PER_MAD: f64 = 1.482_602_218_505_602;

/// Sets heights outside `range`, in metres about the median height, to NaN; returns their number.
pub fn remove_out_of_range(heights: &mut [f64], range: [f64; 2]) -> usize {
    let median = median_of_valid(heights.iter().copied());
    let outside = |height: f64| height - median < range[0] || height - median > range[1];
    replace_where(heights, |_, height| outside(height))
}

/// Sets spikes to NaN and returns their number, after Hampel: a height is a spike when it
/// deviates from the median of its neighbourhood of `2 * SPIKE_HALF_WINDOW + 1` points by more
/// than `threshold` robust standard deviations, `1.4826 MAD`, of that neighbourhood.
///
/// The deviation counts as no smaller than its median over the scan, since seven points
/// often agree by chance, and no smaller than the least step between two neighbouring heights,
/// the digit of the instrument. Neighbourhoods with fewer than four valid points are left alone.
///
/// Cost is linear in the number of points.
pub fn remove_spikes(heights: &mut [f64], threshold: f64) -> usize {
    let deviations: Vec<LocalDeviation> =
        (0..heights.len()).map(|i| local_deviation(heights, i)).collect();
    let typical = median_of_valid(deviations.iter().map(|local| local.scale));
    let least = typical.max(smallest_step(heights));
    replace_where(heights, |i, _| {
        deviations[i].from_median > threshold * deviations[i].scale.max(least)
    })
}

/// A height against its neighbourhood, in metres; both NaN where too few points are valid.
struct LocalDeviation {
    from_median: f64,
    scale: f64,
}

fn local_deviation(heights: &[f64], i: usize) -> LocalDeviation {
    const LEAST_VALID: usize = SPIKE_HALF_WINDOW + 1;
    let start = i.saturating_sub(SPIKE_HALF_WINDOW);
    let end = (i + SPIKE_HALF_WINDOW + 1).min(heights.len());
    let mut buffer = [0.0; 2 * SPIKE_HALF_WINDOW + 1];
    let mut count = 0;
    for &height in heights[start..end].iter().filter(|height| !height.is_nan()) {
        buffer[count] = height;
        count += 1;
    }
    if heights[i].is_nan() || count < LEAST_VALID {
        return LocalDeviation { from_median: f64::NAN, scale: f64::NAN };
    }
    let valid = &mut buffer[..count];
    let median = median_of_sorted(valid);
    valid.iter_mut().for_each(|height| *height = (*height - median).abs());
    let scale = DEVIATION_PER_MAD * median_of_sorted(valid);
    LocalDeviation { from_median: (heights[i] - median).abs(), scale }
}

/// Median of a few values, which it sorts.
fn median_of_sorted(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

/// Median without the NaN; 0 where nothing is left.
fn median_of_valid(values: impl Iterator<Item = f64>) -> f64 {
    let valid: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
    if valid.is_empty() { 0.0 } else { Data::new(valid).median() }
}

/// Smallest difference other than 0 between neighbouring heights; 0 where there is none.
fn smallest_step(heights: &[f64]) -> f64 {
    let steps = heights.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let smallest = steps.filter(|&step| step > 0.0).fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}

fn replace_where(heights: &mut [f64], is_fault: impl Fn(usize, f64) -> bool) -> usize {
    let mut count = 0;
    for (i, height) in heights.iter_mut().enumerate() {
        if is_fault(i, *height) {
            *height = f64::NAN;
            count += 1;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    fn faults(heights: &[f64]) -> Vec<usize> {
        (0..heights.len()).filter(|&i| heights[i].is_nan()).collect()
    }

    #[test]
    fn the_range_counts_from_the_median() {
        let mut heights = vec![10.0, 11.0, f64::NAN, 12.0, 47.0, 9.0, 5.0];
        assert_eq!(remove_out_of_range(&mut heights, [-5.0, 10.0]), 2);
        assert_eq!(faults(&heights), [2, 4, 6]);
    }

    #[test]
    fn spikes_go_and_the_surface_stays() {
        // A wave with steep flanks and sharp valleys, but none narrower than the window.
        let clean: Vec<f64> =
            (0..2000).map(|i| -(0.03 * f64::from(i)).sin().abs().sqrt()).collect();
        let mut heights = clean.clone();
        assert_eq!(remove_spikes(&mut heights, 6.0), 0);

        let spikes = [(0, 2.0), (500, 1.0), (501, 1.2), (777, -3.0), (1400, 0.5), (1999, -2.0)];
        for (i, spike) in spikes {
            heights[i] += spike;
        }
        heights[778] = f64::NAN;
        assert_eq!(remove_spikes(&mut heights, 6.0), spikes.len());
        assert_eq!(faults(&heights), [0, 500, 501, 777, 778, 1400, 1999]);
        for (height, clean) in heights.iter().zip(&clean).filter(|(height, _)| !height.is_nan()) {
            assert_eq!(height, clean);
        }
    }

    #[test]
    fn a_step_is_no_spike() {
        let mut heights: Vec<f64> = (0..100).map(|i| if i < 50 { 0.0 } else { 1.0 }).collect();
        assert_eq!(remove_spikes(&mut heights, 6.0), 0);
    }

    #[test]
    fn noise_and_coarse_digits_are_no_spikes() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        // The sum of twelve uniform numbers is normal to within its tails, at most 6 deviations.
        let mut noise = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let mut fine: Vec<f64> = (0..100_000).map(|_| noise()).collect();
        // Six deviations of the seven-point scale are about five of the noise: 1e-6 of the points,
        // and a few more since the scale scatters above its floor only.
        assert!(remove_spikes(&mut fine, 6.0) < 20);
        // Digits three times as wide as the noise: most neighbourhoods agree exactly.
        let mut coarse: Vec<f64> = (0..100_000).map(|_| (noise() / 3.0).round()).collect();
        assert_eq!(remove_spikes(&mut coarse, 6.0), 0);
    }

    #[test]
    fn nothing_is_done_where_nothing_is_known() {
        assert_eq!(remove_spikes(&mut [], 6.0), 0);
        assert_eq!(remove_spikes(&mut [f64::NAN; 5], 6.0), 0);
        assert_eq!(remove_spikes(&mut [1.0, 5.0, 1.0], 6.0), 0);
        assert_eq!(remove_out_of_range(&mut [f64::NAN; 5], [-1.0, 1.0]), 0);
    }
}
