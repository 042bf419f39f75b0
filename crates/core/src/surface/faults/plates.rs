//! End plates: runs at the ends of a track that are no road.

use super::median_of_valid;
use statrs::statistics::{Data, OrderStatistics};

/// Number of blocks that a scan is divided into: each half a per cent of it.
const BLOCKS: usize = 200;
/// Fewest points of a block.
const LEAST_POINTS: usize = 16;
/// Median step of a flat block over that of the scan.
const FLAT: f64 = 0.1;

/// Number of points at the start and at the end that are end plates, in blocks of half a
/// per cent of the scan: from the end inwards as long as the level of a block, its median, lies
/// more than `threshold` interquartile ranges of all levels outside their quartiles, or its median
/// absolute step is below a tenth of that of the scan; blocks without any height between such
/// blocks count as plate.
///
/// Nothing is found where the scan has fewer than 200 blocks of 16 points.
pub fn end_plates(heights: &[f64], threshold: f64) -> [usize; 2] {
    let points = heights.len() / BLOCKS;
    if points < LEAST_POINTS {
        return [0, 0];
    }
    let median_step =
        |z: &[f64]| median_of_valid(z.windows(2).map(|pair| (pair[1] - pair[0]).abs()));
    let typical = median_step(heights);
    let blocks: Vec<&[f64]> = heights.chunks_exact(points).collect();
    let levels: Vec<f64> = blocks.iter().map(|block| level(block)).collect();
    let mut valid = Data::new(levels.iter().copied().filter(|z| !z.is_nan()).collect::<Vec<_>>());
    let (lower, upper) = (valid.lower_quartile(), valid.upper_quartile());
    let reach = threshold * (upper - lower);
    let is_plate = |i: &usize| {
        let outside = levels[*i] < lower - reach || levels[*i] > upper + reach;
        outside || (!levels[*i].is_nan() && median_step(blocks[*i]) < FLAT * typical)
    };
    let run = |indices: &mut dyn Iterator<Item = usize>| {
        let (mut run, mut plate) = (0, 0);
        for i in indices {
            run += 1;
            if is_plate(&i) {
                plate = run;
            } else if !levels[i].is_nan() {
                break;
            }
        }
        plate * points
    };
    [run(&mut (0..blocks.len())), run(&mut (0..blocks.len()).rev())]
}

fn level(block: &[f64]) -> f64 {
    if block.iter().all(|z| z.is_nan()) {
        return f64::NAN;
    }
    median_of_valid(block.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn road() -> Vec<f64> {
        (0..10_000).map(|i| (0.05 * f64::from(i)).sin() + 0.3 * f64::from(i).sin()).collect()
    }

    #[test]
    fn a_high_plate_and_a_flat_one_are_found_and_a_road_is_not() {
        assert_eq!(end_plates(&road(), 3.0), [0, 0]);
        let mut heights = road();
        heights[..1000].iter_mut().for_each(|z| *z += 30.0);
        heights[9500..].fill(0.2);
        assert_eq!(end_plates(&heights, 3.0), [1000, 500]);
    }

    #[test]
    fn the_gap_behind_a_plate_counts_only_up_to_the_plate() {
        let mut heights = road();
        heights[..200].fill(f64::NAN);
        heights[200..600].iter_mut().for_each(|z| *z += 30.0);
        heights[600..800].fill(f64::NAN);
        assert_eq!(end_plates(&heights, 3.0), [600, 0]);
    }

    #[test]
    fn short_scans_are_not_judged() {
        assert_eq!(end_plates(&road()[..3000], 3.0), [0, 0]);
        assert_eq!(end_plates(&[], 3.0), [0, 0]);
    }
}
