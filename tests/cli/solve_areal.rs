//! `asperity solve areal`.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::fs;

use super::{asperity, asperity_at};
use serde_json::Value;

fn number(result: &Value, key: &str) -> f64 {
    result[key].as_f64().unwrap()
}

/// Modulus over `1 - nu²` of 4 MPa.
const ELASTIC: &str = "--modulus 3 --poisson 0.5";

#[test]
fn a_surface_of_parallel_crests_is_a_line() {
    let areal = asperity(
        "solve areal --size-mm 1,0.25 --mode 1,0:0.01 --mode 3,0:0.002:0.7 --speed 10 --pressure 0.05 --points 256,64 --json",
    )
    .json();
    let line = asperity(
        "solve bem --wave 1:0.01 --wave 0.3333333333333333:0.002:0.7 --speed 10 --pressure 0.05 --points 256 --json",
    )
    .json();
    for key in ["friction_coefficient", "mean_separation_mm"] {
        approx::assert_relative_eq!(number(&areal, key), number(&line, key), max_relative = 1e-9);
    }
    assert!(number(&areal, "contact_area_fraction") < 0.9);
    assert!(number(&areal, "lateral_coefficient").abs() < 1e-12);
    assert!(number(&areal, "residual") < 1e-10);
    assert_eq!((&areal["points_x"], &areal["points_y"]), (&256.into(), &64.into()));
    assert_eq!(areal["grid_points"], 16384);
    let keys = line.as_object().unwrap().keys();
    // A reader of `solve bem` reads this too.
    assert!(keys.into_iter().all(|key| areal.get(key).is_some()), "{areal}");
}

#[test]
fn full_contact_has_the_friction_of_its_formula_at_any_angle() {
    // Three periods on 2 mm along x, one on 1 mm along y: mu p = q_s |q| D² E''(q_s v) / (4 (1 - nu²)).
    let rubber = asperity::rubber::Rubber::table_2_1();
    let (wavenumber_x, wavenumber_y, amplitude) = (TAU * 3.0 / 2e-3, TAU / 1e-3, 1e-6_f64);
    let wavenumber = wavenumber_x.hypot(wavenumber_y);
    for angle in [0.0, 25.0, 90.0, -140.0_f64] {
        let along =
            wavenumber_x * angle.to_radians().cos() + wavenumber_y * angle.to_radians().sin();
        let result = asperity(&format!(
            "solve areal --size-mm 2,1 --mode 3,1:0.001 --speed 10 --angle {angle} --pressure 5 --points 512 --json"
        ))
        .json();
        let loss = rubber.complex_modulus(along.abs() * 0.01).im * along.signum();
        let nu = rubber.poisson_ratio;
        let expected =
            along * wavenumber * amplitude.powi(2) * loss / (4.0 * (1.0 - nu * nu) * 5e6);
        let found = number(&result, "friction_coefficient");
        // Slopes are differences of the fourth order, on 170 points a wave.
        approx::assert_relative_eq!(found, expected, max_relative = 1e-7);
        assert_eq!(number(&result, "contact_area_fraction"), 1.0);
    }
}

#[test]
fn a_bisinusoid_closes_at_the_pressure_of_johnson() {
    // Each wave has the pressure pi E_r D / lambda in full contact, and both add: sqrt 2 pi E_r D' / lambda' for the same
    // surface turned by 45 degrees, D' cos x cos y with D' = 2 D and lambda' = sqrt 2 lambda (doi:10.1016/0020-7403(85)90105-0).
    let full = 2.0 * PI * 4.0 * 0.005;
    let solve = |pressure: f64| {
        asperity(&format!(
            "solve areal --size-mm 1 --mode 1,0:0.005 --mode 0,1:0.005 --speed 10 --pressure {pressure} --points 64 {ELASTIC} --json"
        ))
        .json()
    };
    assert_eq!(number(&solve(1.001 * full), "contact_area_fraction"), 1.0);
    let below = solve(0.98 * full);
    let area = number(&below, "contact_area_fraction");
    assert!(area < 1.0 && area > 0.9, "{area}");
    assert!(number(&below, "friction_coefficient").abs() < 1e-10);
}

