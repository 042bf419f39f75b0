//! The description of a text file in the recipe.

use crate::ScanProblem;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a text file, or a sheet of a workbook (.xlsx), holds a line scan or a height map: one line per
/// point, positions and heights in columns.
///
/// The file is read in this order: `encoding`, `skip_lines`, `skip_until`, column names, points
/// up to `stop_at`, cuts. Cells of a sheet are cells already: `separator` and `encoding` do nothing there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TextFormat {
    /// Sheet of a workbook, by name or by number (the first is 1, which is the default).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sheet: Option<Column>,
    /// What stands between the cells: `tab`, `comma`, `semicolon`, `whitespace` (any run of
    /// blanks) or any single ASCII character.
    pub separator: Separator,
    /// The decimal mark, `.` or `,`; thousands are not separated.
    #[serde(default)]
    pub decimal_mark: DecimalMark,
    /// Character that starts a comment line, for instance `#`; none by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comment: Option<char>,
    /// Number of lines to skip at the start of the file.
    #[serde(default)]
    pub skip_lines: usize,
    /// Skip all lines up to and with the first that starts with this text, for instance
    /// `*****DATA*****`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skip_until: Option<String>,
    /// The points end before the first line after them that starts with this text, for instance
    /// `*****END*****`, which has to come.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stop_at: Option<String>,
    /// Whether a line of column names stands before the first point.
    #[serde(default = "yes")]
    pub header: bool,
    /// Column of the positions, by name or by number (the first is 1). Either this or
    /// `x_spacing_um`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_column: Option<Column>,
    /// Distance between neighbouring lines in micrometres, for a file that holds heights only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_spacing_um: Option<f64>,
    /// Unit of the positions: `nm`, `um`, `mm` or `m`. Required with `x_column`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_unit: Option<LengthUnit>,
    /// Column of the positions across the lines of a height map, by name or by number (the first is
    /// 1). The points are then a grid, sorted by rows or by columns, of which some may be left out;
    /// `ingest.map_lines` takes lines of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_column: Option<Column>,
    /// Unit of the positions across the lines: `nm`, `um`, `mm` or `m`. Required with `y_column`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_unit: Option<LengthUnit>,
    /// Column of the heights, by name or by number (the first is 1).
    pub z_column: Column,
    /// Unit of the heights: `nm`, `um`, `mm` or `m`. Required.
    #[schemars(required)]
    pub z_unit: Option<LengthUnit>,
    /// True for a file of depths, whose numbers grow away from the rubber.
    #[serde(default)]
    pub invert_z: bool,
    /// Cells that mark a missing height. Words compare without regard to case, numbers by value:
    /// `-25400` also stands for `-25400.000`. The empty text stands for an empty cell.
    #[serde(default = "default_missing")]
    pub missing: Vec<String>,
    /// Encoding, as a label of the WHATWG standard: `utf-8`, `latin1`, `windows-1252`,
    /// `utf-16le`, ... A byte order mark takes precedence.
    #[serde(default = "default_encoding")]
    pub encoding: String,
    /// Length to cut off the start of the track in millimetres, for instance a reference plate.
    #[serde(default)]
    pub cut_start_mm: f64,
    /// Length to cut off the end of the track in millimetres.
    #[serde(default)]
    pub cut_end_mm: f64,
}

/// What stands between two cells of a line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Separator {
    /// One tabulator.
    Tab,
    /// One comma.
    Comma,
    /// One semicolon.
    Semicolon,
    /// Any run of blanks and tabulators; leading and trailing ones do not count.
    Whitespace,
    /// Any other single ASCII character.
    #[serde(untagged)]
    Character(char),
}

impl Separator {
    /// The character, or `None` for any run of blanks.
    pub fn character(self) -> Option<char> {
        match self {
            Self::Tab => Some('\t'),
            Self::Comma => Some(','),
            Self::Semicolon => Some(';'),
            Self::Whitespace => None,
            Self::Character(character) => Some(character),
        }
    }
}

/// The mark between the whole and the fraction of a number.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub enum DecimalMark {
    /// `1.5`
    #[default]
    #[serde(rename = ".")]
    Point,
    /// `1,5`
    #[serde(rename = ",")]
    Comma,
}

/// A column of a text file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Column {
    /// By number; the first column is 1.
    Number(usize),
    /// By its name in the header, without regard to blanks around it.
    Name(String),
}

/// Unit of a length in a file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    /// Nanometre.
    Nm,
    /// Micrometre.
    Um,
    /// Millimetre.
    Mm,
    /// Metre.
    M,
}

impl LengthUnit {
    /// Length of `value` units in metres. Divides by a power of ten where that is exact, so that
    /// the result is the double nearest to the number in the file.
    pub fn metres(self, value: f64) -> f64 {
        match self {
            Self::Nm => value / 1e9,
            Self::Um => value / 1e6,
            Self::Mm => value / 1e3,
            Self::M => value,
        }
    }
}

