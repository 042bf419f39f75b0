//! Spikes: single heights far from their neighbours, after Hampel.

use super::{DEVIATION_PER_MAD, median_of_valid, replace_where, smallest_step};

/// Points on each side of the one that [`remove_spikes`] looks at. Seven points in all see one to
/// three bad neighbours as a spike; a wider window would also take real valleys of that width.
pub const SPIKE_HALF_WINDOW: usize = 3;

/// Sets spikes to NaN and returns their indices, after Hampel: a height is a spike when it
/// deviates from the median of its neighbourhood of `2 * SPIKE_HALF_WINDOW + 1` points by more
/// than `threshold` robust standard deviations, `1.4826 MAD`, of that neighbourhood.
///
/// The deviation counts as no smaller than its median over the scan, since seven points
/// often agree by chance, and no smaller than the least step between two neighbouring heights,
/// the digit of the instrument. Neighbourhoods with fewer than four valid points are left alone.
///
/// Cost is linear in the number of points.
pub fn remove_spikes(heights: &mut [f64], threshold: f64) -> Vec<usize> {
    let deviations = local_deviations(heights);
    let typical = median_of_valid(deviations.iter().map(|local| local.scale));
    let least = typical.max(smallest_step(heights));
    replace_where(heights, |i, _| {
        deviations[i].from_median > threshold * deviations[i].scale.max(least)
    })
}

/// A height against its neighbourhood, in metres; both NaN where too few points are valid.
#[derive(Clone, Copy)]
struct LocalDeviation {
    from_median: f64,
    scale: f64,
}

/// Of every height, from a neighbourhood that is kept sorted while it slides along the scan.
fn local_deviations(heights: &[f64]) -> Vec<LocalDeviation> {
    const LEAST_VALID: usize = SPIKE_HALF_WINDOW + 1;
    let mut neighbourhood = Sorted::default();
    heights.iter().take(SPIKE_HALF_WINDOW).for_each(|&height| neighbourhood.insert(height));
    let deviation = |(i, &height): (usize, &f64)| {
        if let Some(&entering) = heights.get(i + SPIKE_HALF_WINDOW) {
            neighbourhood.insert(entering);
        }
        if let Some(leaving) = i.checked_sub(SPIKE_HALF_WINDOW + 1) {
            neighbourhood.remove(heights[leaving]);
        }
        if height.is_nan() || neighbourhood.count < LEAST_VALID {
            return LocalDeviation { from_median: f64::NAN, scale: f64::NAN };
        }
        let (median, deviation) = neighbourhood.median_and_deviation();
        LocalDeviation {
            from_median: (height - median).abs(),
            scale: DEVIATION_PER_MAD * deviation,
        }
    };
    heights.iter().enumerate().map(deviation).collect()
}

/// The valid heights of a neighbourhood in ascending order; one more than it holds, since one
/// enters before another leaves.
#[derive(Default)]
struct Sorted {
    values: [f64; 2 * SPIKE_HALF_WINDOW + 2],
    count: usize,
}

impl Sorted {
    fn insert(&mut self, height: f64) {
        if height.is_nan() {
            return;
        }
        let mut place = self.count;
        while place > 0 && self.values[place - 1] > height {
            self.values[place] = self.values[place - 1];
            place -= 1;
        }
        self.values[place] = height;
        self.count += 1;
    }

    fn remove(&mut self, height: f64) {
        let place = self.values[..self.count].iter().position(|&value| value == height);
        if let Some(place) = place {
            self.values.copy_within(place + 1..self.count, place);
            self.count -= 1;
        }
    }

