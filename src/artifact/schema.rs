//! The committed JSON documents that describe the artifacts.

use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};

use super::columns::table_description;
use super::{ArtifactError, Row, columns};

/// JSON document of a table: schema name, version, description and the columns in order with type,
/// unit and description.
///
/// # Errors
/// [`ArtifactError::RowType`] if the row type is no table.
pub fn table_schema<R: Row>() -> Result<Value, ArtifactError> {
    Ok(json!({
        "title": R::SCHEMA,
        "version": R::VERSION,
        "format": "Arrow IPC file",
        "description": table_description::<R>(),
        "columns": columns::<R>()?,
    }))
}

/// What every file of arrays of one kind holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArraysSchema {
    /// Schema name.
    #[serde(rename = "title")]
    pub schema: &'static str,
    /// Schema version.
    pub version: u32,
    /// What the file holds; also in the file itself.
    pub description: &'static str,
    /// Kinds of datasets.
    pub datasets: Vec<DatasetSchema>,
}

/// One kind of dataset in a file of arrays; its values are 64-bit floating-point numbers in one
/// dimension.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DatasetSchema {
    /// Path in the file with placeholders in braces, such as `{scan}/{window}`.
    pub path: &'static str,
    /// Unit of the values.
    pub unit: &'static str,
    /// What the values are.
    pub description: &'static str,
    /// Attributes besides `unit`; each dataset has all of them.
    pub attributes: Vec<AttributeSchema>,
}

/// One attribute of a dataset.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AttributeSchema {
    /// Its name, with the unit.
    pub name: &'static str,
    /// `f64` or `string`.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// What it says.
    pub description: &'static str,
}

/// JSON document of a kind of file of arrays.
pub fn arrays_schema(schema: &ArraysSchema) -> Value {
    let mut document = json!(schema);
    document["format"] = json!("HDF5 file of arrays");
    document
}

/// Compares the file `dir/name.json` with `value`, or writes it if `update` is set.
///
/// # Errors
/// [`ArtifactError::SchemaDrift`] if they differ as JSON, [`ArtifactError::Io`] if the file cannot
/// be read or written.
pub fn check_or_write(
    dir: &Path,
    name: &str,
    value: &Value,
    update: bool,
) -> Result<(), ArtifactError> {
    let path = dir.join(format!("{name}.json"));
    if update {
        std::fs::create_dir_all(dir).map_err(ArtifactError::io("create", dir))?;
        return std::fs::write(&path, format!("{value:#}\n"))
            .map_err(ArtifactError::io("write", &path));
    }
    let committed = std::fs::read(&path).map_err(ArtifactError::io("read", &path))?;
    match serde_json::from_slice::<Value>(&committed) {
        Ok(committed) if committed == *value => Ok(()),
        _ => Err(ArtifactError::SchemaDrift { path }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drifted_or_missing_document_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("schemas");
        let value = json!({ "title": "a", "version": 1 });
        let missing = check_or_write(&dir, "a", &value, false).unwrap_err();
        assert!(matches!(missing, ArtifactError::Io { .. }));
        check_or_write(&dir, "a", &value, true).unwrap();
        check_or_write(&dir, "a", &value, false).unwrap();
        let drift = check_or_write(&dir, "a", &json!({ "title": "a", "version": 2 }), false);
        assert!(drift.unwrap_err().to_string().contains("a.json is out of date"));
    }
}
