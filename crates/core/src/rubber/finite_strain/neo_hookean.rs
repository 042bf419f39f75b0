//! Compressible neo-Hooke on the elastic part of the deformation (thesis 2.2.15, 2.2.24, 2.2.28).
//!
//! ```text
//! m = C - 1,   C_i = 1 + m_i,   V = det C / det C_i
//! ψ = μ/2 (C : C_i⁻¹ - 2 - ln V) + Λ/4 (V - 1 - ln V)
//! T = μ (C_i⁻¹ - C⁻¹) + Λ/2 (V - 1) C⁻¹
//! ```
//!
//! **Heat.** With `X = C_i⁻¹ C` the power `-∂ψ/∂m_i : dm_i/dt` is `(μ/2 tr (X - 1)² + Λ/4 (V - 1) (tr X - 2)) / τ`. Its
//! shear part is never negative. Its volumetric part is where the spring is compressed and sheared at once, `V < 1` and
//! `tr X > 2`: of second order in both, and so below the shear part for all but large strains.

use super::invariant::invariant;
use super::law::Law;
use super::measure::Measure;
use super::symmetric::{
    Symmetric, contract, determinant, dilatation, dilatation_difference, inverse, one_plus,
    sandwich,
};
use super::{Spring, Tangent, UNITS};

pub(super) struct NeoHookean;

impl Law for NeoHookean {
    const IN_GREEN_STRAIN: bool = true;

    #[inline]
    fn measure(strain: &Symmetric) -> Option<Measure> {
        Some(Measure::Green(*strain))
    }

    fn energy(&self, spring: &Spring, strain: &Symmetric, internal: &Symmetric) -> f64 {
        let (c, past) = (one_plus(strain), one_plus(internal));
        let stretch = contract(&inverse(&past), &c);
        let volume = determinant(&c) / determinant(&past);
        0.5 * spring.shear * (stretch - 2.0 - volume.ln())
            + 0.25 * spring.volumetric * (volume - 1.0 - volume.ln())
    }

    #[inline]
    fn shear_stress(&self, spring: &Spring, [strain, internal, lag]: [&Symmetric; 3]) -> Symmetric {
        // C_i⁻¹ - C⁻¹ = adj C_i (det C - det C_i) / (det C det C_i)
        //               + (adj C_i - adj C) / det C
        let (volume, past) = (1.0 + dilatation(strain), 1.0 + dilatation(internal));
        let change = dilatation_difference(strain, internal, lag) / (volume * past);
        let adjugate = [1.0 + internal[1], 1.0 + internal[0], -internal[2]];
        let less = [-lag[1], -lag[0], lag[2]];
        [0, 1, 2].map(|i| spring.shear * (adjugate[i] * change + less[i] / volume))
    }

    #[inline]
    fn volumetric_stress(
        &self,
        spring: &Spring,
        [strain, internal, lag]: [&Symmetric; 3],
    ) -> Symmetric {
        let half = 0.5 * spring.volumetric;
        let past = 1.0 + dilatation(internal);
        let pressure = half * dilatation_difference(strain, internal, lag) / past;
        let volume = 1.0 + dilatation(strain);
        let adjugate = [1.0 + strain[1], 1.0 + strain[0], -strain[2]];
        adjugate.map(|g| pressure * g / volume)
    }

    /// `δT = μ (C⁻¹ δC C⁻¹ - C_i⁻¹ δC_i C_i⁻¹)`.
    fn shear_tangent(
        &self,
        spring: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
        fraction: f64,
    ) -> Option<Tangent> {
        let g = inverse(&one_plus(strain));
        let g_i = inverse(&positive(internal)?);
        let mut tangent = [[0.0; 3]; 3];
        for (j, unit) in UNITS.iter().enumerate() {
            let whole = sandwich(&g, unit);
            let internal = sandwich(&g_i, unit);
            for i in 0..3 {
                tangent[i][j] = spring.shear * (whole[i] - fraction * internal[i]);
            }
        }
        Some(tangent)
    }

