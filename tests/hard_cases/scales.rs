//! Extreme scales.

use crate::case::{Case, enter_refusal, grid_condition};
use crate::surfaces::{Profile, random_phases, shortest_wave, superposed, table_2_1};
use asperity::contact::SlidingContact;
use asperity::reference::Westergaard;
use asperity::rubber::Rubber;
use asperity::surface::{SineScale, Wave, wave};

#[test]
fn amplitudes_over_wavelengths_up_to_ten() {
    let rubber = Rubber::elastic(3e6, 0.5);
    let mut case = Case::new(
        "amplitude over wavelength 1e-6 to 10, elastic sine",
        "8192 points",
        "area of Westergaard",
    );
    for steepness in [1e-6, 1e-3, 0.1, 1.0, 10.0] {
        let wavelength = 1e-3;
        let wave = SineScale { wavelength, amplitude: steepness * wavelength };
        let exact = Westergaard { reduced_modulus: 4e6, wave };
        let sine = Wave { wavelength, amplitude: wave.amplitude, phase: 0.3 };
        let profile =
            Profile { period: wavelength, heights: wave::sample(&[sine], wavelength, 8192) };
        let mut contact = SlidingContact::new(&rubber, 0.01, wavelength, &profile.heights).unwrap();
        case.conditioned(grid_condition(&rubber, 0.01, &profile));
        for share in [0.01, 0.2, 0.9] {
            let p = share * exact.full_contact_pressure();
            let solution = contact.solve(p).unwrap();
            case.solved(&solution);
            // Second order in the spacing, see `tests/verification/westergaard.rs`.
            let area = exact.contact_area_fraction(p);
            case.agrees(solution.contact_area_fraction, area, 4e-6);
        }
    }
    case.enter();
}

/// The half-space is linear: heights and pressures scale together, to the last bit for powers of
/// two.
#[test]
fn tall_profiles_are_low_ones_enlarged() {
    let rubber = table_2_1();
    let profile = superposed(&random_phases(3, 8), 3000);
    let mut case = Case::new(
        "amplitude over wavelength 4e-7 to 10, 3 waves, lossy",
        "3000 points",
        "the profile of Table 3.1, enlarged: equal bits",
    );
    let mut contact = SlidingContact::new(&rubber, 0.01, profile.period, &profile.heights).unwrap();
    case.conditioned(grid_condition(&rubber, 0.01, &profile));
    let reference = contact.solve(1e6).unwrap();
    // The shortest wave has an amplitude of 0.3 of its length.
    for factor in [-20, -10, 5].map(|exponent| 2_f64.powi(exponent)) {
        let heights: Vec<f64> = profile.heights.iter().map(|z| factor * z).collect();
        let mut contact = SlidingContact::new(&rubber, 0.01, profile.period, &heights).unwrap();
        let solution = contact.solve(factor * 1e6).unwrap();
        case.solved(&solution);
        case.agrees(solution.contact_area_fraction, reference.contact_area_fraction, 0.0);
        case.agrees(solution.mean_separation, factor * reference.mean_separation, 0.0);
        case.agrees(solution.friction_coefficient, factor * reference.friction_coefficient, 0.0);
    }
    case.enter();
}

/// Lengths and the speed scale together, since `q v` is what the rubber feels.
#[test]
fn lengths_from_nanometres_to_kilometres() {
    let rubber = table_2_1();
    let profile = superposed(&random_phases(3, 8), 3000);
    let mut case = Case::new(
        "periods from 2e-10 m to 3e2 m, 3 waves, lossy",
        "3000 points",
        "lengths and speed scaled together: equal bits",
    );
    let mut contact = SlidingContact::new(&rubber, 0.01, profile.period, &profile.heights).unwrap();
    case.conditioned(grid_condition(&rubber, 0.01, &profile));
    let reference = contact.solve(1e6).unwrap();
    for factor in [-20, 20].map(|exponent| 2_f64.powi(exponent)) {
        let heights: Vec<f64> = profile.heights.iter().map(|z| factor * z).collect();
        let mut contact =
            SlidingContact::new(&rubber, factor * 0.01, factor * profile.period, &heights).unwrap();
        let solution = contact.solve(1e6).unwrap();
        case.solved(&solution);
        case.agrees(solution.contact_area_fraction, reference.contact_area_fraction, 0.0);
        case.agrees(solution.friction_coefficient, reference.friction_coefficient, 0.0);
        case.agrees(solution.mean_separation, factor * reference.mean_separation, 0.0);
    }
    case.enter();
}

