//! What conditioning did to a map.

use super::super::form::RemovedMapForm;
use crate::surface::faults::FaultReport;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What conditioning did to a map. Pairs are along x and y.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MapReport {
    /// Name of the map.
    pub map: String,
    /// Points in the file.
    pub points: [usize; 2],
    /// Points without a height in the file.
    pub points_missing_in_file: usize,
    /// Points outside `valid_range_mm`.
    pub points_out_of_range: usize,
    /// Points removed as spikes.
    pub spikes: usize,
    /// Rows that jumped as a whole, whether or not they were removed.
    pub jumped_rows: usize,
    /// Columns that jumped as a whole, whether or not they were removed.
    pub jumped_columns: usize,
    /// Spacing of the file in micrometres.
    pub raw_spacing_um: [f64; 2],
    /// Raw points averaged into one cell; 1 where the spacing of the file was kept.
    pub points_per_cell: [usize; 2],
    /// Spacing after resampling in micrometres.
    pub spacing_um: [f64; 2],
    /// Cells after resampling.
    pub cells: [usize; 2],
    /// Cells without a height.
    pub cells_missing: usize,
    /// Cells at the borders that fill no window.
    pub cells_left_out: usize,
    /// Slopes in mm/mm of the least-squares plane of the whole map; `None` if its points lie on one line.
    pub tilt: Option<[f64; 2]>,
    /// The faults that were looked for, in the order of the work.
    pub faults: Vec<FaultReport>,
    /// All windows, row by row.
    pub windows: Vec<MapWindowReport>,
}

impl MapReport {
    /// Position in millimetres of the centre of a cell: half a block of raw points from its border.
    pub(super) fn position_mm(&self, cell: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let first = 0.5 * (self.points_per_cell[axis] - 1) as f64 * self.raw_spacing_um[axis];
            (first + cell[axis] as f64 * self.spacing_um[axis]) / 1e3
        })
    }
}

/// What became of one window.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MapWindowReport {
    /// Name of the window, `map/000`, or of the map where it was not cut.
    pub name: String,
    /// Position of the centre of its first cell in millimetres from the first point of the file.
    pub origin_mm: [f64; 2],
    /// Share of missing cells, between 0 and 1.
    pub missing_share: f64,
    /// Why the window was rejected; `None` if it was kept.
    pub rejected: Option<String>,
    /// The form removed from the window; `None` if it was rejected.
    pub form: Option<RemovedMapForm>,
}
