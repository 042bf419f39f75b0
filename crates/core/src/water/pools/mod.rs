//! Valleys of a map that a rubber seals, full of water.

use crate::error_kind::{ErrorKind, HasKind};

/// Points between which water passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Neighbours {
    /// The four along x and y: two points that touch at a corner are a dam. More water.
    Four,
    /// Those across the corners as well: water passes between two such points. Less water.
    Eight,
}

/// A map whose sealed valleys are full of water.
#[derive(Debug, Clone, PartialEq)]
pub struct Pools {
    /// Heights in m of stone and water, row by row along x.
    pub heights: Vec<f64>,
    /// Points under water over all points.
    pub filled_fraction: f64,
    /// Mean depth of the water over all points in m: its volume over the nominal area.
    pub mean_depth: f64,
    /// Largest depth of the water in m.
    pub deepest: f64,
    /// The point `[i, j]` of that depth, of several the first; `None` without water.
    pub deepest_point: Option<[usize; 2]>,
}

/// Why a map has no pools.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PoolsError {
    /// Heights and numbers of points that do not belong together, or too many of them.
    #[error("{heights} heights on {nx} by {ny} points: give one for each point, from 1 to {most}", most = MOST_POINTS)]
    Points {
        /// Heights.
        heights: usize,
        /// Points along x.
        nx: usize,
        /// Points along y.
        ny: usize,
    },
    /// A height that is missing or infinite.
    #[error(
        "the height in column {column}, row {row} (counted from 0) is {value}: fill the gaps of the map first"
    )]
    NotFinite {
        /// Column.
        column: usize,
        /// Row.
        row: usize,
        /// The height.
        value: f64,
    },
}

impl HasKind for PoolsError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// Ways in steps stay far from the ends of their integers.
const MOST_POINTS: usize = 1 << 30;

impl Pools {
    /// Fills the sealed pools of a periodic map (Persson, Tartaglino, Albohr & Tosatti, Nature Materials 3, 882, 2004,
    /// doi:10.1038/nmat1255): rubber that covers a road closes the valleys which have no way out, and slides over stone and
    /// trapped water, which does not yield, as over one rigid surface.
    ///
    /// The level at a point is the lowest height `h` at which the valleys `{z <= h}` that are connected with the point lead
    /// round the period, along x or y or both; from there water goes on for ever. What stays below is a pool:
    ///
    /// ```text
    /// filled(x) = max(z(x), level(x))
    /// ```
    ///
    /// There may be any number of ways out, such as parallel valleys, and each point has the level of its own lowest one.
    ///
    /// `heights` in m of `points` along x and y, row by row along x, growing towards the rubber. Points join the sets of their
    /// lower [`Neighbours`] in ascending order; each set knows the way in steps to its points, so that a second way
    /// of another length leads round the period (Newman & Ziff, Phys. Rev. Lett. 85, 4104, 2000,
    /// doi:10.1103/PhysRevLett.85.4104). Time `N log N`.
    ///
    /// # Errors
    /// [`PoolsError`].
    ///
    /// ```
    /// use asperity_core::water::{Neighbours, Pools};
    ///
    /// // A hole 3 deep in a plain: it is full to the plain.
    /// let mut heights = vec![1.0; 25];
    /// heights[12] = -2.0;
    /// let pools = Pools::new(&heights, [5, 5], Neighbours::Four)?;
    /// assert_eq!((pools.deepest, pools.deepest_point), (3.0, Some([2, 2])));
    /// # Ok::<(), asperity_core::water::PoolsError>(())
    /// ```
    pub fn new(
        heights: &[f64],
        points: [usize; 2],
        neighbours: Neighbours,
    ) -> Result<Self, PoolsError> {
        check(heights, points)?;
        let filled = levels(heights, points, neighbours);
        let depths = || filled.iter().zip(heights).map(|(water, z)| water - z);
        let count = heights.len() as f64;
        let deepest = depths().fold(0.0, f64::max);
        let place = depths().position(|depth| depth > 0.0 && depth == deepest);
        Ok(Self {
            filled_fraction: depths().filter(|depth| *depth > 0.0).count() as f64 / count,
            mean_depth: depths().sum::<f64>() / count,
            deepest,
            deepest_point: place.map(|k| [k % points[0], k / points[0]]),
            heights: filled,
        })
    }
}

fn check(heights: &[f64], [nx, ny]: [usize; 2]) -> Result<(), PoolsError> {
    let fits = nx.checked_mul(ny) == Some(heights.len());
    if !fits || heights.is_empty() || heights.len() > MOST_POINTS {
        return Err(PoolsError::Points { heights: heights.len(), nx, ny });
    }
    match heights.iter().position(|z| !z.is_finite()) {
        None => Ok(()),
        Some(k) => Err(PoolsError::NotFinite { column: k % nx, row: k / nx, value: heights[k] }),
    }
}

