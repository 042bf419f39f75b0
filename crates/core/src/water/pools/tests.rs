use super::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

const BOTH: [Neighbours; 2] = [Neighbours::Four, Neighbours::Eight];

fn filled(heights: &[f64], points: [usize; 2]) -> Vec<f64> {
    Pools::new(heights, points, Neighbours::Four).unwrap().heights
}

/// Heights by column and row.
fn map([nx, ny]: [usize; 2], height: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    (0..nx * ny).map(|k| height(k % nx, k / nx)).collect()
}

/// A smooth random map with pools of many sizes.
fn smooth([nx, ny]: [usize; 2], seed: u64) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64(seed);
    let waves: Vec<[f64; 4]> = (0..40)
        .map(|_| {
            let mut whole = || f64::from(random.random_range(-6_i32..=6));
            let (m, n) = (whole(), whole());
            [m, n, random.random::<f64>() * TAU, random.random::<f64>()]
        })
        .collect();
    map([nx, ny], |i, j| {
        let (x, y) = (i as f64 / nx as f64, j as f64 / ny as f64);
        waves.iter().map(|[m, n, phase, a]| a * (TAU * (m * x + n * y) + phase).sin()).sum()
    })
}

/// Whether the valleys up to `level` that are connected with a point lead round the period: a walk that notes how many
/// periods it has gone and comes back to a point with another number. No forest, no order.
fn leads_out(
    heights: &[f64],
    points: [usize; 2],
    neighbours: Neighbours,
    start: usize,
    level: f64,
) -> bool {
    let [nx, ny] = points.map(|n| n as i32);
    let mut gone: Vec<Option<[i32; 2]>> = vec![None; heights.len()];
    gone[start] = Some([0, 0]);
    let mut open = vec![start];
    while let Some(point) = open.pop() {
        let periods = gone[point].unwrap();
        let (i, j) = (point as i32 % nx, point as i32 / nx);
        for [dx, dy] in steps(neighbours) {
            let (a, b) = (i + dx, j + dy);
            let there = [periods[0] + a.div_euclid(nx), periods[1] + b.div_euclid(ny)];
            let other = (b.rem_euclid(ny) * nx + a.rem_euclid(nx)) as usize;
            if heights[other] > level {
                continue;
            }
            match gone[other] {
                None => {
                    gone[other] = Some(there);
                    open.push(other);
                }
                Some(before) if before != there => return true,
                Some(_) => {}
            }
        }
    }
    false
}

/// By trying the height of every point as the level.
#[test]
fn levels_are_those_of_a_search_over_all_levels() {
    let mut random = Pcg64::seed_from_u64(7);
    let mut wet = 0;
    for _ in 0..150 {
        let points = [random.random_range(1..8), random.random_range(1..8)];
        // Few levels, so that many heights are equal.
        let heights = map(points, |_, _| 0.0);
        let heights: Vec<f64> =
            heights.iter().map(|_| f64::from(random.random_range(0_i32..6))).collect();
        for neighbours in BOTH {
            let pools = Pools::new(&heights, points, neighbours).unwrap();
            for (k, z) in heights.iter().enumerate() {
                let level = (0..6)
                    .map(f64::from)
                    .find(|level| level >= z && leads_out(&heights, points, neighbours, k, *level))
                    .unwrap();
                assert_eq!(pools.heights[k], level, "{points:?} {neighbours:?} {k} {heights:?}");
                wet += usize::from(level > *z);
            }
        }
    }
    assert!(wet > 500, "{wet}");
}

