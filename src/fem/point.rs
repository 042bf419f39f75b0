//! The law at one integration point of a steady row.

use super::kinematics::{Tensor, strain_change};
use super::row::Inverted;
use crate::rubber::finite_strain::{
    FiniteStrainRubber, IDENTITY, Measure, Rheology, Spring, Symmetric, contract, dilatation,
    inverse, one_plus, sandwich,
};

/// Coefficients of the linearised law at a point: the change of the stress conjugate to the
/// measure m of the law by those of m and of the internal tensors,
///
/// ```text
/// shear       δT = μ G δm G - Σ_k μ_k G_k δm_k G_k
/// volumetric  δT = (c G:δm - Σ_k c_k G_k:δm_k) G - σ G δm G
/// ```
///
/// with `G = C⁻¹` and `G_k = C_k⁻¹` under neo-Hooke; under the linear law both are unit tensors and
/// σ vanishes.
#[derive(Debug, Clone, Default)]
pub(super) struct Point {
    pub deformation: Tensor,
    pub measure: Measure,
    /// T.
    pub conjugate: Symmetric,
    /// S.
    pub stress: Symmetric,
    /// G.
    pub inverse: Symmetric,
    /// μ or c.
    pub modulus: f64,
    /// σ.
    pub pressure: f64,
}

impl Point {
    /// Stress and linearised law of the shear part; turns internal strains into `G_k`.
    pub fn shear_law(
        &mut self,
        rubber: &FiniteStrainRubber,
        internal: &mut [Symmetric],
    ) -> Result<(), Inverted> {
        let springs = &rubber.branches;
        let strain = &self.measure.value();
        self.conjugate = rubber.shear_stress(&rubber.equilibrium, strain, &[0.0; 3]);
        for (spring, internal) in springs.iter().zip(internal) {
            let stress = rubber.shear_stress(spring, strain, internal);
            (0..3).for_each(|i| self.conjugate[i] += stress[i]);
            (*internal, _) = metric(rubber.rheology, internal)?;
        }
        self.stress = self.measure.derivative(&self.conjugate);
        (self.inverse, _) = metric(rubber.rheology, strain)?;
        self.modulus =
            rubber.equilibrium.shear + springs.iter().map(|spring| spring.shear).sum::<f64>();
        Ok(())
    }

    /// Stress and linearised law of the volumetric part; turns internal strains into `G_k`.
    pub fn volumetric_law(
        &mut self,
        rubber: &FiniteStrainRubber,
        internal: &mut [Symmetric],
        relaxed: &mut [f64],
    ) -> Result<(), Inverted> {
        let half = |spring: &Spring| 0.5 * spring.volumetric;
        let equilibrium = &rubber.equilibrium;
        let strain = &self.measure.value();
        let (inverse, volume) = metric(rubber.rheology, strain)?;
        self.inverse = inverse;
        self.conjugate = rubber.volumetric_stress(equilibrium, strain, &[0.0; 3]);
        self.modulus = half(equilibrium) * volume;
        self.pressure = half(equilibrium) * (volume - 1.0);
        for ((spring, internal), relaxed) in rubber.branches.iter().zip(internal).zip(relaxed) {
            let stress = rubber.volumetric_stress(spring, strain, internal);
            (0..3).for_each(|i| self.conjugate[i] += stress[i]);
            let (inverse, past) = metric(rubber.rheology, internal)?;
            *internal = inverse;
            *relaxed = half(spring) * volume / past;
            self.modulus += *relaxed;
            self.pressure += half(spring) * (volume / past - 1.0);
        }
        self.stress = self.measure.derivative(&self.conjugate);
        Ok(())
    }

    /// Takes over the deformation gradient and the strain `C - 1`.
    pub fn deform(
        &mut self,
        rheology: Rheology,
        deformation: Tensor,
        strain: &Symmetric,
    ) -> Result<(), Inverted> {
        self.deformation = deformation;
        self.measure = rheology.measure(strain).ok_or(Inverted)?;
        Ok(())
    }

    /// Change of the measure by that of the deformation gradient.
    #[inline]
    pub fn measure_change(&self, df: &Tensor) -> Symmetric {
        self.measure.derivative(&strain_change(&self.deformation, df))
    }

    /// Change of the second Piola-Kirchhoff stress by those of the conjugate stress and of the
    /// deformation gradient.
    #[inline]
    pub fn stress_change(&self, conjugate: &Symmetric, df: &Tensor) -> Symmetric {
        let strain = strain_change(&self.deformation, df);
        self.measure.stress_change(&self.conjugate, conjugate, &strain)
    }

    /// Change of the conjugate stress of the shear part.
    #[inline]
    pub fn shear_tangent(
        &self,
        rubber: &FiniteStrainRubber,
        strain: &Symmetric,
        internal: &[Symmetric],
        changed: &[Symmetric],
    ) -> Symmetric {
        let mut stress = sandwich(&self.inverse, strain).map(|s| self.modulus * s);
        for ((spring, g), change) in rubber.branches.iter().zip(internal).zip(changed) {
            let relaxed = sandwich(g, change);
            (0..3).for_each(|i| stress[i] -= spring.shear * relaxed[i]);
        }
        stress
    }

    /// Change of the conjugate stress of the volumetric part.
    #[inline]
    pub fn volumetric_tangent(
        &self,
        strain: &Symmetric,
        internal: &[Symmetric],
        relaxed: &[f64],
        changed: &[Symmetric],
    ) -> Symmetric {
        let mut pressure = self.modulus * contract(&self.inverse, strain);
        for ((c, g), change) in relaxed.iter().zip(internal).zip(changed) {
            pressure -= c * contract(g, change);
        }
        let turned = sandwich(&self.inverse, strain);
        [0, 1, 2].map(|i| pressure * self.inverse[i] - self.pressure * turned[i])
    }
}

/// `G` and the determinant of `1 + strain`, which must be positive definite; of the linear law,
/// unit tensor and 1.
fn metric(rheology: Rheology, strain: &Symmetric) -> Result<(Symmetric, f64), Inverted> {
    if rheology == Rheology::Linear {
        return Ok((IDENTITY, 1.0));
    }
    let volume = 1.0 + dilatation(strain);
    if volume > 0.0 && strain[0] > -1.0 {
        Ok((inverse(&one_plus(strain)), volume))
    } else {
        Err(Inverted)
    }
}
