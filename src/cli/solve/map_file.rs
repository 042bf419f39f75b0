//! A height map of one period: of an instrument, or in a text file.

use std::path::Path;

use crate::cli::inspect::{ScanOptions, read_instrument};
use crate::cli::{CliError, values};
use asperity::files;
use asperity::scans::Described;
use asperity::scans::description::LengthUnit;
use asperity::scans::file::{Grid, ScanFile};

/// Largest deviation of a position from equal spacing, in spacings.
const SPACING_TOLERANCE: f64 = 0.05;
/// Columns of a text with positions: x, y and z.
const POSITIONED: usize = 3;

/// Heights on a grid.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::cli) struct Map {
    /// Points along x and y.
    pub points: [usize; 2],
    /// Periods along x and y in m.
    pub periods: [f64; 2],
    /// Heights in m, row by row along x.
    pub heights: Vec<f64>,
}

/// Reads a map. An instrument file states its units and spacings; a text is described by the options `text`, or has a `unit`
/// and, if it is one of heights alone, row by row, the `size` in m of its rows and, if its spacings differ, of its columns.
///
/// # Errors
/// [`CliError::Input`] with the file and the line or point.
pub(in crate::cli) fn read_map(
    path: &Path,
    unit: Option<LengthUnit>,
    size: Option<[Option<f64>; 2]>,
    text: &ScanOptions,
) -> Result<Map, CliError> {
    let map = read_map_with_gaps(path, unit, size, text)?;
    let missing = map.heights.iter().filter(|z| z.is_nan()).count();
    let Some(first) = map.heights.iter().position(|z| z.is_nan()) else { return Ok(map) };
    Err(CliError::input(format!(
        "{}: {missing} of {} heights are missing, the first in column {}, row {} (counted from 0): fill or cut them first",
        path.display(),
        map.heights.len(),
        first % map.points[0],
        first / map.points[0]
    )))
}

/// As [`read_map`], with NaN where heights are missing.
///
/// # Errors
/// As [`read_map`], but for missing heights.
pub(in crate::cli) fn read_map_with_gaps(
    path: &Path,
    unit: Option<LengthUnit>,
    size: Option<[Option<f64>; 2]>,
    text: &ScanOptions,
) -> Result<Map, CliError> {
    let in_file = |problem: String| CliError::input(format!("{}: {problem}", path.display()));
    let given = match (unit, size) {
        (Some(_), _) => Some("--map-unit"),
        (None, size) => size.map(|_| "--size-mm"),
    };
    if let Some(scan) = read_instrument(path, None)? {
        text.refuse(path, "the file of an instrument, which states its units")?;
        if let Some(given) = given {
            return Err(in_file(format!(
                "is the file of an instrument, which states its units and spacings: leave {given} out"
            )));
        }
        return of_grid(scan).map_err(in_file);
    }
    if let Some(option) = text.given().first() {
        if let Some(given) = given {
            return Err(in_file(format!(
                "is described by {option}, and its unit and spacings by such options too: leave {given} out"
            )));
        }
        return match text.read(path)? {
            Described::Map(scan) => of_grid(scan).map_err(in_file),
            Described::Line(_) => Err(in_file(
                "is described as a line, not a map: give --y-column and --y-unit as well, or --matrix for rows of heights".into(),
            )),
        };
    }
    let Some(unit) = unit else {
        return Err(in_file(
            "is not an instrument file; to read it as text, give --map-unit (nm, um, mm or m), which is never guessed, or \
             describe it as for inspect"
                .into(),
        ));
    };
    let bytes = files::read(path, files::LARGEST_NUMBERS)
        .map_err(|error| in_file(format!("cannot be read: {error}{}", files::advice(&error))))?;
    let text = String::from_utf8(bytes).map_err(|_| in_file("is not UTF-8 text".into()))?;
    of_text(&text, unit, size).map_err(in_file)
}

fn of_grid(scan: ScanFile) -> Result<Map, String> {
    let Grid::Map { columns, rows, spacing_x, spacing_y } = scan.grid else {
        return Err("holds a line, not a map: a recipe reads it (section [ingest])".into());
    };
    Ok(Map {
        points: [columns, rows],
        periods: [spacing_x * columns as f64, spacing_y * rows as f64],
        heights: scan.heights,
    })
}

