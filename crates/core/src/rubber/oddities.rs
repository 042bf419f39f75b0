//! Warnings of numbers of a rubber that are allowed but look like a mistake.

use super::causality::Causality;
use super::{MaxwellBranch, MeasuredModuli, Rubber, RubberData, RubberModel, Viscoelastic};

/// A glass of rubber has some 3 GPa and steel 210: beyond this a modulus has another unit; in Pa.
const STIFFEST: f64 = 1e11;
/// Softer than any gel that holds its shape; in Pa.
const SOFTEST: f64 = 1e2;
/// No relaxation time is measured beyond it, in s; it would be some 300 000 years.
const SLOWEST: f64 = 1e13;

/// Range in `I1 - 3` of a law at finite strain: below it few contacts of a road are in range.
const LEAST_RANGE: f64 = 4.0;

impl RubberData {
    /// Warnings of numbers that no rubber has, as written in the file, with what to do; of a table also what reading it
    /// changed, and where it is not causal.
    pub fn oddities(&self) -> Vec<String> {
        let name = self.rubber.name();
        let mut oddities: Vec<String> =
            self.notes.iter().map(|note| format!("rubber {name}: {note}")).collect();
        oddities.extend(match &self.rubber {
            RubberModel::Maxwell(rubber) => of_maxwell(rubber),
            RubberModel::Table(table) => of_table(table),
        });
        oddities
    }
}

fn of_table(table: &MeasuredModuli) -> Vec<String> {
    let name = table.name();
    let mut oddities = Vec::new();
    let storage = || table.points().iter().map(|point| point.storage_modulus);
    let (softest, stiffest) =
        (storage().fold(f64::INFINITY, f64::min), storage().fold(0.0, f64::max));
    if !(SOFTEST..=STIFFEST).contains(&stiffest) {
        oddities.push(format!(
            "rubber {name}: the storage modulus of its table lies between {:e} and {:e} MPa, and that of rubber between \
             0.1 MPa and some 3 GPa: check the unit",
            softest / 1e6,
            stiffest / 1e6
        ));
    }
    oddities.extend(Causality::of(table).warning(name));
    oddities
}

fn of_maxwell(rubber: &Rubber) -> Vec<String> {
    let name = &rubber.name;
    let mut oddities = Vec::new();
    let equilibrium =
        [("equilibrium_modulus_mpa".to_owned(), rubber.equilibrium_modulus)].into_iter();
    let of_branch = |(k, branch): (usize, &MaxwellBranch)| {
        (format!("modulus_mpa of branch {}", k + 1), branch.modulus)
    };
    let moduli: Vec<(String, f64)> =
        equilibrium.chain(rubber.branches.iter().enumerate().map(of_branch)).collect();
    if let Some((key, modulus)) = moduli.iter().find(|(_, modulus)| *modulus > STIFFEST) {
        let mpa = modulus / 1e6;
        oddities.push(format!(
                "rubber {name}: {key} is {mpa}, which is {:e} GPa, and glassy rubber has some 3 GPa: if the number \
                 is in Pa, write {}",
                mpa / 1e3,
                mpa / 1e6
            ));
    }
    if rubber.glassy_modulus() < SOFTEST {
        oddities.push(format!(
                "rubber {name}: all moduli together are {} MPa, and soft rubber has some 0.1 MPa: check the unit, \
                 moduli are in MPa",
                rubber.glassy_modulus() / 1e6
            ));
    }
    if rubber.branches.is_empty() {
        oddities.push(format!(
                "rubber {name} has no branches and is elastic: it dissipates nothing and its hysteretic friction \
                 is 0; add [[branches]] with modulus_mpa and relaxation_time_s"
            ));
    }
    let slow = rubber.branches.iter().position(|branch| branch.relaxation_time > SLOWEST);
    if let Some(k) = slow {
        oddities.push(format!(
                "rubber {name}: relaxation_time_s of branch {} is {:e}, which no sweep measures: relaxation times \
                 are in s",
                k + 1,
                rubber.branches[k].relaxation_time
            ));
    }
    let limit = rubber.finite_strain.limit();
    if limit < LEAST_RANGE {
        oddities.push(format!(
            "rubber {name}: its law at finite strain, {}, holds up to a shear of {:.2} (I1 - 3 = {limit:.3}), and \
             finite elements refuse contacts that go further; the tips of a road shear rubber by 2 to 5: check its \
             constants, fitted to larger strains",
            rubber.finite_strain.name(),
            limit.sqrt()
        ));
    }
    let branches = &rubber.branches;
    let twice = (1..branches.len()).find(|k| branches[..*k].contains(&branches[*k]));
    if let Some(k) = twice {
        oddities.push(format!(
                "rubber {name}: branch {} stands there twice, with the same modulus and relaxation time; leave one out if \
                 it is a copy",
                k + 1
            ));
    }
    oddities
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::{Rheology, Rubber};

    fn oddities(rubber: Rubber) -> Vec<String> {
        RubberData::from(rubber).oddities()
    }

    #[test]
    fn other_units_and_missing_branches_are_told() {
        assert_eq!(oddities(Rubber::table_2_1()), [""; 0]);
        let in_pa = oddities(Rubber::table_2_1().scaled(1e6));
        assert!(in_pa.len() == 1 && in_pa[0].contains("is 4170000, "), "{in_pa:?}");
        assert!(in_pa[0].contains("write 4.17"), "{in_pa:?}");
        let soft = oddities(Rubber::table_2_1().scaled(1e-9));
        assert!(soft.len() == 1 && soft[0].contains("check the unit"), "{soft:?}");
        let of_law = |c3_over_c1: f64| {
            let finite_strain = Rheology::Yeoh { c2_over_c1: -0.1, c3_over_c1 };
            oddities(Rubber { finite_strain, ..Rubber::table_2_1() })
        };
        assert_eq!(of_law(0.01), [""; 0]);
        let short = of_law(0.0);
        assert!(
            short.len() == 1 && short[0].contains("a shear of 1.29 (I1 - 3 = 1.667)"),
            "{short:?}"
        );
        let elastic = oddities(Rubber::elastic(4e6, 0.5));
        assert!(elastic.len() == 1 && elastic[0].contains("has no branches"), "{elastic:?}");
    }
}
