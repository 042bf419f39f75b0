//! Text files of one point per line, or of one row of heights per line.
//!
//! | module | what it holds |
//! |---|---|
//! | `rows`, `columns`, `number` | lines as cells, the cells of position and height, cells as numbers |
//! | `map` | height maps: x, y and z on each line |
//! | `matrix` | height maps: a row of heights on each line |

mod columns;
mod map;
mod matrix;
mod number;
mod rows;
#[cfg(test)]
mod tests;

use crate::decode::{Located, TextLines};
use crate::description::Separator;
use crate::file::{LARGEST_POINTS, ScanFile};
use crate::last_number::{self, LastNumber};
use crate::spreadsheet::{Book, is_workbook};
use crate::{ScanError, ScanProblem, Source, TextFormat};
use asperity_core::surface::RawScan;
use columns::{Columns, written_cells};
use csv::StringRecord;
use number::{Cells, shorten};
use rows::Rows;
use statrs::statistics::{Data, OrderStatistics};
use std::borrow::Cow;
use std::path::Path;

/// What a description reads.
#[derive(Debug, Clone, PartialEq)]
pub enum Described {
    /// Points along a line.
    Line(RawScan),
    /// Points on a grid, where the description has a `y_column` or is that of a `matrix`.
    Map(ScanFile),
}

/// Reads the line scan in a text file; the scan is named for the file's stem.
///
/// # Errors
/// [`ScanError`] with the path, the line and the column; for the description of a height map.
pub fn read_text(path: &Path, format: &TextFormat) -> Result<RawScan, ScanError> {
    match read_described(path, format)? {
        Described::Line(scan) => Ok(scan),
        Described::Map(_) => Err(ScanError {
            file: path.display().to_string(),
            line: None,
            column: None,
            problem: no_line(format),
        }),
    }
}

/// Reads the line scan or height map in a text file or a workbook; a scan is named for the file's
/// stem.
///
/// # Errors
/// [`ScanError`] with the path, the line and the column.
pub fn read_described(path: &Path, format: &TextFormat) -> Result<Described, ScanError> {
    let whole =
        |problem| ScanError { file: path.display().to_string(), line: None, column: None, problem };
    if path.is_dir() {
        return Err(whole(ScanProblem::Directory));
    }
    let source = Source::open(path).map_err(|error| whole(error.into()))?;
    let name = asperity_files::name::text(path.file_stem().unwrap_or(path.as_os_str()));
    read_source(&name, source, format).map_err(|error| error.in_file(path))
}

/// Reads the line scan in the bytes of a text file.
///
/// # Errors
/// [`ScanError`] that names the file `name`; for the description of a height map.
pub fn parse_text(name: &str, bytes: &[u8], format: &TextFormat) -> Result<RawScan, ScanError> {
    match parse_described(name, bytes, format)? {
        Described::Line(scan) => Ok(scan),
        Described::Map(_) => {
            let problem = no_line(format);
            Err(ScanError { file: name.to_owned(), line: None, column: None, problem })
        }
    }
}

fn no_line(format: &TextFormat) -> ScanProblem {
    let reason = "describes a height map, and a line scan is needed here";
    let key = if format.matrix { "matrix" } else { "y_column" };
    ScanProblem::Description { key, reason: reason.into() }
}

/// [`read_source`] of the bytes of a file.
///
/// # Errors
/// [`ScanError`] that names the file `name`.
pub fn parse_described(
    name: &str,
    bytes: &[u8],
    format: &TextFormat,
) -> Result<Described, ScanError> {
    read_source(name, Source::of_bytes(bytes), format)
}

