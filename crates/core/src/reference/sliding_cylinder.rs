//! A cylinder that slides over a rubber with one relaxation time.

use std::f64::consts::PI;

/// Steady sliding of a rigid cylinder, without shear, over a half-space of a standard linear solid: the exact solution of
/// Hunter (J. Appl. Mech. 28, 611, 1961, doi:10.1115/1.3641792; for sliding Goryacheva, Contact Mechanics in Tribology,
/// 1998, chapter 3).
///
/// The solid has the relaxed reduced modulus `E_0`, the glassy one `E_g`, the relaxation time `T` (at constant strain) and
/// the retardation time `T' = T E_g / E_0` (at constant stress). With the half-width `c` and
///
/// ```text
/// κ = T' V / c,  τ = T V / c,  k = K_1(1/κ) / K_0(1/κ),  i = I_1(1/τ) / I_0(1/τ)
/// s = (κ - τ) i / (i + k)                     middle of the contact, ahead of the axis, in c
/// F = π E_0 c² / (2 R) (1/2 + s k)            force per length
/// μ = (c / R) (s - τ + (κ - s) / (1 + 2 s k))
/// ```
///
/// It follows from `p - T V p'` and `u - T' V u'`, which obey the equations of an elastic half-space with `E_0`; the
/// pressure vanishes at both edges, and the rubber ahead of the contact has never been loaded.
///
/// ```
/// use asperity_core::reference::SlidingCylinder;
///
/// let slider = SlidingCylinder { radius: 0.01, relaxed_modulus: 4e6, glassy_modulus: 4e7, relaxation_time: 1e-3 };
/// let contact = slider.contact(0.1, 1e-3);
/// assert!((contact.friction_coefficient - 0.0575312).abs() < 1e-7);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlidingCylinder {
    /// R in m.
    pub radius: f64,
    /// E_0 in Pa, `E / (1 - ν²)` at rest.
    pub relaxed_modulus: f64,
    /// E_g in Pa, above E_0.
    pub glassy_modulus: f64,
    /// T in s.
    pub relaxation_time: f64,
}

/// The contact of a [`SlidingCylinder`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CylinderContact {
    /// Half of the width of the contact in m.
    pub half_width: f64,
    /// Distance in m of the middle of the contact ahead of the axis of the cylinder.
    pub advance: f64,
    /// Force per length in N/m.
    pub force: f64,
    /// Friction coefficient.
    pub friction_coefficient: f64,
}

impl SlidingCylinder {
    /// The contact at the speed in m/s that is `2 half_width` wide, in m; both positive.
    pub fn contact(&self, speed: f64, half_width: f64) -> CylinderContact {
        let c = half_width;
        let tau = self.relaxation_time * speed / c;
        let kappa = tau * self.glassy_modulus / self.relaxed_modulus;
        let k = ratio_of_k(1.0 / kappa);
        let i = ratio_of_i(1.0 / tau);
        let s = (kappa - tau) * i / (i + k);
        let factor = 0.5 + s * k;
        CylinderContact {
            half_width: c,
            advance: s * c,
            force: PI * self.relaxed_modulus * c * c / (2.0 * self.radius) * factor,
            friction_coefficient: c / self.radius * (s - tau + (kappa - s) / (2.0 * factor)),
        }
    }

    /// The contact at the speed in m/s under the force per length in N/m; both positive.
    pub fn under(&self, speed: f64, force: f64) -> CylinderContact {
        // The width is between those of Hertz with the glassy and with the relaxed modulus.
        let hertz = |modulus: f64| (4.0 * force * self.radius / (PI * modulus)).sqrt();
        let (mut narrow, mut wide) = (hertz(self.glassy_modulus), hertz(self.relaxed_modulus));
        loop {
            let middle = (narrow * wide).sqrt();
            if middle <= narrow || middle >= wide {
                return self.contact(speed, middle);
            }
            let end =
                if self.contact(speed, middle).force < force { &mut narrow } else { &mut wide };
            *end = middle;
        }
    }
}

