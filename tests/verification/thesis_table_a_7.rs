//! Thesis Table A.7: three waves of Table 3.1 at 10 mm/s, five realisations whose phases are not
//! given. For each there is a pair of phases that gives its curve.

use crate::surfaces::{superposed, table_2_1};
use argmin::core::{CostFunction, Executor};
use argmin::solver::neldermead::NelderMead;
use asperity::contact::SlidingContact;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Area fractions of 0.02 and more: the rows below are made by the grid of the thesis.
const AREAS: [f64; 9] = [0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1];

/// Friction coefficients of the five realisations at these areas, thesis Table A.7.
const REALISATIONS: [[f64; 9]; 5] = [
    [0.49944, 0.60943, 0.71755, 0.80528, 0.85530, 0.89507, 0.91959, 0.91366, 0.89295],
    [0.45773, 0.57367, 0.67627, 0.73457, 0.78580, 0.83402, 0.85874, 0.86859, 0.87532],
    [0.51888, 0.59875, 0.66273, 0.66219, 0.65725, 0.63148, 0.63270, 0.63555, 0.64541],
    [0.49199, 0.60839, 0.71589, 0.79710, 0.85568, 0.91245, 0.93550, 0.95870, 0.94793],
    [0.43058, 0.53411, 0.54394, 0.54818, 0.55209, 0.56267, 0.56298, 0.56789, 0.57312],
];

/// Points of the search and of the judgement: 128 and 256 a shortest wave.
const SEARCH_POINTS: usize = 512;
const POINTS: usize = 1024;

/// Of the smallest area, ten points of the search, 1 % is a tenth of a step, more than what the
/// reading of edges of small spots jumps by; it moves the friction by 0.003.
const AREA_TOLERANCE: f64 = 1e-2;

/// Phases tried for each of the two shorter waves; that of the longest is a translation.
const TRIALS: usize = 20;

type Curve = [f64; AREAS.len()];

/// Friction over the areas, if the grid holds all of them.
fn friction_curve(phases: &[f64], points: usize) -> Option<Curve> {
    let profile = superposed(&[phases[0], phases[1], 0.0], points);
    let mut contact =
        SlidingContact::new(&table_2_1(), 0.01, profile.period, &profile.heights).ok()?;
    let mut curve = [0.0; AREAS.len()];
    for (friction, area) in curve.iter_mut().zip(AREAS) {
        *friction = contact.solve_for_area(area, AREA_TOLERANCE).ok()?.friction_coefficient;
    }
    Some(curve)
}

fn root_mean_square_difference(a: &Curve, b: &Curve) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / AREAS.len() as f64).sqrt()
}

struct Distance<'a>(&'a Curve);

impl CostFunction for Distance<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, phases: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        let curve = friction_curve(phases, SEARCH_POINTS);
        Ok(curve.map_or(1.0, |curve| root_mean_square_difference(&curve, self.0)))
    }
}

/// Improves a trial by the simplex method.
fn refine(start: &[f64; 2], published: &Curve) -> (Vec<f64>, f64) {
    let step = 0.5 * TAU / TRIALS as f64;
    let [a, b] = *start;
    let simplex = vec![vec![a, b], vec![a + step, b], vec![a, b + step]];
    let solver = NelderMead::new(simplex).with_sd_tolerance(1e-5).unwrap();
    let result = Executor::new(Distance(published), solver)
        .configure(|state| state.max_iters(60))
        .run()
        .unwrap();
    let state = result.state();
    (state.best_param.clone().unwrap(), state.best_cost)
}

#[test]
fn every_column_is_the_curve_of_some_pair_of_phases() {
    let step = TAU / TRIALS as f64;
    let trials: Vec<([f64; 2], Curve)> = (0..TRIALS * TRIALS)
        .into_par_iter()
        .filter_map(|i| {
            let phases = [(i / TRIALS) as f64 * step, (i % TRIALS) as f64 * step];
            friction_curve(&phases, SEARCH_POINTS).map(|curve| (phases, curve))
        })
        .collect();
    // Some trials may ask the grid for contacts that it does not hold.
    assert!(trials.len() > TRIALS * TRIALS * 9 / 10, "{} trials", trials.len());
    REALISATIONS.par_iter().enumerate().for_each(|(i, published)| {
        let mut ranked: Vec<_> = trials
            .iter()
            .map(|(phases, curve)| (root_mean_square_difference(curve, published), phases))
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (phases, _) = ranked[..4]
            .par_iter()
            .map(|(_, start)| refine(start, published))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap();
        let curve = friction_curve(&phases, POINTS).unwrap();
        let difference = root_mean_square_difference(&curve, published);
        println!("realisation {}: phases {phases:.4?}, rms {difference:.4}", i + 1);
        assert!(difference < 0.02, "realisation {}: {difference} at {phases:?}", i + 1);
    });
}
