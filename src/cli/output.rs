//! Standard output and files.

use std::fmt::Display;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::CliError;
use asperity::artifact::temporary_beside;
use asperity::text::{cut, visible, visible_line};

/// Prints a result to standard output, with control characters of names made visible. A closed pipe, as
/// before `head`, is not an error.
///
/// # Errors
/// [`CliError::Failure`] if standard output cannot be written.
pub(super) fn print(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    match out.write_all(visible(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::failure(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a note or a warning to standard error.
pub(super) fn note(quiet: bool, text: impl Display) {
    if !quiet {
        // A closed standard error must not end a computation.
        let _ = writeln!(io::stderr(), "{}", cut(&visible(&text.to_string())));
    }
}

/// A value as pretty JSON with a line end.
///
/// # Errors
/// [`CliError::Failure`] if it has no JSON form.
pub(super) fn json(value: &impl serde::Serialize) -> Result<String, CliError> {
    let text = serde_json::to_string_pretty(value).map_err(CliError::failure)?;
    Ok(text + "\n")
}

/// Lines of a name and a value, the values aligned.
pub(super) fn aligned(lines: &[(&str, String)]) -> String {
    let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let line = |(name, value): &(&str, String)| {
        let value = value.replace('\n', &format!("\n{:width$}  ", ""));
        format!("{name:<width$}  {value}\n")
    };
    lines.iter().map(line).collect()
}

/// A number with six significant digits, in exponential form where the plain one would be long.
pub(super) fn significant(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || !value.is_finite() {
        format!("{value}")
    } else if (1e-4..1e6).contains(&magnitude) {
        // Rounding to a power of ten adds a digit, as in 0.99999999 -> 1.000000.
        let decimals = 5 - magnitude.log10().floor() as i32;
        format!("{value:.*}", decimals.max(0) as usize)
    } else {
        format!("{value:.5e}")
    }
}

/// Writes a file under a temporary name, forces it to the disk and renames it, so that a crash leaves the old file
/// or the new one. The target of a link is written in the same way; a device or a pipe (`/dev/stdout`) directly.
///
/// # Errors
/// [`CliError::Failure`] that names the file; a file that exists and must not be overwritten is
/// [`CliError::Input`].
pub(super) fn write_file(
    path: &Path,
    overwrite: bool,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), CliError> {
    if let Some(folder) = missing_folder(path) {
        return Err(no_such_folder(path, folder));
    }
    let failed = |error: io::Error| match error.kind() {
        io::ErrorKind::AlreadyExists => already_exists(path),
        _ => CliError::failure(format!("cannot write {}: {error}", path.display())),
    };
    let there = fs::metadata(path);
    // Nothing is lost in a device or a pipe; the target of a dangling link may be on a disk that is not mounted.
    let stream = there.as_ref().is_ok_and(|there| !there.is_file() && !there.is_dir());
    if !overwrite && !stream && fs::symlink_metadata(path).is_ok() {
        return Err(already_exists(path));
    }
    match there {
        Ok(there) if !there.is_file() => {
            File::create(path).and_then(|file| buffered(file, write)).map_err(failed)
        }
        Ok(_) => {
            let target = fs::canonicalize(path).map_err(failed)?;
            write_durably(&target, overwrite, write).map_err(failed)
        }
        Err(_) => write_durably(path, overwrite, write).map_err(failed),
    }
}

/// The folder in which a file is to be written, if it does not exist.
fn missing_folder(path: &Path) -> Option<&Path> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty())?;
    (!folder.exists()).then_some(folder)
}

fn no_such_folder(path: &Path, folder: &Path) -> CliError {
    CliError::input(format!(
        "cannot write {}: there is no folder {}; make it first",
        path.display(),
        folder.display()
    ))
}

/// Fails if a file exists and must not be overwritten, or if its folder does not exist. Called before a long
/// computation whose result the file will hold.
///
/// # Errors
/// [`CliError::Input`].
pub(super) fn refuse_existing(path: Option<&Path>, overwrite: bool) -> Result<(), CliError> {
    let Some(path) = path else { return Ok(()) };
    if let Some(folder) = missing_folder(path) {
        return Err(no_such_folder(path, folder));
    }
    if !overwrite && (path.is_file() || path.is_symlink() && !path.exists()) {
        return Err(already_exists(path));
    }
    Ok(())
}

/// The error for a file that must not be overwritten.
pub(super) fn already_exists(path: &Path) -> CliError {
    let path = visible_line(&path.to_string_lossy()).into_owned();
    CliError::input(format!("{path} exists already: choose another place, or give --force"))
}

fn write_durably(
    path: &Path,
    overwrite: bool,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    // The full message would name the temporary file.
    let mut file = temporary_beside(path).map_err(|error| io::Error::from(error.kind()))?;
    buffered(file.as_file_mut(), write)?;
    file.as_file().sync_all()?;
    let persisted = if overwrite { file.persist(path) } else { file.persist_noclobber(path) };
    persisted.map_err(|error| error.error)?;
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    File::open(folder)?.sync_all()
}

fn buffered(
    file: impl Write,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut file = BufWriter::new(file);
    write(&mut file)?;
    file.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_significant_digits() {
        let cases = [
            (0.664551234, "0.664551"),
            (12.3456789, "12.3457"),
            (123456.789, "123457"),
            (-0.000123456789, "-0.000123457"),
            (1.23456789e-12, "1.23457e-12"),
            (1.23456789e6, "1.23457e6"),
            (0.0, "0"),
        ];
        for (value, expected) in cases {
            assert_eq!(significant(value), expected);
        }
    }

    #[test]
    fn values_are_aligned_also_over_several_lines() {
        let text = aligned(&[("a", "1".into()), ("long", "2\n3".into())]);
        assert_eq!(text, "a     1\nlong  2\n      3\n");
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fields.csv");
        write_file(&path, false, |out| out.write_all(b"old")).unwrap();
        let error = write_file(&path, true, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("no more"))
        });
        assert_eq!(error.unwrap_err().exit_code(), 1);
        let refused = write_file(&path, false, |out| out.write_all(b"new")).unwrap_err();
        assert_eq!(refused.exit_code(), 2);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        write_file(&path, true, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }

    #[test]
    fn a_link_is_not_written_through_unasked_and_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        std::os::unix::fs::symlink(&target, &link).unwrap();
        // Also where it leads nowhere yet.
        assert!(write_file(&link, false, |out| out.write_all(b"new")).is_err());
        fs::write(&target, "old").unwrap();
        assert!(write_file(&link, false, |out| out.write_all(b"new")).is_err());
        let half = write_file(&link, true, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("no more"))
        });
        assert!(half.is_err());
        assert_eq!(fs::read(&target).unwrap(), b"old");
        write_file(&link, true, |out| out.write_all(b"new")).unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read(&target).unwrap(), b"new");
    }
}
