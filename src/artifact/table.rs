//! Tables as Arrow IPC files.
//!
//! A file carries its schema name, version and content digest in the schema metadata, unit and
//! description in the field metadata. Equal rows give equal bytes.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_array::{Float64Array, RecordBatch};
use arrow_ipc::reader::FileReader;
use arrow_ipc::writer::FileWriter;
use arrow_schema::{ArrowError, FieldRef, Schema, SchemaRef};
use serde::Serialize;

use super::columns::table_description;
use super::content::table_content_digest;
use super::layout::check_layout;
use super::{ArtifactError, Column, ColumnType, Digest, Row, TOOL_VERSION, columns};

/// Free key/value pairs of a table, such as warnings; no part of the content digest.
pub type Metadata = BTreeMap<String, String>;

pub(super) const FORMAT: &str = "Arrow IPC file";
const RESERVED: [&str; 5] = ["schema", "version", "tool_version", "description", "content_digest"];

/// What a table says about itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableInfo {
    /// Schema name.
    pub schema: String,
    /// Schema version.
    pub version: u32,
    /// Version of the tool that wrote the file.
    pub tool_version: String,
    /// What one row is.
    pub description: String,
    /// Digest of schema and values without the volatile columns.
    pub content_digest: Digest,
    /// Number of rows.
    pub rows: usize,
    /// Columns in order.
    pub columns: Vec<Column>,
    /// Free key/value pairs.
    pub metadata: Metadata,
}

/// Writes rows as a table and returns the content digest.
///
/// The digest covers schema name, version, names, types, units and exact bits of all columns that
/// are not volatile. An existing file is overwritten; the data are not forced to the disk, see
/// [`Pending::commit`](super::Pending::commit).
///
/// # Errors
/// [`ArtifactError::NotANumber`] for a NaN anywhere, [`ArtifactError::RowType`] for a row type
/// that is no table or a reserved metadata key, [`ArtifactError::Io`].
pub fn write_table<R: Row>(
    path: &Path,
    rows: &[R],
    metadata: &Metadata,
) -> Result<Digest, ArtifactError> {
    let row_type = |column: &str, reason: String| ArtifactError::RowType {
        schema: R::SCHEMA.into(),
        column: column.into(),
        reason,
    };
    if let Some(key) = metadata.keys().find(|key| RESERVED.contains(&key.as_str())) {
        return Err(row_type(key, "is a reserved metadata key".into()));
    }
    let columns = columns::<R>()?;
    let fields: Vec<FieldRef> = columns.iter().map(Column::to_field).collect();
    let arrays = serde_arrow::to_arrow(&fields, rows)
        .map_err(|error| row_type("(all)", format!("cannot be filled: {error}")))?;
    let batch = RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)
        .map_err(|error| row_type("(all)", format!("cannot be filled: {error}")))?;
    refuse_nan(R::SCHEMA, &columns, &batch)?;

    let batches = [batch];
    let digest = table_content_digest(R::SCHEMA, R::VERSION, &columns, &batches);
    let mut file_metadata = metadata.clone();
    file_metadata.extend([
        ("schema".to_owned(), R::SCHEMA.to_owned()),
        ("version".to_owned(), R::VERSION.to_string()),
        ("tool_version".to_owned(), TOOL_VERSION.to_owned()),
        ("description".to_owned(), table_description::<R>()),
        ("content_digest".to_owned(), digest.to_string()),
    ]);
    let bytes = encode(&batches[0], file_metadata).map_err(|error| ArtifactError::Unwritable {
        path: path.to_path_buf(),
        reason: error.to_string(),
    })?;
    std::fs::write(path, bytes).map_err(ArtifactError::io("write", path))?;
    Ok(digest)
}

/// Reads a table that [`write_table`] wrote from the same row type.
///
/// # Errors
/// [`ArtifactError::WrongSchema`], [`ArtifactError::WrongVersion`] and
/// [`ArtifactError::WrongColumns`] if the file is another table, [`ArtifactError::Unreadable`] and
/// [`ArtifactError::Damaged`] if it is not intact, [`ArtifactError::Io`].
pub fn read_table<R: Row>(path: &Path) -> Result<(Vec<R>, Metadata), ArtifactError> {
    decode_rows(path, read_bytes(path)?)
}

/// Schema, columns with units, metadata and number of rows of any table.
///
/// # Errors
/// [`ArtifactError::Unreadable`], [`ArtifactError::Damaged`] or [`ArtifactError::Io`].
pub fn table_info(path: &Path) -> Result<TableInfo, ArtifactError> {
    Ok(TableFile::decode(path, read_bytes(path)?)?.info)
}

pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, ArtifactError> {
    std::fs::read(path).map_err(ArtifactError::io("read", path))
}

