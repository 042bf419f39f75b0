//! The law at one integration point of a steady row.

use super::row::{Inverted, Tensor};
use crate::rubber::finite_strain::{
    FiniteStrainRubber, IDENTITY, Rheology, Spring, Symmetric, contract, dilatation, inverse,
    sandwich,
};

/// Coefficients of the linearised law at a point,
///
/// ```text
/// shear       δS = μ G δC G - Σ_k μ_k G_k δC_k G_k
/// volumetric  δS = (c G:δC - Σ_k c_k G_k:δC_k) H - σ G δC G
/// ```
///
/// with `H = G` but for the linear law, where all of them are unit tensors and σ vanishes.
#[derive(Debug, Clone, Default)]
pub(super) struct Point {
    pub deformation: Tensor,
    pub stress: Symmetric,
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
        strain: &Symmetric,
        internal: &mut [Symmetric],
    ) -> Result<(), Inverted> {
        let springs = &rubber.branches;
        self.stress = rubber.shear_stress_of(&rubber.equilibrium, strain, &[0.0; 3]);
        for (spring, internal) in springs.iter().zip(internal) {
            let stress = rubber.shear_stress_of(spring, strain, internal);
            (0..3).for_each(|i| self.stress[i] += stress[i]);
            (*internal, _) = metric(rubber.rheology, internal)?;
        }
        (self.inverse, _) = metric(rubber.rheology, strain)?;
        self.modulus =
            rubber.equilibrium.shear + springs.iter().map(|spring| spring.shear).sum::<f64>();
        Ok(())
    }

    /// Stress and linearised law of the volumetric part; turns internal strains into `G_k`.
    pub fn volumetric_law(
        &mut self,
        rubber: &FiniteStrainRubber,
        strain: &Symmetric,
        internal: &mut [Symmetric],
        relaxed: &mut [f64],
    ) -> Result<(), Inverted> {
        let half = |spring: &Spring| 0.5 * spring.volumetric;
        let equilibrium = &rubber.equilibrium;
        let (inverse, volume) = metric(rubber.rheology, strain)?;
        self.inverse = inverse;
        self.stress = rubber.volumetric_stress_of(equilibrium, strain, &[0.0; 3]);
        self.modulus = half(equilibrium) * volume;
        self.pressure = half(equilibrium) * (volume - 1.0);
        for ((spring, internal), relaxed) in rubber.branches.iter().zip(internal).zip(relaxed) {
            let stress = rubber.volumetric_stress_of(spring, strain, internal);
            (0..3).for_each(|i| self.stress[i] += stress[i]);
            let (inverse, past) = metric(rubber.rheology, internal)?;
            *internal = inverse;
            *relaxed = half(spring) * volume / past;
            self.modulus += *relaxed;
            self.pressure += half(spring) * (volume / past - 1.0);
        }
        Ok(())
    }

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
        Ok((inverse(&[1.0 + strain[0], 1.0 + strain[1], strain[2]]), volume))
    } else {
        Err(Inverted)
    }
}
