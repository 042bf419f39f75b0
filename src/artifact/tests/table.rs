use std::path::PathBuf;

use serde_json::json;
use tempfile::TempDir;

use super::{Sample, samples};
use crate::artifact::*;

fn place() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("samples.arrow");
    (folder, path)
}

fn digest_of(rows: &[Sample]) -> Digest {
    let (_folder, path) = place();
    write_table(&path, rows, &Metadata::new()).unwrap()
}

#[test]
fn rows_and_metadata_come_back_to_the_bit() {
    let (_folder, path) = place();
    let metadata = Metadata::from([("warnings".into(), "friction over 2 “rarely”".into())]);
    let written = write_table(&path, &samples(), &metadata).unwrap();
    let (rows, found) = read_table::<Sample>(&path).unwrap();
    assert_eq!(rows, samples());
    // `==` takes both zeros for equal.
    assert_eq!(rows[0].friction.unwrap().to_bits(), (-0.0_f64).to_bits());
    assert_eq!(found, metadata);
    assert_eq!(table_info(&path).unwrap().content_digest, written);
}

#[test]
fn an_empty_table_keeps_its_columns() {
    let (_folder, path) = place();
    write_table::<Sample>(&path, &[], &Metadata::new()).unwrap();
    assert_eq!(read_table::<Sample>(&path).unwrap().0, []);
    assert_eq!(table_info(&path).unwrap().columns, columns::<Sample>().unwrap());
    let export = ExportTable::read(&path).unwrap();
    assert_eq!(export.names().len(), 10);
    assert!(export.csv().unwrap().starts_with(b"pressure_mpa,friction,"));
    assert!(export.parquet().unwrap().starts_with(b"PAR1"));
}

#[test]
fn the_file_describes_itself() {
    let (_folder, path) = place();
    write_table(&path, &samples(), &Metadata::new()).unwrap();
    let info = table_info(&path).unwrap();
    assert_eq!((info.schema.as_str(), info.version, info.rows), ("asperity.test.samples", 2, 2));
    assert_eq!(info.description, "One row with every type a column can have.");
    assert_eq!(info.tool_version, TOOL_VERSION);
    let names: Vec<_> = info.columns.iter().map(|column| column.name.as_str()).collect();
    let order = "pressure_mpa friction iterations seed offset converged surface remark amplitudes_mm elapsed_s";
    assert_eq!(names.join(" "), order);
    assert_eq!(info.columns[1].unit.as_deref(), Some("1"));
    assert_eq!(
        info.columns[1].description,
        "Friction coefficient, absent where the solve did not converge."
    );
    let nullable: Vec<_> = info.columns.iter().map(|column| column.nullable).collect();
    assert_eq!(nullable.iter().filter(|flag| **flag).count(), 2);
    assert!(nullable[1] && nullable[7]);
}

#[test]
fn equal_rows_give_equal_bytes() {
    let (_folder, path) = place();
    let metadata: Metadata = (0..20).map(|i| (format!("key {i}"), i.to_string())).collect();
    write_table(&path, &samples(), &metadata).unwrap();
    let first = std::fs::read(&path).unwrap();
    write_table(&path, &samples(), &metadata).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), first);
}

#[test]
fn only_what_is_not_volatile_changes_the_content_digest() {
    let reference = digest_of(&samples());
    let mut slower = samples();
    slower[0].elapsed_s = 99.0;
    assert_eq!(digest_of(&slower), reference);

    let changes: [fn(&mut Vec<Sample>); 11] = [
        |rows| rows[0].pressure_mpa = 0.3,
        |rows| rows[0].friction = Some(0.0),
        |rows| rows[0].iterations = 1,
        |rows| rows[0].seed = 1,
        |rows| rows[0].offset = 1,
        |rows| rows[0].converged = false,
        |rows| rows[0].surface.push(' '),
        |rows| rows[0].remark = None,
        |rows| rows[1].amplitudes_mm.push(0.0),
        |rows| rows.reverse(),
        |rows| rows.truncate(1),
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let mut changed = samples();
        change(&mut changed);
        assert_ne!(digest_of(&changed), reference, "change {index}");
    }
}

