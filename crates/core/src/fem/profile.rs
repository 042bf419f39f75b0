//! The rigid profile as a smooth function of position.

use crate::surface::Wave;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// Fraction of the mean square slope of the waves that count as relevant.
const SLOPE_SHARE: f64 = 0.99;

/// Height, slope and curvature of the profile at one position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Height {
    /// Height z in m.
    pub height: f64,
    /// Slope `dz/dx`.
    pub slope: f64,
    /// Second derivative `d²z/dx²` in 1/m.
    pub curvature: f64,
}

/// A rigid periodic profile `z(x)` that can be evaluated anywhere.
#[derive(Debug, Clone)]
pub struct RigidProfile {
    period: f64,
    shape: Shape,
}

#[derive(Debug, Clone)]
enum Shape {
    /// A short sum of sines is evaluated directly.
    Waves(Vec<Wave>),
    /// The crests of a sine on a flat.
    Crests(Wave),
    /// Many heights become a quintic Hermite interpolant of the trigonometric polynomial.
    Samples(Vec<Height>),
}

impl RigidProfile {
    /// A sum of sines on a period in m that all wavelengths divide.
    pub fn from_waves(waves: &[Wave], period: f64) -> Self {
        Self { period, shape: Shape::Waves(waves.to_vec()) }
    }

    /// Heights in m at equidistant points of a period in m: the trigonometric polynomial through
    /// them. Between the points it is a quintic with the polynomial's heights, slopes and second
    /// derivatives at both ends, so the second derivative is continuous.
    pub fn from_heights(heights: &[f64], period: f64) -> Self {
        Self { period, shape: Shape::Samples(samples_of(&spectrum_of(heights), period)) }
    }

    /// The crests of a sine on a flat at its mean height, one a period: bumps, such as of particles on a flat, of the
    /// height of the amplitude and half as wide as the period.
    pub fn crests(wave: Wave) -> Self {
        Self { period: wave.wavelength, shape: Shape::Crests(wave) }
    }

    /// The profile without its shortest waves: those of up to `whole` waves per period are kept, those of up to
    /// `growing` are multiplied by `share`, all others are left out.
    pub fn partial(&self, whole: f64, growing: f64, share: f64) -> Self {
        let part = |waves: f64| {
            // Wavelengths are known to round-off.
            let within = |most: f64| waves <= most * (1.0 + 1e-9);
            if within(whole) {
                1.0
            } else if within(growing) {
                share
            } else {
                0.0
            }
        };
        let shape = match &self.shape {
            Shape::Waves(waves) => {
                let scaled = |wave: &Wave| Wave {
                    amplitude: part(self.period / wave.wavelength) * wave.amplitude,
                    ..*wave
                };
                Shape::Waves(waves.iter().map(scaled).collect())
            }
            Shape::Crests(wave) => {
                Shape::Crests(Wave { amplitude: part(1.0) * wave.amplitude, ..*wave })
            }
            Shape::Samples(samples) => {
                let heights: Vec<f64> = samples.iter().map(|sample| sample.height).collect();
                let mut spectrum = spectrum_of(&heights);
                for (k, component) in spectrum.iter_mut().enumerate() {
                    *component *= part(k.min(heights.len() - k) as f64);
                }
                Shape::Samples(samples_of(&spectrum, self.period))
            }
        };
        Self { period: self.period, shape }
    }

    /// Length of the period in m.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Number of the shortest relevant waves on the period: this and all longer waves have 99 % of the mean square slope.
    pub fn shortest_waves(&self) -> f64 {
        match &self.shape {
            Shape::Waves(waves) => {
                let shortest = waves
                    .iter()
                    .filter(|wave| wave.amplitude != 0.0)
                    .map(|wave| wave.wavelength)
                    .fold(self.period, f64::min);
                (self.period / shortest).round()
            }
            Shape::Crests(_) => 1.0,
            Shape::Samples(samples) => shortest_waves(samples),
        }
    }

    /// As [`Self::shortest_waves`], but sines with nearly zero slope do not count either: the waves that a mesh must
    /// resolve.
    pub fn steep_waves(&self) -> f64 {
        let Shape::Waves(waves) = &self.shape else { return self.shortest_waves() };
        let mut powers: Vec<(f64, f64)> = waves
            .iter()
            .map(|wave| (wave.wavelength, (wave.amplitude / wave.wavelength).powi(2)))
            .collect();
        powers.sort_by(|a, b| b.0.total_cmp(&a.0));
        let total: f64 = powers.iter().map(|(_, power)| power).sum();
        let mut sum = 0.0;
        let steep = powers.into_iter().find(|(_, power)| {
            sum += power;
            sum >= SLOPE_SHARE * total
        });
        steep.map_or(1.0, |(wavelength, _)| (self.period / wavelength).round())
    }

