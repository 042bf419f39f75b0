use super::*;
use std::convert::Infallible;

const TARGETS: [f64; 12] =
    [0.002, 0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1];

fn area(pressure: f64) -> f64 {
    (pressure / 1e7).powf(0.9).tanh()
}

fn friction(area: f64) -> f64 {
    1.1 * (-(area / 0.03).ln().powi(2) / 20.0).exp()
}

fn point(pressure: f64) -> Result<CurvePoint, Infallible> {
    let contact_area_fraction = area(pressure);
    let friction_coefficient = friction(contact_area_fraction);
    Ok(CurvePoint {
        mean_pressure: pressure,
        contact_area_fraction,
        friction_coefficient,
        error: Some(GridError {
            friction_coefficient: 1e-3 * contact_area_fraction,
            contact_area_fraction: 0.0,
        }),
    })
}

#[test]
fn the_error_is_within_the_tolerance_and_costs_fewer_solves_than_targets_allow() {
    let mut previous = usize::MAX;
    for (tolerance, most) in [(1e-3, 17), (1e-2, 15)] {
        let mut solves = 0;
        let curve = friction_curve(&TARGETS, tolerance, 3e3, |p| {
            solves += 1;
            point(p)
        })
        .unwrap();
        for value in &curve {
            let exact = friction(value.contact_area_fraction);
            let error = (value.friction_coefficient - exact).abs();
            assert!(error <= tolerance * exact, "{value:?} {exact}");
            let there = area(value.mean_pressure);
            approx::assert_relative_eq!(there, value.contact_area_fraction, max_relative = 0.01);
        }
        assert!(solves <= most && solves <= previous, "{solves} solves for {tolerance}");
        previous = solves;
    }
}

#[test]
fn friction_that_vanishes_settles_on_an_error_beside_its_scale() {
    // Nothing but what the grid makes of it, different at every pressure.
    let vanishing = |pressure: f64| -> Result<CurvePoint, Infallible> {
        let friction_coefficient = 1e-7 * (1e3 * pressure.ln()).sin();
        Ok(CurvePoint { friction_coefficient, ..point(pressure)? })
    };
    let accuracy = Accuracy { tolerance: 1e-2, least_friction: 1e-4 };
    for value in friction_curve_within(&TARGETS, accuracy, 3e3, vanishing).unwrap() {
        assert!(value.friction_coefficient.abs() < 2e-7 && value.interpolation_error <= 1e-6);
    }
    // Where there is friction it changes nothing.
    let usual = friction_curve(&TARGETS, 1e-3, 3e3, point).unwrap();
    let accuracy = Accuracy { tolerance: 1e-3, least_friction: 1e-4 };
    assert_eq!(friction_curve_within(&TARGETS, accuracy, 3e3, point).unwrap(), usual);
}

#[test]
fn an_area_that_no_pressure_has_gets_the_friction_on_both_sides_of_the_jump() {
    let jumping = |p: f64| -> Result<CurvePoint, Infallible> {
        let smooth = point(p)?;
        let area = smooth.contact_area_fraction;
        let jump = if area > 0.049 { 1.2 } else { 1.0 };
        Ok(CurvePoint { contact_area_fraction: area * jump, ..smooth })
    };
    for targets in [&[0.05][..], &[0.05, 0.1], &[0.02, 0.05, 0.055]] {
        let mut solves = 0;
        let curve = friction_curve(targets, 1e-2, 3e5, |p| {
            solves += 1;
            jumping(p)
        })
        .unwrap();
        assert!(solves <= 20, "{solves} solves for {targets:?}");
        let value = curve.iter().find(|v| v.contact_area_fraction == 0.05).unwrap();
        let (exact, error) = (friction(0.049), value.interpolation_error);
        assert!(error <= 1e-2 * exact);
        assert!((value.friction_coefficient - exact).abs() <= error.max(1e-2 * exact));
    }
}

#[test]
fn an_area_that_stands_still_and_then_jumps_is_no_trap() {
    let steps = |p: f64| -> Result<CurvePoint, Infallible> {
        let smooth = point(p)?;
        let area = smooth.contact_area_fraction;
        let stepped = if (0.04..0.06).contains(&area) { 0.0400001 } else { area };
        Ok(CurvePoint { contact_area_fraction: stepped, ..smooth })
    };
    let curve = friction_curve(&[0.03, 0.05], 5e-3, 3e5, steps).unwrap();
    approx::assert_relative_eq!(curve[1].friction_coefficient, friction(0.06), max_relative = 0.01);
}

#[test]
fn an_area_that_is_a_bit_off_is_an_error_of_friction() {
    let off = |p: f64| -> Result<CurvePoint, Infallible> {
        let exact = point(p)?;
        let contact_area_fraction = 0.05 * exact.contact_area_fraction;
        let error = GridError { friction_coefficient: 0.0, contact_area_fraction };
        Ok(CurvePoint { error: Some(error), ..exact })
    };
    for value in friction_curve(&TARGETS, 1e-3, 3e3, off).unwrap() {
        let area = value.contact_area_fraction;
        let change = (friction(1.01 * area) - friction(area)).abs() / 0.01_f64.ln_1p();
        let error = value.discretisation_error.unwrap();
        // The slope is that between the solved points.
        assert!((error - 0.05 * change).abs() <= 0.01 * friction(area), "{value:?} {change}");
    }
}

#[test]
fn one_target_and_a_far_guess() {
    for guess in [1e-2, 1e12] {
        let curve = friction_curve(&[0.05], 1e-4, guess, point).unwrap();
        approx::assert_relative_eq!(
            curve[0].friction_coefficient,
            friction(0.05),
            max_relative = 1e-4
        );
    }
}

#[test]
fn an_area_out_of_reach_is_an_error_that_names_it() {
    let error = friction_curve(&[0.5], 1e-3, 1.0, |p| {
        let limited = CurvePoint { contact_area_fraction: 0.3, ..point(p)? };
        Ok::<_, Infallible>(limited)
    })
    .unwrap_err();
    assert!(error.to_string().contains("0.5 was not bracketed"), "{error}");
}

#[test]
fn bad_targets_are_refused() {
    for targets in [&[][..], &[0.1, 0.1], &[0.2, 0.1], &[0.0], &[1.0], &[f64::NAN]] {
        assert!(friction_curve(targets, 1e-3, 1.0, point).is_err());
    }
}
