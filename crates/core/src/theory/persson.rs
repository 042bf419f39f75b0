//! Persson's theory of rubber friction.

use crate::rubber::{FrequencyRange, RubberError, Viscoelastic};
use crate::surface::SineScale;
use statrs::function::erf::{erf, erf_inv};
use std::f64::consts::TAU;

/// Persson's theory (J. Chem. Phys. 115, 3840, 2001, doi:10.1063/1.1388626) for superposed sines in
/// plane strain.
///
/// Seen with all waves up to `q`, the pressure is distributed as by a diffusion over the variance
/// `V(q)` that it would have in full contact. It starts at the mean pressure `p`, and what arrives
/// at zero has left the contact:
///
/// ```text
/// dP/dV = 1/2 d²P/dσ²,  P(σ, 0) = δ(σ - p),  P(0, V) = 0   so   A_c/A_0 = erf(p / sqrt(2 V))
/// ```
///
/// That is the `P(q) = erf(1 / (2 sqrt G))` of the source with `G = V / (2 p²)`. On an isotropic surface
/// `V = ∫ d²q C(q) |q E_r(q v cos φ) / 2|²`, and `G = 1/8 ∫ q³ C dq ∫ |E_r/p|² dφ` as printed there. A
/// sine `D sin(q x)` has the pressure `q |E_r(q v)| D / 2` in full contact, so on a profile
///
/// ```text
/// V = Σ_i q_i² D_i² |E_r(q_i v)|² / 8,   μ = Σ_i q_i² D_i² Im E_r(q_i v) W_i / (4 p)
/// ```
///
/// with the friction of full contact where every `W_i` is 1. `W = S P` with `S = γ + (1 - γ) P²`, since a
/// free surface strains less than one in full contact (Lorenz, Oh, Nam, Jeon & Persson, J. Chem.
/// Phys. 142, 194701, 2015: γ = 1/2; that of 2001: 1). A wave is a jump of `V`, over which `W` falls:
/// `W_i` is the mean of `W` over the jump, which is the limit of a narrow band of waves.
#[derive(Debug, Clone, PartialEq)]
pub struct Persson {
    gamma: f64,
    /// From the longest wave to the shortest.
    jumps: Vec<Jump>,
}

/// What one wave adds.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Jump {
    /// Variance of the pressure in Pa² without and with the wave.
    before: f64,
    after: f64,
    /// Friction stress of the wave in full contact, in Pa.
    stress: f64,
}

/// `erf(x)` differs from 1 by less than round-off beyond.
const SATURATION: f64 = 6.0;
/// Longest panel of the quadrature over `ln V`: three-point Gauss then has ten digits.
const PANEL: f64 = 0.125;

impl Persson {
    /// The theory for a profile, a rubber, a speed in m/s, and γ between 0 and 1: the share of the
    /// strain of full contact that is left in vanishing contact.
    ///
    /// # Errors
    /// [`RubberError::NotMeasured`] if the rubber is not known at the frequency of a wave.
    pub fn new(
        waves: &[SineScale],
        rubber: &dyn Viscoelastic,
        speed: f64,
        gamma: f64,
    ) -> Result<Self, RubberError> {
        let mut waves: Vec<&SineScale> = waves.iter().filter(|w| w.amplitude != 0.0).collect();
        waves.sort_by(|a, b| b.wavelength.total_cmp(&a.wavelength));
        let lengths = waves.iter().map(|wave| wave.wavelength);
        if let Some(excited) = FrequencyRange::excited(lengths, [speed.abs()]) {
            rubber.require(excited)?;
        }
        let mut variance = 0.0;
        let jump = |wave: &SineScale| {
            let wavenumber = TAU / wave.wavelength;
            let slope = wavenumber * wave.amplitude;
            let modulus = rubber.reduced_modulus(wavenumber * speed);
            let before = variance;
            variance += slope * slope * modulus.norm_sqr() / 8.0;
            Jump { before, after: variance, stress: slope * slope * modulus.im / 4.0 }
        };
        Ok(Self { gamma, jumps: waves.into_iter().map(jump).collect() })
    }

    /// Variance of the pressure in full contact with all waves, in Pa².
    pub fn pressure_variance(&self) -> f64 {
        self.jumps.last().map_or(0.0, |jump| jump.after)
    }

    /// Contact area fraction at the mean pressure `p` in Pa.
    pub fn contact_area_fraction(&self, mean_pressure: f64) -> f64 {
        contact_area_fraction(mean_pressure, self.pressure_variance())
    }

    /// Mean pressure in Pa that gives a contact area fraction below 1: the inverse of
    /// [`Self::contact_area_fraction`]. The theory has full contact at infinite pressure only.
    pub fn mean_pressure(&self, contact_area_fraction: f64) -> f64 {
        (2.0 * self.pressure_variance()).sqrt() * erf_inv(contact_area_fraction)
    }

