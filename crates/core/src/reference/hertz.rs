//! Hertz contact with the crest of a sine wave.

use crate::surface::SineScale;
use std::f64::consts::{PI, TAU};

/// Line contact of an elastic half-plane with the parabola at the crest of a rigid sine wave
/// (Johnson, Contact Mechanics, 1985, section 4.2; thesis 2.5.1-4).
///
/// The limit of one sine for contacts much shorter than the wave; with the glassy modulus
/// that of high sliding speed, with the relaxed modulus that of low speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SineCrest {
    /// Reduced modulus E_r in Pa.
    pub reduced_modulus: f64,
    /// The sine wave.
    pub wave: SineScale,
}

impl SineCrest {
    /// Radius of curvature at the crest `R = λ² / (4 π² D)`, in m.
    pub fn radius(&self) -> f64 {
        (self.wave.wavelength / TAU).powi(2) / self.wave.amplitude
    }

    /// Half of the contact width `a = sqrt(4 p λ R / (π E_r))` under the mean pressure `p` in Pa,
    /// in m.
    pub fn half_width(&self, mean_pressure: f64) -> f64 {
        let force = mean_pressure * self.wave.wavelength;
        (4.0 * force * self.radius() / (PI * self.reduced_modulus)).sqrt()
    }

    /// Contact area fraction `2 a / λ`.
    pub fn contact_area_fraction(&self, mean_pressure: f64) -> f64 {
        2.0 * self.half_width(mean_pressure) / self.wave.wavelength
    }

    /// Largest pressure `2 p λ / (π a)`, in Pa.
    pub fn maximum_pressure(&self, mean_pressure: f64) -> f64 {
        2.0 * mean_pressure * self.wave.wavelength / (PI * self.half_width(mean_pressure))
    }
}

#[cfg(test)]
mod tests {
    use super::super::Westergaard;
    use super::*;

    #[test]
    fn westergaard_tends_to_hertz_as_the_contact_shrinks() {
        let wave = SineScale { wavelength: 1e-3, amplitude: 2e-5 };
        let hertz = SineCrest { reduced_modulus: 4e6, wave };
        let westergaard = Westergaard { reduced_modulus: 4e6, wave };
        for load in [1e-4, 1e-6] {
            let p = load * westergaard.full_contact_pressure();
            // asin(s) = s (1 + s²/6 + ...) with s² = p/p*; the largest pressure is the same.
            approx::assert_relative_eq!(
                westergaard.contact_area_fraction(p),
                hertz.contact_area_fraction(p) * (1.0 + load / 6.0),
                max_relative = load * load
            );
            approx::assert_relative_eq!(
                westergaard.maximum_pressure(p),
                hertz.maximum_pressure(p),
                max_relative = 1e-14
            );
        }
    }
}
