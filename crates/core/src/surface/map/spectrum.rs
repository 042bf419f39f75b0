//! Two-dimensional power spectral density of a map without gaps.
//!
//! Over the whole plane of angular wavenumbers `q = (qx, qy)` in rad/m, in m⁴:
//!
//! ```text
//! C(qx, qy) = |sum w z exp(-i q r)|^2 / ((nx ny)^2 mean(w^2) dqx dqy),   dqx = 2 π / (nx dx), dqy = 2 π / (ny dy)
//! sum of C dqx dqy = mean((w z)^2) / mean(w^2)
//! ```
//!
//! so that without a window the integral over the plane, all four quadrants, is the mean square height to round-off. The
//! heights are taken about their mean; the window `w` is the product of one along `x` and one along `y`. The convention is
//! that of `C2D` in [`crate::surface::spectrum`], and the sum over `qy` is the one-sided density of a line there.

use super::HeightMap;
use super::error::{ArealError, mean_height};
use super::transform::{transform_columns, transform_rows};
use crate::surface::PowerSpectrum;
use crate::surface::spectrum::{Route, Window};
use rustfft::num_complex::Complex64;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Width in degrees of the sectors of [`ArealSpectrum::sectors`].
pub const SECTOR: usize = 10;
/// Distance in degrees on either side over which the texture direction is an average.
const DIRECTION_WIDTH: usize = 5;

/// Two-sided power spectral density, see the [module](self) for its normalisation.
#[derive(Debug, Clone, PartialEq)]
pub struct ArealSpectrum {
    /// Points of the map along `x` and `y`.
    pub points: [usize; 2],
    /// Distances dqx and dqy in rad/m between wavenumbers.
    pub step: [f64; 2],
    /// Window on the heights along each direction.
    pub window: Window,
    /// Density in m⁴ of the half plane `qx >= 0`: that of `(k dqx, l dqy)` is `density[k * ny + l]`, `l` modulo `ny`.
    density: Vec<f64>,
}

/// Mean density over a ring of wavenumbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadialBin {
    /// Geometric mean in rad/m of the wavenumbers in the bin.
    pub wavenumber: f64,
    /// Arithmetic mean in m⁴ of the densities in the bin.
    pub density: f64,
    /// Standard error in m⁴ of `density` that a Gaussian surface has: two modes, `q` and `-q`, have one value, and the
    /// window makes neighbours depend on each other.
    pub standard_error: f64,
    /// Number of modes in the bin, `q` and `-q` counted both.
    pub modes: usize,
}

/// Power of the waves within some directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    /// Middle of the sector in degrees from `x` towards `y`; its opposite belongs to it.
    pub angle: f64,
    /// Share of the power within the wavenumbers asked for.
    pub share: f64,
    /// Number of modes, `q` and `-q` counted both.
    pub modes: usize,
}

impl ArealSpectrum {
    /// Periodogram of a map without gaps, its mean removed. Remove at least the mean plane before.
    ///
    /// # Errors
    /// Missing heights, fewer than two points in a direction, all heights equal.
    pub fn of(map: &HeightMap, window: Window) -> Result<Self, ArealError> {
        let mean = mean_height(map, 2)?;
        match map.missing() {
            0 => Ok(Self::about(map, mean, window)),
            missing => Err(ArealError::Gaps { map: map.name.clone(), missing }),
        }
    }

    /// Periodogram of the heights about `mean` (m), missing points at the mean: for directions only.
    pub(super) fn about(map: &HeightMap, mean: f64, window: Window) -> Self {
        let [nx, ny] = map.points;
        let weights = map.points.map(|points| window.weights(points));
        let rows = transform_rows(map.points, nx, |n| {
            let z = map.heights[n];
            if z.is_nan() { 0.0 } else { (z - mean) * weights[0][n % nx] * weights[1][n / nx] }
        });
        let step = map.lengths().map(|length| TAU / length);
        let squares = weights.map(|weights| weights.iter().map(|w| w * w).sum::<f64>());
        // (nx ny)² mean(w²) = nx ny sum(w²)
        let scale = 1.0 / ((nx * ny) as f64 * squares[0] * squares[1] * step[0] * step[1]);
        let bins = nx / 2 + 1;
        let mut density = vec![0.0; bins * ny];
        transform_columns(&[rows], bins, ny, &mut density, |_, column, density| {
            let values = column.iter().map(Complex64::norm_sqr);
            density.iter_mut().zip(values).for_each(|(slot, square)| *slot = scale * square);
        });
        Self { points: map.points, step, window, density }
    }

