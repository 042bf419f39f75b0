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

    /// C at the lag `(k dx, l dy)` of the grid; `None` beyond the largest lags or without pairs.
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
    /// variance within the largest lags. Returns `None` if C does not reach the
    /// variance in any direction.
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

#[cfg(test)]
mod tests {
    use super::super::test_maps::{gaussian, map, noise, with_gaps};
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::TAU;

    /// Sum over all pairs one by one.
    fn by_hand(map: &HeightMap, [k, l]: [isize; 2]) -> (f64, u64) {
        let [nx, ny] = map.points.map(|points| points as isize);
        let (mut sum, mut pairs) = (0.0, 0);
        for j in 0..ny {
            for i in 0..nx {
                if (0..nx).contains(&(i + k)) && (0..ny).contains(&(j + l)) {
                    let at = |i: isize, j: isize| map.heights[(j * nx + i) as usize];
                    let difference = at(i + k, j + l) - at(i, j);
                    if !difference.is_nan() {
                        sum += difference * difference;
                        pairs += 1;
                    }
                }
            }
        }
        (sum / pairs as f64, pairs)
    }

    #[test]
    fn the_correlation_is_that_of_all_pairs_of_a_map_with_missing_points() {
        for points in [[23, 17], [16, 30]] {
            let mut map = with_gaps(noise(points, [2e-6, 5e-6], 4), 6);
            map.heights.iter_mut().for_each(|z| *z += 7.0);
            let correlation = ArealCorrelation::of(&map, Some(1.0)).unwrap();
            let [x, y] = points.map(|points| points as isize - 1);
            assert_eq!(correlation.maximum_lags(), points.map(|points| points - 1));
            for (k, l) in (-y..=y).flat_map(|l| (-x..=x).map(move |k| (k, l))) {
                let (value, pairs) = by_hand(&map, [k, l]);
                match correlation.at([k, l]) {
                    Some(sample) => {
                        assert_eq!(sample.pairs, pairs, "{k} {l}");
                        assert_relative_eq!(sample.value, value, epsilon = 1e-12);
                        assert_relative_eq!(sample.lag, (k as f64 * 2e-6).hypot(l as f64 * 5e-6));
                    }
                    None => assert_eq!(pairs, 0, "{k} {l}"),
                }
            }
            assert_eq!(correlation.at([x + 1, 0]), None);
        }
    }

    #[test]
    fn directions_along_grid_lines_are_lags_of_the_grid() {
        let map = noise([40, 30], [1e-6, 1e-6], 1);
        let correlation = ArealCorrelation::of(&map, None).unwrap();
        for (angle, [k, l]) in
            [(0.0, [1, 0]), (90.0, [0, 1]), (45.0, [1, 1]), (135.0, [-1, 1]), (-45.0, [1, -1])]
        {
            for n in [1, 2, 11] {
                let point = correlation.at([n * k, n * l]).unwrap();
                let found = correlation.along(angle, point.lag).unwrap();
                assert_relative_eq!(found.value, point.value, max_relative = 1e-12);
                assert_eq!(found.pairs, point.pairs);
            }
        }
        // No pair is less than sqrt(2) spacings apart along the diagonal.
        assert_eq!(correlation.along(45.0, 1e-6), None);
        let lags = |n: usize| correlation.directions(&[0.0, 90.0], 10)[n].samples.len();
        assert!(lags(0) > lags(1) && lags(1) > 8);
    }

