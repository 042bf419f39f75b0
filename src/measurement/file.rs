//! Measured friction over speed as a table of text.

use crate::error_kind::{ErrorKind, HasKind};
use crate::files;
use crate::rubber::HOTTEST_C;
use crate::units::Units;
use asperity_scans::cells::{UnclearMark, decimal_mark, lines, number, split_cells};
use asperity_scans::description::DecimalMark;
use std::path::{Path, PathBuf};

/// Friction coefficients that a measurement may have.
const FRICTIONS: std::ops::RangeInclusive<f64> = 0.0..=20.0;

/// Largest mean pressure in MPa at which friction of rubber is measured; a theory takes any.
pub(crate) const LARGEST_MPA: f64 = 100.0;

/// One measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// Measured friction coefficient.
    pub friction: f64,
    /// Temperature in °C, if the file has it.
    pub temperature_c: Option<f64>,
    /// Mean pressure in MPa, if the file has it.
    pub pressure_mpa: Option<f64>,
}

/// Measured friction as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredFile {
    /// The measurements, in the order of the file.
    pub points: Vec<MeasuredPoint>,
    /// Line of each, the first is 1.
    pub lines: Vec<usize>,
}

/// Why a file holds no measured friction.
#[derive(Debug, thiserror::Error)]
pub enum MeasuredFileError {
    /// It cannot be read.
    #[error("cannot read the measured friction {}: {source}{}", .path.display(), files::advice(.source))]
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
        /// Its line; the first is 1.
        line: Option<usize>,
        /// What is wrong and what to do.
        problem: String,
    },
}

impl HasKind for MeasuredFileError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Unreadable { .. } | Self::Problem { .. } => ErrorKind::Input,
        }
    }
}

/// A quantity that a column may hold, by the name in the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quantity {
    SpeedMm,
    SpeedM,
    LogSpeedM,
    Friction,
    Temperature,
    Pressure,
}

const NAMES: [(&str, Quantity); 6] = [
    ("speed_mm_s", Quantity::SpeedMm),
    ("speed_m_s", Quantity::SpeedM),
    ("log10_speed_m_s", Quantity::LogSpeedM),
    ("friction", Quantity::Friction),
    ("temperature_c", Quantity::Temperature),
    ("pressure_mpa", Quantity::Pressure),
];

const HEADER: &str = "the columns must have names in a line without `#`: speed_mm_s, speed_m_s or log10_speed_m_s, and friction; \
     optional are temperature_c and pressure_mpa";

/// Where something is wrong, if it is in one line, and what.
type Located = (Option<usize>, String);

/// Reads measured friction: text with a header, columns separated by commas, semicolons, tabs or blanks; lines that begin with `#` are
/// comments. Decimal commas are read where columns are not separated by commas, and names may be in quotes. Columns with other names are not read. `columns` are the names of the columns of a file that has no header, none for
/// one that has.
///
/// # Errors
/// [`MeasuredFileError`] with the line and the value as typed.
pub fn read_measured(path: &Path, columns: &[String]) -> Result<MeasuredFile, MeasuredFileError> {
    let unreadable = |source| MeasuredFileError::Unreadable { path: path.to_path_buf(), source };
    let problem = |line, problem: String| MeasuredFileError::Problem {
        path: path.to_path_buf(),
        line,
        problem,
    };
    let text = files::read_settings(path).map_err(unreadable)?;
    parse(&text, columns).map_err(|(line, text)| problem(line, text))
}

