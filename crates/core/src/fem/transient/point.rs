//! The law at one integration point over one step.

use crate::rubber::finite_strain::{
    FiniteStrainRubber, Measure, Symmetric, Tangent, UNITS, difference,
};

/// The part of the stress that a point contributes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Factor μ.
    Shear,
    /// Factor Λ.
    Volumetric,
}

/// Stress and its derivative by the strain at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Second Piola-Kirchhoff stress S in Pa.
    pub stress: Symmetric,
    /// `moduli[i][j] = dS_i / dC_j` in Pa; the component xz of `C` stands for xz and zx together.
    pub moduli: Tangent,
}

impl Response {
    const ZERO: Self = Self { stress: [0.0; 3], moduli: [[0.0; 3]; 3] };

    /// The response at the strain `m` in the measure of the law if the internal tensor of branch
    /// k is `history[k] + fractions[k] m`; `None` if the law needs the inverse of an internal tensor that is not positive.
    pub fn at(
        rubber: &FiniteStrainRubber,
        part: Part,
        measure: &Measure,
        history: &[Symmetric],
        fractions: &[f64],
    ) -> Option<Self> {
        let mut response = Self::ZERO;
        let strain = &measure.value();
        let relaxed = [[0.0; 3]];
        let springs = std::iter::once(&rubber.equilibrium).chain(&rubber.branches);
        let histories = relaxed.iter().zip(&[0.0]).chain(history.iter().zip(fractions));
        for (spring, (history, fraction)) in springs.zip(histories) {
            let internal = [0, 1, 2].map(|i| history[i] + fraction * strain[i]);
            let tensors = [strain, &internal, &difference(strain, &internal)];
            let (stress, tangent) = match part {
                Part::Shear => (
                    rubber.shear_stress(spring, tensors),
                    rubber.shear_tangent(spring, strain, &internal, *fraction)?,
                ),
                Part::Volumetric => (
                    rubber.volumetric_stress(spring, tensors),
                    rubber.volumetric_tangent(spring, strain, &internal, *fraction)?,
                ),
            };
            for i in 0..3 {
                response.stress[i] += stress[i];
                (0..3).for_each(|j| response.moduli[i][j] += tangent[i][j]);
            }
        }
        Some(response.of_strain(measure))
    }

    /// Stress and moduli by `C` from those conjugate to the measure.
    fn of_strain(self, measure: &Measure) -> Self {
        let mut response = Self { stress: measure.derivative(&self.stress), ..Self::ZERO };
        for (j, unit) in UNITS.iter().enumerate() {
            let change = measure.derivative(unit);
            let conjugate = self.moduli.map(|row| (0..3).map(|k| row[k] * change[k]).sum());
            let stress = measure.stress_change(&self.stress, &conjugate, unit);
            (0..3).for_each(|i| response.moduli[i][j] = stress[i]);
        }
        response
    }
}
