//! From a scan as measured to windows on equal spacing, without faults and form.

use super::faults::{FarHeights, FaultOverview, FaultReport, RepeatedPositions};
use super::form::{Form, FormError, LARGEST_ORDER, RemovedForm, remove_form};
use super::resample::{Grid, GridError, block_means, place_on_grid, points_per_cell};
use super::window::{window_name, windows};
use super::{LineScan, RawScan};
use crate::error_kind::{ErrorKind, HasKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

mod faults;

/// How to condition a scan, in the order of the work: faults, resampling, windows, form.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Conditioning {
    /// Lowest and highest height about the median of the scan in millimetres; heights outside are
    /// missing. All heights count by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valid_range_mm: Option<[f64; 2]>,
    /// A height that deviates from the median of its neighbourhood by more than this many robust
    /// standard deviations is a spike and missing; 0 keeps all. Six by default: on road scans
    /// some 1e-4 of the points, on normal noise practically none.
    pub spike_threshold: f64,
    /// Level jumps, walls or bridged drop-outs: `"keep"`, or `"missing"`, the points next to them.
    /// They are counted either way.
    pub level_jumps: Handling,
    /// A step between neighbours beyond this many robust standard deviations of the steps around
    /// it is a level jump; 0 looks for none.
    pub jump_threshold: f64,
    /// Points on either side of a level jump that become missing. Pairs of points up to twice this
    /// apart then span no jump.
    pub jump_margin_points: usize,
    /// Runs at the ends that are no road: `"keep"` or `"cut"`. They are counted either way.
    pub end_plates: EndPlates,
    /// Interquartile ranges between the levels of the road and a plate; 0 looks for none.
    pub end_plate_threshold: f64,
    /// Points at the position of the one before: `"mean"`, take the mean of their heights, or
    /// `"refuse"` the scan.
    pub repeated_positions: RepeatedPositions,
    /// Lateral resolution of the instrument in micrometres, the width of its light spot. Not set:
    /// the spacing of the file is kept.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lateral_resolution_um: Option<f64>,
    /// Points per lateral resolution after resampling; two resolve what the spot resolves.
    pub samples_per_resolution: f64,
    /// Length of a window in millimetres. Not set: the scan is one window.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_length_mm: Option<f64>,
    /// Largest share of missing points in a window, between 0 and 1.
    pub max_missing: f64,
    /// The form to remove: `"mean"`, `"slope"` or `{ polynomial = 3 }`.
    pub form: Form,
    /// What the form is fitted to and removed from: each window or the scan as a whole.
    pub form_extent: FormExtent,
}

impl Default for Conditioning {
    fn default() -> Self {
        Self {
            valid_range_mm: None,
            spike_threshold: 6.0,
            level_jumps: Handling::Keep,
            jump_threshold: 10.0,
            jump_margin_points: 1,
            end_plates: EndPlates::Keep,
            end_plate_threshold: 3.0,
            repeated_positions: RepeatedPositions::Mean,
            lateral_resolution_um: None,
            samples_per_resolution: 2.0,
            window_length_mm: None,
            max_missing: 0.1,
            form: Form::Slope,
            form_extent: FormExtent::Window,
        }
    }
}

/// What to do with points at a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Handling {
    /// Leave them.
    Keep,
    /// Make them missing.
    Missing,
}

/// What to do with end plates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum EndPlates {
    /// Leave them.
    Keep,
    /// Shorten the scan by them.
    Cut,
}

/// What a form is fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum FormExtent {
    /// Each window by itself.
    Window,
    /// The whole scan, before it is cut.
    Scan,
}

