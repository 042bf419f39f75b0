//! Height maps of a random surface, as an areal instrument would give them.

use super::parameters::{SynthesisError, between, positive, within};
use super::random::{normal_pair, uniform};
use super::translation::Translation;
use crate::surface::HeightMap;
use crate::surface::map::phases::random_map;
use rand_pcg::Pcg64;
use std::f64::consts::{PI, TAU};

/// The period of the surface in lengths of a map, so that a map is a window of it with ends that do not meet.
const PERIOD: f64 = 2.0;
/// The shortest wave in spacings of the map.
const SHORTEST: f64 = 2.0;
/// Streams of random numbers beside the phases of the surface.
const INSTRUMENT: u128 = 1 << 64;
/// Largest number of points of a map.
const MAX_POINTS: f64 = (1_u64 << 24) as f64;

/// A square map of a random surface, self-affine below its correlation lengths.
///
/// A Gaussian field of power spectral density `C ∝ (1 + (q_x l_x)² + (q_y l_y)²)^(-1-H)` with random phases is mapped to heights
/// of given root mean square and skewness point by point (Grigoriu, doi:10.1061/(ASCE)0733-9399(1984)110:4(610)), so that the
/// spectrum is exact for skewness 0. The instrument tilts it, adds noise, rounds to its digit and loses round patches.
#[derive(Debug, Clone, PartialEq)]
pub struct SyntheticMap {
    /// Length of a side in m.
    pub length: f64,
    /// Distance between points in m.
    pub spacing: f64,
    /// Hurst exponent H, between 0 and 1.
    pub hurst_exponent: f64,
    /// Lengths `l_x`, `l_y` in m below which the surface is self-affine; unequal ones make it anisotropic.
    pub correlation_lengths: [f64; 2],
    /// Root mean square height in m of the unbounded surface; a map shows less of the long waves.
    pub rms_height: f64,
    /// Skewness of the heights, -4 to 4.
    pub skewness: f64,
    /// Slopes of the plane on which it lies, along x and y.
    pub tilt: [f64; 2],
    /// Standard deviation in m of the noise of a point.
    pub noise: f64,
    /// Digit of the instrument in m, to which heights are rounded; 0 for none.
    pub digit: f64,
    /// Share of missing points, 0 to 0.5.
    pub missing_fraction: f64,
    /// Diameter in m of a patch of missing points.
    pub missing_diameter: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl SyntheticMap {
    /// The bundled map: a rolled road of 19.2 mm a side, 50 µm between points, smoother along x, in which it was rolled.
    pub fn bundled() -> Self {
        Self {
            length: 19.2e-3,
            spacing: 50e-6,
            hurst_exponent: 0.75,
            correlation_lengths: [0.6e-3, 0.4e-3],
            rms_height: 0.1e-3,
            skewness: -1.0,
            tilt: [0.01, -0.02],
            noise: 0.5e-6,
            // A power of two near 60 nm: such numbers compress well.
            digit: 2_f64.powi(-24),
            missing_fraction: 0.01,
            missing_diameter: 0.15e-3,
            seed: 1,
        }
    }

    /// Points along a side.
    pub fn points(&self) -> usize {
        (self.length / self.spacing).round() as usize
    }

    /// Checks that every parameter is in its range.
    ///
    /// # Errors
    /// [`SynthesisError::OutOfRange`] for the first outside.
    pub fn validate(&self) -> Result<(), SynthesisError> {
        positive("length_m", self.length)?;
        positive("spacing_m", self.spacing)?;
        within("length_m", self.length, 8.0 * self.spacing, MAX_POINTS.sqrt() * self.spacing)?;
        between("hurst_exponent", self.hurst_exponent, 0.0, 1.0)?;
        for length in self.correlation_lengths {
            positive("correlation_length_m", length)?;
        }
        positive("rms_height_m", self.rms_height)?;
        within("skewness", self.skewness, -4.0, 4.0)?;
        for slope in self.tilt {
            within("tilt", slope, -1.0, 1.0)?;
        }
        within("noise_m", self.noise, 0.0, f64::MAX)?;
        within("digit_m", self.digit, 0.0, f64::MAX)?;
        within("missing_fraction", self.missing_fraction, 0.0, 0.5)?;
        let smallest = if self.missing_fraction > 0.0 { self.spacing } else { 0.0 };
        within("missing_diameter_m", self.missing_diameter, smallest, self.length)
    }

    /// Power spectral density in m⁴ of the Gaussian field at `[q_x, q_y]` in rad/m, normalised over the plane.
    ///
    /// Its integral is `π / (H l_x l_y)` times the factor, which makes the variance that of the heights.
    fn density(&self, [qx, qy]: [f64; 2]) -> f64 {
        let [lx, ly] = self.correlation_lengths;
        let factor = self.rms_height.powi(2) * self.hurst_exponent * lx * ly / PI;
        factor * (1.0 + (qx * lx).powi(2) + (qy * ly).powi(2)).powf(-1.0 - self.hurst_exponent)
    }

    /// Makes the map.
    ///
    /// # Errors
    /// [`SynthesisError::OutOfRange`].
    pub fn generate(&self, name: &str) -> Result<HeightMap, SynthesisError> {
        self.validate()?;
        let n = self.points();
        let period = PERIOD * n as f64 * self.spacing;
        let shortest = SHORTEST * self.spacing;
        let field = random_map(|q| self.density(q), period, shortest, self.seed, 1);
        let wide = (PERIOD * n as f64) as usize;
        let gaussian = field.sample([wide, wide]);
        let translation = Translation::with_skewness(self.skewness);
        let mut rng = Pcg64::new(u128::from(self.seed), INSTRUMENT);
        let mut heights = Vec::with_capacity(n * n);
        for j in 0..n {
            for i in 0..n {
                let standard = gaussian[j * wide + i] / self.rms_height;
                let plane = self.tilt[0] * i as f64 + self.tilt[1] * j as f64;
                let height = self.rms_height * translation.height(standard)
                    + plane * self.spacing
                    + self.noise * normal_pair(&mut rng).0;
                heights.push(self.rounded(height));
            }
        }
        self.lose_points(&mut heights, n);
        let (points, spacing) = ([n, n], [self.spacing; 2]);
        Ok(HeightMap { name: name.to_owned(), points, spacing, heights })
    }

    fn rounded(&self, height: f64) -> f64 {
        if self.digit > 0.0 { (height / self.digit).round() * self.digit } else { height }
    }

    /// Takes away round patches until so many points are missing.
    fn lose_points(&self, heights: &mut [f64], n: usize) {
        let mut rng = Pcg64::new(u128::from(self.seed), INSTRUMENT + 1);
        let to_lose = (self.missing_fraction * heights.len() as f64) as usize;
        let radius = 0.5 * self.missing_diameter / self.spacing;
        let mut lost = 0;
        while lost < to_lose {
            let centre = [0, 1].map(|_| uniform(&mut rng) * n as f64);
            let range = |c: f64| {
                let first = (c - radius).ceil().max(0.0) as usize;
                first..((c + radius).floor() as usize + 1).min(n)
            };
            for j in range(centre[1]) {
                for i in range(centre[0]) {
                    let inside = (i as f64 - centre[0]).hypot(j as f64 - centre[1]) <= radius;
                    let height = &mut heights[j * n + i];
                    if inside && !height.is_nan() {
                        *height = f64::NAN;
                        lost += 1;
                    }
                }
            }
        }
    }

    /// Wavelength in m of the roll-off along x and y, `2 π l`.
    pub fn roll_off(&self) -> [f64; 2] {
        self.correlation_lengths.map(|length| TAU * length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_has_its_height_skewness_and_missing_points() {
        let map = SyntheticMap { tilt: [0.0; 2], ..SyntheticMap::bundled() };
        let made = map.generate("map").unwrap();
        assert_eq!((made.points, made.name.as_str()), ([384, 384], "map"));
        let valid: Vec<f64> = made.heights.iter().copied().filter(|z| !z.is_nan()).collect();
        let missing = made.missing() as f64 / made.heights.len() as f64;
        assert!((0.01..0.0105).contains(&missing), "{missing}");
        let count = valid.len() as f64;
        let mean = valid.iter().sum::<f64>() / count;
        let moment = |k: i32| valid.iter().map(|z| (z - mean).powi(k)).sum::<f64>() / count;
        let rms = moment(2).sqrt();
        // 32 by 48 correlation lengths: scatter of some per cent.
        assert!((rms / 1e-4 - 1.0).abs() < 0.1, "{rms}");
        let skewness = moment(3) / rms.powi(3);
        assert!((skewness + 1.0).abs() < 0.25, "{skewness}");
        assert!(valid.iter().all(|z| (z / map.digit).fract() == 0.0));
    }

    #[test]
    fn the_variance_is_the_integral_of_the_density() {
        let map = SyntheticMap::bundled();
        // Rings in the plane scaled by the correlation lengths.
        let (mut sum, step) = (0.0, 1e-3_f64);
        for k in 0..14_000 {
            let q = (-6.0 + f64::from(k) * step).exp();
            let density = map.density([q / map.correlation_lengths[0], 0.0]);
            sum += TAU * q * q * step * density
                / (map.correlation_lengths[0] * map.correlation_lengths[1]);
        }
        approx::assert_relative_eq!(sum, 1e-8, max_relative = 1e-4);
    }

    #[test]
    fn ranges_are_told_by_name() {
        let wrong = |change: fn(&mut SyntheticMap)| {
            let mut map = SyntheticMap::bundled();
            change(&mut map);
            map.validate().unwrap_err().to_string()
        };
        assert!(wrong(|map| map.hurst_exponent = 1.0).contains("hurst_exponent"));
        assert!(wrong(|map| map.length = 1.0).contains("length_m"));
        assert!(wrong(|map| map.missing_diameter = 0.0).contains("missing_diameter_m"));
        assert!(
            wrong(|map| map.correlation_lengths[1] = f64::NAN).contains("correlation_length_m")
        );
    }
}