#[test]
fn a_crater_fills_to_its_rim_and_a_notch_in_the_rim_lowers_its_water() {
    let points = [48, 40];
    let crater = |notch: f64| {
        map(points, |i, j| {
            let radius = (i as f64 - 24.0).hypot(j as f64 - 20.0);
            match radius {
                r if r < 6.0 => -5.0,
                r if r < 9.0 => {
                    if j == 20 && i > 24 {
                        notch
                    } else {
                        3.0
                    }
                }
                _ => 0.0,
            }
        })
    };
    for (notch, surface) in [(3.0, 3.0), (1.5, 1.5), (-1.0, 0.0)] {
        let heights = crater(notch);
        let pools = Pools::new(&heights, points, Neighbours::Four).unwrap();
        let inside = heights.iter().filter(|z| **z == -5.0).count();
        let under = heights.iter().filter(|z| **z < surface && **z < 0.0).count();
        for (water, z) in pools.heights.iter().zip(&heights) {
            let expected = if *z < 0.0 { surface } else { *z };
            assert_eq!(*water, expected);
        }
        assert!(inside > 100 && pools.deepest == surface + 5.0);
        assert_eq!(pools.filled_fraction, under as f64 / heights.len() as f64);
        let volume = inside as f64 * (surface + 5.0)
            + heights.iter().filter(|z| **z == -1.0).count() as f64 * (surface + 1.0);
        approx::assert_relative_eq!(
            pools.mean_depth,
            volume / heights.len() as f64,
            max_relative = 1e-12
        );
        let [i, j] = pools.deepest_point.unwrap();
        assert_eq!(heights[j * points[0] + i], -5.0);
    }
}

/// The fault of a single outlet: the second valley, higher than the first one, leads out as well.
#[test]
fn parallel_valleys_are_dry_whatever_their_heights() {
    let points = [60, 16];
    let ridges = map(points, |i, _| (TAU * i as f64 / 20.0).sin() + 0.3 * (i / 20) as f64);
    let mut across = vec![0.0; ridges.len()];
    for (k, z) in ridges.iter().enumerate() {
        across[(k % 60) * 16 + k / 60] = *z;
    }
    for (heights, points) in [(&ridges, points), (&across, [16, 60])] {
        let pools = Pools::new(heights, points, Neighbours::Four).unwrap();
        assert_eq!((pools.filled_fraction, pools.deepest_point), (0.0, None));
        assert_eq!(&pools.heights, heights);
    }
    // Dammed, the middle valley is a pool between its ridges at 25 and 45, up to the dam.
    let dam =
        map(points, |i, j| if j == 3 && (26..44).contains(&i) { 1.25 } else { ridges[j * 60 + i] });
    let pools = Pools::new(&dam, points, Neighbours::Four).unwrap();
    for (k, (water, z)) in pools.heights.iter().zip(&dam).enumerate() {
        let middle = (25..45).contains(&(k % 60));
        assert_eq!(*water, if middle { z.max(1.25) } else { *z }, "{k}");
    }
    assert!(pools.filled_fraction > 0.2, "{}", pools.filled_fraction);
}

#[test]
fn a_ring_wall_keeps_water_in_and_none_outside() {
    let points = [30, 30];
    let wall = |i: usize, j: usize| {
        let radius = (i as f64 - 15.0).hypot(j as f64 - 15.0);
        // Two points wide: closed for both kinds of neighbours.
        (8.0..10.0).contains(&radius)
    };
    let heights = map(points, |i, j| if wall(i, j) { 2.0 } else { 0.0 });
    for neighbours in BOTH {
        let pools = Pools::new(&heights, points, neighbours).unwrap();
        for (k, water) in pools.heights.iter().enumerate() {
            let inside = (k as f64 % 30.0 - 15.0).hypot((k / 30) as f64 - 15.0) < 10.0;
            assert_eq!(*water, if inside { 2.0 } else { 0.0 }, "{k}");
        }
    }
    // The period can lie anywhere: the wall across its ends is the same wall.
    let moved = map(points, |i, j| heights[(j + 15) % 30 * 30 + (i + 16) % 30]);
    assert_eq!(
        Pools::new(&moved, points, Neighbours::Four).unwrap().deepest,
        Pools::new(&heights, points, Neighbours::Four).unwrap().deepest
    );
}