/// What conditioning did to a scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConditioningReport {
    /// Name of the scan.
    pub scan: String,
    /// Points in the file.
    pub points_read: usize,
    /// Points without a height in the file.
    pub points_missing_in_file: usize,
    /// Points that the spacing asks for and the file does not have.
    pub points_absent: usize,
    /// Points nearer to the cell of another point than to a free one; averaged with it.
    pub points_sharing_a_cell: usize,
    /// Spacing of the file in micrometres, from a least-squares line through its positions.
    pub raw_spacing_um: f64,
    /// Largest distance of a position from equal spacing in micrometres.
    pub largest_deviation_um: f64,
    /// Points outside `valid_range_mm`.
    pub points_out_of_range: usize,
    /// Points removed as spikes.
    pub spikes: usize,
    /// Raw points averaged into one cell; 1 where the spacing of the file was kept.
    pub points_per_cell: usize,
    /// Spacing after resampling in micrometres.
    pub spacing_um: f64,
    /// Cells after resampling.
    pub cells: usize,
    /// Cells without a height.
    pub cells_missing: usize,
    /// Cells at the two ends that fill no window.
    pub cells_left_out: usize,
    /// The form removed from the scan as a whole, where the recipe asks for that.
    pub form: Option<RemovedForm>,
    /// The faults that were looked for, in the order of the work.
    pub faults: Vec<FaultReport>,
    /// Where they are; none for a scan without any.
    pub overview: Option<FaultOverview>,
    /// Heights of the windows that are kept which no road has; none for most scans.
    pub far: Option<FarHeights>,
    /// All windows in the order of the track.
    pub windows: Vec<WindowReport>,
}

/// What became of one window.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WindowReport {
    /// Name of the window, `scan/000`, or of the scan where it was not cut.
    pub name: String,
    /// Position of its first cell on the track in millimetres.
    pub origin_mm: f64,
    /// Share of missing cells, between 0 and 1.
    pub missing_share: f64,
    /// Why the window was rejected; none for a window that was kept.
    pub rejected: Option<String>,
    /// The form removed from the window, where the recipe asks for that.
    pub form: Option<RemovedForm>,
}

/// A scan that cannot be conditioned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConditioningError {
    /// A value of the recipe is out of its range.
    #[error("{key} is {value}; {demand}")]
    Parameter {
        /// The parameter.
        key: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        demand: &'static str,
    },
    /// Points at the position of the one before, where such scans are refused.
    #[error(
        "scan {scan}: {count} points are at the position of the point before, the first at {position_mm} mm"
    )]
    Repeated {
        /// Name of the scan.
        scan: String,
        /// How many points.
        count: usize,
        /// Position of the first in mm.
        position_mm: f64,
    },
    /// The positions make no grid.
    #[error("scan {scan}: {source}")]
    Grid {
        /// Name of the scan.
        scan: String,
        /// Why.
        source: GridError,
    },
    /// The scan is shorter than one window.
    #[error("scan {scan}: {length_mm} mm long, shorter than one window of {window_mm} mm")]
    TooShort {
        /// Name of the scan.
        scan: String,
        /// Length of the track in mm.
        length_mm: f64,
        /// Length of a window in mm.
        window_mm: f64,
    },
    /// Too few heights are left for the form of the whole scan.
    #[error("scan {scan}: {source}")]
    Form {
        /// Name of the scan.
        scan: String,
        /// Why.
        source: FormError,
    },
    /// No window was kept.
    #[error("scan {scan}: none of {windows} windows is left; the first: {reason}")]
    NothingLeft {
        /// Name of the scan.
        scan: String,
        /// Number of windows.
        windows: usize,
        /// Why the first was rejected.
        reason: String,
    },
}

impl HasKind for ConditioningError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Parameter { .. }
            | Self::Repeated { .. }
            | Self::Grid { .. }
            | Self::TooShort { .. }
            | Self::Form { .. }
            | Self::NothingLeft { .. } => ErrorKind::Input,
        }
    }
}

