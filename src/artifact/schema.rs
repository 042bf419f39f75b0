//! The committed JSON documents that describe the artifacts.

use std::path::Path;

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
