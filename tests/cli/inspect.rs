//! `asperity inspect`.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use asperity::artifact::{
    ArrayDataset, ArrayFile, Attribute, Digest, Identity, Input, Manifest, ResultFile, Row,
    RunFolder, SolveStore, Storage, Table,
};
use serde_json::json;
use tempfile::TempDir;

use super::{asperity, asperity_at, project};

const SCAN: &str = "inspect {} --separator semicolon --comment # --x-column x_mm --x-unit mm --z-column z_um --z-unit um";

/// One solved contact.
#[derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
struct Solve {
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pressure_mpa: f64,
    /// Friction coefficient.
    #[schemars(extend("unit" = "1"))]
    friction: Option<f64>,
    /// Name of the surface.
    surface: String,
    /// Amplitudes of its waves.
    #[schemars(extend("unit" = "mm"))]
    amplitudes_mm: Vec<f64>,
}

impl Row for Solve {
    const SCHEMA: &'static str = "asperity.example.solves";
    const VERSION: u32 = 3;
}

const SOLVES: Table<Solve> = Table::new("bem", "solves.arrow");
const FIELDS: ArrayFile = ArrayFile {
    file: ResultFile { stage: "bem", name: "fields.h5" },
    schema: "asperity.example.fields",
    version: 1,
    description: "Fields.",
};

/// A run with one finished stage `bem`.
fn run() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    let identity = Identity {
        stage: "bem".into(),
        stage_revision: 2,
        output_schemas: vec![SOLVES.schema()],
        parameters: json!({ "speeds_mm_s": [10.0, 50.0] }),
        inputs: vec![Input {
            name: "rubber".into(),
            digest: Digest::of_bytes(b"rubber"),
            origin: Some("data/rubber/table_2_1.toml".into()),
        }],
    };
    let solve = |i: u32| Solve {
        pressure_mpa: f64::from(i) + 0.5,
        friction: (i > 0).then_some(0.25),
        surface: "realisation_07".into(),
        amplitudes_mm: vec![0.01867, 0.02648],
    };
    let heights = ArrayDataset {
        name: "scan_07/heights".into(),
        unit: "m".into(),
        attributes: BTreeMap::from([("spacing_m".into(), Attribute::Float(5e-5))]),
        values: vec![3.0, f64::NAN, -4.0, 1.0],
    };
    let mut pending = run.begin("bem").unwrap();
    let rows: Vec<_> = (0..20).map(solve).collect();
    pending.write_rows(SOLVES, &rows).unwrap();
    pending.write_arrays(FIELDS, Storage::Plain, &[heights]).unwrap();
    let manifest =
        Manifest::new(&identity, pending.outputs().to_vec(), vec!["one is coarse".into()], 1.5)
            .unwrap();
    pending.commit(&manifest).unwrap();
    folder
}

fn in_bem(run: &TempDir, file: &str) -> PathBuf {
    run.path().join("bem").join(file)
}

fn contains_all(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "`{part}` is not in\n{text}");
    }
}

#[test]
fn a_table_shows_schema_units_provenance_and_first_rows() {
    let run = run();
    let path = in_bem(&run, "solves.arrow");
    let text = asperity_at("inspect {}", &path).result();
    let parts = [
        "asperity.example.solves version 3",
        "20 rows, 4 columns",
        "f64 in MPa: Mean pressure.",
        "f64 (number), may be absent: Friction coefficient.",
        "list<f64> in mm",
        "stage bem, revision 2",
        "from data/rubber/table_2_1.toml",
        "intact",
        "one is coarse",
        "realisation_07",
        "4.5",
    ];
    contains_all(&text, &parts);
    assert!(!text.contains("5.5"), "only five rows are the first\n{text}");

    let json = asperity_at("inspect {} --json", &path).json();
    assert_eq!((&json["kind"], &json["rows"]), (&json!("table"), &json!(20)));
    assert_eq!(json["columns"][0]["unit"], "MPa");
    assert_eq!(json["provenance"]["state"], "intact");
    assert_eq!(json["first_rows"].as_array().unwrap().len(), 5);
    let first = json!({
        "pressure_mpa": 0.5, "friction": null, "surface": "realisation_07",
        "amplitudes_mm": [0.01867, 0.02648],
    });
    assert_eq!(json["first_rows"][0], first);
}

