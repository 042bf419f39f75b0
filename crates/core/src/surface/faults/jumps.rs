//! Level jumps: walls that a light beam cannot see, and drop-outs that an instrument has bridged.

use super::{DEVIATION_PER_MAD, median_of_valid, smallest_step};

/// Steps over which the typical step is taken: long against a jump, short against a stone.
const BLOCK: usize = 64;

/// Indices `i` of the steps from point `i` to `i + 1` that are level jumps: `|z(i+1) - z(i)|`
/// exceeds `threshold` times `1.4826` times the median absolute step, in the block of 64 steps
/// that it lies in or of the whole scan, whichever is larger. No step counts that is below
/// `threshold` digits of the instrument. Steps into or out of missing points are not judged.
///
/// Cost is linear in the number of points.
pub fn find_jumps(heights: &[f64], threshold: f64) -> Vec<usize> {
    let steps: Vec<f64> = heights.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let typical = |steps: &[f64]| DEVIATION_PER_MAD * median_of_valid(steps.iter().copied());
    let least = typical(&steps).max(smallest_step(heights));
    let mut jumps = Vec::new();
    for (block, steps) in steps.chunks(BLOCK).enumerate() {
        // Most blocks have no step beyond the smallest limit; only the others need their median.
        if steps.iter().any(|&step| step > threshold * least) {
            let limit = threshold * least.max(typical(steps));
            let beyond = (0..steps.len()).filter(|&i| steps[i] > limit);
            jumps.extend(beyond.map(|i| block * BLOCK + i));
        }
    }
    jumps
}

/// Sets `margin` points on either side of each jump to NaN; returns how many heights that took.
/// Afterwards no pair of points up to `2 * margin` apart spans a jump.
pub fn remove_jumps(heights: &mut [f64], jumps: &[usize], margin: usize) -> usize {
    let mut count = 0;
    for &jump in jumps {
        let range = (jump + 1).saturating_sub(margin)..(jump + 1 + margin).min(heights.len());
        for height in heights[range].iter_mut().filter(|height| !height.is_nan()) {
            *height = f64::NAN;
            count += 1;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave of steps up to 1, with a wall of 20 from point 500 on.
    fn walled() -> Vec<f64> {
        let wave = |i: i32| 10.0 * (0.1 * f64::from(i)).sin();
        (0..1000).map(|i| wave(i) + if i < 500 { 0.0 } else { 20.0 }).collect()
    }

    #[test]
    fn a_wall_is_found_where_it_stands_and_nothing_else() {
        assert_eq!(find_jumps(&walled(), 10.0), [499]);
        let flat_wall: Vec<f64> = walled().iter().map(|z| z.min(9.0)).collect();
        assert!(find_jumps(&flat_wall[..500], 10.0).is_empty());
    }

    #[test]
    fn the_margin_frees_all_pairs_up_to_twice_its_length() {
        let mut heights = walled();
        let jumps = find_jumps(&heights, 10.0);
        assert_eq!(remove_jumps(&mut heights, &jumps, 3), 6);
        assert!((497..503).all(|i| heights[i].is_nan()));
        let spans = |lag: usize| {
            (0..heights.len() - lag)
                .any(|i| i <= 499 && i + lag > 499 && !(heights[i + lag] - heights[i]).is_nan())
        };
        assert!(!spans(6) && spans(7));
    }

    #[test]
    fn jumps_at_the_ends_and_beside_gaps_are_no_trouble() {
        let mut heights = walled();
        heights[500] = f64::NAN;
        assert!(find_jumps(&heights, 10.0).is_empty());
        assert!(find_jumps(&[], 10.0).is_empty());
        assert!(find_jumps(&[f64::NAN; 5], 10.0).is_empty());
        assert_eq!(remove_jumps(&mut [0.0, 9.0], &[0], 5), 2);
    }

    #[test]
    fn a_coarse_digit_is_no_jump() {
        let stairs: Vec<f64> = (0..1000).map(|i| f64::from(i / 100)).collect();
        assert!(find_jumps(&stairs, 10.0).is_empty());
    }
}
