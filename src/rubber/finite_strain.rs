//! Finite linear viscoelasticity in plane strain: an equilibrium spring and Maxwell branches under
//! large deformation.
//!
//! Every spring has the modulus of its branch and the Poisson ratio of the rubber,
//!
//! ```text
//! μ = E / (2 (1 + ν)),    Λ = E ν / ((1 + ν) (1 - 2 ν))
//! ```
//!
//! and one of two laws between the right Cauchy-Green tensor `C = Fᵀ F`, the internal tensor `C_i`
//! of a branch (`C_i = 1` for the equilibrium spring) and the second Piola-Kirchhoff stress `S`:
//!
//! ```text
//! neo-Hooke (thesis 2.2.15, 2.2.28)  S = μ (C_i⁻¹ - C⁻¹) + Λ/2 (det C / det C_i - 1) C⁻¹
//! linear    (thesis 4.4)             S = μ (C - C_i) + Λ/2 tr(C - C_i) 1
//! ```
//!
//! The flow rule is linear (thesis 2.2.24): `dC_i/dt = (C - C_i) / τ`. Without a branch the second
//! law is that of St. Venant and Kirchhoff. Both consist of a shear part (factor μ) and a
//! volumetric part (factor Λ), so that elements can integrate them at different points.

use super::{Rubber, RubberError};

/// A symmetric tensor in the plane: components xx, zz, xz.
pub type Symmetric = [f64; 3];

/// The unit tensor.
pub const IDENTITY: Symmetric = [1.0, 1.0, 0.0];

/// Determinant.
pub fn determinant(a: &Symmetric) -> f64 {
    a[0] * a[1] - a[2] * a[2]
}

/// Inverse; infinite or NaN for a singular tensor.
pub fn inverse(a: &Symmetric) -> Symmetric {
    let d = determinant(a);
    [a[1] / d, a[0] / d, -a[2] / d]
}

/// Double contraction `a : b`.
pub fn contract(a: &Symmetric, b: &Symmetric) -> f64 {
    a[0] * b[0] + a[1] * b[1] + 2.0 * a[2] * b[2]
}

/// The product `G X G` of two symmetric tensors, which is symmetric.
#[inline]
pub fn sandwich(g: &Symmetric, x: &Symmetric) -> Symmetric {
    // Rows of G X first.
    let (xx, xz) = (g[0] * x[0] + g[2] * x[2], g[0] * x[2] + g[2] * x[1]);
    let (zx, zz) = (g[2] * x[0] + g[1] * x[2], g[2] * x[2] + g[1] * x[1]);
    [xx * g[0] + xz * g[2], zx * g[2] + zz * g[1], xx * g[2] + xz * g[1]]
}

/// The law of a spring.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rheology {
    /// Compressible neo-Hooke on the elastic part of the deformation.
    #[default]
    NeoHookean,
    /// Linear viscoelastic stress in the Green-Lagrange strain.
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

    /// Energy in Pa of one spring at `C` with the internal tensor `C_i`; the stress is
    /// `S = 2 ∂ψ/∂C`.
    pub fn energy(&self, spring: &Spring, c: &Symmetric, internal: &Symmetric) -> f64 {
        match self.rheology {
            Rheology::NeoHookean => {
                let stretch = contract(&inverse(internal), c);
                let volume = determinant(c) / determinant(internal);
                0.5 * spring.shear * (stretch - 2.0 - volume.ln())
                    + 0.25 * spring.volumetric * (volume - 1.0 - volume.ln())
            }
            Rheology::Linear => {
                let e = [0, 1, 2].map(|i| 0.5 * (c[i] - internal[i]));
                spring.shear * contract(&e, &e)
                    + 0.5 * spring.volumetric * contract(&IDENTITY, &e).powi(2)
            }
        }
    }

    /// Shear part of the stress of one spring in Pa.
    pub fn shear_stress(&self, spring: &Spring, c: &Symmetric, internal: &Symmetric) -> Symmetric {
        let (from, to) = match self.rheology {
            Rheology::NeoHookean => (inverse(c), inverse(internal)),
            Rheology::Linear => (*internal, *c),
        };
        [0, 1, 2].map(|i| spring.shear * (to[i] - from[i]))
    }

    /// Volumetric part of the stress of one spring in Pa.
    pub fn volumetric_stress(
        &self,
        spring: &Spring,
        c: &Symmetric,
        internal: &Symmetric,
    ) -> Symmetric {
        let half = 0.5 * spring.volumetric;
        match self.rheology {
            Rheology::NeoHookean => {
                let pressure = half * (determinant(c) / determinant(internal) - 1.0);
                inverse(c).map(|g| pressure * g)
            }
            Rheology::Linear => {
                let trace = (c[0] - internal[0]) + (c[1] - internal[1]);
                IDENTITY.map(|unit| half * trace * unit)
            }
        }
    }

    /// Power in Pa/s that a branch turns into heat, `-∂ψ/∂C_i : dC_i/dt` with the flow rule:
    /// its shear part and its volumetric part.
    pub fn dissipation(&self, branch: &Spring, c: &Symmetric, internal: &Symmetric) -> (f64, f64) {
        let flow = [0, 1, 2].map(|i| (c[i] - internal[i]) / branch.relaxation_time);
        match self.rheology {
            Rheology::NeoHookean => {
                let g = inverse(internal);
                // -∂ψ/∂C_i = μ/2 (C_i⁻¹ C C_i⁻¹ - C_i⁻¹) + Λ/4 (det C/det C_i - 1) C_i⁻¹
                let pulled = sandwich(&g, c);
                let shear = [0, 1, 2].map(|i| 0.5 * branch.shear * (pulled[i] - g[i]));
                let volume = determinant(c) / determinant(internal) - 1.0;
                (contract(&shear, &flow), 0.25 * branch.volumetric * volume * contract(&g, &flow))
            }
            Rheology::Linear => {
                let e = [0, 1, 2].map(|i| 0.5 * (c[i] - internal[i]));
                let trace = contract(&IDENTITY, &e);
                (
                    branch.shear * contract(&e, &flow),
                    0.5 * branch.volumetric * trace * contract(&IDENTITY, &flow),
                )
            }
        }
    }
}

/// Nearer to incompressible the volumetric stiffness drowns the rest in round-off.
const MAX_POISSON_RATIO: f64 = 0.4999;
