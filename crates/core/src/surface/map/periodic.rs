//! A map as a periodic surface without waves shorter than a given one, as [`crate::surface::periodic`] for lines.

use super::HeightMap;
use crate::error_kind::{ErrorKind, HasKind};
use crate::numerics::plane::{Transform, fast_length};
use crate::surface::Closure;
use crate::surface::periodic::{BLENDED, blend_weight, blended_points};
use rustfft::num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// The same tolerance of wavelengths as elsewhere.
const ROUND_OFF: f64 = 1e-9;
/// A map needs as many of the shortest waves along each direction, and as many points.
const FEWEST_WAVES: f64 = 4.0;
const FEWEST_POINTS: usize = 8;

/// Heights of one period of a surface that is periodic in both directions, on a grid that resolves all of its waves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PeriodicMap {
    /// Heights in m about their mean, row by row as those of a [`HeightMap`].
    pub heights: Vec<f64>,
    /// Points `[nx, ny]` along `x` and `y`, more than two on every wave.
    pub points: [usize; 2],
    /// Periods in m along `x` and `y`.
    pub periods: [f64; 2],
    /// Shortest wavelength in m, in any direction.
    pub shortest: f64,
}

/// Why a map is no periodic surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PeriodicMapError {
    /// Heights are missing.
    #[error("map {map}: {missing} of {points} heights are missing; fill them first")]
    Missing {
        /// Name of the map.
        map: String,
        /// Missing heights.
        missing: usize,
        /// Points in all.
        points: usize,
    },
    /// The points are too far apart, or the map is too small.
    #[error(
        "map {map}: its points are {spacing_mm} mm apart over {length_mm} mm, and waves of {shortest_mm} mm and more are asked \
         for; a wave needs two points, and a map four waves along each direction"
    )]
    Unresolved {
        /// Name of the map.
        map: String,
        /// Spacing in mm along the direction that does not suffice.
        spacing_mm: f64,
        /// Length in mm along it.
        length_mm: f64,
        /// Shortest wavelength in mm.
        shortest_mm: f64,
    },
}

impl HasKind for PeriodicMapError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

impl PeriodicMap {
    /// The surface of a complete map with waves of `shortest` metres and longer, whatever their direction, and the mean
    /// square in m² of the heights that are shorter and left out.
    ///
    /// # Errors
    /// [`PeriodicMapError`].
    pub fn new(
        map: &HeightMap,
        closure: Closure,
        shortest: f64,
    ) -> Result<(Self, f64), PeriodicMapError> {
        check(map, shortest)?;
        let (closed, points) = match closure {
            Closure::Mirror => mirrored(map),
            Closure::Blend => blended(map),
        };
        let periods = [0, 1].map(|axis| points[axis] as f64 * map.spacing[axis]);
        let mean = closed.iter().sum::<f64>() / closed.len() as f64;
        let variance = closed.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / closed.len() as f64;
        let mut transform = Transform::new(points);
        transform.real.copy_from_slice(&closed);
        drop(closed);
        transform.forward();
        let modes = Modes { points, spectrum: &transform.spectrum };
        let least = resolving(periods, shortest);
        let inside = |kx: f64, ky: f64| is_kept([kx, ky], periods, shortest);
        let mut heights = modes.on_grid(least, inside);
        let largest = map.heights.iter().fold(0.0_f64, |most, z| most.max(z.abs()));
        if heights.iter().all(|z| z.abs() <= ROUND_OFF * largest) {
            // What is left of a level map is round-off.
            heights.fill(0.0);
        }
        let kept = heights.iter().map(|z| z * z).sum::<f64>() / heights.len() as f64;
        Ok((Self { heights, points: least, periods, shortest }, (variance - kept).max(0.0)))
    }

    /// Heights in m on another grid of the same periods: the same sum of waves.
    ///
    /// On a grid with fewer points than two on a wave the shortest waves are left out, not mistaken for longer ones.
    pub fn sample(&self, points: [usize; 2]) -> Vec<f64> {
        if points == self.points {
            return self.heights.clone();
        }
        let mut transform = Transform::new(self.points);
        transform.real.copy_from_slice(&self.heights);
        transform.forward();
        Modes { points: self.points, spectrum: &transform.spectrum }.on_grid(points, |_, _| true)
    }

