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
    let sdf = inspected(&project("data/scans/formats/scan_1.sdf"));
    assert_eq!(sdf["format"], "SDF aISO-1.0");
    for key in ["points", "missing", "spacing_m", "mean_m", "std_m"] {
        assert_eq!(sdf[key], x3p[key], "{key}");
    }
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
    let sdf = folder.path().join("copy.sdf");
    asperity(&format!("convert {} --to {}", source.display(), sdf.display())).result();
    assert_eq!(fs::read(project("data/scans/formats/scan_1.sdf")).unwrap(), fs::read(sdf).unwrap());
    assert!(asperity(&command).error(2).contains("--force"));
    let odd =
        format!("convert {} --to {}", source.display(), folder.path().join("a.txt").display());
    assert!(asperity(&odd).error(2).contains("*.x3p, *.sdf or *.csv"));
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
    let described = asperity_at(
        "inspect {} --json --separator semicolon --comment # --x-column x_mm --x-unit mm --z-column z_um --z-unit um",
        &path,
    );
    let described = described.json();
    for key in ["format", "points", "missing", "spacing_m", "mean_m", "std_m"] {
        assert!(!found[key].is_null() && found[key] == described[key], "{key}: {found}");
    }
}

/// The texts beside the reference files: what they state is read, what they do not is asked for.
#[test]
fn reference_texts_are_inspected() {
    let folder = project("../shared");
    let text = folder.join("formats/text");
    if !text.exists() {
        println!("skipped: {} is not there", text.display());
        return;
    }
    let near = |found: &Value, key: &str, expected: f64| {
        let value = found[key].as_f64().unwrap();
        assert!((value / expected - 1.0).abs() < 1e-12, "{key}: {found}");
    };
    // 12.34 um on 3 columns, 5678.9 nm on 4 rows; heights 1 1.5 3, -2 -3 -6, 0 0 0, 9 9 9 m.
    let map = inspected(&text.join("gwyddion-export-german.txt"));
    assert_eq!((&map["format"], &map["shape"]), (&json!("Gwyddion text"), &json!([4, 3])));
    near(&map, "spacing_m", 12.34e-6 / 3.0);
    near(&map, "spacing_y_m", 5678.9e-9 / 4.0);
    near(&map, "mean_m", 21.5 / 12.0);
    near(&map, "std_m", (304.25 / 12.0 - (21.5_f64 / 12.0).powi(2)).sqrt());
    let bare = inspected(&text.join("nonuniform.asc"));
    assert_eq!((&bare["points"], &bare["mean_m"]), (&json!(134), &Value::Null));
    assert!(bare["unread"].as_str().unwrap().contains("x_unit, z_unit"), "{bare}");
    let road = inspected(&folder.join("scans/captif/20211011_aylesbury_dec_station_0.dat"));
    assert_eq!((&road["points"], &road["missing"]), (&json!(51067), &json!(4373)));
    assert!(road["mean_m"].is_f64() && road["std_m"].is_f64(), "{road}");
}

/// Files as they come: one clear error with the name of the file, the place and what to do, or an
/// answer that says what is not read.
#[test]
fn clumsy_files_are_answered_clearly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.dat");
    let sdf = fs::read(project("data/scans/formats/scan_1.sdf")).unwrap();
    let changed = |from: &str, to: &str| {
        String::from_utf8(sdf.clone()).unwrap().replacen(from, to, 1).into_bytes()
    };
    let x3p = fs::read(project("data/scans/formats/scan_1.x3p")).unwrap();
    let missing = String::from(
        "aISO-1.0\nNumPoints=2\nNumProfiles=1\nXscale=1e-6\nYscale=0\nZscale=1\n\
                                DataType=7\n*\nBAD BAD\n*\n",
    );
    let errors: [(&[u8], &[&str]); 10] = [
        (b"", &["is empty"]),
        (&sdf[..sdf.len() / 2], &["line ", "expected 400", "copy the file again"]),
        (&x3p[..x3p.len() / 2], &["no zip archive", "copy the file again"]),
        (
            &changed("NumPoints = 400", "NumPoints = 4000000000"),
            &["the heights must have 7999999999 bytes"],
        ),
        (&changed("Xscale = 1e-5", "Xscale = 1e5"), &["line 7", "spacing", "check"]),
        (&changed("Zscale = 1", "Zscale = 0"), &["line 9", "Zscale is `0`", "positive"]),
        (&changed("Zscale = 1", "Zscale = -1"), &["line 9", "Zscale is `-1`", "positive"]),
        (missing.as_bytes(), &["all 2 heights are missing"]),
        (b"PK\x05\x06\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", &["is not an Arrow table"]),
        (b"no\nnumbers\n", &["without lines of numbers"]),
    ];
    for (bytes, parts) in errors {
        fs::write(&path, bytes).unwrap();
        let error = asperity_at("inspect {}", &path).error(2);
        for part in parts.iter().chain(&["scan.dat"]) {
            assert!(error.contains(part), "`{part}` is not in {error}");
        }
    }
    let directory = asperity(&format!(
        "convert {} --to {}/a.x3p",
        project("src").display(),
        folder.path().display()
    ));
    assert!(directory.error(2).contains("src is a folder; give the file of one scan"));
    // The name says nothing; two lines of names, decimal commas, UTF-16 with a mark are seen through.
    let utf16: Vec<u8> = "\u{feff}x;z\r\nmm;um\r\n0,0;1,5\r\n0,1;2,5\r\n0,2;2,0\r\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    fs::write(&path, utf16).unwrap();
    let found = inspected(&path);
    assert_eq!((&found["points"], &found["encoding"]), (&json!(3), &json!("utf-16le")));
    assert!((found["mean_m"].as_f64().unwrap() / 2e-6 - 1.0).abs() < 1e-12, "{found}");
    let unmarked: Vec<u8> =
        "x_mm;z_um\n0.0;1.5\n0.1;2.5\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    fs::write(&path, unmarked).unwrap();
    assert_eq!(inspected(&path)["encoding"], "utf-16le");
    fs::write(&path, "x_mm;z_um\n0;1,234.5\n1;2,345.5\n").unwrap();
    assert!(inspected(&path)["unread"].as_str().unwrap().contains("`1,234.5` separates thousands"));
    let row = "1 2 3 4 5 6 7 8 9 10 11 12 13\n";
    fs::write(&path, row.repeat(3)).unwrap();
    let rows = inspected(&path);
    assert!(rows["unread"].as_str().unwrap().contains("does not state x_spacing_um"), "{rows}");
    assert_eq!(rows["matrix"], true);
    assert!(rows["recipe_section"].as_str().unwrap().contains("matrix = true"), "{rows}");
}