#[test]
fn a_nan_is_refused_by_column_and_row() {
    let (_folder, path) = place();
    let valid = || samples().swap_remove(1);
    let cases = [
        ("pressure_mpa", Sample { pressure_mpa: f64::NAN, ..valid() }),
        ("friction", Sample { friction: Some(f64::NAN), ..valid() }),
        ("amplitudes_mm", Sample { amplitudes_mm: vec![1.0, f64::NAN], ..valid() }),
    ];
    for (column, row) in cases {
        let rows = [valid(), row];
        let message = write_table(&path, &rows, &Metadata::new()).unwrap_err().to_string();
        assert!(message.contains(&format!("column {column}")), "{message}");
        assert!(message.contains("row 1"), "{message}");
    }
    assert!(!path.exists());
}

/// Declares a row type with the columns and name of a changed [`Sample`].
macro_rules! other_row {
    ($name:ident, $schema:literal, $version:literal, $unit:literal) => {
        /// Another row.
        #[derive(Debug, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        struct $name {
            /// Mean pressure.
            #[schemars(extend("unit" = $unit))]
            pressure_mpa: f64,
        }
        impl Row for $name {
            const SCHEMA: &'static str = $schema;
            const VERSION: u32 = $version;
        }
    };
}
other_row!(OtherName, "asperity.test.others", 2, "MPa");
other_row!(OtherVersion, "asperity.test.samples", 3, "MPa");
other_row!(OtherColumns, "asperity.test.samples", 2, "Pa");

#[test]
fn another_schema_version_or_set_of_columns_is_refused() {
    let (_folder, path) = place();
    write_table(&path, &samples(), &Metadata::new()).unwrap();
    let name = read_table::<OtherName>(&path).unwrap_err().to_string();
    assert!(name.contains("asperity.test.samples, expected asperity.test.others"), "{name}");
    let version = read_table::<OtherVersion>(&path).unwrap_err().to_string();
    assert!(
        version.contains("version 2, this tool reads version 3: run the stage again"),
        "{version}"
    );
    let columns = read_table::<OtherColumns>(&path).unwrap_err().to_string();
    assert!(columns.contains("column 0 is `pressure_mpa` (Float, MPa), expected"), "{columns}");
}

/// A type that no column has, for [`row_types_that_are_no_table_are_refused`].
#[derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
struct Nested {
    /// A vector of texts.
    names: Vec<String>,
}
impl Row for Nested {
    const SCHEMA: &'static str = "asperity.test.nested";
    const VERSION: u32 = 1;
}

/// A number without its unit.
#[derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
struct Unitless {
    /// A speed.
    speed: f64,
}
impl Row for Unitless {
    const SCHEMA: &'static str = "asperity.test.unitless";
    const VERSION: u32 = 1;
}

/// A column without description, one that is not always written.
#[derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
struct Undescribed {
    count: u32,
}
impl Row for Undescribed {
    const SCHEMA: &'static str = "asperity.test.undescribed";
    const VERSION: u32 = 1;
}

#[test]
fn row_types_that_are_no_table_are_refused() {
    let nested = columns::<Nested>().unwrap_err().to_string();
    assert!(nested.contains("column names of asperity.test.nested must be f64"), "{nested}");
    let unitless = columns::<Unitless>().unwrap_err().to_string();
    assert!(
        unitless.contains("column speed of asperity.test.unitless states no unit"),
        "{unitless}"
    );
    let undescribed = columns::<Undescribed>().unwrap_err().to_string();
    assert!(undescribed.contains("has no doc comment"), "{undescribed}");
    let (_folder, path) = place();
    let metadata = Metadata::from([("schema".into(), "mine".into())]);
    let reserved = write_table(&path, &samples(), &metadata).unwrap_err().to_string();
    assert!(reserved.contains("reserved metadata key"), "{reserved}");
}

/// A small file, so that damage can be tried at every byte: one column per kind of buffer.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
struct Small {
    /// Friction.
    #[schemars(extend("unit" = "1"))]
    friction: Option<f64>,
    /// Name.
    name: String,
    /// Amplitudes.
    #[schemars(extend("unit" = "mm"))]
    amplitudes_mm: Vec<f64>,
}
impl Row for Small {
    const SCHEMA: &'static str = "asperity.test.small";
    const VERSION: u32 = 1;
}

