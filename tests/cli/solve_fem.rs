//! `asperity solve fem`.

use std::fs;

use super::{asperity, asperity_at};
use serde_json::Value;

const SINE: &str = "solve fem --wave 0.0625:0.005 --speed 10 --pressure 0.3 --columns 32";

fn number(result: &Value, key: &str) -> f64 {
    result[key].as_f64().unwrap()
}

#[test]
fn the_keys_are_those_of_the_half_space_and_more() {
    let of_bem = asperity("solve bem --wave 0.0625:0.005 --speed 10 --pressure 0.3 --json").json();
    let of_fem = asperity(&format!("{SINE} --json")).json();
    for key in of_bem.as_object().unwrap().keys() {
        assert!(of_fem.get(key).is_some(), "{key}");
    }
    // Slopes of 0.36 rms: both models within a few percent.
    let [bem, fem] = [&of_bem, &of_fem].map(|result| number(result, "friction_coefficient"));
    assert!((fem / bem - 1.0).abs() < 0.05 && fem != bem, "{fem} {bem}");
    assert!(number(&of_fem, "residual") <= 1e-8);
    assert_eq!(of_fem["grid_points"], 32);
}

#[test]
fn the_table_has_the_figures_of_the_json() {
    let table = asperity(SINE).result();
    let friction = number(&asperity(&format!("{SINE} --json")).json(), "friction_coefficient");
    assert!(table.contains(&format!("{friction:.6}")), "{table}");
    assert!(table.contains("32 x "), "{table}");
}

#[test]
fn an_area_is_found_and_fields_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let fields = folder.path().join("fields.csv");
    let arguments =
        "solve fem --wave 0.0625:0.005 --speed 10 --area 0.2 --columns 32 --json --fields {}";
    let result = asperity_at(arguments, &fields).json();
    assert!((number(&result, "contact_area_fraction") - 0.2).abs() < 1e-4);
    let text = fs::read_to_string(&fields).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("x_mm,height_mm,pressure_mpa,separation_mm"));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 32);
    assert!(rows.iter().all(|row| row[2] >= 0.0 && (row[2] == 0.0) == (row[3] > 1e-9)));
}

#[test]
fn the_transient_route_writes_its_series() {
    let folder = tempfile::tempdir().unwrap();
    let series = folder.path().join("drag.csv");
    let arguments = "solve fem --wave 0.0625:0.005 --speed 1 --pressure 0.3 --columns 16 --route transient \
                     --drag-periods 2 --json --series {}";
    let result = asperity_at(arguments, &series).json();
    assert!(number(&result, "friction_oscillation") > 0.0);
    let text = fs::read_to_string(&series).unwrap();
    let last = text.lines().last().unwrap();
    let displacement: f64 = last.split(',').nth(2).unwrap().parse().unwrap();
    assert!((displacement - 0.125).abs() < 1e-9, "{last}");
}

#[test]
fn the_end_of_a_path_is_an_error_with_the_last_point() {
    let error = asperity(
        "solve fem --wave 0.0625:0.01867 --speed 10 --pressure 3 --columns 16 --rheology linear",
    )
    .error(1);
    assert!(error.contains("no finite-deformation solution at 3.0000 MPa"), "{error}");
    assert!(error.contains("the path ended at ") && error.contains("friction is"), "{error}");
    assert!(error.contains("try other --columns, or a pressure below that"), "{error}");
    let area =
        "solve fem --wave 0.0625:0.01867 --speed 10 --area 0.9 --columns 16 --rheology linear";
    let error = asperity(area).error(1);
    assert!(error.starts_with("error: --area 0.9: no finite-deformation solution"), "{error}");
}

#[test]
fn a_profile_that_is_not_resolved_is_refused_or_warned_of() {
    let two = "solve fem --wave 0.5:0.01 --wave 0.0625:0.005 --speed 10 --pressure 0.1 --columns";
    let error = asperity(&format!("{two} 32")).error(2);
    assert!(error.contains("32 columns are 4.0 on the shortest wave"), "{error}");
    assert!(error.contains("--columns 64 at least, better 512"), "{error}");
    let few = asperity(&format!("{two} 96 --json"));
    assert_eq!(few.code, 0);
    assert!(few.stderr.starts_with("warning: 12.0 columns on the shortest wave"), "{}", few.stderr);
    // The short wave has no slope that matters.
    let gentle =
        "solve fem --wave 0.5:0.01 --wave 0.0625:1e-6 --speed 10 --pressure 0.1 --columns 64";
    asperity(gentle).result();

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("profile.txt");
    let profile = "solve fem --profile {} --profile-unit mm --speed 10 --pressure 0.1 --columns 64";
    fs::write(&path, "0 0.1\n1 0.2\n2 0.1\n").unwrap();
    let error = asperity_at(profile, &path).error(2);
    assert!(error.contains("has 3 points, a profile needs 8 or more"), "{error}");
    let zigzag = |i: usize| f64::from(u8::from(i.is_multiple_of(2)));
    let height = |i: usize| 0.1 * zigzag(i / 3 + i) + 1e-3 * i as f64;
    let lines: String = (0..16).map(|i| format!("{i} {}\n", height(i))).collect();
    fs::write(&path, lines).unwrap();
    let error = asperity_at(profile, &path).error(2);
    assert!(error.contains("not resolved by its 16 points"), "{error}");
}

