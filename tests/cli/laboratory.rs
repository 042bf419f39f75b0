//! Files as laboratories send them, from `init` to the parameters of the scans.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Outcome, asperity_at, binary};
use rust_xlsxwriter::Workbook;

fn within(folder: &Path, arguments: &[&str]) -> Outcome {
    Outcome::of(binary().current_dir(folder).arg("--quiet").args(arguments))
}

/// Makes a project for a scan and runs its first two stages; the recipe.
fn project(folder: &Path, scans: &[&str]) -> String {
    within(folder, &[&["init", "road", "--scans"], scans].concat()).result();
    for stage in ["ingest", "characterise"] {
        let run = ["run", "road/recipe.toml", "--out", "out", "--only", stage];
        // Short scans are warned of.
        let run = within(folder, &run);
        assert_eq!(run.code, 0, "{}", run.stderr);
    }
    fs::read_to_string(folder.join("road/recipe.toml")).unwrap()
}

/// A road of several waves, in um, at a place in mm.
fn height(x: f64, y: f64) -> f64 {
    40.0 * (7.0 * x).sin() + 9.0 * (31.0 * x + 5.0 * y).cos() + 4.0 * (90.0 * x - 13.0 * y).sin()
}

/// Points of a height map, by columns.
fn map_text(columns: usize, rows: usize, step: f64) -> String {
    let point = |i: usize| {
        let (x, y) = ((i / rows) as f64 * step, (i % rows) as f64 * 2.0 * step);
        format!("{x:.4}\t{y:.4}\t{:.4}\n", height(x, y))
    };
    String::from("X (mm)\tY (mm)\tZ (\u{b5}m)\n")
        + &(0..columns * rows).map(point).collect::<String>()
}

#[test]
fn a_map_as_text_becomes_lines_of_a_run_by_its_own_proposal() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("map.txt"), map_text(400, 12, 0.01)).unwrap();
    let seen = asperity_at("inspect {}", &folder.path().join("map.txt")).result();
    for part in [
        "height map, 12 rows of 400 points",
        "um along the rows and 20.0000 um between",
        "y_column",
    ] {
        assert!(seen.contains(part), "{part}: {seen}");
    }
    let recipe = project(folder.path(), &["map.txt"]);
    assert!(
        recipe.contains("scans = [\"../map.txt\"]") && recipe.contains("map_lines = \"rows\""),
        "{recipe}"
    );
    let windows =
        asperity_at("inspect {} --json", &folder.path().join("out/ingest/windows.arrow")).result();
    assert!(windows.contains("\"rows\": 12"), "{windows}");
    // As a file of an instrument it is the same map.
    let options = "--separator tab --x-column 1 --x-unit mm --y-column 2 --y-unit mm --z-column 3 --z-unit um";
    let options: Vec<&str> = options.split(' ').collect();
    within(
        folder.path(),
        &[&["convert", "map.txt", "--to", "map.x3p"], options.as_slice()].concat(),
    )
    .result();
    let seen = asperity_at("inspect {}", &folder.path().join("map.x3p")).result();
    assert!(seen.contains("height map, 12 rows of 400 points"), "{seen}");
}

#[test]
fn a_workbook_becomes_a_run_by_its_own_proposal() {
    let folder = tempfile::tempdir().unwrap();
    let mut book = Workbook::new();
    book.add_worksheet().write(0, 0, "Ra").unwrap().write(0, 1, 12.5).unwrap();
    let sheet = book.add_worksheet().set_name("Scan").unwrap();
    sheet.write(0, 0, "X [mm]").unwrap().write(0, 1, "Z [um]").unwrap();
    for i in 0..800_u32 {
        let x = f64::from(i) * 0.01;
        sheet.write(i + 1, 0, x).unwrap().write(i + 1, 1, height(x, 0.0)).unwrap();
    }
    book.save(folder.path().join("scan.xlsx")).unwrap();
    let recipe = project(folder.path(), &["scan.xlsx"]);
    assert!(recipe.contains("sheet = \"Scan\""), "{recipe}");
    let seen = asperity_at("inspect {}", &folder.path().join("scan.xlsx")).result();
    assert!(seen.contains("workbook") && seen.contains("spacing 10.0000 um"), "{seen}");
    let options = [
        "--sheet",
        "1",
        "--separator",
        "tab",
        "--no-header",
        "--x-spacing-um",
        "1",
        "--z-column",
        "2",
        "--z-unit",
        "um",
    ];
    let error =
        within(folder.path(), &[&["inspect", "scan.xlsx"], options.as_slice()].concat()).error(2);
    assert!(error.contains("too few points"), "{error}");
}