    /// Density in m⁴ at `(k dqx, l dqy)`; zero beyond the Nyquist wavenumbers.
    pub fn density(&self, [k, l]: [isize; 2]) -> f64 {
        let (k, l) = if k < 0 { (-k, -l) } else { (k, l) };
        let [nx, ny] = self.points.map(|points| points as isize);
        if 2 * k > nx || 2 * l.abs() > ny {
            return 0.0;
        }
        self.density[(k * ny + l.rem_euclid(ny)) as usize]
    }

    /// Wavenumbers in rad/m, density and multiplicity of the modes of the half plane.
    fn modes(&self) -> impl Iterator<Item = ([f64; 2], f64, usize)> {
        let [nx, ny] = self.points;
        self.density.iter().enumerate().map(move |(n, &density)| {
            let (k, l) = (n / ny, n % ny);
            let l = if 2 * l > ny { l as f64 - ny as f64 } else { l as f64 };
            let wavenumbers = [k as f64 * self.step[0], l * self.step[1]];
            (wavenumbers, density, if k == 0 || 2 * k == nx { 1 } else { 2 })
        })
    }

    /// The wavenumber in rad/m up to which all directions are there: the smaller Nyquist wavenumber.
    pub fn largest_wavenumber(&self) -> f64 {
        let nyquist = |axis: usize| (self.points[axis] / 2) as f64 * self.step[axis];
        nyquist(0).min(nyquist(1))
    }

    /// Integral in m² over the plane.
    pub fn power(&self) -> f64 {
        let sum: f64 = self.modes().map(|(_, density, sides)| sides as f64 * density).sum();
        sum * self.step[0] * self.step[1]
    }

    /// Means over rings of equal width in `log q`, `per_decade` a decade, with edges at `10^(j / per_decade)` rad/m
    /// whatever the map, up to [`Self::largest_wavenumber`]; `q = 0` and empty rings are left out. Where the spectrum is
    /// steep the mean exceeds the density at the mean wavenumber, most so in the first rings, which are sums of a few
    /// modes; a window blurs these, too.
    pub fn radial(&self, per_decade: usize) -> Vec<RadialBin> {
        let (per_decade, largest) = (per_decade.max(1) as f64, self.largest_wavenumber());
        let mut rings: BTreeMap<i64, [f64; 3]> = BTreeMap::new();
        for ([qx, qy], density, sides) in self.modes() {
            let square = qx * qx + qy * qy;
            // The Nyquist wavenumber itself is a product: allow for its round-off.
            if square == 0.0 || square.sqrt() > largest * (1.0 + 1e-12) {
                continue;
            }
            let (logarithm, sides) = (0.5 * square.ln(), sides as f64);
            let ring = (logarithm * std::f64::consts::LOG10_E * per_decade).floor() as i64;
            let sums = rings.entry(ring).or_default();
            *sums = [sums[0] + sides, sums[1] + sides * density, sums[2] + sides * logarithm];
        }
        let inflation = self.window.variance_inflation().powi(2);
        let bin = |[modes, density, logarithm]: [f64; 3]| RadialBin {
            wavenumber: (logarithm / modes).exp(),
            density: density / modes,
            standard_error: density / modes * (2.0 * inflation / modes).sqrt().min(1.0),
            modes: modes as usize,
        };
        rings.into_values().map(bin).collect()
    }

