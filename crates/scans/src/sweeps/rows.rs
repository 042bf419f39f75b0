//! Rows of numbers below a header.

use super::grid::Grid;
use super::layout::{Column, Layout, Wanted, next_layout};
use super::names::{Quantity, Unit};
use super::{GivenShift, Located, SweepPoint, TableOptions};
use crate::cells::{UnclearMark, decimal_mark, number};
use crate::description::DecimalMark;
use asperity_core::rubber::ZERO_CELSIUS;
use std::f64::consts::TAU;

/// The cells of a row that are read, as written in the file.
pub(super) struct Cells {
    line: u64,
    cells: Vec<(Column, String)>,
}

/// A row of numbers in the units of the file.
pub(super) struct Record {
    pub line: u64,
    values: Vec<(Column, String, f64)>,
}

/// Adds the rows of a table; returns the row after it.
pub(super) fn block(
    grid: &Grid,
    layout: &Layout,
    wanted: Wanted,
    options: &TableOptions,
    all: &mut Vec<Cells>,
) -> Result<usize, Located> {
    for (k, row) in grid.rows.iter().enumerate().skip(layout.first_row) {
        if row.comment {
            continue;
        }
        let cell = |column: &Column| row.cells.get(column.index).map_or("", String::as_str);
        let digits = |text: &str| text.contains(|c: char| c.is_ascii_digit());
        let there = layout.columns.iter().filter(|column| !cell(column).is_empty()).count();
        let numbers = layout.columns.iter().filter(|column| digits(cell(column))).count();
        // Behind the last row: the next table of the file, or what an instrument adds.
        if numbers == 0
            && (there < layout.columns.len() || header_follows(grid, k, wanted, options))
        {
            return Ok(k);
        }
        let surplus = row.cells.iter().skip(layout.width).any(|cell| !cell.is_empty());
        let short = layout.columns.iter().any(|column| column.index >= row.cells.len());
        if layout.width > 0 && surplus || short {
            let (cells, width) = (row.cells.len(), layout.width);
            let problem = format!(
                "{cells} values where the header has {width}: is a decimal comma also what separates the columns? \
                 Write decimals with a point, or separate the columns by semicolons"
            );
            let blank =
                "the row has fewer values than columns: complete it, or leave it out".to_owned();
            return Err((Some(row.line), if width > 0 { problem } else { blank }));
        }
        let cells = layout.columns.iter().map(|c| (c.clone(), cell(c).to_owned())).collect();
        all.push(Cells { line: row.line, cells });
    }
    Ok(grid.rows.len())
}

fn header_follows(grid: &Grid, k: usize, wanted: Wanted, options: &TableOptions) -> bool {
    matches!(next_layout(grid, k, wanted, options), Ok(Some(next)) if next.first_row <= k + 2)
}

/// How numbers are written in a file.
pub(super) struct Numbers {
    mark: DecimalMark,
}

impl Numbers {
    /// The decimal mark that is given, or the only one that the cells allow.
    pub fn of(rows: &[Cells], given: Option<DecimalMark>) -> Result<Self, Located> {
        if let Some(mark) = given {
            return Ok(Self { mark });
        }
        let cells =
            rows.iter().flat_map(|row| row.cells.iter().map(|(_, text)| (row.line, text.as_str())));
        match decimal_mark(cells) {
            Ok(mark) => Ok(Self { mark }),
            Err(unclear @ UnclearMark::Mixed { line, .. }) => {
                Err((Some(line), unclear.to_string()))
            }
            Err(unclear @ UnclearMark::Thousands { line, .. }) => Err((
                Some(line),
                format!(
                    "{unclear}: say which with --decimal-mark , or write numbers without commas"
                ),
            )),
        }
    }

    pub fn comma(&self) -> bool {
        self.mark == DecimalMark::Comma
    }

