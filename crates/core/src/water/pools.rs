//! Valleys of a map that a sliding rubber seals, full of water.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// A map with its pools filled.
#[derive(Debug, Clone, PartialEq)]
pub struct Pools {
    /// Heights in m of stone and water, row by row along x.
    pub heights: Vec<f64>,
    /// Height in m of the lowest network of valleys that leads out of the map.
    pub outlet: f64,
    /// Points under water over all points.
    pub filled_fraction: f64,
    /// Mean depth of the water over all points, in m.
    pub mean_depth: f64,
}

/// Fills the pools of a periodic map to the level at which they spill (Persson, Tartaglino, Albohr & Tosatti, Nature
/// Materials 3, 882, 2004, doi:10.1038/nmat1255): rubber that covers a road closes pools which have no way out, and slides on the filled
/// surface as if it were dry, where the water is as stiff as the road.
///
/// Water finds a way out along the lowest network of valleys that crosses the map and, as the map is periodic, goes on
/// for ever. All points are under water that no path to this network leaves below their level:
///
/// ```text
/// filled(x) = max(z(x), min over paths to the network of the highest point on the path)
/// ```
///
/// `heights` in m of `points` along x and y, row by row along x. Water moves between the four neighbours of a point.
/// The network is found by a union of points in ascending order (Newman & Ziff, Phys. Rev. Lett. 85, 4104, 2000,
/// doi:10.1103/PhysRevLett.85.4104), the levels by a priority flood (Barnes, Lehman & Mulla, Comput. Geosci. 62, 117, 2014,
/// doi:10.1016/j.cageo.2013.04.024): N log N in both.
///
/// # Panics
/// If the number of heights is not the product of the points, there is none, or one is not finite.
pub fn fill_pools(heights: &[f64], points: [usize; 2]) -> Pools {
    assert!(
        heights.len() == points[0] * points[1] && !heights.is_empty(),
        "a height for each point"
    );
    assert!(heights.iter().all(|z| z.is_finite()), "heights must be finite");
    let (outlet, seeds) = network(heights, points);
    let filled = flood(heights, points, &seeds);
    let depth = |(water, z): (&f64, &f64)| water - z;
    let count = heights.len() as f64;
    let under = filled.iter().zip(heights).filter(|(water, z)| *water > *z).count();
    Pools {
        filled_fraction: under as f64 / count,
        mean_depth: filled.iter().zip(heights).map(depth).sum::<f64>() / count,
        heights: filled,
        outlet,
    }
}

/// The four neighbours of a point, with the step to each.
fn neighbours(point: usize, [nx, ny]: [usize; 2]) -> [(usize, [i64; 2]); 4] {
    let (i, j) = (point % nx, point / nx);
    let at = |i: usize, j: usize| j * nx + i;
    [
        (at((i + 1) % nx, j), [1, 0]),
        (at((i + nx - 1) % nx, j), [-1, 0]),
        (at(i, (j + 1) % ny), [0, 1]),
        (at(i, (j + ny - 1) % ny), [0, -1]),
    ]
}

/// The level at which valleys first lead out of the map, and the points of the network below it.
fn network(heights: &[f64], points: [usize; 2]) -> (f64, Vec<usize>) {
    let mut order: Vec<usize> = (0..heights.len()).collect();
    order.sort_by(|a, b| heights[*a].total_cmp(&heights[*b]));
    let mut forest = Forest::new(heights.len());
    let mut wet = vec![false; heights.len()];
    for point in order {
        wet[point] = true;
        for (other, step) in neighbours(point, points) {
            if wet[other] && forest.join(point, other, step) {
                let root = forest.find(point).0;
                let members = (0..heights.len()).filter(|k| wet[*k]).collect::<Vec<_>>();
                let network = members.into_iter().filter(|k| forest.find(*k).0 == root).collect();
                return (heights[point], network);
            }
        }
    }
    unreachable!("all points together lead out of a periodic map")
}

/// Disjoint sets of points that know the way from each point to the root of its set, counted in steps without the
/// period: two ways that differ lead around the map.
struct Forest {
    parent: Vec<u32>,
    way: Vec<[i64; 2]>,
    size: Vec<u32>,
}