/// The numbers of the lines that have any, with their line numbers.
fn rows(text: &str) -> Result<Vec<(usize, Vec<f64>)>, String> {
    let mut found = Vec::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let data = line.split('#').next().unwrap_or_default();
        if data.trim().is_empty() {
            continue;
        }
        let number = |(column, cell): (usize, &str)| {
            values::finite(cell).map_err(|problem| {
                format!(
                    "line {}, column {}: {problem}; start lines of text with #, fill or cut missing points first",
                    index + 1,
                    column + 1
                )
            })
        };
        if let Some(number) = decimal_comma(data) {
            return Err(format!(
                "line {}: `{number}` looks like a number with a decimal comma: write decimal points",
                index + 1
            ));
        }
        let cells = cells(data);
        let numbers: Result<Vec<f64>, String> = cells.into_iter().enumerate().map(number).collect();
        found.push((index + 1, numbers?));
    }
    Ok(found)
}

/// Blanks around a comma or semicolon are part of the separator; between two separators is an empty cell.
fn cells(data: &str) -> Vec<&str> {
    let parts = data.trim().trim_end_matches([',', ';']).split([',', ';']);
    parts
        .flat_map(|part| match part.trim() {
            "" => vec![""],
            cells => cells.split_whitespace().collect(),
        })
        .collect()
}

/// A number such as `0,5` beside others that are separated otherwise, on a line without a decimal point.
fn decimal_comma(data: &str) -> Option<&str> {
    let is_digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let tokens: Vec<&str> =
        data.split([';', ' ', '\t']).filter(|token| !token.is_empty()).collect();
    if data.contains('.') || tokens.len() < 2 {
        return None;
    }
    tokens.into_iter().find(|token| {
        token.split_once(',').is_some_and(|(whole, rest)| {
            is_digit(whole.chars().next_back()) && is_digit(rest.chars().next())
        })
    })
}

fn of_text(text: &str, unit: LengthUnit, size: Option<[Option<f64>; 2]>) -> Result<Map, String> {
    let rows = rows(text)?;
    let Some((first_line, first)) = rows.first() else { return Err("holds no numbers".into()) };
    let columns = first.len();
    if let Some((line, other)) = rows.iter().find(|(_, row)| row.len() != columns) {
        return Err(format!(
            "line {line} has {} numbers, line {first_line} has {columns}: every row of a map has as many",
            other.len()
        ));
    }
    match (columns, size) {
        (POSITIONED, None) => positioned(&rows, unit),
        (POSITIONED, Some(_)) => Err(
            "has three columns, x, y and z, which tell the size of the map: leave --size-mm out"
                .into(),
        ),
        (_, None) => Err(format!(
            "has rows of {columns} heights without positions: give the length of a row as --size-mm"
        )),
        (_, Some([along, across])) => {
            let (nx, ny) = (columns, rows.len());
            let Some(length) = along else {
                return Err("give the length of a row as --size-mm".into());
            };
            let width = across.unwrap_or(length / nx as f64 * ny as f64);
            Ok(Map {
                points: [nx, ny],
                periods: [length, width],
                heights: rows.iter().flat_map(|(_, row)| row).map(|z| unit.metres(*z)).collect(),
            })
        }
    }
}