/// What describes a text is refused where it would be passed over.
#[test]
fn options_of_a_text_are_refused_for_the_file_of_an_instrument() {
    let folder = tempfile::tempdir().unwrap();
    let options = "--invert-z --cut-start-mm 5 --x-unit mm --encoding utf-16le";
    let inspect = format!("inspect {{}} {options}");
    let convert = format!("convert {{}} --to {}/a.csv {options}", folder.path().display());
    for command in [&inspect, &convert] {
        let error = asperity_at(command, &project("data/scans/formats/scan_1.x3p")).error(2);
        let given = "leave out --x-unit, --invert-z, --encoding, --cut-start-mm";
        for part in ["scan_1.x3p", given, "ingest.invert_instrument_heights"] {
            assert!(error.contains(part), "`{part}` is not in {error}");
        }
    }
    assert!(!folder.path().join("a.csv").exists());
    let folder = asperity_at("inspect {} --x-unit mm", folder.path()).error(2);
    assert!(folder.contains("leave out --x-unit"), "{folder}");
    let text = project("data/scans/specimen/scan_01.txt");
    let alone = asperity_at("inspect {} --encoding windows-1252", &text).error(2);
    assert!(alone.contains("give --separator"), "{alone}");
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
        // Headers are dense in meaning; the rest is sampled, and large files more coarsely.
        let length = bytes.len();
        let (stride, samples) = if length > 100_000 { (97, 10) } else { (3, 40) };
        let sampled = move |i: usize| i * length / samples;
        let places = || (0..length.min(700)).step_by(stride).chain((0..samples).map(sampled));
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

/// Two wheel paths, of which the right is twice the left.
const ROAD: &str = "ERDFILEV2.00\n 2, 3, -1, 1, 5, 0.0250, -1,\nSHORTNAMLElev.  RElev.  \nUNITSNAMmm      mm      \n\
                    XUNITS  m\nEND\n1.0 2.0\n2.0 4.0\n3.0 6.0\n";

#[test]
fn a_channel_of_an_erd_file_is_chosen_by_its_number() {
    let folder = tempfile::tempdir().unwrap();
    let (road, csv) = (folder.path().join("road.erd"), folder.path().join("right.csv"));
    fs::write(&road, ROAD).unwrap();
    let mean = |options: &str| {
        let found = asperity_at(&format!("inspect {{}} --json {options}"), &road).json();
        assert_eq!(found["instrument"]["channels of heights"], "1 LElev., 2 RElev.");
        found["mean_m"].as_f64().unwrap()
    };
    assert_eq!((mean(""), mean("--erd-channel 1")), (2e-3, 2e-3));
    assert_eq!(mean("--erd-channel 2"), 4e-3);
    asperity_at(&format!("convert {{}} --erd-channel 2 --to {}", csv.display()), &road).result();
    assert!(fs::read_to_string(&csv).unwrap().contains(",6e-3\n"));
    let refused = asperity_at("inspect {} --erd-channel 3", &road).error(2);
    assert!(refused.contains("1 LElev., 2 RElev."), "{refused}");
    assert!(asperity_at("inspect {} --erd-channel 0", &road).error(2).contains("the first is 1"));
    let other = asperity_at("inspect {} --erd-channel 2", &csv).error(2);
    assert!(other.contains("is not an ERD file"), "{other}");
    let to = folder.path().join("again.sdf");
    let convert = format!("convert {{}} --erd-channel 2 --to {}", to.display());
    assert!(asperity_at(&convert, &csv).error(2).contains("is not an ERD file"));
}