impl Forest {
    fn new(points: usize) -> Self {
        Self {
            parent: (0..points as u32).collect(),
            way: vec![[0, 0]; points],
            size: vec![1; points],
        }
    }

    /// The root of a point and the way there; halves paths on the way.
    fn find(&mut self, mut point: usize) -> (usize, [i64; 2]) {
        let mut way = [0, 0];
        loop {
            let parent = self.parent[point] as usize;
            if parent == point {
                return (point, way);
            }
            let grandparent = self.parent[parent] as usize;
            if grandparent != parent {
                self.way[point] = sum(self.way[point], self.way[parent]);
                self.parent[point] = grandparent as u32;
            }
            way = sum(way, self.way[point]);
            point = self.parent[point] as usize;
        }
    }

    /// Joins the sets of two neighbours, of which the second is a step from the first; whether they were one set already
    /// and the step closes a way around the map.
    fn join(&mut self, a: usize, b: usize, step: [i64; 2]) -> bool {
        let ((root_a, way_a), (root_b, way_b)) = (self.find(a), self.find(b));
        // From a over b to the root of b.
        let over = sum(step, way_b);
        if root_a == root_b {
            return over != way_a;
        }
        let difference = [over[0] - way_a[0], over[1] - way_a[1]];
        let (child, parent, way) = if self.size[root_a] <= self.size[root_b] {
            (root_a, root_b, difference)
        } else {
            (root_b, root_a, [-difference[0], -difference[1]])
        };
        self.parent[child] = parent as u32;
        self.way[child] = way;
        self.size[parent] += self.size[child];
        false
    }
}

