//! `asperity water`.

use std::fs;
use std::path::Path;

use super::{Outcome, binary, project};
use approx::assert_relative_eq;
use serde_json::Value;

/// A crater in a plain: walls 0.3 mm high about a floor of 3 by 3 points that is 0.2 mm deep.
fn crater() -> String {
    let height = |i: i32, j: i32| match (i - 8).abs().max((j - 8).abs()) {
        0..=1 => -0.2,
        2..=3 => 0.3,
        _ => 0.0,
    };
    let row = |j: i32| {
        (0..16).map(|i| height(i, j).to_string()).collect::<Vec<String>>().join(" ") + "\n"
    };
    (0..16).map(row).collect()
}

const CRATER: &str = "--map crater.txt --map-unit mm --size-mm 3.2";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("crater.txt"), crater()).unwrap();
    folder
}

fn run(folder: &Path, arguments: &str) -> Outcome {
    Outcome::of(binary().current_dir(folder).args(arguments.split_whitespace()))
}

fn water(folder: &Path, arguments: &str) -> Outcome {
    run(folder, &format!("water {arguments}"))
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap()
}

#[test]
fn a_crater_holds_its_volume_and_the_written_map_none() {
    let folder = folder();
    let json =
        water(folder.path(), &format!("{CRATER} --filled full.x3p --dry dry.sdf --json")).json();
    // 9 of 256 points, 0.5 mm from the floor to the rim.
    assert_relative_eq!(number(&json, "filled_fraction"), 9.0 / 256.0, max_relative = 1e-15);
    let volume = number(&json, "volume_per_area_mm");
    assert_relative_eq!(volume, 0.5 * 9.0 / 256.0, max_relative = 1e-12);
    assert_relative_eq!(number(&json, "deepest_mm"), 0.5, max_relative = 1e-12);
    let place: Vec<f64> =
        json["deepest_at_mm"].as_array().unwrap().iter().filter_map(Value::as_f64).collect();
    assert_relative_eq!(place[..], [1.4, 1.4], max_relative = 1e-12);
    assert!(json["film"].is_null() && json["filled_gap_points"] == 0);

    let full = water(folder.path(), "--map full.x3p --json").json();
    assert_eq!((number(&full, "filled_fraction"), number(&full, "deepest_mm")), (0.0, 0.0));
    let dry = water(folder.path(), "--map dry.sdf --json").json();
    assert_relative_eq!(number(&dry, "volume_per_area_mm"), volume, max_relative = 1e-6);
    let table = water(folder.path(), CRATER).result();
    assert!(table.contains("sealed volume per area") && table.contains("0.0175781 mm"), "{table}");
    let solved = run(folder.path(), "solve areal --map full.x3p --speed 10 --pressure 0.05 --json");
    assert_eq!(solved.code, 0, "{}", solved.stderr);
}

/// The bundled map has gaps and a slope, and closes nowhere.
#[test]
fn gaps_planes_and_edges_are_treated_as_asked_for_only() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(project("data/scans/map/road.x3p"), folder.path().join("road.x3p")).unwrap();
    let refused = water(folder.path(), "--map road.x3p").error(2);
    assert!(refused.contains("heights are missing: give --fill-gaps-mm"), "{refused}");
    let narrow = water(folder.path(), "--map road.x3p --fill-gaps-mm 0.01").error(2);
    assert!(narrow.contains("only gaps up to 0.0100 mm are filled"), "{narrow}");
    let open = "--map road.x3p --fill-gaps-mm 2 --json --quiet";
    let warned = water(folder.path(), "--map road.x3p --fill-gaps-mm 2");
    assert!(warned.stderr.contains("has a cliff there; give --mirror"), "{}", warned.stderr);
    let closed = "--map road.x3p --fill-gaps-mm 2 --remove-plane --mirror --json";
    // Without a warning.
    let [open, closed] = [open, closed].map(|arguments| water(folder.path(), arguments).json());
    assert_eq!((number(&open, "points_x"), number(&closed, "points_x")), (384.0, 768.0));
    assert!(number(&closed, "filled_gap_points") > 100.0);
    assert!(number(&closed, "rms_height_mm") < number(&open, "rms_height_mm"));
    for json in [&open, &closed] {
        let [four, eight] =
            ["volume_per_area_4_mm", "volume_per_area_8_mm"].map(|key| number(json, key));
        assert!(
            0.0 < eight && eight <= four && four == number(json, "volume_per_area_mm"),
            "{json}"
        );
    }
    let eight =
        water(folder.path(), "--map road.x3p --fill-gaps-mm 2 --neighbours 8 --json --quiet")
            .json();
    assert_eq!(eight["volume_per_area_mm"], open["volume_per_area_8_mm"]);
}