#[test]
fn an_area_has_its_pressure_and_a_layer_is_stiffer() {
    let base = "solve areal --size-mm 1 --mode 2,1:0.004 --mode 1,-2:0.003 --speed 10 --points 64 --quiet --json";
    let found = asperity(&format!("{base} --area 0.2")).json();
    approx::assert_relative_eq!(number(&found, "contact_area_fraction"), 0.2, max_relative = 1e-6);
    let pressure = number(&found, "pressure_mpa");
    let again = asperity(&format!("{base} --pressure {pressure}")).json();
    approx::assert_relative_eq!(number(&again, "contact_area_fraction"), 0.2, max_relative = 1e-5);
    // A layer of a tenth of the wavelength is much stiffer, one of ten wavelengths is a half-space.
    let thin = asperity(&format!("{base} --pressure {pressure} --thickness-mm 0.04")).json();
    assert!(number(&thin, "contact_area_fraction") < 0.18);
    let thick = asperity(&format!("{base} --pressure {pressure} --thickness-mm 10")).json();
    approx::assert_relative_eq!(number(&thick, "contact_area_fraction"), 0.2, max_relative = 1e-5);
}

/// Heights in um of two waves on 48 by 32 points over 1.2 by 0.8 mm.
fn heights() -> Vec<Vec<f64>> {
    let height = |j: u32, i: u32| {
        let (x, y) = (f64::from(i) / 48.0, f64::from(j) / 32.0);
        4.0 * (TAU * (2.0 * x + y)).sin() + 2.0 * (TAU * (x - y) + 0.4).sin()
    };
    (0..32).map(|j| (0..48).map(|i| height(j, i)).collect()).collect()
}

#[test]
fn modes_and_maps_of_all_sorts_are_the_same_surface() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (mut rows, mut points) = (String::new(), String::from("# x y z\n"));
    for (j, row) in heights().iter().enumerate() {
        let cells: Vec<String> = row.iter().map(|z| format!("{z:.12}")).collect();
        writeln!(rows, "{}", cells.join("\t")).unwrap();
        for (i, z) in row.iter().enumerate() {
            writeln!(points, "{}, {}, {z:.12}", 25 * i, 25 * j).unwrap();
        }
    }
    fs::write(path("rows.txt"), rows).unwrap();
    fs::write(path("points.csv"), points).unwrap();
    asperity_at(
        "convert {}/points.csv --to {}/map.x3p --separator comma --comment # --no-header --x-column 1 --x-unit um --y-column 2 --y-unit um --z-column 3 --z-unit um",
        folder.path(),
    )
    .result();
    // Two coarser grids are too few for an error, and a warning says so.
    let load = "--speed 10 --pressure 0.02 --quiet --json";
    let modes = asperity(&format!(
        "solve areal --size-mm 1.2,0.8 --mode 2,1:0.004 --mode 1,-1:0.002:0.4 --points 48,32 {load}"
    ))
    .json();
    for surface in [
        "--map {}/rows.txt --map-unit um --size-mm 1.2,0.8",
        "--map {}/rows.txt --map-unit um --size-mm 1.2",
        "--map {}/points.csv --map-unit um",
        "--map {}/map.x3p",
    ] {
        let map = asperity_at(&format!("solve areal {surface} {load}"), folder.path()).json();
        let (a, b) = (number(&map, "friction_coefficient"), number(&modes, "friction_coefficient"));
        approx::assert_relative_eq!(a, b, max_relative = 1e-7);
        assert_eq!(map["points_x"], 48, "{surface}");
    }
    // Fields at all points, row by row.
    asperity_at(
        &format!("solve areal --map {{}}/map.x3p --fields {{}}/fields.csv {load}"),
        folder.path(),
    )
    .json();
    let fields = fs::read_to_string(path("fields.csv")).unwrap();
    let lines: Vec<&str> = fields.lines().collect();
    assert_eq!(lines.len(), 1 + 48 * 32);
    assert_eq!(lines[0], "x_mm,y_mm,height_mm,pressure_mpa,separation_mm");
    let cells =
        |k: usize| -> Vec<f64> { lines[1 + k].split(',').map(|c| c.parse().unwrap()).collect() };
    let last = cells(48 * 32 - 1);
    assert!((last[0] - 1.175).abs() < 1e-9 && (last[1] - 0.775).abs() < 1e-9, "{last:?}");
    let mean = (0..48 * 32).map(|k| cells(k)[3]).sum::<f64>() / (48.0 * 32.0);
    approx::assert_relative_eq!(mean, 0.02, max_relative = 1e-9);
}