impl TextFormat {
    /// Checks what serde cannot: keys that depend on each other and ranges of values.
    ///
    /// # Errors
    /// [`ScanProblem::Description`] with the key and what to do.
    pub fn validate(&self) -> Result<(), ScanProblem> {
        self.validate_columns()?;
        if self.z_unit.is_none() {
            return Err(missing_unit("z_unit"));
        }
        self.validate_characters()?;
        if self.stop_at.as_ref().is_some_and(|text| text.trim().is_empty()) {
            return Err(description(
                "stop_at",
                "is empty; give the start of a line, or leave it out",
            ));
        }
        for (key, value) in [("cut_start_mm", self.cut_start_mm), ("cut_end_mm", self.cut_end_mm)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(description(key, format!("is {value}; give a length of 0 or more")));
            }
        }
        Ok(())
    }

    fn validate_map(&self) -> Result<(), ScanProblem> {
        if self.y_column.is_none() {
            return match self.y_unit {
                None => Ok(()),
                Some(_) => Err(description("y_unit", "goes with y_column, which is not set")),
            };
        }
        if self.x_column.is_none() {
            return Err(description("y_column", "needs x_column: a height map has both positions"));
        }
        if self.y_unit.is_none() {
            return Err(missing_unit("y_unit"));
        }
        let cuts = [("cut_start_mm", self.cut_start_mm), ("cut_end_mm", self.cut_end_mm)];
        match cuts.into_iter().find(|(_, length)| *length != 0.0) {
            None => Ok(()),
            Some((key, length)) => {
                let reason =
                    format!("is {length} mm, and is for line scans; leave it out with y_column");
                Err(description(key, reason))
            }
        }
    }

    fn validate_columns(&self) -> Result<(), ScanProblem> {
        match (&self.x_column, self.x_spacing_um) {
            (Some(_), Some(_)) => {
                return Err(description(
                    "x_spacing_um",
                    "is given with x_column; keep one of them",
                ));
            }
            (None, None) => {
                return Err(description(
                    "x_column",
                    "is not set; name the column of the positions, or set x_spacing_um for a file of heights only",
                ));
            }
            (None, Some(spacing)) if !(spacing > 0.0 && spacing.is_finite()) => {
                return Err(description(
                    "x_spacing_um",
                    format!("is {spacing}; it must be positive"),
                ));
            }
            (Some(_), None) if self.x_unit.is_none() => return Err(missing_unit("x_unit")),
            _ => {}
        }
        self.validate_map()?;
        let columns = [&self.x_column, &self.y_column, &Some(self.z_column.clone())];
        for (i, column) in columns.iter().enumerate() {
            if let Some(column) = column
                && columns[..i].iter().any(|other| other.as_ref() == Some(column))
            {
                let key = if i == 1 { "y_column" } else { "z_column" };
                return Err(description(key, "is the column of other positions; each has its own"));
            }
        }
        for (key, column) in [
            ("x_column", self.x_column.as_ref()),
            ("y_column", self.y_column.as_ref()),
            ("z_column", Some(&self.z_column)),
            ("sheet", self.sheet.as_ref()),
        ] {
            match column {
                Some(Column::Number(0)) => {
                    return Err(description(key, "is 0; the first is number 1"));
                }
                Some(Column::Name(name)) if !self.header && key != "sheet" => {
                    let reason = format!("is the name `{name}`, but header = false; give a number");
                    return Err(description(key, reason));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn validate_characters(&self) -> Result<(), ScanProblem> {
        let separator = self.separator.character();
        if separator.is_some_and(|c| !c.is_ascii() || "\"\r\n".contains(c)) {
            return Err(description(
                "separator",
                "must be an ASCII character, no quote or line end",
            ));
        }
        if separator == Some(',') && self.decimal_mark == DecimalMark::Comma {
            return Err(description("separator", "and decimal_mark are both a comma"));
        }
        if self.comment.is_some_and(|c| !c.is_ascii()) {
            return Err(description("comment", "must be one ASCII character"));
        }
        Ok(())
    }
}

fn missing_unit(key: &'static str) -> ScanProblem {
    description(key, "is not set; units are never guessed: choose one of nm, um, mm, m")
}

fn description(key: &'static str, reason: impl Into<String>) -> ScanProblem {
    ScanProblem::Description { key, reason: reason.into() }
}

fn yes() -> bool {
    true
}

/// The marks of a missing height that need not be listed.
pub(super) fn default_missing() -> Vec<String> {
    ["", "NaN", "BAD"].map(String::from).to_vec()
}

fn default_encoding() -> String {
    "utf-8".into()
}
