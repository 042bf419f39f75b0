//! Height-difference correlation of a map along directions, with missing points.
//!
//! ```text
//! C(s) = mean over all pairs of valid points a lag s = (sx, sy) apart of (z(r + s) - z(r))^2
//! ```
//!
//! as for lines in [`crate::surface::correlation`]; at the lags of the grid it is the mean over the pairs to about
//! `2e-15 Sq^2`. Twice the variance less twice the autocovariance is the same on an endless surface only.

use super::HeightMap;
use super::error::{ArealError, mean_height};
use super::gradient::Gradients;
use super::lags::{LagPlane, PairMean};
use crate::surface::CorrelationSample;
use crate::surface::correlation::log_spaced_lags;

/// Number of directions, equally spaced over half a turn, from which anisotropy is computed.
const DIRECTIONS: usize = 36;

/// Height-difference correlation over the plane of lags.
#[derive(Debug, Clone, PartialEq)]
pub struct ArealCorrelation {
    /// Mean square in m² of the valid heights about their mean; half the plateau of C.
    pub variance: f64,
    plane: LagPlane,
    gradients: Gradients,
}

/// Correlation along one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectionalCorrelation {
    /// Direction in degrees from `x` towards `y`.
    pub angle: f64,
    /// C at some lags, ascending.
    pub samples: Vec<CorrelationSample>,
}

/// How far a surface differs from an isotropic one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anisotropy {
    /// Direction of the run in degrees from `x` towards `y`, 0 to 180: that of the longest correlation. It means little
    /// where `aspect` is near 1.
    pub run: f64,
    /// Length in m, across the run, at which C reaches the variance, an autocorrelation of 1/2.
    pub length_across: f64,
    /// `length_across` over the length along the run: 1 isotropic, 0 for ridges without end.
    pub aspect: f64,
    /// Direction in degrees along which the gradients are least: the run of the shortest waves.
    pub gradient_run: f64,
    /// Rms gradient along `gradient_run` over that across it: 1 isotropic, 0 for ridges without end.
    pub gradient_ratio: f64,
}

/// Anisotropy of C at one lag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LagAnisotropy {
    /// Lag in m.
    pub lag: f64,
    /// Mean of C in m² over all directions.
    pub mean: f64,
    /// Direction in degrees, 0 to 180, in which C is least.
    pub run: f64,
    /// The least C over the largest, both of the harmonic of half a turn; 1 isotropic.
    pub ratio: f64,
}

impl ArealCorrelation {
    /// Correlation at lags up to `maximum_lag` (m) along each axis; half the lengths of the map without it.
    ///
    /// # Errors
    /// Fewer than two points in a direction, fewer than two heights, all heights equal, no neighbours with heights.
    pub fn of(map: &HeightMap, maximum_lag: Option<f64>) -> Result<Self, ArealError> {
        let mean = mean_height(map, 2)?;
        let gradients = Gradients::of(map)?;
        let lags = [0, 1].map(|axis| {
            let (points, spacing) = (map.points[axis], map.spacing[axis]);
            maximum_lag.map_or(points / 2, |lag| (lag / spacing).round() as usize).max(1)
        });
        let plane = LagPlane::of(map, mean, lags, PairMean::SquaredDifference);
        let squares = map.heights.iter().filter(|z| !z.is_nan()).map(|z| (z - mean).powi(2));
        let variance = squares.sum::<f64>() / (map.heights.len() - map.missing()) as f64;
        Ok(Self { variance, plane, gradients })
    }

    /// Largest lags along `x` and `y` as numbers of spacings.
    pub fn maximum_lags(&self) -> [usize; 2] {
        self.plane.lags
    }

    /// C at the lag `(k dx, l dy)` of the grid; none beyond the largest lags or without pairs.
    pub fn at(&self, [k, l]: [isize; 2]) -> Option<CorrelationSample> {
        let [dx, dy] = self.plane.spacing;
        let lag = (k as f64 * dx).hypot(l as f64 * dy);
        self.plane.get([k, l]).map(|(value, pairs)| CorrelationSample {
            lag,
            value,
            pairs: pairs as u64,
        })
    }

