//! Files that a user gives: read completely, if they are plain files of a reasonable size.
//!
//! | module | what it holds |
//! |---|---|
//! | [`os`] | what is different on another operating system |
//! | [`name`] | names and paths as text without loss |
//! | `located` | texts of numbers, with the place of what is wrong |
//! | `toml_error` | mistakes in TOML with line and nearest key |

mod located;
pub mod name;
pub mod os;
mod toml_error;

pub use located::{Located, cells, read_located};
pub use toml_error::{TomlError, nearest};

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Largest recipe, rubber or other file of settings that is read, in bytes. A recipe of ten thousand listed
/// scans has 1 MB.
pub const LARGEST_SETTINGS: u64 = 16 << 20;
/// Largest file of numbers in text other than a scan that is read, in bytes: a profile of the largest number of
/// grid points (16777216) in 15 digits has some 700 MB.
pub const LARGEST_NUMBERS: u64 = 1 << 30;

/// Whether what is at a path is a plain file of at most `limit` bytes. Nothing is opened: to open a named pipe
/// waits for a writer.
///
/// # Errors
/// Those of the operating system; [`io::ErrorKind::IsADirectory`], [`io::ErrorKind::InvalidInput`] for
/// devices, pipes and sockets and [`io::ErrorKind::FileTooLarge`], each with what to do.
pub fn admit(path: &Path, limit: u64) -> io::Result<()> {
    let metadata = std::fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::Error::new(
            io::ErrorKind::IsADirectory,
            "it is a folder; give the file itself",
        ));
    }
    if !metadata.is_file() {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            format!("it is {}, not a file; write its content to a file first", os::kind(&metadata)),
        ));
    }
    admit_size(metadata.len(), limit)
}

/// The bytes of a plain file of at most `limit` bytes.
///
/// # Errors
/// As [`admit`].
pub fn read(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    admit(path, limit)?;
    let mut bytes = Vec::new();
    // A file may grow after its size was asked for.
    File::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    admit_size(bytes.len() as u64, limit)?;
    Ok(bytes)
}

/// The text of a plain file of settings, UTF-8 of at most [`LARGEST_SETTINGS`] bytes.
///
/// # Errors
/// As [`admit`]; [`io::ErrorKind::InvalidData`] that names the line for what is not UTF-8.
pub fn read_settings(path: &Path) -> io::Result<String> {
    String::from_utf8(read(path, LARGEST_SETTINGS)?).map_err(|error| {
        let read = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + read.iter().filter(|byte| **byte == b'\n').count();
        io::Error::new(
            io::ErrorKind::InvalidData,
            format!("line {line} is not UTF-8 text; save the file as UTF-8"),
        )
    })
}

/// What to do, where the operating system states only what is wrong.
pub fn advice(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::NotFound => "; check the path",
        io::ErrorKind::PermissionDenied => "; give yourself read access",
        _ => "",
    }
}

fn admit_size(bytes: u64, limit: u64) -> io::Result<()> {
    if bytes <= limit {
        return Ok(());
    }
    Err(io::Error::new(
        io::ErrorKind::FileTooLarge,
        format!(
            "the file has {} MB or more, and at most {} MB are read; check that it is the right file",
            bytes >> 20,
            limit >> 20
        ),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_plain_files_of_sensible_size_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, "a = 1\nb = 'ö'\n").unwrap();
        assert_eq!(read_settings(&path).unwrap(), "a = 1\nb = 'ö'\n");
        assert_eq!(read(&path, 3).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        std::fs::write(&path, b"a = 1\nb = '\xf6'\n").unwrap();
        assert!(read_settings(&path).unwrap_err().to_string().contains("line 2 is not UTF-8"));
        let is_folder = read_settings(folder.path()).unwrap_err().to_string();
        assert!(is_folder.contains("a folder"), "{is_folder}");
        let device = read_settings(Path::new("/dev/null")).unwrap_err().to_string();
        assert!(device.contains("a device"), "{device}");
        let missing = read_settings(&folder.path().join("none")).unwrap_err();
        assert_eq!(missing.kind(), io::ErrorKind::NotFound);
    }
}
