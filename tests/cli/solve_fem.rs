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
        "solve fem --wave 0.0625:0.01867 --speed 10 --pressure 20 --columns 32 --rheology linear",
    )
    .error(1);
    assert!(error.contains("no finite-deformation solution at 20.0000 MPa"), "{error}");
    assert!(error.contains("the path ended at 0.") && error.contains("friction is"), "{error}");
}

#[test]
fn contradictions_are_named() {
    for (arguments, message) in [
        ("--points 64", "give --columns"),
        ("--series drag.csv", "--series needs --route transient"),
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
