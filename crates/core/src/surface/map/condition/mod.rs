//! From a map as measured to windows without faults and form.

use super::HeightMap;
use super::form::{FormOfMap, LARGEST_DEGREE, MapFormError, RemovedMapForm, remove_form, tilt};
use crate::error_kind::{ErrorKind, HasKind};
use crate::surface::condition::Handling;
use crate::surface::resample::points_per_cell;
use crate::surface::window::{window_name, windows};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

mod blocks;
mod faults;
mod report;

pub use report::{MapReport, MapWindowReport};

/// How to condition a map, in the order of the work: faults, resampling, windows, form.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MapConditioning {
    /// Lowest and highest height about the median of the map in millimetres; heights outside are missing. All heights
    /// count by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valid_range_mm: Option<[f64; 2]>,
    /// A height is a spike and missing if it deviates by more than this many robust standard deviations from the median of
    /// the 5 x 5 points around it, and from that of seven points along x, y and both diagonals; 0 keeps all.
    pub spike_threshold: f64,
    /// Rows and columns that jumped as a whole, as line-by-line instruments make them: `"keep"`, or `"missing"`, all
    /// their points. They are counted either way.
    pub level_jumps: Handling,
    /// The median step between two rows (columns) is a jump if it deviates by more than this many robust standard
    /// deviations from the usual one; 0 looks for none.
    pub jump_threshold: f64,
    /// Lateral resolution of the instrument in micrometres. Not set: the spacing of the file is kept.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lateral_resolution_um: Option<f64>,
    /// Points per lateral resolution after resampling, along either axis; two resolve what the instrument resolves.
    pub samples_per_resolution: f64,
    /// Lengths of a window along x and y in millimetres. Not set: the map is one window.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_length_mm: Option<[f64; 2]>,
    /// Largest share of missing points in a window, between 0 and 1.
    pub max_missing: f64,
    /// The form to remove from each window: `"mean"`, `"plane"` or `{ polynomial = 3 }`, the total degree, at most 8.
    pub form: FormOfMap,
}

impl Default for MapConditioning {
    fn default() -> Self {
        Self {
            valid_range_mm: None,
            spike_threshold: 6.0,
            level_jumps: Handling::Keep,
            jump_threshold: 10.0,
            lateral_resolution_um: None,
            samples_per_resolution: 2.0,
            window_length_mm: None,
            max_missing: 0.1,
            form: FormOfMap::Plane,
        }
    }
}

/// A map that cannot be conditioned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapConditioningError {
    /// A value of the recipe is out of its range.
    #[error("{key} is {value}; {require}")]
    Parameter {
        /// The parameter.
        key: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        require: &'static str,
    },
    /// The number of heights is not that of the points, or there are none.
    #[error("map {map} has {heights} heights for {columns} x {rows} points")]
    Points {
        /// Name of the map.
        map: String,
        /// Number of heights.
        heights: usize,
        /// Points along x.
        columns: usize,
        /// Points along y.
        rows: usize,
    },
    /// A spacing is not positive.
    #[error("map {map}: the spacing along {axis} is {spacing_um} um; it must be positive")]
    Spacing {
        /// Name of the map.
        map: String,
        /// `x` or `y`.
        axis: char,
        /// The spacing in um.
        spacing_um: f64,
    },
    /// A height is infinite.
    #[error("map {map}: the height at column {column}, row {row} is infinite")]
    Infinite {
        /// Name of the map.
        map: String,
        /// Column, from 0.
        column: usize,
        /// Row, from 0.
        row: usize,
    },
    /// The map is smaller than one window or one cell.
    #[error(
        "map {map} is {length_mm:.3} mm long along {axis}, shorter than one {part} of {part_mm:.3} mm ({key})"
    )]
    TooSmall {
        /// Name of the map.
        map: String,
        /// `x` or `y`.
        axis: char,
        /// Length of the map along it in mm.
        length_mm: f64,
        /// `window` or `cell`.
        part: &'static str,
        /// Its length in mm.
        part_mm: f64,
        /// The parameter that sets it.
        key: &'static str,
    },
    /// No window was kept.
    #[error("map {map}: none of {windows} windows is kept; the first: {reason}")]
    NothingLeft {
        /// Name of the map.
        map: String,
        /// Number of windows.
        windows: usize,
        /// Why the first was rejected.
        reason: String,
    },
}

