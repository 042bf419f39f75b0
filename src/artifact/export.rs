//! Tables for other programs: CSV and Parquet, in memory, since there is no temporary folder that could be missing or
//! full. Never artifacts: CSV has no units.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type, UInt32Type, UInt64Type};
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch, StringArray, UInt32Array};
use arrow_schema::{ArrowError, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::errors::ParquetError;
use serde_json::{Map, Value};

use super::ArtifactError;
use super::columns::ColumnType;
use super::table::{TableFile, read_bytes};

/// A table for other programs.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportTable {
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
}

/// The values of a column that is not of an artifact.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Names.
    Text(Vec<String>),
    /// Counts; `None` where there is none.
    Count(Vec<Option<u32>>),
    /// Numbers; `None` where there is none.
    Float(Vec<Option<f64>>),
}

impl ExportTable {
    /// Any table of an artifact, after its content digest has been checked.
    ///
    /// # Errors
    /// Those of [`table_info`](super::table_info).
    pub fn read(path: &Path) -> Result<Self, ArtifactError> {
        let TableFile { schema, batches, .. } = TableFile::decode(path, read_bytes(path)?)?;
        Ok(Self { schema, batches })
    }

    /// A table of named columns that all have one length.
    ///
    /// # Errors
    /// [`ArtifactError::NotRepresentable`] for columns of different lengths.
    pub fn new(columns: impl IntoIterator<Item = (String, Values)>) -> Result<Self, ArtifactError> {
        let array = |values: Values| -> ArrayRef {
            match values {
                Values::Text(names) => Arc::new(StringArray::from(names)),
                Values::Count(counts) => Arc::new(UInt32Array::from(counts)),
                Values::Float(numbers) => Arc::new(Float64Array::from(numbers)),
            }
        };
        let columns = columns.into_iter().map(|(name, values)| (name, array(values)));
        let batch = RecordBatch::try_from_iter(columns)
            .map_err(|error| not_representable("Arrow", error.to_string()))?;
        Ok(Self { schema: batch.schema(), batches: vec![batch] })
    }

    /// Names of the columns.
    pub fn names(&self) -> Vec<String> {
        self.schema.fields().iter().map(|field| field.name().clone()).collect()
    }

    /// The same without some columns.
    ///
    /// # Errors
    /// [`ArtifactError::NotRepresentable`] if batches differ in their columns.
    pub fn without(&self, columns: &[&str]) -> Result<Self, ArtifactError> {
        let names = self.names();
        let kept = (0..names.len()).filter(|index| !columns.contains(&names[*index].as_str()));
        let kept: Vec<usize> = kept.collect();
        let failed = |error: ArrowError| not_representable("Arrow", error.to_string());
        let schema = Arc::new(self.schema.project(&kept).map_err(failed)?);
        let batches = self.batches.iter().map(|batch| batch.project(&kept));
        let batches = batches.collect::<Result<_, _>>().map_err(failed)?;
        Ok(Self { schema, batches })
    }

    /// The first rows as JSON objects, for a look at it.
    ///
    /// # Errors
    /// [`ArtifactError::NotRepresentable`] for a type that no table has.
    pub fn first_rows(&self, most: usize) -> Result<Vec<Map<String, Value>>, ArtifactError> {
        let mut rows = Vec::new();
        for batch in &self.batches {
            let part = batch.slice(0, batch.num_rows().min(most - rows.len()));
            let part: Vec<Map<String, Value>> = serde_arrow::from_record_batch(&part)
                .map_err(|error| not_representable("JSON", error.to_string()))?;
            rows.extend(part);
        }
        Ok(rows)
    }

    /// As CSV with a header; floats with the fewest digits that read back to the same bits, absent values as nothing,
    /// lists as their values with blanks between them, since CSV has none. Names that begin like the formula of a
    /// spreadsheet stand behind an apostrophe.
    ///
    /// # Errors
    /// [`ArtifactError::NotRepresentable`] for a type that no table has.
    pub fn csv(&self) -> Result<Vec<u8>, ArtifactError> {
        let failed = |error: csv::Error| not_representable("CSV", error.to_string());
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.names()).map_err(failed)?;
        for batch in &self.batches {
            let columns: Vec<CellWriter> =
                batch.columns().iter().map(|column| cells(column)).collect::<Result<_, _>>()?;
            for row in 0..batch.num_rows() {
                writer.write_record(columns.iter().map(|cell| cell(row))).map_err(failed)?;
            }
        }
        writer.into_inner().map_err(|error| not_representable("CSV", error.to_string()))
    }

    /// As Parquet, with types and units.
    ///
    /// # Errors
    /// [`ArtifactError::NotRepresentable`] for a type that Parquet does not have.
    pub fn parquet(&self) -> Result<Vec<u8>, ArtifactError> {
        let failed = |error: ParquetError| not_representable("Parquet", error.to_string());
        let mut bytes = Vec::new();
        let mut writer =
            ArrowWriter::try_new(&mut bytes, self.schema.clone(), None).map_err(failed)?;
        for batch in &self.batches {
            writer.write(batch).map_err(failed)?;
        }
        writer.close().map_err(failed)?;
        Ok(bytes)
    }
}

