use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::artifact::arrays::unlocked;
use crate::artifact::*;

const SCHEMA: &str = "asperity.test.arrays";

fn place() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arrays.h5");
    (folder, path)
}

fn dataset(name: &str, values: Vec<f64>) -> ArrayDataset {
    let attributes = BTreeMap::from([
        ("spacing_m".to_owned(), Attribute::Float(3.75e-5)),
        ("seed".to_owned(), Attribute::Integer(i64::MIN)),
        ("origin".to_owned(), Attribute::Text("Straße – µ".into())),
        ("remark".to_owned(), Attribute::Text(String::new())),
    ]);
    ArrayDataset { name: name.into(), unit: "m".into(), attributes, values }
}

/// Sorted by name: an empty one, one below and one above the size that is compressed.
fn datasets() -> Vec<ArrayDataset> {
    let long = (0..40_000).map(|i| (f64::from(i) * 1e-3).sin() * 1e-3).collect();
    vec![
        dataset("empty", Vec::new()),
        dataset("scan_07/heights", long),
        dataset("scan_07/window/heights", vec![f64::NAN, -0.0, 1.0 / 3.0, f64::MIN_POSITIVE / 8.0]),
    ]
}

fn write(path: &Path, datasets: &[ArrayDataset]) -> Digest {
    write_as(Storage::Compressed, path, datasets)
}

