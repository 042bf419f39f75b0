//! Sums over pairs of points of a map at all lags, with missing points.
//!
//! With the mask `m` of valid points and `y = m z`, the heights about their mean, the sums over all pairs a lag `s`
//! apart are correlations of fields padded with zeros, so that nothing wraps around:
//!
//! ```text
//! N(s) = m * m                                number of pairs
//! R(s) = (y * y) / N                          mean product, the autocovariance
//! C(s) = (z^2 m * m + m * z^2 m - 2 y * y) / N   mean square difference
//! ```
//!
//! All are even in `s`, so that half of the plane is stored.

use super::HeightMap;
use super::transform::{invert_rows, transform_columns, transform_rows};
use crate::numerics::plane::fast_length;
use crate::surface::CorrelationSample;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;

/// What is averaged over pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PairMean {
    /// Products of heights about their mean.
    Product,
    /// Squares of height differences.
    SquaredDifference,
}

/// Means over pairs in m² at the lags `(k dx, l dy)`, `|k| <= lags[0]`, `|l| <= lags[1]`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LagPlane {
    /// Largest lags along `x` and `y` as numbers of spacings.
    pub lags: [usize; 2],
    /// Distances in m between lags.
    pub spacing: [f64; 2],
    /// Those of `l >= 0`, row by row, `k` from `-lags[0]`; NaN without pairs.
    values: Vec<f64>,
    /// Numbers of pairs, as `values`.
    pairs: Vec<f64>,
}

impl LagPlane {
    /// Means over the pairs of a map, heights about `mean` (m). The absolute error is about `2e-15 Sq^2`.
    pub fn of(map: &HeightMap, mean: f64, lags: [usize; 2], kind: PairMean) -> Self {
        let lags = [0, 1].map(|axis| lags[axis].min(map.points[axis] - 1));
        // Padding by the largest lag keeps what wraps around beyond it.
        let length = [0, 1].map(|axis| fast_length(map.points[axis] + lags[axis]));
        let valid = |n: usize| !map.heights[n].is_nan();
        let height = |n: usize| if valid(n) { map.heights[n] - mean } else { 0.0 };
        let mut fields = vec![
            transform_rows(map.points, length[0], |n| if valid(n) { 1.0 } else { 0.0 }),
            transform_rows(map.points, length[0], height),
        ];
        if kind == PairMean::SquaredDifference {
            fields.push(transform_rows(map.points, length[0], |n| height(n).powi(2)));
        }
        let (width, rows) = (2 * lags[0] + 1, lags[1] + 1);
        let columns = products(&fields, length, rows);
        drop(fields);
        let scale = 1.0 / (length[0] * length[1]) as f64;
        let plane = |offset: usize| {
            let mut plane = vec![0.0; width * rows];
            let stride = [offset, 2 * rows];
            invert_rows(&columns, stride, length[0], width, &mut plane, |line, kept| {
                let (negative, positive) = kept.split_at_mut(lags[0]);
                positive.copy_from_slice(&line[..=lags[0]]);
                negative.copy_from_slice(&line[line.len() - lags[0]..]);
                kept.iter_mut().for_each(|value| *value *= scale);
            });
            plane
        };
        let (mut pairs, mut values) = (plane(0), plane(rows));
        for (value, pairs) in values.iter_mut().zip(&mut pairs) {
            *pairs = pairs.round().max(0.0);
            *value = if *pairs > 0.0 { *value / *pairs } else { f64::NAN };
            if kind == PairMean::SquaredDifference {
                *value = if value.is_nan() { f64::NAN } else { value.max(0.0) };
            }
        }
        Self { lags, spacing: map.spacing, values, pairs }
    }

    /// Mean and number of pairs at a lag; `None` outside the plane or without pairs.
    pub fn get(&self, [k, l]: [isize; 2]) -> Option<(f64, f64)> {
        let (k, l) = if l < 0 { (-k, -l) } else { (k, l) };
        let column = usize::try_from(k + self.lags[0] as isize).ok()?;
        let (row, width) = (l as usize, 2 * self.lags[0] + 1);
        if column >= width || row > self.lags[1] {
            return None;
        }
        let n = row * width + column;
        (self.pairs[n] > 0.0).then(|| (self.values[n], self.pairs[n]))
    }

    /// Mean and number of pairs at a lag in spacings of which one component is a whole number: between the points of
    /// the plane along the other one, the mean follows the cubic polynomial through four of them (a line through two
    /// where one of the four has no pairs).
    pub fn between(&self, lag: [f64; 2]) -> Option<(f64, f64)> {
        let axis = usize::from((lag[1] - lag[1].round()).abs() > (lag[0] - lag[0].round()).abs());
        let whole = lag[1 - axis].round() as isize;
        // Angles are rounded: within a billionth of a spacing the lag is that of the point.
        let nearest = lag[axis].round();
        let floor = if (lag[axis] - nearest).abs() < 1e-9 { nearest } else { lag[axis].floor() };
        let (low, t) = (floor as isize, lag[axis] - floor);
        let at = |step: isize| {
            let mut lag = [whole; 2];
            lag[axis] = low + step;
            self.get(lag)
        };
        let here = at(0)?;
        if t.abs() < 1e-9 {
            return Some(here);
        }
        let next = at(1)?;
        let pairs = here.1 + t * (next.1 - here.1);
        let value = match (at(-1), at(2)) {
            (Some(before), Some(after)) => cubic([before.0, here.0, next.0, after.0], t),
            _ => here.0 + t * (next.0 - here.0),
        };
        Some((value, pairs))
    }

