//! What a user is told of the scans.

use super::{Conditioned, Ingest, ReadFile, ScanFile};
use crate::surface::ConditioningReport;

/// Where the description does not fit the files.
pub(super) fn of_description(
    ingest: &Ingest,
    files: &[ScanFile],
    read: &[ReadFile<Conditioned>],
) -> Vec<String> {
    let mut warnings = Vec::new();
    if ingest.text.is_some() && read.iter().all(|file| !file.is_text) {
        warnings.push(
            "[ingest.text] describes no scan and does nothing: all files are those of \
             instruments, which state their own units and layout; heights that grow away from \
             the rubber are turned by ingest.invert_instrument_heights = true"
                .to_owned(),
        );
    }
    if ingest.invert_instrument_heights && read.iter().all(|file| file.is_text) {
        warnings.push(
            "ingest.invert_instrument_heights does nothing: no scan is the file of an \
             instrument; texts are turned by ingest.text.invert_z = true"
                .to_owned(),
        );
    }
    let contradicted: Vec<_> =
        files.iter().zip(read).filter(|(_, read)| !read.contradictions.is_empty()).collect();
    if let Some((file, read)) = contradicted.first() {
        warnings.push(format!(
            "units of {} of {} files: in the first, {}, {} (ingest.text); the description counts, \
             change it if the file is right",
            contradicted.len(),
            files.len(),
            file.name,
            read.contradictions.join(", and ")
        ));
    }
    warnings
}

/// What the scans themselves give reason for.
pub(super) fn of_scans(reports: &[&ConditioningReport]) -> Vec<String> {
    [rejected(reports), jumps(reports), far(reports)].into_iter().flatten().collect()
}

fn rejected(reports: &[&ConditioningReport]) -> Option<String> {
    let windows = reports.iter().flat_map(|report| &report.windows);
    let total = windows.clone().count();
    let rejected: Vec<_> = windows.filter(|window| window.rejected.is_some()).collect();
    let first = rejected.first()?;
    let reason = first.rejected.as_deref().unwrap_or_default();
    Some(format!(
        "{} of {total} windows were rejected, the first, {}, because {reason}",
        rejected.len(),
        first.name
    ))
}

/// Says so where level jumps that were kept make most of the shortest waves of a scan.
fn jumps(reports: &[&ConditioningReport]) -> Option<String> {
    let decided_by_jumps = |report: &&&ConditioningReport| {
        report.faults.iter().any(|fault| {
            fault.fault == "level jumps"
                && fault.decision == "kept"
                && fault.high_frequency_ratio.is_some_and(|ratio| ratio < 0.5)
        })
    };
    let concerned: Vec<_> = reports.iter().filter(decided_by_jumps).collect();
    let first = concerned.first()?;
    Some(format!(
        "level jumps make more than half of the shortest waves of {} of {} scans, the first {}; \
         look at ingest/faults.arrow, consider ingest.conditioning.level_jumps = \"missing\"",
        concerned.len(),
        reports.len(),
        first.scan
    ))
}

/// Says so where heights are left that no road has.
fn far(reports: &[&ConditioningReport]) -> Option<String> {
    let far: Vec<_> = reports.iter().filter_map(|report| Some((report, report.far?))).collect();
    let (first, heights) = far.first()?;
    Some(format!(
        "{} of {} scans keep heights more than ten interquartile ranges outside their quartiles; the \
         first, {}, {} between {:.1} and {:.1} mm: a reference plate or a mark of missing points? \
         look at ingest/cleaning.md, consider ingest.text.cut_start_mm and cut_end_mm, \
         ingest.conditioning.valid_range_mm or ingest.text.missing",
        far.len(),
        reports.len(),
        first.scan,
        heights.count,
        heights.first_mm,
        heights.last_mm
    ))
}
