//! Sweeps and shift factors from text files and workbooks.
//!
//! A header names quantities with their units, as instruments write them, or the user
//! describes the columns; units are never guessed. Separator, encoding and decimal mark follow from
//! the content where only one reading is possible. A file may hold several tables, one after the
//! other, as instruments export a sweep for each temperature.
//!
//! | module | what it holds |
//! |---|---|
//! | `grid` | a file as rows of cells |
//! | `names`, `layout` | quantity and unit of a column by its name; which column holds what |
//! | `rows` | the numbers below a header |
//! | `tables` | master curves as points, and strain sweeps |
//! | `doubts` | warnings of numbers that look like a mistake of units or columns |

#[cfg(test)]
mod bundled;
mod doubts;
mod grid;
mod layout;
mod names;
mod rows;
mod tables;
#[cfg(test)]
mod tests;

pub use doubts::{doubts, strain_doubts};
pub use layout::DescribedColumn;
pub use tables::{StrainUnit, read_master_curve, read_strain_sweeps};

use crate::description::{DecimalMark, Separator};
use asperity_core::error_kind::{ErrorKind, HasKind};
use asperity_core::rubber::fit::{GivenShift, Sweep, SweepPoint};
use grid::{Grid, GridError, grids, of_text};
use layout::{Wanted, next_layout, no_header};
use rows::{Numbers, Record};
use std::collections::HashSet;
use std::io;
use std::path::{Path, PathBuf};

/// Rows whose temperatures differ by no more belong to one sweep, in K: a chamber is never quite
/// where it was set.
const SAME_SWEEP_K: f64 = 0.5;
/// Largest file of sweeps in bytes: a million points.
const LARGEST_FILE: u64 = 64 << 20;

/// How the names of columns begin that this program documents.
const OWN_NAMES: [&str; 6] =
    ["frequency_", "angular_frequency_", "storage_", "loss_", "temperature_", "strain_"];

/// Where something is wrong, if it is in one line, and what.
pub(super) type Located = (Option<u64>, String);

/// Why a file holds no sweeps.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The operating system refused.
    #[error("cannot read the sweeps {}", .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the operating system answered.
        source: std::io::Error,
    },
    /// The complete text, or one line of it.
    #[error("{}{}: {problem}", .path.display(), .line.map_or(String::new(), |line| format!(", line {line}")))]
    Problem {
        /// The file.
        path: PathBuf,
        /// Its line, or the row of a sheet; the first is 1.
        line: Option<u64>,
        /// What is wrong and what to do.
        problem: String,
    },
}

impl HasKind for TableError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Unreadable { .. } | Self::Problem { .. } => ErrorKind::Input,
        }
    }
}

/// How a file is to be read, where its content leaves a question.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableOptions {
    /// Columns; by the header if empty.
    pub columns: Vec<DescribedColumn>,
    /// The separator of the cells.
    pub separator: Option<Separator>,
    /// The decimal mark.
    pub decimal_mark: Option<DecimalMark>,
    /// Sheet of a workbook.
    pub sheet: Option<String>,
}

/// Sweeps as they were read.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepTable {
    /// One sweep for each temperature, by ascending temperature.
    pub sweeps: Vec<Sweep>,
    /// Columns, units, separator and decimal mark in words.
    pub read_as: String,
    /// Whether the header is not the one of this program, so that it is worth telling.
    pub interpreted: bool,
    /// The symbol of the modulus in the header, `E` or `G`.
    pub symbol: Option<char>,
    /// Whether the frequencies are stated in Hz.
    pub in_hertz: bool,
    /// Whether the temperatures are stated in °C.
    pub in_celsius: bool,
}

/// Reads sweeps of Young's modulus from a text file or a workbook; `factor` makes Young's modulus of
/// what was measured ([`ModulusKind::factor`](asperity_core::rubber::fit::ModulusKind::factor)).
///
/// # Errors
/// [`TableError`] with the line and what to do.
pub fn read_sweeps(
    path: &Path,
    options: &TableOptions,
    factor: f64,
) -> Result<SweepTable, TableError> {
    let grids = read_grids(path, options)?;
    sweeps_of(&grids, options, factor).map_err(|located| problem(path, located))
}

/// [`read_sweeps`] of a text in memory.
///
/// # Errors
/// The line, if it is one line, and what is wrong with it.
pub fn parse_sweeps(
    text: &str,
    options: &TableOptions,
    factor: f64,
) -> Result<SweepTable, (Option<u64>, String)> {
    sweeps_of(&of_text(text, options.separator), options, factor)
}

/// Reads shift factors: a column of temperatures and one of `log10_shift` or `shift_factor`.
///
/// # Errors
/// [`TableError`] with the line and what to do.
pub fn read_shift_factors(path: &Path) -> Result<Vec<GivenShift>, TableError> {
    let options = TableOptions::default();
    let grids = read_grids(path, &options)?;
    factors_of(&grids, &options).map_err(|located| problem(path, located))
}

fn problem(path: &Path, (line, problem): Located) -> TableError {
    TableError::Problem { path: path.to_path_buf(), line, problem }
}

fn read_grids(path: &Path, options: &TableOptions) -> Result<Vec<Grid>, TableError> {
    grids(path, options).map_err(|error| match error {
        GridError::Unreadable(source) => {
            TableError::Unreadable { path: path.to_path_buf(), source }
        }
        GridError::Problem(text) => problem(path, (None, text)),
    })
}

fn read_limited(path: &Path) -> io::Result<Vec<u8>> {
    asperity_files::read(path, LARGEST_FILE)
}

