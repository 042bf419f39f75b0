//! What can be wrong with an instrument file.

use std::fmt;
use std::path::Path;

/// An instrument file that cannot be read: which one, where, what was found and what expected.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {problem}")]
pub struct FileError {
    /// Path or name of the file.
    pub file: String,
    /// What is wrong.
    #[source]
    pub problem: FileProblem,
}

impl FileError {
    /// The same error, told of the file at `path`.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        Self { file: path.display().to_string(), ..self }
    }
}

/// A place within an instrument file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// Offset in bytes from the start of the file.
    Byte(usize),
    /// Line, counted from 1.
    Line(usize),
    /// Element of the XML document, from the root, such as `Record3/MatrixDimension/SizeX`.
    Element(String),
    /// Member of an archive.
    Member(String),
    /// Number of a height in the order of the file, counted from 1.
    Height(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Byte(offset) => write!(out, "byte {offset}"),
            Self::Line(line) => write!(out, "line {line}"),
            Self::Element(path) => write!(out, "element {path}"),
            Self::Member(name) => write!(out, "archive member {name}"),
            Self::Height(number) => write!(out, "height {number}"),
        }
    }
}

/// What is wrong with an instrument file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileProblem {
    /// The operating system refused.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// The file ends before what its header declares.
    #[error(
        "{what} needs {needed} bytes from byte {offset} on, but the file has {length}; copy it again"
    )]
    Truncated {
        /// What is read there.
        what: &'static str,
        /// Where it starts.
        offset: usize,
        /// Its length.
        needed: u64,
        /// Length of the file.
        length: usize,
    },
    /// A value that the format does not allow there.
    #[error("{place}: {what} is {found}, expected {expected}")]
    Unexpected {
        /// Where.
        place: Place,
        /// Which quantity.
        what: &'static str,
        /// What stands there.
        found: String,
        /// What should.
        expected: String,
    },
    /// A size beyond what a scan has.
    #[error("{place}: {what} is {size}, above the limit of {limit}; no such scan is read")]
    TooLarge {
        /// Where it is declared or found.
        place: Place,
        /// Which quantity.
        what: &'static str,
        /// Its value.
        size: u64,
        /// The largest that is accepted.
        limit: u64,
    },
    /// The checksum of a part is not the one that the file states.
    #[error(
        "archive member {member}: its MD5 checksum is {found}, the file states {stated}; copy it again"
    )]
    Checksum {
        /// The part.
        member: String,
        /// Computed checksum.
        found: String,
        /// Stated checksum.
        stated: String,
    },
    /// A variant of the format that is not read.
    #[error("{place}: {what} is not read; {advice}")]
    Unsupported {
        /// Where it is declared.
        place: Place,
        /// The variant.
        what: String,
        /// What to do.
        advice: &'static str,
    },
    /// The archive itself is damaged.
    #[error("{place}: {reason}; copy the file again")]
    Damaged {
        /// Where.
        place: Place,
        /// What the decoder says.
        reason: String,
    },
    /// A file of another kind, which is known and not read.
    #[error("this is {what}, which is not read; {advice}")]
    Foreign {
        /// Its kind.
        what: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// All points are marked as missing.
    #[error("all {points} heights are missing; there is nothing to read, export the scan again")]
    AllMissing {
        /// Number of points.
        points: usize,
    },
}

/// Shorthand of [`FileProblem::Unexpected`].
pub(super) fn unexpected(
    place: Place,
    what: &'static str,
    found: impl fmt::Display,
    expected: impl fmt::Display,
) -> FileProblem {
    let found = shorten(&found.to_string());
    FileProblem::Unexpected { place, what, found, expected: expected.to_string() }
}

/// The start of a text from a file, printable.
fn shorten(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut start: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().nth(LONGEST).is_some() {
        start.push_str("...");
    }
    format!("`{start}`")
}
