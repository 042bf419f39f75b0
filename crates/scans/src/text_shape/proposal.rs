//! The description that would read a text, in the form of a recipe.

use super::TextShape;
use crate::TextFormat;
use crate::description::{Column, DecimalMark, LengthUnit, Separator, default_missing};
use std::fmt::Write;

/// What a matrix does not state.
const MATRIX: &str = "\
matrix = true
# x_spacing_um = ?            # distance between neighbouring heights of a line: the file does not state it
# y_spacing_um = ?            # distance between the lines; x_spacing_um if left out
# z_unit = ?                  # the file does not state it: nm, um, mm or m
";

impl TextShape {
    /// The proposed description.
    ///
    /// # Errors
    /// The keys that the file does not state a value of.
    pub fn format(&self) -> Result<TextFormat, Vec<&'static str>> {
        if self.is_matrix() {
            return Err(vec!["x_spacing_um", "z_unit"]);
        }
        let (x, z) = self.proposed_columns();
        let y = self.proposed_y();
        let unit = |number: usize| self.columns[number].unit;
        let unstated: Vec<&str> = [
            ("x_spacing_um", x.is_none()),
            ("x_unit", x.is_some_and(|x| unit(x).is_none())),
            ("y_unit", y.is_some_and(|y| unit(y).is_none())),
            ("z_unit", unit(z).is_none()),
        ]
        .into_iter()
        .filter_map(|(key, absent)| absent.then_some(key))
        .collect();
        if !unstated.is_empty() {
            return Err(unstated);
        }
        Ok(TextFormat {
            sheet: self.sheet.clone().map(Column::Name),
            separator: self.separator,
            decimal_mark: self.decimal_mark,
            comment: self.comment,
            skip_lines: if self.skip_until.is_some() { 0 } else { self.skip_lines },
            skip_until: self.skip_until.clone(),
            stop_at: self.stop_at.clone(),
            matrix: false,
            header: Some(self.header),
            x_column: x.map(|x| self.column(x)),
            x_spacing_um: None,
            y_spacing_um: None,
            x_unit: x.and_then(unit),
            y_column: y.map(|y| self.column(y)),
            y_unit: y.and_then(unit),
            z_column: Some(self.column(z)),
            z_unit: unit(z),
            invert_z: false,
            missing: default_missing().into_iter().chain(self.missing.clone()).collect(),
            encoding: self.encoding.into(),
            cut_start_mm: 0.0,
            cut_end_mm: 0.0,
        })
    }

    /// The section `[ingest.text]` of a recipe that would read the file; what the file does not
    /// say stands there as a comment that asks for it.
    pub fn recipe_section(&self) -> String {
        let mut text = String::from("[ingest.text]\n");
        self.lines_of_layout(&mut text);
        if self.is_matrix() {
            text.push_str(MATRIX);
        } else {
            self.lines_of_columns(&mut text);
        }
        let mut line = |line: String| {
            // Writing to a text does not fail.
            let _ = writeln!(text, "{line}");
        };
        if !self.missing.is_empty() {
            let marks = default_missing().into_iter().chain(self.missing.clone());
            let marks: Vec<String> = marks.map(|mark| quoted(&mark)).collect();
            line(format!("missing = [{}]", marks.join(", ")));
        }
        if self.encoding != "utf-8" {
            line(format!("encoding = \"{}\"", self.encoding));
        }
        text
    }

    fn lines_of_columns(&self, text: &mut String) {
        let mut line = |line: String| {
            // Writing to a text does not fail.
            let _ = writeln!(text, "{line}");
        };
        let (x, z) = self.proposed_columns();
        match x {
            Some(x) => {
                line(format!("x_column = {}", self.column_text(x)));
                line(unit_text("x_unit", self.columns[x].unit));
            }
            None => {
                line("# x_spacing_um = ?            # the file does not say it by column".into());
            }
        }
        if let Some(y) = self.proposed_y() {
            line(format!("y_column = {}", self.column_text(y)));
            line(unit_text("y_unit", self.columns[y].unit));
        }
        line(format!("z_column = {}", self.column_text(z)));
        line(unit_text("z_unit", self.columns[z].unit));
    }

    fn lines_of_layout(&self, text: &mut String) {
        let mut line = |line: String| {
            // Writing to a text does not fail.
            let _ = writeln!(text, "{line}");
        };
        if let Some(sheet) = &self.sheet {
            line(format!("sheet = {}", quoted(sheet)));
        }
        line(format!("separator = {}", separator_text(self.separator)));
        if self.decimal_mark == DecimalMark::Comma {
            line("decimal_mark = \",\"".into());
        }
        if let Some(comment) = self.comment {
            line(format!("comment = {:?}", comment.to_string()));
        }
        match &self.skip_until {
            Some(marker) => line(format!("skip_until = {}", quoted(marker))),
            None if self.skip_lines > 0 => line(format!("skip_lines = {}", self.skip_lines)),
            None => {}
        }
        if let Some(footer) = &self.stop_at {
            line(format!("stop_at = {}", quoted(footer)));
        }
        if !self.header && !self.is_matrix() {
            line("header = false".into());
        }
    }

    /// A column by its name, or by its number if that is clearer.
    fn column(&self, number: usize) -> Column {
        let name = &self.columns[number].name;
        let unique = self.columns.iter().filter(|column| column.name == *name).count() == 1;
        if self.header && self.names_are_cells && unique && !name.is_empty() {
            Column::Name(name.clone())
        } else {
            Column::Number(number + 1)
        }
    }

    fn column_text(&self, number: usize) -> String {
        match self.column(number) {
            Column::Name(name) => quoted(&name),
            Column::Number(number) => number.to_string(),
        }
    }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// Name of a unit in a description of a text file.
pub fn unit_name(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Nm => "nm",
        LengthUnit::Um => "um",
        LengthUnit::Mm => "mm",
        LengthUnit::M => "m",
    }
}

fn unit_text(key: &str, unit: Option<LengthUnit>) -> String {
    match unit {
        Some(unit) => format!("{key} = \"{}\"", unit_name(unit)),
        None => {
            format!("# {key} = ?                  # the column does not state it: nm, um, mm or m")
        }
    }
}

/// A separator as the recipe writes it.
pub fn separator_text(separator: Separator) -> &'static str {
    match separator {
        Separator::Tab => "\"tab\"",
        Separator::Comma => "\"comma\"",
        Separator::Semicolon => "\"semicolon\"",
        Separator::Whitespace | Separator::Character(_) => "\"whitespace\"",
    }
}
