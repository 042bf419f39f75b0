//! Gradients of a map from differences of neighbouring valid points.

use super::HeightMap;
use super::error::ArealError;
use rayon::prelude::*;

/// Means of gradients of a map.
///
/// Each cell of four points has two edges along `x` and two along `y`, and four corners: the triangle of a corner and its
/// two neighbours has the slopes of the two edges. All triangles with three valid points weigh the same, so that a missing
/// point costs only the triangles it is in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gradients {
    /// Sdq: root of the mean square difference along `x` plus that along `y`, each over all its valid pairs.
    pub rms: f64,
    /// Sdr: mean over triangles of `sqrt(1 + zx² + zy²) - 1`.
    pub developed: f64,
    /// Means of `zx²`, `zx zy` and `zy²` over triangles.
    pub tensor: [f64; 3],
}

/// Sums over a row of cells and the edges at its lower side.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// Squares of slopes along `x` and along `y`, and their numbers.
    edges: [[f64; 2]; 2],
    developed: f64,
    tensor: [f64; 3],
    triangles: f64,
}

impl Gradients {
    /// Means over a map.
    ///
    /// # Errors
    /// No triangle of valid points.
    pub fn of(map: &HeightMap) -> Result<Self, ArealError> {
        let [nx, _] = map.points;
        let row = |j: usize| map.heights.get(j * nx..(j + 1) * nx);
        let rows: Vec<Sums> = (0..map.points[1])
            .into_par_iter()
            .filter_map(|j| Some(Sums::of_row(row(j)?, row(j + 1), map.spacing)))
            .collect();
        let total = rows.iter().fold(Sums::default(), Sums::plus);
        if total.triangles == 0.0 {
            return Err(ArealError::NoNeighbours { map: map.name.clone() });
        }
        let mean = |[sum, count]: [f64; 2]| sum / count;
        Ok(Self {
            rms: (mean(total.edges[0]) + mean(total.edges[1])).sqrt(),
            developed: total.developed / total.triangles,
            tensor: total.tensor.map(|sum| sum / total.triangles),
        })
    }

    /// Direction in degrees from `x` towards `y` (0 to 180) along which the gradient is least, and the rms gradient along
    /// it over that across it.
    pub fn least(&self) -> (f64, f64) {
        let [xx, xy, yy] = self.tensor;
        let (mean, difference) = (f64::midpoint(xx, yy), (xx - yy) / 2.0);
        let radius = difference.hypot(xy);
        let angle = (-xy).atan2(-difference).to_degrees() / 2.0;
        // All pairs that differ may be without a third point: no gradient, no direction.
        let square = if mean > 0.0 { (mean - radius).max(0.0) / (mean + radius) } else { 1.0 };
        (angle.rem_euclid(180.0), square.sqrt())
    }
}

impl Sums {
    fn of_row(row: &[f64], next: Option<&[f64]>, [dx, dy]: [f64; 2]) -> Self {
        let mut sums = Self::default();
        for pair in row.windows(2) {
            sums.edge(0, (pair[1] - pair[0]) / dx);
        }
        let Some(next) = next else { return sums };
        for (here, above) in row.iter().zip(next) {
            sums.edge(1, (above - here) / dy);
        }
        for (low, high) in row.windows(2).zip(next.windows(2)) {
            let x = [(low[1] - low[0]) / dx, (high[1] - high[0]) / dx];
            let y = [(high[0] - low[0]) / dy, (high[1] - low[1]) / dy];
            for zx in x {
                for zy in y {
                    sums.triangle(zx, zy);
                }
            }
        }
        sums
    }

    fn edge(&mut self, axis: usize, slope: f64) {
        if !slope.is_nan() {
            self.edges[axis][0] += slope * slope;
            self.edges[axis][1] += 1.0;
        }
    }

    fn triangle(&mut self, zx: f64, zy: f64) {
        let square = zx * zx + zy * zy;
        if !square.is_nan() {
            // sqrt(1 + s) - 1 without cancellation.
            self.developed += square / (1.0 + (1.0 + square).sqrt());
            self.tensor[0] += zx * zx;
            self.tensor[1] += zx * zy;
            self.tensor[2] += zy * zy;
            self.triangles += 1.0;
        }
    }

    fn plus(self, other: &Self) -> Self {
        let add = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        let [a, b] = [self.tensor, other.tensor];
        Self {
            edges: [add(self.edges[0], other.edges[0]), add(self.edges[1], other.edges[1])],
            developed: self.developed + other.developed,
            tensor: [a[0] + b[0], a[1] + b[1], a[2] + b[2]],
            triangles: self.triangles + other.triangles,
        }
    }
}
