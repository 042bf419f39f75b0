//! Planted spikes, and surfaces that have none.

use super::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn map_of(points: [usize; 2], height: impl FnMut([usize; 2]) -> f64) -> HeightMap {
    let [columns, rows] = points;
    let places = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j]));
    let heights = places.map(height).collect();
    HeightMap { name: "map".into(), points, spacing: [1e-5, 1e-5], heights }
}

/// Normal noise of unit variance: a sum of twelve uniform numbers, within its tails.
fn noise(random: &mut Pcg64Mcg) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

/// Stones of a rolled road, 28 to 48 points across and 60 to 100 high, with flat faces and flanks that take four times
/// `flank` points from a tenth to nine tenths of the height. Texture of height 3.5 and noise of 0.3 lie on them.
fn road(points: [usize; 2], flank: f64) -> HeightMap {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let count = points[0] * points[1] / 1600;
    let stones: Vec<[f64; 4]> = (0..count)
        .map(|_| {
            let at = [0, 1].map(|axis| random.random::<f64>() * points[axis] as f64);
            [
                at[0],
                at[1],
                14.0 + 10.0 * random.random::<f64>(),
                60.0 + 40.0 * random.random::<f64>(),
            ]
        })
        .collect();
    map_of(points, |[i, j]| {
        let (x, y) = (i as f64, j as f64);
        let face = |[u, v, radius, height]: &[f64; 4]| {
            let distance = (x - u).hypot(y - v);
            height / (1.0 + ((distance - radius) / flank).exp())
        };
        let top = stones.iter().map(face).fold(0.0, f64::max);
        top + 2.0 * (0.31 * x + 0.2 * y).sin() + 1.5 * (0.5 * y).sin() + 0.3 * noise(&mut random)
    })
}

fn positions(map: &HeightMap, found: &[usize]) -> Vec<[usize; 2]> {
    found.iter().map(|k| [k % map.points[0], k / map.points[0]]).collect()
}

#[test]
fn noise_has_no_spikes() {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut map = map_of([400, 400], |_| noise(&mut random));
    assert!(remove_spikes(&mut map.clone(), 6.0).is_empty());
    // Below four deviations some of 160000 points are expected: 6e-5 of them beyond four, where the lines save a few.
    assert!(remove_spikes(&mut map, 4.0).len() < 30);
    let mut coarse = map_of([300, 300], |_| (noise(&mut random) / 3.0).round());
    assert!(remove_spikes(&mut coarse, 6.0).is_empty());
}

#[test]
fn steep_flanks_of_stones_are_no_spikes() {
    // At the steepest 70 and 90 typical spreads from one point to the next.
    for flank in [1.0, 0.25] {
        let mut map = road([300, 200], flank);
        let found = remove_spikes(&mut map, 6.0);
        assert!(found.is_empty(), "{flank}: {:?}", positions(&map, &found));
    }
}

#[test]
fn planted_spikes_are_found_and_nothing_else() {
    let mut map = road([200, 150], 1.0);
    let beside_gap = [90, 40];
    for [i, j] in [[91, 40], [90, 41], [89, 41], [91, 39]] {
        map.heights[j * 200 + i] = f64::NAN;
    }
    let mut planted = vec![
        [0, 0],
        [199, 149],
        [100, 0],
        [0, 77],
        [199, 30],
        [60, 149],
        beside_gap,
        [150, 100],
        [151, 100],
        [30, 30],
    ];
    planted.extend((0..9).map(|k| [120 + k % 3, 60 + k / 3]));
    for (k, [i, j]) in planted.iter().enumerate() {
        map.heights[j * 200 + i] += if k % 2 == 0 || k > 9 { 400.0 } else { -400.0 };
    }
    let clean = map.clone();
    let found = remove_spikes(&mut map, 6.0);
    planted.sort_by_key(|[i, j]| (*j, *i));
    assert_eq!(positions(&map, &found), planted);
    assert!(found.iter().all(|&k| map.heights[k].is_nan()));
    let kept = (0..map.heights.len()).filter(|k| !found.contains(k) && !map.heights[*k].is_nan());
    kept.for_each(|k| assert_eq!(map.heights[k], clean.heights[k]));
}

#[test]
fn walls_grooves_and_jumped_rows_are_no_spikes() {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let mut walls = |is_high: fn([usize; 2]) -> bool| {
        let mut map =
            map_of([80, 60], |at| noise(&mut random) + if is_high(at) { 100.0 } else { 0.0 });
        let found = remove_spikes(&mut map, 6.0);
        assert!(found.is_empty(), "{:?}", positions(&map, &found));
    };
    // A step along x, along y, along a diagonal and aslant.
    walls(|[i, _]| i > 30);
    walls(|[_, j]| j > 30);
    walls(|[i, j]| i > j);
    walls(|[i, j]| 2 * i > 3 * j + 5);
    // A block with sharp corners, and the hole of it.
    walls(|[i, j]| (20..40).contains(&i) && (20..40).contains(&j));
    walls(|[i, j]| !((20..40).contains(&i) && (20..40).contains(&j)));
    // A groove or ridge of one point along the axes and the diagonal, and rows that jumped.
    walls(|[i, _]| i == 30);
    walls(|[i, j]| i == j);
    walls(|[_, j]| j == 30 || j == 31);
}

#[test]
fn maps_too_small_to_tell_are_left_alone() {
    for points in [[0, 0], [1, 1], [2, 2], [4, 1]] {
        let mut map = map_of(points, |[i, j]| if i == 1 && j == 0 { 9.0 } else { 0.0 });
        assert!(remove_spikes(&mut map, 6.0).is_empty());
    }
    // The digit of the second is a tenth of its spike; the first is one digit high.
    let mut digit = map_of([9, 9], |at| if at == [4, 4] { 1.0 } else { 0.0 });
    assert!(remove_spikes(&mut digit, 6.0).is_empty());
    let mut flat = digit;
    flat.heights[0] = 0.1;
    assert_eq!(remove_spikes(&mut flat, 6.0), [40]);
    let mut missing = map_of([9, 9], |_| f64::NAN);
    assert!(remove_spikes(&mut missing, 6.0).is_empty());
}
