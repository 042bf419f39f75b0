//! Line scans of a file: its profile, or chosen lines of its height map.

use super::error::FileProblem;
use super::{Grid, LARGEST_POINTS};
use asperity_core::surface::RawScan;

/// Which lines of a height map are taken as line scans.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum MapLines {
    /// The rows, along x.
    Rows,
    /// The columns, along y.
    Columns,
}

/// Takes the heights of a file row after row and keeps those of the chosen lines alone.
pub(super) struct LineCollector<'a> {
    name: &'a str,
    grid: Grid,
    lines: MapLines,
    step: usize,
    /// Place of the next height, from 0.
    at: usize,
    /// The profile, the row that is being read, or the chosen columns.
    kept: Vec<Vec<f64>>,
}

impl<'a> LineCollector<'a> {
    /// # Errors
    /// [`FileProblem::TooManyLines`] if the chosen lines have more points than a file may have.
    pub(super) fn new(
        name: &'a str,
        grid: Grid,
        lines: MapLines,
        step: usize,
    ) -> Result<Self, FileProblem> {
        let step = step.max(1);
        let mut kept = vec![Vec::new()];
        if let Grid::Map { columns, rows, .. } = grid {
            let (count, length) = match lines {
                MapLines::Rows => (rows, columns),
                MapLines::Columns => (columns, rows),
            };
            let points = count.div_ceil(step) as u64 * length as u64;
            if points > LARGEST_POINTS {
                let enough = (count as u64 * length as u64).div_ceil(LARGEST_POINTS);
                return Err(FileProblem::TooManyLines { points, step, enough });
            }
            if lines == MapLines::Columns {
                kept = vec![Vec::new(); count.div_ceil(step)];
            }
        }
        Ok(Self { name, grid, lines, step, at: 0, kept })
    }

    /// Takes the next heights; every line that is complete goes to `each`.
    pub(super) fn take<E>(
        &mut self,
        mut heights: &[f64],
        each: &mut dyn FnMut(RawScan) -> Result<(), E>,
    ) -> Result<(), E> {
        let Grid::Map { columns, spacing_x, .. } = self.grid else {
            self.kept[0].extend_from_slice(heights);
            return Ok(());
        };
        while !heights.is_empty() {
            let (row, column) = (self.at / columns, self.at % columns);
            let (part, rest) = heights.split_at(heights.len().min(columns - column));
            self.at += part.len();
            heights = rest;
            match self.lines {
                MapLines::Rows if row % self.step == 0 => {
                    self.kept[0].extend_from_slice(part);
                    if column + part.len() == columns {
                        let row = std::mem::take(&mut self.kept[0]);
                        self.give(("row", self.at / columns - 1), spacing_x, row, each)?;
                    }
                }
                MapLines::Rows => {}
                MapLines::Columns => {
                    let first = column.next_multiple_of(self.step);
                    for place in (first..column + part.len()).step_by(self.step) {
                        self.kept[place / self.step].push(part[place - column]);
                    }
                }
            }
        }
        Ok(())
    }

    /// Gives the lines that are complete at the end of the file alone.
    pub(super) fn finish<E>(
        mut self,
        each: &mut dyn FnMut(RawScan) -> Result<(), E>,
    ) -> Result<(), E> {
        let kept = std::mem::take(&mut self.kept);
        match (self.grid, self.lines) {
            (Grid::Profile { spacing }, _) => kept
                .into_iter()
                .try_for_each(|heights| each(line(self.name.to_owned(), spacing, heights))),
            (Grid::Map { .. }, MapLines::Rows) => Ok(()),
            (Grid::Map { spacing_y, .. }, MapLines::Columns) => {
                kept.into_iter().enumerate().try_for_each(|(place, heights)| {
                    self.give(("column", place * self.step), spacing_y, heights, each)
                })
            }
        }
    }

    /// Gives a line of a map unless it is without any height.
    fn give<E>(
        &self,
        (word, number): (&str, usize),
        spacing: f64,
        heights: Vec<f64>,
        each: &mut dyn FnMut(RawScan) -> Result<(), E>,
    ) -> Result<(), E> {
        if heights.iter().all(|height| height.is_nan()) {
            return Ok(());
        }
        each(line(format!("{}_{word}_{number:04}", self.name), spacing, heights))
    }
}

fn line(name: String, spacing: f64, heights: Vec<f64>) -> RawScan {
    let positions = (0..heights.len()).map(|i| i as f64 * spacing).collect();
    RawScan { name, positions, heights }
}