fn write_as(storage: Storage, path: &Path, datasets: &[ArrayDataset]) -> Digest {
    write_arrays(path, SCHEMA, 3, "Heights of a test", storage, datasets).unwrap()
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn arrays_and_attributes_come_back_to_the_bit() {
    let (_folder, path) = place();
    for storage in [Storage::Plain, Storage::Compressed] {
        write_as(storage, &path, &datasets());
        let found = read_arrays(&path, SCHEMA, 3).unwrap();
        assert_eq!(found.len(), 3);
        for (found, written) in found.iter().zip(datasets()) {
            assert_eq!(found.name, written.name);
            assert_eq!(found.unit, written.unit);
            assert_eq!(found.attributes, written.attributes);
            assert_eq!(bits(&found.values), bits(&written.values));
        }
    }
}

#[test]
fn the_file_describes_itself() {
    let (_folder, path) = place();
    let written = write(&path, &datasets());
    let info = arrays_info(&path).unwrap();
    assert_eq!((info.schema.as_str(), info.version), (SCHEMA, 3));
    assert_eq!((info.description.as_str(), info.content_digest), ("Heights of a test", written));
    assert_eq!(
        (info.datasets[1].name.as_str(), info.datasets[1].length),
        ("scan_07/heights", 40_000)
    );
    // 40 000 smooth values of 8 bytes; uncompressed the file would exceed this.
    assert!(std::fs::metadata(&path).unwrap().len() < 320_000);
}

#[test]
fn equal_arrays_give_equal_bytes_and_order_is_no_content() {
    let (_folder, path) = place();
    let digest = write(&path, &datasets());
    let files = [Storage::Plain, Storage::Compressed].map(|storage| {
        write_as(storage, &path, &datasets());
        (storage, std::fs::read(&path).unwrap())
    });
    // HDF5 time stamps have a resolution of one second.
    std::thread::sleep(std::time::Duration::from_millis(1100));
    for (storage, first) in files {
        assert_eq!(write_as(storage, &path, &datasets()), digest);
        assert_eq!(std::fs::read(&path).unwrap(), first, "{storage:?}");
    }
    let mut reversed = datasets();
    reversed.reverse();
    assert_eq!(write(&path, &reversed), digest);
}

#[test]
fn everything_a_dataset_has_is_content() {
    let (_folder, path) = place();
    let reference = write(&path, &datasets());
    let changes: [fn(&mut ArrayDataset); 6] = [
        |d| d.name.push('x'),
        |d| d.unit = "mm".into(),
        |d| d.values[0] = 0.0,
        |d| d.values.truncate(1),
        |d| drop(d.attributes.insert("seed".into(), Attribute::Float(1.0))),
        |d| drop(d.attributes.remove("remark")),
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let mut changed = datasets();
        change(&mut changed[2]);
        assert_ne!(write(&path, &changed), reference, "change {index}");
    }
}

#[test]
fn another_schema_or_version_is_refused() {
    let (_folder, path) = place();
    write(&path, &datasets());
    let name = read_arrays(&path, "asperity.test.others", 3).unwrap_err().to_string();
    assert!(name.contains("holds asperity.test.arrays, expected asperity.test.others"), "{name}");
    let version = read_arrays(&path, SCHEMA, 4).unwrap_err().to_string();
    assert!(version.contains("version 3, this tool reads version 4"), "{version}");
}

#[test]
fn damaged_and_foreign_files_are_refused() {
    let (_folder, path) = place();
    let missing = read_arrays(&path, SCHEMA, 3).unwrap_err();
    assert!(matches!(missing, ArtifactError::Io { .. }), "{missing}");

    write(&path, &datasets());
    let bytes = std::fs::read(&path).unwrap();
    for length in [0, 1, 100, bytes.len() / 2, bytes.len() - 1] {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let error = read_arrays(&path, SCHEMA, 3).unwrap_err();
        assert!(matches!(error, ArtifactError::Unreadable { .. }), "{length}: {error}");
    }
    // One bit of the stored 1/3: the file stays well-formed.
    let pattern = (1.0_f64 / 3.0).to_le_bytes();
    let at = bytes.windows(8).position(|window| window == pattern).unwrap();
    let mut flipped = bytes.clone();
    flipped[at] ^= 1;
    std::fs::write(&path, &flipped).unwrap();
    let error = read_arrays(&path, SCHEMA, 3).unwrap_err();
    assert!(matches!(error, ArtifactError::Damaged { .. }), "{error}");
}

#[test]
fn a_foreign_hdf5_file_lacks_schema_or_unit() {
    let (_folder, path) = place();
    unlocked().create(&path).unwrap().close().unwrap();
    let schema = read_arrays(&path, SCHEMA, 3).unwrap_err().to_string();
    assert!(schema.contains("has no attribute `version` of the file"), "{schema}");

    write(&path, &datasets());
    let file = unlocked().open_rw(&path).unwrap();
    file.new_dataset::<f64>().shape(3).create("extra").unwrap();
    file.close().unwrap();
    let unit = read_arrays(&path, SCHEMA, 3).unwrap_err().to_string();
    assert!(unit.contains("has no attribute `unit` of dataset `extra`"), "{unit}");
}

/// A process started while a file is open inherits what HDF5 locked, and keeps it.
#[test]
fn a_lock_that_another_holds_on_the_file_does_not_matter() {
    let (_folder, path) = place();
    std::fs::write(&path, "").unwrap();
    let held = std::fs::File::open(&path).unwrap();
    held.lock().unwrap();
    write(&path, &datasets());
    assert_eq!(read_arrays(&path, SCHEMA, 3).unwrap().len(), 3);
}

#[test]
fn datasets_that_hdf5_cannot_hold_are_refused() {
    let (_folder, path) = place();
    let one = || dataset("a/b", vec![1.0]);
    let mut unitless = one();
    unitless.unit.clear();
    let mut twofold = one();
    twofold.attributes.insert("unit".into(), Attribute::Text("mm".into()));
    let mut nul = one();
    nul.attributes.insert("note".into(), Attribute::Text("a\0b".into()));
    let cases = [
        (vec![one(), one()], "used twice"),
        (vec![one(), dataset("a", vec![])], "name of a dataset"),
        (vec![dataset("a//b", vec![])], "must be a word"),
        (vec![dataset("", vec![])], "must be a word"),
        (vec![unitless], "unit is empty"),
        (vec![twofold], "field of its own"),
        (vec![nul], "NUL"),
    ];
    for (datasets, expected) in cases {
        let message =
            write_arrays(&path, SCHEMA, 3, "", Storage::Plain, &datasets).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
    let nowhere = path.join("none/arrays.h5");
    let message =
        write_arrays(&nowhere, SCHEMA, 3, "", Storage::Plain, &[one()]).unwrap_err().to_string();
    assert!(message.contains("none/arrays.h5"), "{message}");
}
