//! Tables as polars data frames: pretty printing and exports, never artifacts, because polars
//! drops the units.

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
/// has none.
///
/// # Errors
/// [`ArtifactError::Io`], [`ArtifactError::Unwritable`].
pub fn write_csv(frame: &mut DataFrame, path: &Path) -> Result<(), ArtifactError> {
    export(path, |file| {
        let columns = frame.columns().iter().map(without_lists).collect::<Result<_, _>>()?;
        CsvWriter::new(file).finish(&mut DataFrame::new(frame.height(), columns)?)
    })
}

/// The column, or the text of its lists of floats.
fn without_lists(column: &Column) -> Result<Column, PolarsError> {
    let DataType::List(_) = column.dtype() else {
        return Ok(column.clone());
    };
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