    pub fn mark_name(&self) -> &'static str {
        if self.comma() { "decimal comma" } else { "decimal point" }
    }

    pub fn record(&self, row: &Cells) -> Result<Record, Located> {
        let value = |(column, text): &(Column, String)| {
            let value = self.number(column, text).map_err(|problem| (Some(row.line), problem))?;
            Ok((column.clone(), text.clone(), value))
        };
        let values = row.cells.iter().map(value).collect::<Result<_, Located>>()?;
        Ok(Record { line: row.line, values })
    }

    fn number(&self, column: &Column, text: &str) -> Result<f64, String> {
        let name = &column.name;
        match number(text, self.mark) {
            Some(value) if value.is_finite() => Ok(value),
            Some(_) => Err(format!(
                "{name} is {text}, it must be a finite number: correct the row or leave it out"
            )),
            None if text.contains([',', '.']) && text.contains(|c: char| c.is_ascii_digit()) => {
                Err(format!(
                    "{name} is `{text}`, which is not a number with a {}: say the mark with --decimal-mark, and \
                     write numbers without marks between thousands",
                    self.mark_name()
                ))
            }
            None => Err(format!(
                "{name} is `{text}`, which is not a number: correct the row or leave it out"
            )),
        }
    }
}

impl Record {
    fn value(&self, quantity: Quantity) -> Option<&(Column, String, f64)> {
        self.values.iter().find(|(column, ..)| column.quantity == quantity)
    }

    /// A value as written in the file.
    pub fn text(&self, quantity: Quantity) -> &str {
        self.value(quantity).map_or("", |(_, text, _)| text.as_str())
    }

    /// The name of a column.
    pub fn name(&self, quantity: Quantity) -> &str {
        self.value(quantity).map_or("", |(column, ..)| column.name.as_str())
    }

    /// A value that must be positive, in SI.
    fn positive(&self, quantity: Quantity) -> Result<f64, Located> {
        let Some((column, text, value)) = self.value(quantity) else { return Ok(f64::NAN) };
        let unit = match column.unit {
            Some(Unit::Hertz) => TAU,
            Some(Unit::Pascal(size)) => size,
            _ => 1.0,
        };
        if *value > 0.0 {
            return Ok(value * unit);
        }
        let problem = format!(
            "{} is {text}, it must be positive: correct the row or leave it out",
            column.name
        );
        Err((Some(self.line), problem))
    }

    pub fn point(&self, factor: f64) -> Result<SweepPoint, Located> {
        let angular_frequency = self.positive(Quantity::Frequency)?;
        let storage_modulus = self.positive(Quantity::Storage)? * factor;
        let loss_modulus = match self.value(Quantity::Loss) {
            Some(_) => self.positive(Quantity::Loss)? * factor,
            None => self.positive(Quantity::LossFactor)? * storage_modulus,
        };
        Ok(SweepPoint { angular_frequency, storage_modulus, loss_modulus })
    }

    pub fn temperature_c(&self) -> Result<Option<f64>, Located> {
        let Some((column, text, value)) = self.value(Quantity::Temperature) else {
            return Ok(None);
        };
        let celsius = match column.unit {
            Some(Unit::Kelvin) => value - ZERO_CELSIUS,
            _ => *value,
        };
        if celsius <= -ZERO_CELSIUS {
            let problem = format!(
                "{} is {text}, which is not above absolute zero: check the number and its unit",
                column.name
            );
            return Err((Some(self.line), problem));
        }
        Ok(Some(celsius))
    }

    /// Angular frequency in rad/s, where there is a column of it.
    pub fn angular_frequency(&self) -> Result<Option<f64>, Located> {
        let there = self.value(Quantity::Frequency).is_some();
        there.then(|| self.positive(Quantity::Frequency)).transpose()
    }

    /// The unit of the strain in the header, and the strain in it.
    pub fn strain(&self) -> Result<(Option<Unit>, f64), Located> {
        let unit = self.value(Quantity::Strain).and_then(|(column, ..)| column.unit);
        Ok((unit, self.positive(Quantity::Strain)?))
    }

    /// Storage and loss modulus in Pa.
    pub fn moduli(&self) -> Result<[f64; 2], Located> {
        let storage = self.positive(Quantity::Storage)?;
        Ok(match self.value(Quantity::Loss) {
            Some(_) => [storage, self.positive(Quantity::Loss)?],
            None => [storage, self.positive(Quantity::LossFactor)? * storage],
        })
    }

    pub fn given_shift(&self) -> Result<GivenShift, Located> {
        let temperature_c = self.temperature_c()?.unwrap_or(f64::NAN);
        let log10_shift = match self.value(Quantity::Log10Shift) {
            Some((_, _, value)) => *value,
            None => self.positive(Quantity::ShiftFactor)?.log10(),
        };
        Ok(GivenShift { temperature_c, log10_shift })
    }
}