    /// Friction coefficient at the mean pressure `p` in Pa.
    pub fn friction_coefficient(&self, mean_pressure: f64) -> f64 {
        let weighted = |jump: &Jump| jump.stress * self.mean_weight(jump, mean_pressure);
        self.jumps.iter().map(weighted).sum::<f64>() / mean_pressure
    }

    /// Mean of `W` over a jump of the variance: 1 up to where `P` begins to fall, from there by
    /// quadrature over `ln V`, in which `P` varies slowly over all its decades.
    fn mean_weight(&self, jump: &Jump, mean_pressure: f64) -> f64 {
        let knee = 0.5 * (mean_pressure / SATURATION).powi(2);
        if jump.after <= knee {
            return 1.0;
        }
        let from = jump.before.max(knee);
        let (start, span) = (from.ln(), (jump.after / from).ln());
        let panels = (span / PANEL).ceil().max(1.0) as usize;
        let step = span / panels as f64;
        // Dividing by the integral of 1 by the same rule keeps small jumps free of cancellation.
        let (mut weight, mut measure) = (0.0, 0.0);
        for panel in 0..panels {
            let middle = start + (panel as f64 + 0.5) * step;
            for (place, share) in GAUSS {
                let variance = (middle + 0.5 * step * place).exp();
                weight += share * variance * self.weight(mean_pressure, variance);
                measure += share * variance;
            }
        }
        let falling = weight / measure;
        let saturated = (from - jump.before) / (jump.after - jump.before);
        if saturated > 0.0 { saturated + (1.0 - saturated) * falling } else { falling }
    }

    /// `W = S P`.
    fn weight(&self, mean_pressure: f64, variance: f64) -> f64 {
        let area = contact_area_fraction(mean_pressure, variance);
        area * (self.gamma + (1.0 - self.gamma) * area * area)
    }
}

/// Abscissae and weights of the Gauss rule of three points.
const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 18.0),
    (0.0, 8.0 / 18.0),
    (0.774_596_669_241_483_4, 5.0 / 18.0),
];

