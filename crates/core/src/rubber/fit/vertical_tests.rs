//! Vertical factors from noisy sweeps: how far shifts and factors are off, and whether their
//! intervals say so.

use super::tests::{broad, normal};
use super::*;
use crate::rubber::{MaxwellBranch, Rubber, ShiftLaw, TemperatureDependence, VerticalShift};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

const EXPANSION_PER_K: f64 = 6.6e-4;
const NOISE: f64 = 0.02;
const TEMPERATURES_C: [f64; 10] = [-45.0, -40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 25.0, 40.0, 50.0];

/// Hevea rubber about 25 °C as in the other tests, with a law of the vertical factor.
fn dependence(vertical: VerticalShift) -> TemperatureDependence {
    let law = ShiftLaw::Wlf { c1: 8.86, c2_k: 101.6 };
    let about_248 =
        TemperatureDependence { reference_c: -25.15, law, measured_c: None, vertical: None };
    TemperatureDependence { vertical: Some(vertical), ..about_248.about(25.0) }
}

/// Plateau, transition and glass: the slope changes over the curve, branches are half a decade apart.
fn transition() -> Rubber {
    let branch = |k: i32| {
        let decade = 3.0 - 0.5 * f64::from(k);
        // From 0.1 to 100 MPa a branch, halfway at 1e-4 s.
        let glassy = 1.0 / (1.0 + 10_f64.powf(0.6 * (decade + 4.0)));
        MaxwellBranch {
            modulus: 1e5 * 10_f64.powf(3.0 * glassy),
            relaxation_time: 10_f64.powf(decade),
        }
    };
    Rubber { branches: (0..20).map(branch).collect(), ..Rubber::elastic(1e6, 0.49) }
}

/// Moduli that rise with the power 0.25 of the frequency from end to end: four branches a decade,
/// each a factor of 10^(0.25/4) stiffer than the slower one.
fn power_law() -> Rubber {
    let branch = |k: i32| {
        let decade = 6.0 - 0.25 * f64::from(k);
        let modulus = 1e5 * 10_f64.powf(-0.25 * decade);
        MaxwellBranch { modulus, relaxation_time: 10_f64.powf(decade) }
    };
    Rubber { branches: (0..72).map(branch).collect(), ..Rubber::elastic(1e3, 0.49) }
}

/// Sweeps from 0.1 to 100 Hz with normal noise in each modulus.
fn sweeps(rubber: &Rubber, vertical: VerticalShift, seed: u64) -> Vec<Sweep> {
    let mut random = Pcg64::seed_from_u64(seed);
    let dependence = dependence(vertical);
    let mut sweep = |temperature_c: f64| {
        let at = rubber
            .shifted(dependence.shift_factor(temperature_c).unwrap())
            .scaled(dependence.vertical_factor(temperature_c));
        let mut noisy = |modulus: f64| modulus * (NOISE * normal(&mut random)).exp();
        let mut point = |k: i32| {
            let angular_frequency = TAU * 10_f64.powf(f64::from(k) / 6.0 - 1.0);
            let modulus = at.complex_modulus(angular_frequency);
            let (storage_modulus, loss_modulus) = (noisy(modulus.re), noisy(modulus.im));
            SweepPoint { angular_frequency, storage_modulus, loss_modulus }
        };
        Sweep { temperature_c: Some(temperature_c), points: (0..=18).map(&mut point).collect() }
    };
    TEMPERATURES_C.into_iter().map(&mut sweep).collect()
}

/// What many fits have missed.
#[derive(Default)]
struct Tally {
    /// Largest miss of log10 a_T of each fit, over the factors that count as determined.
    shifts: Vec<f64>,
    /// Largest miss of ln b_T of each fit.
    verticals: Vec<f64>,
    /// Factors in all, not determined, and inside their interval: shifts, vertical factors.
    count: usize,
    open: usize,
    inside: [usize; 2],
    refused: usize,
}

impl Tally {
    fn add(&mut self, fit: &MasterCurve, vertical: VerticalShift) {
        let truth = dependence(vertical);
        let (mut shifts, mut verticals) = (0.0_f64, 0.0_f64);
        for shift in fit.shifts.iter().filter(|shift| shift.confidence_95.is_some()) {
            let right = truth.shift_factor(shift.temperature_c).unwrap().log10();
            let miss = (shift.log10_shift - right).abs();
            self.count += 1;
            self.open += usize::from(shift.uncertain);
            self.inside[0] += usize::from(miss <= shift.confidence_95.unwrap());
            if !shift.uncertain {
                shifts = shifts.max(miss);
            }
            let right = truth.vertical_factor(shift.temperature_c);
            let Some(found) = shift.vertical else { continue };
            verticals = verticals.max((found.factor / right).ln().abs());
            let holds = |[low, high]: [f64; 2]| (low..=high).contains(&right);
            self.inside[1] += usize::from(found.confidence_95.is_some_and(holds));
        }
        self.shifts.push(shifts);
        self.verticals.push(verticals);
    }

