//! Instrument files: bytes in, a [`RawScan`](crate::surface::RawScan) or an error out.
//!
//! Nothing is guessed. Files that state their units are told by their content and read natively
//! ([`mod@file`]); of text files, units, columns and markers of missing points come from a description
//! in the recipe (a sheet of a workbook is text to it: [`spreadsheet`]), and what does not fit it is an error that names the line and the key to change.
//! [`text_shape`] looks at a text and proposes such a description.

#[cfg(test)]
mod cases;
mod decode;
pub mod description;
pub mod error;
pub mod file;
mod lattice;
pub mod spreadsheet;
mod text;
pub mod text_shape;
mod thousands;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

pub use description::TextFormat;
pub use error::{ScanError, ScanProblem};
pub use file::{FileError, FileProblem};
pub use text::{Described, parse_described, parse_text, read_described, read_text};

/// Largest file that is read, in bytes: one is held in memory as a whole, beside its points. As
/// text these are some 80 million points, 80 m of road in steps of 1 µm.
pub const LARGEST_FILE: u64 = 1 << 30;

/// The bytes of a file of at most [`LARGEST_FILE`] bytes.
///
/// # Errors
/// Those of the operating system; [`io::ErrorKind::FileTooLarge`] that says what to do, also for
/// what has no end (`/dev/zero`).
pub fn read_bytes(path: &Path) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    admit_size(file.metadata()?.len())?;
    let mut bytes = Vec::new();
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes)?;
    admit_size(bytes.len() as u64)?;
    Ok(bytes)
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
            "the file has {} MB or more, and files of at most {} MB are read; cut it into parts, each of which is a \
             scan, or export fewer points from the instrument",
            mega(bytes),
            mega(LARGEST_FILE)
        ),
    ))
}