    /// Median and median absolute deviation from it. The deviations are those of two sorted
    /// halves, so the smaller half of them is met by going outward from the median.
    fn median_and_deviation(&self) -> (f64, f64) {
        let values = &self.values[..self.count];
        let middle = values.len() / 2;
        let odd = values.len() % 2 == 1;
        let median = if odd { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) };
        let (mut below, mut above) = (middle, middle);
        let mut next = || {
            let down = below.checked_sub(1).map_or(f64::INFINITY, |i| median - values[i]);
            let up = values.get(above).map_or(f64::INFINITY, |value| value - median);
            if down < up {
                below -= 1;
                down
            } else {
                above += 1;
                up
            }
        };
        let (mut last, mut deviation) = (0.0, 0.0);
        for _ in 0..=middle {
            (last, deviation) = (deviation, next());
        }
        (median, if odd { deviation } else { 0.5 * (last + deviation) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use statrs::statistics::{Data, OrderStatistics};

    proptest! {
        /// Against sorting each neighbourhood anew; few levels, so that many heights are equal.
        #[test]
        fn the_sliding_neighbourhood_is_the_sorted_one(
            levels in proptest::collection::vec(prop_oneof![1 => Just(None), 4 => (0..9_i32).prop_map(Some)], 0..60)
        ) {
            let heights: Vec<f64> =
                levels.iter().map(|level| level.map_or(f64::NAN, |level| 0.1 * f64::from(level))).collect();
            for (i, found) in local_deviations(&heights).iter().enumerate() {
                let around = i.saturating_sub(SPIKE_HALF_WINDOW)..(i + SPIKE_HALF_WINDOW + 1).min(heights.len());
                let valid: Vec<f64> = heights[around].iter().copied().filter(|z| !z.is_nan()).collect();
                if heights[i].is_nan() || valid.len() <= SPIKE_HALF_WINDOW {
                    prop_assert!(found.from_median.is_nan() && found.scale.is_nan());
                    continue;
                }
                let median = Data::new(valid.clone()).median();
                let deviations: Vec<f64> = valid.iter().map(|z| (z - median).abs()).collect();
                prop_assert_eq!(found.from_median, (heights[i] - median).abs());
                prop_assert_eq!(found.scale, DEVIATION_PER_MAD * Data::new(deviations).median());
            }
        }
    }

    #[test]
    fn spikes_go_and_the_surface_stays() {
        // A wave with steep flanks and sharp valleys, but none narrower than the window.
        let clean: Vec<f64> =
            (0..2000).map(|i| -(0.03 * f64::from(i)).sin().abs().sqrt()).collect();
        let mut heights = clean.clone();
        assert!(remove_spikes(&mut heights, 6.0).is_empty());

        let spikes = [(0, 2.0), (500, 1.0), (501, 1.2), (777, -3.0), (1400, 0.5), (1999, -2.0)];
        for (i, spike) in spikes {
            heights[i] += spike;
        }
        heights[778] = f64::NAN;
        assert_eq!(remove_spikes(&mut heights, 6.0), spikes.map(|(i, _)| i));
        assert!(spikes.iter().all(|&(i, _)| heights[i].is_nan()));
        for (height, clean) in heights.iter().zip(&clean).filter(|(height, _)| !height.is_nan()) {
            assert_eq!(height, clean);
        }
    }

    #[test]
    fn a_step_is_no_spike() {
        let mut heights: Vec<f64> = (0..100).map(|i| if i < 50 { 0.0 } else { 1.0 }).collect();
        assert!(remove_spikes(&mut heights, 6.0).is_empty());
    }

    #[test]
    fn noise_and_coarse_digits_are_no_spikes() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        // The sum of twelve uniform numbers is normal to within its tails, at most 6 deviations.
        let mut noise = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let mut fine: Vec<f64> = (0..100_000).map(|_| noise()).collect();
        // Six deviations of the seven-point scale are about five of the noise: 1e-6 of the points,
        // and a few more since the scale scatters above its floor only.
        assert!(remove_spikes(&mut fine, 6.0).len() < 20);
        // Digits three times as wide as the noise: most neighbourhoods agree exactly.
        let mut coarse: Vec<f64> = (0..100_000).map(|_| (noise() / 3.0).round()).collect();
        assert!(remove_spikes(&mut coarse, 6.0).is_empty());
    }
}
