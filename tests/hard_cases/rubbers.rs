//! Relaxed and glassy limits.

use crate::case::{Case, grid_condition};
use crate::surfaces::{random_phases, shortest_wave, superposed, table_2_1};
use asperity::contact::SlidingContact;
use asperity::reference::{FullContact, Westergaard};
use asperity::rubber::{MaxwellBranch, Rubber};

/// Relaxation times from `shortest` on, equally spaced over `decades`, whose equal moduli make the
/// glassy modulus `ratio` times the relaxed one of 1 MPa.
fn broad(branches: usize, shortest: f64, decades: f64, ratio: f64) -> Rubber {
    let equilibrium_modulus = 1e6;
    let modulus = equilibrium_modulus * (ratio - 1.0) / branches as f64;
    let branch = |k: usize| MaxwellBranch {
        modulus,
        relaxation_time: shortest * 10_f64.powf(decades * k as f64 / (branches - 1).max(1) as f64),
    };
    Rubber {
        name: format!("{branches} branches"),
        equilibrium_modulus,
        branches: (0..branches).map(branch).collect(),
        poisson_ratio: 0.49,
        finite_strain: Default::default(),
    }
}

/// 40 relaxation times from 1e-12 s to 1e4 s and a glassy modulus of 1e4 times the relaxed one.
fn forty_times() -> Rubber {
    broad(40, 1e-12, 16.0, 1e4)
}

/// One relaxation time and a modulus ratio of 1e4: a phase of 88.9 degrees at its peak.
fn one_time() -> Rubber {
    broad(1, 1e-4, 0.0, 1e4)
}

#[test]
fn forty_relaxation_times_over_16_decades() {
    let rubber = forty_times();
    let mut case =
        Case::new("40 times over 16 decades", "128 points, 1e-16 to 1e12 m/s, 3 waves", "Lemke");
    for speed in (-16..=12).step_by(4).map(|exponent| 10_f64.powi(exponent)) {
        let profile = superposed(&random_phases(3, 5), 128);
        for depth in [1e-2, 0.3, 2.0] {
            case.compare_with_lemke(&rubber, speed, &profile, depth);
        }
    }
    case.enter();
}

#[test]
fn a_modulus_ratio_of_1e4_in_one_step() {
    let mut case = Case::new(
        "E ratio 1e4 in one relaxation time",
        "127 and 128 points, 1e-9 to 1e4 m/s",
        "Lemke",
    );
    for speed in [1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 1e4] {
        for (waves, points) in [(1, 127), (3, 128)] {
            let profile = superposed(&random_phases(waves, 6), points);
            for depth in [1e-2, 0.3, 2.0] {
                case.compare_with_lemke(&one_time(), speed, &profile, depth);
            }
        }
    }
    case.enter();
}

/// On grids beyond a dense matrix: nothing but the residual and the balance of power, work on the
/// slope of the profile against the loss in the spectrum.
#[test]
fn both_rubbers_are_solved_on_fine_grids() {
    for (name, rubber) in [
        ("40 times over 16 decades, all speeds", forty_times()),
        ("E ratio 1e4 in one time, all speeds", one_time()),
    ] {
        let mut case = Case::new(
            name,
            "4096 points, 1e-16 to 1e12 m/s",
            "friction from the slopes and from the power",
        );
        for speed in (-16..=12).step_by(2).map(|exponent| 10_f64.powi(exponent)) {
            let profile = superposed(&random_phases(2, 7), 4096);
            case.conditioned(grid_condition(&rubber, speed, &profile));
            let mut contact =
                SlidingContact::new(&rubber, speed, profile.period, &profile.heights).unwrap();
            let full = contact.smallest_full_contact_pressure();
            for share in [1e-2, 0.3] {
                let solution = contact.solve(share * full).unwrap();
                case.solved(&solution);
                let [slopes, power] = [solution.friction_coefficient, solution.hysteretic_friction];
                // Of the tangent of the profile, which is of order one; the singular pressure at a
                // leading edge of the lossiest contacts is resolved to the spacing only.
                case.differs((slopes - power).abs(), 5e-3);
            }
        }
        case.enter();
    }
}

#[test]
fn the_ends_of_the_spectrum_are_elastic() {
    let profile = superposed(&[0.0], 8192);
    for (name, rubber) in
        [("40 times", forty_times()), ("one time", one_time()), ("Table 2.1", table_2_1())]
    {
        let mut case = Case::new(
            "rubbery and glassy end",
            format!("8192 points, {name}, 1e-20 and 1e20 m/s"),
            "Westergaard with the limiting modulus",
        );
        for (speed, modulus) in
            [(1e-20, rubber.equilibrium_modulus), (1e20, rubber.glassy_modulus())]
        {
            let reduced_modulus = modulus / (1.0 - rubber.poisson_ratio.powi(2));
            let exact = Westergaard { reduced_modulus, wave: shortest_wave() };
            let mut contact =
                SlidingContact::new(&rubber, speed, profile.period, &profile.heights).unwrap();
            case.conditioned(grid_condition(&rubber, speed, &profile));
            for share in [0.01, 0.2, 0.9] {
                let p = share * exact.full_contact_pressure();
                let solution = contact.solve(p).unwrap();
                case.solved(&solution);
                // Second order in the spacing, see `tests/verification/westergaard.rs`.
                let area = exact.contact_area_fraction(p);
                case.agrees(solution.contact_area_fraction, area, 4e-6);
                assert!(solution.hysteretic_friction.abs() < 1e-7);
            }
        }
        case.enter();
    }
}

#[test]
fn full_contact_is_the_formula_at_every_speed() {
    let mut case = Case::new(
        "full contact, 40 times over 16 decades",
        "1024 points, 1e-16 to 1e12 m/s",
        "friction of the Fourier formula",
    );
    let rubber = forty_times();
    let profile = superposed(&[0.4], 1024);
    for speed in (-16..=12).map(|exponent| 10_f64.powi(exponent)) {
        let exact = FullContact { rubber: &rubber, wave: shortest_wave(), speed };
        let p = 1.5 * exact.smallest_pressure();
        let mut contact =
            SlidingContact::new(&rubber, speed, profile.period, &profile.heights).unwrap();
        let solution = contact.solve(p).unwrap();
        case.solved(&solution);
        case.conditioned(grid_condition(&rubber, speed, &profile));
        // The taper of the phase changes that of one wave on 1024 points by 4e-11 rad, of a friction
        // of order one; without loss there is none but round-off.
        let friction = exact.friction_coefficient(p).unwrap();
        case.differs((solution.friction_coefficient - friction).abs(), 1e-9);
    }
    case.enter();
}