#[test]
fn arrays_show_their_statistics() {
    let run = run();
    let path = in_bem(&run, "fields.h5");
    let text = asperity_at("inspect {}", &path).result();
    // Mean of 3, -4 and 1 is 0, their mean square 26/3.
    let line = "scan_07/heights  4 values, 1 missing, mean 0 m, rms 2.94392 m, spacing_m = 0.00005";
    contains_all(&text, &["asperity.example.fields version 1", "stage bem", "intact", line]);
    let json = asperity_at("inspect {} --json", &path).json();
    assert_eq!((&json["kind"], &json["statistics"][0]["missing"]), (&json!("arrays"), &json!(1)));
    assert_eq!(json["datasets"][0]["attributes"]["spacing_m"], 5e-5);
}

#[test]
fn folders_and_manifests_show_the_files_and_their_state() {
    let run = run();
    let whole = asperity_at("inspect {}", run.path()).result();
    contains_all(
        &whole,
        &["stage bem, revision 2", "solves.arrow: asperity.example.solves", "intact"],
    );
    assert_eq!(asperity_at("inspect {} --json", run.path()).json()["kind"], "run");

    fs::remove_file(in_bem(&run, "fields.h5")).unwrap();
    let stage = asperity_at("inspect {}", &in_bem(&run, "")).result();
    contains_all(&stage, &["speeds_mm_s", "50.0", "MISSING", "intact", "1.50000 s"]);
    let json = asperity_at("inspect {} --json", &in_bem(&run, "")).json();
    assert_eq!(json["states"], json!(["intact", "missing"]));

    let manifest = asperity_at("inspect {}", &in_bem(&run, "manifest.json")).result();
    contains_all(&manifest, &["asperity.manifest version 2", "fields.h5", "speeds_mm_s"]);
}

#[test]
fn the_kind_is_found_by_content_and_a_changed_file_is_told() {
    let run = run();
    let renamed = run.path().join("table.txt");
    fs::copy(in_bem(&run, "solves.arrow"), &renamed).unwrap();
    contains_all(&asperity_at("inspect {}", &renamed).result(), &["20 rows"]);

    // A padding byte after the magic, which only the digest of the bytes covers.
    let path = in_bem(&run, "solves.arrow");
    let mut bytes = fs::read(&path).unwrap();
    bytes[6] ^= 1;
    fs::write(&path, bytes).unwrap();
    contains_all(&asperity_at("inspect {}", &path).result(), &["CHANGED since it was written"]);
}

#[test]
fn truncated_and_foreign_files_are_named() {
    let run = run();
    for file in ["solves.arrow", "fields.h5", "manifest.json"] {
        let path = in_bem(&run, file);
        let bytes = fs::read(&path).unwrap();
        let cut = run.path().join(file);
        fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
        let error = asperity_at("inspect {}", &cut).error(2);
        contains_all(&error, &[file, "truncated"]);
    }
    let path = run.path().join("file");
    let cases: [(&[u8], &str); 6] = [
        (b"", "is empty"),
        (b"\x7fELF\0\0", "is not an Arrow table"),
        (
            b"{\"schema\": \"asperity.manifest\", \"version\": 9}",
            "version 9, this tool reads version 2",
        ),
        (
            b"{\"schema\": \"asperity.recipe\", \"version\": 1}",
            "holds asperity.recipe, expected asperity.manifest",
        ),
        (b"{\"schema\": \"asperity.solve\", \"version\": 1}", "cannot be read as stored solve"),
        (b"{\"a\": 1}", "cannot be read as a manifest"),
    ];
    for (bytes, part) in cases {
        fs::write(&path, bytes).unwrap();
        let error = asperity_at("inspect {}", &path).error(2);
        assert!(error.contains(part) && error.contains("/file"), "{error}");
        // A file that is not asperity's is not to be deleted.
        assert!(part != "cannot be read as a manifest" || !error.contains("delete"), "{error}");
    }
    assert!(asperity("inspect no/such").error(2).contains("no/such"));
    let folder = asperity_at("inspect {}", &project("src")).error(2);
    assert!(folder.contains("neither a manifest.json nor finished stages"), "{folder}");
}

