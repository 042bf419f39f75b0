//! What a law of a spring has to state.

use super::measure::Measure;
use super::symmetric::Symmetric;
use super::{Spring, Tangent};

/// A law of a spring in a strain measure `m(C)`, with the internal tensor `m_i` of its branch, zero for the equilibrium
/// spring: energy, conjugate stress `T = 2 ∂ψ/∂m`, tangent and driving force, the last three with a shear part (factor
/// μ) and a volumetric part (factor Λ).
///
/// Stresses are computed from the *lag* `m - m_i` as well: where a branch relaxes fast, the difference of two strains of
/// order one would be round-off times the glassy modulus.
///
/// What depends on the measure alone is told apart by the type of a law, what depends on its constants by the law itself;
/// [`super::Rheology`] chooses one at run time. A new law is a file with an implementation, a variant of `Rheology`, and
/// one line in `checks.rs`.
pub(super) trait Law {
    /// Whether `m` is `C - 1` itself, so that `T` is the second Piola-Kirchhoff stress.
    const IN_GREEN_STRAIN: bool;

    /// `m` at the strain `C - 1`; `None` if `C` is not positive definite and the law needs that.
    fn measure(strain: &Symmetric) -> Option<Measure>;

    /// Energy ψ in Pa of one spring.
    fn energy(&self, spring: &Spring, strain: &Symmetric, internal: &Symmetric) -> f64;

    /// Shear part of `T` in Pa from `m`, `m_i` and `m - m_i`.
    fn shear_stress(&self, spring: &Spring, tensors: [&Symmetric; 3]) -> Symmetric;

    /// Volumetric part of `T` in Pa from `m`, `m_i` and `m - m_i`.
    fn volumetric_stress(&self, spring: &Spring, tensors: [&Symmetric; 3]) -> Symmetric;

    /// Derivative of the shear part of `T` by `m` in Pa if `δm_i = fraction δm`; `None` if `m_i` is not the measure of a
    /// deformation.
    fn shear_tangent(
        &self,
        spring: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
        fraction: f64,
    ) -> Option<Tangent>;

    /// As [`Self::shear_tangent`], of the volumetric part.
    fn volumetric_tangent(
        &self,
        spring: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
        fraction: f64,
    ) -> Option<Tangent>;

    /// `G(m)` and `V(m)` of the same tangent as products of tensors,
    ///
    /// ```text
    /// shear       δT = μ Φ' (G δm G - G_i δm_i G_i) + μ Φ'' K (K : δm - M : δm_i)
    /// volumetric  δT = Λ/2 (V/V_i (G : δm - G_i : δm_i) G - (V/V_i - 1) G δm G)
    /// ```
    ///
    /// with the [`Hardening`] of the law. `None` if `m` is not the measure of a deformation.
    fn metric(measure: &Symmetric) -> Option<(Symmetric, f64)>;

    /// `V(m)` alone.
    fn volume(measure: &Symmetric) -> f64;

    /// What the stiffening of the law adds to the tangent, from `m`, `m_i` and `m - m_i`.
    #[inline]
    fn hardening(&self, _tensors: [&Symmetric; 3]) -> Hardening {
        Hardening::NONE
    }

    /// `I1 - 3 - 2 ln J` of the elastic part of the deformation from `m`, `m_i` and `m - m_i`; `None` for a law that has
    /// no such invariant in its measure.
    fn invariant(tensors: [&Symmetric; 3]) -> Option<f64>;

    /// The force `-∂ψ/∂m_i` in Pa that drives the flow of a branch: shear part and volumetric part.
    fn driving_force(
        &self,
        branch: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
    ) -> [Symmetric; 2];
}

/// How the shear part of a spring stiffens at one state: `μ Φ'' K (K : δm - M : δm_i)` in the tangent, besides the
/// modulus `μ Φ'`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hardening {
    /// Φ'.
    pub slope: f64,
    /// Φ''.
    pub curvature: f64,
    /// `K`, the change of the invariant by the measure.
    pub by_strain: Symmetric,
    /// `M`, less the change of the invariant by the internal tensor.
    pub by_internal: Symmetric,
}

impl Hardening {
    /// Of a law whose shear modulus is constant.
    pub const NONE: Self =
        Self { slope: 1.0, curvature: 0.0, by_strain: [0.0; 3], by_internal: [0.0; 3] };
}
