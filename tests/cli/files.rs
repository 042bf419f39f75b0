//! Instrument files on the command line: `inspect`, `convert`, and what damage does to them.

use std::fs;
use std::path::{Path, PathBuf};

use asperity::scans::file::parse_file;
use asperity::scans::text_shape::TextShape;
use serde_json::{Value, json};

use super::{asperity, asperity_at, project};

/// Files of the reference folder, or none with a note.
fn reference_files() -> Vec<PathBuf> {
    let folder = project("../shared/formats");
    let mut files = Vec::new();
    for kind in ["sdf", "sur", "x3p", "text"] {
        let Ok(entries) = fs::read_dir(folder.join(kind)) else {
            println!("skipped: {} is not there", folder.display());
            continue;
        };
        files.extend(entries.map(|entry| entry.unwrap().path()));
    }
    files
}

/// Bundled files, which are always there.
fn bundled_files() -> Vec<PathBuf> {
    let entries = fs::read_dir(project("data/scans/formats")).unwrap();
    entries.map(|entry| entry.unwrap().path()).collect()
}

fn inspected(path: &Path) -> Value {
    asperity_at("inspect {} --json", path).json()
}

#[test]
fn bundled_formats_hold_the_same_scan() {
    let x3p = inspected(&project("data/scans/formats/scan_1.x3p"));
    assert_eq!((&x3p["format"], &x3p["kind"]), (&json!("X3P PRF"), &json!("profile")));
    assert_eq!(x3p["points"], 400);
    assert!(x3p["missing"].as_u64().unwrap() > 0, "{x3p}");
    assert!(x3p["detected"].as_str().unwrap().contains("checksum verified"), "{x3p}");
    let csv = format!(
        "inspect {} --json --separator comma --x-column x_m --x-unit m --z-column z_m --z-unit m",
        "{}"
    );
    let csv = asperity_at(&csv, &project("data/scans/formats/scan_1.csv")).json();
    assert_eq!((&csv["points"], &csv["missing"]), (&x3p["points"], &x3p["missing"]));
    let (csv, x3p) = (csv["mean_um"].as_f64().unwrap(), x3p["mean_m"].as_f64().unwrap());
    assert!((csv / (x3p * 1e6) - 1.0).abs() < 1e-12, "{csv} {x3p}");
}

#[test]
fn convert_writes_what_inspect_reads_and_overwrites_only_on_demand() {
    let folder = tempfile::tempdir().unwrap();
    let source = project("data/scans/formats/scan_1.x3p");
    let copy = folder.path().join("copy.x3p");
    let command = format!("convert {} --to {}", source.display(), copy.display());
    asperity(&command).result();
    assert_eq!(fs::read(&source).unwrap(), fs::read(&copy).unwrap());
    assert!(asperity(&command).error(2).contains("--force"));
    let odd =
        format!("convert {} --to {}", source.display(), folder.path().join("a.txt").display());
    assert!(asperity(&odd).error(2).contains("*.x3p or *.csv"));
}

#[test]
fn inspect_gives_the_expected_numbers_of_the_reference_files() {
    let folder = project("../shared/formats");
    let Ok(text) = fs::read_to_string(folder.join("expected.json")) else {
        println!("skipped: {} is not there", folder.display());
        return;
    };
    let expected: Value = serde_json::from_str(&text).unwrap();
    for (name, entry) in expected.as_object().unwrap().iter().filter(|(_, entry)| entry.is_object())
    {
        let found = inspected(&folder.join(name));
        for key in ["points", "shape", "missing"] {
            assert!(entry[key].is_null() || entry[key] == found[key], "{name} {key}: {found}");
        }
        for (expected, key) in [("step_m", "spacing_m"), ("mean_m", "mean_m"), ("std_m", "std_m")] {
            let Some(expected) = entry[expected].as_f64() else { continue };
            let value = found[key].as_f64().unwrap();
            // The sums of the other readers run in another order.
            assert!((value / expected - 1.0).abs() < 1e-10, "{name} {key}: {value}");
        }
    }
}

#[test]
fn a_text_without_options_is_described() {
    let path = project("data/scans/specimen/scan_01.txt");
    let text = asperity_at("inspect {}", &path).result();
    for part in ["[ingest.text]", "separator = \"semicolon\"", "x_unit = \"mm\"", "z_unit = \"um\""]
    {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let found = inspected(&path);
    assert_eq!((&found["kind"], &found["comment"]), (&json!("text"), &json!("#")));
}

/// Truncation at many lengths and a flipped bit at many places: an answer or an error with the
/// name of the file, and never a panic.
#[test]
fn damaged_files_are_an_answer_or_a_clear_error() {
    for path in bundled_files().into_iter().chain(reference_files()) {
        let bytes = fs::read(&path).unwrap();
        let read = |bytes: &[u8]| {
            if let Err(error) = parse_file("damaged", bytes) {
                assert!(error.to_string().starts_with("damaged: "), "{error}");
            }
            let _ = TextShape::of(bytes.get(..20_000).unwrap_or(bytes));
        };
        // Headers are dense in meaning; the rest is sampled. Of large files, which take longer,
        // every place of the first is not tried.
        let length = bytes.len();
        let stride = if length > 100_000 { 41 } else { 3 };
        let places =
            || (0..length.min(700)).step_by(stride).chain((0..40).map(move |i| i * length / 40));
        for length in places() {
            read(&bytes[..length]);
        }
        for place in places() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1 << (place % 8);
            read(&damaged);
            damaged[place] = 0xff;
            read(&damaged);
        }
    }
}