fn parse(text: &str, names: &[String]) -> Result<MeasuredFile, Located> {
    let mut rows = (1..)
        .zip(lines(text))
        .map(|(number, line)| (number, line.trim().trim_start_matches('\u{feff}')))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
        .peekable();
    let (number, header) =
        rows.peek().copied().ok_or_else(|| (None, format!("the file is empty; {HEADER}")))?;
    let separator = separator(header, names.len());
    let columns = if names.is_empty() {
        rows.next();
        columns(&cells(header, separator)).map_err(|text| (Some(number), text))?
    } else {
        columns(names).map_err(|text| (None, text))?
    };
    let rows: Vec<(usize, Vec<String>)> =
        rows.map(|(number, line)| (number, cells(line, separator))).collect();
    if let Some((number, row)) = rows.iter().find(|(_, row)| row.len() != columns.len()) {
        return Err((Some(*number), miscounted(row.len(), columns.len(), separator)));
    }
    let mark = mark(&rows, &columns)?;
    let mut file = MeasuredFile { points: Vec::new(), lines: Vec::new() };
    for (number, row) in rows {
        file.points.push(point(&columns, &row, mark).map_err(|text| (Some(number), text))?);
        file.lines.push(number);
    }
    if file.points.is_empty() {
        return Err((None, "there is a header and no measurement below it".into()));
    }
    Ok(file)
}

/// The separator of a file by its first line, which is a header, or a row of so many columns; `None` for blanks.
fn separator(first: &str, columns: usize) -> Option<char> {
    let found = || [';', '\t', ','].into_iter().filter(|mark| first.contains(*mark));
    if columns == 0 {
        return found().next();
    }
    // A comma in a row may be a decimal comma: `0,1 0,85` has two cells by blanks, and `0.1, 0.85` by commas.
    let fits = |mark: &Option<char>| {
        let cells = cells(first, *mark);
        let single = |cell: &String| !cell.contains(char::is_whitespace) && !cell.ends_with(',');
        cells.len() == columns && cells.iter().all(single)
    };
    found().map(Some).chain([None]).find(fits).unwrap_or(found().next())
}

fn cells(line: &str, separator: Option<char>) -> Vec<String> {
    match separator {
        Some(mark) => split_cells(line, mark),
        None => line.split_whitespace().map(|cell| cell.trim_matches('"').to_owned()).collect(),
    }
}

fn miscounted(found: usize, needed: usize, separator: Option<char>) -> String {
    let advice = match separator {
        Some(',') if found > needed => {
            ": is a decimal comma also what separates the columns? Separate the columns by semicolons, or write decimals with a point"
        }
        _ => ": complete the line, or leave it out",
    };
    format!("{found} cells where the header has {needed}{advice}")
}

/// The decimal mark of the columns that are read.
fn mark(
    rows: &[(usize, Vec<String>)],
    columns: &[Option<Quantity>],
) -> Result<DecimalMark, Located> {
    let read = rows.iter().flat_map(|(number, row)| {
        let own = row.iter().zip(columns).filter(|(_, quantity)| quantity.is_some());
        own.map(|(cell, _)| (*number as u64, cell.as_str()))
    });
    decimal_mark(read).map_err(|unclear| match unclear {
        UnclearMark::Mixed { line, .. } => (usize::try_from(line).ok(), unclear.to_string()),
        UnclearMark::Thousands { line, .. } => {
            (usize::try_from(line).ok(), format!("{unclear}: write numbers without commas"))
        }
    })
}

/// The quantity of every column.
fn columns(header: &[String]) -> Result<Vec<Option<Quantity>>, String> {
    let quantity = |name: &String| {
        let found = NAMES.iter().find(|(known, _)| name.eq_ignore_ascii_case(known));
        found.map(|(_, quantity)| *quantity)
    };
    let columns: Vec<Option<Quantity>> = header.iter().map(quantity).collect();
    // A temperature or pressure that is not understood must not be taken for one that was not measured.
    let meant = |name: &&String| {
        let name = name.to_ascii_lowercase();
        let short = ["t", "p", "sigma"].iter().any(|short| {
            name == *short
                || name
                    .strip_prefix(short)
                    .is_some_and(|rest| rest.starts_with(['_', ' ', '/', '(', '[']))
        });
        quantity(&name).is_none() && (short || name.contains("temp") || name.contains("press"))
    };
    if let Some(name) = header.iter().find(meant) {
        return Err(format!(
            "the column `{name}` is not understood: temperatures stand in temperature_c (°C), pressures in pressure_mpa (MPa); \
             rename it, or give it another name if it is not to be read"
        ));
    }
    let has = |of: &[Quantity]| columns.iter().flatten().filter(|q| of.contains(q)).count();
    let speeds = has(&[Quantity::SpeedMm, Quantity::SpeedM, Quantity::LogSpeedM]);
    for (count, what) in [(speeds, "speed"), (has(&[Quantity::Friction]), "friction")] {
        if count != 1 {
            let found = header.join(", ");
            return Err(format!(
                "{count} columns of the {what} among `{found}`, one is needed; {HEADER}"
            ));
        }
    }
    for (quantity, name) in
        [(Quantity::Temperature, "temperature_c"), (Quantity::Pressure, "pressure_mpa")]
    {
        if has(&[quantity]) > 1 {
            return Err(format!("{name} stands twice"));
        }
    }
    Ok(columns)
}

