//! Tables as polars data frames: pretty printing and exports, never artifacts, because polars
//! drops the units.

use std::fs::File;
use std::io::{BufWriter, Cursor, Write};
use std::path::Path;

use polars::prelude::{
    CsvWriter, DataFrame, IpcReader, ParquetWriter, PolarsError, SerReader, SerWriter,
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
/// same bits, absent values as nothing.
///
/// # Errors
/// [`ArtifactError::Io`]; [`ArtifactError::Unwritable`] for a column of lists, which CSV has not.
pub fn write_csv(frame: &mut DataFrame, path: &Path) -> Result<(), ArtifactError> {
    export(path, |file| CsvWriter::new(file).finish(frame))
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
