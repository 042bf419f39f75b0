//! What can go wrong with a file, and what to do about it.

use crate::error_kind::{ErrorKind, HasKind};
use std::io;
use std::path::{Path, PathBuf};

use super::Digest;

/// Failure to write, read or trust an artifact.
#[derive(Debug, thiserror::Error)]
pub enum ArtifactError {
    /// The operating system refused.
    #[error("cannot {action} {}: {cause}{}", .path.display(), advice(.cause))]
    Io {
        /// What was attempted, an infinitive such as `write`.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the operating system answered.
        cause: io::Error,
    },
    /// The file cannot be decoded at all.
    #[error(
        "{} cannot be read as {format} ({reason}); it is truncated, damaged or of another kind: delete {} and run the stage again",
        .path.display(),
        what_to_delete(.path)
    )]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What it should have been, such as `Arrow IPC file`.
        format: &'static str,
        /// What the decoder stumbled over.
        reason: String,
    },
    /// A stage reads what it does not declare, so that the key of its result would not know it: a mistake in the code
    /// of the stage.
    #[error("a stage reads {stage}/{file} without declaring it: add it to what its contract reads")]
    Undeclared {
        /// The stage whose result is read.
        stage: String,
        /// The file.
        file: String,
    },
    /// The format library refused to write.
    #[error("cannot write {}: {reason}; free some space, or give yourself write access to its folder", .path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the library said.
        reason: String,
    },
    /// The file holds something else.
    #[error("{} holds {found}, expected {expected}: give the file of the right stage", .path.display())]
    WrongSchema {
        /// The file.
        path: PathBuf,
        /// Schema name found.
        found: String,
        /// Schema name asked for.
        expected: String,
    },
    /// The file was written by another version of the tool.
    #[error(
        "{} holds {schema} version {found}, this tool reads version {expected}: run the stage again, or use the tool that wrote it",
        .path.display()
    )]
    WrongVersion {
        /// The file.
        path: PathBuf,
        /// Schema name.
        schema: String,
        /// Version found.
        found: u32,
        /// Version asked for.
        expected: u32,
    },
    /// The columns are not those of the schema although name and version are.
    #[error("{} does not have the columns of {schema}: {reason}; run the stage again", .path.display())]
    WrongColumns {
        /// The file.
        path: PathBuf,
        /// Schema name.
        schema: String,
        /// The first difference.
        reason: String,
    },
    /// A value that is no number was about to be written to a table.
    #[error(
        "column {column} of {schema} is NaN in row {row} (counted from 0): an unconverged or undefined result is not a number, leave it empty (Option) or drop the row"
    )]
    NotANumber {
        /// Schema name.
        schema: String,
        /// Column name.
        column: String,
        /// Row, counted from 0.
        row: usize,
    },
    /// A row type that cannot be a table; a mistake in the program, not in the data.
    #[error("column {column} of {schema} {reason}")]
    RowType {
        /// Schema name.
        schema: String,
        /// Column name, or the metadata key.
        column: String,
        /// What is wrong and what is possible.
        reason: String,
    },
    /// A set of arrays that cannot be a file; a mistake in the program, not in the data.
    #[error("dataset `{name}` cannot be written: {reason}")]
    Dataset {
        /// Dataset name.
        name: String,
        /// What is wrong and what is possible.
        reason: String,
    },
    /// A dataset or attribute that every file of the kind has is missing.
    #[error("{} has no {what}: it was not written by this tool or is damaged; run the stage again", .path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// What is missing, such as ``attribute `unit` of dataset `a/b` ``.
        what: String,
    },
    /// The content is not what was written.
    #[error(
        "{} was changed or damaged after it was written (digest {found:#}, written as {expected:#}): {}",
        .path.display(), mend(.path)
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Digest in the manifest or the file itself.
        expected: Digest,
        /// Digest of what is there.
        found: Digest,
    },
    /// The file is shorter or longer than its manifest says.
    #[error(
        "{} has {found} bytes, its manifest says {expected}: it was truncated or replaced; {}",
        .path.display(), mend(.path)
    )]
    WrongSize {
        /// The file.
        path: PathBuf,
        /// Bytes according to the manifest.
        expected: u64,
        /// Bytes found.
        found: u64,
    },
    /// A file or link that asperity did not write is where it would write.
    #[error("{} {what}: {remedy}", .path.display())]
    Foreign {
        /// The file or link.
        path: PathBuf,
        /// What it is.
        what: String,
        /// What to do.
        remedy: String,
    },
    /// Another process works in the folder.
    #[error("another run is using {}{}: wait for it or choose another --out", .path.display(), in_brackets(.holder))]
    Locked {
        /// The output folder.
        path: PathBuf,
        /// What the other process says of itself, such as `process 4711`; may be empty.
        holder: String,
    },
    /// The stage has not been run, or not to its end.
    #[error("{} holds no finished result of the stage `{stage}`: run it first", .path.display())]
    NoResult {
        /// The output folder.
        path: PathBuf,
        /// Stage name.
        stage: String,
    },
    /// The result exists but does not have the file.
    #[error("the result of the stage `{stage}` has no file `{file}`, it has: {available}")]
    NoSuchOutput {
        /// Stage name.
        stage: String,
        /// File asked for.
        file: String,
        /// Files of the result.
        available: String,
    },
    /// A value has no JSON form that reads back.
    #[error("{what} cannot be kept as JSON ({reason}); numbers must be finite, keys must be text")]
    NotRepresentable {
        /// What was to be kept.
        what: String,
        /// What the serialiser said.
        reason: String,
    },
    /// A committed schema is not the one of the program.
    #[error(
        "{} is out of date: a table or array that others read has changed; raise its version, write the schemas with `ASPERITY_UPDATE_SCHEMAS=1 cargo test --release --test stages schemas` and commit them",
        .path.display()
    )]
    SchemaDrift {
        /// The committed file.
        path: PathBuf,
    },
}

