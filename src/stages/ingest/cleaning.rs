//! What was cleaned from the scans, for the people who decide on it.

use super::{FaultRow, MapRow, ScanReportRow, WindowRow};
use crate::text::markdown_text;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The report of cleaning as a document: `cleaning.md`.
pub const CLEANING_FILE: &str = "cleaning.md";

/// The report of a campaign as a Markdown document: for each scan its points, the faults that were
/// found, by which criterion, what was done with them and what that means for slope and shortest
/// waves; then the windows that were rejected. Scans with missing points and digits alone share a
/// table, those without any fault a line. `pictures` gives the file of the picture of a scan.
pub fn cleaning_markdown(
    scans: &[ScanReportRow],
    faults: &[FaultRow],
    windows: &[WindowRow],
    maps: &[MapRow],
    pictures: &BTreeMap<String, String>,
) -> String {
    let mut text = String::from("# What was cleaned\n");
    let mut by_scan: BTreeMap<&str, Vec<&FaultRow>> = BTreeMap::new();
    for fault in faults.iter().filter(|fault| fault.count > 0) {
        by_scan.entry(&fault.scan).or_default().push(fault);
    }
    let mut clean = Vec::new();
    let mut gappy = String::new();
    let mut of_maps = String::new();
    for of_map in maps.chunk_by(|a, b| a.map == b.map) {
        let found = by_scan.remove(of_map[0].map.as_str()).unwrap_or_default();
        map_section(&mut of_maps, of_map, &found);
    }
    for scan in scans {
        let found = by_scan.remove(scan.scan.as_str()).unwrap_or_default();
        // Only what can be taken away has an effect.
        if found.iter().any(|fault| fault.rms_slope_before.is_some()) {
            section(&mut text, scan, &found);
            if let Some(picture) = pictures.get(&scan.scan) {
                let _ = write!(text, "\n![{}]({picture})\n", markdown_text(&scan.scan));
            }
        } else if scan.points_missing > 0 || !found.is_empty() {
            gappy_row(&mut gappy, scan, &found, pictures);
        } else {
            clean.push(markdown_text(&scan.scan));
        }
    }
    if !gappy.is_empty() {
        text.push_str(
            "\n## Missing points and digits\n\nThese scans have no other faults.\n\n\
             | scan | points | spacing | without a height in the file | found | picture |\n\
             |---|---:|---:|---:|---|---|\n",
        );
        text.push_str(&gappy);
    }
    if !clean.is_empty() {
        let _ = write!(
            text,
            "\n## Without faults\n\n{} of {} scans: {}\n",
            clean.len(),
            scans.len(),
            clean.join(", ")
        );
    }
    let rejected: Vec<(&str, &str)> = windows
        .iter()
        .filter_map(|window| Some((window.window.as_str(), window.rejected.as_deref()?)))
        .collect();
    let _ = write!(
        text,
        "\n## Windows\n\n{} of {} kept.\n",
        windows.len() - rejected.len(),
        windows.len()
    );
    for (window, reason) in rejected {
        let _ = writeln!(text, "- {}: {reason}", markdown_text(window));
    }
    text + &of_maps
}

/// What was found in a map, and which of its windows are kept.
fn map_section(text: &mut String, windows: &[MapRow], faults: &[&FaultRow]) {
    let Some(map) = windows.first() else { return };
    let points = map.points_x * map.points_y;
    let _ = write!(
        text,
        "\n## Map {}\n\n{} by {} points, {:.2} by {:.2} µm apart; {} without a height in the file ({:.1} %).\n",
        markdown_text(&map.map),
        map.points_x,
        map.points_y,
        map.spacing_x_um,
        map.spacing_y_um,
        map.points_missing,
        100.0 * map.points_missing as f64 / points.max(1) as f64
    );
    if !faults.is_empty() {
        text.push_str(FAULT_HEAD);
        faults.iter().for_each(|fault| fault_row(text, fault));
    }
    let rejected = || windows.iter().filter_map(|w| Some((&w.window, w.rejected.as_ref()?)));
    let _ = write!(
        text,
        "\n{} of {} windows kept.\n",
        windows.len() - rejected().count(),
        windows.len()
    );
    for (window, reason) in rejected() {
        let _ = writeln!(text, "- {}: {reason}", markdown_text(window));
    }
}

/// Head of a table of faults.
const FAULT_HEAD: &str = "\n| fault | found | share | decision | rms slope with, without | shortest waves without, \
     over with | criterion |\n|---|---:|---:|---|---:|---:|---|\n";

