use super::*;
use crate::rubber::{MaxwellBranch, Rubber, ShiftLaw, TemperatureDependence};
use approx::assert_relative_eq;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::{LN_10, TAU};

/// Three terms at 1, 1e-2 and 1e-4 s.
fn three_terms() -> Rubber {
    let branch = |modulus, relaxation_time| MaxwellBranch { modulus, relaxation_time };
    Rubber {
        branches: vec![branch(3e6, 1.0), branch(2e7, 1e-2), branch(1e8, 1e-4)],
        ..Rubber::elastic(2e6, 0.49)
    }
}

/// Standard normal deviate by Box & Muller.
pub(super) fn normal(random: &mut Pcg64) -> f64 {
    let [a, b]: [f64; 2] = [random.random(), random.random()];
    (-2.0 * (1.0 - a).ln()).sqrt() * (TAU * b).cos()
}

/// Eight points a decade over decades of frequency in Hz, with a relative error of normal noise.
fn sweep(rubber: &Rubber, decades: [i32; 2], noise: f64, random: &mut Pcg64) -> Sweep {
    let mut point = |k: i32| {
        let angular_frequency = TAU * 10_f64.powf(f64::from(k) / 8.0);
        let modulus = rubber.complex_modulus(angular_frequency);
        SweepPoint {
            angular_frequency,
            storage_modulus: modulus.re * (noise * normal(random)).exp(),
            loss_modulus: modulus.im * (noise * normal(random)).exp(),
        }
    };
    let points = (8 * decades[0]..=8 * decades[1]).map(&mut point).collect();
    Sweep { temperature_c: None, points }
}

fn fit(rubber: &Rubber, decades: [i32; 2], noise: f64, seed: u64) -> MasterCurve {
    let sweep = sweep(rubber, decades, noise, &mut Pcg64::seed_from_u64(seed));
    fit_sweeps(&[sweep], &FitOptions::default()).unwrap()
}

fn assert_recovered(fit: &MasterCurve, rubber: &Rubber, tolerance: f64) {
    assert_eq!(fit.terms.len(), rubber.branches.len(), "{:?}", fit.candidates);
    let modulus = fit.equilibrium_modulus.value;
    assert_relative_eq!(modulus, rubber.equilibrium_modulus, max_relative = tolerance);
    for (term, branch) in fit.terms.iter().zip(&rubber.branches) {
        assert_relative_eq!(term.modulus.value, branch.modulus, max_relative = tolerance);
        let time = term.relaxation_time.value;
        assert_relative_eq!(time, branch.relaxation_time, max_relative = tolerance);
    }
}

