//! The faults of one scan, found, judged and removed in their order.

use super::{Conditioning, EndPlates, Handling};
use crate::surface::RawScan;
use crate::surface::faults::{
    FaultReport, RepeatedPositions, Texture, end_plates, find_jumps, merge_repeated,
    position_jitter, quantisation, remove_jumps, remove_out_of_range, remove_spikes,
};
use crate::surface::form::{Form, remove_form};
use crate::surface::resample::Grid;

/// Merges repeated positions where that is asked for, and judges how the track was sampled.
pub(super) fn sampling(scan: &RawScan, conditioning: &Conditioning) -> (RawScan, Vec<FaultReport>) {
    let points = scan.heights.len().max(1) as f64;
    let (merged, repeated) = merge_repeated(scan);
    let (scan, decision) = match conditioning.repeated_positions {
        RepeatedPositions::Mean => (merged, "averaged"),
        RepeatedPositions::Refuse => (scan.clone(), "refused"),
    };
    let jitter = position_jitter(&scan.positions);
    let criterion = "position equal to that of the point before".into();
    let share = repeated as f64 / points;
    let repeated = FaultReport::new("repeated positions", criterion, decision, repeated, share);
    let criterion = "coefficient of variation of the steps below 1.5 mean steps".into();
    let jitter = FaultReport::new("jitter", criterion, "reported", 0, 0.0)
        .measuring("coefficient of variation", jitter);
    (scan, vec![repeated, jitter])
}

/// Numbers of points that the older keys took away.
pub(super) struct Removed {
    pub out_of_range: usize,
    pub spikes: usize,
}

/// Removes the faults that the recipe wants removed from a scan on equal spacing, and reports all.
pub(super) fn heights(
    grid: &mut Grid,
    conditioning: &Conditioning,
    reports: &mut Vec<FaultReport>,
) -> Removed {
    reports.push(stairs(grid));
    plates(grid, conditioning, reports);
    let out_of_range = out_of_range(grid, conditioning, reports);
    let spikes = spikes(grid, conditioning, reports);
    jumps(grid, conditioning, reports);
    reports.extend(tilt(grid));
    Removed { out_of_range, spikes }
}

fn stairs(grid: &Grid) -> FaultReport {
    let found = quantisation(&grid.heights);
    let count = (found.equal_share * grid.heights.len() as f64).round() as usize;
    let criterion = "equal neighbouring heights".into();
    FaultReport::new("stair-steps", criterion, "reported", count, found.equal_share)
        .measuring("height resolution [um]", found.step * 1e6)
}

fn plates(grid: &mut Grid, conditioning: &Conditioning, reports: &mut Vec<FaultReport>) {
    let threshold = conditioning.end_plate_threshold;
    let [start, end] = match threshold > 0.0 {
        true => end_plates(&grid.heights, threshold),
        false => [0, 0],
    };
    let total = grid.heights.len();
    let rest = grid.heights[start..total - end.min(total - start)].to_vec();
    let (before, after) = (texture(grid), Texture::of(&rest, grid.spacing));
    let cut = conditioning.end_plates == EndPlates::Cut;
    let criterion = format!(
        "runs at the ends with a level {threshold} interquartile ranges outside the quartiles, or \
         flat (end_plate_threshold)"
    );
    let share = (start + end) as f64 / total.max(1) as f64;
    let decision = if cut { "cut" } else { "kept" };
    let report = FaultReport::new("end plates", criterion, decision, start + end, share);
    reports.push(report.with_effect(before, after));
    if cut {
        grid.origin += start as f64 * grid.spacing;
        grid.heights = rest;
    }
}

fn out_of_range(
    grid: &mut Grid,
    conditioning: &Conditioning,
    reports: &mut Vec<FaultReport>,
) -> usize {
    let Some([lowest, highest]) = conditioning.valid_range_mm else { return 0 };
    let before = texture(grid);
    let count = remove_out_of_range(&mut grid.heights, [lowest / 1e3, highest / 1e3]);
    let criterion = format!("{lowest} to {highest} mm about the median (valid_range_mm)");
    let report = FaultReport::new("out of range", criterion, "missing", count, share(count, grid));
    reports.push(report.with_effect(before, texture(grid)));
    count
}

fn spikes(grid: &mut Grid, conditioning: &Conditioning, reports: &mut Vec<FaultReport>) -> usize {
    let threshold = conditioning.spike_threshold;
    if threshold <= 0.0 {
        return 0;
    }
    let before = texture(grid);
    let count = remove_spikes(&mut grid.heights, threshold);
    let criterion = format!(
        "{threshold} robust standard deviations from the median of seven points (spike_threshold)"
    );
    let report = FaultReport::new("spikes", criterion, "missing", count, share(count, grid));
    reports.push(report.with_effect(before, texture(grid)));
    count
}

fn jumps(grid: &mut Grid, conditioning: &Conditioning, reports: &mut Vec<FaultReport>) {
    let threshold = conditioning.jump_threshold;
    if threshold <= 0.0 {
        return;
    }
    let before = texture(grid);
    let found = find_jumps(&grid.heights, threshold);
    let mut heights = grid.heights.clone();
    let removed = remove_jumps(&mut heights, &found, conditioning.jump_margin_points);
    let after = Texture::of(&heights, grid.spacing);
    let decision = match conditioning.level_jumps {
        Handling::Keep => "kept",
        Handling::Missing => "missing",
    };
    let criterion = format!(
        "a step beyond {threshold} robust standard deviations of the steps around it \
         (jump_threshold)"
    );
    let report =
        FaultReport::new("level jumps", criterion, decision, found.len(), share(removed, grid));
    reports.push(report.with_effect(before, after));
    if conditioning.level_jumps == Handling::Missing {
        grid.heights = heights;
    }
}

/// The tilt of the scan; none where fewer than two heights are left.
fn tilt(grid: &Grid) -> Option<FaultReport> {
    let removed = remove_form(&mut grid.heights.clone(), Form::Slope).ok()?;
    let track_mm = (grid.heights.len() - 1) as f64 * grid.spacing * 1e3;
    let slope = 2.0 * removed.legendre_coefficients_mm[1] / track_mm;
    let criterion = "least-squares line; removed as `form` says".into();
    let report = FaultReport::new("tilt", criterion, "reported", 0, 0.0);
    slope.is_finite().then(|| report.measuring("slope [1]", slope))
}

fn texture(grid: &Grid) -> Texture {
    Texture::of(&grid.heights, grid.spacing)
}

fn share(count: usize, grid: &Grid) -> f64 {
    count as f64 / grid.heights.len().max(1) as f64
}