    /// The step in spacings, along a ray at `angle` (degrees from `x` towards `y`), from one to the next point at which
    /// the faster growing component is a whole number, and its length in m.
    pub fn ray(&self, angle: f64) -> ([f64; 2], f64) {
        let (sin, cos) = angle.to_radians().sin_cos();
        let step = [cos / self.spacing[0], sin / self.spacing[1]];
        let length = 1.0 / step[0].abs().max(step[1].abs());
        (step.map(|component| component * length), length)
    }

    /// Mean and number of pairs at a distance `lag` (m) along a ray at `angle` degrees: between the points of
    /// [`Self::ray`] by a power law, or a line if a mean is not positive. None before the first and after the last.
    pub fn along(&self, angle: f64, lag: f64) -> Option<CorrelationSample> {
        let (step, length) = self.ray(angle);
        let position = lag / length;
        let nearest = position.round();
        let floor = if (position - nearest).abs() < 1e-9 { nearest } else { position.floor() };
        if floor < 1.0 {
            return None;
        }
        let at = |n: f64| self.between(step.map(|component| n * component));
        let (here, pairs) = at(floor)?;
        if (position - floor).abs() < 1e-9 {
            return Some(CorrelationSample { lag, value: here, pairs: pairs.round() as u64 });
        }
        let (next, next_pairs) = at(floor + 1.0)?;
        let value = if here > 0.0 && next > 0.0 {
            let t = (position / floor).ln() / (1.0 + 1.0 / floor).ln();
            here * (next / here).powf(t)
        } else {
            here + (position - floor) * (next - here)
        };
        let pairs = pairs + (position - floor) * (next_pairs - pairs);
        Some(CorrelationSample { lag, value, pairs: pairs.round() as u64 })
    }
}

impl LagPlane {
    /// Number of steps along a ray, from lag zero, after which the mean first crosses `level` (m²). Between two points the
    /// mean follows the cubic polynomial through four. Returns `None` if it does not cross within the plane.
    pub fn crossing(&self, step: [f64; 2], level: f64) -> Option<f64> {
        let at = |n: f64| self.between(step.map(|c| n * c)).map(|(value, _)| value - level);
        let start = at(0.0)?;
        let (mut before, mut n) = (start, 1.0);
        let after = loop {
            let value = at(n)?;
            if value * start <= 0.0 {
                break value;
            }
            (before, n) = (value, n + 1.0);
        };
        let line = before / (before - after);
        let (Some(first), Some(last)) = (at(n - 2.0), at(n + 1.0)) else {
            return Some(n - 1.0 + line);
        };
        let (mut low, mut high) = (0.0, 1.0);
        // Halving to round-off of a step.
        for _ in 0..50 {
            let middle = f64::midpoint(low, high);
            match cubic([first, before, after, last], middle) * start > 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        Some(n - 1.0 + low)
    }

    /// Shortest and longest distance in m, over all directions, at which the mean first crosses `level` along a ray from
    /// lag zero to the border of the plane, and whether it does so in every direction: the longest is a lower bound if
    /// not. Returns `None` if it does not cross in any direction.
    pub fn crossings(&self, level: f64) -> Option<(f64, f64, bool)> {
        let [x, y] = self.lags.map(|lag| lag as isize);
        let sides = (0..=y).flat_map(|l| [[-x, l], [x, l]]);
        let (mut shortest, mut longest, mut all) = (f64::INFINITY, 0.0, true);
        for end in sides.chain((1 - x..x).map(|k| [k, y])) {
            let steps = end[0].abs().max(end[1].abs()) as f64;
            let step = end.map(|lag| lag as f64 / steps);
            let length = (step[0] * self.spacing[0]).hypot(step[1] * self.spacing[1]);
            let crossing = self.crossing(step, level);
            shortest = crossing.map_or(shortest, |n| shortest.min(n * length));
            longest = (crossing.unwrap_or(steps) * length).max(longest);
            all &= crossing.is_some();
        }
        shortest.is_finite().then_some((shortest, longest, all))
    }
}

/// Transforms of pairs and sums back along `y`: for each wavenumber along `x`, `rows` values of the pairs and as many of
/// the sums. The fields are mask, heights and, for squared differences, squares.
fn products(fields: &[Vec<Complex64>], length: [usize; 2], rows: usize) -> Vec<Complex64> {
    let bins = length[0] / 2 + 1;
    let mut kept = vec![Complex64::ZERO; bins * 2 * rows];
    let inverse = FftPlanner::new().plan_fft_inverse(length[1]);
    transform_columns(fields, bins, length[1], &mut kept, |_, columns, kept| {
        let (mask, rest) = columns.split_at_mut(length[1]);
        let (heights, squares) = rest.split_at_mut(length[1]);
        for (n, (m, y)) in mask.iter_mut().zip(heights.iter_mut()).enumerate() {
            let product = y.norm_sqr();
            let sum = squares.get(n).map_or(product, |w| 2.0 * ((*w * m.conj()).re - product));
            *m = m.norm_sqr().into();
            *y = sum.into();
        }
        inverse.process(mask);
        inverse.process(heights);
        kept[..rows].copy_from_slice(&mask[..rows]);
        kept[rows..].copy_from_slice(&heights[..rows]);
    });
    kept
}

/// The cubic polynomial through values at -1, 0, 1 and 2, at `t`.
pub(super) fn cubic([a, b, c, d]: [f64; 4], t: f64) -> f64 {
    let inner = b * (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0 - c * (t + 1.0) * t * (t - 2.0) / 2.0;
    inner - a * t * (t - 1.0) * (t - 2.0) / 6.0 + d * (t + 1.0) * t * (t - 1.0) / 6.0
}
