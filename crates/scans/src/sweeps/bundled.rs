//! The bundled sweeps, made and fitted here.

use super::{TableOptions, read_sweeps};
use approx::assert_relative_eq;
use asperity_core::rubber::fit::{FitOptions, fit_sweeps};
use asperity_core::rubber::{Rubber, ShiftLaw};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// Standard normal deviate by Box & Muller.
fn normal(random: &mut Pcg64) -> f64 {
    let [a, b]: [f64; 2] = [random.random(), random.random()];
    (-2.0 * (1.0 - a).ln()).sqrt() * (TAU * b).cos()
}

/// The bundled sweeps: Table 2.1 between 0.1 and 100 Hz at eight temperatures under a WLF law, with a
/// noise of 2 %.
fn bundled_sweeps() -> String {
    let law = ShiftLaw::Wlf { c1: 8.86, c2_k: 101.6 };
    let mut random = Pcg64::seed_from_u64(21);
    let mut text = String::from(
        "# Synthetic: the rubber of table_2_1.toml at 20 degrees, WLF with c1 = 8.86 and c2 = 101.6 K,\n\
         # normal noise of 2 % in each modulus.\n\
         frequency_hz,storage_mpa,loss_mpa,temperature_c\n",
    );
    for temperature_c in [-30.0, -25.0, -20.0, -15.0, -10.0, 0.0, 10.0, 20.0] {
        let factor = 10_f64.powf(law.log10_shift(temperature_c, 20.0));
        let rubber = Rubber::table_2_1().shifted(factor);
        for k in 0..=18 {
            let frequency = 10_f64.powf(f64::from(k) / 6.0 - 1.0);
            let modulus = rubber.complex_modulus(TAU * frequency) / 1e6;
            let mut noisy = |modulus: f64| modulus * (0.02 * normal(&mut random)).exp();
            let (storage, loss) = (noisy(modulus.re), noisy(modulus.im));
            text += &format!("{frequency:.4},{storage:.4e},{loss:.4e},{temperature_c}\n");
        }
    }
    text
}

fn bundled() -> std::path::PathBuf {
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/rubber/table_2_1_sweeps.csv").into()
}

#[test]
fn the_bundled_sweeps_are_made_here_and_give_table_2_1() {
    assert_eq!(std::fs::read_to_string(bundled()).unwrap(), bundled_sweeps());
    let sweeps = read_sweeps(&bundled(), &TableOptions::default(), 1.0).unwrap().sweeps;
    assert_eq!(sweeps.len(), 8);
    let options = FitOptions { reference_c: Some(20.0), ..FitOptions::default() };
    let found = fit_sweeps(&sweeps, &options).unwrap();
    let rubber = Rubber::table_2_1();
    assert_eq!(found.terms.len(), rubber.branches.len(), "{:?}", found.candidates);
    // Ten times a standard error of the weakest term, noise over the root of the points it shows in.
    let recovered = |value, exact| assert_relative_eq!(value, exact, max_relative = 0.1);
    recovered(found.equilibrium_modulus.value, rubber.equilibrium_modulus);
    for (term, branch) in found.terms.iter().zip(&rubber.branches) {
        recovered(term.modulus.value, branch.modulus);
        recovered(term.relaxation_time.value, branch.relaxation_time);
    }
}

#[test]
#[ignore = "rewrites data/rubber/table_2_1_sweeps.csv"]
fn rewrite_the_bundled_sweeps() {
    std::fs::write(bundled(), bundled_sweeps()).unwrap();
}
