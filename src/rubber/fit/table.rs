//! Sweeps as CSV.
//!
//! One header line, in any order: `frequency_hz` or `angular_frequency_rad_s`; `storage_mpa` and
//! `loss_mpa` (also `_pa`, `_kpa`, `_gpa`); optionally `temperature_c`. Commas between the columns,
//! points as decimal marks, comment lines after `#`.

use super::{Sweep, SweepPoint};
use crate::error_kind::{ErrorKind, HasKind};
use std::collections::HashSet;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Rows whose temperatures differ by no more belong to one sweep, in K: a chamber is never quite
/// where it was set.
const SAME_SWEEP_K: f64 = 0.5;

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
    /// The text as a whole, or one line of it.
    #[error("{}{}: {problem}", .path.display(), .line.map_or(String::new(), |line| format!(", line {line}")))]
    Problem {
        /// The file.
        path: PathBuf,
        /// Its line, the first is 1.
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

/// Reads sweeps of Young's modulus from a CSV file; `factor` makes Young's modulus of what was
/// measured ([`ModulusKind::factor`](super::ModulusKind::factor)).
///
/// # Errors
/// [`TableError`] with the line and what to do.
pub fn read_sweeps(path: &Path, factor: f64) -> Result<Vec<Sweep>, TableError> {
    let bytes = crate::files::read(path, crate::files::LARGEST_NUMBERS)
        .map_err(|source| TableError::Unreadable { path: path.to_path_buf(), source })?;
    let problem = |line, problem| TableError::Problem { path: path.to_path_buf(), line, problem };
    let text = String::from_utf8(bytes).map_err(|_| {
        problem(None, "it is no UTF-8 text: export the sweeps as CSV in UTF-8".into())
    })?;
    parse_sweeps(&text, factor).map_err(|(line, text)| problem(line, text))
}

/// [`read_sweeps`] of a text in memory.
///
/// # Errors
/// The line, if it is one line, and what is wrong with it.
pub fn parse_sweeps(text: &str, factor: f64) -> Result<Vec<Sweep>, (Option<u64>, String)> {
    // The line of a record that the csv reader tells is that of the blank lines before it.
    let lines = text.trim_start_matches('\u{feff}').lines().zip(1_u64..);
    let told = |(line, _): &(&str, u64)| !line.trim().is_empty() && !line.starts_with('#');
    let (lines, numbers): (Vec<&str>, Vec<u64>) = lines.filter(told).unzip();
    let text = lines.join("\n");
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let headers = reader.headers().map_err(|error| (None, error.to_string()))?.clone();
    let first = numbers.first().copied();
    let columns = Columns::find(&headers).map_err(|problem| (first, problem))?;
    let (mut rows, mut seen) = (Vec::new(), HashSet::new());
    for (k, record) in reader.records().enumerate() {
        let at = numbers.get(k + 1).copied();
        let record = record.map_err(|error| (at, row_problem(&error)))?;
        let row = columns.row(&record, factor).map_err(|problem| (at, problem))?;
        let temperature = row.temperature_c.unwrap_or_default();
        if !seen.insert((row.point.angular_frequency.to_bits(), temperature.to_bits())) {
            let what = match row.temperature_c {
                Some(temperature) => format!(" at {temperature} °C"),
                None => String::new(),
            };
            let frequency = record.get(columns.frequency.0).unwrap_or_default();
            let problem = format!(
                "the frequency {frequency}{what} stands here for the second time: average the rows, or give \
                 each temperature in a column temperature_c"
            );
            return Err((at, problem));
        }
        rows.push(row);
    }
    match rows.len() {
        0 => Err((None, "there are no rows below the header: export the measured points".into())),
        1 => Err((None, "there is one point only: a fit needs a sweep over frequencies".into())),
        _ => Ok(by_temperature(rows)),
    }
}

fn row_problem(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => format!(
            "{len} values where the header has {expected_len}: separate columns by commas and write decimals with \
             a point"
        ),
        _ => error.to_string(),
    }
}

struct Row {
    temperature_c: Option<f64>,
    point: SweepPoint,
}

/// Places of the columns with their factors to SI.
struct Columns {
    frequency: (usize, f64),
    storage: (usize, f64),
    loss: (usize, f64),
    temperature: Option<usize>,
    names: Vec<String>,
}

