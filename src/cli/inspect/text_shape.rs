//! Text without a description: what it looks like, and a proposal for a description.

use asperity::units::Units;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::foreign;
use super::scan::Scan;
use crate::cli::CliError;
use crate::cli::output::{aligned, significant};
use asperity::scans::description::{DecimalMark, LengthUnit, Separator};
use asperity::scans::file::{Grid, ScanFile};
use asperity::scans::spreadsheet;
use asperity::scans::text_shape::{self, separator_text};
use asperity::scans::{Described, parse_described};

/// Files with more columns than this, without names, are height maps, not profiles.
const MOST_COLUMNS: usize = 12;

/// What a text looks like.
#[derive(Debug, Serialize)]
pub(super) struct TextShape {
    #[serde(with = "asperity::files::name::path")]
    path: PathBuf,
    format: &'static str,
    /// Sheet of a workbook, if it is not the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    sheet: Option<String>,
    encoding: &'static str,
    separator: Separator,
    decimal_mark: DecimalMark,
    comment: Option<char>,
    /// Number of lines before the names of the columns or the points.
    skip_lines: usize,
    skip_until: Option<String>,
    /// Start of the line after the points.
    #[serde(skip_serializing_if = "Option::is_none")]
    stop_at: Option<String>,
    header: bool,
    /// Whether the lines seem to be rows of heights.
    matrix: bool,
    columns: Vec<Column>,
    points: usize,
    /// What is read with the proposed description; absent if it cannot be read.
    #[serde(flatten)]
    read: Option<Statistics>,
    /// Why it cannot be read.
    #[serde(skip_serializing_if = "Option::is_none")]
    unread: Option<String>,
    /// Cells proposed as marks of missing heights.
    missing_marks: Vec<String>,
    /// Lines before the points that state a unit.
    stated: Vec<String>,
    /// The section of a recipe for this file.
    recipe_section: String,
}

/// Numbers as read with the proposed description, to be checked.
#[derive(Debug, Serialize)]
struct Statistics {
    missing: usize,
    /// Rows and columns of a map.
    #[serde(skip_serializing_if = "Option::is_none")]
    shape: Option<[usize; 2]>,
    /// Of the least-squares line through the positions, which ingest takes as well; along the rows of
    /// a map.
    spacing_m: f64,
    /// Between the rows of a map.
    #[serde(skip_serializing_if = "Option::is_none")]
    spacing_y_m: Option<f64>,
    mean_m: f64,
    /// Of the population of valid points.
    std_m: f64,
}

#[derive(Debug, Serialize)]
struct Column {
    name: String,
    unit: Option<LengthUnit>,
    grows: bool,
}

impl TextShape {
    /// # Errors
    /// [`CliError::Input`] for a file that cannot be read or holds no columns of numbers.
    pub(super) fn read(path: &Path) -> Result<Self, CliError> {
        let bytes = asperity::scans::read_bytes(path)
            .map_err(|error| CliError::input(format!("cannot read {}: {error}", path.display())))?;
        let is_workbook = spreadsheet::is_workbook(&bytes);
        let what = match is_workbook {
            true => "is a workbook without rows of numbers, not a scan",
            false => "is text without lines of numbers, not a scan",
        };
        let shape = text_shape::TextShape::of(&bytes)
            .ok_or_else(|| problem_of_workbook(path, &bytes, what))?;
        let matrix = shape.is_matrix();
        let mut recipe_section = shape.recipe_section();
        if shape.is_map() {
            recipe_section.insert_str(0, "[ingest]\nmap_lines = \"rows\"\n\n");
        }
        let (read, unread) = match statistics(path, &bytes, &shape) {
            Ok(statistics) => (Some(statistics), None),
            Err(reason) => (None, Some(reason)),
        };
        let column = |column: text_shape::TextColumn| Column {
            name: column.name,
            unit: column.unit,
            grows: column.grows,
        };
        Ok(Self {
            path: path.to_path_buf(),
            format: if is_workbook { "workbook" } else { "text" },
            sheet: shape.sheet,
            encoding: shape.encoding,
            separator: shape.separator,
            decimal_mark: shape.decimal_mark,
            comment: shape.comment,
            skip_lines: shape.skip_lines,
            skip_until: shape.skip_until,
            stop_at: shape.stop_at,
            header: shape.header,
            matrix,
            columns: shape.columns.into_iter().map(column).collect(),
            points: shape.rows,
            read,
            unread,
            missing_marks: shape.missing,
            stated: shape.stated,
            recipe_section,
        })
    }

