//! Poisson ratios at and next to that of an incompressible solid, on the half-space.

use crate::case::{Case, enter_refusal, grid_condition};
use crate::surfaces::{random_phases, shortest_wave, superposed, table_2_1};
use asperity::contact::{ContactError, SlidingContact};
use asperity::reference::Westergaard;
use asperity::rubber::{Rubber, RubberError};

/// The Poisson ratio enters the half-space by the reduced modulus alone, which is finite at 0.5.
#[test]
fn the_half_space_takes_an_incompressible_rubber() {
    let profile = superposed(&random_phases(3, 2), 2048);
    for nu in [0.499, 0.5] {
        let mut case = Case::new(
            "nu = 0.499 and 0.5 in the BEM, lossy",
            format!("2048 points, nu = {nu}"),
            "nu = 0 with moduli over 1 - nu^2",
        );
        let incompressible = Rubber { poisson_ratio: nu, ..table_2_1() };
        let mut equal = Rubber { poisson_ratio: 0.0, ..table_2_1() };
        equal.equilibrium_modulus /= 1.0 - nu * nu;
        equal.branches.iter_mut().for_each(|branch| branch.modulus /= 1.0 - nu * nu);
        case.conditioned(grid_condition(&incompressible, 0.01, &profile));
        let new = |rubber: &Rubber| {
            SlidingContact::new(rubber, 0.01, profile.period, &profile.heights).unwrap()
        };
        let (mut a, mut b) = (new(&incompressible), new(&equal));
        for p in [1e4, 1e6, 2e7] {
            let (a, b) = (a.solve(p).unwrap(), b.solve(p).unwrap());
            case.solved(&a);
            case.solved(&b);
            // Moduli that differ by round-off; the residual of 1e-10 in islands of a few points.
            case.agrees(a.friction_coefficient, b.friction_coefficient, 1e-7);
            case.agrees(a.contact_area_fraction, b.contact_area_fraction, 1e-7);
            case.agrees(a.mean_separation, b.mean_separation, 1e-7);
        }
        case.enter();
    }
}

#[test]
fn an_incompressible_sine_is_westergaards() {
    let mut case = Case::new(
        "nu = 0.499 and 0.5 in the BEM, elastic sine",
        "8192 points",
        "area of Westergaard",
    );
    let profile = superposed(&[0.0], 8192);
    for nu in [0.499, 0.5] {
        let rubber = Rubber::elastic(3e6, nu);
        let exact = Westergaard { reduced_modulus: 3e6 / (1.0 - nu * nu), wave: shortest_wave() };
        case.conditioned(grid_condition(&rubber, 0.01, &profile));
        let p = 0.2 * exact.full_contact_pressure();
        let mut contact =
            SlidingContact::new(&rubber, 0.01, profile.period, &profile.heights).unwrap();
        let solution = contact.solve(p).unwrap();
        case.solved(&solution);
        // Second order in the spacing, see `tests/verification/westergaard.rs`.
        case.agrees(solution.contact_area_fraction, exact.contact_area_fraction(p), 4e-6);
    }
    case.enter();
}

#[test]
fn beyond_incompressible_is_refused() {
    let profile = superposed(&[0.0], 64);
    let rubber = Rubber::elastic(3e6, 0.5 + 1e-12);
    let error = SlidingContact::new(&rubber, 0.01, profile.period, &profile.heights).err().unwrap();
    let expected = RubberError::PoissonRatio { rubber: "elastic".into(), value: 0.5 + 1e-12 };
    assert_eq!(error, ContactError::Rubber(expected));
    enter_refusal("nu above 0.5 in the BEM", "64 points", error);
}