/// Reads the line scan or height map in a text file, line by line, of which one is in memory, or in
/// a workbook. Positions and heights are converted to metres, missing heights are NaN.
///
/// # Errors
/// [`ScanError`] that names the file `name`.
pub fn read_source(
    name: &str,
    source: Source<'_>,
    format: &TextFormat,
) -> Result<Described, ScanError> {
    let error = |line, column, problem| ScanError { file: name.to_owned(), line, column, problem };
    let whole = |problem| error(None, None, problem);
    let located = |(line, problem): Located| error(line, None, problem);

    format.validate().map_err(whole)?;
    let source = source.with_directory().map_err(|error| whole(error.into()))?;
    let sheet;
    let (source, format) = if is_workbook(source.start()) {
        let mut book = Book::open(source.start()).map_err(whole)?;
        sheet = book.text(format.sheet.as_ref(), format.decimal_mark).map_err(whole)?;
        let separator = Separator::Tab;
        let format = TextFormat { separator, encoding: "utf-8".into(), ..format.clone() };
        (Source::of_bytes(sheet.as_bytes()), Cow::Owned(format))
    } else if format.sheet.is_some() {
        let reason = "names a sheet, but the file is not a workbook (.xlsx); leave it out".into();
        return Err(whole(ScanProblem::Description { key: "sheet", reason }));
    } else {
        (source, Cow::Borrowed(format))
    };
    let mut lines = TextLines::open(source, &format.encoding).map_err(located)?;
    lines.skip_preamble(&format).map_err(located)?;
    let rows = Rows::new(lines, &format);
    let failed = |failure: Failure| error(failure.line, failure.column, failure.problem);
    if format.matrix {
        return Ok(Described::Map(matrix::read(rows, &format).map_err(failed)?));
    }
    let points = read_points(rows, &format).map_err(failed)?;
    if format.y_column.is_some() {
        let map = map::on_grid(points, &format).map_err(whole)?;
        return Ok(Described::Map(map));
    }
    let scan = to_metres(name, points, &format);
    check_plausible(&scan, &format).map_err(whole)?;
    let scan = cut_ends(scan, &format).map_err(whole)?;
    if scan.heights.iter().all(|height| height.is_nan()) {
        return Err(whole(ScanProblem::AllMissing { points: scan.heights.len() }));
    }
    Ok(Described::Line(scan))
}

/// The numbers of a file in its own units; no positions where it holds heights only.
#[derive(Default)]
struct Points {
    positions: Vec<f64>,
    /// Positions across, of a height map.
    across: Vec<f64>,
    heights: Vec<f64>,
}

struct Failure {
    line: Option<usize>,
    column: Option<String>,
    problem: ScanProblem,
}

impl From<Located> for Failure {
    fn from((line, problem): Located) -> Self {
        Self { line, column: None, problem }
    }
}

fn read_points(mut rows: Rows<'_>, format: &TextFormat) -> Result<Points, Failure> {
    let cells = Cells::new(format);
    let mut record = StringRecord::new();
    let on_line = |rows: &Rows, problem| Failure { line: Some(rows.line()), column: None, problem };
    let too_few = |rows: &Rows, points| {
        let problem = rows.ends_with(ScanProblem::TooFewPoints { rows: points });
        Failure { line: None, column: None, problem }
    };

    if format.has_header() && !rows.read_names(&mut record, &cells)? {
        return Err(too_few(&rows, 0));
    }
    let header = format.has_header().then_some(&record);
    let columns =
        Columns::resolve(format, header, &cells).map_err(|problem| on_line(&rows, problem))?;

    let mut points = Points::default();
    let mut ends = Ends::default();
    while rows.read(&mut record)? {
        // Spreadsheets end a file with lines of separators only.
        if columns.x.is_some() && written_cells(&record) == 0 {
            continue;
        }
        columns.check(&record).map_err(|problem| {
            let truncated =
                matches!(problem, ScanProblem::ShortLine { .. }) && rows.is_unfinished_line();
            on_line(&rows, if truncated { ScanProblem::Truncated } else { problem })
        })?;
        if columns.x.is_none() && !points.heights.is_empty() && rows.follows_blank_line() {
            return Err(on_line(&rows, ScanProblem::BlankLine));
        }
        let unfinished = rows.is_unfinished_line();
        ends.check(&record, &columns, unfinished).map_err(|problem| on_line(&rows, problem))?;
        if points.heights.len() as u64 == LARGEST_POINTS {
            return Err(on_line(&rows, ScanProblem::TooManyPoints { limit: LARGEST_POINTS }));
        }
        push(&mut points, &record, &columns, &cells).map_err(|(place, problem)| Failure {
            line: Some(rows.line()),
            column: Some(columns.describe(place)),
            problem: if points.heights.is_empty() { hint_at_header(problem) } else { problem },
        })?;
    }
    match points.heights.len() {
        points @ (0 | 1) => Err(too_few(&rows, points)),
        _ => Ok(points),
    }
}