    /// Points of a grid with at least so many on the shortest wave: products of 2, 3 and 5 that are multiples of 8, so that
    /// transforms are fast and three coarser grids are every second point.
    pub fn grid(&self, per_wave: f64) -> [usize; 2] {
        self.periods.map(|period| {
            let least = (per_wave * period / self.shortest * (1.0 - ROUND_OFF)).ceil() as usize;
            8 * fast_length(least.div_ceil(8).max(2))
        })
    }

    /// Whether it has no wave.
    pub fn is_flat(&self) -> bool {
        self.heights.iter().all(|z| *z == 0.0)
    }

    /// Its root mean square height and gradient, skewness and kurtosis.
    pub fn roughness(&self) -> MapRoughness {
        let count = self.heights.len() as f64;
        let mean = |power: i32| self.heights.iter().map(|z| z.powi(power)).sum::<f64>() / count;
        let rms_height = mean(2).sqrt();
        let mut transform = Transform::new(self.points);
        transform.real.copy_from_slice(&self.heights);
        transform.forward();
        let [nx, ny] = self.points;
        let mut square = 0.0;
        for (bin, column) in transform.spectrum.chunks_exact(ny).enumerate() {
            let pairs = if bin == 0 || 2 * bin == nx { 1.0 } else { 2.0 };
            for (j, coefficient) in column.iter().enumerate() {
                let q = std::f64::consts::TAU
                    * (bin as f64 / self.periods[0]).hypot(signed(j, ny) / self.periods[1]);
                square += pairs * (q * coefficient.norm()).powi(2);
            }
        }
        MapRoughness {
            rms_height,
            rms_gradient: square.sqrt() / count,
            skewness: mean(3) / rms_height.powi(3),
            kurtosis: mean(4) / rms_height.powi(4),
        }
    }
}

/// Roughness of a periodic map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapRoughness {
    /// Root mean square height in m.
    pub rms_height: f64,
    /// Root mean square of the length of the gradient.
    pub rms_gradient: f64,
    /// Mean cube of the heights over that of their root mean square.
    pub skewness: f64,
    /// Mean fourth power of the heights over that of their root mean square.
    pub kurtosis: f64,
}

/// The fewest points, products of 2, 3 and 5, that resolve all waves of a surface.
pub(super) fn resolving(periods: [f64; 2], shortest: f64) -> [usize; 2] {
    periods.map(|period| {
        let highest = (period / shortest * (1.0 + ROUND_OFF)).floor() as usize;
        // One more than two on the shortest wave: its phase is known.
        2 * fast_length(highest + 1)
    })
}

/// Length in m over which the ends of a blended map pass into each other, by its period.
pub fn blended_length(period: f64) -> f64 {
    // Of the window, of which the period is what is left.
    period * BLENDED / (1.0 - BLENDED)
}

/// Whether a wave of these numbers in the periods is no shorter than the shortest one.
pub(super) fn is_kept([kx, ky]: [f64; 2], periods: [f64; 2], shortest: f64) -> bool {
    (kx / periods[0]).hypot(ky / periods[1]) <= (1.0 + ROUND_OFF) / shortest
}

/// The number of a coefficient, from `-n/2` to `n/2`.
pub(super) fn signed(j: usize, n: usize) -> f64 {
    if 2 * j <= n { j as f64 } else { j as f64 - n as f64 }
}

/// Coefficients of a field on a grid, as a [`Transform`] leaves them.
struct Modes<'a> {
    points: [usize; 2],
    spectrum: &'a [Complex64],
}