#[test]
fn a_scan_is_summarised_in_the_units_given() {
    let path = project("data/scans/specimen/scan_01.txt");
    let text = asperity_at(SCAN, &path).result();
    contains_all(
        &text,
        &[
            "8000 points, 240 missing (3.0 %)",
            "2.00000 um by least squares, median 2.00000 um",
            "505.000",
        ],
    );
    let json = asperity_at(&format!("{SCAN} --json"), &path).json();
    assert_eq!((&json["kind"], &json["missing"]), (&json!("scan"), &json!(240)));
    assert_eq!(json["first_points"][0][0], 0.0);
    // 505.0 um through metres and back.
    assert!((json["first_points"][0][1].as_f64().unwrap() - 505.0).abs() < 1e-12);
}

#[test]
fn a_scan_without_its_units_is_refused_with_what_is_needed() {
    let path = project("data/scans/specimen/scan_01.txt");
    let bare = asperity_at("inspect {} --z-column z_um", &path).error(2);
    contains_all(&bare, &["--separator", "--x-column", "--x-unit", "--z-unit"]);
    let unit = asperity_at(&SCAN.replace("--z-unit um", ""), &path).error(2);
    assert!(unit.contains("give --z-unit as well"), "{unit}");
    let wrong = asperity_at(&SCAN.replace("z_um", "height"), &path).error(2);
    contains_all(&wrong, &["scan_01.txt", "no column `height`", "`x_mm`, `z_um`"]);
    assert_eq!(wrong.matches("no column `height`").count(), 1, "{wrong}");
}

/// Counts of the lines of the file and of its `NaN`.
#[test]
fn a_real_road_scan_can_be_described_by_options() {
    let path = project("../shared/scans/captif/20211011_aylesbury_dec_station_0.dat");
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return;
    }
    // Columns by number: `Distance (mm)` has a blank, at which the helper would split.
    let options = "inspect {} --separator tab --skip-until *****DATA***** --x-column 2 --x-unit mm --z-column 3 --z-unit mm";
    let text = asperity_at(options, &path).result();
    let spacing = "37.4890 um by least squares, median 37.0000 um";
    contains_all(&text, &["51067 points, 4373 missing (8.6 %)", "0 to 1914.41 mm", spacing]);
    assert!(!text.contains("WARNING"), "{text}");
    let wrong = asperity_at(&options.replace("--z-unit mm", "--z-unit um"), &path).result();
    contains_all(&wrong, &["WARNING", "`Depth (mm)` states mm, the description z_unit = \"um\""]);
    let steep = asperity_at(&options.replace("--x-unit mm", "--x-unit um"), &path).error(2);
    contains_all(&steep, &["steeper than", "1.914413 mm long", "x_unit"]);
}

#[test]
fn a_stored_solve_is_told_from_a_manifest_and_shown() {
    let folder = tempfile::tempdir().unwrap();
    let store = SolveStore::open(folder.path()).unwrap();
    let key = Digest::of_bytes(b"all that determines it");
    store.put(&key, &json!({ "friction_coefficient": 0.25 })).unwrap();
    let digits = key.to_string();
    let path = folder.path().join(&digits[..2]).join(format!("{digits}.json"));
    let text = asperity_at("inspect {}", &path).result();
    contains_all(&text, &["asperity.solve version 1", "intact", "\"friction_coefficient\": 0.25"]);
    let result = asperity_at("inspect {} --json", &path).json();
    assert_eq!((&result["kind"], &result["key"]), (&json!("solve"), &json!(digits)));
    fs::write(&path, fs::read_to_string(&path).unwrap().replace("0.25", "0.75")).unwrap();
    assert!(asperity_at("inspect {}", &path).result().contains("CHANGED"));
}
