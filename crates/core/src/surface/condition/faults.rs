//! Detection and removal of the faults of one scan, in order.

use super::{Conditioning, ConditioningError, EndPlates, Handling};
use crate::numerics::statistics::least_squares_line;
use crate::surface::RawScan;
use crate::surface::faults::{
    FaultOverview, FaultReport, FoundPoints, RepeatedPositions, Texture, end_plates, find_jumps,
    merge_repeated, position_jitter, quantisation, remove_jumps, remove_out_of_range,
    remove_spikes,
};
use crate::surface::resample::Grid;

/// Merges repeated positions or refuses a scan that has some, and reports how evenly the track was sampled.
pub(super) fn sampling(
    scan: &RawScan,
    conditioning: &Conditioning,
) -> Result<(RawScan, Vec<FaultReport>), ConditioningError> {
    let points = scan.heights.len().max(1) as f64;
    let first = scan.positions.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0]);
    let (merged, repeated) = merge_repeated(scan);
    let decision = match (conditioning.repeated_positions, first) {
        (RepeatedPositions::Mean, _) => "averaged",
        (RepeatedPositions::Refuse, None) => "refused",
        (RepeatedPositions::Refuse, Some(position)) => {
            return Err(ConditioningError::Repeated {
                scan: scan.name.clone(),
                count: repeated,
                position_mm: position * 1e3,
            });
        }
    };
    let scan = merged;
    let jitter = position_jitter(&scan.positions);
    let criterion = "position equal to that of the point before".into();
    let share = repeated as f64 / points;
    let repeated = FaultReport::new("repeated positions", criterion, decision, repeated, share);
    let criterion = "coefficient of variation of the steps below 1.5 mean steps".into();
    let jitter = FaultReport::new("jitter", criterion, "reported", 0, 0.0)
        .measuring("coefficient of variation", jitter);
    Ok((scan, vec![repeated, jitter]))
}

/// What became of the heights of a scan.
pub(super) struct Findings {
    pub reports: Vec<FaultReport>,
    pub out_of_range: usize,
    pub spikes: usize,
    pub overview: Option<FaultOverview>,
}

/// Removes the faults that are to be removed from a scan on equal spacing, and reports all.
pub(super) fn heights(grid: &mut Grid, conditioning: &Conditioning) -> Findings {
    let measured = grid.clone();
    let mut work =
        Inspection { grid, conditioning, reports: Vec::new(), found: Vec::new(), cut: 0 };
    work.stairs();
    work.plates();
    let out_of_range = work.out_of_range();
    let spikes = work.spikes();
    work.jumps();
    work.tilt();
    let Inspection { reports, found, .. } = work;
    Findings { reports, out_of_range, spikes, overview: FaultOverview::new(&measured, &found) }
}

/// A scan while its faults are looked for.
struct Inspection<'a> {
    grid: &'a mut Grid,
    conditioning: &'a Conditioning,
    reports: Vec<FaultReport>,
    found: Vec<FoundPoints>,
    /// Points cut off at the start.
    cut: usize,
}