/// A matrix that `inspect` describes and that options read.
#[test]
fn rows_of_heights_are_proposed_described_and_solved() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("Sample 7\n[Data]\n");
    for row in heights() {
        let cells: Vec<String> =
            row.iter().map(|z| format!("{:.9}", -z).replace('.', ",")).collect();
        text += &(cells.join(";") + ";\n");
    }
    fs::write(folder.path().join("depths.txt"), text).unwrap();
    let proposed = asperity_at("inspect {}/depths.txt", folder.path()).result();
    for part in [
        "the file does not state x_spacing_um, z_unit",
        "48 heights on each line, a row of a height map",
        "map_lines = \"rows\"",
        "skip_until = \"[Data]\"",
        "decimal_mark = \",\"",
        "matrix = true\n# x_spacing_um = ?",
    ] {
        assert!(proposed.contains(part), "{part}: {proposed}");
    }
    let described = "--matrix --separator semicolon --decimal-mark , --skip-until [Data] --x-spacing-um 25 --y-spacing-um 20 --z-unit um --invert-z";
    let map = asperity_at(&format!("inspect {{}}/depths.txt {described} --json"), folder.path());
    let map = map.json();
    assert_eq!((&map["kind"], &map["shape"]), (&"map".into(), &serde_json::json!([32, 48])));
    assert_eq!((number(&map, "spacing_m"), number(&map, "spacing_y_m")), (25e-6, 20e-6));
    // An x3p file states all that, and areal reads either.
    let convert = format!("convert {{}}/depths.txt --to {{}}/map.x3p {described}");
    asperity_at(&convert, folder.path()).result();
    let load = "--speed 10 --pressure 0.02 --quiet --json";
    let solve = |map: &str| {
        let result = asperity_at(&format!("solve areal --map {{}}/{map} {load}"), folder.path());
        number(&result.json(), "friction_coefficient")
    };
    let of_text = solve(&format!("depths.txt {described}"));
    approx::assert_relative_eq!(of_text, solve("map.x3p"), max_relative = 1e-9);
    for (arguments, part) in [
        ("inspect {}/depths.txt --matrix --separator ;", "--x-spacing-um, --z-unit"),
        (
            "inspect {}/depths.txt --matrix --separator ; --x-spacing-um 1 --z-unit um --z-column 1",
            "the key `z_column` of its description does not go with matrix = true",
        ),
        (
            "solve areal --map {}/depths.txt --matrix --separator ; --x-spacing-um 1 --z-unit um --map-unit um --speed 10 --pressure 1",
            "leave --map-unit out",
        ),
        ("solve areal --map {}/map.x3p --matrix --speed 10 --pressure 1", "leave out --matrix"),
        (
            "solve areal --size-mm 1 --mode 1,0:0.01 --matrix --speed 10 --pressure 1",
            "--matrix describes a --map",
        ),
    ] {
        let outcome = asperity_at(arguments, folder.path());
        assert_eq!(outcome.code, 2, "{arguments}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(part), "{arguments}: {}", outcome.stderr);
    }
}

#[test]
fn a_map_that_does_not_close_is_told_and_its_mirror_closes() {
    let folder = tempfile::tempdir().unwrap();
    let text: String = (0..16)
        .map(|j| (0..16).map(|i| format!("{} ", i + (i * j) % 3)).collect::<String>() + "\n")
        .collect();
    fs::write(folder.path().join("tilted.txt"), text).unwrap();
    let solve =
        "solve areal --map {}/tilted.txt --map-unit um --size-mm 0.5 --speed 10 --pressure 0.1";
    let tilted = asperity_at(solve, folder.path());
    assert!(tilted.stderr.contains("ends along x"), "{}", tilted.stderr);
    let mirrored = asperity_at(&format!("{solve} --mirror"), folder.path());
    assert!(!mirrored.stderr.contains("ends along"), "{}", mirrored.stderr);
    let quiet = asperity_at(&format!("{solve} --mirror --quiet --json"), folder.path());
    assert_eq!(quiet.json()["points_y"], 32);
}