/// Stefan's film: 1/h² = 2 p t / (η w²), and 4 p t / (3 η R²).
#[test]
fn a_film_needs_the_time_of_the_closed_form() {
    let folder = folder();
    let strip =
        format!("{CRATER} --block-width-mm 10 --pressure 0.3 --film-um 5 --viscosity 1e-3 --json");
    let film = water(folder.path(), &strip).json()["film"].clone();
    let time = 1e-3 * 0.01_f64.powi(2) / (2.0 * 3e5 * 5e-6_f64.powi(2));
    assert_relative_eq!(number(&film, "time_s"), time, max_relative = 1e-12);
    assert_relative_eq!(number(&film, "speed_mm_s"), 10.0 / time, max_relative = 1e-12);
    let disc = format!("{CRATER} --disc-radius-mm 4 --pressure 0.3 --film-um 5 --json");
    let film = water(folder.path(), &disc).json()["film"].clone();
    let time = 3.0 * 1.002e-3 * 0.004_f64.powi(2) / (4.0 * 3e5 * 5e-6_f64.powi(2));
    assert_relative_eq!(number(&film, "time_s"), time, max_relative = 1e-12);
    assert_relative_eq!(number(&film, "speed_mm_s"), 8.0 / time, max_relative = 1e-12);
}

#[test]
fn mistakes_are_explained_and_leave_no_file() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("flat.txt"), "0 0\n0 0\n").unwrap();
    fs::write(at.join("gap.txt"), crater().replacen("0 ", "NaN ", 1)).unwrap();
    fs::write(at.join("ragged.txt"), crater() + "0 0\n").unwrap();
    let before = fs::read_dir(at).unwrap().count();
    let cases = [
        ("--map missing.x3p", "missing.x3p"),
        ("--map crater.txt", "--map-unit"),
        ("--map flat.txt --map-unit mm --size-mm 1", "a map needs 8 to"),
        ("--map gap.txt --map-unit mm --size-mm 1", "`NaN` is not a finite number"),
        ("--map ragged.txt --map-unit mm --size-mm 1", "line 17"),
        ("--map crater.txt --map-unit m --size-mm 3.2", "are no surface"),
        (&format!("{CRATER} --filled full.txt"), "call the new file *.x3p or *.sdf"),
        (&format!("{CRATER} --filled a.x3p --dry a.x3p"), "the same file"),
        (&format!("{CRATER} --filled crater.txt --force"), "would overwrite the input"),
        (&format!("{CRATER} --film-um 5 --pressure 1"), "--block-width-mm or --disc-radius-mm"),
        (&format!("{CRATER} --block-width-mm 5"), "--pressure"),
        (&format!("{CRATER} --block-width-mm -5 --pressure 1 --film-um 1"), "not positive"),
        (
            &format!("{CRATER} --block-width-mm 1e300 --pressure 1e-300 --film-um 1e-300"),
            "double precision",
        ),
        (&format!("{CRATER} --neighbours 6"), "4, 8"),
    ];
    for (arguments, part) in cases {
        let message = water(at, arguments).error(2);
        assert!(message.contains(part), "{arguments}: {message}");
    }
    assert_eq!(fs::read_dir(at).unwrap().count(), before);
    fs::write(at.join("full.x3p"), "mine").unwrap();
    assert!(water(at, &format!("{CRATER} --filled full.x3p")).error(2).contains("exists already"));
    assert_eq!(fs::read_to_string(at.join("full.x3p")).unwrap(), "mine");
}