/// [`read_table`] of bytes in memory; the path serves the messages.
pub(super) fn decode_rows<R: Row>(
    path: &Path,
    bytes: Vec<u8>,
) -> Result<(Vec<R>, Metadata), ArtifactError> {
    let TableFile { info, batches, .. } = TableFile::decode(path, bytes)?;
    ArtifactError::check_schema(path, (&info.schema, info.version), (R::SCHEMA, R::VERSION))?;
    let wrong_columns = |reason: String| ArtifactError::WrongColumns {
        path: path.to_path_buf(),
        schema: R::SCHEMA.into(),
        reason,
    };
    if let Some(reason) = first_difference(&info.columns, &columns::<R>()?) {
        return Err(wrong_columns(reason));
    }
    let mut rows = Vec::with_capacity(info.rows);
    for batch in &batches {
        let part: Vec<R> = serde_arrow::from_record_batch(batch)
            .map_err(|error| wrong_columns(error.to_string()))?;
        rows.extend(part);
    }
    Ok((rows, info.metadata))
}

/// A decoded file whose content digest has been checked.
pub(super) struct TableFile {
    pub(super) info: TableInfo,
    pub(super) schema: SchemaRef,
    /// Empty if there are no rows.
    pub(super) batches: Vec<RecordBatch>,
}

impl TableFile {
    pub(super) fn decode(path: &Path, bytes: Vec<u8>) -> Result<Self, ArtifactError> {
        let unreadable =
            |error: ArrowError| ArtifactError::unreadable(path, FORMAT, error.to_string());
        check_layout(&bytes).map_err(unreadable)?;
        let reader = FileReader::try_new(Cursor::new(bytes), None).map_err(unreadable)?;
        let schema = reader.schema();
        let batches: Vec<RecordBatch> = reader.collect::<Result<_, _>>().map_err(unreadable)?;

        let mut metadata: Metadata =
            schema.metadata().iter().map(|(key, value)| (key.clone(), value.clone())).collect();
        let mut take = |key: &str| {
            let what = format!("metadata `{key}`");
            metadata.remove(key).ok_or(ArtifactError::Missing { path: path.to_path_buf(), what })
        };
        let invalid = |reason: String| ArtifactError::unreadable(path, FORMAT, reason);
        let name = take("schema")?;
        let version = take("version")?
            .parse()
            .map_err(|error| invalid(format!("its schema version is not a number: {error}")))?;
        let tool_version = take("tool_version")?;
        let description = take("description")?;
        let recorded = take("content_digest")?.parse().map_err(invalid)?;
        let columns = schema
            .fields()
            .iter()
            .map(|field| {
                Column::of_field(field).ok_or_else(|| {
                    invalid(format!("column {} is {}", field.name(), field.data_type()))
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        let found = table_content_digest(&name, version, &columns, &batches);
        ArtifactError::check_digest(path, recorded, found)?;
        let info = TableInfo {
            schema: name,
            version,
            tool_version,
            description,
            content_digest: found,
            rows: batches.iter().map(RecordBatch::num_rows).sum(),
            columns,
            metadata,
        };
        Ok(Self { info, schema, batches })
    }
}

fn encode(batch: &RecordBatch, metadata: Metadata) -> Result<Vec<u8>, ArrowError> {
    let schema = batch.schema().as_ref().clone().with_metadata(metadata);
    let batch = batch.clone().with_schema(Arc::new(schema))?;
    let mut writer = FileWriter::try_new(Vec::new(), &batch.schema())?;
    if batch.num_rows() > 0 {
        writer.write(&batch)?;
    }
    writer.into_inner()
}

fn refuse_nan(schema: &str, columns: &[Column], batch: &RecordBatch) -> Result<(), ArtifactError> {
    for (column, array) in columns.iter().zip(batch.columns()) {
        let has_nan = |values: &Float64Array| values.iter().flatten().any(f64::is_nan);
        let row = match column.kind {
            ColumnType::Float => {
                array.as_primitive::<Float64Type>().iter().position(|x| x.is_some_and(f64::is_nan))
            }
            ColumnType::FloatList => array
                .as_list::<i32>()
                .iter()
                .position(|list| list.is_some_and(|list| has_nan(list.as_primitive()))),
            _ => None,
        };
        if let Some(row) = row {
            let (schema, column) = (schema.to_owned(), column.name.clone());
            return Err(ArtifactError::NotANumber { schema, column, row });
        }
    }
    Ok(())
}

/// The first column that differs in name, type, nullability, unit or volatility; descriptions may.
fn first_difference(found: &[Column], expected: &[Column]) -> Option<String> {
    let text = |column: Option<&Column>| match column {
        None => "nothing".to_owned(),
        Some(Column { name, kind, nullable, unit, volatile, .. }) => {
            let unit = unit.as_deref().unwrap_or("no unit");
            let nullable = if *nullable { ", nullable" } else { "" };
            let volatile = if *volatile { ", volatile" } else { "" };
            format!("`{name}` ({kind:?}, {unit}{nullable}{volatile})")
        }
    };
    (0..found.len().max(expected.len())).find_map(|i| {
        let (found, expected) = (text(found.get(i)), text(expected.get(i)));
        (found != expected).then(|| format!("column {i} is {found}, expected {expected}"))
    })
}
