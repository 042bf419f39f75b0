//! `asperity theory persson`.

use std::fs;
use std::path::Path;

use super::{Outcome, binary, project};
use approx::assert_relative_eq;
use serde_json::Value;

/// C = 1e-14 m4 (q / 1e3 rad/m)^-3.6 from 1e3 to 1e5 rad/m, H = 0.8.
const SPECTRUM: &str =
    "# q in rad/m, C in m4\n1e3 1e-14\n1e4 2.5118864315095823e-18\n1e5 6.309573444801943e-22\n";
const LOAD: &str = "--pressure 0.3 --speed 10";
const UNITS: &str = "--wavenumber-unit rad/m --density-unit m4";

fn theory(folder: &Path, arguments: &str) -> Outcome {
    let arguments = arguments.split_whitespace();
    Outcome::of(binary().current_dir(folder).args(["theory", "persson"]).args(arguments))
}

fn with_spectrum(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("road.txt"), text).unwrap();
    folder
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap()
}

#[test]
fn table_json_and_csv_have_the_same_figures() {
    let folder = with_spectrum(SPECTRUM);
    let command = format!("--spectrum road.txt {UNITS} --pressure 0.1,0.3 --speed 1,10:1000:1");
    let json = theory(folder.path(), &format!("{command} --json --to out.csv")).json();
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * 4);
    let table = theory(folder.path(), &command).result();
    let friction = format!("{:.6}", number(&rows[7], "friction_coefficient"));
    assert!(table.lines().last().unwrap().contains(&friction[..7]), "{table}");
    assert!(table.contains("gamma = 0.5") && table.contains("rms height"), "{table}");
    let csv = fs::read_to_string(folder.path().join("out.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + rows.len());
    // 2 pi C integrated: 1e-14 1e6 (1 - 100^-1.6) / 1.6 over q.
    let height = (std::f64::consts::TAU * 1e-8 * (1.0 - 100_f64.powf(-1.6)) / 1.6).sqrt();
    assert_relative_eq!(
        number(&json["surface"], "rms_height_mm"),
        1e3 * height,
        max_relative = 1e-9
    );
    for row in rows {
        let error = number(row, "friction_coefficient_error");
        assert!(error <= 1e-6 * number(row, "friction_coefficient"), "{row}");
    }
    // An output is not overwritten unasked, an input never.
    let again = theory(folder.path(), &format!("{command} --to out.csv"));
    assert!(again.error(2).contains("exists already"));
    let over = theory(folder.path(), &format!("{command} --to road.txt --force"));
    assert!(over.error(2).contains("would overwrite the input"));
}

#[test]
fn units_and_dimensions_of_one_surface_agree() {
    let folder = with_spectrum(SPECTRUM);
    let json = |file: &str, units: &str| {
        let command = format!("--spectrum {file} {units} {LOAD} --json");
        theory(folder.path(), &command).json()["rows"][0].clone()
    };
    let reference = json("road.txt", UNITS);
    let write = |name: &str, q: &dyn Fn(f64) -> f64, c: &dyn Fn(f64, f64) -> f64| {
        let points = (0..=120).map(|k| {
            let at = 1e3 * 1e2_f64.powf(f64::from(k) / 120.0);
            let density = 1e-14 * (at / 1e3_f64).powf(-3.6);
            format!("{:e} {:e}\n", q(at), c(at, density))
        });
        fs::write(folder.path().join(name), points.collect::<String>()).unwrap();
    };
    let tau = std::f64::consts::TAU;
    write("um.txt", &|q| q / 1e6, &|_, c| c * 1e24);
    write("counted.txt", &|q| q / tau, &|_, c| c * tau * tau);
    for (file, units) in [
        ("um.txt", "--wavenumber-unit rad/um --density-unit um4"),
        ("counted.txt", "--wavenumber-unit 1/m --density-unit m4"),
    ] {
        for key in ["friction_coefficient", "contact_area_fraction", "mean_gap_mm"] {
            let found = number(&json(file, units), key);
            assert_relative_eq!(found, number(&reference, key), max_relative = 1e-5);
        }
    }
    // The line of a power law without end: C1 = 2 q C sqrt(pi) G(H + 1/2) / G(H + 1), H = 0.8.
    let gamma = statrs::function::gamma::gamma;
    let line = 2.0 * std::f64::consts::PI.sqrt() * gamma(1.3) / gamma(1.8);
    write("line.txt", &|q| q / 1e3, &|q, c| 1e9 * line * q * c);
    write("both.txt", &|q| q / 1e3, &|q, c| 0.5e9 * line * q * c);
    let units = "--wavenumber-unit rad/mm --density-unit mm3";
    for (file, sides) in [("line.txt", ""), ("both.txt", " --sides two")] {
        let found = json(file, &format!("{units}{sides}"));
        let friction = number(&found, "friction_coefficient");
        // The Abel inverse by Gauss' rule on 60 points a decade.
        let expected = number(&reference, "friction_coefficient");
        assert_relative_eq!(friction, expected, max_relative = 1e-5);
    }
}

#[test]
fn magnifications_end_with_all_waves_and_wavelengths_cut() {
    let folder = with_spectrum(SPECTRUM);
    let command = format!("--spectrum road.txt {UNITS} {LOAD} --json");
    let all = theory(folder.path(), &format!("{command} --magnifications-per-decade 3")).json();
    let rows = all["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 6);
    assert!(rows.windows(2).all(|pair| {
        number(&pair[0], "friction_coefficient") < number(&pair[1], "friction_coefficient")
            && number(&pair[0], "contact_area_fraction") > number(&pair[1], "contact_area_fraction")
    }));
    // Waves up to ten times the first wavenumber: 2 pi / 1e4 m.
    let shortest = 0.2 * std::f64::consts::PI;
    let cut = theory(folder.path(), &format!("{command} --shortest-wavelength-mm {shortest}"));
    let cut = &cut.json()["rows"][0];
    for key in ["friction_coefficient", "rms_gradient"] {
        assert_relative_eq!(number(cut, key), number(&rows[2], key), max_relative = 1e-6);
    }
}

#[test]
fn heat_is_given_beside_the_prediction_without() {
    let folder = with_spectrum(SPECTRUM);
    let rubber = project("data/rubber/example_wlf.toml");
    let command = format!(
        "--spectrum road.txt {UNITS} --pressure 0.3 --speed 1,1000 --rubber {} --temperature-c 20 --quiet",
        rubber.display()
    );
    let flash = format!("{command} --flash --contact-diameter-mm 2");
    let json = theory(folder.path(), &format!("{flash} --json --to hot.csv")).json();
    let (rows, hot) = (&json["rows"], &json["flash"]);
    assert_eq!(hot.as_array().unwrap().len(), 2);
    assert!(number(&hot[0], "rise_k") < 1.0);
    assert!(number(&hot[1], "rise_k") > number(&hot[0], "rise_k"));
    let area = |value: &Value| number(value, "contact_area_fraction");
    assert!(area(&hot[1]) > area(&rows[1]));
    let csv = fs::read_to_string(folder.path().join("hot.csv")).unwrap();
    let columns = |line: &str| line.split(',').count();
    assert!(csv.lines().all(|line| columns(line) == 22), "{csv}");
    // Each row has the cold values beside the hot ones.
    let text = theory(folder.path(), &format!("{flash} --magnifications-per-decade 1")).result();
    let (_, table) = text.split_once("rise / K\n").unwrap();
    for (k, line) in table.lines().enumerate() {
        let cells: Vec<f64> = line.split_whitespace().map(|cell| cell.parse().unwrap()).collect();
        for (at, column) in
            [(0, "speed_mm_s"), (2, "contact_area_fraction"), (4, "friction_coefficient")]
        {
            assert_relative_eq!(cells[at], number(&rows[k], column), max_relative = 1e-5);
        }
        for (at, column) in [(3, "contact_area_fraction"), (5, "friction_coefficient")] {
            assert_relative_eq!(cells[at], number(&hot[k], column), max_relative = 1e-5);
        }
    }
    assert_eq!(table.lines().count(), 2);
    // Table 2.1 has no law of temperature.
    let cold = format!("--spectrum road.txt {UNITS} {LOAD} --flash --contact-diameter-mm 2");
    assert!(theory(folder.path(), &cold).error(2).contains("no [temperature] section"));
}

#[test]
fn a_scan_and_a_map_are_surfaces_too() {
    let folder = tempfile::tempdir().unwrap();
    // Heights in um on 6.4 by 6.4 mm: waves in many directions, each with half the amplitude of the one before.
    let height = |i: u32, j: u32| -> f64 {
        let wave = |k: u32| {
            let (m, n) = (f64::from(3 + 2 * k), f64::from(5 * k % 7) - 3.0);
            let turns = (m * f64::from(i) + n * f64::from(j)) / 64.0;
            100.0 * 0.5_f64.powi(k as i32) * (std::f64::consts::TAU * turns + f64::from(k)).cos()
        };
        (0..8).map(wave).sum()
    };
    let row = |j: u32| (0..64).map(|i| format!("{:.6} ", height(i, j))).collect::<String>() + "\n";
    fs::write(folder.path().join("map.txt"), (0..64).map(row).collect::<String>()).unwrap();
    let command = format!("--map map.txt --map-unit um --size-mm 6.4 {LOAD} --json --quiet");
    let map = theory(folder.path(), &command).json();
    // Maps with missing heights are refused, as by `solve areal`.
    let gaps = project("data/scans/map/road.x3p");
    let message = theory(folder.path(), &format!("--map {} {LOAD}", gaps.display())).error(2);
    assert!(message.contains("heights are missing"), "{message}");
    let scan = project("data/scans/specimen/scan_01.txt");
    let text =
        "--separator semicolon --comment # --x-column x_mm --x-unit mm --z-column z_um --z-unit um";
    let command = format!(
        "--scan {} {text} {LOAD} --shortest-wavelength-mm 0.25 --json --quiet",
        scan.display()
    );
    let scan = theory(folder.path(), &command).json();
    for found in [map, scan] {
        let row = &found["rows"][0];
        let (area, friction) =
            (number(row, "contact_area_fraction"), number(row, "friction_coefficient"));
        assert!(area > 0.0 && area < 1.0 && friction > 0.0 && friction < 10.0, "{row}");
        assert!(number(row, "rms_height_mm") > 0.01, "{row}");
    }
}

#[test]
fn mistakes_say_what_to_do() {
    let folder = with_spectrum(SPECTRUM);
    for (arguments, part) in [
        (format!("--spectrum road.txt {LOAD}"), "--wavenumber-unit"),
        (format!("{UNITS} {LOAD}"), "--spectrum"),
        (
            format!("--spectrum road.txt --wavenumber-unit m --density-unit m4 {LOAD}"),
            "choose rad/m",
        ),
        (format!("--spectrum road.txt {UNITS} --sides two {LOAD}"), "leave --sides out"),
        (format!("--spectrum road.txt {UNITS} {LOAD} --gamma 2"), "not from 0 to 1"),
        (
            format!("--spectrum road.txt {UNITS} {LOAD} --shortest-wavelength-mm 0.001"),
            "stay within them",
        ),
        (format!("--spectrum none.txt {UNITS} {LOAD}"), "none.txt: cannot be read"),
        (format!("--spectrum road.txt {UNITS} --pressure 0.3 --speed 0"), "not positive"),
        (format!("--spectrum road.txt {UNITS} {LOAD} --separator tab"), "--separator describes"),
    ] {
        let message = theory(folder.path(), &arguments).error(2);
        assert!(message.contains(part), "{arguments}: {message}");
    }
    // A unit of a thousandth is seen by the roughness.
    let wrong =
        "--spectrum road.txt --wavenumber-unit rad/mm --density-unit m4 --pressure 30 --speed 10";
    let outcome = theory(folder.path(), wrong);
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    assert!(outcome.stderr.contains("steeper than any road"), "{}", outcome.stderr);
}
