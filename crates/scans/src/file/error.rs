//! What can be wrong with an instrument file.

use crate::lines::LineError;
use asperity_core::error_kind::{ErrorKind, HasKind};
use std::fmt;

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

impl HasKind for FileError {
    fn kind(&self) -> ErrorKind {
        // A scan is a file of the user, whatever is wrong with it.
        ErrorKind::Input
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
        "{what} must have {needed} bytes from byte {offset} on, but the file has {length}; copy it again"
    )]
    Truncated {
        /// What is read there.
        what: &'static str,
        /// Where it starts.
        offset: usize,
        /// Its length.
        needed: u64,
        /// Length of the file.
        length: u64,
    },
    /// A value that the format does not allow there.
    #[error("{place}: {what} is {found}, expected {expected}")]
    Unexpected {
        /// Where.
        place: Place,
        /// Which quantity.
        what: &'static str,
        /// What was found there.
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
    /// More points than are held in memory, in the lines of a height map that are asked for.
    #[error(
        "every {step}. line of the height map makes {points} points, and at most {} are held in memory; take every \
         {enough}. line (`map_line_step = {enough}`) or fewer",
        super::LARGEST_POINTS
    )]
    TooManyLines {
        /// Points of the lines.
        points: u64,
        /// Every how many lines one is asked for.
        step: usize,
        /// The smallest step that is read.
        enough: u64,
    },
    /// Bytes that unpack to more than heights of an instrument do.
    #[error(
        "{place}: {packed} bytes unpack to {unpacked}, more than {} times as many: no scan is packed as tightly; ask \
         where the file comes from, or save it without compression",
        super::super::packed::LARGEST_RATIO
    )]
    Ratio {
        /// Where they are.
        place: Place,
        /// Their number in the file.
        packed: u64,
        /// Their number in memory.
        unpacked: u64,
    },
    /// A line or a word longer than any of a scan.
    #[error(
        "line {line}: it is longer than {limit} bytes without {end}, and a scan has no such line; export it again"
    )]
    Endless {
        /// Number of the line, from 1.
        line: usize,
        /// Longest that is read, in bytes.
        limit: usize,
        /// What was expected there.
        end: &'static str,
    },
    /// The file ends within a number, and the part before is a number as well.
    #[error(
        "line {line}: the file ends here without a line end, within or after `{text}`, which has fewer digits than all \
         numbers before it: it is most likely cut off; copy it again, or end the line if it is complete"
    )]
    CutNumber {
        /// Number of the line, from 1.
        line: usize,
        /// The number.
        text: String,
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
pub(super) fn shorten(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut start: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().nth(LONGEST).is_some() {
        start.push_str("...");
    }
    format!("`{start}`")
}

/// What a line reader found, as a problem of the file.
pub(super) fn of_line(error: LineError, line: usize, end: &'static str) -> FileProblem {
    match error {
        LineError::Io(error) => error.into(),
        LineError::TooLong(limit) => FileProblem::Endless { line, limit, end },
    }
}