impl HasKind for MapConditioningError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Parameter { .. }
            | Self::Points { .. }
            | Self::Spacing { .. }
            | Self::Infinite { .. }
            | Self::TooSmall { .. }
            | Self::NothingLeft { .. } => ErrorKind::Input,
        }
    }
}

impl MapConditioning {
    /// Checks the ranges of all values.
    ///
    /// # Errors
    /// [`MapConditioningError::Parameter`] for the first that is out of its range.
    pub fn validate(&self) -> Result<(), MapConditioningError> {
        let check = |key, value: f64, holds: bool, require| {
            if holds {
                Ok(())
            } else {
                Err(MapConditioningError::Parameter { key, value, require })
            }
        };
        let positive = |key, value: f64| {
            check(key, value, value > 0.0 && value.is_finite(), "it must be positive")
        };
        if let Some([lowest, highest]) = self.valid_range_mm {
            let require = "the range is [lowest, highest], and its ends are swapped or the same: give the lowest height first";
            // NaN is reported below.
            let swapped = lowest >= highest;
            check("valid_range_mm", lowest, !swapped, require)?;
            let require = "the range [lowest, highest] must hold the median, 0";
            check("valid_range_mm", lowest, lowest < 0.0, require)?;
            check("valid_range_mm", highest, highest > 0.0, require)?;
        }
        let thresholds =
            [("spike_threshold", self.spike_threshold), ("jump_threshold", self.jump_threshold)];
        for (key, threshold) in thresholds {
            check(key, threshold, threshold >= 0.0, "it must be 0 (off) or positive")?;
        }
        self.lateral_resolution_um.map_or(Ok(()), |um| positive("lateral_resolution_um", um))?;
        positive("samples_per_resolution", self.samples_per_resolution)?;
        for length in self.window_length_mm.into_iter().flatten() {
            positive("window_length_mm", length)?;
        }
        let share = self.max_missing;
        check("max_missing", share, (0.0..1.0).contains(&share), "it must be in [0, 1)")?;
        let degree = self.form.degree();
        check("form.polynomial", degree as f64, degree <= LARGEST_DEGREE, "it must be 8 or less")
    }
}

/// Conditions one map: removes faults, averages down to the resolution of the instrument, cuts windows and removes their
/// form. Returns the windows that are kept, row by row.
///
/// Cost and memory are linear in the number of points.
///
/// # Errors
/// [`MapConditioningError`] for a parameter out of range, a map that is none, and when no window is left.
pub fn condition_map(
    map: &HeightMap,
    conditioning: &MapConditioning,
) -> Result<(Vec<HeightMap>, MapReport), MapConditioningError> {
    conditioning.validate()?;
    check_map(map)?;
    let mut cleaned = map.clone();
    let findings = faults::find(&mut cleaned, conditioning);
    let cell = conditioning.lateral_resolution_um.map_or([1, 1], |um| {
        let target = um / 1e6 / conditioning.samples_per_resolution;
        map.spacing.map(|spacing| points_per_cell(spacing, target))
    });
    let cells = blocks::block_means(cleaned, cell);
    if cells.heights.is_empty() {
        let axis = usize::from(cells.points[0] > 0);
        let length_mm = cell[axis] as f64 * map.spacing[axis] * 1e3;
        return Err(too_small(map, axis, ("cell", length_mm, "lateral_resolution_um")));
    }
    let mut report = MapReport {
        map: map.name.clone(),
        points: map.points,
        points_missing_in_file: map.missing(),
        points_out_of_range: findings.out_of_range,
        spikes: findings.spikes,
        jumped_rows: findings.jumped_rows,
        jumped_columns: findings.jumped_columns,
        raw_spacing_um: map.spacing.map(|spacing| spacing * 1e6),
        points_per_cell: cell,
        spacing_um: cells.spacing.map(|spacing| spacing * 1e6),
        cells: cells.points,
        cells_missing: cells.missing(),
        cells_left_out: 0,
        tilt: findings.tilt,
        faults: findings.reports,
        windows: Vec::new(),
    };
    let kept = cut(&cells, conditioning, &mut report)?;
    Ok((kept, report))
}

fn check_map(map: &HeightMap) -> Result<(), MapConditioningError> {
    let [columns, rows] = map.points;
    let name = || map.name.clone();
    let heights = map.heights.len();
    if heights == 0 || columns.checked_mul(rows) != Some(heights) {
        return Err(MapConditioningError::Points { map: name(), heights, columns, rows });
    }
    for (axis, spacing) in ['x', 'y'].into_iter().zip(map.spacing) {
        if !(spacing > 0.0 && spacing.is_finite()) {
            let spacing_um = spacing * 1e6;
            return Err(MapConditioningError::Spacing { map: name(), axis, spacing_um });
        }
    }
    match map.heights.iter().position(|z| z.is_infinite()) {
        Some(k) => Err(MapConditioningError::Infinite {
            map: name(),
            column: k % columns,
            row: k / columns,
        }),
        None => Ok(()),
    }
}