    /// The number of heights it interpolates; `None` for a sum of sines.
    pub fn samples(&self) -> Option<usize> {
        match &self.shape {
            Shape::Waves(_) | Shape::Crests(_) => None,
            Shape::Samples(samples) => Some(samples.len()),
        }
    }

    /// Height and derivatives at any position `x` in m.
    pub fn at(&self, x: f64) -> Height {
        match &self.shape {
            Shape::Waves(waves) => superposed(waves, x),
            Shape::Crests(wave) => {
                let at = superposed(&[*wave], x);
                if at.height > 0.0 {
                    at
                } else {
                    Height { height: 0.0, slope: 0.0, curvature: 0.0 }
                }
            }
            Shape::Samples(samples) => interpolated(samples, self.period, x),
        }
    }

    /// Heights at `points` equidistant positions of one period, from `x = 0` on.
    pub fn sample(&self, points: usize) -> Vec<f64> {
        (0..points).map(|i| self.at(i as f64 * self.period / points as f64).height).collect()
    }
}

fn spectrum_of(heights: &[f64]) -> Vec<Complex64> {
    let mut spectrum: Vec<Complex64> = heights.iter().map(|z| Complex64::new(*z, 0.0)).collect();
    FftPlanner::new().plan_fft_forward(heights.len()).process(&mut spectrum);
    spectrum
}

/// Heights, slopes and curvatures of a trigonometric polynomial at its points.
fn samples_of(spectrum: &[Complex64], period: f64) -> Vec<Height> {
    let mut planner = FftPlanner::new();
    let mut derivative = |order: i32| {
        let mut field = differentiate(spectrum, period, order);
        planner.plan_fft_inverse(spectrum.len()).process(&mut field);
        field
    };
    let [heights, slopes, curvatures] = [derivative(0), derivative(1), derivative(2)];
    heights
        .iter()
        .zip(slopes.iter().zip(&curvatures))
        .map(|(height, (slope, curvature))| Height {
            height: height.re,
            slope: slope.re,
            curvature: curvature.re,
        })
        .collect()
}

fn shortest_waves(samples: &[Height]) -> f64 {
    let mut slopes: Vec<Complex64> =
        samples.iter().map(|sample| Complex64::new(sample.slope, 0.0)).collect();
    FftPlanner::new().plan_fft_forward(slopes.len()).process(&mut slopes);
    let powers: Vec<f64> =
        slopes[..=samples.len() / 2].iter().map(nalgebra::Complex::norm_sqr).collect();
    let total: f64 = powers.iter().sum();
    let mut sum = 0.0;
    let shortest = powers.iter().position(|power| {
        sum += power;
        sum >= SLOPE_SHARE * total
    });
    shortest.unwrap_or(1).max(1) as f64
}

fn superposed(waves: &[Wave], x: f64) -> Height {
    let mut sum = Height { height: 0.0, slope: 0.0, curvature: 0.0 };
    for wave in waves {
        let q = TAU / wave.wavelength;
        let (sine, cosine) = (q * x + wave.phase).sin_cos();
        sum.height += wave.amplitude * sine;
        sum.slope += wave.amplitude * q * cosine;
        sum.curvature -= wave.amplitude * q * q * sine;
    }
    sum
}

fn differentiate(spectrum: &[Complex64], period: f64, order: i32) -> Vec<Complex64> {
    let n = spectrum.len();
    let factor = |k: usize| {
        let wave = if 2 * k <= n { k as f64 } else { k as f64 - n as f64 };
        // The highest wave of an even count has no slope at the points.
        let wave = if 2 * k == n && order % 2 == 1 { 0.0 } else { wave };
        Complex64::new(0.0, TAU * wave / period).powi(order) / n as f64
    };
    spectrum.iter().enumerate().map(|(k, z)| z * factor(k)).collect()
}