    /// C at a lag in m along a direction in degrees from `x` towards `y`.
    ///
    /// Along the faster growing component the lags of the grid are kept, across it the cubic polynomial through four of
    /// them is taken, and between two such points a power law; exact at lags of the grid. None before the first point of
    /// a direction and beyond the largest lags.
    pub fn along(&self, angle: f64, lag: f64) -> Option<CorrelationSample> {
        self.plane.along(angle, lag)
    }

    /// C along directions in degrees at common lags: multiples of the smaller spacing, `per_decade` a decade.
    pub fn directions(&self, angles: &[f64], per_decade: usize) -> Vec<DirectionalCorrelation> {
        let lags = self.lags(per_decade);
        let samples = |angle| lags.iter().filter_map(|&lag| self.along(angle, lag)).collect();
        angles
            .iter()
            .map(|&angle| DirectionalCorrelation { angle, samples: samples(angle) })
            .collect()
    }

    /// Anisotropy by lengths of correlation and by gradients.
    ///
    /// The length at which C reaches the variance is taken along 36 directions, and `1 / length²` fitted by `a - b cos
    /// 2 (angle - run)`, which is exact for elliptic contours and for ridges; it counts as 0 where C does not reach the
    /// variance within the largest lags. None if it does so in no direction.
    pub fn anisotropy(&self) -> Option<Anisotropy> {
        let inverse_square = |angle: f64| {
            let (step, length) = self.plane.ray(angle);
            self.plane.crossing(step, self.variance).map_or(0.0, |n| (n * length).powi(-2))
        };
        let (mean, amplitude, run) =
            harmonic(&directions().map(inverse_square).collect::<Vec<_>>());
        let (gradient_run, gradient_ratio) = self.gradients.least();
        (mean > 0.0).then(|| Anisotropy {
            run,
            length_across: (mean + amplitude).sqrt().recip(),
            aspect: ((mean - amplitude).max(0.0) / (mean + amplitude)).sqrt(),
            gradient_run,
            gradient_ratio,
        })
    }

    /// Anisotropy of C at each of the common lags that are within the plane in all directions.
    pub fn anisotropy_by_lag(&self, per_decade: usize) -> Vec<LagAnisotropy> {
        let at = |lag: f64| {
            let along = |angle| self.along(angle, lag).map(|sample| sample.value);
            let values = directions().map(along).collect::<Option<Vec<f64>>>()?;
            let (mean, amplitude, run) = harmonic(&values);
            let ratio = (mean - amplitude).max(0.0) / (mean + amplitude);
            Some(LagAnisotropy { lag, mean, run, ratio })
        };
        self.lags(per_decade).into_iter().filter_map(at).collect()
    }

    fn lags(&self, per_decade: usize) -> Vec<f64> {
        let ([x, y], [dx, dy]) = (self.plane.lags, self.plane.spacing);
        let (unit, longest) = (dx.min(dy), (x as f64 * dx).hypot(y as f64 * dy));
        let lags = log_spaced_lags((longest / unit) as usize, per_decade);
        lags.into_iter().map(|lag| lag as f64 * unit).collect()
    }
}

fn directions() -> impl Iterator<Item = f64> {
    (0..DIRECTIONS).map(|n| n as f64 * 180.0 / DIRECTIONS as f64)
}

/// Mean and amplitude of `mean - amplitude cos 2 (angle - run)` and the run in degrees, by least squares through values
/// at [`directions`].
fn harmonic(values: &[f64]) -> (f64, f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (angle, value) in directions().zip(values) {
        let (s, c) = (2.0 * angle.to_radians()).sin_cos();
        cosine += 2.0 / count * value * c;
        sine += 2.0 / count * value * s;
    }
    let run = (-sine).atan2(-cosine).to_degrees() / 2.0;
    (mean, cosine.hypot(sine), run.rem_euclid(180.0))
}