/// The records of all tables in the file, with the layout of the first one.
fn records(
    grids: &[Grid],
    wanted: Wanted,
    options: &TableOptions,
) -> Result<(Vec<Record>, layout::Layout, Numbers, String), Located> {
    let mut with_table = Vec::new();
    let mut failure = None;
    for grid in grids {
        match next_layout(grid, 0, wanted, options) {
            Ok(Some(layout)) => with_table.push((grid, layout)),
            Ok(None) => {}
            Err(located) => failure = failure.or(Some(located)),
        }
    }
    if grids.len() > 1 && with_table.len() > 1 && options.sheet.is_none() && is_workbook(grids) {
        let names: Vec<&str> = with_table.iter().map(|(grid, _)| grid.seen_as.as_str()).collect();
        let problem =
            format!("several sheets hold sweeps ({}): choose one with --sheet", names.join(", "));
        return Err((None, problem));
    }
    let Some((grid, first)) = with_table.into_iter().next() else {
        return Err(failure.unwrap_or_else(|| no_header(grids, wanted)));
    };
    let mut cells = Vec::new();
    let mut layout = first.clone();
    loop {
        let end = rows::block(grid, &layout, wanted, options, &mut cells)?;
        match next_layout(grid, end, wanted, options)? {
            Some(next) => layout = next,
            None => break,
        }
    }
    let numbers = Numbers::of(&cells, options.decimal_mark)?;
    let records = cells.iter().map(|cells| numbers.record(cells)).collect::<Result<_, _>>()?;
    Ok((records, first, numbers, grid.seen_as.clone()))
}

fn is_workbook(grids: &[Grid]) -> bool {
    !grids.iter().any(|grid| grid.seen_as == "tab")
}

fn factors_of(grids: &[Grid], options: &TableOptions) -> Result<Vec<GivenShift>, Located> {
    let (records, ..) = records(grids, Wanted::Factors, options)?;
    let mut factors: Vec<GivenShift> = Vec::new();
    for record in &records {
        let shift = record.given_shift()?;
        if factors.iter().any(|other| other.temperature_c == shift.temperature_c) {
            let text = record.text(names::Quantity::Temperature);
            let problem = format!(
                "the temperature {text} is given here for the second time: keep one of its factors"
            );
            return Err((Some(record.line), problem));
        }
        factors.push(shift);
    }
    if factors.len() < 2 {
        return Err((
            None,
            "there are fewer than two shift factors: give one for each temperature".into(),
        ));
    }
    Ok(factors)
}

fn sweeps_of(grids: &[Grid], options: &TableOptions, factor: f64) -> Result<SweepTable, Located> {
    let (records, layout, numbers, seen_as) = records(grids, Wanted::Sweeps, options)?;
    let (mut points, mut seen) = (Vec::new(), HashSet::new());
    for record in &records {
        let point = record.point(factor)?;
        let temperature_c = record.temperature_c()?;
        let temperature = temperature_c.unwrap_or_default();
        if !seen.insert((point.angular_frequency.to_bits(), temperature.to_bits())) {
            return Err((Some(record.line), twice(record, temperature_c, layout.strain)));
        }
        points.push(Point { temperature_c, point });
    }
    let columns = layout.columns.iter().map(|column| {
        let unit = column.unit.map(|unit| format!(" in {}", unit.name())).unwrap_or_default();
        format!("{} from `{}`{unit}", column.quantity.what(), column.name)
    });
    let columns: Vec<String> = columns.collect();
    let table = |sweeps| SweepTable {
        sweeps,
        read_as: format!("{}; cells by {seen_as}, {}", columns.join(", "), numbers.mark_name()),
        interpreted: numbers.comma()
            || !layout
                .columns
                .iter()
                .all(|column| OWN_NAMES.iter().any(|own| column.name.starts_with(own))),
        symbol: layout.columns.iter().find_map(|column| column.symbol),
        in_hertz: layout.column(names::Quantity::Frequency).and_then(|c| c.unit)
            == Some(names::Unit::Hertz),
        in_celsius: layout.column(names::Quantity::Temperature).and_then(|c| c.unit)
            == Some(names::Unit::Celsius),
    };
    match points.len() {
        0 => Err((None, "there are no rows below the header: export the measured points".into())),
        1 => Err((None, "there is one point only: a fit needs a sweep over frequencies".into())),
        _ => Ok(table(by_temperature(points))),
    }
}

fn twice(record: &Record, temperature_c: Option<f64>, strain: bool) -> String {
    let at = temperature_c.map_or(String::new(), |temperature| format!(" at {temperature} °C"));
    let frequency = record.text(names::Quantity::Frequency);
    let what = if strain {
        "this looks like a strain sweep: a rubber is fitted to frequency sweeps at one strain amplitude, keep those rows"
    } else {
        "average the rows, or give each temperature in a column temperature_c"
    };
    format!("the frequency {frequency}{at} is given here for the second time: {what}")
}

struct Point {
    temperature_c: Option<f64>,
    point: SweepPoint,
}

/// One sweep for each temperature, the mean of its rows.
fn by_temperature(mut rows: Vec<Point>) -> Vec<Sweep> {
    let temperature = |row: &Point| row.temperature_c.unwrap_or(0.0);
    rows.sort_by(|a, b| temperature(a).total_cmp(&temperature(b)));
    let same = |a: &Point, b: &Point| temperature(b) - temperature(a) <= SAME_SWEEP_K;
    let sweep = |rows: &[Point]| {
        let sum: Option<f64> = rows.iter().map(|row| row.temperature_c).sum();
        Sweep {
            // To the millikelvin: a mean of equal decimals is to be that decimal.
            temperature_c: sum.map(|sum| (1e3 * sum / rows.len() as f64).round() / 1e3),
            points: rows.iter().map(|row| row.point).collect(),
        }
    };
    rows.chunk_by(same).map(sweep).collect()
}
