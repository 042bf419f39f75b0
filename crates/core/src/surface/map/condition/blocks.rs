//! Means of blocks of points.

use super::super::HeightMap;

/// Mean of the valid heights in each block of `cell` points. A block with fewer than half of its heights valid is
/// missing; points beyond the last whole block are left out.
///
/// White noise loses its variance as one over the points of a block, the longer waves of the surface remain.
pub(super) fn block_means(map: HeightMap, cell: [usize; 2]) -> HeightMap {
    if cell == [1, 1] {
        return map;
    }
    let [columns, _] = map.points;
    let points = [0, 1].map(|axis| map.points[axis] / cell[axis]);
    let mut heights = Vec::with_capacity(points[0] * points[1]);
    for rows in map.heights.chunks_exact(columns * cell[1]) {
        for column in (0..points[0]).map(|i| i * cell[0]) {
            let block = rows.chunks_exact(columns).flat_map(|row| &row[column..column + cell[0]]);
            let (sum, count) = block
                .filter(|z| !z.is_nan())
                .fold((0.0, 0_usize), |(sum, count), z| (sum + z, count + 1));
            let few = 2 * count < cell[0] * cell[1];
            heights.push(if few { f64::NAN } else { sum / count as f64 });
        }
    }
    let spacing = [0, 1].map(|axis| map.spacing[axis] * cell[axis] as f64);
    HeightMap { name: map.name, points, spacing, heights }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_the_means_of_their_valid_points() {
        let mut heights: Vec<f64> = (0..35).map(f64::from).collect();
        for k in [0, 2, 3, 9, 10, 16] {
            heights[k] = f64::NAN;
        }
        let map = HeightMap { name: "map".into(), points: [7, 5], spacing: [1.0, 2.0], heights };
        let means = block_means(map, [2, 3]);
        assert_eq!((means.points, means.spacing), ([3, 1], [2.0, 6.0]));
        // 1, 7, 8, 14, 15 of the first block; 17 alone of six in the second; 4, 5, 11, 12, 18, 19 of the third.
        assert_eq!([means.heights[0], means.heights[2]], [9.0, 11.5]);
        assert!(means.heights[1].is_nan());
    }
}