/// A map of one point a line: x runs fastest, or y.
fn positioned(rows: &[(usize, Vec<f64>)], unit: LengthUnit) -> Result<Map, String> {
    let value = |axis: usize| move |(_, row): &(usize, Vec<f64>)| row[axis];
    let run = |axis: usize| {
        let first = rows[0].1[axis];
        rows.iter().take_while(|row| value(axis)(row) == first).count()
    };
    // Where one position stays, the other runs.
    let (along_y, along_x) = (run(0), run(1));
    let (fast, inner) = if along_x >= along_y { (0, along_x) } else { (1, along_y) };
    let outer = rows.len() / inner;
    if inner < 2 || outer < 2 || inner * outer != rows.len() {
        return Err(format!(
            "has {} points, whose first row has {inner}: give them row by row or column by column, each of the same number \
             of points, two or more",
            rows.len()
        ));
    }
    let slow = 1 - fast;
    let step = |axis: usize, stride: usize, count: usize| {
        (rows[(count - 1) * stride].1[axis] - rows[0].1[axis]) / (count - 1) as f64
    };
    let steps = [step(fast, 1, inner), step(slow, inner, outer)];
    for (index, (line, row)) in rows.iter().enumerate() {
        let places = [(fast, index % inner, steps[0]), (slow, index / inner, steps[1])];
        for (axis, place, step) in places {
            let expected = rows[0].1[axis] + place as f64 * step;
            let close = (row[axis] - expected).abs() <= SPACING_TOLERANCE * step.abs();
            if step == 0.0 || !close {
                let name = ["x", "y"][axis];
                return Err(format!(
                    "line {line}: {name} = {} is not on a grid of equal spacing, which has {expected} there",
                    row[axis]
                ));
            }
        }
    }
    let (nx, ny) = if fast == 0 { (inner, outer) } else { (outer, inner) };
    let [step_x, step_y] = if fast == 0 { steps } else { [steps[1], steps[0]] };
    let height = |j: usize, i: usize| {
        // Descending positions are the same map, read from its other end.
        let i = if step_x < 0.0 { nx - 1 - i } else { i };
        let j = if step_y < 0.0 { ny - 1 - j } else { j };
        let index = if fast == 0 { j * inner + i } else { i * inner + j };
        unit.metres(rows[index].1[2])
    };
    Ok(Map {
        points: [nx, ny],
        periods: [unit.metres(step_x.abs()) * nx as f64, unit.metres(step_y.abs()) * ny as f64],
        heights: (0..ny)
            .flat_map(|j| (0..nx).map(move |i| (j, i)))
            .map(|(j, i)| height(j, i))
            .collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, size: Option<[Option<f64>; 2]>) -> Result<Map, String> {
        of_text(text, LengthUnit::Um, size)
    }

    #[test]
    fn points_and_rows_are_the_same_map() {
        // Heights 1 to 6 um in two rows of three points, spacings of 10 and 20 um.
        let rows = read("1 2 3 4\n5 6 7 8 # the second row\n\n", Some([Some(40e-6), Some(40e-6)]))
            .unwrap();
        assert_eq!((rows.points, rows.periods), ([4, 2], [40e-6, 40e-6]));
        let line = |x: i32, y: i32, z: i32| format!("{x};{y};{z}\n");
        let order = |flip: [bool; 2], y_first: bool| {
            let mut lines = Vec::new();
            for k in 0..8 {
                let (i, j) = if y_first { (k / 2, k % 2) } else { (k % 4, k / 4) };
                let i = if flip[0] { 3 - i } else { i };
                let j = if flip[1] { 1 - j } else { j };
                lines.push(line(10 * i, 20 * j, 1 + i + 4 * j));
            }
            lines.concat()
        };
        for flip in [[false, false], [true, false], [false, true], [true, true]] {
            for y_first in [false, true] {
                let map = read(&order(flip, y_first), None).unwrap();
                assert_eq!(map.points, [4, 2]);
                for (a, b) in map.periods.iter().zip(rows.periods) {
                    approx::assert_relative_eq!(*a, b, max_relative = 1e-12);
                }
                assert_eq!(map.heights, rows.heights, "{flip:?} {y_first}");
            }
        }
        // Equal spacing where the width is not given.
        let square = read("1,2,3,4\n5,6,7,8\n", Some([Some(40e-6), None])).unwrap();
        assert_eq!(square.periods, [40e-6, 20e-6]);
    }

    #[test]
    fn mistaken_maps_are_explained() {
        let size = Some([Some(1e-3), None]);
        for (text, size, part) in [
            ("# nothing\n", None, "holds no numbers"),
            ("1 2 3 4\n1 2 3\n", size, "line 2 has 3 numbers, line 1 has 4"),
            ("1 2 3 4\n1 2 x 4\n", size, "line 2, column 3: `x` is not a number"),
            ("1 2 nan 4\n", size, "line 1, column 3: `nan` is not a finite number"),
            ("1;;3;4\n", size, "line 1, column 2"),
            ("0,5\t0,25\t1\t2\n", size, "line 1: `0,5` looks like a number with a decimal comma"),
            ("1;2\n0,5;0,25\n", size, "line 2: `0,5` looks like"),
            ("1 2 3 4\n", None, "give the length of a row as --size-mm"),
            ("0 0 1\n1 0 1\n", size, "leave --size-mm out"),
            ("0 0 1\n1 0 1\n2 0 1\n", None, "has 3 points, whose first row has 3"),
            ("0 0 1\n1 0 1\n0 1 1\n1.2 1 1\n", None, "line 4: x = 1.2 is not on a grid"),
            ("0 0 1\n1 0 1\n0 1 1\n1 1 1\n0 3 1\n1 3 1\n", None, "line 3: y = 1 is not on a grid"),
        ] {
            let message = read(text, size).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