fn too_small(
    map: &HeightMap,
    axis: usize,
    (part, part_mm, key): (&'static str, f64, &'static str),
) -> MapConditioningError {
    let length_mm = map.lengths()[axis] * 1e3;
    let (map, axis) = (map.name.clone(), ['x', 'y'][axis]);
    MapConditioningError::TooSmall { map, axis, length_mm, part, part_mm, key }
}

/// Cuts the windows, removes their form and reports on each.
fn cut(
    map: &HeightMap,
    conditioning: &MapConditioning,
    report: &mut MapReport,
) -> Result<Vec<HeightMap>, MapConditioningError> {
    let points = conditioning.window_length_mm.map_or(map.points, |window_mm| {
        // A window of an integer number of cells must not lose one to round-off.
        [0, 1]
            .map(|axis| (window_mm[axis] / 1e3 / map.spacing[axis] * (1.0 + 1e-9)).floor() as usize)
    });
    let ranges = [0, 1].map(|axis| windows(map.points[axis], points[axis]));
    if let Some(axis) = ranges.iter().position(Vec::is_empty) {
        let length_mm = conditioning.window_length_mm.map_or(0.0, |window_mm| window_mm[axis]);
        return Err(too_small(map, axis, ("window", length_mm, "window_length_mm")));
    }
    let [columns, rows] = &ranges;
    report.cells_left_out = map.heights.len() - columns.len() * rows.len() * points[0] * points[1];
    let mut kept = Vec::new();
    let places = rows.iter().flat_map(|rows| columns.iter().map(move |columns| [columns, rows]));
    for (index, [columns, rows]) in places.enumerate() {
        let heights = rows
            .clone()
            .flat_map(|j| &map.heights[j * map.points[0]..][columns.clone()])
            .copied()
            .collect();
        let name = match conditioning.window_length_mm {
            Some(_) => window_name(&map.name, index),
            None => map.name.clone(),
        };
        let mut window = HeightMap { name, points, spacing: map.spacing, heights };
        let missing_share = window.missing() as f64 / window.heights.len() as f64;
        let (form, rejected) = match finish(&mut window, missing_share, conditioning) {
            Ok(form) => (Some(form), None),
            Err(reason) => (None, Some(reason)),
        };
        report.windows.push(MapWindowReport {
            name: window.name.clone(),
            origin_mm: report.position_mm([columns.start, rows.start]),
            missing_share,
            rejected: rejected.clone(),
            form,
        });
        if rejected.is_none() {
            kept.push(window);
        }
    }
    if kept.is_empty() {
        return Err(MapConditioningError::NothingLeft {
            map: report.map.clone(),
            windows: report.windows.len(),
            reason: report.windows[0].rejected.clone().unwrap_or_default(),
        });
    }
    Ok(kept)
}

/// Removes the form of a window, or says why the window is rejected.
fn finish(
    window: &mut HeightMap,
    missing: f64,
    conditioning: &MapConditioning,
) -> Result<RemovedMapForm, String> {
    if missing > conditioning.max_missing {
        return Err(format!(
            "{:.1} % of the points are missing, the limit is {:.1} % (max_missing)",
            100.0 * missing,
            100.0 * conditioning.max_missing
        ));
    }
    remove(window, conditioning.form).map_err(|error| error.to_string())
}

/// Removes a form; heights that are nothing else become 0, not the round-off of its fit.
fn remove(map: &mut HeightMap, form: FormOfMap) -> Result<RemovedMapForm, MapFormError> {
    /// Share of the largest height that a fit leaves of a form.
    const ROUND_OFF: f64 = 1e-12;
    // `f64::max` passes over NaN.
    let largest = |map: &HeightMap| map.heights.iter().fold(0.0_f64, |most, z| most.max(z.abs()));
    let before = largest(map);
    let removed = remove_form(map, form)?;
    if largest(map) <= ROUND_OFF * before {
        map.heights.iter_mut().filter(|z| !z.is_nan()).for_each(|z| *z = 0.0);
    }
    Ok(removed)
}

#[cfg(test)]
mod tests;