/// How the lines of points end, to detect a file that was cut in its last one.
#[derive(Default)]
struct Ends {
    numbers: LastNumber,
    lines: usize,
    /// Cells of the line before.
    cells: usize,
}

impl Ends {
    /// Compares a line without a line end with those before it.
    fn check(
        &mut self,
        record: &StringRecord,
        columns: &Columns,
        unfinished: bool,
    ) -> Result<(), ScanProblem> {
        let Some(last) = record.len().checked_sub(1) else { return Ok(()) };
        if !unfinished {
            self.lines += 1;
            self.cells = record.len();
            self.numbers.note(&record[last]);
            return Ok(());
        }
        // A cut in another column leaves position and height complete.
        if last != columns.z && columns.x != Some(last) {
            return Ok(());
        }
        if self.lines >= last_number::ENOUGH && record.len() < self.cells {
            return Err(ScanProblem::Truncated);
        }
        match self.numbers.is_cut(&record[last]) {
            true => Err(ScanProblem::CutNumber { text: shorten(record[last].trim()) }),
            false => Ok(()),
        }
    }
}

/// Appends the point of one line; the error comes with the place of the column, from 0.
fn push(
    points: &mut Points,
    record: &StringRecord,
    columns: &Columns,
    cells: &Cells,
) -> Result<(), (usize, ScanProblem)> {
    if let Some(x) = columns.x {
        let position = cells.position(&record[x]).map_err(|problem| (x, problem))?;
        if let (Some(&previous), None) = (points.positions.last(), columns.y) {
            // Equal positions are a fault of the track, which conditioning merges or refuses.
            if position < previous {
                let (text, previous) = (record[x].trim().to_owned(), previous.to_string());
                return Err((x, ScanProblem::NotIncreasing { text, previous }));
            }
        }
        points.positions.push(position);
    }
    if let Some(y) = columns.y {
        points.across.push(cells.position(&record[y]).map_err(|problem| (y, problem))?);
    }
    let height = cells.height(&record[columns.z]).map_err(|problem| (columns.z, problem))?;
    points.heights.push(height);
    Ok(())
}

/// Words on the first line of points are most likely the names of the columns.
fn hint_at_header(problem: ScanProblem) -> ScanProblem {
    match problem {
        ScanProblem::NotANumber { text, .. } => ScanProblem::NotANumber {
            text,
            hint: "; set `header`, `skip_lines` or `skip_until` if this line is no point yet",
        },
        other => other,
    }
}

fn to_metres(name: &str, points: Points, format: &TextFormat) -> RawScan {
    use crate::description::LengthUnit::{M, Um};
    // `validate` has seen that the units are there where they are needed.
    let x_unit = format.x_unit.unwrap_or(M);
    let z_unit = format.z_unit.unwrap_or(M);
    let sign = if format.invert_z { -1.0 } else { 1.0 };
    let mut positions = points.positions;
    positions.iter_mut().for_each(|position| *position = x_unit.metres(*position));
    if let Some(spacing) = format.x_spacing_um {
        positions = (0..points.heights.len()).map(|i| Um.metres(i as f64 * spacing)).collect();
    }
    let mut heights = points.heights;
    heights.iter_mut().for_each(|height| *height = sign * z_unit.metres(*height));
    RawScan { name: name.to_owned(), positions, heights }
}