fn point(
    columns: &[Option<Quantity>],
    cells: &[String],
    mark: DecimalMark,
) -> Result<MeasuredPoint, String> {
    let mut point = MeasuredPoint {
        speed_mm_s: f64::NAN,
        friction: f64::NAN,
        temperature_c: None,
        pressure_mpa: None,
    };
    for (column, cell) in columns.iter().zip(cells) {
        let Some(quantity) = column else { continue };
        let value = number(cell, mark).ok_or_else(|| format!("`{cell}` is not a number"))?;
        if !value.is_finite() {
            return Err(format!("`{cell}` is not a finite number: leave the line out"));
        }
        match quantity {
            Quantity::SpeedMm => point.speed_mm_s = value,
            Quantity::SpeedM => point.speed_mm_s = value.m_to_mm(),
            Quantity::LogSpeedM => point.speed_mm_s = 10.0_f64.powf(value).m_to_mm(),
            Quantity::Friction => point.friction = value,
            Quantity::Temperature => point.temperature_c = Some(value),
            Quantity::Pressure => point.pressure_mpa = Some(value),
        }
    }
    if !(point.speed_mm_s > 0.0 && point.speed_mm_s.is_finite()) {
        return Err(format!("the speed {} mm/s is not positive", point.speed_mm_s));
    }
    if let Some(celsius) = point.temperature_c.filter(|c| !(-100.0..=HOTTEST_C).contains(c)) {
        return Err(format!(
            "the temperature {celsius} °C is not between -100 and {HOTTEST_C} °C; is it in K?"
        ));
    }
    if let Some(pressure) = point.pressure_mpa.filter(|pressure| *pressure <= 0.0) {
        return Err(format!("the pressure {pressure} MPa is not positive"));
    }
    if let Some(pressure) = point.pressure_mpa.filter(|pressure| *pressure > LARGEST_MPA) {
        return Err(format!(
            "the pressure {pressure} MPa is above {LARGEST_MPA} MPa; is it in Pa or kPa? Give MPa"
        ));
    }
    if !FRICTIONS.contains(&point.friction) {
        return Err(format!(
            "the friction coefficient {} is not between {} and {}: give force over load, not percent; are columns swapped?",
            point.friction,
            FRICTIONS.start(),
            FRICTIONS.end()
        ));
    }
    Ok(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_their_names() {
        let text = "# tester 7\nspeed_m_s; friction; note; temperature_c\n1e-3; 1.2; a; 20\n0.5; 1.4; b; 21.5\n";
        let file = parse(text, &[]).unwrap();
        assert_eq!((file.points.len(), &file.lines[..]), (2, &[3, 4][..]));
        let last = file.points[1];
        assert_eq!((last.speed_mm_s, last.friction), (500.0, 1.4));
        assert_eq!((last.temperature_c, last.pressure_mpa), (Some(21.5), None));
        let blanks = parse("log10_speed_m_s  friction\n-3 0.7\n", &[]).unwrap();
        let names = ["log10_speed_m_s", "friction"].map(str::to_owned);
        let named = parse("# no header\n-3 0.7\n", &names).unwrap();
        assert_eq!((named.lines, &named.points), (vec![2], &blanks.points));
        approx::assert_relative_eq!(blanks.points[0].speed_mm_s, 1.0, max_relative = 1e-14);
    }

    #[test]
    fn decimal_commas_quotes_and_returns_are_read() {
        let plain = parse("speed_mm_s,friction,temperature_c\n0.1,0.85,20\n1,1.25,21.5\n", &[]);
        let plain = plain.unwrap();
        for text in [
            "speed_mm_s;friction;temperature_c\n0,1;0,85;20\n1;1,25;21,5\n",
            "\"speed_mm_s\";\"friction\";\"temperature_c\"\r\n\"0,1\";\"0,85\";20\r\n1;1,25;21,5\r\n",
            "\"speed_mm_s\",\"friction\",\"temperature_c\"\n0.1,0.85,20\n1,1.25,21.5\n",
            "\"speed_mm_s\" \"friction\" \"temperature_c\"\n0,1 0,85 20\n1 1,25 21,5\n",
            "speed_mm_s\tfriction\ttemperature_c\r0,1\t0,85\t20\r1\t1,25\t21,5\r",
        ] {
            assert_eq!(parse(text, &[]).unwrap(), plain, "{text}");
        }
        let names = ["speed_mm_s", "friction", "temperature_c"].map(str::to_owned);
        let bare = parse("0,1 0,85 20\n1 1,25 21,5\n", &names).unwrap();
        assert_eq!(bare.points, plain.points);
        let bare = parse("0.1, 0.85, 20\n1, 1.25, 21.5\n", &names).unwrap();
        assert_eq!(bare.points, plain.points);
        // A comma in a column that is not read says nothing.
        let note = "speed_mm_s;note;friction\n0.1;dry, hot;0.85\n";
        assert_eq!(parse(note, &[]).unwrap().points[0].friction, 0.85);
    }

    #[test]
    fn marks_with_two_readings_are_refused_with_advice() {
        let error = |text: &str| parse(text, &[]).unwrap_err();
        let (line, text) = error("speed_mm_s,friction\n0,1,0,85\n");
        assert!(
            line == Some(2) && text.contains("4 cells") && text.contains("semicolons"),
            "{text}"
        );
        let (line, text) = error("speed_mm_s;friction\n100;1\n1,000;1\n");
        assert!(line == Some(3) && text.contains("`1,000` may have a decimal comma"), "{text}");
        let (line, text) = error("speed_mm_s;friction\n0.1;0,85\n");
        assert!(line == Some(2) && text.contains("`0,85` has a comma"), "{text}");
    }

    #[test]
    fn mistakes_are_told_with_their_line() {
        let error = |text: &str| parse(text, &[]).unwrap_err();
        assert!(error("").1.contains("empty"));
        assert!(error("speed,friction\n1,2\n").1.contains("0 columns of the speed"));
        assert_eq!(
            error("speed_mm_s,friction\n1,2\n1,x\n"),
            (Some(3), "`x` is not a number".into())
        );
        assert!(error("speed_mm_s,friction\n1,nan\n").1.contains("`nan` is not a finite"));
        assert!(error("speed_mm_s,friction\n1,85\n").1.contains("not percent"));
        assert!(
            error("speed_mm_s,friction,p_MPa\n1,1,3\n").1.contains("`p_MPa` is not understood")
        );
        assert!(error("speed_mm_s,friction,temperature_c\n1,1,300\n").1.contains("is it in K"));
        // 0.3 MPa typed in Pa: theory would take it.
        let pascal = error("speed_mm_s,friction,pressure_mpa\n1,1,300000\n").1;
        assert!(pascal.contains("300000 MPa") && pascal.contains("is it in Pa"), "{pascal}");
        assert!(error("speed_mm_s,friction,temperature_k\n1,1,300\n").1.contains("temperature_k"));
        assert!(error("speed_mm_s,friction\n1\n").1.contains("1 cells"));
        assert!(error("speed_mm_s,friction\n-1,2\n").1.contains("not positive"));
        assert!(error("speed_mm_s,friction\n").1.contains("no measurement"));
        assert!(error("speed_mm_s,speed_m_s,friction\n").1.contains("2 columns of the speed"));
    }
}