#[test]
fn pressures_over_ten_decades_of_one_sine() {
    let rubber = Rubber::elastic(3e6, 0.5);
    let exact = Westergaard { reduced_modulus: 4e6, wave: shortest_wave() };
    let profile = superposed(&[0.0], 16384);
    let mut contact = SlidingContact::new(&rubber, 0.01, profile.period, &profile.heights).unwrap();
    let mut case = Case::new(
        "pressures over ten decades, 1e-8 to 1e2 p*, elastic sine",
        "16384 points",
        "mean separation and largest pressure of Westergaard",
    );
    case.conditioned(grid_condition(&rubber, 0.01, &profile));
    for share in (-8..=2).map(|exponent| 10_f64.powi(exponent)) {
        let p = share * exact.full_contact_pressure();
        let solution = contact.solve(p).unwrap();
        case.solved(&solution);
        let separation = (solution.mean_separation - exact.mean_separation(p)).abs();
        // Errors of the spacing squared: heights of a crest of one point are (2π/16384)²/2 = 7e-8
        // of the amplitude below it at the next.
        case.differs(separation / exact.wave.amplitude, 1e-6);
        // At 1e-8 p* the contact is one point, whose pressure is a mean over the spacing.
        if solution.contact_area_fraction > 20.0 / 16384.0 {
            let largest = solution.pressure.iter().copied().fold(0.0, f64::max);
            case.agrees(largest, exact.maximum_pressure(p), 1e-3);
        }
    }
    case.enter();
}

#[test]
fn pressures_over_ten_decades_of_a_rough_profile() {
    let mut case = Case::new("pressures over ten decades, 8 waves, lossy", "200 points", "Lemke");
    let profile = superposed(&random_phases(8, 9), 200);
    let mut loads = Vec::new();
    for depth in [1e-6, 1e-4, 1e-2, 0.1, 0.5, 1.0, 2.0, 10.0, 1e2, 1e4] {
        case.compare_with_lemke(&table_2_1(), 0.01, &profile, depth);
        loads.push(
            crate::lemke::DenseContact::at_depth(&table_2_1(), 0.01, &profile, depth).mean_pressure,
        );
    }
    assert!(loads[9] > 1e10 * loads[0], "{loads:?}");
    case.enter();
}

#[test]
fn pressures_that_are_none_are_refused() {
    let profile = superposed(&[0.0], 64);
    let mut contact =
        SlidingContact::new(&table_2_1(), 0.01, profile.period, &profile.heights).unwrap();
    for p in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = contact.solve(p).unwrap_err();
        let expected = format!("the mean pressure in Pa is {p}, it must be positive and finite");
        assert_eq!(error.to_string(), expected);
        enter_refusal("invalid mean pressure", format!("64 points, p = {p}"), error);
    }
}

/// Full contact needs no iteration, but where the pressure dwarfs its variation by more than the
/// digits of a number there is nothing left to find.
#[test]
fn pressures_beyond_double_precision_are_refused() {
    let profile = superposed(&[0.0], 64);
    let mut contact =
        SlidingContact::new(&table_2_1(), 0.01, profile.period, &profile.heights).unwrap();
    for p in [1e17, 1e300] {
        let error = contact.solve(p).unwrap_err();
        assert!(error.to_string().ends_with("or a lower pressure"), "{error}");
        enter_refusal("pressure beyond double precision", format!("64 points, p = {p:e}"), error);
    }
}