    /// `δT = Λ/2 (V (C⁻¹ : δC - C_i⁻¹ : δC_i) C⁻¹ - (V - 1) C⁻¹ δC C⁻¹)`.
    fn volumetric_tangent(
        &self,
        spring: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
        fraction: f64,
    ) -> Option<Tangent> {
        let (c, c_i) = (one_plus(strain), positive(internal)?);
        let (g, g_i) = (inverse(&c), inverse(&c_i));
        let volume = determinant(&c) / determinant(&c_i);
        let mut tangent = [[0.0; 3]; 3];
        for (j, unit) in UNITS.iter().enumerate() {
            let growth = contract(&g, unit) - fraction * contract(&g_i, unit);
            let congruent = sandwich(&g, unit);
            for i in 0..3 {
                tangent[i][j] = 0.5
                    * spring.volumetric
                    * (volume * growth * g[i] - (volume - 1.0) * congruent[i]);
            }
        }
        Some(tangent)
    }

    /// `C⁻¹` and `det C`.
    #[inline]
    fn metric(measure: &Symmetric) -> Option<(Symmetric, f64)> {
        let volume = Self::volume(measure);
        if volume > 0.0 && measure[0] > -1.0 {
            Some((inverse(&one_plus(measure)), volume))
        } else {
            None
        }
    }

    #[inline]
    fn volume(measure: &Symmetric) -> f64 {
        1.0 + dilatation(measure)
    }

    fn invariant(tensors: [&Symmetric; 3]) -> Option<f64> {
        Some(invariant(tensors))
    }

    /// `μ/2 (C_i⁻¹ C C_i⁻¹ - C_i⁻¹)` and `Λ/4 (V - 1) C_i⁻¹`.
    fn driving_force(
        &self,
        branch: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
    ) -> [Symmetric; 2] {
        let (c, past) = (one_plus(strain), one_plus(internal));
        let g = inverse(&past);
        let pulled = sandwich(&g, &c);
        let volume = determinant(&c) / determinant(&past) - 1.0;
        [
            [0, 1, 2].map(|i| 0.5 * branch.shear * (pulled[i] - g[i])),
            g.map(|g| 0.25 * branch.volumetric * volume * g),
        ]
    }
}

/// `1 + m`, if it is positive definite.
fn positive(measure: &Symmetric) -> Option<Symmetric> {
    let c = one_plus(measure);
    (determinant(&c) > 0.0 && c[0] > 0.0).then_some(c)
}

#[cfg(test)]
mod tests {
    use super::super::{FiniteStrainRubber, Rheology};
    use super::*;
    use crate::rubber::Rubber;
    use approx::assert_relative_eq;

    #[test]
    fn simple_shear_needs_a_shear_stress_in_proportion() {
        let rubber = FiniteStrainRubber::new(&Rubber::table_2_1(), Rheology::NeoHookean).unwrap();
        let spring = rubber.equilibrium;
        for gamma in [1e-3, 0.3, 2.0] {
            // F = [[1, γ], [0, 1]], and σ = F S Fᵀ has the shear component S_xz + γ S_zz.
            let strain = [0.0, gamma * gamma, gamma];
            let stress = NeoHookean.shear_stress(&spring, [&strain, &[0.0; 3], &strain]);
            let shear = stress[2] + gamma * stress[1];
            assert_relative_eq!(shear, spring.shear * gamma, max_relative = 1e-12);
            let volumetric = NeoHookean.volumetric_stress(&spring, [&strain, &[0.0; 3], &strain]);
            assert!(volumetric.iter().all(|t| t.abs() < 1e-12 * spring.volumetric));
        }
    }

    #[test]
    fn compression_with_much_shear_takes_heat_up_by_the_volumetric_part_alone() {
        let rubber = FiniteStrainRubber::new(&Rubber::table_2_1(), Rheology::NeoHookean).unwrap();
        let heat = |strain: Symmetric| rubber.dissipation(&rubber.branches[2], &strain, &[0.0; 3]);
        let [shear, volumetric] = heat([1.0, -0.6, 0.0]);
        assert!(shear > 0.0 && volumetric < 0.0, "{shear} {volumetric}");
        let [shear, volumetric] = heat([0.1, -0.092, 0.0]);
        assert!(volumetric < 0.0 && shear + volumetric > 0.0, "{shear} {volumetric}");
    }
}
