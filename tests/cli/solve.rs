//! `asperity solve bem`.

use std::f64::consts::{PI, TAU};
use std::fs;

use super::{asperity, asperity_at, project};
use asperity::rubber::Rubber;
use serde_json::Value;

const TABLE_5_3: &str = "solve bem --wave 0.0625:0.01867 --speed 10 --pressure 3.30858";
/// One sine with E/(1-nu^2) = 4 MPa, so that full contact needs p* = pi 4 MPa 0.01 / 1.
const ELASTIC: &str =
    "solve bem --wave 1:0.01 --speed 10 --modulus 3 --poisson 0.5 --points 4096 --json";
const ELASTIC_FULL_MPA: f64 = PI * 4.0 * 0.01;

fn number(result: &Value, key: &str) -> f64 {
    result[key].as_f64().unwrap()
}

#[test]
fn one_sine_has_the_published_friction() {
    let result = asperity(&format!("{TABLE_5_3} --points 4096 --json")).json();
    // Column friction_bem of Table 5.3, which its own grid determines to 5e-4.
    assert!((number(&result, "friction_coefficient") - 0.66455).abs() < 5e-4, "{result}");
    let mut keys: Vec<&str> = result.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    let expected = [
        "contact_area_fraction",
        "error_estimate",
        "friction_coefficient",
        "grid_points",
        "iterations",
        "mean_separation_mm",
        "pressure_mpa",
        "residual",
        "seconds",
    ];
    assert_eq!(keys, expected);
    assert_eq!(result["grid_points"], 4096);
    assert!(result["iterations"].as_u64().unwrap() > 0);
    assert!((number(&result, "pressure_mpa") - 3.30858).abs() < 1e-14);
    assert!(number(&result, "residual") < 1e-10);
    assert!(number(&result, "seconds") > 0.0);
}

#[test]
fn the_table_has_units_and_the_figures_of_the_json() {
    let table = asperity(TABLE_5_3).result();
    let result = asperity(&format!("{TABLE_5_3} --json")).json();
    let friction = format!("{:.6}", number(&result, "friction_coefficient"));
    let line = |start: &str| table.lines().find(|line| line.starts_with(start)).unwrap().to_owned();
    assert!(line("friction coefficient").ends_with(&friction), "{table}");
    assert!(line("mean pressure").ends_with("3.30858 MPa"), "{table}");
    assert!(line("mean separation").ends_with(" mm"), "{table}");
    assert!(line("grid points").ends_with(" 1024"), "{table}");
}

#[test]
fn the_default_rubber_is_the_file_of_table_2_1() {
    let file = project("data/rubber/table_2_1.toml");
    let read = asperity_at(&format!("{TABLE_5_3} --json --rubber {{}}"), &file).json();
    let default = asperity(&format!("{TABLE_5_3} --json")).json();
    for key in ["friction_coefficient", "contact_area_fraction", "mean_separation_mm"] {
        assert_eq!(read[key], default[key]);
    }
}

#[test]
fn an_elastic_half_space_follows_westergaard() {
    let pressure = ELASTIC_FULL_MPA / 4.0;
    let result = asperity(&format!("{ELASTIC} --pressure {pressure}")).json();
    // (2/pi) asin(sqrt(1/4)) = 1/3; 4096 points resolve the edges to a fraction of a cell.
    let error = number(&result, "contact_area_fraction") - 1.0 / 3.0;
    assert!(error.abs() < 1.0 / 4096.0, "{error:e}");
    assert!(number(&result, "friction_coefficient").abs() < 1e-10, "{result}");
}

#[test]
fn the_pressure_for_an_area_follows_westergaard() {
    let result = asperity(&format!("{ELASTIC} --area 0.05")).json();
    assert!((number(&result, "contact_area_fraction") - 0.05).abs() < 1e-6, "{result}");
    let exact = ELASTIC_FULL_MPA * (PI / 2.0 * 0.05).sin().powi(2);
    // p ~ A^2 and the edges are read to a fraction of a cell of 1/205 of the area.
    assert!((number(&result, "pressure_mpa") / exact - 1.0).abs() < 2.0 / 205.0, "{result}");
}

#[test]
fn full_contact_has_the_exact_friction() {
    let result = asperity("solve bem --wave 0.5:0.01:2 --speed 10 --pressure 80 --json").json();
    assert_eq!(number(&result, "contact_area_fraction"), 1.0);
    let (wavenumber, amplitude) = (TAU / 0.5e-3, 0.01e-3);
    let loss = Rubber::table_2_1().reduced_modulus(wavenumber * 0.01).im;
    let exact = (wavenumber * amplitude).powi(2) * loss / (4.0 * 80e6);
    let relative = number(&result, "friction_coefficient") / exact - 1.0;
    // Rounding: the sums are exact for one sine on any grid that resolves it.
    assert!(relative.abs() < 1e-9, "{relative:e}");
}