impl Conditioning {
    /// Checks the ranges of all values.
    ///
    /// # Errors
    /// [`ConditioningError::Parameter`] for the first that is out of its range.
    pub fn validate(&self) -> Result<(), ConditioningError> {
        let check = |key, value: f64, holds: bool, demand| {
            if holds { Ok(()) } else { Err(ConditioningError::Parameter { key, value, demand }) }
        };
        let positive = |key, value: f64| {
            check(key, value, value > 0.0 && value.is_finite(), "it must be positive")
        };
        if let Some([lowest, highest]) = self.valid_range_mm {
            let demand = "the range is [lowest, highest], and its ends are swapped or the same: give the lowest height first";
            // NaN is reported below.
            let swapped = lowest >= highest;
            check("valid_range_mm", lowest, !swapped, demand)?;
            let demand = "the range [lowest, highest] must hold the median, 0";
            check("valid_range_mm", lowest, lowest < 0.0, demand)?;
            check("valid_range_mm", highest, highest > 0.0, demand)?;
        }
        let threshold = self.spike_threshold;
        check("spike_threshold", threshold, threshold >= 0.0, "it must be 0 (off) or positive")?;
        let threshold = self.jump_threshold;
        check("jump_threshold", threshold, threshold >= 0.0, "it must be 0 (off) or positive")?;
        let margin = self.jump_margin_points;
        check("jump_margin_points", margin as f64, margin >= 1, "it must be 1 or more")?;
        let threshold = self.end_plate_threshold;
        let demand = "it must be 0 (off) or positive";
        check("end_plate_threshold", threshold, threshold >= 0.0, demand)?;
        self.lateral_resolution_um.map_or(Ok(()), |um| positive("lateral_resolution_um", um))?;
        positive("samples_per_resolution", self.samples_per_resolution)?;
        self.window_length_mm.map_or(Ok(()), |mm| positive("window_length_mm", mm))?;
        let share = self.max_missing;
        check("max_missing", share, (0.0..1.0).contains(&share), "it must be in [0, 1)")?;
        let order = self.form.order();
        check("form.polynomial", order as f64, order <= LARGEST_ORDER, "it must be 12 or less")
    }
}

/// Conditions one scan: puts it on equal spacing, removes faults, averages down to the resolution
/// of the instrument, cuts windows and removes their form. Returns the windows that are kept.
///
/// Cost and memory are linear in the number of points.
///
/// # Errors
/// [`ConditioningError`] for a parameter out of range, positions that make no grid, and when no
/// window is left.
pub fn condition(
    scan: &RawScan,
    conditioning: &Conditioning,
) -> Result<(Vec<LineScan>, ConditioningReport), ConditioningError> {
    conditioning.validate()?;
    let name = || scan.name.clone();
    let (merged, mut found) = faults::sampling(scan, conditioning)?;
    let (mut raw, fit) = place_on_grid(&merged)
        .map_err(|source| ConditioningError::Grid { scan: name(), source })?;
    let findings = faults::heights(&mut raw, conditioning);
    found.extend(findings.reports);

    let points = conditioning.lateral_resolution_um.map_or(1, |um| {
        points_per_cell(raw.spacing, um / 1e6 / conditioning.samples_per_resolution)
    });
    let mut grid = block_means(&raw, points);
    let is_far = FarHeights::cells(&grid.heights);
    let form = match conditioning.form_extent {
        FormExtent::Window => None,
        FormExtent::Scan => Some(
            remove(&mut grid.heights, conditioning.form)
                .map_err(|source| ConditioningError::Form { scan: name(), source })?,
        ),
    };
    let mut report = ConditioningReport {
        scan: name(),
        points_read: scan.heights.len(),
        points_missing_in_file: count_missing(&scan.heights),
        points_absent: fit.empty_cells,
        points_sharing_a_cell: fit.points_sharing,
        raw_spacing_um: raw.spacing * 1e6,
        largest_deviation_um: fit.largest_deviation * 1e6,
        points_out_of_range: findings.out_of_range,
        spikes: findings.spikes,
        points_per_cell: points,
        spacing_um: grid.spacing * 1e6,
        cells: grid.heights.len(),
        cells_missing: count_missing(&grid.heights),
        cells_left_out: 0,
        form,
        faults: found,
        overview: findings.overview,
        far: None,
        windows: Vec::new(),
    };
    let kept = cut(&grid, conditioning, &mut report)?;
    // The cell that a window starts with, by the position it was given.
    let start = |window: &LineScan| ((window.origin - grid.origin) / grid.spacing).round() as usize;
    let ranges = kept.iter().map(|window| start(window)..start(window) + window.heights.len());
    report.far = FarHeights::new(&grid, ranges.flatten().filter(|&cell| is_far[cell]));
    Ok((kept, report))
}

