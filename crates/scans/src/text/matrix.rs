//! Height maps as text of one row per line: heights alone.

use super::columns::written_cells;
use super::map::plausible;
use super::number::{Cells, shorten};
use super::rows::Rows;
use super::{Failure, check_range};
use crate::description::LengthUnit;
use crate::file::{Grid, LARGEST_POINTS, ScanFile};
use crate::last_number::LastNumber;
use crate::{ScanProblem, TextFormat};
use csv::StringRecord;

/// Rows and columns of a map, at least.
const FEWEST: usize = 2;

/// Reads the rows to the end of the map; missing heights are NaN.
pub(super) fn read(mut rows: Rows<'_>, format: &TextFormat) -> Result<ScanFile, Failure> {
    let whole = |problem| Failure { line: None, column: None, problem };
    let (spacing_x, spacing_y) = spacings(format).map_err(whole)?;
    let mut matrix = Matrix::new(format);
    let mut record = StringRecord::new();
    while rows.read(&mut record)? {
        matrix.push(&record, &rows)?;
    }
    let (columns, heights) = matrix.finish();
    let count = heights.len().checked_div(columns).unwrap_or(0);
    if count < FEWEST || columns < FEWEST {
        return Err(whole(rows.ends_with(too_small(count, columns))));
    }
    check_range(&heights).map_err(whole)?;
    if heights.iter().all(|height| height.is_nan()) {
        let problem =
            format!("all {} heights are missing; check `missing` and `separator`", heights.len());
        return Err(whole(ScanProblem::Grid { problem }));
    }
    Ok(ScanFile {
        format: "text".into(),
        detected: format!("a description with matrix: {count} rows of {columns} heights"),
        grid: Grid::Map { columns, rows: count, spacing_x, spacing_y },
        heights,
        instrument: Vec::new(),
    })
}

/// Spacings in m along the rows and between them.
fn spacings(format: &TextFormat) -> Result<(f64, f64), ScanProblem> {
    // `validate` has seen that the first is there.
    let x = format.x_spacing_um.unwrap_or_default();
    let y = format.y_spacing_um.unwrap_or(x);
    let um = |spacing| LengthUnit::Um.metres(spacing);
    Ok((plausible(um(x), "x_spacing_um")?, plausible(um(y), "y_spacing_um")?))
}

fn too_small(rows: usize, columns: usize) -> ScanProblem {
    let check = match (rows, columns) {
        (0, _) => "`skip_lines`, `skip_until` and `comment`",
        (_, 1) => "`separator`; leave `matrix` out if this is one line of heights",
        _ => "`skip_lines`; leave `matrix` out if this is one line of heights",
    };
    ScanProblem::Grid {
        problem: format!(
            "holds {rows} rows of {columns} numbers, and a map has {FEWEST} of each or more; check {check}"
        ),
    }
}

/// The rows that were read.
struct Matrix {
    cells: Cells,
    unit: LengthUnit,
    /// -1 for depths.
    sign: f64,
    /// Cells of the first row.
    width: usize,
    /// Line of the first row.
    first: usize,
    /// Cells at the end of the rows that are empty in all of them: a separator ends every line, or
    /// lines before the map are longer.
    spare: usize,
    /// Whether a line of blanks follows the last row.
    blank: bool,
    heights: Vec<f64>,
    numbers: LastNumber,
}

impl Matrix {
    fn new(format: &TextFormat) -> Self {
        Self {
            cells: Cells::new(format),
            unit: format.z_unit.unwrap_or(LengthUnit::M),
            sign: if format.invert_z { -1.0 } else { 1.0 },
            width: 0,
            first: 0,
            spare: 0,
            blank: false,
            heights: Vec::new(),
            numbers: LastNumber::default(),
        }
    }

    /// Appends a row.
    fn push(&mut self, record: &StringRecord, rows: &Rows) -> Result<(), Failure> {
        let line = rows.line();
        let on_line = |problem| Failure { line: Some(line), column: None, problem };
        let written = written_cells(record);
        // A line of separators is a row without heights, one of blanks is not.
        if record.len() == 1 && written == 0 && self.width != 1 {
            self.blank = self.width > 0;
            return Ok(());
        }
        if self.width == 0 {
            (self.width, self.first) = (record.len(), line);
            self.spare = self.width;
        } else {
            self.check(record, rows).map_err(on_line)?;
        }
        self.use_cells(written)?;
        if (self.heights.len() + record.len()) as u64 > LARGEST_POINTS {
            return Err(on_line(ScanProblem::TooManyPoints { limit: LARGEST_POINTS }));
        }
        for (place, cell) in record.iter().enumerate() {
            if place >= self.width - self.spare {
                self.heights.push(f64::NAN);
                continue;
            }
            let height = self.cells.height(cell).map_err(|problem| Failure {
                line: Some(line),
                column: Some((place + 1).to_string()),
                problem: if line == self.first { hint(problem) } else { problem },
            })?;
            self.heights.push(self.sign * self.unit.metres(height));
        }
        Ok(())
    }

    /// Compares a row with those before it.
    fn check(&mut self, record: &StringRecord, rows: &Rows) -> Result<(), ScanProblem> {
        let after_blank = rows.follows_blank_line() && written_cells(record) > 0;
        if self.blank || after_blank {
            let problem = "a blank line between rows of heights; delete it if the map goes on after it, or cut the file there \
                           if another map follows";
            return Err(ScanProblem::Grid { problem: problem.into() });
        }
        let unfinished = rows.is_unfinished_line();
        let cells = record.len();
        if cells != self.width {
            if unfinished && cells < self.width {
                return Err(ScanProblem::Truncated);
            }
            let numbers = cells - self.spare.min(cells - written_cells(record));
            let (numbers, expected) = match self.width - self.spare {
                // The cells at the end make the difference.
                expected if expected == numbers => (cells, self.width),
                expected => (numbers, expected),
            };
            return Err(ScanProblem::UnequalRow { numbers, expected, first: self.first });
        }
        let last = &record[cells - 1];
        if unfinished && self.numbers.is_cut(last) {
            return Err(ScanProblem::CutNumber { text: shorten(last.trim()) });
        }
        self.numbers.note(last);
        Ok(())
    }

    /// Takes note that a row has written cells up to the one of this number.
    fn use_cells(&mut self, written: usize) -> Result<(), Failure> {
        let spare = self.width - written;
        if spare >= self.spare {
            return Ok(());
        }
        // These cells were passed over in the rows before.
        if !self.heights.is_empty() {
            self.cells.height("").map_err(|problem| Failure {
                line: Some(self.first),
                column: Some(written.to_string()),
                problem,
            })?;
        }
        self.spare = spare;
        Ok(())
    }

    /// Columns and heights, without the spare cells of the rows.
    fn finish(self) -> (usize, Vec<f64>) {
        let Self { width, spare, mut heights, .. } = self;
        if spare > 0 {
            let mut place = 0;
            heights.retain(|_| {
                place += 1;
                (place - 1) % width < width - spare
            });
        }
        (width - spare, heights)
    }
}

/// Words on the first line of heights are most likely names or remarks.
fn hint(problem: ScanProblem) -> ScanProblem {
    match problem {
        ScanProblem::NotANumber { text, .. } => ScanProblem::NotANumber {
            text,
            hint: "; set `skip_lines`, `skip_until` or `comment` if this line is no row of heights, or list the word in \
                   `missing`",
        },
        other => other,
    }
}