#[test]
fn a_profile_is_solved_as_the_waves_it_was_sampled_from() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("profile.csv");
    let points = 1024;
    let line = |i: usize| {
        let x = i as f64 / points as f64;
        format!("{}; {}\n", 62.5 * x, 18.67 * (TAU * x).sin())
    };
    let text: String = (0..points).map(line).collect();
    fs::write(&path, format!("# x in um; z in um\n{text}")).unwrap();
    let solve = "solve bem --profile {} --profile-unit um --speed 10 --pressure 3.30858 --json";
    let profile = asperity_at(solve, &path).json();
    let waves = asperity(&format!("{TABLE_5_3} --json")).json();
    for key in ["friction_coefficient", "contact_area_fraction", "mean_separation_mm"] {
        // Rounding of the heights, amplified by the slope of the edges.
        let relative = number(&profile, key) / number(&waves, key) - 1.0;
        assert!(relative.abs() < 1e-9, "{key}: {relative:e}");
    }
    let other = asperity_at(&format!("{solve} --points 512"), &path).error(2);
    assert!(other.contains("has 1024 points"), "{other}");
    let unit = "solve bem --profile {} --speed 10 --pressure 3.3";
    assert!(asperity_at(unit, &path).error(2).contains("--profile-unit"));
}

#[test]
fn fields_add_up_to_the_result() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fields.csv");
    fs::write(&path, "of another solve").unwrap();
    let refused = asperity_at(&format!("{TABLE_5_3} --json --fields {{}}"), &path).error(2);
    assert!(refused.contains("fields.csv exists already"), "{refused}");
    assert_eq!(fs::read(&path).unwrap(), b"of another solve");
    let result = asperity_at(&format!("{TABLE_5_3} --json --force --fields {{}}"), &path).json();
    let mut reader = csv::Reader::from_path(&path).unwrap();
    assert_eq!(
        reader.headers().unwrap(),
        vec!["x_mm", "height_mm", "pressure_mpa", "separation_mm"]
    );
    let rows: Vec<[f64; 4]> = reader.deserialize().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 1024);
    let mean = |column: usize| rows.iter().map(|row| row[column]).sum::<f64>() / 1024.0;
    assert!((mean(2) / 3.30858 - 1.0).abs() < 1e-9);
    // Heights and displacements have no mean, so the gap's mean is the mean separation.
    assert!((mean(3) / number(&result, "mean_separation_mm") - 1.0).abs() < 1e-9);
    let highest = rows.iter().map(|row| row[1]).fold(0.0, f64::max);
    assert!((highest / 0.01867 - 1.0).abs() < 1e-12);
    assert!(rows.iter().all(|row| row[2] == 0.0 || row[3].abs() < 1e-12));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn fields_never_replace_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rubber.toml");
    fs::copy(project("data/rubber/table_2_1.toml"), &path).unwrap();
    let error = asperity_at(&format!("{TABLE_5_3} --rubber {{}} --fields {{}}"), &path).error(2);
    assert!(error.contains("would overwrite the input"), "{error}");
    assert!(fs::read_to_string(&path).unwrap().contains("Table 2.1"));
}

#[test]
fn the_grid_follows_from_the_accuracy_that_is_asked_for() {
    let solve = |rest: &str| asperity(&format!("{TABLE_5_3} {rest} --json")).json();
    let truth = number(&solve("--points 262144"), "friction_coefficient");
    let mut coarser = 0;
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let result = solve(&format!("--tolerance {tolerance}"));
        let friction = number(&result, "friction_coefficient");
        let estimate = result["error_estimate"]["total"].as_f64().unwrap();
        assert!(estimate <= tolerance * friction, "{result}");
        assert!((friction - truth).abs() <= estimate, "{result} {truth}");
        let points = result["grid_points"].as_u64().unwrap();
        assert!(points > coarser);
        coarser = points;
    }
    for (rest, part) in [
        ("--tolerance 0", "between 1e-8 and 0.5"),
        ("--tolerance 1e-3 --points 512", "cannot be used with"),
    ] {
        assert!(asperity(&format!("{TABLE_5_3} {rest}")).error(2).contains(part), "{rest}");
    }
}

