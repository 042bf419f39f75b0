//! The table of the faults of the scans.

use crate::artifact::{Row, Table};
use crate::surface::faults::FaultReport;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What was found wrong in each scan and what it meant: `faults.arrow`.
pub const FAULTS: Table<FaultRow> = Table::new("ingest", "faults.arrow");

/// One kind of fault in one scan, at the spacing of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FaultRow {
    /// Name of the scan.
    pub scan: String,
    /// Kind of fault.
    pub fault: String,
    /// Criterion of its detector, with the key that holds its number.
    pub criterion: String,
    /// What was done: kept, missing, cut, averaged, refused, reported.
    pub decision: String,
    /// How often it was found.
    pub count: u64,
    /// Share of the points that it concerns.
    #[schemars(extend("unit" = "1"))]
    pub share: f64,
    /// What was measured besides, named in `measure_name`.
    #[schemars(extend("unit" = "see measure_name"))]
    pub measure: Option<f64>,
    /// Name and unit of the measure.
    pub measure_name: Option<String>,
    /// Root mean square slope before the fault is removed.
    #[schemars(extend("unit" = "1"))]
    pub rms_slope_before: Option<f64>,
    /// And after, also where it was decided to keep the fault.
    #[schemars(extend("unit" = "1"))]
    pub rms_slope_after: Option<f64>,
    /// Mean square of second differences, after over before: the ratio of the power spectral
    /// density weighted by 16 sin^4(q dx / 2), that is at the highest wavenumbers.
    #[schemars(extend("unit" = "1"))]
    pub high_frequency_ratio: Option<f64>,
}

impl Row for FaultRow {
    const SCHEMA: &'static str = "asperity.ingest.faults";
    const VERSION: u32 = 1;
}

/// The faults of a scan or map.
pub(super) fn fault_rows(scan: &str, faults: &[FaultReport]) -> Vec<FaultRow> {
    let row = |fault: &FaultReport| FaultRow {
        scan: scan.to_owned(),
        fault: fault.fault.clone(),
        criterion: fault.criterion.clone(),
        decision: fault.decision.clone(),
        count: fault.count as u64,
        share: fault.share,
        measure: fault.measure,
        measure_name: fault.measure_name.clone(),
        rms_slope_before: fault.rms_slope_before,
        rms_slope_after: fault.rms_slope_after,
        high_frequency_ratio: fault.high_frequency_ratio,
    };
    faults.iter().map(row).collect()
}
