//! Tables as polars data frames: pretty printing and exports, never artifacts, because polars
//! drops the units.

use std::borrow::Cow;
use std::fs::File;
use std::io::{BufWriter, Cursor, Write};
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

/// Writes a data frame as CSV with a header; floats with the fewest digits that read back to the
/// same bits, absent values as nothing, lists as their values with blanks between them, since CSV
/// has none. Names that begin like the formula of a spreadsheet stand behind an apostrophe.
///
/// # Errors
/// [`ArtifactError::Io`], [`ArtifactError::Unwritable`].
pub fn write_csv(frame: &mut DataFrame, path: &Path) -> Result<(), ArtifactError> {
    export(path, |file| {
        let columns = frame.columns().iter().map(for_csv).collect::<Result<_, _>>()?;
        CsvWriter::new(file).finish(&mut DataFrame::new(frame.height(), columns)?)
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

/// Writes a data frame as Parquet.
///
/// # Errors
/// [`ArtifactError::Io`], [`ArtifactError::Unwritable`].
pub fn write_parquet(frame: &mut DataFrame, path: &Path) -> Result<(), ArtifactError> {
    export(path, |file| ParquetWriter::new(file).finish(frame).map(|_| ()))
}

fn export(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), PolarsError>,
) -> Result<(), ArtifactError> {
    let file = File::create(path).map_err(ArtifactError::io("create", path))?;
    let mut file = BufWriter::new(file);
    write(&mut file).map_err(|error| ArtifactError::Unwritable {
        path: path.to_path_buf(),
        reason: error.to_string(),
    })?;
    file.flush().map_err(ArtifactError::io("write", path))
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
        let mut frame = DataFrame::new(names.len(), columns).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("names.csv");
        write_csv(&mut frame, &path).unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        let expected =
            "name,number\n'=cmd|' /C calc'!A0,-1.5\n'@x,2.0\ntread,-3.0\na=b,4.0\n\"\",5.0\n";
        assert_eq!(text, expected);
    }
}
