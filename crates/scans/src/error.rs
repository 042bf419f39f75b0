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
    /// The operating system refuses to read it.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// It is a directory.
    #[error("is a directory; give the scan file itself")]
    Directory,
    /// Its description has a key that does not fit.
    #[error("the key `{key}` of its description {reason}")]
    Description {
        /// The key.
        key: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// It has no bytes.
    #[error("the file is empty")]
    Empty,
    /// It is not text.
    #[error("holds binary data, not text; check the file type, or set `encoding` (utf-16le, ...)")]
    Binary,
    /// Its bytes are not of the encoding.
    #[error("bytes that are not {encoding}; set `encoding`, for instance to windows-1252")]
    Encoding {
        /// The encoding.
        encoding: &'static str,
    },
    /// All lines are skipped.
    #[error("has {lines} lines, fewer than skip_lines = {skip_lines}")]
    SkippedAll {
        /// Lines of the file.
        lines: usize,
        /// Lines to skip.
        skip_lines: usize,
    },
    /// The line before the points is not there.
    #[error("no line starts with the marker `{marker}` (skip_until)")]
    NoMarker {
        /// How the line should begin.
        marker: String,
    },
    /// The line after the points is not there.
    #[error(
        "no line after the points starts with `{marker}` (stop_at): the file may have been cut; if it is complete, leave stop_at out"
    )]
    NoFooter {
        /// How the line should begin.
        marker: String,
    },
    /// A column is not there.
    #[error("there is no column `{wanted}`; the columns are {present}; check `separator` as well")]
    UnknownColumn {
        /// What was asked for.
        wanted: String,
        /// What there is.
        present: String,
    },
    /// Several columns have the name.
    #[error("{count} columns are named `{wanted}`; give the number of the column")]
    AmbiguousColumn {
        /// What was asked for.
        wanted: String,
        /// How many.
        count: usize,
    },
    /// The line of names holds numbers.
    #[error("holds numbers where the column names should be; set `header = false`")]
    HeaderIsData,
    /// A line is too long for points.
    #[error(
        "a line of more than {limit} bytes is not a line of points; check the file type, or export the file again"
    )]
    LongLine {
        /// The most that is allowed.
        limit: usize,
    },
    /// It has more points than a scan may have.
    #[error("more than {limit} points; cut the file into parts, each of which is a scan")]
    TooManyPoints {
        /// The most that is allowed.
        limit: u64,
    },
    /// A line has too many cells.
    #[error("more than {limit} cells; check `separator`, or export one profile per file")]
    ManyCells {
        /// The most that is allowed.
        limit: usize,
    },
    /// A quotation mark is not closed in its line.
    #[error(
        "a cell opens a quotation mark that its line does not close, and the points up to the next mark would be lost \
         in it; close or delete the mark"
    )]
    QuotedLines,
    /// A line has another number of cells than there are names.
    #[error("{cells} cells under {columns} column names; check `separator` and `decimal_mark`")]
    CellCount {
        /// Cells of the line.
        cells: usize,
        /// Names of columns.
        columns: usize,
    },
    /// A line has too few cells.
    #[error("ends after {cells} cells, {needed} are needed; complete or delete the line")]
    ShortLine {
        /// Cells of the line.
        cells: usize,
        /// Cells that are needed.
        needed: usize,
    },
    /// A row of a matrix has another number of heights than the first.
    #[error(
        "holds {numbers} numbers, and {expected} were expected, as on line {first}: all rows of a matrix are equally long; \
         check `separator` and `decimal_mark`, and mark missing heights"
    )]
    UnequalRow {
        /// Numbers of the line.
        numbers: usize,
        /// Numbers of the first row.
        expected: usize,
        /// Line of the first row.
        first: usize,
    },
    /// The last line is incomplete.
    #[error("the file breaks off in the middle of its last line; copy it again")]
    Truncated,
    /// The last number may be incomplete.
    #[error(
        "the file ends here without a line end, within or after `{text}`, which has fewer digits than all numbers \
         before it: it is most likely cut off; copy it again, or end the line if it is complete"
    )]
    CutNumber {
        /// The cell as it stands.
        text: String,
    },
    /// A line between heights is blank.
    #[error("a blank line between heights; without positions mark a missing height, say by NaN")]
    BlankLine,
    /// A cell is not a number.
    #[error("`{text}` is not a number{hint}")]
    NotANumber {
        /// The cell as it stands.
        text: String,
        /// What may help.
        hint: &'static str,
    },
    /// A number has the other decimal mark.
    #[error("`{text}` has the wrong decimal mark; set `decimal_mark = \"{mark}\"`{hint}")]
    DecimalMark {
        /// The cell as it stands.
        text: String,
        /// The mark.
        mark: char,
        /// What may help.
        hint: &'static str,
    },
    /// A number has separators of thousands.
    #[error("`{text}` separates thousands by `{mark}`, which is not read; export the file without")]
    Thousands {
        /// The cell as it stands.
        text: String,
        /// The mark.
        mark: char,
    },
    /// A number is not finite.
    #[error(
        "`{text}` is infinite or too large for a number; list it in `missing` if it marks a gap"
    )]
    Infinite {
        /// The cell as it stands.
        text: String,
    },
    /// Positions do not increase.
    #[error(
        "the position {text} comes after {previous}; check `x_column`, sort the file by position, cut it where the track turns back, or describe a height map by `y_column` as well"
    )]
    NotIncreasing {
        /// The cell as it stands.
        text: String,
        /// The position before.
        previous: String,
    },
    /// All positions are equal.
    #[error(
        "all {points} points have the same position; choose the column of positions (`x_column`)"
    )]
    OnePosition {
        /// Points of the scan.
        points: usize,
    },
    /// There are fewer than two points.
    #[error(
        "too few points: {rows} where at least 2 are needed; check `skip_lines`, `skip_until` and `comment`"
    )]
    TooFewPoints {
        /// Points that were found.
        rows: usize,
    },
    /// No point has a height.
    #[error("all {points} heights are missing; check `z_column` and `missing`")]
    AllMissing {
        /// Points of the scan.
        points: usize,
    },
    /// The cuts leave nothing.
    #[error(
        "nothing is left: the track is {length_mm} mm long, cut_start_mm + cut_end_mm is {cut_mm} mm"
    )]
    AllCut {
        /// Length of the track in mm.
        length_mm: f64,
        /// Sum of the cuts in mm.
        cut_mm: f64,
    },
    /// The spacing is not that of a texture scan.
    #[error("points {} mm apart are not a scan of texture (1e-6 to 10 mm); check `{key}`", brief(*spacing_mm))]
    AbsurdSpacing {
        /// Spacing in mm.
        spacing_mm: f64,
        /// The key.
        key: &'static str,
    },
    /// Slopes are so large that a unit must be wrong.
    #[error(
        "half of all neighbouring points are steeper than {} to 1 (the track would be {} mm long): a unit is wrong; \
         check `x_unit` (or `x_spacing_um`) and `z_unit`",
        slope.round(), brief(*length_mm)
    )]
    Steep {
        /// Median of the slopes.
        slope: f64,
        /// Length of the track in mm.
        length_mm: f64,
    },
    /// Many positions repeat.
    #[error(
        "{percent:.0} % of the points are at the position of the point before: this is a height map (describe the column \
         of the other position by `y_column` and `y_unit`), or the positions have too few digits (give `x_spacing_um` in \
         place of `x_column`)"
    )]
    Repeated {
        /// Share of repeated positions in percent.
        percent: f64,
    },
    /// The positions of a height map form no grid.
    #[error("{problem}")]
    Grid {
        /// What is wrong.
        problem: String,
    },
    /// A workbook cannot be read.
    #[error("{reason}; save the sheet as CSV and describe that")]
    Workbook {
        /// What is wrong with it.
        reason: String,
    },
    /// A sheet is not there.
    #[error("there is no sheet `{wanted}` (key `sheet`); the sheets are {present}")]
    NoSheet {
        /// What was asked for.
        wanted: String,
        /// What there is.
        present: String,
    },
    /// Heights are not those of a road.
    #[error(
        "heights from {} m to {} m are not those of a road; check `z_unit`, or list a marker of missing points in `missing`",
        brief(*lowest_m), brief(*highest_m)
    )]
    AbsurdHeights {
        /// Lowest height in m.
        lowest_m: f64,
        /// Highest height in m.
        highest_m: f64,
    },
}

/// A number without hundreds of digits.
fn brief(number: f64) -> String {
    if number == 0.0 || (1e-6..1e7).contains(&number.abs()) {
        number.to_string()
    } else {
        format!("{number:.3e}")
    }
}
