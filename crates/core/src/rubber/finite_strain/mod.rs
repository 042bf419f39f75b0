//! Finite linear viscoelasticity in plane strain: an equilibrium spring and Maxwell branches under
//! large deformation.
//!
//! Every spring has the modulus of its branch and the Poisson ratio of the rubber,
//!
//! ```text
//! μ = E / (2 (1 + ν)),    Λ = E ν / ((1 + ν) (1 - 2 ν))
//! ```
//!
//! and one of two laws. Each is written in a measure `m` of strain, a function of the right
//! Cauchy-Green tensor `C = Fᵀ F`; the internal tensor `m_i` of a branch (zero for the equilibrium
//! spring) follows it by a linear flow rule, `dm_i/dt = (m - m_i) / τ`; and the stress `T = 2 ∂ψ/∂m`
//! conjugate to it gives the second Piola-Kirchhoff stress `S = T : dm/dC`.
//!
//! ```text
//! neo-Hooke  m = C - 1   T = μ (C_i⁻¹ - C⁻¹) + Λ/2 (det C / det C_i - 1) C⁻¹,  C_i = 1 + m_i
//! linear     m = ln C    T = μ (m - m_i) + Λ/2 tr(m - m_i) 1
//! ```
//!
//! The first is that of the thesis (2.2.15, 2.2.24, 2.2.28). The second is linear viscoelasticity
//! in the logarithmic strain `E = ½ ln C` of Hencky, `T = 2 μ e + Λ tr(e) 1` with `e = E - E_i`
//! (Miehe, Apel, Lambrecht 2002, doi:10.1016/S0045-7825(02)00438-3): Kirchhoff stress linear in
//! the true strain. Both consist of a shear part (factor μ) and a volumetric part (factor Λ), so
//! that elements can integrate them at different points.

mod logarithm;
mod measure;
mod symmetric;
#[cfg(test)]
mod tests;

pub use logarithm::Logarithm;
pub use measure::Measure;
pub use symmetric::{
    IDENTITY, Scalar, Symmetric, contract, determinant, difference, dilatation,
    dilatation_difference, inverse, one_plus, sandwich,
};

use super::{Rubber, RubberError};

/// The law of a spring.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rheology {
    /// Compressible neo-Hooke on the elastic part of the deformation.
    #[default]
    NeoHookean,
    /// Linear viscoelastic Kirchhoff stress in the logarithmic strain.
    Linear,
}

/// A spring with its relaxation time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Shear modulus μ in Pa.
    pub shear: f64,
    /// First Lamé constant Λ in Pa.
    pub volumetric: f64,
    /// Relaxation time τ in s; infinite for the equilibrium spring.
    pub relaxation_time: f64,
}

/// Rubber under large plane strain.
#[derive(Debug, Clone, PartialEq)]
pub struct FiniteStrainRubber {
    /// The law of all springs.
    pub rheology: Rheology,
    /// The spring that never relaxes.
    pub equilibrium: Spring,
    /// The springs of the Maxwell branches.
    pub branches: Vec<Spring>,
}

impl FiniteStrainRubber {
    /// The rubber of linear viscoelasticity under a law for large strains.
    ///
    /// # Errors
    /// Those of [`Rubber::validate`], and [`RubberError::PoissonRatio`] for `ν = 0.5`, whose `Λ`
    /// is infinite.
    pub fn new(rubber: &Rubber, rheology: Rheology) -> Result<Self, RubberError> {
        rubber.validate()?;
        let nu = rubber.poisson_ratio;
        if nu > MAX_POISSON_RATIO {
            return Err(RubberError::NotCompressible {
                rubber: rubber.name.clone(),
                value: nu,
                limit: MAX_POISSON_RATIO,
            });
        }
        let spring = |modulus: f64, relaxation_time: f64| Spring {
            shear: modulus / (2.0 * (1.0 + nu)),
            volumetric: modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            relaxation_time,
        };
        Ok(Self {
            rheology,
            equilibrium: spring(rubber.equilibrium_modulus, f64::INFINITY),
            branches: rubber
                .branches
                .iter()
                .map(|branch| spring(branch.modulus, branch.relaxation_time))
                .collect(),
        })
    }

    /// The rubber in a contact that lasts for a `time` in s and returns after a `period` in s, as the steady field
    /// sees it whose rows repeat after that period.
    ///
    /// Of a strain that is the same along a row a branch still carries the share `e^{-time/τ}` at the end of the contact,
    /// where a steady field has it relaxed for ever; what varies along the row relaxes as before. Such shares of the moduli
    /// are added to the equilibrium spring, and taken back from what varies by one more branch, of
    /// negative modulus, that relaxes far more slowly than a row passes.
    #[must_use]
    pub fn in_a_contact_that_lasts(mut self, time: f64, period: f64) -> Self {
        let held = |value: fn(&Spring) -> f64| -> f64 {
            let share = |branch: &Spring| value(branch) * (-time / branch.relaxation_time).exp();
            self.branches.iter().map(share).sum()
        };
        let (shear, volumetric) = (held(|spring| spring.shear), held(|spring| spring.volumetric));
        self.equilibrium.shear += shear;
        self.equilibrium.volumetric += volumetric;
        let relaxation_time = PERIODS_OF_THE_MEAN * period;
        self.branches.push(Spring { shear: -shear, volumetric: -volumetric, relaxation_time });
        self
    }