/// `I_1(y) / I_0(y)` by its continued fraction (DLMF 10.33), which keeps all digits of a small ratio.
fn ratio_of_i(y: f64) -> f64 {
    if y > LARGE {
        return asymptotic(y, -1.0);
    }
    // Terms beyond those of the order y do not matter.
    let terms = 40 + 2 * y as i32;
    (1..=terms).rev().fold(0.0, |below, n| 1.0 / (2.0 * f64::from(n) / y + below))
}

/// `K_1(z) / K_0(z)`: both are integrals of `exp(-z cosh t)` from 0 on, which the trapezoidal rule has to round-off.
fn ratio_of_k(z: f64) -> f64 {
    if z > LARGE {
        return asymptotic(z, 1.0);
    }
    let step = 1.0 / 64.0;
    let [mut zeroth, mut first] = [0.5; 2];
    for k in 1.. {
        let cosh = (f64::from(k) * step).cosh();
        let weight = (-z * (cosh - 1.0)).exp();
        zeroth += weight;
        first += weight * cosh;
        // The tail falls faster than any power.
        if weight * cosh < 1e-18 * first {
            break;
        }
    }
    first / zeroth
}

/// Beyond, ratios are those of [`asymptotic`].
const LARGE: f64 = 1e3;

/// Ratio of the Bessel functions of order 1 and 0, to a relative 1e-12 beyond [`LARGE`] (DLMF 10.40): `sign` is
/// -1 for I and 1 for K.
fn asymptotic(z: f64, sign: f64) -> f64 {
    1.0 + sign / (2.0 * z) - 1.0 / (8.0 * z * z) + sign / (8.0 * z.powi(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLIDER: SlidingCylinder = SlidingCylinder {
        radius: 0.01,
        relaxed_modulus: 4e6,
        glassy_modulus: 4e7,
        relaxation_time: 1e-3,
    };

    /// Abramowitz & Stegun, tables 9.8: I_0(1), I_1(1), K_0(1), K_1(1), and K at 0.1.
    #[test]
    fn ratios_of_bessel_functions_are_those_of_the_tables() {
        approx::assert_relative_eq!(
            ratio_of_i(1.0),
            0.565_159_104 / 1.266_065_878,
            max_relative = 2e-9
        );
        approx::assert_relative_eq!(
            ratio_of_k(1.0),
            0.601_907_230 / 0.421_024_438,
            max_relative = 3e-9
        );
        approx::assert_relative_eq!(
            ratio_of_k(0.1),
            9.853_844_780 / 2.427_069_024,
            max_relative = 1e-9
        );
        // Where the series takes over.
        for (series, sum) in
            [(asymptotic(1e3, -1.0), ratio_of_i(1e3)), (asymptotic(1e3, 1.0), ratio_of_k(1e3))]
        {
            approx::assert_relative_eq!(series, sum, max_relative = 1e-12);
        }
    }

    #[test]
    fn slow_and_fast_sliding_are_contacts_of_hertz_without_friction() {
        let force = 500.0;
        let hertz = |modulus: f64| (4.0 * force * SLIDER.radius / (PI * modulus)).sqrt();
        let slow = SLIDER.under(1e-8, force);
        let fast = SLIDER.under(1e8, force);
        approx::assert_relative_eq!(slow.half_width, hertz(4e6), max_relative = 1e-6);
        approx::assert_relative_eq!(fast.half_width, hertz(4e7), max_relative = 1e-6);
        for contact in [slow, fast] {
            approx::assert_relative_eq!(contact.force, force, max_relative = 1e-12);
            assert!(contact.friction_coefficient.abs() < 1e-6, "{contact:?}");
        }
    }

    /// A linear solid: friction over the slope `c / R` depends on `V T / c` alone.
    #[test]
    fn friction_grows_as_the_root_of_the_force_at_a_speed_that_grows_as_well() {
        let (one, four) = (SLIDER.under(0.3, 100.0), SLIDER.under(0.6, 400.0));
        approx::assert_relative_eq!(four.half_width, 2.0 * one.half_width, max_relative = 1e-12);
        approx::assert_relative_eq!(
            four.friction_coefficient,
            2.0 * one.friction_coefficient,
            max_relative = 1e-11
        );
        assert!(one.advance > 0.0 && one.friction_coefficient > 0.01);
    }
}