fn fault_row(text: &mut String, fault: &FaultRow) {
    let slopes = match (fault.rms_slope_before, fault.rms_slope_after) {
        (Some(before), Some(after)) => format!("{before:.3}, {after:.3}"),
        _ => "–".into(),
    };
    let ratio =
        fault.high_frequency_ratio.map_or_else(|| "–".into(), |ratio| format!("{ratio:.3}"));
    let measure = match (fault.measure, &fault.measure_name) {
        (Some(measure), Some(name)) => format!("; {name} {measure:.4}"),
        _ => String::new(),
    };
    let _ = writeln!(
        text,
        "| {} | {} | {:.2} % | {}{measure} | {slopes} | {ratio} | {} |",
        fault.fault,
        fault.count,
        100.0 * fault.share,
        fault.decision,
        fault.criterion.replace('|', "\\|")
    );
}

fn gappy_row(
    text: &mut String,
    scan: &ScanReportRow,
    faults: &[&FaultRow],
    pictures: &BTreeMap<String, String>,
) {
    let found: Vec<String> =
        faults.iter().map(|fault| format!("{} {}", fault.count, fault.fault)).collect();
    let picture =
        pictures.get(&scan.scan).map_or_else(String::new, |file| format!("[{file}]({file})"));
    let _ = writeln!(
        text,
        "| {} | {} | {:.2} µm | {} ({:.1} %) | {} | {picture} |",
        markdown_text(&scan.scan),
        scan.points_read,
        scan.raw_spacing_um,
        scan.points_missing,
        missing_percent(scan),
        found.join(", ")
    );
}

fn missing_percent(scan: &ScanReportRow) -> f64 {
    100.0 * scan.points_missing as f64 / scan.points_read.max(1) as f64
}

fn section(text: &mut String, scan: &ScanReportRow, faults: &[&FaultRow]) {
    let missing = missing_percent(scan);
    let _ = write!(
        text,
        "\n## {}\n\n{} points, {:.2} µm apart; {} without a height in the file ({missing:.1} %).\n",
        markdown_text(&scan.scan),
        scan.points_read,
        scan.raw_spacing_um,
        scan.points_missing
    );
    text.push_str(FAULT_HEAD);
    faults.iter().for_each(|fault| fault_row(text, fault));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(name: &str, missing: u64) -> ScanReportRow {
        ScanReportRow {
            scan: name.into(),
            points_read: 1000,
            points_missing: missing,
            points_absent: 0,
            points_out_of_range: 0,
            spikes: 0,
            raw_spacing_um: 37.5,
            largest_deviation_um: 0.0,
            points_per_cell: 1,
            spacing_um: 37.5,
            windows_kept: 1,
            windows_rejected: 0,
        }
    }

    fn fault(scan: &str, fault: &str, count: u64) -> FaultRow {
        FaultRow {
            scan: scan.into(),
            fault: fault.into(),
            criterion: "a step | beyond ten".into(),
            decision: "missing".into(),
            count,
            share: 0.0125,
            measure: None,
            measure_name: None,
            rms_slope_before: Some(2.671),
            rms_slope_after: Some(1.12),
            high_frequency_ratio: Some(0.11),
        }
    }

    #[test]
    fn faults_stand_with_their_scan_and_clean_scans_share_a_line() {
        let scans = [scan("a", 49), scan("b", 0), scan("c", 0), scan("d", 7)];
        let faults = [
            fault("a", "level jumps", 119),
            fault("a", "spikes", 0),
            fault("b", "spikes", 0),
            fault("c", "tilt", 0),
            FaultRow { rms_slope_before: None, ..fault("d", "stair-steps", 5) },
        ];
        let window = |name: &str, rejected: Option<&str>| WindowRow {
            window: name.into(),
            origin_mm: 0.0,
            missing_share: 0.3,
            form_rms_mm: None,
            rejected: rejected.map(str::to_owned),
        };
        let windows = [window("a-00", None), window("a-01", Some("30 % are missing"))];
        let pictures = BTreeMap::from([("a".to_owned(), "faults_01.svg".to_owned())]);
        let text = cleaning_markdown(&scans, &faults, &windows, &[], &pictures);
        assert!(text.contains("\n![a](faults_01.svg)\n"), "{text}");
        assert!(text.contains("## a\n\n1000 points, 37.50 µm apart; 49 without"), "{text}");
        assert!(text.contains("(4.9 %)"), "{text}");
        assert!(
            text.contains(
                "| level jumps | 119 | 1.25 % | missing | 2.671, 1.120 | 0.110 | a step \\| beyond ten |"
            ),
            "{text}"
        );
        assert!(!text.contains("| spikes |"), "{text}");
        let row = "| d | 1000 | 37.50 µm | 7 (0.7 %) | 5 stair-steps |  |";
        assert!(text.contains(row), "{text}");
        assert!(text.contains("2 of 4 scans: b, c"), "{text}");
        assert!(text.contains("1 of 2 kept.\n- a-01: 30 % are missing"), "{text}");
    }
}
