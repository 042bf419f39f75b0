//! Which cells of a line hold the position and the height.

use super::number::{Cells, shorten};
use crate::description::{Column, Separator};
use crate::{ScanProblem, TextFormat};
use csv::StringRecord;

/// Indices of the columns, from 0, and their names in the header.
pub(super) struct Columns {
    /// `None` for a file of heights only.
    pub(super) x: Option<usize>,
    /// Of a height map.
    pub(super) y: Option<usize>,
    pub(super) z: usize,
    names: Option<Vec<String>>,
    /// Whether every line must have one cell per name: among blanks a name of two words is two.
    exact: bool,
}

impl Columns {
    /// Resolves the columns of a description, by the header line where there is one.
    pub(super) fn resolve(
        format: &TextFormat,
        header: Option<&StringRecord>,
        cells: &Cells,
    ) -> Result<Self, ScanProblem> {
        let names: Option<Vec<String>> =
            header.map(|record| record.iter().map(|name| name.trim().to_owned()).collect());
        if let Some(names) = &names {
            let mut written = names.iter().filter(|name| !name.is_empty()).peekable();
            if written.peek().is_some() && written.all(|name| cells.is_number(name)) {
                return Err(ScanProblem::HeaderIsData);
            }
        }
        let known = names.as_deref().unwrap_or_default();
        let place = |column: &Column| find(column, known);
        let by_name = |column: &Column| matches!(column, Column::Name(_));
        let described = [&format.x_column, &format.y_column, &format.z_column];
        let exact = format.separator == Separator::Whitespace
            && described.into_iter().flatten().any(by_name);
        let x = format.x_column.as_ref().map(place).transpose()?;
        let y = format.y_column.as_ref().map(place).transpose()?;
        let z = place(format.height_column()?)?;
        Ok(Self { x, y, z, names, exact })
    }

    /// Number of cells a line needs.
    pub(super) fn needed(&self) -> usize {
        self.x.max(self.y).unwrap_or(0).max(self.z) + 1
    }

    /// What to call a column in a message.
    pub(super) fn describe(&self, place: usize) -> String {
        match self.names.as_ref().and_then(|names| names.get(place)) {
            Some(name) if !name.is_empty() => format!("{} (`{}`)", place + 1, shorten(name)),
            _ => (place + 1).to_string(),
        }
    }

    /// Checks the number of cells of a line; empty cells at its end do not count.
    pub(super) fn check(&self, record: &StringRecord) -> Result<(), ScanProblem> {
        if let Some(names) = &self.names {
            let columns = names.len();
            let cells = if record.len() > columns { written_cells(record) } else { record.len() };
            if cells > columns || (self.exact && cells != columns) {
                return Err(ScanProblem::CellCount { cells, columns });
            }
        }
        if record.len() < self.needed() {
            return Err(ScanProblem::ShortLine { cells: record.len(), needed: self.needed() });
        }
        Ok(())
    }
}

/// Number of cells up to the last that is not empty.
pub(super) fn written_cells(record: &StringRecord) -> usize {
    (0..record.len()).rev().find(|&i| !record[i].trim().is_empty()).map_or(0, |last| last + 1)
}

fn find(column: &Column, names: &[String]) -> Result<usize, ScanProblem> {
    let name = match column {
        Column::Number(number) if names.is_empty() || *number <= names.len() => {
            return Ok(number - 1);
        }
        Column::Number(number) => return Err(unknown(number.to_string(), names)),
        Column::Name(name) => name.trim(),
    };
    let mut places = (0..names.len()).filter(|&place| names[place] == name);
    match (places.next(), places.count()) {
        (Some(place), 0) => Ok(place),
        (Some(_), more) => {
            Err(ScanProblem::AmbiguousColumn { wanted: name.to_owned(), count: more + 1 })
        }
        (None, _) => Err(unknown(name.to_owned(), names)),
    }
}

fn unknown(wanted: String, names: &[String]) -> ScanProblem {
    const SHOWN: usize = 20;
    let mut present: Vec<_> =
        names.iter().take(SHOWN).map(|name| format!("`{}`", shorten(name))).collect();
    if names.len() > SHOWN {
        present.push("...".into());
    }
    ScanProblem::UnknownColumn { wanted, present: present.join(", ") }
}