/// Quintic Hermite interpolation.
fn interpolated(samples: &[Height], period: f64, x: f64) -> Height {
    let n = samples.len();
    let step = period / n as f64;
    let place = (x / step).rem_euclid(n as f64);
    let left = (place as usize).min(n - 1);
    let t = place - left as f64;
    let (a, b) = (samples[left], samples[(left + 1) % n]);
    // Taylor polynomial from the left plus its difference to the values at the right end.
    let (a1, a2) = (a.slope * step, a.curvature * step * step);
    let (b1, b2) = (b.slope * step, b.curvature * step * step);
    let height = b.height - a.height - a1 - 0.5 * a2;
    let slope = b1 - a1 - a2;
    let curvature = b2 - a2;
    let cubic = 10.0 * height - 4.0 * slope + 0.5 * curvature;
    let quartic = -15.0 * height + 7.0 * slope - curvature;
    let quintic = 6.0 * height - 3.0 * slope + 0.5 * curvature;
    Height {
        height: a.height + t * (a1 + t * (0.5 * a2 + t * (cubic + t * (quartic + t * quintic)))),
        slope: (a1 + t * (a2 + t * (3.0 * cubic + t * (4.0 * quartic + t * 5.0 * quintic)))) / step,
        curvature: (a2 + t * (6.0 * cubic + t * (12.0 * quartic + t * 20.0 * quintic)))
            / (step * step),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::wave;
    use approx::assert_relative_eq;

    fn waves() -> Vec<Wave> {
        let wave = |wavelength, amplitude, phase| Wave { wavelength, amplitude, phase };
        vec![wave(1.0, 0.1, 0.3), wave(0.5, 0.07, 2.0), wave(0.125, 0.01, 4.0)]
    }

    #[test]
    fn derivatives_are_those_of_the_height() {
        let exact = RigidProfile::from_waves(&waves(), 1.0);
        let samples = RigidProfile::from_heights(&wave::sample(&waves(), 1.0, 64), 1.0);
        let step = 1e-5;
        for profile in [exact, samples] {
            for x in [-0.3, 0.0, 0.123, 0.77, 1.4] {
                let [before, at, after] =
                    [x - step, x, x + step].map(|position| profile.at(position));
                let slope = (after.height - before.height) / (2.0 * step);
                let curvature = (after.slope - before.slope) / (2.0 * step);
                // Differences err by the third derivative, 500 here and up to 1e5 for the quintic.
                assert_relative_eq!(at.slope, slope, epsilon = 1e-6);
                assert_relative_eq!(at.curvature, curvature, epsilon = 1e-3);
            }
        }
    }

    #[test]
    fn the_waves_to_resolve_are_those_with_slope() {
        let mut waves = waves();
        let steep = |waves: &[Wave]| RigidProfile::from_waves(waves, 1.0).steep_waves();
        assert_eq!(steep(&waves), 8.0);
        // Slopes of 0.1, 0.14 and 8e-6 over 2 pi.
        waves[2].amplitude = 1e-6;
        assert_eq!(steep(&waves), 2.0);
        assert_eq!(RigidProfile::from_waves(&waves, 1.0).shortest_waves(), 8.0);
        let samples = wave::sample(&waves, 1.0, 64);
        assert_eq!(RigidProfile::from_heights(&samples, 1.0).steep_waves(), 2.0);
        let flat = Wave { wavelength: 1.0, amplitude: 0.0, phase: 0.0 };
        assert_eq!(steep(&[flat]), 1.0);
    }

    #[test]
    fn a_partial_profile_has_the_waves_asked_for() {
        let exact = RigidProfile::from_waves(&waves(), 1.0);
        let samples = RigidProfile::from_heights(&wave::sample(&waves(), 1.0, 64), 1.0);
        let [long, middle, short] = waves()[..] else { panic!("three waves") };
        let halved = Wave { amplitude: 0.5 * middle.amplitude, ..middle };
        let expected = [
            ((1.0, 1.0, 0.3), vec![long]),
            ((1.0, 2.0, 0.5), vec![long, halved]),
            ((2.0, f64::INFINITY, 0.0), vec![long, middle]),
            ((2.0, f64::INFINITY, 1.0), vec![long, middle, short]),
        ];
        for ((whole, growing, share), waves) in expected {
            let expected = RigidProfile::from_waves(&waves, 1.0);
            for profile in [&exact, &samples] {
                let partial = profile.partial(whole, growing, share);
                for i in 0..64 {
                    let (x, expected) = (f64::from(i) / 64.0, expected.at(f64::from(i) / 64.0));
                    assert_relative_eq!(partial.at(x).height, expected.height, epsilon = 1e-12);
                    assert_relative_eq!(partial.at(x).slope, expected.slope, epsilon = 1e-10);
                }
            }
        }
    }

    #[test]
    fn samples_of_resolved_waves_are_the_waves() {
        let exact = RigidProfile::from_waves(&waves(), 1.0);
        let errors = [64, 128].map(|points| {
            let samples = RigidProfile::from_heights(&wave::sample(&waves(), 1.0, points), 1.0);
            (0..1000)
                .map(|i| f64::from(i) / 777.0)
                .map(|x| (samples.at(x).height - exact.at(x).height).abs())
                .fold(0.0, f64::max)
        });
        // Sixth order in the spacing.
        assert!(errors[1] < errors[0] / 50.0 && errors[1] < 1e-8, "{errors:?}");
    }
}