impl HasKind for ArtifactError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Io { action, cause, .. } => of_io(action, cause),
            // A result that was given to be read and is another one, damaged or not there.
            Self::Unreadable { .. }
            | Self::WrongSchema { .. }
            | Self::WrongVersion { .. }
            | Self::WrongColumns { .. }
            | Self::Missing { .. }
            | Self::Damaged { .. }
            | Self::WrongSize { .. }
            | Self::Foreign { .. }
            | Self::NoResult { .. }
            | Self::NoSuchOutput { .. } => ErrorKind::Input,
            Self::Unwritable { .. }
            | Self::Undeclared { .. }
            | Self::NotANumber { .. }
            | Self::RowType { .. }
            | Self::Dataset { .. }
            | Self::Locked { .. }
            | Self::NotRepresentable { .. }
            | Self::SchemaDrift { .. } => ErrorKind::Failure,
        }
    }
}

impl ArtifactError {
    /// Closure for `map_err` that adds what was attempted and where.
    pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |cause| Self::Io { action, path, cause }
    }

    pub(super) fn unreadable(path: &Path, format: &'static str, reason: impl ToString) -> Self {
        Self::Unreadable { path: path.to_path_buf(), format, reason: reason.to_string() }
    }

    /// Compares the schema of a file with the one asked for, name first.
    pub(super) fn check_schema(
        path: &Path,
        found: (&str, u32),
        expected: (&str, u32),
    ) -> Result<(), Self> {
        let path = path.to_path_buf();
        if found.0 != expected.0 {
            let (found, expected) = (found.0.to_owned(), expected.0.to_owned());
            return Err(Self::WrongSchema { path, found, expected });
        }
        if found.1 != expected.1 {
            let schema = found.0.to_owned();
            return Err(Self::WrongVersion { path, schema, found: found.1, expected: expected.1 });
        }
        Ok(())
    }

    /// Compares a digest with the recorded one.
    pub(super) fn check_digest(path: &Path, expected: Digest, found: Digest) -> Result<(), Self> {
        if expected == found {
            return Ok(());
        }
        Err(Self::Damaged { path: path.to_path_buf(), expected, found })
    }
}

fn in_brackets(holder: &str) -> String {
    if holder.is_empty() { String::new() } else { format!(" ({holder})") }
}

/// How a damaged file is made again: what stands beside it may be of others.
fn mend(path: &Path) -> &'static str {
    if path.extension().is_some_and(|extension| extension == super::PACK_EXTENSION) {
        "run its shard again, which solves anew what is missing"
    } else if path.ends_with(super::Manifest::FILE) {
        "if nothing in its folder is yours, delete that folder and run the stage again"
    } else {
        "run the stage again, which replaces it"
    }
}

/// What to do about the failures of the operating system that a user can mend.
fn advice(cause: &io::Error) -> &'static str {
    match cause.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "; free some space or choose another --out"
        }
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "; give yourself write access or choose another --out"
        }
        io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
            "; a file is in the way, choose another --out"
        }
        io::ErrorKind::NotFound => "; check the path",
        io::ErrorKind::IsADirectory => "; a folder is in the place of a file: move it away",
        _ => "",
    }
}

/// A file that is not there or not open to the user was given to be read, or a path where something of another
/// kind is; everything else is the disk.
fn of_io(action: &str, cause: &io::Error) -> ErrorKind {
    use io::ErrorKind as Os;
    let reads = matches!(action, "read" | "open");
    match cause.kind() {
        Os::AlreadyExists | Os::NotADirectory | Os::IsADirectory => ErrorKind::Input,
        Os::NotFound | Os::PermissionDenied if reads => ErrorKind::Input,
        _ => ErrorKind::Failure,
    }
}

/// A stage without its manifest is a folder that nobody knows who wrote, so that both go.
fn what_to_delete(path: &std::path::Path) -> &'static str {
    match path.file_name() {
        Some(name) if name == super::Manifest::FILE => "its folder",
        _ => "it",
    }
}