impl Modes<'_> {
    /// The field on another grid, without its mean and with the waves alone whose numbers `keep` admits. Waves that either
    /// grid has two points on or fewer are left out.
    fn on_grid(&self, to: [usize; 2], keep: impl Fn(f64, f64) -> bool) -> Vec<f64> {
        let [_, from_y] = self.points;
        let mut target = Transform::new(to);
        let scale = 1.0 / (self.points[0] * self.points[1]) as f64;
        let resolved = |k: f64, axis: usize| 2.0 * k.abs() < self.points[axis].min(to[axis]) as f64;
        for (bin, column) in self.spectrum.chunks_exact(from_y).enumerate() {
            let kx = bin as f64;
            if !resolved(kx, 0) {
                break;
            }
            for (j, coefficient) in column.iter().enumerate() {
                let ky = signed(j, from_y);
                let is_mean = bin == 0 && j == 0;
                if is_mean || !resolved(ky, 1) || !keep(kx, ky) {
                    continue;
                }
                let place = if ky < 0.0 { to[1] - (-ky) as usize } else { ky as usize };
                target.spectrum[bin * to[1] + place] = coefficient * scale;
            }
        }
        target.backward();
        target.real
    }
}

fn check(map: &HeightMap, shortest: f64) -> Result<(), PeriodicMapError> {
    let missing = map.missing();
    if missing > 0 {
        let (map, points) = (map.name.clone(), map.heights.len());
        return Err(PeriodicMapError::Missing { map, missing, points });
    }
    for axis in 0..2 {
        let (spacing, length) = (map.spacing[axis], map.lengths()[axis]);
        let enough = map.points[axis] >= FEWEST_POINTS && length >= FEWEST_WAVES * shortest;
        if !enough || 2.0 * spacing > shortest * (1.0 + ROUND_OFF) {
            return Err(PeriodicMapError::Unresolved {
                map: map.name.clone(),
                spacing_mm: 1e3 * spacing,
                length_mm: 1e3 * length,
                shortest_mm: 1e3 * shortest,
            });
        }
    }
    Ok(())
}

/// The map, its mirror images along each direction, and that along both.
fn mirrored(map: &HeightMap) -> (Vec<f64>, [usize; 2]) {
    let [nx, ny] = map.points;
    let mut closed = Vec::with_capacity(4 * nx * ny);
    for j in (0..ny).chain((0..ny).rev()) {
        let row = &map.heights[j * nx..][..nx];
        closed.extend_from_slice(row);
        closed.extend(row.iter().rev());
    }
    (closed, [2 * nx, 2 * ny])
}