    /// Energy in Pa of one spring at the strain `m` with the internal tensor `m_i`, both in the
    /// measure of the law; the conjugate stress is `T = 2 ∂ψ/∂m`.
    pub fn energy(&self, spring: &Spring, strain: &Symmetric, internal: &Symmetric) -> f64 {
        match self.rheology {
            Rheology::NeoHookean => {
                let (c, past) = (one_plus(strain), one_plus(internal));
                let stretch = contract(&inverse(&past), &c);
                let volume = determinant(&c) / determinant(&past);
                0.5 * spring.shear * (stretch - 2.0 - volume.ln())
                    + 0.25 * spring.volumetric * (volume - 1.0 - volume.ln())
            }
            Rheology::Linear => {
                let e = [0, 1, 2].map(|i| 0.5 * (strain[i] - internal[i]));
                spring.shear * contract(&e, &e)
                    + 0.5 * spring.volumetric * contract(&IDENTITY, &e).powi(2)
            }
        }
    }

    /// Shear part of the conjugate stress in Pa of one spring at the strain `m` with the internal tensor `m_i`; as accurate
    /// as their difference `lag = m - m_i`, which may be known better than by subtraction.
    pub fn shear_stress(
        &self,
        spring: &Spring,
        [strain, internal, lag]: [&Symmetric; 3],
    ) -> Symmetric {
        match self.rheology {
            Rheology::NeoHookean => {
                // C_i⁻¹ - C⁻¹ = adj C_i (det C - det C_i) / (det C det C_i)
                //               + (adj C_i - adj C) / det C
                let (volume, past) = (1.0 + dilatation(strain), 1.0 + dilatation(internal));
                let change = dilatation_difference(strain, internal, lag) / (volume * past);
                let adjugate = [1.0 + internal[1], 1.0 + internal[0], -internal[2]];
                let less = [-lag[1], -lag[0], lag[2]];
                [0, 1, 2].map(|i| spring.shear * (adjugate[i] * change + less[i] / volume))
            }
            Rheology::Linear => lag.map(|lag| spring.shear * lag),
        }
    }

    /// Volumetric part of the conjugate stress of one spring in Pa, as accurate.
    pub fn volumetric_stress(
        &self,
        spring: &Spring,
        [strain, internal, lag]: [&Symmetric; 3],
    ) -> Symmetric {
        let half = 0.5 * spring.volumetric;
        match self.rheology {
            Rheology::NeoHookean => {
                let past = 1.0 + dilatation(internal);
                let pressure = half * dilatation_difference(strain, internal, lag) / past;
                let volume = 1.0 + dilatation(strain);
                let adjugate = [1.0 + strain[1], 1.0 + strain[0], -strain[2]];
                adjugate.map(|g| pressure * g / volume)
            }
            Rheology::Linear => IDENTITY.map(|unit| half * (lag[0] + lag[1]) * unit),
        }
    }

    /// The force `-∂ψ/∂m_i` in Pa that drives the flow of a branch: its shear part and its
    /// volumetric part.
    pub fn driving_force(
        &self,
        branch: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
    ) -> [Symmetric; 2] {
        match self.rheology {
            Rheology::NeoHookean => {
                // μ/2 (C_i⁻¹ C C_i⁻¹ - C_i⁻¹) + Λ/4 (det C / det C_i - 1) C_i⁻¹
                let (c, past) = (one_plus(strain), one_plus(internal));
                let g = inverse(&past);
                let pulled = sandwich(&g, &c);
                let volume = determinant(&c) / determinant(&past) - 1.0;
                [
                    [0, 1, 2].map(|i| 0.5 * branch.shear * (pulled[i] - g[i])),
                    g.map(|g| 0.25 * branch.volumetric * volume * g),
                ]
            }
            // The energy knows m - m_i alone, and T = 2 ∂ψ/∂m.
            Rheology::Linear => {
                let tensors = [strain, internal, &difference(strain, internal)];
                [self.shear_stress(branch, tensors), self.volumetric_stress(branch, tensors)]
                    .map(|stress| stress.map(|t| 0.5 * t))
            }
        }
    }

    /// Power in Pa/s that a branch turns into heat, `-∂ψ/∂m_i : dm_i/dt` with the flow rule:
    /// its shear part and its volumetric part.
    pub fn dissipation(
        &self,
        branch: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
    ) -> [f64; 2] {
        let flow = difference(strain, internal).map(|lag| lag / branch.relaxation_time);
        self.driving_force(branch, strain, internal).map(|force| contract(&force, &flow))
    }
}

/// Periods in which the mean of a row relaxes, where it is to be told from what varies along it: the shortest
/// variation, of one period, leaks into it by `1 / (2 π)` of the reciprocal.
const PERIODS_OF_THE_MEAN: f64 = 1e3;
/// Nearer to incompressible the volumetric stiffness drowns the rest in round-off.
const MAX_POISSON_RATIO: f64 = 0.4999;