#[test]
fn mistakes_name_the_option_or_the_file_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rows.txt"), "1 2 3 4\n".repeat(4)).unwrap();
    fs::write(folder.path().join("hole.txt"), "1 2 nan 4\n".repeat(4)).unwrap();
    fs::write(folder.path().join("commas.txt"), "0,5\t1,5\t2\t1\n".repeat(8)).unwrap();
    let spike = "0 0 0 0 0 0 0 0\n".repeat(7) + "0 0 0 1e20 0 0 0 0\n";
    fs::write(folder.path().join("spike.txt"), spike).unwrap();
    let load = "--speed 10 --pressure 0.1";
    for (arguments, part) in [
        (format!("--mode 1,0:0.01 {load}"), "--size-mm"),
        (format!("--size-mm 1 --mode 0,0:0.01 {load}"), "0,0 is a constant height"),
        (
            format!("--size-mm 1 --mode 1,0:0.01 --points 4 {load}"),
            "--points is 4, it must be from 8",
        ),
        (format!("--size-mm 1 --mode 40,0:0.01 --points 64 {load}"), "at least 120, better 1280"),
        (format!("--size-mm 1 --mode 1,0:0.01 --points 16384 {load}"), "--memory-gb allows 4.5"),
        (format!("--map {{}}/rows.txt {load}"), "give --map-unit"),
        (
            format!("--map {{}}/rows.txt --map-unit um {load}"),
            "give the length of a row as --size-mm",
        ),
        (
            format!("--map {{}}/rows.txt --map-unit um --size-mm 1 {load}"),
            "has 4 by 4 points, a map needs 8",
        ),
        (
            format!("--map {{}}/hole.txt --map-unit um --size-mm 1 {load}"),
            "line 1, column 3: `nan` is not a finite number",
        ),
        (
            format!("--map {{}}/commas.txt --map-unit um --size-mm 1 {load}"),
            "`0,5` looks like a number with a decimal comma",
        ),
        (
            format!("--map {{}}/spike.txt --map-unit mm --size-mm 1 {load}"),
            "are no surface: check --map-unit",
        ),
        (format!("--size-mm 1,2,3 --mode 1,0:0.01 {load}"), "give one number, or two with a comma"),
        (format!("--size-mm 1 --mode 1,0:0.01 --mirror {load}"), "--mirror"),
        (format!("--map {{}}/none.txt --map-unit um --size-mm 1 {load}"), "none.txt"),
        ("--size-mm 1 --mode 1,0:0.01 --speed 10".into(), "--pressure"),
    ] {
        let outcome = asperity_at(&format!("solve areal {arguments}"), folder.path());
        assert_eq!(outcome.code, 2, "{arguments}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(part), "{arguments}: {}", outcome.stderr);
    }
}

#[test]
fn a_grid_that_does_not_resolve_the_contact_is_told() {
    // Friction of the wrong sign on the coarse grid, found by trying at random.
    let coarse = asperity(
        "solve areal --size-mm 0.1206,1.0623 --mode 8,-6:0.008155:5.226 --points 128,32 --speed 0.2826 --angle -41 --area 0.05",
    );
    assert_eq!(coarse.code, 0, "{}", coarse.stderr);
    assert!(coarse.stderr.contains("grid points across on average, too few"), "{}", coarse.stderr);
    assert!(coarse.stderr.contains("differs from that by the dissipation"), "{}", coarse.stderr);
    // A grid beyond the memory is refused before it is made.
    let error = asperity(
        "solve areal --size-mm 1 --mode 2,1:0.004 --points 32768 --speed 10 --pressure 0.1",
    )
    .error(2);
    assert!(error.contains("--memory-gb allows 4.5"), "{error}");
}