    fn columns_text(&self) -> String {
        if self.matrix {
            return format!("{} heights on each line, a row of a height map", self.columns.len());
        }
        let column = |(index, column): (usize, &Column)| {
            let unit = match column.unit {
                Some(unit) => format!("{unit:?}").to_lowercase(),
                None => "no unit stated".into(),
            };
            let grows = if column.grows { ", grows" } else { "" };
            format!("{} `{}`: {unit}{grows}", index + 1, column.name)
        };
        let mut columns: Vec<String> =
            self.columns.iter().enumerate().take(MOST_COLUMNS).map(column).collect();
        if self.columns.len() > MOST_COLUMNS {
            columns.push(format!("... {} in all", self.columns.len()));
        }
        columns.join("\n")
    }

    pub(super) fn text(&self) -> String {
        let mark = match self.decimal_mark {
            DecimalMark::Point => "point",
            DecimalMark::Comma => "comma",
        };
        let before = match &self.skip_until {
            Some(marker) => format!("{} lines, the last is `{marker}`", self.skip_lines),
            None => format!("{} lines to skip", self.skip_lines),
        };
        let points = match &self.stop_at {
            Some(footer) => {
                format!("{}, followed by a line that begins with `{footer}`", self.points)
            }
            None => self.points.to_string(),
        };
        let um = |metres: f64| significant(metres.m_to_um()) + " um";
        let numbers = match (&self.read, &self.unread) {
            (Some(read), _) => format!(
                "{}{} missing, spacing {}, mean of z {}, rms of z {} about the mean",
                read.shape.map_or(String::new(), |[rows, columns]| {
                    format!("height map, {rows} rows of {columns} points, ")
                }),
                read.missing,
                match read.spacing_y_m {
                    Some(y) =>
                        format!("{} along the rows and {} between them", um(read.spacing_m), um(y)),
                    None => um(read.spacing_m),
                },
                um(read.mean_m),
                um(read.std_m)
            ),
            (None, reason) => reason.clone().unwrap_or_default(),
        };
        let what = match &self.sheet {
            Some(sheet) => format!("{}, sheet `{sheet}`", self.format),
            None => self.format.to_owned(),
        };
        let lines = aligned(&[
            ("file", self.path.display().to_string()),
            ("format", format!("{what}; nothing is read of it without a description")),
            ("encoding", self.encoding.into()),
            ("separator", separator_text(self.separator).trim_matches('"').into()),
            ("decimal mark", mark.into()),
            ("before the columns", before),
            ("column names", if self.header { "yes" } else { "no" }.into()),
            ("columns", self.columns_text()),
            ("lines of points", points),
            (
                "missing marks",
                self.missing_marks
                    .iter()
                    .map(|mark| format!("`{mark}`?"))
                    .collect::<Vec<_>>()
                    .join(", "),
            ),
            ("stated units", self.stated.join("\n")),
            ("with the proposal", numbers),
        ]);
        format!("{lines}\na description for the recipe, to be checked:\n\n{}", self.recipe_section)
    }
}

/// What is read of the file with the proposed description, or why nothing is.
fn statistics(
    path: &Path,
    bytes: &[u8],
    shape: &text_shape::TextShape,
) -> Result<Statistics, String> {
    if let Some(cell) = &shape.thousands {
        return Err(format!(
            "not read: `{cell}` separates thousands, which no description can tell from a decimal \
             mark; export the file without"
        ));
    }
    let format = shape.format().map_err(|keys| {
        format!("not read: the file does not state {}; units are never guessed", keys.join(", "))
    })?;
    let name = path.display().to_string();
    match parse_described(&name, bytes, &format).map_err(|error| error.to_string())? {
        Described::Line(scan) => {
            let Scan { missing, spacing_m, mean_m, std_m, .. } = Scan::of(path, scan);
            Ok(Statistics { missing, shape: None, spacing_m, spacing_y_m: None, mean_m, std_m })
        }
        Described::Map(map) => Ok(of_map(&map)),
    }
}

fn of_map(map: &ScanFile) -> Statistics {
    let (shape, spacing_m, spacing_y_m) = match map.grid {
        Grid::Profile { spacing } => (None, spacing, None),
        Grid::Map { columns, rows, spacing_x, spacing_y } => {
            (Some([rows, columns]), spacing_x, Some(spacing_y))
        }
    };
    let (missing, mean_m, std_m) = (map.missing(), map.mean(), map.standard_deviation());
    Statistics { missing, shape, spacing_m, spacing_y_m, mean_m, std_m }
}

/// Why no numbers were found in a file: for a workbook that cannot be opened, the reason.
fn problem_of_workbook(path: &Path, bytes: &[u8], what: &str) -> CliError {
    match spreadsheet::is_workbook(bytes).then(|| spreadsheet::Book::open(bytes)) {
        Some(Err(error)) => CliError::input(format!("{}: {error}", path.display())),
        _ => foreign(path, what),
    }
}
