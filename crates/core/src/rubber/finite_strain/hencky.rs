//! Kirchhoff stress linear in the logarithmic strain of Hencky (Miehe, Apel, Lambrecht 2002,
//! doi:10.1016/S0045-7825(02)00438-3).
//!
//! ```text
//! m = ln C,   e = (m - m_i) / 2
//! ψ = μ e : e + Λ/2 (tr e)²
//! T = 2 μ e + Λ tr(e) 1
//! ```

use super::law::Law;
use super::logarithm::Logarithm;
use super::measure::Measure;
use super::symmetric::{IDENTITY, Symmetric, contract, difference};
use super::{Spring, Tangent};

pub(super) struct Hencky;

impl Law for Hencky {
    const IN_GREEN_STRAIN: bool = false;

    #[inline]
    fn measure(strain: &Symmetric) -> Option<Measure> {
        Logarithm::new(strain).map(Measure::Logarithmic)
    }

    fn energy(&self, spring: &Spring, strain: &Symmetric, internal: &Symmetric) -> f64 {
        let e = [0, 1, 2].map(|i| 0.5 * (strain[i] - internal[i]));
        spring.shear * contract(&e, &e) + 0.5 * spring.volumetric * contract(&IDENTITY, &e).powi(2)
    }

    #[inline]
    fn shear_stress(&self, spring: &Spring, [_, _, lag]: [&Symmetric; 3]) -> Symmetric {
        lag.map(|lag| spring.shear * lag)
    }

    #[inline]
    fn volumetric_stress(&self, spring: &Spring, [_, _, lag]: [&Symmetric; 3]) -> Symmetric {
        let half = 0.5 * spring.volumetric;
        IDENTITY.map(|unit| half * (lag[0] + lag[1]) * unit)
    }

    fn shear_tangent(
        &self,
        spring: &Spring,
        _: &Symmetric,
        _: &Symmetric,
        fraction: f64,
    ) -> Option<Tangent> {
        let stiffness = spring.shear * (1.0 - fraction);
        Some([[stiffness, 0.0, 0.0], [0.0, stiffness, 0.0], [0.0, 0.0, stiffness]])
    }

    fn volumetric_tangent(
        &self,
        spring: &Spring,
        _: &Symmetric,
        _: &Symmetric,
        fraction: f64,
    ) -> Option<Tangent> {
        let stiffness = 0.5 * spring.volumetric * (1.0 - fraction);
        Some([[stiffness, stiffness, 0.0], [stiffness, stiffness, 0.0], [0.0; 3]])
    }

    /// The unit tensor and 1: the law is linear.
    #[inline]
    fn metric(_: &Symmetric) -> Option<(Symmetric, f64)> {
        Some((IDENTITY, 1.0))
    }

    #[inline]
    fn volume(_: &Symmetric) -> f64 {
        1.0
    }

    fn invariant(_: [&Symmetric; 3]) -> Option<f64> {
        None
    }

    /// Half the stress, since ψ depends on `m - m_i` alone and `T = 2 ∂ψ/∂m`.
    fn driving_force(
        &self,
        branch: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
    ) -> [Symmetric; 2] {
        let tensors = [strain, internal, &difference(strain, internal)];
        [self.shear_stress(branch, tensors), self.volumetric_stress(branch, tensors)]
            .map(|stress| stress.map(|t| 0.5 * t))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FiniteStrainRubber, Rheology};
    use super::*;
    use crate::rubber::Rubber;
    use approx::assert_relative_eq;

    #[test]
    fn the_kirchhoff_stress_is_linear_in_the_true_strain() {
        let rubber = FiniteStrainRubber::new(&Rubber::table_2_1(), Rheology::Linear).unwrap();
        let spring = rubber.equilibrium;
        let stretches: [f64; 2] = [0.3, 2.1];
        let measure =
            Hencky::measure(&[stretches[0].powi(2) - 1.0, stretches[1].powi(2) - 1.0, 0.0])
                .unwrap();
        let strain = measure.value();
        let tensors = [&strain, &[0.0; 3], &strain];
        let shear = measure.derivative(&Hencky.shear_stress(&spring, tensors));
        let volumetric = measure.derivative(&Hencky.volumetric_stress(&spring, tensors));
        let volume = (stretches[0] * stretches[1]).ln();
        for (i, stretch) in stretches.iter().enumerate() {
            let kirchhoff = stretch * stretch * (shear[i] + volumetric[i]);
            let linear = 2.0 * spring.shear * stretch.ln() + spring.volumetric * volume;
            assert_relative_eq!(kirchhoff, linear, max_relative = 1e-12);
        }
        assert_eq!((shear[2], volumetric[2]), (0.0, 0.0));
    }
}