/// A channel one point wide from corner to corner leads round both periods at once, if water passes at corners.
#[test]
fn a_diagonal_channel_leads_out_across_corners_only() {
    let points = [12, 12];
    let heights = map(points, |i, j| if i == j { -1.0 } else { 1.0 });
    let wet = |neighbours| Pools::new(&heights, points, neighbours).unwrap().filled_fraction;
    assert_eq!((wet(Neighbours::Four), wet(Neighbours::Eight)), (12.0 / 144.0, 0.0));
}

#[test]
fn filling_twice_changes_nothing_and_never_lowers() {
    for seed in 0..20 {
        let points = [31, 44];
        let heights = smooth(points, seed);
        for neighbours in BOTH {
            let once = Pools::new(&heights, points, neighbours).unwrap();
            assert!(once.filled_fraction > 0.0);
            assert!(once.heights.iter().zip(&heights).all(|(water, z)| water >= z));
            let twice = Pools::new(&once.heights, points, neighbours).unwrap();
            assert_eq!(once.heights, twice.heights);
            assert_eq!((twice.filled_fraction, twice.deepest), (0.0, 0.0));
        }
        let [four, eight] =
            BOTH.map(|neighbours| Pools::new(&heights, points, neighbours).unwrap().mean_depth);
        assert!(eight <= four, "{seed}: {eight} {four}");
    }
}

/// Pools move with the map, and heights matter by their order alone.
#[test]
fn a_shifted_turned_mirrored_or_stretched_map_has_the_same_pools() {
    let [nx, ny] = [37, 24];
    let heights = smooth([nx, ny], 3);
    let water = filled(&heights, [nx, ny]);
    type Move = Box<dyn Fn(usize, usize) -> (usize, usize)>;
    let moves: [([usize; 2], Move); 4] = [
        ([nx, ny], Box::new(move |i, j| ((i + 11) % nx, (j + 19) % ny))),
        ([nx, ny], Box::new(move |i, j| (nx - 1 - i, j))),
        ([ny, nx], Box::new(move |i, j| (j, i))),
        ([ny, nx], Box::new(move |i, j| (j, ny - 1 - i))),
    ];
    for (points, source) in moves {
        let moved = |values: &[f64]| {
            map(points, |i, j| {
                let (a, b) = source(i, j);
                values[b * nx + a]
            })
        };
        assert_eq!(filled(&moved(&heights), points), moved(&water));
    }
    let stretched = |values: &[f64]| values.iter().map(|z| z.powi(3) + 7.0).collect::<Vec<_>>();
    assert_eq!(filled(&stretched(&heights), [nx, ny]), stretched(&water));
}

#[test]
fn a_flat_map_a_line_and_a_point_have_no_pools() {
    for points in [[4, 3], [12, 1], [1, 12], [1, 1]] {
        let pools = Pools::new(&vec![2.0; points[0] * points[1]], points, Neighbours::Four);
        assert_eq!(pools.unwrap().mean_depth, 0.0);
    }
    // A line repeats across: each of its points leads out along y.
    assert_eq!(filled(&[3.0, 1.0, 2.0, 0.0], [4, 1]), [3.0, 1.0, 2.0, 0.0]);
}

#[test]
fn heights_that_are_no_map_are_refused() {
    let error = |heights: &[f64], points| {
        Pools::new(heights, points, Neighbours::Four).unwrap_err().to_string()
    };
    assert!(error(&[1.0; 5], [2, 3]).starts_with("5 heights on 2 by 3 points"));
    assert!(error(&[], [0, 3]).starts_with("0 heights"));
    assert!(error(&[1.0], [usize::MAX, 2]).starts_with("1 heights"));
    let gap = error(&[0.0, 0.0, 0.0, f64::NAN], [2, 2]);
    assert!(gap.starts_with("the height in column 1, row 1 (counted from 0) is NaN"), "{gap}");
}
