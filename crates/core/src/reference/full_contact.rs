//! Sliding in full contact with one sine wave.

use crate::rubber::Rubber;
use crate::surface::SineScale;
use std::f64::consts::{PI, TAU};

/// A viscoelastic half-plane that slides at constant speed in full contact with a rigid sine wave: one frequency
/// `ω = q v`, `q = 2 π / λ`, so only the complex modulus there matters (thesis 2.2.5-6 with the half-plane's compliance
/// `2 / (q E_r)`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FullContact<'a> {
    /// The rubber.
    pub rubber: &'a Rubber,
    /// The sine wave.
    pub wave: SineScale,
    /// Sliding speed in m/s; against `+x` if negative.
    pub speed: f64,
}

impl FullContact<'_> {
    /// Smallest mean pressure of full contact `π |E_r(q v)| D / λ`, in Pa: below it the pressure
    /// would be a tension in the valleys.
    pub fn smallest_pressure(&self) -> f64 {
        PI * self.reduced_modulus().norm() * self.wave.amplitude / self.wave.wavelength
    }

    /// Friction coefficient `q² D² E''(q v) / (4 (1 - ν²) p)` at the mean pressure `p` in Pa, if
    /// that is enough for full contact.
    pub fn friction_coefficient(&self, mean_pressure: f64) -> Option<f64> {
        let slope = self.wavenumber() * self.wave.amplitude;
        let enough = mean_pressure >= self.smallest_pressure() && mean_pressure > 0.0;
        enough.then(|| slope * slope * self.reduced_modulus().im / (4.0 * mean_pressure))
    }

    fn wavenumber(&self) -> f64 {
        TAU / self.wave.wavelength
    }

    fn reduced_modulus(&self) -> rustfft::num_complex::Complex64 {
        self.rubber.reduced_modulus(self.wavenumber() * self.speed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::MaxwellBranch;

    #[test]
    fn an_elastic_body_needs_the_pressure_of_westergaard_and_has_no_friction() {
        let wave = SineScale { wavelength: 1e-3, amplitude: 1e-5 };
        let rubber = Rubber::elastic(3e6, 0.5);
        let contact = FullContact { rubber: &rubber, wave, speed: 0.1 };
        let westergaard = super::super::Westergaard { reduced_modulus: 4e6, wave };
        let p = contact.smallest_pressure();
        approx::assert_relative_eq!(p, westergaard.full_contact_pressure(), max_relative = 1e-14);
        assert_eq!(contact.friction_coefficient(p), Some(0.0));
        assert_eq!(contact.friction_coefficient(0.99 * p), None);
    }

    #[test]
    fn one_branch_at_its_peak_dissipates_half_its_modulus() {
        // At ω τ = 1 the loss modulus of a branch is half its modulus.
        let rubber = Rubber {
            name: "one branch".into(),
            equilibrium_modulus: 1e6,
            branches: vec![MaxwellBranch { modulus: 8e6, relaxation_time: 1e-3 }],
            poisson_ratio: 0.0,
            finite_strain: Default::default(),
        };
        let wave = SineScale { wavelength: TAU * 1e-3, amplitude: 1e-5 };
        let contact = FullContact { rubber: &rubber, wave, speed: 1.0 };
        let expected = 1e-4 * 4e6 / (4.0 * 1e6);
        let friction = contact.friction_coefficient(1e6).unwrap();
        approx::assert_relative_eq!(friction, expected, max_relative = 1e-12);
    }
}
