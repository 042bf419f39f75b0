//! What can be wrong with a scan file.

use asperity_core::error_kind::{ErrorKind, HasKind};
use std::path::Path;

/// A scan file that cannot be read: where, what, and what to do.
#[derive(Debug, thiserror::Error)]
#[error("{file}{}: {problem}", place(.line, .column))]
pub struct ScanError {
    /// Path or name of the file.
    pub file: String,
    /// Line in the file, counted from 1, where the problem has one.
    pub line: Option<usize>,
    /// Column (its name, else its number), where the problem has one.
    pub column: Option<String>,
    /// What is wrong.
    #[source]
    pub problem: ScanProblem,
}

impl HasKind for ScanError {
    fn kind(&self) -> ErrorKind {
        // A scan is a file of the user, whatever is wrong with it.
        ErrorKind::Input
    }
}

impl ScanError {
    /// The same error for the file at `path`.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        Self { file: path.display().to_string(), ..self }
    }
}

fn place(line: &Option<usize>, column: &Option<String>) -> String {
    let line = line.map(|line| format!(", line {line}")).unwrap_or_default();
    let column = column.as_ref().map(|column| format!(", column {column}")).unwrap_or_default();
    line + &column
}

/// What is wrong with a scan file or with its description.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScanProblem {
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    #[error("is a directory; give the scan file itself")]
    Directory,
    #[error("the key `{key}` of its description {reason}")]
    Description { key: &'static str, reason: String },
    #[error("the file is empty")]
    Empty,
    #[error("holds binary data, not text; check the file type, or set `encoding` (utf-16le, ...)")]
    Binary,
    #[error("bytes that are not {encoding}; set `encoding`, for instance to windows-1252")]
    Encoding { encoding: &'static str },
    #[error("has {lines} lines, fewer than skip_lines = {skip_lines}")]
    SkippedAll { lines: usize, skip_lines: usize },
    #[error("no line starts with the marker `{marker}` (skip_until)")]
    NoMarker { marker: String },
    #[error(
        "no line after the points starts with `{marker}` (stop_at): the file may have been cut; if it is complete, leave stop_at out"
    )]
    NoFooter { marker: String },
    #[error("there is no column `{wanted}`; the columns are {present}; check `separator` as well")]
    UnknownColumn { wanted: String, present: String },
    #[error("{count} columns are named `{wanted}`; give the number of the column")]
    AmbiguousColumn { wanted: String, count: usize },
    #[error("holds numbers where the column names should be; set `header = false`")]
    HeaderIsData,
    #[error(
        "a line of more than {limit} bytes is not a line of points; check the file type, or export the file again"
    )]
    LongLine { limit: usize },
    #[error("more than {limit} points; cut the file into parts, each of which is a scan")]
    TooManyPoints { limit: u64 },
    #[error("more than {limit} cells; check `separator`, or export one profile per file")]
    ManyCells { limit: usize },
    #[error(
        "a cell opens a quotation mark that its line does not close, and the points up to the next mark would be lost \
         in it; close or delete the mark"
    )]
    QuotedLines,
    #[error("{cells} cells under {columns} column names; check `separator` and `decimal_mark`")]
    CellCount { cells: usize, columns: usize },
    #[error("ends after {cells} cells, {needed} are needed; complete or delete the line")]
    ShortLine { cells: usize, needed: usize },
    #[error("the file breaks off in the middle of its last line; copy it again")]
    Truncated,
    #[error(
        "the file ends here without a line end, within or after `{text}`, which has fewer digits than all numbers \
         before it: it is most likely cut off; copy it again, or end the line if it is complete"
    )]
    CutNumber { text: String },
    #[error("a blank line between heights; without positions mark a missing height, say by NaN")]
    BlankLine,
    #[error("`{text}` is not a number{hint}")]
    NotANumber { text: String, hint: &'static str },
    #[error("`{text}` has the wrong decimal mark; set `decimal_mark = \"{mark}\"`{hint}")]
    DecimalMark { text: String, mark: char, hint: &'static str },
    #[error("`{text}` separates thousands by `{mark}`, which is not read; export the file without")]
    Thousands { text: String, mark: char },
    #[error(
        "`{text}` is infinite or too large for a number; list it in `missing` if it marks a gap"
    )]
    Infinite { text: String },
    #[error(
        "the position {text} comes after {previous}; check `x_column`, sort the file by position, cut it where the track turns back, or describe a height map by `y_column` as well"
    )]
    NotIncreasing { text: String, previous: String },
    #[error(
        "all {points} points have the same position; choose the column of positions (`x_column`)"
    )]
    OnePosition { points: usize },
    #[error(
        "too few points: {rows} where at least 2 are needed; check `skip_lines`, `skip_until` and `comment`"
    )]
    TooFewPoints { rows: usize },
    #[error("all {points} heights are missing; check `z_column` and `missing`")]
    AllMissing { points: usize },
    #[error(
        "nothing is left: the track is {length_mm} mm long, cut_start_mm + cut_end_mm is {cut_mm} mm"
    )]
    AllCut { length_mm: f64, cut_mm: f64 },
    #[error("points {} mm apart are not a scan of texture (1e-6 to 10 mm); check `{key}`", brief(*spacing_mm))]
    AbsurdSpacing { spacing_mm: f64, key: &'static str },
    #[error(
        "half of all neighbouring points are steeper than {} to 1 (the track would be {} mm long): a unit is wrong; \
         check `x_unit` (or `x_spacing_um`) and `z_unit`",
        slope.round(), brief(*length_mm)
    )]
    Steep { slope: f64, length_mm: f64 },
    #[error(
        "{percent:.0} % of the points are at the position of the point before: this is a height map (describe the column \
         of the other position by `y_column` and `y_unit`), or the positions have too few digits (give `x_spacing_um` in \
         place of `x_column`)"
    )]
    Repeated { percent: f64 },
    #[error("{problem}")]
    Grid { problem: String },
    #[error("{reason}; save the sheet as CSV and describe that")]
    Workbook { reason: String },
    #[error("there is no sheet `{wanted}` (key `sheet`); the sheets are {present}")]
    NoSheet { wanted: String, present: String },
    #[error(
        "heights from {} m to {} m are not those of a road; check `z_unit`, or list a marker of missing points in `missing`",
        brief(*lowest_m), brief(*highest_m)
    )]
    AbsurdHeights { lowest_m: f64, highest_m: f64 },
}

/// A number without hundreds of digits.
fn brief(number: f64) -> String {
    if number == 0.0 || (1e-6..1e7).contains(&number.abs()) {
        number.to_string()
    } else {
        format!("{number:.3e}")
    }
}