/// The text of the cell in a row.
type CellWriter<'a> = Box<dyn Fn(usize) -> String + 'a>;

fn cells(column: &dyn Array) -> Result<CellWriter<'_>, ArtifactError> {
    let Some(kind) = ColumnType::of_data_type(column.data_type()) else {
        let reason = format!("a column of {}", column.data_type());
        return Err(not_representable("CSV", reason));
    };
    let cell: CellWriter = match kind {
        ColumnType::Float => {
            let values = column.as_primitive::<Float64Type>();
            Box::new(|row| float(values.value(row)))
        }
        ColumnType::Unsigned32 => {
            let values = column.as_primitive::<UInt32Type>();
            Box::new(|row| values.value(row).to_string())
        }
        ColumnType::Unsigned64 => {
            let values = column.as_primitive::<UInt64Type>();
            Box::new(|row| values.value(row).to_string())
        }
        ColumnType::Integer => {
            let values = column.as_primitive::<Int64Type>();
            Box::new(|row| values.value(row).to_string())
        }
        ColumnType::Boolean => {
            let values = column.as_boolean();
            Box::new(|row| values.value(row).to_string())
        }
        ColumnType::Text => {
            let values = column.as_string::<i32>();
            Box::new(|row| spreadsheet_cell(values.value(row)).into_owned())
        }
        ColumnType::FloatList => {
            let lists = column.as_list::<i32>();
            Box::new(|row| {
                let list = lists.value(row);
                let words = list.as_primitive::<Float64Type>().iter();
                let words: Vec<String> = words.map(|x| x.map_or(String::new(), float)).collect();
                words.join(" ")
            })
        }
    };
    Ok(Box::new(move |row| if column.is_null(row) { String::new() } else { cell(row) }))
}

/// The fewest digits that read back to the same bits, as JSON has them: `2.0`, `0.00001`, `1e-6`.
fn float(value: f64) -> String {
    if value.is_finite() { Value::from(value).to_string() } else { value.to_string() }
}

/// A name as it may stand in a cell of CSV: a spreadsheet runs what begins like a formula
/// (<https://owasp.org/www-community/attacks/CSV_Injection>), but not behind an apostrophe.
fn spreadsheet_cell(text: &str) -> Cow<'_, str> {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']) {
        return Cow::Owned(format!("'{text}"));
    }
    Cow::Borrowed(text)
}

fn not_representable(format: &str, reason: String) -> ArtifactError {
    ArtifactError::NotRepresentable { what: format!("the table as {format}"), reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_no_formulas_and_numbers_stay_numbers() {
        let names = ["=cmd|' /C calc'!A0", "@x", "tread", "a=b", ""].map(str::to_owned);
        let numbers = vec![Some(-1.5), Some(2.0), None, Some(1e-5), Some(1e300)];
        let columns = [("name", Values::Text(names.to_vec())), ("number", Values::Float(numbers))];
        let table =
            ExportTable::new(columns.map(|(name, values)| (name.to_owned(), values))).unwrap();
        let text = String::from_utf8(table.csv().unwrap()).unwrap();
        let expected =
            "name,number\n'=cmd|' /C calc'!A0,-1.5\n'@x,2.0\ntread,\na=b,0.00001\n,1e+300\n";
        assert_eq!(text, expected);
        assert_eq!(table.without(&["name"]).unwrap().names(), ["number"]);
        assert_eq!(table.first_rows(1).unwrap()[0]["number"], -1.5);
    }

    #[test]
    fn columns_of_different_lengths_are_no_table() {
        let columns = [2, 3].map(|count| ("a".to_owned(), Values::Float(vec![None; count])));
        assert!(ExportTable::new(columns).unwrap_err().to_string().contains("the table as Arrow"));
    }
}
