//! The description of a text file in the recipe.

use crate::ScanProblem;
use schemars::JsonSchema;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// How a text file, or a sheet of a workbook (.xlsx), holds a line scan or a height map: one line per
/// point, positions and heights in columns; or, with `matrix`, one line per row of a map.
///
/// The file is read in this order: `encoding`, `skip_lines`, `skip_until`, column names, points
/// up to `stop_at`, cuts. Cells of a sheet are cells already: `separator` and `encoding` do nothing there.
// `remote` makes functions of what is derived; the traits below add what depends on other keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, remote = "Self")]
#[schemars(extend("anyOf" = [
    { "required": ["z_column"] },
    { "required": ["matrix"], "properties": { "matrix": { "const": true } } },
]))]
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
    /// True for a file of heights alone, one row of a height map on each line: the first line is the
    /// first row, the first height of a line is at x = 0. `x_spacing_um` and `y_spacing_um` are its
    /// spacings; it has no columns, so that keys of columns and their names cannot be set.
    #[serde(default, skip_serializing_if = "is_false")]
    pub matrix: bool,
    /// Whether a line of column names stands before the first point; true if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("type" = "boolean", "default" = true))]
    pub header: Option<bool>,
    /// Column of the positions, by name or by number (the first is 1). Either this or
    /// `x_spacing_um`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_column: Option<Column>,
    /// Distance between neighbouring lines in micrometres, for a file that holds heights only; of a
    /// `matrix` the distance between neighbouring heights of a line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_spacing_um: Option<f64>,
    /// Distance between the lines of a `matrix` in micrometres; `x_spacing_um` if not set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_spacing_um: Option<f64>,
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
    /// Column of the heights, by name or by number (the first is 1). Required unless `matrix` is true.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z_column: Option<Column>,
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

impl<'de> Deserialize<'de> for TextFormat {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut format = Self::deserialize(deserializer)?;
        if !format.matrix {
            format.header.get_or_insert(true);
            if format.z_column.is_none() {
                return Err(D::Error::missing_field("z_column"));
            }
        }
        Ok(format)
    }
}

impl Serialize for TextFormat {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Self::serialize(self, serializer)
    }
}

impl TextFormat {
    /// Whether a line of column names stands before the first point.
    pub fn has_header(&self) -> bool {
        self.header.unwrap_or(!self.matrix)
    }

    /// Whether the file holds a height map and not a line.
    pub fn is_map(&self) -> bool {
        self.matrix || self.y_column.is_some()
    }

    /// The column of the heights, which a matrix does not have.
    pub(super) fn height_column(&self) -> Result<&Column, ScanProblem> {
        let reason = "is not set; name the column of the heights, or set matrix = true for a file of rows of heights";
        self.z_column.as_ref().ok_or_else(|| description("z_column", reason))
    }

    /// Checks what serde cannot: keys that depend on each other and ranges of values.
    ///
    /// # Errors
    /// [`ScanProblem::Description`] with the key and what to do.
    pub fn validate(&self) -> Result<(), ScanProblem> {
        if self.matrix {
            self.validate_matrix()?;
        } else {
            self.validate_columns()?;
        }
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

    /// A matrix has spacings in place of columns.
    fn validate_matrix(&self) -> Result<(), ScanProblem> {
        let set = [
            ("x_column", self.x_column.is_some()),
            ("x_unit", self.x_unit.is_some()),
            ("y_column", self.y_column.is_some()),
            ("y_unit", self.y_unit.is_some()),
            ("z_column", self.z_column.is_some()),
        ];
        if let Some((key, _)) = set.into_iter().find(|(_, set)| *set) {
            return Err(description(
                key,
                "does not go with matrix = true, whose lines hold heights alone; leave one of them out",
            ));
        }
        if self.header == Some(true) {
            return Err(description(
                "header",
                "does not go with matrix = true, which has no column names; leave it out, and pass over lines before the \
                 first row by skip_lines, skip_until or comment",
            ));
        }
        let cuts = [("cut_start_mm", self.cut_start_mm), ("cut_end_mm", self.cut_end_mm)];
        if let Some((key, length)) = cuts.into_iter().find(|(_, length)| *length != 0.0) {
            let reason =
                format!("is {length} mm, and is for line scans; leave it out with matrix = true");
            return Err(description(key, reason));
        }
        if self.x_spacing_um.is_none() {
            return Err(description(
                "x_spacing_um",
                "is not set; with matrix = true it is the distance between neighbouring heights of a line",
            ));
        }
        let spacings = [("x_spacing_um", self.x_spacing_um), ("y_spacing_um", self.y_spacing_um)];
        spacings.into_iter().try_for_each(|(key, spacing)| positive(key, spacing))
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
            (Some(_), None) if self.x_unit.is_none() => return Err(missing_unit("x_unit")),
            _ => positive("x_spacing_um", self.x_spacing_um)?,
        }
        if self.y_spacing_um.is_some() {
            return Err(description("y_spacing_um", "goes with matrix = true, which is not set"));
        }
        self.validate_map()?;
        let heights = self.height_column()?;
        let columns = [&self.x_column, &self.y_column, &self.z_column];
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
            ("z_column", Some(heights)),
            ("sheet", self.sheet.as_ref()),
        ] {
            match column {
                Some(Column::Number(0)) => {
                    return Err(description(key, "is 0; the first is number 1"));
                }
                Some(Column::Name(name)) if !self.has_header() && key != "sheet" => {
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

fn positive(key: &'static str, spacing: Option<f64>) -> Result<(), ScanProblem> {
    match spacing {
        Some(spacing) if !(spacing > 0.0 && spacing.is_finite()) => {
            Err(description(key, format!("is {spacing}; it must be positive")))
        }
        _ => Ok(()),
    }
}

fn missing_unit(key: &'static str) -> ScanProblem {
    description(key, "is not set; units are never guessed: choose one of nm, um, mm, m")
}

fn description(key: &'static str, reason: impl Into<String>) -> ScanProblem {
    ScanProblem::Description { key, reason: reason.into() }
}

// The signature is that of serde.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_false(flag: &bool) -> bool {
    !*flag
}

/// The marks of a missing height that need not be listed.
pub(super) fn default_missing() -> Vec<String> {
    ["", "NaN", "BAD"].map(String::from).to_vec()
}

fn default_encoding() -> String {
    "utf-8".into()
}