const FREQUENCY_UNITS: [(&str, f64); 2] = [("frequency_hz", TAU), ("angular_frequency_rad_s", 1.0)];
const MODULUS_UNITS: [(&str, f64); 4] = [("_pa", 1.0), ("_kpa", 1e3), ("_mpa", 1e6), ("_gpa", 1e9)];
const WANTED: &str = "wanted is a header such as `frequency_hz,storage_mpa,loss_mpa,temperature_c` \
    (angular_frequency_rad_s, and _pa, _kpa or _gpa are understood too; temperature_c may be left out)";

impl Columns {
    fn find(headers: &csv::StringRecord) -> Result<Self, String> {
        let names: Vec<String> = headers.iter().map(str::to_owned).collect();
        if names.iter().all(String::is_empty) {
            return Err(format!("there is no header: {WANTED}"));
        }
        if names.len() == 1 && names[0].contains([';', '\t']) {
            return Err("the columns are separated by semicolons or tabulators: separate them by commas, and \
                 write decimals with a point"
                .into());
        }
        let frequencies = FREQUENCY_UNITS.map(|(name, factor)| (name.to_owned(), factor));
        let moduli =
            |kind: &str| MODULUS_UNITS.map(|(unit, factor)| (format!("{kind}{unit}"), factor));
        let columns = Self {
            frequency: one(&names, &frequencies, "frequency")?,
            storage: one(&names, &moduli("storage"), "storage modulus")?,
            loss: one(&names, &moduli("loss"), "loss modulus")?,
            temperature: names.iter().position(|name| name == "temperature_c"),
            names,
        };
        let known = 3 + usize::from(columns.temperature.is_some());
        if columns.names.len() > known {
            let used = [columns.frequency.0, columns.storage.0, columns.loss.0];
            let unknown = (0..columns.names.len())
                .find(|k| !used.contains(k) && columns.temperature != Some(*k))
                .map_or("", |k| columns.names[k].as_str());
            return Err(format!("the column `{unknown}` is not known, leave it out: {WANTED}"));
        }
        Ok(columns)
    }

    fn row(&self, record: &csv::StringRecord, factor: f64) -> Result<Row, String> {
        let positive = |(column, unit): (usize, f64)| match self.number(record, column)? {
            value if value > 0.0 => Ok(value * unit),
            value => Err(format!(
                "{} is {value}, it must be positive: correct the row or leave it out",
                self.names[column]
            )),
        };
        let point = SweepPoint {
            angular_frequency: positive(self.frequency)?,
            storage_modulus: positive(self.storage)? * factor,
            loss_modulus: positive(self.loss)? * factor,
        };
        let temperature_c =
            self.temperature.map(|column| self.number(record, column)).transpose()?;
        Ok(Row { temperature_c, point })
    }

    fn number(&self, record: &csv::StringRecord, column: usize) -> Result<f64, String> {
        let (text, name) = (record.get(column).unwrap_or_default(), &self.names[column]);
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(format!(
                "{name} is {text}, it must be a finite number: correct the row or leave it out"
            )),
            Err(_) if text.contains(',') => {
                Err(format!("{name} is `{text}`: write decimals with a point"))
            }
            Err(_) => Err(format!(
                "{name} is `{text}`, which is no number: correct the row or leave it out"
            )),
        }
    }
}

/// The one column of several possible names, with its factor.
fn one(names: &[String], choices: &[(String, f64)], what: &str) -> Result<(usize, f64), String> {
    let factor = |name: &String| choices.iter().find(|(choice, _)| choice == name);
    let found: Vec<(usize, f64)> = names
        .iter()
        .enumerate()
        .filter_map(|(k, name)| factor(name).map(|(_, factor)| (k, *factor)))
        .collect();
    match found[..] {
        [column] => Ok(column),
        [] => Err(format!("there is no column of the {what}: {WANTED}")),
        _ => Err(format!("there are {} columns of the {what}, leave one: {WANTED}", found.len())),
    }
}

/// One sweep for each temperature, the mean of its rows.
fn by_temperature(mut rows: Vec<Row>) -> Vec<Sweep> {
    let temperature = |row: &Row| row.temperature_c.unwrap_or(0.0);
    rows.sort_by(|a, b| temperature(a).total_cmp(&temperature(b)));
    let same = |a: &Row, b: &Row| temperature(b) - temperature(a) <= SAME_SWEEP_K;
    let sweep = |rows: &[Row]| {
        let sum: Option<f64> = rows.iter().map(|row| row.temperature_c).sum();
        Sweep {
            // To the millikelvin: a mean of equal decimals is to be that decimal.
            temperature_c: sum.map(|sum| (1e3 * sum / rows.len() as f64).round() / 1e3),
            points: rows.iter().map(|row| row.point).collect(),
        }
    };
    rows.chunk_by(same).map(sweep).collect()
}
