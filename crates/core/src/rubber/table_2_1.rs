//! The rubber of the published tables.

use super::{MaxwellBranch, Rheology, Rubber};

/// Modulus in MPa and relaxation time in s of each branch (thesis, Table 2.1).
const BRANCHES: [(f64, f64); 6] = [
    (1.72, 1.134e-2),
    (7.36, 2.628e-4),
    (70.98, 1.316e-5),
    (505.87, 1.295e-6),
    (1125.85, 7.708e-8),
    (1185.94, 4.2e-10),
];
const PA_PER_MPA: f64 = 1e6;

impl Rubber {
    /// The rubber of the published tables (thesis, Table 2.1) with the constant Poisson ratio 0.49.
    pub fn table_2_1() -> Self {
        let branch = |(modulus_mpa, relaxation_time)| MaxwellBranch {
            modulus: modulus_mpa * PA_PER_MPA,
            relaxation_time,
        };
        Self {
            name: "Table 2.1".into(),
            equilibrium_modulus: 4.17 * PA_PER_MPA,
            branches: BRANCHES.map(branch).into(),
            poisson_ratio: 0.49,
            finite_strain: Rheology::NeoHookean,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_moduli_add_up_to_the_glassy_one() {
        // The sum was typed from the thesis by itself.
        let glassy = Rubber::table_2_1().glassy_modulus();
        approx::assert_relative_eq!(glassy, 2901.89e6, max_relative = 1e-12);
    }
}
