//! The tables of the stage.

use super::{FAULTS, MAP_WINDOWS, MAPS};
use crate::artifact::{
    ArrayFile, ArraysSchema, AttributeSchema, DatasetSchema, ResultFile, Row, SchemaVersion, Table,
};
use crate::surface::ConditioningReport;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Windows of equal spacing: `scans.h5`, one dataset each, heights in m, NaN where missing.
pub const SCANS: ArrayFile = ArrayFile {
    file: ResultFile { stage: "ingest", name: "scans.h5" },
    schema: "asperity.ingest.scans",
    version: 1,
    description: "line scans on equal spacing, form removed; NaN where a height is missing",
};
/// What conditioning did to each scan file: `report.arrow`.
pub const REPORT: Table<ScanReportRow> = Table::new("ingest", "report.arrow");
/// What became of each window: `windows.arrow`.
pub const WINDOWS: Table<WindowRow> = Table::new("ingest", "windows.arrow");

/// What conditioning did to one scan file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScanReportRow {
    /// Name of the scan, from its file.
    pub scan: String,
    /// Points in the file.
    pub points_read: u64,
    /// Points without a height in the file.
    pub points_missing: u64,
    /// Points that the spacing asks for and the file does not have.
    pub points_absent: u64,
    /// Points outside the valid range.
    pub points_out_of_range: u64,
    /// Points removed as spikes.
    pub spikes: u64,
    /// Spacing in the file.
    #[schemars(extend("unit" = "um"))]
    pub raw_spacing_um: f64,
    /// Largest distance of a position from equal spacing.
    #[schemars(extend("unit" = "um"))]
    pub largest_deviation_um: f64,
    /// Raw points averaged into one.
    pub points_per_cell: u64,
    /// Spacing after resampling.
    #[schemars(extend("unit" = "um"))]
    pub spacing_um: f64,
    /// Windows kept.
    pub windows_kept: u64,
    /// Windows rejected.
    pub windows_rejected: u64,
}

impl Row for ScanReportRow {
    const SCHEMA: &'static str = "asperity.ingest.report";
    const VERSION: u32 = 1;
}

/// What became of one window of a scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WindowRow {
    /// Name of the window.
    pub window: String,
    /// Position of its first point on the track.
    #[schemars(extend("unit" = "mm"))]
    pub origin_mm: f64,
    /// Share of missing points.
    #[schemars(extend("unit" = "1"))]
    pub missing_share: f64,
    /// Root mean square of the form removed; absent for rejected windows.
    #[schemars(extend("unit" = "mm"))]
    pub form_rms_mm: Option<f64>,
    /// Why the window was rejected; absent for one that was kept.
    pub rejected: Option<String>,
}

impl Row for WindowRow {
    const SCHEMA: &'static str = "asperity.ingest.windows";
    const VERSION: u32 = 1;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![
        SCANS.schema(),
        REPORT.schema(),
        FAULTS.schema(),
        WINDOWS.schema(),
        MAPS.schema(),
        MAP_WINDOWS.schema(),
    ]
}

/// What [`SCANS`] holds.
pub fn scans_schema() -> ArraysSchema {
    let attribute = |name, kind, description| AttributeSchema { name, kind, description };
    ArraysSchema {
        schema: SCANS.schema,
        version: SCANS.version,
        description: SCANS.description,
        datasets: vec![DatasetSchema {
            path: "{window}",
            unit: "m",
            description: "heights of a window, growing towards the rubber; the name is that of the \
                          scan file, followed by a slash and a number where it was cut",
            attributes: vec![
                attribute("spacing_m", "f64", "distance between neighbouring points"),
                attribute("origin_m", "f64", "position of the first point on the track"),
                attribute("missing_fraction", "f64", "share of the points without a height"),
                attribute("source", "string", "name of the scan file without its extension"),
                attribute("source_digest", "string", "BLAKE3 digest of the scan file"),
            ],
        }],
    }
}

pub(super) fn report_row(report: &ConditioningReport) -> ScanReportRow {
    let rejected = report.windows.iter().filter(|w| w.rejected.is_some()).count();
    ScanReportRow {
        scan: report.scan.clone(),
        points_read: report.points_read as u64,
        points_missing: report.points_missing_in_file as u64,
        points_absent: report.points_absent as u64,
        points_out_of_range: report.points_out_of_range as u64,
        spikes: report.spikes as u64,
        raw_spacing_um: report.raw_spacing_um,
        largest_deviation_um: report.largest_deviation_um,
        points_per_cell: report.points_per_cell as u64,
        spacing_um: report.spacing_um,
        windows_kept: (report.windows.len() - rejected) as u64,
        windows_rejected: rejected as u64,
    }
}

pub(super) fn window_rows(report: &ConditioningReport) -> Vec<WindowRow> {
    let row = |window: &crate::surface::condition::WindowReport| WindowRow {
        window: window.name.clone(),
        origin_mm: window.origin_mm,
        missing_share: window.missing_share,
        form_rms_mm: window.form.as_ref().map(|form| form.rms_mm),
        rejected: window.rejected.clone(),
    };
    report.windows.iter().map(row).collect()
}
