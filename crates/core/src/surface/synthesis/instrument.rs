//! What a line profilometer makes of a surface: spot, tilt, noise and drop-outs.

use super::random::{normal_pair, run_length, uniform};
use rand::Rng;

/// Standard deviations of the Gaussian spot after which its weight is cut (3e-7 of the peak).
const SPOT_REACH: f64 = 5.5;

/// Means of a periodic profile under a Gaussian spot centred on its points 0, `stride`, 2 `stride`, ...
///
/// `diameter` is the 1/e² diameter of the spot, four standard deviations of its weight, in units of
/// the spacing; 0 leaves the points as they are. Returns `count` values; the profile is not empty.
pub(super) fn spot_average(
    profile: &[f64],
    count: usize,
    stride: usize,
    diameter: f64,
) -> Vec<f64> {
    let deviation = diameter / 4.0;
    let reach = (SPOT_REACH * deviation).floor() as usize;
    let weight = |offset: usize| match offset {
        0 => 1.0,
        _ => (-0.5 * (offset as f64 / deviation).powi(2)).exp(),
    };
    let weights: Vec<f64> = (0..=2 * reach).map(|k| weight(k.abs_diff(reach))).collect();
    let total: f64 = weights.iter().sum();
    let period = profile.len();
    // A spot wider than the ring would wrap several times; one more period keeps the index positive.
    let shift = period * (1 + reach / period) - reach;
    let mean = |i: usize| {
        let at = |k: usize| profile[(i * stride + k + shift) % period];
        weights.iter().enumerate().map(|(k, weight)| weight * at(k)).sum::<f64>() / total
    };
    (0..count).map(mean).collect()
}

/// Add white Gaussian noise of the given standard deviation.
pub(super) fn add_noise(heights: &mut [f64], deviation: f64, rng: &mut impl Rng) {
    for pair in heights.chunks_mut(2) {
        let (first, second) = normal_pair(rng);
        for (height, noise) in pair.iter_mut().zip([first, second]) {
            *height += deviation * noise;
        }
    }
}

/// Indices of `count` missing points, in runs around steep and deep places.
///
/// A run is centred on a point with probability proportional to `1 + (z'/rms z')² + (depth/Rq)²`, where
/// depth is the distance below the mean line; an optical sensor loses the light on flanks and in valleys.
/// Its length is geometric with mean `mean_length` points. Runs may overlap and the last one is cut
/// so that the count is exact. `count` is at most `heights.len()`.
pub(super) fn drop_outs(
    heights: &[f64],
    count: usize,
    mean_length: f64,
    rng: &mut impl Rng,
) -> Vec<usize> {
    let cumulative = cumulative_weights(heights);
    let Some(&total) = cumulative.last() else { return Vec::new() };
    let mut missing = vec![false; heights.len()];
    let mut left = count;
    while left > 0 {
        let target = uniform(rng) * total;
        let centre = cumulative.partition_point(|&sum| sum < target);
        let length = run_length(mean_length, rng);
        let start = centre.saturating_sub(length / 2);
        let end = (start + length).min(heights.len());
        for point in missing[start..end].iter_mut().filter(|point| !**point).take(left) {
            *point = true;
            left -= 1;
        }
    }
    (0..heights.len()).filter(|&i| missing[i]).collect()
}

fn cumulative_weights(heights: &[f64]) -> Vec<f64> {
    let last = heights.len().saturating_sub(1);
    let slopes: Vec<f64> = (0..heights.len())
        .map(|i| (heights[(i + 1).min(last)] - heights[i.saturating_sub(1)]).powi(2))
        .collect();
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    let depths: Vec<f64> = heights.iter().map(|z| (mean - z).max(0.0).powi(2)).collect();
    let variance = heights.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / heights.len() as f64;
    let slope_variance = slopes.iter().sum::<f64>() / heights.len() as f64;
    // A flat profile has neither steep nor deep places.
    let share = |value: f64, scale: f64| if scale > 0.0 { value / scale } else { 0.0 };
    slopes
        .iter()
        .zip(&depths)
        .scan(0.0, |sum, (&slope, &depth)| {
            *sum += 1.0 + share(slope, slope_variance) + share(depth, variance);
            Some(*sum)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_pcg::Pcg64;
    use std::f64::consts::TAU;

    #[test]
    fn the_spot_damps_a_sine_by_its_gaussian_transfer_function() {
        let (points, waves, diameter) = (400, 10.0, 24.0);
        let sine = |i: usize| (TAU * waves * i as f64 / points as f64).sin();
        let profile: Vec<f64> = (0..points).map(sine).collect();
        let seen = spot_average(&profile, 150, 2, diameter);
        let deviation = diameter / 4.0;
        let damping = (-0.5 * (TAU * waves / points as f64 * deviation).powi(2)).exp();
        for (i, z) in seen.iter().enumerate() {
            // The weight beyond the reach is erfc(5.5/sqrt(2)) = 4e-8.
            assert!((z - damping * sine(2 * i)).abs() < 1e-7);
        }
        assert_eq!(spot_average(&profile, 150, 1, 0.0), profile[..150]);
    }

    #[test]
    fn a_spot_wider_than_the_profile_sees_its_mean() {
        let seen = spot_average(&[1.0, 2.0, 6.0], 3, 1, 100.0);
        // The damping of the slowest mode is far below rounding; the cut leaves 4e-8.
        assert!(seen.iter().all(|z| (z - 3.0).abs() < 1e-6));
    }

    #[test]
    fn drop_outs_have_the_count_and_prefer_steep_and_deep_places() {
        let mut rng = Pcg64::new(7, 8);
        // A plane with one steep-walled trench over a tenth of it.
        let heights: Vec<f64> =
            (0..2000).map(|i| if (900..1100).contains(&i) { -1.0 } else { 0.0 }).collect();
        let missing = drop_outs(&heights, 100, 5.0, &mut rng);
        assert_eq!(missing.len(), 100);
        assert!(missing.windows(2).all(|pair| pair[0] < pair[1]));
        let inside = missing.iter().filter(|i| (895..1105).contains(*i)).count();
        // The weights put 0.7 of the runs here; without preference it would be a tenth.
        assert!(inside > 50, "{inside} of 100 in the trench");
    }

    #[test]
    fn drop_outs_of_a_plane_and_of_nothing_are_possible() {
        let mut rng = Pcg64::new(9, 10);
        assert_eq!(drop_outs(&[0.0; 50], 25, 3.0, &mut rng).len(), 25);
        assert!(drop_outs(&[], 0, 3.0, &mut rng).is_empty());
    }
}
