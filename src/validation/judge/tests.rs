//! Cases of synthetic sets.

use super::*;

/// Friction of a law of 6 MPa, 10 mm/s at 20 °C, width 0.1 and 0.5 eV over five decades, with an error that alternates in sign.
fn set(title: &str, celsius: f64, noise: f64) -> Set {
    let value = |k: i32| {
        let speed = 10.0_f64.powi(k - 4);
        let (pressure, hysteretic, contact_area_fraction) = (3e5, 0.2, 0.1);
        let shift = crate::interface::Activation { energy_ev: 0.5, reference_c: 20.0 };
        let decades = (speed / 0.01).log10() + shift.ln_factor(celsius) / std::f64::consts::LN_10;
        let adhesive = 6e6 * (-0.1 * decades * decades).exp() * contact_area_fraction / pressure;
        let error = if k % 2 == 0 { noise } else { -noise };
        Beside {
            measured: MeasuredFriction {
                speed,
                temperature_c: celsius,
                pressure,
                friction: hysteretic + adhesive + error,
                hysteretic,
                contact_area_fraction,
            },
            hysteretic_error: Some(0.01),
            relative_area_error: Some(0.02),
        }
    };
    let label = Label { model: "bem".into(), surfaces: "measured".into(), effect: "none".into() };
    Set {
        title: title.into(),
        measured: "friction.csv".into(),
        lines: (2..8).collect(),
        temperature_c: Some(celsius),
        several_temperatures: false,
        reference_c: None,
        warnings: Vec::new(),
        fixed: Fixed { width: Some(0.1), ..Fixed::default() },
        given: None,
        predictions: vec![Prediction {
            label,
            shortest_wavelength_mm: 0.06,
            values: (0..6).map(value).collect(),
        }],
        left_out: Vec::new(),
    }
}

fn of(judged: &Validated, case: Case) -> &Judged {
    judged.results.iter().find(|result| result.case == case).unwrap()
}

#[test]
fn bands_hold_the_errors_of_the_computation_and_of_the_fit() {
    let judged = judge(&[set("a", 20.0, 0.05), set("b", 20.0, 0.0)]).unwrap();
    let alone = of(&judged, Case::Hysteresis);
    assert_eq!((alone.with_band, alone.inside_band), (12, 0));
    let [low, high] = alone.points[0].band_95.unwrap();
    approx::assert_relative_eq!(high - low, 0.02, max_relative = 1e-12);
    // The exact set alone: no scatter, and the error of the computation is left.
    let own = of(&judged, Case::Own);
    assert!(own.rms_of_sets[1] < 1e-9 && own.rms_of_sets[0] > 0.03, "{:?}", own.rms_of_sets);
    let exact = &own.points[8];
    let [low, high] = exact.band_95.unwrap();
    let computed = 0.01 + 0.02 * exact.adhesive;
    assert_eq!(exact.band_parts.hysteresis, Some(0.01));
    assert_eq!(exact.band_parts.area, Some(0.02 * exact.adhesive));
    assert_eq!((alone.points[0].band_parts.fit, alone.points[0].band_parts.area), (0.0, Some(0.0)));
    approx::assert_relative_eq!(high - low, 2.0 * computed, max_relative = 1e-6);
    let scattered = &of(&judged, Case::Joint).points[0];
    let [low, high] = scattered.band_95.unwrap();
    let parts = scattered.band_parts;
    let half = parts.fit.hypot(parts.hysteresis.unwrap() + parts.area.unwrap());
    assert!(parts.fit > 0.01, "{parts:?}");
    approx::assert_relative_eq!(high - low, 2.0 * half, max_relative = 1e-12);
    let other = of(&judged, Case::Other);
    assert_eq!(other.laws[0].fitted_to, ["b"]);
    assert!((other.rms_of_sets[0] - 0.05).abs() < 1e-9, "{:?}", other.rms_of_sets);
    assert_eq!(judged.headline().unwrap().case, Case::Joint);
}

#[test]
fn a_law_of_one_temperature_predicts_no_other_one() {
    let judged = judge(&[set("a", 20.0, 0.0), set("b", 40.0, 0.0)]).unwrap();
    assert!(judged.results.iter().all(|result| result.case != Case::Other));
    let reason = judged.left_out.iter().find(|reason| reason.contains("other")).unwrap();
    assert!(reason.contains("20 °C") && reason.contains("40 °C"), "{reason}");
    assert_eq!(of(&judged, Case::Joint).laws[0].reference_c, Some(20.0));
    let stated = [("a", 20.0), ("b", 40.0)].map(|(title, celsius)| {
        let mut set = set(title, celsius, 0.0);
        set.reference_c = Some(40.0);
        set
    });
    let hot = judge(&stated).unwrap();
    assert_eq!(of(&hot, Case::Joint).laws[0].reference_c, Some(40.0));
    let turned = judge(&[set("b", 40.0, 0.0), set("a", 20.0, 0.0)]).unwrap();
    assert_eq!(of(&turned, Case::Joint).laws[0].reference_c, Some(20.0));
}

#[test]
fn sets_that_cannot_be_told_apart_or_fix_other_constants_are_refused() {
    let same = judge(&[set("a", 20.0, 0.0), set("a", 20.0, 0.0)]).unwrap_err();
    assert!(same.to_string().contains("title `a`"), "{same}");
    let mut other = set("b", 20.0, 0.0);
    other.fixed.width = Some(0.2);
    let mut warm = set("b", 20.0, 0.0);
    warm.reference_c = Some(30.0);
    let reference = judge(&[set("a", 20.0, 0.0), warm]).unwrap_err();
    assert!(reference.to_string().contains("different reference_c"), "{reference}");
    let different = judge(&[set("a", 20.0, 0.0), other]).unwrap_err();
    assert!(different.to_string().contains("different width"), "{different}");
}