/// Refuses numbers that only a wrong unit, column or marker explains.
fn check_plausible(scan: &RawScan, format: &TextFormat) -> Result<(), ScanProblem> {
    // An atomic force microscope steps by a nanometre; texture ends at wavelengths of 50 mm.
    const SPACINGS_M: std::ops::RangeInclusive<f64> = 1e-9..=1e-2;
    // A track may stop now and then; a map has a line of points at each position.
    const MOST_REPEATED_PERCENT: f64 = 5.0;
    const FEWEST_REPEATED: usize = 5;

    let all_steps = scan.positions.windows(2).map(|pair| pair[1] - pair[0]);
    let steps = || all_steps.clone().filter(|step| *step > 0.0);
    if steps().next().is_none() {
        return Err(ScanProblem::OnePosition { points: scan.positions.len() });
    }
    // The median is within the range where every step is; most files need none.
    if !steps().all(|step| SPACINGS_M.contains(&step)) {
        let spacing = Data::new(steps().collect::<Vec<_>>()).median();
        if !SPACINGS_M.contains(&spacing) {
            let key = if format.x_spacing_um.is_some() { "x_spacing_um" } else { "x_unit" };
            return Err(ScanProblem::AbsurdSpacing { spacing_mm: spacing * 1e3, key });
        }
    }
    let repeated = all_steps.len() - steps().count();
    let percent = 100.0 * repeated as f64 / scan.positions.len() as f64;
    if percent > MOST_REPEATED_PERCENT && repeated >= FEWEST_REPEATED {
        return Err(ScanProblem::Repeated { percent });
    }
    check_range(&scan.heights)?;
    check_slope(scan)
}

fn check_range(heights: &[f64]) -> Result<(), ScanProblem> {
    // No profilometer of texture has a range of a metre.
    const LARGEST_RANGE_M: f64 = 1.0;
    // `f64::min` and `max` pass over NaN.
    let lowest_m = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let highest_m = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if highest_m - lowest_m > LARGEST_RANGE_M {
        return Err(ScanProblem::AbsurdHeights { lowest_m, highest_m });
    }
    Ok(())
}

/// Refuses a scan whose neighbouring points are steeper than any surface at every second point, as
/// they are where one of the units is a thousand times off.
fn check_slope(scan: &RawScan) -> Result<(), ScanProblem> {
    // 88 degrees. The steepest of the real scans has a median of 0.3.
    const STEEPEST: f64 = 30.0;
    let pairs = scan.positions.windows(2).zip(scan.heights.windows(2));
    let slopes = || {
        pairs
            .clone()
            .filter(|(x, _)| x[1] > x[0])
            .map(|(x, z)| ((z[1] - z[0]) / (x[1] - x[0])).abs())
    };
    let (steep, all) =
        slopes().filter(|slope| !slope.is_nan()).fold((0_usize, 0_usize), |(steep, all), slope| {
            (steep + usize::from(slope > STEEPEST), all + 1)
        });
    if 2 * steep <= all {
        return Ok(());
    }
    let slope = Data::new(slopes().filter(|slope| !slope.is_nan()).collect::<Vec<_>>()).median();
    let length_m = scan.positions[scan.positions.len() - 1] - scan.positions[0];
    Err(ScanProblem::Steep { slope, length_mm: length_m * 1e3 })
}

/// Drops the points within `cut_start_mm` of the first and `cut_end_mm` of the last.
fn cut_ends(mut scan: RawScan, format: &TextFormat) -> Result<RawScan, ScanProblem> {
    let (Some(&first), Some(&last)) = (scan.positions.first(), scan.positions.last()) else {
        return Err(ScanProblem::TooFewPoints { rows: 0 });
    };
    let (from, to) = (first + format.cut_start_mm / 1e3, last - format.cut_end_mm / 1e3);
    let start = scan.positions.partition_point(|&position| position < from);
    let end = scan.positions.partition_point(|&position| position <= to);
    if end < start + 2 {
        let cut_mm = format.cut_start_mm + format.cut_end_mm;
        return Err(ScanProblem::AllCut { length_mm: (last - first) * 1e3, cut_mm });
    }
    for values in [&mut scan.positions, &mut scan.heights] {
        values.truncate(end);
        values.drain(..start);
    }
    Ok(scan)
}