#[test]
fn a_period_too_long_to_be_meant_is_not_solved_unasked() {
    let error =
        asperity("solve fem --wave 0.0625:0.01 --wave 0.0626:0.01 --speed 10 --pressure 0.1")
            .error(2);
    for part in ["39.1250 mm", "626 of the shortest waves", "are 40064", "--columns N"] {
        assert!(error.contains(part), "{part}: {error}");
    }
}

#[test]
fn both_routes_warn_of_a_coarse_mesh_with_figures() {
    for arguments in [
        "--wave 0.0625:0.01867 --speed 10000 --pressure 1 --columns 128",
        "--wave 0.0625:0.005 --speed 10 --pressure 0.3 --columns 16 --route transient --drag-periods 4",
    ] {
        let outcome = asperity(&format!("solve fem {arguments} --json"));
        assert_eq!(outcome.code, 0);
        let result: Value = serde_json::from_str(&outcome.stdout).unwrap();
        for key in ["friction_coefficient", "hysteretic_friction"] {
            let figure = number(&result, key).to_string();
            assert!(outcome.stderr.contains(&figure[..6]), "{figure}: {}", outcome.stderr);
        }
        assert!(outcome.stderr.contains("give more --columns"), "{}", outcome.stderr);
    }
}

#[test]
fn a_drag_that_stops_says_where_in_the_units_of_the_options() {
    let error = asperity(
        "solve fem --wave 0.0625:0.02 --speed 10 --pressure 20 --route transient --columns 16",
    )
    .error(1);
    assert!(error.contains(" MPa, 0.000000 mm dragged)"), "{error}");
    assert!(error.contains("use more columns or a smaller pressure"), "{error}");
}

#[test]
fn the_file_of_a_bad_rubber_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rubber.toml");
    fs::write(&path, "name = 'tread'\nequilibrium_modulus_mpa = 4.0\npoisson_ratio = 0.5\n")
        .unwrap();
    let error = asperity_at(&format!("{SINE} --rubber {{}}"), &path).error(2);
    assert!(error.contains("rubber.toml: ") && error.contains("poisson_ratio is 0.5"), "{error}");
}

#[test]
fn contradictions_are_named() {
    for (arguments, message) in [
        ("--points 64", "give --columns"),
        ("--series drag.csv", "--series needs --route transient"),
        ("--drag-periods 12", "--drag-periods needs --route transient"),
        ("--flow-rule trapezoidal", "--flow-rule needs --route transient"),
        ("--route transient --drag-periods 0", "--drag-periods is 0: give at least 1"),
        ("--route transient --fields f.csv", "--fields are those of the steady route"),
        ("--columns 4", "the number of columns is 4"),
        ("--height 0.01", "the height of the block in periods is 0.01"),
        ("--modulus 4 --poisson 0.5", "poisson_ratio is 0.5"),
    ] {
        let error = asperity(&format!(
            "solve fem --wave 0.0625:0.005 --speed 10 --pressure 0.3 {arguments}"
        ))
        .error(2);
        assert!(error.contains(message), "{arguments}: {error}");
    }
    let error =
        asperity("solve fem --wave 0.0625:0.005 --speed 10 --area 0.1 --route transient").error(2);
    assert!(error.contains("--area is found by the steady route"), "{error}");
}

/// A slight slope, so that local friction and hysteresis nearly add up.
#[test]
fn local_friction_and_a_shear_stress_are_part_of_the_friction() {
    let without = asperity(&format!("{SINE} --json")).json();
    assert!(without.get("interface_friction").is_none());
    let with = asperity(&format!("{SINE} --local-friction 0.3 --json")).json();
    let [friction, heat, shear] =
        ["friction_coefficient", "hysteretic_friction", "interface_friction"]
            .map(|key| number(&with, key));
    assert!((heat + shear - friction).abs() < 0.02 * friction, "{heat} {shear} {friction}");
    assert!(friction > number(&without, "friction_coefficient") + 0.3, "{friction}");
    let table = asperity(&format!("{SINE} --shear-mpa 1")).result();
    assert!(table.contains("from the shear of the contact"), "{table}");
    let both = asperity(&format!("{SINE} --shear-mpa 1 --local-friction 0.3")).error(2);
    assert!(both.contains("cannot be used with"), "{both}");
    let transient = asperity(&format!("{SINE} --shear-mpa 1 --route transient")).error(2);
    assert!(transient.contains("--shear-mpa is for the steady route only"), "{transient}");
}
