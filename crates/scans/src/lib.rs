//! Instrument files: bytes in, a [`RawScan`](asperity_core::surface::RawScan) or an error out.
//!
//! Nothing is guessed. Files that state their units are recognised by their content and read natively ([`mod@file`]);
//! of text files, units, columns and markers of missing points come from a description in the recipe (a sheet of a
//! workbook is text to it: [`spreadsheet`]), and what does not fit it is an error that names the line and the key to
//! change. [`text_shape`] looks at a text and proposes such a description.
//!
//! | module | what it holds |
//! |---|---|
//! | `source`, `packed` | a file as a stream of known length; how far compressed data may unpack |
//! | [`mod@file`] | files of instruments |
//! | [`description`] | the description of a text file |
//! | `text`, [`spreadsheet`] | text files and sheets of workbooks, read as a description says |
//! | `cells` | lines, cells and decimal mark of a table of text |
//! | `decode`, `lines`, `last_number`, `thousands` | lines and words of a text; numbers that were cut off; separated thousands |
//! | `lattice` | the grid of a height map whose points are listed one by one |
//! | [`text_shape`] | what a text looks like, and the description that would read it |
//! | [`sweeps`] | measured moduli and shift factors |
//! | [`error`] | what can be wrong with a scan file |
//! | `cases` | tests on files from laboratories |

#[cfg(test)]
mod cases;
pub mod cells;
mod decode;
pub mod description;
pub mod error;
pub mod file;
mod last_number;
mod lattice;
mod lines;
mod packed;
mod source;
pub mod spreadsheet;
pub mod sweeps;
mod text;
pub mod text_shape;
pub(crate) mod thousands;

use asperity_files as files;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

pub use description::TextFormat;
pub use error::{ScanError, ScanProblem};
pub use file::{FileError, FileProblem};
pub use source::Source;
pub use text::{Described, parse_described, parse_text, read_described, read_source, read_text};

/// Largest file of which all bytes are in memory, in bytes: X3P, whose directory is at its end,
/// texts of Gwyddion, whose spacing follows from the number of rows, and what is described or
/// converted. All others are read as streams and may be larger.
pub const LARGEST_FILE: u64 = 1 << 30;

/// The bytes of a file of at most [`LARGEST_FILE`] bytes.
///
/// # Errors
/// Those of the operating system; [`io::ErrorKind::FileTooLarge`] and, for what is not a plain file,
/// [`io::ErrorKind::InvalidInput`] or [`io::ErrorKind::IsADirectory`], each with what to do.
pub fn read_bytes(path: &Path) -> io::Result<Vec<u8>> {
    admit(path)?;
    let mut bytes = Vec::new();
    // A file may grow after its size was asked for.
    File::open(path)?.take(LARGEST_FILE + 1).read_to_end(&mut bytes)?;
    admit_size(bytes.len() as u64)?;
    Ok(bytes)
}

/// Whether what is at a path is a plain file that [`read_bytes`] reads; it is not opened.
///
/// # Errors
/// As [`read_bytes`].
pub fn admit(path: &Path) -> io::Result<()> {
    files::admit(path, u64::MAX)?;
    admit_size(std::fs::metadata(path)?.len())
}

/// Whether a file of that many bytes is read.
///
/// # Errors
/// As [`read_bytes`].
pub fn admit_size(bytes: u64) -> io::Result<()> {
    if bytes <= LARGEST_FILE {
        return Ok(());
    }
    let mega = |bytes: u64| bytes / 1_000_000;
    Err(io::Error::new(
        io::ErrorKind::FileTooLarge,
        format!(
            "the file has {} MB or more, and at most {} MB are held in memory; export fewer points, cut it into parts, \
             each of which is a scan, or save it as SDF (binary), uncompressed Digital Surf, ERD or text of two columns, \
             which are read row by row by `run` and `inspect`",
            mega(bytes),
            mega(LARGEST_FILE)
        ),
    ))
}

/// Whether a large file is worth reading to its end, by its start: whether it is one of those
/// that are read as streams, and whether it holds what it declares.
///
/// # Errors
/// As [`admit_size`]; [`io::ErrorKind::InvalidData`] that says what is wrong with the file.
pub fn admit_source(source: Source<'_>) -> io::Result<()> {
    let length = source.length();
    if length <= LARGEST_FILE {
        return Ok(());
    }
    let invalid = |problem: String| io::Error::new(io::ErrorKind::InvalidData, problem);
    match file::Format::detect(source.start()) {
        Some(file::Format::X3p | file::Format::Gwyddion) => admit_size(length),
        Some(_) => file::open(source).map(|_| ()).map_err(|problem| invalid(problem.to_string())),
        None if is_binary(source.start()) => {
            Err(invalid(format!("{} (of {length} bytes)", ScanProblem::Binary)))
        }
        None => Ok(()),
    }
}

/// Whether bytes are not text: only UTF-16 has zeros, in every second byte.
fn is_binary(start: &[u8]) -> bool {
    start.windows(4).any(|four| four == [0; 4])
}