fn contact_area_fraction(mean_pressure: f64, variance: f64) -> f64 {
    erf(mean_pressure / (2.0 * variance).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::FullContact;
    use crate::rubber::{MaxwellBranch, Rubber};
    use crate::surface::{TABLE_3_1_MM, Wave, wave};
    use proptest::prelude::*;
    use rustfft::num_complex::Complex64;
    use std::f64::consts::PI;

    const SPEED: f64 = 0.01;

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

    fn ladder() -> Vec<SineScale> {
        let scale = |(wavelength, amplitude): &(f64, f64)| SineScale {
            wavelength: 1e-3 * wavelength,
            amplitude: 1e-3 * amplitude,
        };
        TABLE_3_1_MM[..3].iter().map(scale).collect()
    }

    #[test]
    fn at_large_pressure_it_is_full_contact() {
        let (rubber, waves) = (rubber(), ladder());
        let theory = Persson::new(&waves, &rubber, SPEED, 0.5).unwrap();
        // Beyond six standard deviations erf is 1 to the last digit.
        let p = 10.0 * theory.pressure_variance().sqrt();
        let exact: f64 = waves
            .iter()
            .map(|wave| FullContact { rubber: &rubber, wave: *wave, speed: SPEED })
            .map(|contact| contact.friction_coefficient(p).unwrap())
            .sum();
        approx::assert_relative_eq!(theory.friction_coefficient(p), exact, max_relative = 1e-14);
        assert_eq!(theory.contact_area_fraction(p), 1.0);
    }

    #[test]
    fn the_variance_is_that_of_the_pressure_of_a_sampled_profile() {
        let (rubber, scales) = (rubber(), ladder());
        let phases = [0.3, 2.0, 4.4];
        let waves: Vec<Wave> = scales
            .iter()
            .zip(phases)
            .map(|(s, phase)| Wave { wavelength: s.wavelength, amplitude: s.amplitude, phase })
            .collect();
        let (period, n) = (2.5e-4, 64);
        let heights = wave::sample(&waves, period, n);
        // The pressure in full contact, wavenumber by wavenumber.
        let pressure = |i: usize| -> f64 {
            (1..n / 2)
                .map(|k| {
                    let angle = |j: usize| TAU * (k * j) as f64 / n as f64;
                    let terms = heights.iter().enumerate();
                    let height: Complex64 =
                        terms.map(|(j, z)| Complex64::from_polar(z / n as f64, -angle(j))).sum();
                    let q = TAU * k as f64 / period;
                    let modulus = rubber.reduced_modulus(q * SPEED);
                    2.0 * (modulus * height * Complex64::from_polar(0.5 * q, angle(i))).re
                })
                .sum()
        };
        let variance = (0..n).map(|i| pressure(i).powi(2)).sum::<f64>() / n as f64;
        let theory = Persson::new(&scales, &rubber, SPEED, 0.5).unwrap();
        approx::assert_relative_eq!(theory.pressure_variance(), variance, max_relative = 1e-12);
    }

    #[test]
    fn small_loads_have_area_in_proportion_and_constant_friction() {
        let theory = Persson::new(&ladder(), &rubber(), SPEED, 0.5).unwrap();
        let p = 1e-4 * theory.pressure_variance().sqrt();
        // erf(x) = 2 x / sqrt(pi) (1 - x²/3 + ...).
        let area = 1e-4 * (2.0 / PI).sqrt();
        approx::assert_relative_eq!(theory.contact_area_fraction(p), area, max_relative = 1e-8);
        // The first jump starts at full contact, which makes the next order in p that of p.
        approx::assert_relative_eq!(
            theory.friction_coefficient(p),
            theory.friction_coefficient(0.1 * p),
            max_relative = 1e-3
        );
    }

    /// Without a reduction of strain the mean over a jump has a closed form.
    #[test]
    fn the_mean_over_a_jump_is_its_integral() {
        let theory = Persson::new(&ladder(), &rubber(), SPEED, 1.0).unwrap();
        for relative in [1e-5, 1e-3, 0.1, 0.5, 1.0, 3.0, 20.0] {
            let p = relative * theory.pressure_variance().sqrt();
            let integral = |v: f64| {
                if v == 0.0 {
                    return 0.0;
                }
                let x = p / (2.0 * v).sqrt();
                let free = statrs::function::erf::erfc(x);
                v * erf(x) + p * (2.0 * v / PI).sqrt() * (-x * x).exp() - p * p * free
            };
            for jump in &theory.jumps {
                let expected =
                    (integral(jump.after) - integral(jump.before)) / (jump.after - jump.before);
                approx::assert_relative_eq!(
                    theory.mean_weight(jump, p),
                    expected,
                    max_relative = 1e-9
                );
            }
        }
    }

    #[test]
    fn a_wave_is_a_narrow_band_of_waves() {
        let (rubber, wave) = (rubber(), ladder()[0]);
        let one = Persson::new(&[wave], &rubber, SPEED, 0.5).unwrap();
        let p = 0.2 * one.pressure_variance().sqrt();
        let count = 4000;
        let band: Vec<SineScale> = (0..count)
            .map(|k| SineScale {
                wavelength: wave.wavelength * (1.0 + 1e-9 * f64::from(k)),
                amplitude: wave.amplitude / f64::from(count).sqrt(),
            })
            .collect();
        let band = Persson::new(&band, &rubber, SPEED, 0.5).unwrap();
        // An oracle that knows no mean over a jump: W in the middle of each.
        let sum: f64 = band
            .jumps
            .iter()
            .map(|jump| jump.stress * band.weight(p, 0.5 * (jump.before + jump.after)))
            .sum();
        // Moduli over a band of 4e-6 vary by as much.
        approx::assert_relative_eq!(sum / p, one.friction_coefficient(p), max_relative = 1e-5);
    }

    #[test]
    fn an_elastic_body_and_a_flat_profile_have_no_friction() {
        let elastic = Persson::new(&ladder(), &Rubber::elastic(3e6, 0.5), SPEED, 0.5).unwrap();
        assert_eq!(elastic.friction_coefficient(1e5), 0.0);
        let flat = SineScale { wavelength: 1e-3, amplitude: 0.0 };
        let flat = Persson::new(&[flat], &rubber(), SPEED, 0.5).unwrap();
        assert_eq!((flat.friction_coefficient(1e5), flat.contact_area_fraction(1e5)), (0.0, 1.0));
    }

    proptest! {
        #[test]
        fn pressure_and_area_are_inverse(area in 1e-4..0.99) {
            let theory = Persson::new(&ladder(), &rubber(), SPEED, 0.5).unwrap();
            let p = theory.mean_pressure(area);
            // The library's inverse of erf has eleven digits.
            let off = (theory.contact_area_fraction(p) / area - 1.0).abs();
            prop_assert!(off < 1e-10, "{off:e}");
        }

        #[test]
        fn less_strain_in_partial_contact_is_less_friction(p in 1e3..1e8, gamma in 0.0..1.0) {
            let friction = |gamma| {
                Persson::new(&ladder(), &rubber(), SPEED, gamma).unwrap().friction_coefficient(p)
            };
            prop_assert!(friction(gamma) <= friction(1.0) * (1.0 + 1e-12));
        }
    }
}
