//! Line scans, before and after they are brought to equal spacing.

/// A line scan as an instrument gave it, converted to SI.
#[derive(Debug, Clone, PartialEq)]
pub struct RawScan {
    /// Name of the scan, unique within a run; the file stem where nothing better is known.
    pub name: String,
    /// Positions along the track in metres, same length as `heights`, not necessarily equidistant.
    pub positions: Vec<f64>,
    /// Heights in metres; NaN where the instrument gave none.
    pub heights: Vec<f64>,
}

/// A line scan on equal spacing.
#[derive(Debug, Clone, PartialEq)]
pub struct LineScan {
    /// Name of the scan (and window, after cutting), unique within a run.
    pub name: String,
    /// Position of the first point on the original track, in metres.
    pub origin: f64,
    /// Distance between neighbouring points, in metres.
    pub spacing: f64,
    /// Heights in metres; NaN where missing.
    pub heights: Vec<f64>,
}

impl LineScan {
    /// Length of the scan in metres, `n * spacing`: every point stands for one cell.
    pub fn length(&self) -> f64 {
        self.heights.len() as f64 * self.spacing
    }

    /// Share of missing points, between 0 and 1; 1 for an empty scan.
    pub fn missing_fraction(&self) -> f64 {
        if self.heights.is_empty() {
            return 1.0;
        }
        let missing = self.heights.iter().filter(|z| z.is_nan()).count();
        missing as f64 / self.heights.len() as f64
    }
}
