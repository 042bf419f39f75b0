//! Instrument files, which state their own units.

use asperity::units::Units;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::cli::output::{aligned, significant};
use asperity::scans::file::{Grid, OpenScan, Statistics};

/// An instrument file, summarised.
#[derive(Debug, Serialize)]
pub(super) struct InstrumentFile {
    #[serde(with = "asperity::files::name::path")]
    path: PathBuf,
    format: String,
    /// How the format was recognised.
    detected: String,
    /// Of a profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<u64>,
    /// Rows and columns of a map.
    #[serde(skip_serializing_if = "Option::is_none")]
    shape: Option<[usize; 2]>,
    /// Along the profile, or along the rows of a map.
    spacing_m: f64,
    /// Between the rows of a map.
    #[serde(skip_serializing_if = "Option::is_none")]
    spacing_y_m: Option<f64>,
    mean_m: f64,
    /// Of the population of valid points.
    std_m: f64,
    missing: u64,
    instrument: BTreeMap<String, String>,
}

impl InstrumentFile {
    pub(super) fn of(path: &Path, scan: &OpenScan<'_>, statistics: &Statistics) -> Self {
        let (points, shape, spacing_m, spacing_y_m) = match scan.grid {
            Grid::Profile { spacing } => (Some(statistics.points()), None, spacing, None),
            Grid::Map { columns, rows, spacing_x, spacing_y } => {
                (None, Some([rows, columns]), spacing_x, Some(spacing_y))
            }
        };
        Self {
            path: path.to_path_buf(),
            format: scan.format.clone(),
            detected: scan.detected.clone(),
            points,
            shape,
            spacing_m,
            spacing_y_m,
            mean_m: statistics.mean(),
            std_m: statistics.standard_deviation(),
            missing: statistics.missing(),
            instrument: scan.instrument.iter().cloned().collect(),
        }
    }

    pub(super) fn text(&self) -> String {
        let (shape, points) = match (self.points, self.shape) {
            (_, Some([rows, columns])) => {
                (format!("height map, {rows} rows of {columns} points"), (rows * columns) as u64)
            }
            (points, None) => {
                let points = points.unwrap_or_default();
                (format!("profile of {points} points"), points)
            }
        };
        let share = 100.0 * self.missing as f64 / points as f64;
        let um = |metres: f64| significant(metres.m_to_um()) + " um";
        let spacing = match self.spacing_y_m {
            Some(y) => format!("{} along the rows, {} between them", um(self.spacing_m), um(y)),
            None => um(self.spacing_m),
        };
        let instrument: Vec<String> =
            self.instrument.iter().map(|(name, value)| format!("{name}: {value}")).collect();
        aligned(&[
            ("file", self.path.display().to_string()),
            ("format", self.format.clone()),
            ("detected", self.detected.clone()),
            ("shape", format!("{shape}, {} missing ({share:.1} %)", self.missing)),
            ("spacing", spacing),
            ("mean of z", um(self.mean_m)),
            ("rms of z", um(self.std_m) + " about the mean, form not removed"),
            ("instrument", instrument.join("\n")),
        ])
    }
}