/// The last columns pass into the first ones, then the last rows.
fn blended(map: &HeightMap) -> (Vec<f64>, [usize; 2]) {
    let [nx, ny] = map.points;
    let [over_x, over_y] = map.points.map(blended_points);
    let (columns, rows) = (nx - over_x, ny - over_y);
    let mut closed = Vec::with_capacity(columns * ny);
    for row in map.heights.chunks_exact(nx) {
        closed.extend_from_slice(&row[..columns]);
        let start = closed.len() - columns;
        for (i, z) in closed[start..].iter_mut().enumerate().take(over_x) {
            let weight = blend_weight(i, over_x);
            *z = weight * *z + (1.0 - weight) * row[columns + i];
        }
    }
    let (kept, end) = closed.split_at_mut(rows * columns);
    for (j, end) in end.chunks_exact(columns).enumerate() {
        let weight = blend_weight(j, over_y);
        for (z, last) in kept[j * columns..].iter_mut().zip(end) {
            *z = weight * *z + (1.0 - weight) * last;
        }
    }
    closed.truncate(rows * columns);
    (closed, [columns, rows])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Waves of given numbers on 40 by 24 points, 0.05 and 0.1 mm apart: 2 by 2.4 mm.
    fn map(height: impl Fn(f64, f64) -> f64) -> HeightMap {
        let points = [40, 24];
        let place = |k: usize| ((k % 40) as f64 / 40.0, (k / 40) as f64 / 24.0);
        let heights = (0..960).map(place).map(|(x, y)| height(x, y)).collect();
        HeightMap { name: "m".into(), points, spacing: [5e-5, 1e-4], heights }
    }

    #[test]
    fn a_mirrored_cosine_is_itself_on_any_grid() {
        // Half waves between the centres of cells close without a kink when mirrored.
        let cell = |u: f64, n: f64| TAU * (u + 0.5 / n);
        let original =
            map(|x, y| 1e-5 * (1.5 * cell(x, 40.0)).cos() * (cell(y, 24.0)).cos() + 3e-4);
        let (surface, left_out) = PeriodicMap::new(&original, Closure::Mirror, 4e-4).unwrap();
        approx::assert_relative_eq!(surface.periods[0], 4e-3, max_relative = 1e-12);
        approx::assert_relative_eq!(surface.periods[1], 4.8e-3, max_relative = 1e-12);
        assert!(left_out < 1e-25, "{left_out}");
        let fine = surface.sample([160, 96]);
        for (k, z) in fine.iter().enumerate() {
            let (x, y) = ((k % 160) as f64 / 160.0, (k / 160) as f64 / 96.0);
            let (x, y) = (2.0 * x, 2.0 * y);
            let expected = 1e-5 * (1.5 * cell(x, 40.0)).cos() * cell(y, 24.0).cos();
            assert!((z - expected).abs() < 1e-17, "{k}: {z} {expected}");
        }
        let rough = surface.roughness();
        approx::assert_relative_eq!(rough.rms_height, 0.5e-5, max_relative = 1e-12);
        // Waves of 4/3 and 2.4 mm.
        let gradient = 0.5e-5 * (TAU / (4e-3 / 3.0)).hypot(TAU / 2.4e-3);
        approx::assert_relative_eq!(rough.rms_gradient, gradient, max_relative = 1e-12);
    }

    #[test]
    fn short_waves_of_any_direction_are_left_out() {
        let wave = |x: f64, y: f64, m: f64, n: f64| (TAU * (m * x + n * y)).sin();
        // 2 by 2.4 mm, not blended: the numbers of waves on the part that stays are whole.
        let original = map(|x, y| 1e-5 * wave(x, y, 3.0, 0.0) + 2e-6 * wave(x, y, 7.0, 8.0));
        let (surface, left_out) = PeriodicMap::new(&original, Closure::Mirror, 2.5e-4).unwrap();
        // 2/7 and 0.3 mm along the axes, 0.207 mm across the crests.
        assert!((left_out / 2e-12 - 1.0).abs() < 0.1, "{left_out}");
        assert!((surface.roughness().rms_height / 0.707e-5 - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_blended_map_closes_and_keeps_its_middle() {
        let original = map(|x, y| 1e-4 * (x - 0.4 * y) + 1e-6 * (9.0 * x).sin());
        let (closed, points) = blended(&original);
        assert_eq!(points, [38, 23]);
        let steep = closed.chunks_exact(38).map(|row| (row[0] - row[37]).abs()).fold(0.0, f64::max);
        // Without blending the step is that of the whole tilt, 1e-4.
        assert!(steep < 6e-5, "{steep}");
        assert_eq!(closed[10 * 38 + 20], original.heights[10 * 40 + 20]);
    }

    #[test]
    fn grids_have_factors_of_two_three_and_five_and_can_be_halved() {
        let (surface, _) = PeriodicMap::new(&map(|x, _| 1e-5 * x), Closure::Mirror, 4e-4).unwrap();
        assert_eq!(surface.points, [24, 30], "10 and 12 waves");
        assert_eq!(surface.grid(8.0), [80, 96]);
        assert_eq!(surface.grid(8.1), [96, 120]);
    }

    #[test]
    fn small_coarse_and_gappy_maps_are_refused() {
        let fine = map(|x, _| x);
        assert!(matches!(
            PeriodicMap::new(&fine, Closure::Mirror, 1.9e-4),
            Err(PeriodicMapError::Unresolved { .. })
        ));
        assert!(matches!(
            PeriodicMap::new(&fine, Closure::Mirror, 6e-4),
            Err(PeriodicMapError::Unresolved { .. })
        ));
        let mut gappy = fine;
        gappy.heights[7] = f64::NAN;
        let error = PeriodicMap::new(&gappy, Closure::Blend, 4e-4).unwrap_err();
        assert!(error.to_string().contains("1 of 960 heights are missing"), "{error}");
    }
}