    /// Shares of the power, the integral of `q C dq` over each sector of 10 degrees, of the waves with wavenumbers from
    /// `from` to `to` (rad/m). The sectors are centred at 0, 10, ... 170 degrees, so that no axis is a border. Longest
    /// waves have the most power and the fewest directions: ask for a range from some 10 steps of the spectrum, and up to
    /// [`Self::largest_wavenumber`] at most.
    pub fn sectors(&self, [from, to]: [f64; 2]) -> Vec<Sector> {
        let to = to.min(self.largest_wavenumber() * (1.0 + 1e-12));
        let mut sums = [(0.0, 0_usize); 180 / SECTOR];
        for ([qx, qy], density, sides) in self.modes() {
            let q = qx.hypot(qy);
            if q > 0.0 && q >= from && q <= to {
                let sector = (direction(qx, qy) / SECTOR as f64).round() as usize % sums.len();
                sums[sector].0 += sides as f64 * density;
                sums[sector].1 += sides;
            }
        }
        let total: f64 = sums.iter().map(|(power, _)| power).sum();
        let sector = |(n, (power, modes))| Sector {
            angle: (n * SECTOR) as f64,
            share: if total > 0.0 { power / total } else { 0.0 },
            modes,
        };
        sums.into_iter().enumerate().map(sector).collect()
    }

    /// Direction in degrees from `x` towards `y`, 0 to 180, of the waves with the most power: where the power within 5
    /// degrees on either side is largest, the power-weighted mean of the directions within these.
    ///
    /// ISO 25178-2:2021 takes the largest amplitude instead of the power. That is the same for one dominant direction;
    /// for several, power prefers the higher waves.
    pub fn texture_direction(&self) -> f64 {
        let largest = self.largest_wavenumber() * (1.0 + 1e-12);
        // Power by degrees, and its sum times a vector of twice the angle: opposite directions are the same.
        let mut degrees = vec![(0.0, Complex64::ZERO); 180];
        for ([qx, qy], density, sides) in self.modes() {
            if qx.hypot(qy) <= largest && (qx, qy) != (0.0, 0.0) {
                let (angle, power) = (direction(qx, qy), density * sides as f64);
                let slot = &mut degrees[angle.round() as usize % 180];
                slot.0 += power;
                slot.1 += Complex64::from_polar(power, 2.0 * angle.to_radians());
            }
        }
        let around = |middle: usize| {
            (0..=2 * DIRECTION_WIDTH).map(move |n| (middle + 180 + n - DIRECTION_WIDTH) % 180)
        };
        let power = |middle: usize| around(middle).map(|n| degrees[n].0).sum::<f64>();
        let powers: Vec<f64> = (0..180).map(power).collect();
        let best = (0..180).fold(0, |best, n| if powers[n] > powers[best] { n } else { best });
        // Where little else has power, neighbouring sums are equal: move the middle to the mean until it stays.
        let mut middle = best;
        let mut direction = best as f64;
        for _ in 0..2 * DIRECTION_WIDTH {
            let sum: Complex64 = around(middle).map(|n| degrees[n].1).sum();
            direction = (sum.arg().to_degrees() / 2.0).rem_euclid(180.0);
            let next = direction.round() as usize % 180;
            if next == middle {
                break;
            }
            middle = next;
        }
        direction
    }

    /// One-sided density in m³ of lines along `x`, by the integral over `qy`: without a window that is the mean of the
    /// periodograms of the rows, taken about the mean of the map; with one, that of the rows weighted by the square of
    /// the window along `y`. It counts as one scan, since neighbouring rows are alike.
    pub fn rows(&self) -> PowerSpectrum {
        let [nx, ny] = self.points;
        let sides = |k: usize| if k == 0 || 2 * k == nx { 1.0 } else { 2.0 };
        let lines = self.density.chunks_exact(ny).enumerate();
        let density = lines.map(|(k, line)| sides(k) * line.iter().sum::<f64>() * self.step[1]);
        PowerSpectrum {
            wavenumber_step: self.step[0],
            density: density.collect(),
            routes: vec![Route::Periodogram(self.window)],
        }
    }
}

/// Direction of a wave in degrees, 0 to 180.
fn direction(qx: f64, qy: f64) -> f64 {
    qy.atan2(qx).to_degrees().rem_euclid(180.0)
}

#[cfg(test)]
mod tests;
