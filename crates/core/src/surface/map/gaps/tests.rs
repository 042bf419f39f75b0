//! Gaps in planes and in rough maps.

use super::*;

fn map_of(points: [usize; 2], spacing: [f64; 2], height: impl Fn(f64, f64) -> f64) -> HeightMap {
    let places = (0..points[1]).flat_map(|j| (0..points[0]).map(move |i| (i, j)));
    let heights =
        places.map(|(i, j)| height(i as f64 * spacing[0], j as f64 * spacing[1])).collect();
    HeightMap { name: "map".into(), points, spacing, heights }
}

fn remove(map: &mut HeightMap, is_gap: impl Fn(usize, usize) -> bool) -> usize {
    let columns = map.points[0];
    (0..map.heights.len())
        .filter(|k| is_gap(k % columns, k / columns))
        .map(|k| map.heights[k] = f64::NAN)
        .count()
}

#[test]
fn a_plane_is_recovered() {
    let plane = map_of([90, 70], [2e-5, 7e-5], |x, y| 0.05 + 0.3 * x - 0.2 * y);
    let mut map = plane.clone();
    // Single points, a small gap that is solved at once, and a large one of odd shape.
    let gaps = |i: usize, j: usize| {
        let single = i % 8 == 3 && j % 9 == 4;
        let disc = (i as f64 - 50.0).hypot(j as f64 - 40.0) < 18.0 && i != 47;
        single || disc || ((10..14).contains(&i) && (20..24).contains(&j))
    };
    let missing = remove(&mut map, gaps);
    assert_eq!(fill_gaps(&mut map, 1.0), Ok(missing));
    let relief = 0.3 * 90.0 * 2e-5 + 0.2 * 70.0 * 7e-5;
    for (filled, plane) in map.heights.iter().zip(&plane.heights) {
        // A residual of 1e-12, gaps of 36 points.
        assert!((filled - plane).abs() < 1e-11 * relief, "{filled} {plane}");
    }
}

#[test]
fn filled_heights_are_the_weighted_means_of_their_neighbours() {
    let wave = |x: f64, y: f64| (3e4 * x).sin() + (5e4 * y).cos() * (2e4 * x).sin();
    let mut map = map_of([60, 50], [1e-5, 3e-5], wave);
    let is_gap = |i: usize, j: usize| {
        (i < 9 && j < 7) || (i > 50 && j < 25) || (j == 30 && i != 20) || (i == 40 && j < 12)
    };
    let missing = remove(&mut map, is_gap);
    let (low, high) =
        map.heights.iter().fold((9.0_f64, -9.0_f64), |(l, h), &z| (l.min(z), h.max(z)));
    assert_eq!(fill_gaps(&mut map, 1.0), Ok(missing));
    let (wx, wy) = (1.0 / 1e-10, 1.0 / 9e-10);
    for point in (0..3000).filter(|k| is_gap(k % 60, k / 60)) {
        let (mut sum, mut total) = (0.0, 0.0);
        for (side, neighbour) in neighbours([60, 50], point).into_iter().enumerate() {
            let weight = if side < 2 { wx } else { wy };
            if let Some(neighbour) = neighbour {
                sum += weight * map.heights[neighbour];
                total += weight;
            }
        }
        assert!((map.heights[point] - sum / total).abs() < 1e-11, "{point}");
        assert!((low..=high).contains(&map.heights[point]));
    }
}

#[test]
fn a_row_that_is_missing_is_filled_within_the_limit() {
    let mut map = map_of([40, 30], [1e-5, 2e-5], |_, y| 5.0 * y);
    remove(&mut map, |_, j| j == 12 || j == 13);
    // Either row is one step of 20 um away from a height.
    let error = fill_gaps(&mut map.clone(), 39e-6).unwrap_err();
    assert_eq!(
        error.to_string(),
        "map map: the gap at column 0, row 12 is 0.0400 mm wide, and only gaps up to 0.0390 mm are filled; \
         raise the limit or leave this map out"
    );
    assert_eq!(fill_gaps(&mut map, 40e-6), Ok(80));
    for (k, z) in map.heights.iter().enumerate() {
        approx::assert_abs_diff_eq!(*z, 5.0 * 2e-5 * (k / 40) as f64, epsilon = 1e-14);
    }
}

