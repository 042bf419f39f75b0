//! The law at one integration point with the memory of one step.

use crate::rubber::finite_strain::{
    FiniteStrainRubber, Measure, Rheology, Symmetric, contract, determinant, difference, inverse,
    one_plus, sandwich,
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
    pub moduli: [[f64; 3]; 3],
}

/// Unit changes of the three components of `C`.
const UNITS: [Symmetric; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Response {
    const ZERO: Self = Self { stress: [0.0; 3], moduli: [[0.0; 3]; 3] };

    /// The response at the strain `m` in the measure of the law if the internal tensor of branch
    /// k is `history[k] + follows[k] m`; none where the law takes the inverse of an internal
    /// tensor that is not positive.
    pub fn at(
        rubber: &FiniteStrainRubber,
        part: Part,
        measure: &Measure,
        history: &[Symmetric],
        follows: &[f64],
    ) -> Option<Self> {
        let mut response = Self::ZERO;
        let strain = &measure.value();
        let relaxed = [[0.0; 3]];
        let springs = std::iter::once(&rubber.equilibrium).chain(&rubber.branches);
        let memory = relaxed.iter().zip(&[0.0]).chain(history.iter().zip(follows));
        let c = one_plus(strain);
        let c_inverse = inverse(&c);
        for (spring, (history, follows)) in springs.zip(memory) {
            let internal = [0, 1, 2].map(|i| history[i] + follows * strain[i]);
            let c_i = one_plus(&internal);
            let positive = determinant(&c_i) > 0.0 && c_i[0] > 0.0;
            if rubber.rheology == Rheology::NeoHookean && !positive {
                return None;
            }
            let tensors = [strain, &internal, &difference(strain, &internal)];
            let state = State { c: &c, c_inverse: &c_inverse, c_i: &c_i, follows: *follows };
            let (stress, modulus) = match part {
                Part::Shear => (rubber.shear_stress(spring, tensors), spring.shear),
                Part::Volumetric => (rubber.volumetric_stress(spring, tensors), spring.volumetric),
            };
            (0..3).for_each(|i| response.stress[i] += stress[i]);
            match (rubber.rheology, part) {
                (Rheology::NeoHookean, Part::Shear) => {
                    response.add_neo_hookean_shear(modulus, &state);
                }
                (Rheology::NeoHookean, Part::Volumetric) => {
                    response.add_neo_hookean_volumetric(modulus, &state);
                }
                (Rheology::Linear, Part::Shear) => {
                    (0..3).for_each(|i| response.moduli[i][i] += modulus * (1.0 - follows));
                }
                (Rheology::Linear, Part::Volumetric) => {
                    let stiffness = 0.5 * modulus * (1.0 - follows);
                    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        response.moduli[i][j] += stiffness;
                    }
                }
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

    /// `δS = μ (C⁻¹ δC C⁻¹ - C_i⁻¹ δC_i C_i⁻¹)`.
    fn add_neo_hookean_shear(&mut self, shear: f64, state: &State) {
        let g_i = inverse(state.c_i);
        for (j, unit) in UNITS.iter().enumerate() {
            let whole = sandwich(state.c_inverse, unit);
            let internal = sandwich(&g_i, unit);
            for i in 0..3 {
                self.moduli[i][j] += shear * (whole[i] - state.follows * internal[i]);
            }
        }
    }

    /// `δS = Λ/2 (V (C⁻¹ : δC - C_i⁻¹ : δC_i) C⁻¹ - (V - 1) C⁻¹ δC C⁻¹)`, `V = det C / det C_i`.
    fn add_neo_hookean_volumetric(&mut self, volumetric: f64, state: &State) {
        let g = state.c_inverse;
        let g_i = inverse(state.c_i);
        let volume = determinant(state.c) / determinant(state.c_i);
        for (j, unit) in UNITS.iter().enumerate() {
            let growth = contract(g, unit) - state.follows * contract(&g_i, unit);
            let turned = sandwich(g, unit);
            for i in 0..3 {
                self.moduli[i][j] +=
                    0.5 * volumetric * (volume * growth * g[i] - (volume - 1.0) * turned[i]);
            }
        }
    }
}

/// Tensors of one spring under neo-Hooke.
struct State<'a> {
    c: &'a Symmetric,
    c_inverse: &'a Symmetric,
    c_i: &'a Symmetric,
    follows: f64,
}
