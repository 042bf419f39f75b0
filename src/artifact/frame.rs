//! Tables as polars data frames: pretty printing and exports, never artifacts, because polars
//! drops the units.

use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

use polars::prelude::{
    Column, CsvWriter, DataFrame, DataType, IpcReader, ParquetWriter, PolarsError, SerReader,
    SerWriter,
};

use super::ArtifactError;
use super::table::{FORMAT, TableFile, read_bytes};

/// The table as a polars data frame, after its content digest has been checked.
///
/// # Errors
/// Those of [`table_info`](super::table_info).
pub fn data_frame(path: &Path) -> Result<DataFrame, ArtifactError> {
    let bytes = read_bytes(path)?;
    TableFile::decode(path, bytes.clone())?;
    IpcReader::new(Cursor::new(bytes))
        .finish()
        .map_err(|error| ArtifactError::unreadable(path, FORMAT, error))
}

/// A data frame as CSV with a header; floats with the fewest digits that read back to the
/// same bits, absent values as nothing, lists as their values with blanks between them, since CSV
/// has none. Names that begin like the formula of a spreadsheet stand behind an apostrophe.
///
/// # Errors
/// [`ArtifactError::NotRepresentable`].
pub fn csv_bytes(frame: &DataFrame) -> Result<Vec<u8>, ArtifactError> {
    export("CSV", |bytes| {
        let columns = frame.columns().iter().map(for_csv).collect::<Result<_, _>>()?;
        CsvWriter::new(bytes).finish(&mut DataFrame::new(frame.height(), columns)?)
    })
}

/// The column, the text of its lists of floats, or its names made harmless.
fn for_csv(column: &Column) -> Result<Column, PolarsError> {
    match column.dtype() {
        DataType::String => {
            let cells = column.str()?.iter().map(|name| name.map(spreadsheet_cell));
            Ok(Column::new(column.name().clone(), cells.collect::<Vec<_>>()))
        }
        DataType::List(_) => without_lists(column),
        _ => Ok(column.clone()),
    }
}

/// A name as it may stand in a cell of CSV: a spreadsheet runs what begins like a formula
/// (<https://owasp.org/www-community/attacks/CSV_Injection>), but not behind an apostrophe.
fn spreadsheet_cell(text: &str) -> Cow<'_, str> {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']) {
        return Cow::Owned(format!("'{text}"));
    }
    Cow::Borrowed(text)
}

fn without_lists(column: &Column) -> Result<Column, PolarsError> {
    let mut cells: Vec<Option<String>> = Vec::with_capacity(column.len());
    for list in column.list()?.series_iter() {
        let text = list.map(|list| {
            let values = list.f64()?.iter();
            let words: Vec<String> =
                values.map(|x| x.map_or(String::new(), |x| x.to_string())).collect();
            Ok::<_, PolarsError>(words.join(" "))
        });
        cells.push(text.transpose()?);
    }
    Ok(Column::new(column.name().clone(), cells))
}

/// A data frame as Parquet.
///
/// # Errors
/// [`ArtifactError::NotRepresentable`].
pub fn parquet_bytes(frame: &mut DataFrame) -> Result<Vec<u8>, ArtifactError> {
    export("Parquet", |bytes| ParquetWriter::new(bytes).finish(frame).map(drop))
}

/// In memory: there is no temporary folder that could be missing or full.
fn export(
    format: &str,
    write: impl FnOnce(&mut Vec<u8>) -> Result<(), PolarsError>,
) -> Result<Vec<u8>, ArtifactError> {
    let mut bytes = Vec::new();
    write(&mut bytes).map_err(|error| ArtifactError::NotRepresentable {
        what: format!("the table as {format}"),
        reason: error.to_string(),
    })?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_no_formulas_and_numbers_stay_numbers() {
        let names = ["=cmd|' /C calc'!A0", "@x", "tread", "a=b", ""];
        let numbers = [-1.5, 2.0, -3.0, 4.0, 5.0];
        let columns =
            vec![Column::new("name".into(), names), Column::new("number".into(), numbers)];
        let frame = DataFrame::new(names.len(), columns).unwrap();
        let text = String::from_utf8(csv_bytes(&frame).unwrap()).unwrap();
        let expected =
            "name,number\n'=cmd|' /C calc'!A0,-1.5\n'@x,2.0\ntread,-3.0\na=b,4.0\n\"\",5.0\n";
        assert_eq!(text, expected);
    }
}
