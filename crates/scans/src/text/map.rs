//! Height maps as text of one point per line: x, y and z.

use super::{Points, check_range};
use crate::description::LengthUnit::M;
use crate::file::{Grid, LARGEST_POINTS, ScanFile};
use crate::lattice::Lattice;
use crate::{ScanProblem, TextFormat};

/// Places of a grid for each point of the file, at most.
const MOST_PLACES: usize = 4;
/// Spacings of a map in m, as those of line scans.
const SPACINGS_M: std::ops::RangeInclusive<f64> = 1e-9..=1e-2;

/// The points on their grid: rows along x, from the lowest y to the highest; NaN where the file has
/// no point or no height.
pub(super) fn on_grid(points: Points, format: &TextFormat) -> Result<ScanFile, ScanProblem> {
    let problem = |problem: String| ScanProblem::Grid { problem };
    let Points { positions: x, across: y, heights: z } = points;
    let lattice = Lattice::of(&x, &y).map_err(problem)?;
    let Lattice { columns, rows, .. } = lattice;
    let places = columns.saturating_mul(rows);
    if places > MOST_PLACES * z.len() || places as u64 > LARGEST_POINTS {
        return Err(problem(format!(
            "{} points are on a grid of {rows} rows of {columns}, most of which is empty; check `x_column` and \
             `y_column`, or export the map on an equal grid",
            z.len()
        )));
    }
    // `validate` has seen that the units are there.
    let unit = |unit: Option<_>| unit.unwrap_or(M);
    let spacing_x = plausible(unit(format.x_unit).metres(lattice.step_x), "x_unit")?;
    let spacing_y = plausible(unit(format.y_unit).metres(lattice.step_y), "y_unit")?;
    let sign = if format.invert_z { -1.0 } else { 1.0 };
    let mut heights = vec![f64::NAN; places];
    let mut taken = vec![false; places];
    for ((x, y), z) in x.iter().zip(&y).zip(&z) {
        let (column, row) = lattice.place(*x, *y);
        let place = row * columns + column;
        if std::mem::replace(&mut taken[place], true) {
            return Err(problem(format!(
                "two points are at x = {x}, y = {y} (in the unit of the file); delete one of them"
            )));
        }
        heights[place] = sign * unit(format.z_unit).metres(*z);
    }
    check_range(&heights)?;
    if heights.iter().all(|height| height.is_nan()) {
        return Err(ScanProblem::AllMissing { points: z.len() });
    }
    Ok(ScanFile {
        format: "text".into(),
        detected: format!("a description with y_column: {} points on a grid", z.len()),
        grid: Grid::Map { columns, rows, spacing_x, spacing_y },
        heights,
        instrument: Vec::new(),
    })
}

/// A spacing in m, unless only a mistake in the `key` explains it.
pub(super) fn plausible(spacing: f64, key: &'static str) -> Result<f64, ScanProblem> {
    if SPACINGS_M.contains(&spacing) {
        return Ok(spacing);
    }
    Err(ScanProblem::AbsurdSpacing { spacing_mm: spacing * 1e3, key })
}
