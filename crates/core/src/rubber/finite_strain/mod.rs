//! Finite linear viscoelasticity in plane strain: an equilibrium spring and Maxwell branches under
//! large deformation.
//!
//! Every spring has the modulus of its branch and the Poisson ratio of the rubber,
//!
//! ```text
//! μ = E / (2 (1 + ν)),    Λ = E ν / ((1 + ν) (1 - 2 ν))
//! ```
//!
//! and one of the laws of [`Rheology`]. Each is written in a measure `m` of strain, a function of the right
//! Cauchy-Green tensor `C = Fᵀ F`; the internal tensor `m_i` of a branch (zero for the equilibrium
//! spring) follows it by a linear flow rule, `dm_i/dt = (m - m_i) / τ`; and the stress `T = 2 ∂ψ/∂m`
//! conjugate to it gives the second Piola-Kirchhoff stress `S = T : dm/dC`.
//!
//! ```text
//! neo-Hooke           m = C - 1   T = μ (C_i⁻¹ - C⁻¹) + Λ/2 (det C / det C_i - 1) C⁻¹,  C_i = 1 + m_i
//! Yeoh, Arruda-Boyce  m = C - 1   T = μ Φ' (C_i⁻¹ - C⁻¹) + Λ/2 (det C / det C_i - 1) C⁻¹
//! linear              m = ln C    T = μ (m - m_i) + Λ/2 tr(m - m_i) 1
//! ```
//!
//! The first is that of the thesis (2.2.15, 2.2.24, 2.2.28). The second and the third stiffen with the first invariant of
//! the elastic part of the deformation (`invariant`). The last is linear viscoelasticity
//! in the logarithmic strain `E = ½ ln C` of Hencky. All consist of a shear part (factor μ) and a volumetric
//! part (factor Λ), so that elements can integrate them at different points.
//!
//! | module | what it holds |
//! |---|---|
//! | `law` | what a law states: energy, stress, tangent, driving force |
//! | `rheology` | the choice of a law, with its constants |
//! | `neo_hookean`, `invariant`, `hencky` | the laws: neo-Hooke; Yeoh and Arruda-Boyce; the linear one |
//! | `checks` | the tests that every law passes |
//! | `measure` | the strain measure of a law and its derivatives by `C` |
//! | `logarithm` | `ln C` in closed form |
//! | `symmetric` | symmetric tensors in the plane |

#[cfg(test)]
mod checks;
mod hencky;
mod invariant;
mod law;
mod logarithm;
mod measure;
mod neo_hookean;
mod rheology;
mod symmetric;

pub use invariant::Stiffening;
pub use law::Hardening;
pub use logarithm::Logarithm;
pub use measure::Measure;
pub use rheology::{BadConstant, Rheology};
pub use symmetric::{
    IDENTITY, Scalar, Symmetric, contract, determinant, difference, dilatation,
    dilatation_difference, inverse, one_plus, sandwich,
};

use super::{Rubber, RubberError};
use hencky::Hencky;
use law::Law;
use neo_hookean::NeoHookean;

/// Derivative of a conjugate stress by its strain, `dT_i / dm_j` in Pa; the component xz of the strain stands for xz and
/// zx together.
pub type Tangent = [[f64; 3]; 3];

/// Unit changes of the three components of a strain.
pub(crate) const UNITS: [Symmetric; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Calls a function of the law of a rubber.
macro_rules! of_law {
    ($rubber:expr, $function:ident($($argument:expr),*)) => {
        match $rubber.rheology {
            Rheology::NeoHookean => NeoHookean.$function($($argument),*),
            Rheology::Linear => Hencky.$function($($argument),*),
            Rheology::Yeoh { .. } | Rheology::ArrudaBoyce { .. } => {
                Law::$function(&$rubber.stiffening, $($argument),*)
            }
        }
    };
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
    /// How their shear parts stiffen under it.
    pub stiffening: Stiffening,
    /// The spring that never relaxes.
    pub equilibrium: Spring,
    /// The springs of the Maxwell branches.
    pub branches: Vec<Spring>,
}

impl FiniteStrainRubber {
    /// The rubber of linear viscoelasticity under a law for large strains.
    ///
    /// # Errors
    /// Those of [`Rubber::validate`], [`RubberError::NotCompressible`] for a `ν` next to 0.5, where `Λ`
    /// is infinite, and [`RubberError::Law`] for a constant of the law that is none.
    pub fn new(rubber: &Rubber, rheology: Rheology) -> Result<Self, RubberError> {
        rubber.validate()?;
        rubber.check_law(rheology)?;
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
            stiffening: rheology.stiffening(),
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
        of_law!(self, energy(spring, strain, internal))
    }

    /// Shear part of the conjugate stress in Pa of one spring at the strain `m` with the internal tensor `m_i`; as accurate
    /// as their difference `lag = m - m_i`, which may be known better than by subtraction.
    #[inline]
    pub fn shear_stress(&self, spring: &Spring, tensors: [&Symmetric; 3]) -> Symmetric {
        of_law!(self, shear_stress(spring, tensors))
    }

    /// Volumetric part of the conjugate stress of one spring in Pa, as accurate.
    #[inline]
    pub fn volumetric_stress(&self, spring: &Spring, tensors: [&Symmetric; 3]) -> Symmetric {
        of_law!(self, volumetric_stress(spring, tensors))
    }

    /// Derivative of [`Self::shear_stress`] by the strain `m` if the internal tensor changes by a `fraction` of its change;
    /// `None` where the law takes the inverse of an internal tensor that is not positive.
    pub fn shear_tangent(
        &self,
        spring: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
        fraction: f64,
    ) -> Option<Tangent> {
        of_law!(self, shear_tangent(spring, strain, internal, fraction))
    }

    /// As [`Self::shear_tangent`], of [`Self::volumetric_stress`].
    pub fn volumetric_tangent(
        &self,
        spring: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
        fraction: f64,
    ) -> Option<Tangent> {
        of_law!(self, volumetric_tangent(spring, strain, internal, fraction))
    }

    /// What the stiffening of the law adds to the tangent of a spring, from `m`, `m_i` and `m - m_i`.
    #[inline]
    pub(crate) fn hardening(&self, tensors: [&Symmetric; 3]) -> Hardening {
        of_law!(self, hardening(tensors))
    }

    /// `I1 - 3 - 2 ln J` of the elastic part of the deformation of a spring, from `m`, `m_i` and `m - m_i`; `None` under
    /// the linear law. The law holds up to [`Rheology::limit`].
    pub fn invariant(&self, tensors: [&Symmetric; 3]) -> Option<f64> {
        match self.rheology {
            Rheology::Linear => Hencky::invariant(tensors),
            _ => NeoHookean::invariant(tensors),
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
        of_law!(self, driving_force(branch, strain, internal))
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