#[test]
fn all_scans_are_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("scans")).unwrap();
    for (name, points) in [("a", 700), ("b", 800), ("c", 950)] {
        let row =
            |i: usize| format!("{:.3};{:.4}\n", i as f64 * 0.01, height(i as f64 * 0.01, 0.0));
        let text = String::from("x_mm;z_um\n") + &(0..points).map(row).collect::<String>();
        fs::write(folder.path().join(format!("scans/{name}.txt")), text).unwrap();
    }
    let recipe = project(folder.path(), &["scans"]);
    assert!(
        recipe.contains("scans = [\"../scans\"]") && recipe.contains("window_length_mm = 7.0"),
        "{recipe}"
    );
    // What is no scan, or has another spacing, is said.
    fs::write(folder.path().join("scans/notes.txt"), "a note\n").unwrap();
    let row = |i: usize| format!("{:.3};{:.4}\n", i as f64 * 0.03, height(i as f64 * 0.03, 0.0));
    let text = String::from("x_mm;z_um\n") + &(0..300).map(row).collect::<String>();
    fs::write(folder.path().join("scans/d.txt"), text).unwrap();
    let made = Outcome::of(
        binary().current_dir(folder.path()).args(["init", "other", "--scans", "scans"]),
    );
    for part in [
        "1 of 5 files cannot be read like this",
        "notes.txt",
        "10.00 to 30.00 um",
        "the spacings differ",
    ] {
        assert!(made.stderr.contains(part), "{part}: {}", made.stderr);
    }
    // Rows of numbers are a map, whose spacing is left open.
    let matrix =
        (0..9).map(|i| format!("{} 3 1 4 {}\n", (i * 5) % 7, (i * 7) % 5)).collect::<String>();
    fs::write(folder.path().join("matrix.txt"), matrix).unwrap();
    let made = Outcome::of(binary().current_dir(folder.path()).args([
        "init",
        "third",
        "--scans",
        "matrix.txt",
    ]));
    assert!(made.stderr.contains("does not state x_spacing_um, z_unit"), "{}", made.stderr);
    let recipe = fs::read_to_string(folder.path().join("third/recipe.toml")).unwrap();
    for part in ["map_lines = \"rows\"", "matrix = true\n# x_spacing_um = ?"] {
        assert!(recipe.contains(part), "{part}: {recipe}");
    }
}

#[test]
fn files_that_are_not_read_are_named_by_every_command() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.opd"), b"\x01\x00Directory\0\0\0\0").unwrap();
    for command in [
        vec!["inspect", "a.opd"],
        vec!["convert", "a.opd", "--to", "a.x3p"],
        vec!["init", "road", "--scans", "a.opd"],
    ] {
        let error = within(folder.path(), &command).error(2);
        assert!(error.contains("a.opd") && error.contains("Wyko ASCII"), "{command:?}: {error}");
    }
}

/// The cases beside the project.
#[test]
fn cases_run_from_their_own_proposals() {
    let cases = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/cases"));
    if !cases.is_dir() {
        println!("skipped: {} is not there", cases.display());
        return;
    }
    for file in [
        "01_micro_sign_latin1/scan.csv",
        "02_stylus_csv_crcrlf/scan.csv",
        "04_wyko_ascii/map.asc",
        "05_opencrg_text/road.crg",
        "08_xml_reference_profile/profile.xml",
        "09_spreadsheet/scan.xlsx",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = cases.join(file);
        let recipe = project(folder.path(), &[path.to_str().unwrap()]);
        assert!(!recipe.contains(" = ?"), "{file}: {recipe}");
    }
}