#[test]
fn the_size_of_a_gap_is_the_circle_in_it() {
    let mut map = map_of([60, 50], [1e-5, 2e-5], |_, _| 1.0);
    remove(&mut map, |i, j| (20..31).contains(&i) && (10..41).contains(&j));
    // Eleven columns: the middle one is six steps of 10 um from either side.
    let ([column, row], size) = widest_gap(&map);
    assert_eq!((column, (12..=38).contains(&row)), (25, true));
    approx::assert_relative_eq!(size, 120e-6, max_relative = 1e-12);
    // At an edge there are heights on one side only: the far column is five steps away.
    let mut edge = map_of([60, 50], [1e-5, 2e-5], |_, _| 1.0);
    remove(&mut edge, |i, _| i > 54);
    approx::assert_relative_eq!(widest_gap(&edge).1, 100e-6, max_relative = 1e-12);
    // A corner: nearest is the diagonal neighbour of the block, or the shorter way along an axis.
    let mut corner = map_of([9, 9], [1e-5, 2e-5], |_, _| 1.0);
    remove(&mut corner, |i, j| i < 3 && j < 2);
    assert_eq!(widest_gap(&corner).0, [0, 0]);
    approx::assert_relative_eq!(widest_gap(&corner).1, 60e-6, max_relative = 1e-12);
}

/// Against trying every pair of points.
#[test]
fn distances_are_those_to_the_nearest_height() {
    let mut map = map_of([23, 17], [1e-5, 1.7e-5], |_, _| 1.0);
    remove(&mut map, |i, j| (i * i + 3 * j * i + j) % 11 != 0);
    let valid: Vec<usize> = (0..391).filter(|k| !map.heights[*k].is_nan()).collect();
    let distance = |a: usize, b: usize| {
        let [x, y] = [a % 23, a / 23].map(|k| k as f64);
        (1e-5 * (x - (b % 23) as f64)).hypot(1.7e-5 * (y - (b / 23) as f64))
    };
    let nearest = |a: usize| valid.iter().map(|&b| distance(a, b)).fold(f64::INFINITY, f64::min);
    let widest = (0..391).map(nearest).fold(0.0, f64::max);
    approx::assert_relative_eq!(widest_gap(&map).1, 2.0 * widest, max_relative = 1e-12);
}

#[test]
fn a_refused_map_is_unchanged_and_the_reason_is_told() {
    let mut map = map_of([30, 30], [1e-5, 1e-5], |x, y| x + y);
    remove(&mut map, |i, j| (5..15).contains(&i) && (5..15).contains(&j) || (i == 20 && j == 3));
    let missing = map.missing();
    let error = fill_gaps(&mut map, 50e-6).unwrap_err();
    assert!(matches!(error, GapError::TooWide { column: 9, row: 9, .. }), "{error}");
    assert_eq!((map.missing(), error.kind()), (missing, ErrorKind::Input));
    assert!(fill_gaps(&mut map, f64::NAN).unwrap_err().to_string().contains("NaN mm"));
    let mut empty = map_of([4, 5], [1e-5, 1e-5], |_, _| f64::NAN);
    let error = fill_gaps(&mut empty, 1.0).unwrap_err();
    assert_eq!(error, GapError::NoHeights { map: "map".into(), points: 20 });
    let mut nothing = map_of([0, 0], [1e-5, 1e-5], |_, _| 0.0);
    assert_eq!(fill_gaps(&mut nothing, 1.0), Ok(0));
}

#[test]
fn corners_and_edges_are_continued_level() {
    let mut map = map_of([20, 20], [1e-5, 1e-5], |x, _| x);
    let original = map.clone();
    remove(&mut map, |i, j| {
        (i == 0 && j == 0) || (i == 19 && j == 19) || (j == 0 && (8..11).contains(&i))
    });
    assert_eq!(fill_gaps(&mut map, 1e-3), Ok(5));
    // The corner is the mean of its two neighbours.
    approx::assert_abs_diff_eq!(map.heights[0], 0.5e-5, epsilon = 1e-18);
    approx::assert_abs_diff_eq!(map.heights[399], 18.5e-5, epsilon = 1e-18);
    // Along an edge across which nothing varies, a plane stays a plane.
    for i in 8..11 {
        approx::assert_abs_diff_eq!(map.heights[i], original.heights[i], epsilon = 1e-18);
    }
}
