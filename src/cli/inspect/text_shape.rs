//! Text without a description: what it looks like, and what would describe it.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::foreign;
use crate::cli::CliError;
use crate::cli::output::aligned;
use crate::scans::description::{DecimalMark, LengthUnit, Separator};
use crate::scans::text_shape::{self, separator_text};

/// What a text looks like.
#[derive(Debug, Serialize)]
pub(super) struct TextShape {
    path: PathBuf,
    format: &'static str,
    encoding: &'static str,
    separator: Separator,
    decimal_mark: DecimalMark,
    comment: Option<char>,
    /// Lines before the names of the columns or the points.
    skip_lines: usize,
    skip_until: Option<String>,
    header: bool,
    columns: Vec<Column>,
    /// Lines of points among the first 2000.
    rows: usize,
    /// Lines before the points that state a unit.
    stated: Vec<String>,
    /// The section of a recipe that would read it.
    recipe_section: String,
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
        let bytes = std::fs::read(path)
            .map_err(|error| CliError::input(format!("cannot read {}: {error}", path.display())))?;
        let shape = text_shape::TextShape::of(&bytes)
            .ok_or_else(|| foreign(path, "is text without lines of numbers: no scan"))?;
        let recipe_section = shape.recipe_section();
        let column = |column: text_shape::TextColumn| Column {
            name: column.name,
            unit: column.unit,
            grows: column.grows,
        };
        Ok(Self {
            path: path.to_path_buf(),
            format: "text",
            encoding: shape.encoding,
            separator: shape.separator,
            decimal_mark: shape.decimal_mark,
            comment: shape.comment,
            skip_lines: shape.skip_lines,
            skip_until: shape.skip_until,
            header: shape.header,
            columns: shape.columns.into_iter().map(column).collect(),
            rows: shape.rows,
            stated: shape.stated,
            recipe_section,
        })
    }

    pub(super) fn text(&self) -> String {
        let mark = match self.decimal_mark {
            DecimalMark::Point => "point",
            DecimalMark::Comma => "comma",
        };
        let column = |(index, column): (usize, &Column)| {
            let unit = match column.unit {
                Some(unit) => format!("{unit:?}").to_lowercase(),
                None => "no unit stated".into(),
            };
            let grows = if column.grows { ", grows" } else { "" };
            format!("{} `{}`: {unit}{grows}", index + 1, column.name)
        };
        let columns: Vec<String> = self.columns.iter().enumerate().map(column).collect();
        let before = match &self.skip_until {
            Some(marker) => format!("{} lines, the last is `{marker}`", self.skip_lines),
            None => format!("{} lines to skip", self.skip_lines),
        };
        let lines = aligned(&[
            ("file", self.path.display().to_string()),
            ("format", "text; nothing is read of it without a description".into()),
            ("encoding", self.encoding.into()),
            ("separator", separator_text(self.separator).trim_matches('"').into()),
            ("decimal mark", mark.into()),
            ("before the columns", before),
            ("column names", if self.header { "yes" } else { "no" }.into()),
            ("columns", columns.join("\n")),
            ("lines of points", format!("{} (of the first 2000 lines)", self.rows)),
            ("stated units", self.stated.join("\n")),
        ]);
        format!("{lines}\na description for the recipe, to be checked:\n\n{}", self.recipe_section)
    }
}
