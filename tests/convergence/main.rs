//! Observed orders of the contact solver in the grid spacing.
//!
//! Errors of one contact scatter by a factor of several with the place of its edges between grid
//! points, so an order is fitted to root mean squares over phases of the profile and pressures.
//! The scatter that is left moves an order by up to 0.3; the tolerance is 0.4.

#[path = "../verification/surfaces.rs"]
#[allow(dead_code)]
mod surfaces;

mod estimate;
mod finite_elements;

use asperity::contact::{ContactSolution, SlidingContact};
use asperity::reference::Westergaard;
use asperity::rubber::Rubber;
use rayon::prelude::*;
use surfaces::{random_phases, shortest_wave, superposed, table_2_1};

const GRIDS: [usize; 5] = [2048, 4096, 8192, 16384, 32768];
const PHASES: usize = 16;

fn solve(rubber: &Rubber, phase: f64, points: usize, pressures: &[f64]) -> Vec<ContactSolution> {
    let profile = superposed(&[phase], points);
    let mut contact = SlidingContact::new(rubber, 0.01, profile.period, &profile.heights).unwrap();
    pressures.iter().map(|p| contact.solve(*p).unwrap()).collect()
}

/// Slope of a straight line through the logarithms of errors over spacings.
fn order(errors: &[f64]) -> f64 {
    let n = errors.len() as f64;
    let x: Vec<f64> = GRIDS.iter().map(|points| -(*points as f64).ln()).collect();
    let y: Vec<f64> = errors.iter().map(|error| error.ln()).collect();
    let (x_mean, y_mean) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let covariance: f64 = x.iter().zip(&y).map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
    covariance / x.iter().map(|x| (x - x_mean).powi(2)).sum::<f64>()
}

/// Root mean square over phases and pressures of the error of a quantity on each grid.
fn errors(
    rubber: &Rubber,
    pressures: &[f64],
    error: impl Fn(usize, &ContactSolution) -> f64 + Sync,
) -> Vec<f64> {
    let phases = random_phases(PHASES, 21);
    GRIDS
        .iter()
        .map(|points| {
            let sum: f64 = phases
                .par_iter()
                .map(|phase| {
                    let solutions = solve(rubber, *phase, *points, pressures);
                    solutions.iter().enumerate().map(|(i, s)| error(i, s).powi(2)).sum::<f64>()
                })
                .sum();
            (sum / (PHASES * pressures.len()) as f64).sqrt()
        })
        .collect()
}

fn assert_order(name: &str, errors: &[f64], expected: f64, tolerance: f64) {
    let observed = order(errors);
    println!("{name}: order {observed:.2}, errors {errors:?}");
    assert!((observed - expected).abs() <= tolerance, "{name}: order {observed}, {errors:?}");
}

/// The waves next to the highest of the grid decide only the shape of the edges; a reading of the
/// edges that knows this shape leaves second order.
#[test]
fn an_elastic_sine_converges_with_the_square_of_the_spacing() {
    let exact = Westergaard { reduced_modulus: 4e6, wave: shortest_wave() };
    let full = exact.full_contact_pressure();
    let pressures = [0.03, 0.1, 0.3, 0.6, 0.9].map(|load| load * full);
    let rubber = Rubber::elastic(3e6, 0.5);
    let area = errors(&rubber, &pressures, |i, s| {
        s.contact_area_fraction / exact.contact_area_fraction(pressures[i]) - 1.0
    });
    let separation = errors(&rubber, &pressures, |i, s| {
        (s.mean_separation - exact.mean_separation(pressures[i])) / exact.wave.amplitude
    });
    assert_order("elastic area", &area, 2.0, 0.4);
    assert_order("elastic mean separation", &separation, 2.0, 0.4);
}

/// Friction from the power weighs the waves by their wavenumber and sees the singular ends of the
/// pressure more: order 1.6.
///
/// Against an answer on a grid that is 16 times finer than the finest.
#[test]
fn rubber_converges_with_the_square_of_the_spacing() {
    let rubber = table_2_1();
    let pressures = [0.3e6, 1e6, 3.3e6, 8e6];
    let finest = solve(&rubber, 0.0, 1 << 19, &pressures);
    let relative = |read: fn(&ContactSolution) -> f64| {
        let finest = &finest;
        errors(&rubber, &pressures, move |i, s| read(s) / read(&finest[i]) - 1.0)
    };
    assert_order("area", &relative(|s| s.contact_area_fraction), 2.0, 0.4);
    assert_order("friction from slopes", &relative(|s| s.friction_coefficient), 2.0, 0.4);
    assert_order("mean separation", &relative(|s| s.mean_separation), 2.0, 0.4);
    assert_order("friction from power", &relative(|s| s.hysteretic_friction), 1.6, 0.4);
}