/// Cuts the windows, removes their form and reports on each.
fn cut(
    grid: &Grid,
    conditioning: &Conditioning,
    report: &mut ConditioningReport,
) -> Result<Vec<LineScan>, ConditioningError> {
    let total = grid.heights.len();
    // A window of an integer number of cells must not lose one to round-off.
    let points = conditioning.window_length_mm.map_or(total, |window_mm| {
        (window_mm / 1e3 / grid.spacing * (1.0 + 1e-9)).floor() as usize
    });
    let ranges = windows(total, points);
    if ranges.is_empty() {
        let length_mm = total as f64 * grid.spacing * 1e3;
        let window_mm = conditioning.window_length_mm.unwrap_or(length_mm);
        return Err(ConditioningError::TooShort {
            scan: report.scan.clone(),
            length_mm,
            window_mm,
        });
    }
    report.cells_left_out = total - ranges.len() * points;
    let mut kept = Vec::new();
    for (index, range) in ranges.into_iter().enumerate() {
        let name = match conditioning.window_length_mm {
            Some(_) => window_name(&report.scan, index),
            None => report.scan.clone(),
        };
        let origin = grid.origin + range.start as f64 * grid.spacing;
        let heights = grid.heights[range].to_vec();
        let mut window = LineScan { name, origin, spacing: grid.spacing, heights };
        let (form, rejected) = match finish(&mut window, conditioning) {
            Ok(form) => (form, None),
            Err(reason) => (None, Some(reason)),
        };
        report.windows.push(WindowReport {
            name: window.name.clone(),
            origin_mm: origin * 1e3,
            missing_share: window.missing_fraction(),
            rejected,
            form,
        });
        if report.windows[index].rejected.is_none() {
            kept.push(window);
        }
    }
    if kept.is_empty() {
        return Err(ConditioningError::NothingLeft {
            scan: report.scan.clone(),
            windows: report.windows.len(),
            reason: report.windows[0].rejected.clone().unwrap_or_default(),
        });
    }
    Ok(kept)
}

/// Removes the form of a window, or says why the window is rejected.
fn finish(
    window: &mut LineScan,
    conditioning: &Conditioning,
) -> Result<Option<RemovedForm>, String> {
    let missing = window.missing_fraction();
    if missing > conditioning.max_missing {
        return Err(format!(
            "{:.1} % of the points are missing, the limit is {:.1} % (max_missing)",
            100.0 * missing,
            100.0 * conditioning.max_missing
        ));
    }
    match conditioning.form_extent {
        FormExtent::Scan => Ok(None),
        FormExtent::Window => remove(&mut window.heights, conditioning.form)
            .map(Some)
            .map_err(|error| error.to_string()),
    }
}

/// Removes a form; heights that are nothing else have none left, not the round-off of its fit.
fn remove(heights: &mut [f64], form: Form) -> Result<RemovedForm, FormError> {
    /// Share of the largest height that a fit of up to twelfth order leaves of it.
    const ROUND_OFF: f64 = 1e-12;
    // `f64::max` passes over NaN.
    let largest = |z: &[f64]| z.iter().fold(0.0_f64, |most, z| most.max(z.abs()));
    let before = largest(heights);
    let removed = remove_form(heights, form)?;
    if largest(heights) <= ROUND_OFF * before {
        heights.iter_mut().filter(|z| !z.is_nan()).for_each(|z| *z = 0.0);
    }
    Ok(removed)
}

fn count_missing(heights: &[f64]) -> usize {
    heights.iter().filter(|height| height.is_nan()).count()
}

#[cfg(test)]
mod tests;
