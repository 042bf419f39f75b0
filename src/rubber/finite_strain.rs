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

/// `det(1 + a) - 1`, accurate for a small tensor.
pub fn dilatation(a: &Symmetric) -> f64 {
    a[0] + a[1] + determinant(a)
}

/// `det(1 + a) - det(1 + b)`, accurate for small tensors.
pub fn dilatation_difference(a: &Symmetric, b: &Symmetric) -> f64 {
    (a[0] - b[0]) + (a[1] - b[1]) + (determinant(a) - determinant(b))
}

/// `C - 1`.
fn strain_of(c: &Symmetric) -> Symmetric {
    [c[0] - 1.0, c[1] - 1.0, c[2]]
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
        self.shear_stress_of(spring, &strain_of(c), &strain_of(internal))
    }

    /// Volumetric part of the stress of one spring in Pa.
    pub fn volumetric_stress(
        &self,
        spring: &Spring,
        c: &Symmetric,
        internal: &Symmetric,
    ) -> Symmetric {
        self.volumetric_stress_of(spring, &strain_of(c), &strain_of(internal))
    }

    /// [`Self::shear_stress`] from the strains `C - 1` and `C_i - 1`: nothing is lost to
    /// cancellation however small they are.
    pub fn shear_stress_of(
        &self,
        spring: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
    ) -> Symmetric {
        match self.rheology {
            Rheology::NeoHookean => {
                // C_i⁻¹ - C⁻¹ = adj C_i (det C - det C_i) / (det C det C_i)
                //               + (adj C_i - adj C) / det C
                let (volume, past) = (1.0 + dilatation(strain), 1.0 + dilatation(internal));
                let change = dilatation_difference(strain, internal) / (volume * past);
                let adjugate = [1.0 + internal[1], 1.0 + internal[0], -internal[2]];
                let less =
                    [internal[1] - strain[1], internal[0] - strain[0], strain[2] - internal[2]];
                [0, 1, 2].map(|i| spring.shear * (adjugate[i] * change + less[i] / volume))
            }
            Rheology::Linear => [0, 1, 2].map(|i| spring.shear * (strain[i] - internal[i])),
        }
    }

    /// [`Self::volumetric_stress`] from the strains `C - 1` and `C_i - 1`.
    pub fn volumetric_stress_of(
        &self,
        spring: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
    ) -> Symmetric {
        let half = 0.5 * spring.volumetric;
        match self.rheology {
            Rheology::NeoHookean => {
                let past = 1.0 + dilatation(internal);
                let pressure = half * dilatation_difference(strain, internal) / past;
                let volume = 1.0 + dilatation(strain);
                let adjugate = [1.0 + strain[1], 1.0 + strain[0], -strain[2]];
                adjugate.map(|g| pressure * g / volume)
            }
            Rheology::Linear => {
                let trace = (strain[0] - internal[0]) + (strain[1] - internal[1]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const LAWS: [Rheology; 2] = [Rheology::NeoHookean, Rheology::Linear];

    fn rubber(rheology: Rheology) -> FiniteStrainRubber {
        FiniteStrainRubber::new(&Rubber::table_2_1(), rheology).unwrap()
    }

    /// A strongly deformed state and one of its past.
    fn states() -> [(Symmetric, Symmetric); 3] {
        [
            ([1.3, 0.9, 0.2], IDENTITY),
            ([0.6, 2.1, -0.4], [0.8, 1.5, 0.1]),
            ([4.0, 0.5, 1.1], [2.5, 0.9, -0.7]),
        ]
    }

    /// Derivative of a function of a symmetric tensor by central differences, as the tensor that
    /// contracted with a change gives the change of the function.
    fn derivative(function: impl Fn(&Symmetric) -> f64, at: &Symmetric) -> Symmetric {
        [0, 1, 2].map(|i| {
            let step = 1e-6;
            let shifted = |by: f64| {
                let mut c = *at;
                c[i] += by;
                function(&c)
            };
            let slope = (shifted(step) - shifted(-step)) / (2.0 * step);
            // The shear component stands twice in a contraction.
            if i == 2 { 0.5 * slope } else { slope }
        })
    }

    #[test]
    fn stress_is_the_derivative_of_the_energy() {
        for law in LAWS {
            let rubber = rubber(law);
            for (c, internal) in states() {
                let spring = rubber.branches[2];
                let slope = derivative(|c| rubber.energy(&spring, c, &internal), &c);
                let shear = rubber.shear_stress(&spring, &c, &internal);
                let volumetric = rubber.volumetric_stress(&spring, &c, &internal);
                for i in 0..3 {
                    let stress = shear[i] + volumetric[i];
                    // Differences of energies of 1e9 Pa.
                    assert_relative_eq!(
                        stress,
                        2.0 * slope[i],
                        max_relative = 1e-6,
                        epsilon = 10.0
                    );
                }
            }
        }
    }

    #[test]
    fn heat_is_what_the_energy_loses_by_flow() {
        for law in LAWS {
            let rubber = rubber(law);
            for (c, internal) in states() {
                let spring = rubber.branches[2];
                let slope = derivative(|internal| rubber.energy(&spring, &c, internal), &internal);
                let flow = [0, 1, 2].map(|i| (c[i] - internal[i]) / spring.relaxation_time);
                let (shear, volumetric) = rubber.dissipation(&spring, &c, &internal);
                let lost = -contract(&slope, &flow);
                assert_relative_eq!(shear + volumetric, lost, max_relative = 1e-6);
                assert!(shear > 0.0);
            }
        }
    }

    #[test]
    fn a_turned_body_has_the_turned_stress() {
        // The law knows the deformation through C = FᵀF alone, so P = F S turns with F.
        let f = [1.2, 0.5, -0.3, 0.9];
        let (sine, cosine) = 0.7_f64.sin_cos();
        let turned = [
            cosine * f[0] - sine * f[2],
            cosine * f[1] - sine * f[3],
            sine * f[0] + cosine * f[2],
            sine * f[1] + cosine * f[3],
        ];
        let cauchy_green = |f: [f64; 4]| {
            [f[0] * f[0] + f[2] * f[2], f[1] * f[1] + f[3] * f[3], f[0] * f[1] + f[2] * f[3]]
        };
        for law in LAWS {
            let rubber = rubber(law);
            let stress = |f| rubber.shear_stress(&rubber.equilibrium, &cauchy_green(f), &IDENTITY);
            for (a, b) in stress(f).into_iter().zip(stress(turned)) {
                assert_relative_eq!(a, b, max_relative = 1e-12);
            }
        }
    }

    #[test]
    fn small_strains_obey_hooke() {
        for law in LAWS {
            let rubber = rubber(law);
            let spring = rubber.equilibrium;
            let strain = [2e-7, -3e-7, 1e-7];
            let c = [0, 1, 2].map(|i| IDENTITY[i] + 2.0 * strain[i]);
            let shear = rubber.shear_stress(&spring, &c, &IDENTITY);
            let volumetric = rubber.volumetric_stress(&spring, &c, &IDENTITY);
            let trace = strain[0] + strain[1];
            for i in 0..3 {
                let hooke =
                    2.0 * spring.shear * strain[i] + spring.volumetric * trace * IDENTITY[i];
                // Second order of the strain, and the round-off of 1 + strain.
                assert_relative_eq!(shear[i] + volumetric[i], hooke, max_relative = 1e-4);
            }
        }
    }

    #[test]
    fn tiny_strains_keep_their_digits() {
        let rubber = rubber(Rheology::NeoHookean);
        let spring = rubber.branches[4];
        let tiny = [2e-14, -3e-14, 1e-14];
        let stress = rubber.volumetric_stress_of(&spring, &tiny, &[0.0; 3]);
        assert_relative_eq!(stress[0], -0.5 * spring.volumetric * 1e-14, max_relative = 1e-12);
        let stress = rubber.shear_stress_of(&spring, &tiny, &[0.0; 3]);
        for i in 0..3 {
            assert_relative_eq!(stress[i], spring.shear * tiny[i], max_relative = 1e-12);
        }
    }

    #[test]
    fn incompressible_rubber_is_refused() {
        let incompressible = Rubber::elastic(1e6, 0.5);
        let error = FiniteStrainRubber::new(&incompressible, Rheology::NeoHookean).unwrap_err();
        assert!(error.to_string().contains("poisson_ratio is 0.5"), "{error}");
    }
}