fn small() -> Vec<Small> {
    let first = Small { friction: Some(0.5), name: "07".into(), amplitudes_mm: vec![1.0, 2.0] };
    vec![first.clone(), Small { friction: None, ..first }]
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let (_folder, path) = place();
    write_table(&path, &small(), &Metadata::new()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    for length in 0..bytes.len() {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let error = read_table::<Small>(&path).unwrap_err();
        assert!(matches!(error, ArtifactError::Unreadable { .. }), "{length}: {error}");
    }
    std::fs::write(&path, b"pressure,friction\n0.1,0.5\n").unwrap();
    let foreign = read_table::<Small>(&path).unwrap_err().to_string();
    assert!(foreign.contains("samples.arrow cannot be read as Arrow IPC file"), "{foreign}");
}

/// The digest in the file finds a flipped bit in the values that Arrow itself cannot see, the
/// check of the layout one that would make its reader panic. What passes is padding and
/// descriptions; the manifest's digest of the bytes covers those.
#[test]
fn a_flipped_bit_never_changes_the_rows_unseen() {
    let (_folder, path) = place();
    write_table(&path, &small(), &Metadata::new()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let mut damaged = 0;
    for index in 0..bytes.len() {
        let mut flipped = bytes.clone();
        flipped[index] ^= 1 << (index % 8);
        std::fs::write(&path, &flipped).unwrap();
        match read_table::<Small>(&path) {
            Err(ArtifactError::Damaged { .. }) => damaged += 1,
            Err(_) => {}
            Ok((rows, _)) => assert_eq!(rows, small(), "byte {index}"),
        }
    }
    // At least the 5 floats and 4 letters of the rows.
    assert!(damaged >= 5 * 8 + 4, "{damaged}");
}

#[test]
fn a_foreign_arrow_file_lacks_the_schema_name() {
    use polars::prelude::*;
    let (_folder, path) = place();
    let mut frame = df!["x" => [1.0, 2.0]].unwrap();
    IpcWriter::new(std::fs::File::create(&path).unwrap()).finish(&mut frame).unwrap();
    let message = table_info(&path).unwrap_err().to_string();
    assert!(message.contains("has no metadata `schema`"), "{message}");
}

#[test]
fn polars_reads_the_values_and_exports_read_back() {
    use polars::prelude::*;
    let (folder, path) = place();
    write_table(&path, &samples(), &Metadata::new()).unwrap();
    let frame = IpcReader::new(std::fs::File::open(&path).unwrap()).finish().unwrap();
    assert_eq!((frame.height(), frame.width()), (2, 10));
    assert_eq!(frame.column("friction").unwrap().null_count(), 1);

    let parquet = folder.path().join("samples.parquet");
    std::fs::write(&parquet, ExportTable::read(&path).unwrap().parquet().unwrap()).unwrap();
    let read = ParquetReader::new(std::fs::File::open(parquet).unwrap()).finish().unwrap();
    assert!(read.equals_missing(&frame));

    let csv = folder.path().join("samples.csv");
    std::fs::write(&csv, ExportTable::read(&path).unwrap().csv().unwrap()).unwrap();
    let mut reader = ::csv::Reader::from_path(csv).unwrap();
    let lists = frame.get_column_index("amplitudes_mm").unwrap();
    let record = reader.records().next().unwrap().unwrap();
    let values: Vec<f64> = record[lists].split(' ').map(|x| x.parse().unwrap()).collect();
    assert_eq!(values, samples()[0].amplitudes_mm);
    assert_eq!(record[0].parse::<f64>().unwrap().to_bits(), (0.1_f64 + 0.2).to_bits());
    assert_eq!(&record[6], "Straße 07 – µ");
    assert_eq!(&reader.records().next().unwrap().unwrap()[1], "");
}

#[test]
fn the_json_document_lists_the_columns_in_order() {
    let document = table_schema::<Sample>().unwrap();
    assert_eq!(document["title"], "asperity.test.samples");
    assert_eq!(document["version"], 2);
    let first = json!({
        "name": "pressure_mpa", "type": "f64", "nullable": false, "unit": "MPa",
        "description": "Mean pressure.", "volatile": false,
    });
    assert_eq!(document["columns"][0], first);
    assert_eq!(document["columns"][8]["type"], "list<f64>");
    assert_eq!(document["columns"][6].get("unit"), None);
}

#[test]
fn a_full_disk_is_named_with_the_way_out() {
    let full = std::path::Path::new("/dev/full");
    let message = write_table(full, &samples(), &Metadata::new()).unwrap_err().to_string();
    assert!(message.contains("cannot write /dev/full"), "{message}");
    assert!(message.contains("free some space"), "{message}");
}
