//! Elastic contact with one sine wave.

use crate::surface::SineScale;
use std::f64::consts::{FRAC_2_PI, PI};

/// Frictionless contact of an elastic half-plane with a rigid sine wave (Westergaard 1939,
/// doi:10.1115/1.4008919; Johnson, Contact Mechanics, 1985, section 13.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Westergaard {
    /// Reduced modulus E_r in Pa.
    pub reduced_modulus: f64,
    /// The sine wave.
    pub wave: SineScale,
}

impl Westergaard {
    /// Smallest mean pressure of full contact `p* = π E_r D / λ`, in Pa.
    pub fn full_contact_pressure(&self) -> f64 {
        PI * self.reduced_modulus * self.wave.amplitude / self.wave.wavelength
    }

    /// Contact area fraction `A_c/A_0 = 2/π asin(sqrt(p/p*))`, 1 from `p*` on.
    pub fn contact_area_fraction(&self, mean_pressure: f64) -> f64 {
        FRAC_2_PI * self.load(mean_pressure).sqrt().asin()
    }

    /// Mean pressure in Pa that gives a contact area fraction: `p* sin²(π/2 A_c/A_0)`.
    pub fn mean_pressure(&self, contact_area_fraction: f64) -> f64 {
        self.full_contact_pressure() * (0.5 * PI * contact_area_fraction).sin().powi(2)
    }

    /// Pressure in Pa at the `distance` in m from a crest: with `ψ = π distance / λ`
    /// `2 sqrt(p p*) cos ψ sqrt(1 - sin²ψ p*/p)` in contact, `p + p* cos 2ψ` in full contact.
    pub fn pressure(&self, mean_pressure: f64, distance: f64) -> f64 {
        let full = self.full_contact_pressure();
        let angle = PI * distance / self.wave.wavelength;
        if mean_pressure >= full {
            return mean_pressure + full * (2.0 * angle).cos();
        }
        let under_root = 1.0 - angle.sin().powi(2) * full / mean_pressure;
        2.0 * (mean_pressure * full).sqrt() * angle.cos().abs() * under_root.max(0.0).sqrt()
    }

    /// Largest pressure in Pa: `2 sqrt(p p*)`, `p + p*` in full contact.
    pub fn maximum_pressure(&self, mean_pressure: f64) -> f64 {
        self.pressure(mean_pressure, 0.0)
    }

    /// Mean separation in m: `D (1 - P + P ln P)` with `P = p/p*`, 0 from `p*` on.
    ///
    /// It is the integral of the compliance `dubar/dp = D ln(P) / p*`; the work of the load up to
    /// full contact is then `p* D / 4`, the elastic energy of the sine.
    pub fn mean_separation(&self, mean_pressure: f64) -> f64 {
        let load = self.load(mean_pressure);
        let logarithm = if load > 0.0 { load.ln() } else { 0.0 };
        self.wave.amplitude * (1.0 - load + load * logarithm)
    }

    /// Mean pressure over that of full contact, between 0 and 1.
    fn load(&self, mean_pressure: f64) -> f64 {
        (mean_pressure / self.full_contact_pressure()).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTACT: Westergaard =
        Westergaard { reduced_modulus: 4e6, wave: SineScale { wavelength: 1e-3, amplitude: 2e-5 } };

    #[test]
    fn the_pressure_has_the_mean_and_the_edges_it_should() {
        for relative in [0.1, 0.6, 1.0, 1.7] {
            let p = relative * CONTACT.full_contact_pressure();
            let half_width = 0.5e-3 * CONTACT.contact_area_fraction(p);
            // With distance = a sin(s) the root at the edge is no trouble for the midpoint rule.
            let n = 2000;
            let mean: f64 = (0..n)
                .map(|i| {
                    let s = (f64::from(i) + 0.5) / f64::from(n) * 0.5 * PI;
                    let distance = half_width * s.sin();
                    CONTACT.pressure(p, distance) * s.cos() * half_width * 0.5 * PI / f64::from(n)
                })
                .sum::<f64>()
                * 2.0
                / 1e-3;
            approx::assert_relative_eq!(mean, p, max_relative = 1e-5);
            if relative < 1.0 {
                assert_eq!(CONTACT.pressure(p, 1.0001 * half_width), 0.0);
                assert!(CONTACT.pressure(p, 0.9999 * half_width) > 0.0);
            }
        }
    }

    #[test]
    fn the_area_and_its_pressure_are_inverse() {
        for fraction in [1e-3, 0.3, 0.99, 1.0] {
            let p = CONTACT.mean_pressure(fraction);
            approx::assert_relative_eq!(
                CONTACT.contact_area_fraction(p),
                fraction,
                max_relative = 1e-7
            );
        }
    }

    #[test]
    fn the_surfaces_part_by_the_amplitude_and_meet_in_full_contact() {
        assert_eq!(CONTACT.mean_separation(0.0), 2e-5);
        assert_eq!(CONTACT.mean_separation(CONTACT.full_contact_pressure()), 0.0);
        assert_eq!(CONTACT.mean_separation(1e9), 0.0);
    }
}