fn sum(a: [i64; 2], b: [i64; 2]) -> [i64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// A point of the shore, the lowest first.
#[derive(PartialEq)]
struct Shore(f64, usize);

impl Eq for Shore {}

impl PartialOrd for Shore {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Shore {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}

/// Levels of the water that has no way to the seeds.
fn flood(heights: &[f64], points: [usize; 2], seeds: &[usize]) -> Vec<f64> {
    let mut level = vec![f64::NAN; heights.len()];
    let mut shore = BinaryHeap::new();
    for seed in seeds {
        level[*seed] = heights[*seed];
        shore.push(Reverse(Shore(heights[*seed], *seed)));
    }
    while let Some(Reverse(Shore(height, point))) = shore.pop() {
        for (other, _) in neighbours(point, points) {
            if level[other].is_nan() {
                level[other] = heights[other].max(height);
                shore.push(Reverse(Shore(level[other], other)));
            }
        }
    }
    level
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use std::f64::consts::TAU;

    /// A smooth random map, uneven in size.
    fn random([nx, ny]: [usize; 2], seed: u64) -> Vec<f64> {
        let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
        let waves: Vec<[f64; 4]> = (0..40)
            .map(|_| {
                let mut whole = || f64::from(random.random_range(-6_i32..=6));
                let (m, n) = (whole(), whole());
                [m, n, random.random::<f64>() * TAU, random.random::<f64>()]
            })
            .collect();
        let height = |k: usize| {
            let (x, y) = ((k % nx) as f64 / nx as f64, (k / nx) as f64 / ny as f64);
            waves.iter().map(|[m, n, phase, a]| a * (TAU * (m * x + n * y) + phase).sin()).sum()
        };
        (0..nx * ny).map(height).collect()
    }

    /// One crater in a plain with a channel: it fills to its rim, and the channel stays dry.
    #[test]
    fn a_crater_fills_to_its_rim() {
        let (n, rim, floor) = (48, 3.0, -5.0);
        let height = |k: usize| {
            let (i, j) = (k % n, k / n);
            let radius = ((i as f64 - 24.0).powi(2) + (j as f64 - 24.0).powi(2)).sqrt();
            match radius {
                r if r < 6.0 => floor,
                r if r < 9.0 => rim,
                // Below the floor of the crater, all along x.
                _ if j == 2 => -7.0,
                _ => 0.0,
            }
        };
        let heights: Vec<f64> = (0..n * n).map(height).collect();
        let pools = fill_pools(&heights, [n, n]);
        assert_eq!(pools.outlet, -7.0);
        for (k, (water, z)) in pools.heights.iter().zip(&heights).enumerate() {
            let expected = if *z == floor { rim } else { *z };
            assert_eq!(*water, expected, "point {k}");
        }
        let inside = heights.iter().filter(|z| **z == floor).count() as f64;
        assert_eq!(pools.filled_fraction, inside / (n * n) as f64);
        approx::assert_relative_eq!(
            pools.mean_depth,
            8.0 * pools.filled_fraction,
            max_relative = 1e-12
        );
    }

    #[test]
    fn filling_twice_changes_nothing_and_never_lowers() {
        for seed in 0..20 {
            let points = [31, 44];
            let heights = random(points, seed);
            let once = fill_pools(&heights, points);
            assert!(once.heights.iter().zip(&heights).all(|(water, z)| water >= z));
            let twice = fill_pools(&once.heights, points);
            assert_eq!(once.heights, twice.heights);
            assert_eq!((twice.filled_fraction, once.outlet), (0.0, twice.outlet));
        }
    }

    /// Levels by relaxation over all paths, and the network by trying levels, without queue or forest.
    #[test]
    fn levels_are_those_of_the_lowest_path() {
        for seed in 100..110 {
            let points = [17, 13];
            let heights = random(points, seed);
            let pools = fill_pools(&heights, points);
            let wraps = |level: f64| way_around(&heights, points, level);
            let mut sorted = heights.clone();
            sorted.sort_by(f64::total_cmp);
            let first = sorted.iter().find(|level| wraps(**level).is_some()).unwrap();
            assert_eq!(pools.outlet, *first);
            let network = wraps(*first).unwrap();
            let mut level: Vec<f64> = (0..heights.len())
                .map(|k| if network[k] { heights[k] } else { f64::INFINITY })
                .collect();
            loop {
                let before = level.clone();
                for k in 0..level.len() {
                    for (other, _) in neighbours(k, points) {
                        level[k] = level[k].min(heights[k].max(level[other]));
                    }
                }
                if level == before {
                    break;
                }
            }
            assert_eq!(pools.heights, level);
        }
    }

    /// The points at or below a level from which one comes back to the same point of another period, if there are any: a walk over
    /// three by three periods.
    fn way_around(heights: &[f64], [nx, ny]: [usize; 2], level: f64) -> Option<Vec<bool>> {
        let periods = 9;
        let (wide, high) = (periods * nx, periods * ny);
        for start in (0..heights.len()).filter(|k| heights[*k] <= level) {
            let (i, j) = (start % nx + (periods / 2) * nx, start / nx + (periods / 2) * ny);
            let mut seen = vec![false; wide * high];
            let mut open = vec![(i, j)];
            seen[j * wide + i] = true;
            while let Some((i, j)) = open.pop() {
                let near = [(i + 1, j), (i.wrapping_sub(1), j), (i, j + 1), (i, j.wrapping_sub(1))];
                for (a, b) in near.into_iter().filter(|(a, b)| *a < wide && *b < high) {
                    if !seen[b * wide + a] && heights[(b % ny) * nx + a % nx] <= level {
                        seen[b * wide + a] = true;
                        open.push((a, b));
                    }
                }
            }
            let mut own = vec![0; heights.len()];
            for (k, _) in seen.iter().enumerate().filter(|(_, seen)| **seen) {
                own[(k / wide % ny) * nx + k % wide % nx] += 1;
            }
            if own[start] > 1 {
                return Some(own.iter().map(|count| *count > 0).collect());
            }
        }
        None
    }

    #[test]
    fn a_line_of_points_and_a_flat_map_have_no_pools() {
        assert_eq!(fill_pools(&[1.0], [1, 1]).filled_fraction, 0.0);
        let flat = fill_pools(&[2.0; 12], [4, 3]);
        assert_eq!((flat.filled_fraction, flat.outlet), (0.0, 2.0));
        // Ridges along y: every valley leads out along y.
        let ridges: Vec<f64> =
            (0..64 * 8).map(|k| (TAU * f64::from(k % 64) / 16.0).sin()).collect();
        assert_eq!(fill_pools(&ridges, [64, 8]).filled_fraction, 0.0);
    }
}
