//! Sections on the scans.

use super::Report;
use super::page::{absent, number, optional, percent, table};
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages;
use crate::stages::characterise::{AVERAGES, AverageRow, PARAMETERS, ParametersRow};
use crate::stages::ingest::{
    FAULTS, FaultRow, MAP_WINDOWS, MapRow, REPORT, ScanReportRow, WINDOWS, WindowRow,
};
use maud::{Markup, html};
use std::collections::BTreeSet;

const NO_SCANS: &str = "This run has no scans: its recipe states the waves itself.";

impl Report<'_> {
    pub(super) fn input(&self) -> Result<Markup, ReportError> {
        let Some(scans) = rows(self.run, REPORT)? else {
            return Ok(absent(NO_SCANS));
        };
        let faults = rows(self.run, FAULTS)?.unwrap_or_default();
        let windows = rows(self.run, WINDOWS)?.unwrap_or_default();
        let maps = rows(self.run, MAP_WINDOWS)?.unwrap_or_default();
        let found: Vec<&FaultRow> = faults.iter().filter(|fault| fault.count > 0).collect();
        let rejected: Vec<&WindowRow> = windows.iter().filter(|w| w.rejected.is_some()).collect();
        let points: u64 = scans.iter().map(|scan| scan.points_read).sum();
        Ok(html! {
            (self.warnings(&[stages::ingest::STAGE])?)
            @if scans.is_empty() {
                p { "No line scans were taken of the height maps (" code { "realise.profiles = false" } ")." }
            } @else {
                p { (scans.len()) " scans with " (points) " points came in; " (windows.len() - rejected.len())
                    " of " (windows.len()) " windows were kept." }
            }
            @if !maps.is_empty() { p { (map_sentence(&maps)) } }
            @if !scans.is_empty() { (scan_table(&scans)) }
            @if found.is_empty() {
                p { "No faults were found in the scans." }
            } @else {
                (fault_table(&found))
            }
            @if !rejected.is_empty() {
                (table("Windows that were rejected", &["window", "missing", "why"], 3,
                    rejected.iter().map(|w| vec![
                        w.window.clone(), percent(w.missing_share), w.rejected.clone().unwrap_or_default(),
                    ])))
            }
            @if maps.iter().any(|row| row.rejected.is_some()) {
                (table("Windows of maps that were rejected", &["window", "missing", "why"], 3,
                    maps.iter().filter_map(|row| {
                        Some(vec![row.window.clone(), percent(row.missing_share), row.rejected.clone()?])
                    })))
            }
        })
    }

    pub(super) fn heights(&self) -> Result<Markup, ReportError> {
        if !self.has(stages::ingest::STAGE)? {
            return Ok(absent(NO_SCANS));
        }
        let averages = rows(self.run, AVERAGES)?.unwrap_or_default();
        let parameters = rows(self.run, PARAMETERS)?.unwrap_or_default();
        Ok(html! {
            (self.figure("scans")?)
            (self.figure("heights")?)
            (self.doubt(&[stages::characterise::STAGE]))
            @if !averages.is_empty() {
                (average_table("Roughness parameters, averages over the windows", &averages))
            }
            @if !parameters.is_empty() { (parameter_table(&parameters)) }
        })
    }
}

/// Parameters of roughness as means over windows.
pub(super) fn average_table(caption: &str, rows: &[AverageRow]) -> Markup {
    table(
        caption,
        &["parameter", "mean", "± 95 %", "standard deviation", "windows"],
        1,
        rows.iter().map(|row| {
            vec![
                row.parameter.clone(),
                number(row.mean, 4),
                optional(row.confidence_95, 2),
                optional(row.standard_deviation, 2),
                row.windows.to_string(),
            ]
        }),
    )
}

/// What became of the maps: the lines of the same files are counted beside them.
fn map_sentence(windows: &[MapRow]) -> String {
    let maps: BTreeSet<&str> = windows.iter().map(|row| row.map.as_str()).collect();
    let kept = windows.iter().filter(|row| row.rejected.is_none()).count();
    let maps = if maps.len() == 1 {
        "1 height map was".into()
    } else {
        format!("{} height maps were", maps.len())
    };
    format!("{maps} read, and {kept} of {} windows kept.", windows.len())
}

fn scan_table(scans: &[ScanReportRow]) -> Markup {
    table(
        "Scans as they came in",
        &[
            "scan",
            "points",
            "missing",
            "absent",
            "out of range",
            "spikes",
            "spacing / µm",
            "largest deviation / µm",
            "spacing used / µm",
            "windows kept",
            "windows rejected",
        ],
        1,
        scans.iter().map(|scan| {
            vec![
                scan.scan.clone(),
                scan.points_read.to_string(),
                scan.points_missing.to_string(),
                scan.points_absent.to_string(),
                scan.points_out_of_range.to_string(),
                scan.spikes.to_string(),
                number(scan.raw_spacing_um, 4),
                number(scan.largest_deviation_um, 2),
                number(scan.spacing_um, 4),
                scan.windows_kept.to_string(),
                scan.windows_rejected.to_string(),
            ]
        }),
    )
}

fn fault_table(faults: &[&FaultRow]) -> Markup {
    table(
        "Faults that were found and what was done with them",
        &[
            "scan",
            "fault",
            "decision",
            "criterion",
            "count",
            "share of points",
            "rms slope before",
            "after",
            "power of the shortest waves, after over before",
        ],
        4,
        faults.iter().map(|fault| {
            vec![
                fault.scan.clone(),
                fault.fault.clone(),
                fault.decision.clone(),
                fault.criterion.clone(),
                fault.count.to_string(),
                percent(fault.share),
                optional(fault.rms_slope_before, 3),
                optional(fault.rms_slope_after, 3),
                optional(fault.high_frequency_ratio, 2),
            ]
        }),
    )
}

fn parameter_table(rows: &[ParametersRow]) -> Markup {
    table(
        "Roughness parameters of each window",
        &[
            "window",
            "Ra / mm",
            "Rq / mm",
            "Rp / mm",
            "Rv / mm",
            "Rt / mm",
            "Rsk",
            "Rku",
            "rms slope",
        ],
        1,
        rows.iter().map(|row| {
            let values = [
                row.ra_mm,
                row.rq_mm,
                row.rp_mm,
                row.rv_mm,
                row.rt_mm,
                row.rsk,
                row.rku,
                row.rms_slope,
            ];
            let mut cells = vec![row.scan.clone()];
            cells.extend(values.map(|value| number(value, 3)));
            cells
        }),
    )
}