#[test]
fn an_exact_series_is_found_again() {
    assert_recovered(&fit(&three_terms(), [-3, 6], 0.0, 0), &three_terms(), 1e-6);
    let one = Rubber { branches: three_terms().branches[1..2].to_vec(), ..three_terms() };
    assert_recovered(&fit(&one, [-1, 3], 0.0, 0), &one, 1e-6);
    // Six terms over eight decades, from 1.72 to 1186 MPa.
    let found = fit(&Rubber::table_2_1(), [0, 10], 0.0, 0);
    assert_recovered(&found, &Rubber::table_2_1(), 1e-6);
    assert!(found.misfit.loss_factor.largest < 1e-7, "{:?}", found.misfit);
    found.rubber("found", 0.49).rubber.maxwell().unwrap().validate().unwrap();
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_say_and_the_criterion_finds_the_terms() {
    let rubber = three_terms();
    let mut held = [0; 7];
    let mut right = 0;
    for seed in 0..100 {
        let found = fit(&rubber, [-2, 5], 0.02, seed);
        if found.terms.len() != 3 {
            continue;
        }
        right += 1;
        let moduli = found.terms.iter().map(|term| term.modulus);
        let times = found.terms.iter().map(|term| term.relaxation_time);
        let estimates = std::iter::once(found.equilibrium_modulus).chain(moduli).chain(times);
        let truths = std::iter::once(rubber.equilibrium_modulus)
            .chain(rubber.branches.iter().map(|branch| branch.modulus))
            .chain(rubber.branches.iter().map(|branch| branch.relaxation_time));
        for (held, (estimate, truth)) in held.iter_mut().zip(estimates.zip(truths)) {
            let [low, high] = estimate.confidence_95.unwrap();
            *held += usize::from((low..=high).contains(&truth));
        }
    }
    // 95 +- 2.2 of 100 are expected of each interval.
    assert!(right >= 90, "{right}");
    assert!(held.iter().all(|held| 10 * held >= 9 * right), "{held:?} of {right}");
}

#[test]
fn whatever_the_noise_moduli_are_positive() {
    for seed in 0..20 {
        let found = fit(&three_terms(), [-2, 5], 0.3, seed);
        let data = found.rubber("noisy", 0.49);
        data.rubber.maxwell().unwrap().validate().unwrap();
        assert_eq!(data.measured, Some(found.measured));
    }
}

#[test]
fn the_wanted_number_of_terms_is_fitted() {
    let sweep = sweep(&three_terms(), [-2, 5], 0.0, &mut Pcg64::seed_from_u64(0));
    let options = FitOptions { terms: Some(2), ..FitOptions::default() };
    let found = fit_sweeps(std::slice::from_ref(&sweep), &options).unwrap();
    assert_eq!(found.terms.len(), 2);
    assert!(found.misfit.loss_modulus.rms > 0.1);
    let options = FitOptions { terms: Some(57), ..options };
    let error = fit_sweeps(&[sweep], &options).unwrap_err();
    assert!(matches!(error, FitError::TooFewPoints { points: 57, .. }), "{error}");
}

#[test]
fn points_in_any_order_are_the_same_sweep() {
    let rubber = three_terms();
    let sweep = sweep(&rubber, [-2, 5], 0.02, &mut Pcg64::seed_from_u64(3));
    let mut reversed = sweep.clone();
    reversed.points.reverse();
    let of = |sweep: Sweep| fit_sweeps(&[sweep], &FitOptions::default()).unwrap();
    assert_eq!(of(sweep), of(reversed));
}

const TEMPERATURES: [f64; 7] = [-25.0, -15.0, -5.0, 5.0, 20.0, 40.0, 60.0];

/// Two and a half decades at every temperature, as a laboratory's machine has them.
fn sweeps(rubber: &Rubber, law: &ShiftLaw, noise: f64, seed: u64) -> Vec<Sweep> {
    let dependence = TemperatureDependence {
        reference_c: 20.0,
        law: law.clone(),
        measured_c: None,
        vertical: None,
    };
    let mut random = Pcg64::seed_from_u64(seed);
    let mut sweep_at = |temperature_c: f64| {
        let shifted = rubber.shifted(dependence.shift_factor(temperature_c).unwrap());
        let mut points = sweep(&shifted, [-1, 2], noise, &mut random).points;
        points.truncate(21);
        Sweep { temperature_c: Some(temperature_c), points }
    };
    TEMPERATURES.iter().map(|t| sweep_at(*t)).collect()
}

/// A rubber that relaxes over the whole of the master curve below.
pub(super) fn broad() -> Rubber {
    let branch = |k: i32| MaxwellBranch {
        modulus: 4e6 * 1.9_f64.powi(k),
        relaxation_time: 10_f64.powf(1.5 - 1.25 * f64::from(k)),
    };
    Rubber { branches: (0..7).map(branch).collect(), ..Rubber::elastic(3e6, 0.49) }
}

#[test]
fn a_known_wlf_law_is_found_again() {
    let (c1, c2_k) = (6.0, 110.0);
    let law = ShiftLaw::Wlf { c1, c2_k };
    let options = FitOptions { reference_c: Some(20.0), ..FitOptions::default() };
    let exact = fit_sweeps(&sweeps(&broad(), &law, 0.0, 0), &options).unwrap();
    let ShiftLaw::Wlf { c1: found1, c2_k: found2 } = exact.laws[0].law else {
        panic!("{:?}", exact.laws)
    };
    assert_recovered(&exact, &broad(), 1e-6);
    assert_relative_eq!(found1, c1, max_relative = 1e-6);
    assert_relative_eq!(found2, c2_k, max_relative = 1e-6);

    let noisy = fit_sweeps(&sweeps(&broad(), &law, 0.02, 1), &options).unwrap();
    for shift in &noisy.shifts {
        let truth = law.log10_shift(shift.temperature_c, 20.0);
        // Twice the interval: six of them at 95 % miss one now and then.
        let bound = 2.0 * shift.confidence_95.unwrap_or(0.0);
        assert!((shift.log10_shift - truth).abs() <= bound, "{shift:?} {truth}");
    }
    assert_eq!(noisy.laws[0].law.name(), "wlf");
    let dependence = noisy.rubber("noisy", 0.49).temperature.unwrap();
    assert_eq!((dependence.reference_c, dependence.measured_c), (20.0, Some([-25.0, 60.0])));
}

#[test]
fn an_arrhenius_law_is_told_from_wlf() {
    let law = ShiftLaw::Arrhenius { activation_energy_kj_mol: 110.0 };
    let options = FitOptions { reference_c: Some(20.0), ..FitOptions::default() };
    let found = fit_sweeps(&sweeps(&broad(), &law, 0.0, 0), &options).unwrap();
    let ShiftLaw::Arrhenius { activation_energy_kj_mol } = found.laws[0].law else {
        panic!("{:?}", found.laws)
    };
    assert_relative_eq!(activation_energy_kj_mol, 110.0, max_relative = 1e-6);
}

#[test]
fn another_reference_temperature_moves_the_times_only() {
    let law = ShiftLaw::Wlf { c1: 6.0, c2_k: 110.0 };
    let data = sweeps(&broad(), &law, 0.0, 0);
    let at = |reference_c| {
        let options = FitOptions { reference_c: Some(reference_c), ..FitOptions::default() };
        fit_sweeps(&data, &options).unwrap()
    };
    let moved = broad().shifted(10_f64.powf(law.log10_shift(-5.0, 20.0)));
    assert_recovered(&at(-5.0), &moved, 1e-6);
    // c1' = c1 c2 / c2', c2' = c2 + T' - T.
    let ShiftLaw::Wlf { c1, c2_k } = at(-5.0).laws[0].law else { panic!() };
    assert_relative_eq!(c2_k, 85.0, max_relative = 1e-6);
    assert_relative_eq!(c1, 6.0 * 110.0 / 85.0, max_relative = 1e-6);
    let options = FitOptions { reference_c: Some(0.0), ..FitOptions::default() };
    let error = fit_sweeps(&data, &options).unwrap_err().to_string();
    assert!(error.contains("choose one of [-25, -15, -5, 5, 20, 40, 60] °C"), "{error}");
}

#[test]
fn the_jacobian_is_that_of_differences() {
    let law = ShiftLaw::Wlf { c1: 6.0, c2_k: 110.0 };
    let data = sweeps(&broad(), &law, 0.02, 0);
    let options = FitOptions {
        reference_c: Some(20.0),
        vertical: VerticalChoice::Free { expansion_per_k: 6.6e-4 },
        ..FitOptions::default()
    };
    let chain = chain::joined(data, &options).unwrap();
    let mut problem = model::Prony { terms: 2, ..problem(&chain) };
    problem.verticals.as_mut().unwrap().noise = 0.02;
    assert_eq!(problem.parameters(), 1 + 2 * 2 + 2 * 6);
    let terms = vec![[16.0, 0.5], [18.0, -LN_10]];
    let ln_verticals = vec![0.1, 0.2, 0.05, -0.1, 0.0, -0.3, 0.1];
    let series = model::Series { ln_equilibrium: 15.0, terms, ln_verticals, ..chain.start() };
    let at = problem.pack(&series);
    use crate::numerics::least_squares::LeastSquares;
    let exact = problem.jacobian(&at);
    for column in 0..at.len() {
        let moved = |step: f64| {
            let mut parameters = at.clone();
            parameters[column] += step;
            problem.residuals(&parameters)
        };
        let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
        // Truncation 1e-10, round-off 1e-16 / 1e-5.
        let error = (difference - exact.column(column)).amax();
        assert!(error < 1e-9, "column {column}: {error}");
    }
}

#[test]
fn impossible_sweeps_are_refused() {
    let good = sweep(&three_terms(), [-2, 5], 0.0, &mut Pcg64::seed_from_u64(0));
    let refused = |change: &dyn Fn(&mut Vec<SweepPoint>)| {
        let mut sweep = good.clone();
        change(&mut sweep.points);
        fit_sweeps(&[sweep], &FitOptions::default()).unwrap_err().to_string()
    };
    assert!(refused(&|points| points.clear()).contains("no points"));
    assert!(refused(&|points| points.truncate(1)).contains("1 points are too few"));
    assert!(refused(&|points| points[3].loss_modulus = f64::NAN).contains("loss modulus is NaN"));
    assert!(refused(&|points| points[3].storage_modulus = -1.0).contains("storage modulus is -1"));
    assert!(refused(&|points| points[3].angular_frequency = 0.0).contains("frequency is 0"));
    assert!(refused(&|points| points[3] = points[4]).contains("occurs twice"));
    let two = [good.clone(), good];
    let error = fit_sweeps(&two, &FitOptions::default()).unwrap_err();
    assert_eq!(error, FitError::Temperatures);
    let elastic = SweepPoint { angular_frequency: 1.0, storage_modulus: 1e6, loss_modulus: 1e-3 };
    let points =
        (1..9).map(|k| SweepPoint { angular_frequency: f64::from(k), ..elastic }).collect();
    let flat = Sweep { temperature_c: None, points };
    if let Ok(found) = fit_sweeps(&[flat], &FitOptions::default()) {
        found.rubber("flat", 0.5).rubber.maxwell().unwrap().validate().unwrap();
    }
}
