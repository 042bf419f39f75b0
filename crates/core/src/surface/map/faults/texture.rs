//! The shortest waves and the digit of a map, from its rows and columns.

use super::super::HeightMap;
use crate::surface::faults::{Quantisation, Texture};

/// Steps smaller than this share of the largest height are round-off of a unit conversion.
const ROUND_OFF: f64 = 1e-12;

/// Root mean square slope and mean square second difference over all rows and columns of a map.
pub fn map_texture(map: &HeightMap) -> Texture {
    let [columns, _] = map.points;
    let (mut slopes, mut seconds) = (MeanSquare::default(), MeanSquare::default());
    if map.heights.is_empty() {
        return Texture { rms_slope: 0.0, high_frequency: 0.0 };
    }
    for row in map.heights.chunks_exact(columns) {
        row.windows(2).for_each(|z| slopes.add((z[1] - z[0]) / map.spacing[0]));
        row.windows(3).for_each(|z| seconds.add(z[0] - 2.0 * z[1] + z[2]));
    }
    let heights = &map.heights;
    for (z, next) in heights.iter().zip(heights.iter().skip(columns)) {
        slopes.add((next - z) / map.spacing[1]);
    }
    let three =
        heights.iter().zip(heights.iter().skip(columns)).zip(heights.iter().skip(2 * columns));
    three.for_each(|((a, b), c)| seconds.add(a - 2.0 * b + c));
    Texture { rms_slope: slopes.mean().sqrt(), high_frequency: seconds.mean() }
}

/// Height resolution of a map and the share of equal neighbours, along rows.
pub fn map_quantisation(map: &HeightMap) -> Quantisation {
    let largest = map.heights.iter().fold(0.0_f64, |most, z| most.max(z.abs()));
    let (mut equal, mut pairs, mut step) = (0_usize, 0_usize, f64::INFINITY);
    for row in map.heights.chunks_exact(map.points[0].max(1)) {
        for size in row.windows(2).map(|z| (z[1] - z[0]).abs()).filter(|size| !size.is_nan()) {
            pairs += 1;
            if size <= ROUND_OFF * largest {
                equal += 1;
            } else {
                step = step.min(size);
            }
        }
    }
    let step = if step.is_finite() { step } else { 0.0 };
    Quantisation { step, equal_share: equal as f64 / pairs.max(1) as f64 }
}

#[derive(Default)]
struct MeanSquare {
    sum: f64,
    count: usize,
}

impl MeanSquare {
    fn add(&mut self, value: f64) {
        if !value.is_nan() {
            self.sum += value * value;
            self.count += 1;
        }
    }

    fn mean(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_those_of_rows_and_columns() {
        let heights = vec![0.0, 1.0, 3.0, 2.0, f64::NAN, 3.0];
        let map = HeightMap { name: "map".into(), points: [3, 2], spacing: [0.5, 2.0], heights };
        let texture = map_texture(&map);
        // Slopes 2, 4 along the first row; 1, 0 along the columns.
        assert_eq!(texture.rms_slope, (21.0_f64 / 4.0).sqrt());
        assert_eq!(texture.high_frequency, 1.0);
        assert_eq!(map_quantisation(&map), Quantisation { step: 1.0, equal_share: 0.0 });
    }

    #[test]
    fn pairs_across_the_ends_of_rows_do_not_count() {
        let heights = vec![1.0, 1.0, 5.0, 5.0];
        let map = HeightMap { name: "map".into(), points: [2, 2], spacing: [1.0, 1.0], heights };
        assert_eq!(map_quantisation(&map), Quantisation { step: 0.0, equal_share: 1.0 });
        assert_eq!(map_texture(&map).rms_slope, 8.0_f64.sqrt());
    }
}
