//! Theory of Klüppel and Heinrich.

use crate::rubber::{FrequencyRange, RubberError, Viscoelastic};
use crate::surface::SineScale;
use std::f64::consts::{FRAC_PI_4, TAU};

/// The theory of Klüppel & Heinrich (Rubber Chem. Technol. 73, 578, 2000, doi:10.5254/1.3547607;
/// thesis 1.3.5) for superposed sines in plane strain.
///
/// A layer of thickness `<δ>` is strained as the profile is rough:
///
/// ```text
/// μ = 1 / (2 (2π)²) <δ> / (p v) ∫ ω E''(ω) S(ω) dω,   <δ> = b <z_p>,   <z_p> = ∫_d^∞ (z - d) φ(z) dz
/// ```
///
/// `φ` is the distribution of heights and `d` the distance of rubber and mean line. `S` is the one-sided
/// spectrum of height over `ξ²`, with ξ the largest length of the roughness: for a self-affine surface
/// `S = S_0 (ω / ω_min)^(2D - 7)` from `ω_min = 2 π v / ξ` with `S_0 = (3 - D) ξ_perp² / (2 π v ξ)`, of which the
/// integral is the mean square height over `ξ²`. A profile of waves has
/// `S = Σ_i D_i² / (2 ξ²) δ(ω - q_i v)` and ξ the longest wavelength, so that
///
/// ```text
/// μ = <δ> / (16 π² p ξ²) Σ_i q_i D_i² E''(q_i v)
/// ```
///
/// **The load** of the source is that of Greenwood and Williamson on the largest scale, spheres over
/// an area. Its counterpart in plane strain are line contacts, one for each ξ. A Hertz line contact
/// bears `π E_r a² / (4 R)` a unit length; with the `a² = R δ` of Hertz' sphere that is `π E_r δ / 4` for
/// a penetration δ, since the depth of a line contact in a half-plane is not defined otherwise.
/// Summits are as high as heights are, so
///
/// ```text
/// p = π/4 |E_r(2 π v / ξ)| <z_p> / ξ
/// ```
///
/// **The area** is the share of the profile above `d`, also that of the largest scale. Load and layer are
/// then in proportion, and friction is the same at every load; in the source it depends on it
/// weakly.
///
/// **b** is not known from the theory: it is fitted to measured friction.
#[derive(Debug, Clone, PartialEq)]
pub struct KlueppelHeinrich {
    /// Ascending, about their mean, in m.
    heights: Vec<f64>,
    /// Largest length of the roughness in m.
    length: f64,
    /// `|E_r(2 π v / ξ)|` in Pa.
    modulus: f64,
    /// `Σ_i q_i D_i² E''(q_i v) / (16 π² ξ²)` in Pa/m.
    dissipation: f64,
    layer_ratio: f64,
}

impl KlueppelHeinrich {
    /// The theory for a profile, its heights in m at equal spacing over a period, a rubber, a speed in
    /// m/s and `layer_ratio`, the factor b.
    ///
    /// # Errors
    /// [`RubberError::NotMeasured`] if the rubber is not known at the frequency of a wave.
    ///
    /// # Panics
    /// Without a height, or if no wave has an amplitude.
    pub fn new(
        waves: &[SineScale],
        heights: &[f64],
        rubber: &dyn Viscoelastic,
        speed: f64,
        layer_ratio: f64,
    ) -> Result<Self, RubberError> {
        let rough = || waves.iter().filter(|wave| wave.amplitude != 0.0);
        let length = rough().map(|wave| wave.wavelength).fold(0.0, f64::max);
        assert!(length > 0.0 && !heights.is_empty(), "a profile with heights and a wave");
        let lengths = rough().map(|wave| wave.wavelength);
        if let Some(excited) = FrequencyRange::excited(lengths, [speed.abs()]) {
            rubber.require(excited)?;
        }
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        let mut heights: Vec<f64> = heights.iter().map(|z| z - mean).collect();
        heights.sort_by(f64::total_cmp);
        let loss = |wave: &SineScale| {
            let wavenumber = TAU / wave.wavelength;
            let modulus = rubber.complex_modulus(wavenumber * speed);
            wavenumber * wave.amplitude.powi(2) * modulus.im
        };
        Ok(Self {
            heights,
            length,
            modulus: rubber.reduced_modulus(TAU * speed / length).norm(),
            dissipation: rough().map(loss).sum::<f64>() / (2.0 * TAU * length).powi(2),
            layer_ratio,
        })
    }