#[test]
fn unresolved_spots_are_warned_of_on_standard_error_only() {
    let solve = "solve bem --wave 0.0625:0.01867 --speed 10 --pressure 1e-4 --points 64 --json";
    let outcome = asperity(solve);
    assert_eq!(outcome.code, 0);
    assert!(outcome.stderr.starts_with("warning: a contact spot is 1.00000 grid points wide"));
    assert!(serde_json::from_str::<Value>(&outcome.stdout).is_ok());
    asperity(&format!("--quiet {solve}")).result();
    asperity(&format!("{solve} --quiet")).result();
}

#[test]
fn bad_options_are_named_with_exit_code_2() {
    let rest = "--speed 10 --pressure 1";
    let load = "solve bem --wave 1:0.01";
    let cases = [
        ("solve bem".to_owned(), "--speed <MM_S>"),
        (format!("solve bem {rest}"), "--wave"),
        (format!("solve bem --wave 0.0625 {rest}"), "such as 0.0625:0.01867"),
        (format!("solve bem --wave a:b {rest}"), "`a` is not a number"),
        (format!("solve bem --wave 0:1 {rest}"), "0 is not positive"),
        (format!("solve bem --wave -1:1 {rest}"), "-1 is not positive"),
        (format!("solve bem --wave 1:NaN {rest}"), "not a finite number"),
        (format!("solve bem --wave 1:1 --wave 1.41421356:1 {rest}"), "no common period"),
        (format!("solve bem --wave 1:1 --profile x --profile-unit mm {rest}"), "cannot be used"),
        (format!("solve bem --wave 1:1 --profile-unit mm {rest}"), "cannot be used"),
        (format!("solve bem --profile no/such --profile-unit mm {rest}"), "no/such"),
        (format!("{load} --speed 10"), "--pressure <MPA>|--area <FRACTION>"),
        (format!("{load} {rest} --area 0.1"), "cannot be used with"),
        (format!("{load} --speed 0 --pressure 1"), "0 is not positive"),
        (format!("{load} --speed -10 --pressure 1"), "-10 is not positive"),
        (format!("{load} --speed 10 --pressure NaN"), "`NaN` is not a finite number"),
        (format!("{load} --speed 10 --pressure -1"), "-1 is not positive"),
        (format!("{load} --speed 10 --pressure 3,3"), "the decimal mark is a point"),
        (format!("{load} --speed 10 --area 5"), "5 % is 0.05"),
        (format!("{load} --speed 10 --area 0"), "between 0 and 1"),
        ("solve bem --wave 1:0 --speed 10 --area 0.1".to_owned(), "the profile is flat"),
        (format!("{load} {rest} --modulus 3"), "--poisson <NU>"),
        (format!("{load} {rest} --poisson 0.5"), "--modulus <MPA>"),
        (format!("{load} {rest} --modulus 3 --poisson 0.6"), "poisson_ratio is 0.6"),
        (format!("{load} {rest} --modulus 3 --poisson 0.5 --rubber x"), "cannot be used"),
        (format!("{load} {rest} --rubber no/such.toml"), "no/such.toml"),
        (format!("{load} {rest} --points 7"), "from 8 to 16777216"),
        (format!("{load} {rest} --points -7"), "is not a whole number"),
        (format!("{load} --wave 100:1 {rest} --points 256"), "at least 300, better 6400"),
    ];
    for (arguments, part) in cases {
        let error = asperity(&arguments).error(2);
        assert!(error.contains(part), "{arguments}: {error}");
    }
}

#[test]
fn a_bad_rubber_is_named_by_file_line_and_key() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rubber.toml");
    fs::write(&path, "name = 'tread'\nmodulus_mpa = 3\n").unwrap();
    let error = asperity_at(&format!("{TABLE_5_3} --rubber {{}}"), &path).error(2);
    for part in ["rubber.toml, line 2", "unknown key `modulus_mpa`"] {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn what_cannot_be_solved_has_exit_code_1_and_a_missing_folder_2() {
    // Heights of 1e297 m leave no digit for the pressure, and one point of any grid to carry it.
    let huge = "solve bem --wave 1:1e300 --speed 10 --pressure 1 --json";
    let refined = asperity(huge).error(1);
    assert!(refined.contains("no three grids resolve the contact"), "{refined}");
    let fixed = asperity(&format!("{huge} --points 64")).error(1);
    assert!(fixed.contains("did not converge"), "{fixed}");
    let folder = asperity(&format!("{TABLE_5_3} --fields no/such/folder/fields.csv")).error(2);
    assert!(folder.contains("cannot write no/such/folder/fields.csv"), "{folder}");
}