    fn new(
        rubber: &Rubber,
        truth: VerticalShift,
        choice: VerticalChoice,
        seeds: std::ops::Range<u64>,
    ) -> Self {
        let mut tally = Self::default();
        for seed in seeds {
            let options =
                FitOptions { reference_c: Some(25.0), vertical: choice, ..Default::default() };
            match fit_sweeps(&sweeps(rubber, truth, seed), &options) {
                Ok(fit) => tally.add(&fit, truth),
                Err(_) => tally.refused += 1,
            }
        }
        tally.shifts.sort_by(f64::total_cmp);
        tally.verticals.sort_by(f64::total_cmp);
        tally
    }

    fn line(&self) -> String {
        let at = |sorted: &[f64], part: f64| {
            sorted
                .get((part * (sorted.len() as f64 - 1.0)).round() as usize)
                .copied()
                .unwrap_or(f64::NAN)
        };
        let share = |k: usize| 100.0 * self.inside[k] as f64 / self.count as f64;
        format!(
            "{:.3} | {:.3} | {:.0} % | {:.3} | {:.0} % | {} of {} | {}",
            at(&self.shifts, 0.95),
            at(&self.shifts, 1.0),
            share(0),
            at(&self.verticals, 0.95),
            share(1),
            self.open,
            self.count,
            self.refused
        )
    }
}

const FREE: VerticalChoice = VerticalChoice::Free { expansion_per_k: EXPANSION_PER_K };
const RHO_T: VerticalShift = VerticalShift::RhoT { expansion_per_k: EXPANSION_PER_K };

#[test]
fn free_factors_find_what_density_times_temperature_misses() {
    let (rubber, truth) = (broad().scaled(0.1), VerticalShift::Power { exponent: -1.0 });
    let rho_t = VerticalChoice::RhoT { expansion_per_k: EXPANSION_PER_K };
    assert!(Tally::new(&rubber, truth, rho_t, 0..1).shifts[0] > 0.5);
    let free = Tally::new(&rubber, truth, FREE, 0..3);
    assert!(free.shifts[2] < 0.15 && free.verticals[2] < 0.1, "{}", free.line());
    // 95 % of 27 are expected inside, and neighbours miss together.
    assert!(free.inside.iter().all(|inside| *inside > 20), "{}", free.line());
}

/// Along a power law a factor is as good as a shift: fits of 11 and 14 terms are equally good and
/// differ by a decade at -45 °C.
#[test]
fn shifts_along_a_power_law_are_not_determined() {
    let options = FitOptions { reference_c: Some(25.0), vertical: FREE, ..Default::default() };
    let fit = fit_sweeps(&sweeps(&power_law(), RHO_T, 0), &options).unwrap();
    let coldest = fit.shifts[0];
    let right = dependence(RHO_T).shift_factor(coldest.temperature_c).unwrap().log10();
    assert!(coldest.uncertain, "{coldest:?}");
    let half = coldest.confidence_95.unwrap();
    assert!((coldest.log10_shift - right).abs() < half, "{coldest:?} {right}");
}

#[test]
#[ignore = "prints the table of docs/rubber_data.md; minutes"]
fn table_of_misses() {
    let rubbers = [
        ("bumpy", broad().scaled(0.1), 30),
        ("transition", transition(), 12),
        ("power law", power_law(), 10),
    ];
    let truths = [("ρT", RHO_T), ("1/T", VerticalShift::Power { exponent: -1.0 })];
    let choices = [
        ("none", VerticalChoice::None),
        ("rho-t", VerticalChoice::RhoT { expansion_per_k: EXPANSION_PER_K }),
        ("free", FREE),
    ];
    let of = &|(name, rubber, seeds): &(&str, Rubber, u64)| {
        for (truth_name, truth) in truths {
            for (choice_name, choice) in choices {
                let line = Tally::new(rubber, truth, choice, 00..*seeds).line();
                println!("| {name} | {truth_name} | {choice_name} | {line} |");
            }
        }
    };
    std::thread::scope(|scope| {
        for rubber in &rubbers {
            scope.spawn(move || of(rubber));
        }
    });
}