    #[test]
    fn a_sine_at_thirty_degrees_shows_its_direction_and_its_correlation() {
        let (amplitude, wavelength, spacing) = (3e-6, 40e-6, [1e-6, 1.5e-6]);
        let q = TAU / wavelength;
        let (sin, cos) = 30_f64.to_radians().sin_cos();
        let wave = |x: f64, y: f64| amplitude * (q * (x * cos + y * sin)).sin();
        let correlation = ArealCorrelation::of(&map([400, 300], spacing, wave), None).unwrap();
        for direction in correlation.directions(&[0.0, 30.0, 75.0, 120.0, 150.0], 5) {
            let along = q * (direction.angle - 30.0).to_radians().cos();
            for sample in direction.samples.iter().filter(|sample| sample.lag < 200e-6) {
                // D^2 (1 - cos q s) on an endless surface; here some ten waves of which the rest does not average out.
                let exact = amplitude.powi(2) * (1.0 - (along * sample.lag).cos());
                assert_relative_eq!(sample.value, exact, epsilon = 0.03 * amplitude.powi(2));
            }
        }
        let anisotropy = correlation.anisotropy().unwrap();
        assert_relative_eq!(anisotropy.run, 120.0, epsilon = 0.5);
        // cos(q s) = 1/2 - to the variance D^2 / 2 - at a sixth of the wavelength.
        assert_relative_eq!(anisotropy.length_across, wavelength / 6.0, max_relative = 0.01);
        assert!(anisotropy.aspect < 0.1, "{anisotropy:?}");
        assert_relative_eq!(anisotropy.gradient_run, 120.0, epsilon = 0.1);
        assert!(anisotropy.gradient_ratio < 0.05, "{anisotropy:?}");
        let short = correlation.anisotropy_by_lag(5)[0];
        assert_relative_eq!(short.run, 120.0, epsilon = 1.0);
        assert!(short.ratio < 0.05);
    }

    #[test]
    fn stretched_waves_have_the_aspect_they_were_stretched_by() {
        // C(q) of Gaussian form, correlation lengths 12 and 6 points along 25 and 115 degrees.
        let (sin, cos) = 25_f64.to_radians().sin_cos();
        let density = |qx: f64, qy: f64| {
            let (along, across) = (qx * cos + qy * sin, qy * cos - qx * sin);
            (-(12.0 * along).powi(2) / 2.0 - (6.0 * across).powi(2) / 2.0).exp()
        };
        let map = gaussian(512, [1.0, 1.0], density, true, 2);
        let anisotropy = ArealCorrelation::of(&map, Some(100.0)).unwrap().anisotropy().unwrap();
        // Some 3000 areas of correlation: lengths to a few per cent, the direction to a degree or two.
        assert_relative_eq!(anisotropy.run, 25.0, epsilon = 3.0);
        assert_relative_eq!(anisotropy.aspect, 0.5, max_relative = 0.06);
        assert_relative_eq!(anisotropy.gradient_run, 25.0, epsilon = 3.0);
        assert_relative_eq!(anisotropy.gradient_ratio, 0.5, max_relative = 0.06);
        // ACF = exp(-s^2 / (2 6^2)) = 1/2.
        let half = 6.0 * (2.0 * 2_f64.ln()).sqrt();
        assert_relative_eq!(anisotropy.length_across, half, max_relative = 0.06);
    }

    #[test]
    fn between_the_lags_of_the_grid_the_correlation_is_that_of_a_finer_map() {
        let density = |qx: f64, qy: f64| 1e-3 * (0.05_f64.hypot(qx.hypot(qy))).powf(-3.6);
        let fine = gaussian(512, [1.0, 1.0], density, true, 5);
        let every_second = |n: usize| fine.heights[(n / 256) * 2 * 512 + (n % 256) * 2];
        let heights = (0..256 * 256).map(every_second).collect();
        let coarse = HeightMap { points: [256; 2], spacing: [2.0; 2], heights, name: "07".into() };
        let [fine, coarse] = [fine, coarse].map(|map| ArealCorrelation::of(&map, None).unwrap());
        for [k, l] in [[2, 1], [-3, 2], [5, 3], [7, 7], [-11, 20], [41, 3]] {
            let point = fine.at([k, l]).unwrap();
            let angle = (l as f64).atan2(k as f64).to_degrees();
            let found = coarse.along(angle, point.lag).unwrap();
            // A quarter of the pairs, and C of the surface is rough at short lags.
            assert_relative_eq!(found.value, point.value, max_relative = 0.02);
        }
    }

    #[test]
    fn what_has_no_correlation_is_an_error() {
        let of = |map: HeightMap| ArealCorrelation::of(&map, None).unwrap_err();
        let flat = map([5, 5], [1.0; 2], |_, _| 0.1);
        assert!(matches!(of(flat.clone()), ArealError::Flat { .. }));
        assert!(matches!(of(map([5, 1], [1.0; 2], |x, _| x)), ArealError::TooSmall { .. }));
        let missing = HeightMap { heights: vec![f64::NAN; 25], ..flat };
        assert!(matches!(of(missing), ArealError::TooFewHeights { valid: 0, .. }));
    }
}
