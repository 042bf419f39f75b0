//! The law at one integration point with the memory of one step.

use crate::rubber::finite_strain::{
    FiniteStrainRubber, IDENTITY, Rheology, Spring, Symmetric, contract, determinant, inverse,
    sandwich,
};

/// A tensor in the plane: components xx, xz, zx, zz.
pub type Tensor = [f64; 4];

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

    /// The response at the strain `c` if the internal tensor of branch k is
    /// `history[k] + follows[k] C`; none where the law takes the inverse of an internal tensor
    /// that is not positive.
    pub fn at(
        rubber: &FiniteStrainRubber,
        part: Part,
        c: &Symmetric,
        history: &[Symmetric],
        follows: &[f64],
    ) -> Option<Self> {
        let mut response = Self::ZERO;
        let relaxed = [IDENTITY];
        let springs = std::iter::once(&rubber.equilibrium).chain(&rubber.branches);
        let memory = relaxed.iter().zip(&[0.0]).chain(history.iter().zip(follows));
        let c_inverse = inverse(c);
        for (spring, (history, follows)) in springs.zip(memory) {
            let c_i = [0, 1, 2].map(|i| history[i] + follows * c[i]);
            let positive = determinant(&c_i) > 0.0 && c_i[0] > 0.0;
            if rubber.rheology == Rheology::NeoHookean && !positive {
                return None;
            }
            let state = State { c, c_inverse: &c_inverse, c_i: &c_i, follows: *follows };
            let (stress, modulus) = match part {
                Part::Shear => (rubber.shear_stress(spring, c, &c_i), spring.shear),
                Part::Volumetric => (rubber.volumetric_stress(spring, c, &c_i), spring.volumetric),
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
        Some(response)
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

/// The force `-∂ψ/∂C_i` in Pa that drives the flow of a branch.
pub fn driving_force(
    rubber: &FiniteStrainRubber,
    part: Part,
    branch: &Spring,
    c: &Symmetric,
    c_i: &Symmetric,
) -> Symmetric {
    let g = inverse(c_i);
    let strain = [0, 1, 2].map(|i| 0.5 * (c[i] - c_i[i]));
    match (rubber.rheology, part) {
        (Rheology::NeoHookean, Part::Shear) => {
            let pulled = sandwich(&g, c);
            [0, 1, 2].map(|i| 0.5 * branch.shear * (pulled[i] - g[i]))
        }
        (Rheology::NeoHookean, Part::Volumetric) => {
            let volume = determinant(c) / determinant(c_i);
            g.map(|g| 0.25 * branch.volumetric * (volume - 1.0) * g)
        }
        (Rheology::Linear, Part::Shear) => strain.map(|e| branch.shear * e),
        (Rheology::Linear, Part::Volumetric) => {
            let trace = contract(&IDENTITY, &strain);
            IDENTITY.map(|unit| 0.5 * branch.volumetric * trace * unit)
        }
    }
}

/// Strains of one spring.
struct State<'a> {
    c: &'a Symmetric,
    c_inverse: &'a Symmetric,
    c_i: &'a Symmetric,
    follows: f64,
}

/// `C = Fᵀ F`.
#[inline]
pub fn right_cauchy_green(f: &Tensor) -> Symmetric {
    [f[0] * f[0] + f[2] * f[2], f[1] * f[1] + f[3] * f[3], f[0] * f[1] + f[2] * f[3]]
}

/// Change of `C` when a node moves along x (0) or z (1) by one; `gradient` is that of its shape
/// function.
#[inline]
pub fn strain_change(f: &Tensor, gradient: &[f64; 2], direction: usize) -> Symmetric {
    let row = [f[2 * direction], f[2 * direction + 1]];
    [
        2.0 * row[0] * gradient[0],
        2.0 * row[1] * gradient[1],
        row[0] * gradient[1] + row[1] * gradient[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::Rubber;
    use approx::assert_relative_eq;

    #[test]
    fn the_power_of_the_driving_force_is_the_dissipation() {
        let (c, c_i) = ([1.3, 0.8, 0.2], [1.1, 0.9, -0.1]);
        for rheology in [Rheology::NeoHookean, Rheology::Linear] {
            let rubber = FiniteStrainRubber::new(&Rubber::table_2_1(), rheology).unwrap();
            for branch in &rubber.branches {
                let flow = [0, 1, 2].map(|i| (c[i] - c_i[i]) / branch.relaxation_time);
                let power = |part| contract(&driving_force(&rubber, part, branch, &c, &c_i), &flow);
                let (shear, volumetric) = rubber.dissipation(branch, &c, &c_i);
                assert_relative_eq!(power(Part::Shear), shear, max_relative = 1e-13);
                assert_relative_eq!(power(Part::Volumetric), volumetric, max_relative = 1e-13);
            }
        }
    }
}