/// The height of stone or water at every point.
fn levels(heights: &[f64], points: [usize; 2], neighbours: Neighbours) -> Vec<f64> {
    let mut order: Vec<u32> = (0..heights.len() as u32).collect();
    order.sort_unstable_by(|a, b| {
        let height = |k: u32| heights[k as usize];
        height(*a).total_cmp(&height(*b)).then(a.cmp(b))
    });
    let mut forest = Forest::new(heights.len());
    let mut wet = vec![false; heights.len()];
    let mut level = heights.to_vec();
    for point in order {
        let point = point as usize;
        wet[point] = true;
        for step in steps(neighbours) {
            let other = beside(point, *step, points);
            if wet[other] {
                forest.join(point, other, *step);
            }
        }
        forest.drain(point, |member| level[member] = heights[point]);
    }
    level
}

fn steps(neighbours: Neighbours) -> &'static [[i32; 2]] {
    const STEPS: [[i32; 2]; 8] =
        [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, -1], [1, -1], [-1, 1]];
    match neighbours {
        Neighbours::Four => &STEPS[..4],
        Neighbours::Eight => &STEPS,
    }
}

/// The point a step further, round the period.
fn beside(point: usize, [dx, dy]: [i32; 2], [nx, ny]: [usize; 2]) -> usize {
    let further = |k: usize, step: i32, n: usize| match step {
        1 => (k + 1) % n,
        0 => k,
        _ => (k + n - 1) % n,
    };
    further(point / nx, dy, ny) * nx + further(point % nx, dx, nx)
}

/// No point.
const NONE: u32 = u32::MAX;

/// Disjoint sets of points. Each point knows the way to the root of its set in steps, without the period.
struct Forest {
    parent: Vec<u32>,
    way: Vec<[i32; 2]>,
    size: Vec<u32>,
    /// Of a root: whether its set leads round the period.
    leads_out: Vec<bool>,
    /// Of a root: first and last of its points that have no level yet.
    waiting: Vec<[u32; 2]>,
    /// The next point that waits in the same set.
    next: Vec<u32>,
}

impl Forest {
    fn new(points: usize) -> Self {
        Self {
            parent: (0..points as u32).collect(),
            way: vec![[0, 0]; points],
            size: vec![1; points],
            leads_out: vec![false; points],
            waiting: (0..points as u32).map(|point| [point; 2]).collect(),
            next: vec![NONE; points],
        }
    }

    /// The root of a point and the way there; halves paths as it goes.
    fn find(&mut self, mut point: usize) -> (usize, [i32; 2]) {
        let mut way = [0, 0];
        loop {
            let parent = self.parent[point] as usize;
            if parent == point {
                return (point, way);
            }
            let grandparent = self.parent[parent];
            if grandparent as usize != parent {
                self.way[point] = sum(self.way[point], self.way[parent]);
                self.parent[point] = grandparent;
            }
            way = sum(way, self.way[point]);
            point = self.parent[point] as usize;
        }
    }

    /// Joins the sets of two points, of which `b` is a step from `a`. One set that has another way between them already leads
    /// round the period.
    fn join(&mut self, a: usize, b: usize, step: [i32; 2]) {
        let ((root_a, way_a), (root_b, way_b)) = (self.find(a), self.find(b));
        // From a over b to the root of b.
        let over = sum(step, way_b);
        if root_a == root_b {
            self.leads_out[root_a] |= over != way_a;
            return;
        }
        let between = [over[0] - way_a[0], over[1] - way_a[1]];
        let (child, parent, way) = if self.size[root_a] <= self.size[root_b] {
            (root_a, root_b, between)
        } else {
            (root_b, root_a, [-between[0], -between[1]])
        };
        self.parent[child] = parent as u32;
        self.way[child] = way;
        self.size[parent] += self.size[child];
        self.leads_out[parent] |= self.leads_out[child];
        self.waiting[parent] = self.chain(self.waiting[parent], self.waiting[child]);
    }

    /// One list of two.
    fn chain(&mut self, [first, last]: [u32; 2], [second, end]: [u32; 2]) -> [u32; 2] {
        match (first, second) {
            (NONE, _) => [second, end],
            (_, NONE) => [first, last],
            _ => {
                self.next[last as usize] = second;
                [first, end]
            }
        }
    }

    /// Gives every point that waits in the set of `point` to `level`, if that leads round the period.
    fn drain(&mut self, point: usize, mut level: impl FnMut(usize)) {
        let (root, _) = self.find(point);
        if !self.leads_out[root] {
            return;
        }
        let [mut member, _] = std::mem::replace(&mut self.waiting[root], [NONE; 2]);
        while member != NONE {
            level(member as usize);
            member = self.next[member as usize];
        }
    }
}

fn sum(a: [i32; 2], b: [i32; 2]) -> [i32; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

#[cfg(test)]
mod tests;