impl Inspection<'_> {
    fn stairs(&mut self) {
        let found = quantisation(&self.grid.heights);
        let count = (found.equal_share * self.grid.heights.len() as f64).round() as usize;
        let criterion = "equal neighbouring heights".into();
        let report =
            FaultReport::new("stair-steps", criterion, "reported", count, found.equal_share);
        self.reports.push(report.measuring("height resolution [um]", found.step * 1e6));
    }

    fn plates(&mut self) {
        let threshold = self.conditioning.end_plate_threshold;
        let [start, end] = match threshold > 0.0 {
            true => end_plates(&self.grid.heights, threshold),
            false => [0, 0],
        };
        let total = self.grid.heights.len();
        let road = start..total - end.min(total - start);
        let rest = self.grid.heights[road.clone()].to_vec();
        let (before, after) = (self.texture(), Texture::new(&rest, self.grid.spacing));
        let cut = self.conditioning.end_plates == EndPlates::Cut;
        let criterion = format!(
            "runs at the ends with a level {threshold} interquartile ranges outside the quartiles, \
             or flat (end_plate_threshold)"
        );
        let share = (start + end) as f64 / total.max(1) as f64;
        let decision = if cut { "cut" } else { "kept" };
        let report = FaultReport::new("end plates", criterion, decision, start + end, share);
        self.reports.push(report.with_effect(before, after));
        self.mark("end plates", (0..total).filter(|point| !road.contains(point)).collect());
        if cut {
            self.cut = start;
            self.grid.origin += start as f64 * self.grid.spacing;
            self.grid.heights = rest;
        }
    }

    fn out_of_range(&mut self) -> usize {
        let Some([lowest, highest]) = self.conditioning.valid_range_mm else { return 0 };
        let criterion = format!("{lowest} to {highest} mm about the median (valid_range_mm)");
        self.remove("out of range", criterion, |heights| {
            remove_out_of_range(heights, [lowest / 1e3, highest / 1e3])
        })
    }

    fn spikes(&mut self) -> usize {
        let threshold = self.conditioning.spike_threshold;
        if threshold <= 0.0 {
            return 0;
        }
        let criterion = format!(
            "{threshold} robust standard deviations from the median of seven points \
             (spike_threshold)"
        );
        self.remove("spikes", criterion, |heights| remove_spikes(heights, threshold))
    }

    /// Removes the points that a detector finds, and returns their number.
    fn remove(
        &mut self,
        fault: &'static str,
        criterion: String,
        detector: impl FnOnce(&mut [f64]) -> Vec<usize>,
    ) -> usize {
        let before = self.texture();
        let points = detector(&mut self.grid.heights);
        let count = points.len();
        let after = if count == 0 { before } else { self.texture() };
        let report = FaultReport::new(fault, criterion, "missing", count, self.share(count));
        self.reports.push(report.with_effect(before, after));
        self.mark(fault, points);
        count
    }

    fn jumps(&mut self) {
        let threshold = self.conditioning.jump_threshold;
        if threshold <= 0.0 {
            return;
        }
        let jumps = find_jumps(&self.grid.heights, threshold);
        let before = self.texture();
        let (mut after, mut removed) = (before, 0);
        if !jumps.is_empty() {
            let mut heights = self.grid.heights.clone();
            removed = remove_jumps(&mut heights, &jumps, self.conditioning.jump_margin_points);
            after = Texture::new(&heights, self.grid.spacing);
            if self.conditioning.level_jumps == Handling::Missing {
                self.grid.heights = heights;
            }
        }
        let decision = match self.conditioning.level_jumps {
            Handling::Keep => "kept",
            Handling::Missing => "missing",
        };
        let criterion = format!(
            "a step beyond {threshold} robust standard deviations of the steps around it \
             (jump_threshold)"
        );
        let share = self.share(removed);
        let report = FaultReport::new("level jumps", criterion, decision, jumps.len(), share);
        self.reports.push(report.with_effect(before, after));
        self.mark("level jumps", jumps);
    }

    /// The tilt of the scan; none where fewer than two heights are left.
    fn tilt(&mut self) {
        let valid = || self.grid.heights.iter().enumerate().filter(|(_, height)| !height.is_nan());
        let places = valid().map(|(i, _)| i as f64);
        let (_, step) = least_squares_line(places, valid().map(|(_, &height)| height));
        let slope = step / self.grid.spacing;
        if slope.is_finite() {
            let criterion = "least-squares line; removed as `form` says".into();
            let report = FaultReport::new("tilt", criterion, "reported", 0, 0.0);
            self.reports.push(report.measuring("slope [1]", slope));
        }
    }

    fn texture(&self) -> Texture {
        Texture::new(&self.grid.heights, self.grid.spacing)
    }

    fn share(&self, count: usize) -> f64 {
        count as f64 / self.grid.heights.len().max(1) as f64
    }

    /// Remembers where faults are, as places in the scan before anything was cut.
    fn mark(&mut self, fault: &'static str, mut points: Vec<usize>) {
        points.iter_mut().for_each(|point| *point += self.cut);
        self.found.push(FoundPoints { fault, points });
    }
}