    /// Mean penetration depth `<z_p>` in m at the contact area fraction, between 0 and 1.
    pub fn mean_penetration(&self, contact_area_fraction: f64) -> f64 {
        let distance = self.distance(contact_area_fraction);
        let above = self.heights.iter().rev().take_while(|z| **z > distance);
        above.map(|z| z - distance).sum::<f64>() / self.heights.len() as f64
    }

    /// Mean pressure in Pa that gives a contact area fraction, between 0 and 1.
    pub fn mean_pressure(&self, contact_area_fraction: f64) -> f64 {
        self.stiffness() * self.mean_penetration(contact_area_fraction)
    }

    /// Contact area fraction at the mean pressure `p` in Pa, by bisection of
    /// [`Self::mean_pressure`]; 1 from where the rubber reaches the lowest valley.
    pub fn contact_area_fraction(&self, mean_pressure: f64) -> f64 {
        let (mut below, mut above) = (0.0, 1.0);
        if self.mean_pressure(above) <= mean_pressure {
            return above;
        }
        // As many halvings as a double has bits.
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (below + above);
            if self.mean_pressure(middle) < mean_pressure {
                below = middle;
            } else {
                above = middle;
            }
        }
        0.5 * (below + above)
    }

    /// Friction coefficient, the same at every mean pressure.
    pub fn friction_coefficient(&self) -> f64 {
        self.layer_ratio * self.dissipation / self.stiffness()
    }

    /// Pressure over penetration depth, in Pa/m.
    fn stiffness(&self) -> f64 {
        FRAC_PI_4 * self.modulus / self.length
    }

    /// Distance `d` above which the share of the heights lies. A sample stands for the interval around
    /// it, so its own height is met in the middle of its share.
    fn distance(&self, contact_area_fraction: f64) -> f64 {
        let last = self.heights.len() - 1;
        let place = (1.0 - contact_area_fraction) * self.heights.len() as f64 - 0.5;
        let place = place.clamp(0.0, last as f64);
        let below = (place as usize).min(last.saturating_sub(1));
        let above = (below + 1).min(last);
        let share = place - below as f64;
        self.heights[below] + share * (self.heights[above] - self.heights[below])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::{MaxwellBranch, Rubber};
    use crate::surface::{Wave, wave};
    use std::f64::consts::PI;

    const SPEED: f64 = 0.01;
    const POINTS: usize = 4096;

    fn rubber() -> Rubber {
        Rubber {
            name: "two branches".into(),
            equilibrium_modulus: 4e6,
            branches: vec![
                MaxwellBranch { modulus: 8e6, relaxation_time: 1e-3 },
                MaxwellBranch { modulus: 2e8, relaxation_time: 1e-5 },
            ],
            poisson_ratio: 0.49,
            finite_strain: Default::default(),
        }
    }

    fn one_sine(layer_ratio: f64) -> KlueppelHeinrich {
        let scale = SineScale { wavelength: 1e-3, amplitude: 2e-5 };
        let wave = Wave { wavelength: 1e-3, amplitude: 2e-5, phase: 0.3 };
        let heights = wave::sample(&[wave], 1e-3, POINTS);
        KlueppelHeinrich::new(&[scale], &heights, &rubber(), SPEED, layer_ratio).unwrap()
    }

    #[test]
    fn one_sine_penetrates_as_its_heights_say() {
        let theory = one_sine(1.0);
        for area in [0.01, 0.05, 0.5, 0.9, 1.0] {
            // z > d on a share s of a sine: d = D cos(π s), <z_p> = D (sin(π s) / π - s cos(π s)).
            let angle = PI * area;
            let exact = 2e-5 * (angle.sin() / PI - area * angle.cos());
            // A sample more or less may lie above d.
            let points = area * POINTS as f64;
            approx::assert_relative_eq!(
                theory.mean_penetration(area),
                exact,
                max_relative = 1.0 / points
            );
        }
        assert_eq!(theory.mean_penetration(0.0), 0.0);
    }

    #[test]
    fn pressure_and_area_are_inverse_and_the_friction_is_that_of_the_layer() {
        let (theory, rubber) = (one_sine(3.0), rubber());
        let q = TAU / 1e-3;
        for area in [0.01, 0.1, 0.6, 0.99] {
            let p = theory.mean_pressure(area);
            approx::assert_relative_eq!(theory.contact_area_fraction(p), area, max_relative = 1e-9);
            let depth = theory.mean_penetration(area);
            let reduced = rubber.reduced_modulus(q * SPEED).norm();
            approx::assert_relative_eq!(
                p,
                0.25 * PI * reduced * depth / 1e-3,
                max_relative = 1e-12
            );
            let loss = rubber.complex_modulus(q * SPEED).im;
            let expected = 3.0 * depth * q * 2e-5 * 2e-5 * loss / (16.0 * PI * PI * p * 1e-6);
            approx::assert_relative_eq!(
                theory.friction_coefficient(),
                expected,
                max_relative = 1e-12
            );
        }
        assert_eq!(theory.contact_area_fraction(2.0 * theory.mean_pressure(1.0)), 1.0);
    }

    /// The formula of the source, with its spectrum and its frequencies, against a dense ladder.
    #[test]
    fn a_dense_ladder_is_the_self_affine_surface_of_the_source() {
        let (rubber, dimension, height, length) = (rubber(), 2.3, 1e-4, 1e-3);
        let (lowest, decades, count) = (TAU * SPEED / length, 2.0, 2000);
        let spectrum = |frequency: f64| {
            let plateau = (3.0 - dimension) * height * height / (TAU * SPEED * length);
            plateau * (frequency / lowest).powf(2.0 * dimension - 7.0)
        };
        let band = |k: u32| {
            let at = |k: f64| lowest * 10_f64.powf(decades * k / f64::from(count));
            let k = f64::from(k);
            (at(k + 0.5), at(k + 1.0) - at(k))
        };
        let waves: Vec<SineScale> = (0..count)
            .map(|k| {
                let (frequency, width) = band(k);
                let square = 2.0 * length * length * spectrum(frequency) * width;
                SineScale { wavelength: TAU * SPEED / frequency, amplitude: square.sqrt() }
            })
            .collect();
        let integral: f64 = (0..count)
            .map(|k| {
                let (frequency, width) = band(k);
                let loss = rubber.complex_modulus(frequency).im;
                frequency * loss * spectrum(frequency) * width
            })
            .sum();
        let theory =
            KlueppelHeinrich::new(&waves, &[-height, height], &rubber, SPEED, 1.0).unwrap();
        let (p, depth) = (theory.mean_pressure(0.4), theory.mean_penetration(0.4));
        let source = depth / (2.0 * TAU * TAU * p * SPEED) * integral;
        // The longest wave of the ladder is half a band shorter than ξ: 1e-3 of it, squared.
        approx::assert_relative_eq!(theory.friction_coefficient(), source, max_relative = 3e-3);
    }

    #[test]
    fn an_elastic_body_has_no_friction() {
        let scale = SineScale { wavelength: 1e-3, amplitude: 2e-5 };
        let rubber = Rubber::elastic(3e6, 0.5);
        let theory = KlueppelHeinrich::new(&[scale], &[-1e-5, 1e-5], &rubber, SPEED, 1.0).unwrap();
        assert_eq!(theory.friction_coefficient(), 0.0);
    }
}
