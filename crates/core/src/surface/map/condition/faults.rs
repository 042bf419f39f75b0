//! Detection and removal of the faults of one map, in order.

use super::super::HeightMap;
use super::super::faults::{
    LONGEST_RUN, find_jumped_columns, find_jumped_rows, map_quantisation, map_texture,
    remove_spikes,
};
use super::{Handling, MapConditioning, tilt};
use crate::surface::faults::{FaultReport, remove_out_of_range};

/// What became of the heights of a map.
pub(super) struct Findings {
    pub reports: Vec<FaultReport>,
    pub out_of_range: usize,
    pub spikes: usize,
    pub jumped_rows: usize,
    pub jumped_columns: usize,
    pub tilt: Option<[f64; 2]>,
}

/// Removes the faults that are to be removed from a map, and reports all.
pub(super) fn find(map: &mut HeightMap, conditioning: &MapConditioning) -> Findings {
    let mut work = Inspection { map, conditioning, reports: Vec::new() };
    work.stairs();
    let out_of_range = work.out_of_range();
    let spikes = work.spikes();
    let [jumped_rows, jumped_columns] = work.jumps();
    let tilt = work.tilt();
    Findings { reports: work.reports, out_of_range, spikes, jumped_rows, jumped_columns, tilt }
}

/// A map while its faults are looked for.
struct Inspection<'a> {
    map: &'a mut HeightMap,
    conditioning: &'a MapConditioning,
    reports: Vec<FaultReport>,
}

impl Inspection<'_> {
    fn stairs(&mut self) {
        let found = map_quantisation(self.map);
        let count = (found.equal_share * self.map.heights.len() as f64).round() as usize;
        let criterion = "equal neighbouring heights along x".into();
        let report =
            FaultReport::new("stair-steps", criterion, "reported", count, found.equal_share);
        self.reports.push(report.measuring("height resolution [um]", found.step * 1e6));
    }

    fn out_of_range(&mut self) -> usize {
        let Some([lowest, highest]) = self.conditioning.valid_range_mm else { return 0 };
        let criterion = format!("{lowest} to {highest} mm about the median (valid_range_mm)");
        self.remove("out of range", criterion, |map| {
            remove_out_of_range(&mut map.heights, [lowest / 1e3, highest / 1e3])
        })
    }

    fn spikes(&mut self) -> usize {
        let threshold = self.conditioning.spike_threshold;
        if threshold <= 0.0 {
            return 0;
        }
        let criterion = format!(
            "{threshold} robust standard deviations from the median of 5 x 5 points, and of seven along \
             each of four lines (spike_threshold)"
        );
        self.remove("spikes", criterion, |map| remove_spikes(map, threshold))
    }

    /// Removes the points that a detector finds, and returns their number.
    fn remove(
        &mut self,
        fault: &str,
        criterion: String,
        detector: impl FnOnce(&mut HeightMap) -> Vec<usize>,
    ) -> usize {
        let before = map_texture(self.map);
        let count = detector(self.map).len();
        let after = if count == 0 { before } else { map_texture(self.map) };
        let share = self.share(count);
        let report = FaultReport::new(fault, criterion, "missing", count, share);
        self.reports.push(report.with_effect(before, after));
        count
    }

    /// Jumped rows and columns; both are looked for before either is removed.
    fn jumps(&mut self) -> [usize; 2] {
        let threshold = self.conditioning.jump_threshold;
        if threshold <= 0.0 {
            return [0, 0];
        }
        let rows = find_jumped_rows(self.map, threshold);
        let columns = find_jumped_columns(self.map, threshold);
        let counts = [rows.len(), columns.len()];
        let [nx, _] = self.map.points;
        self.jumped("row jumps", "rows", rows, |k| k / nx);
        self.jumped("column jumps", "columns", columns, |k| k % nx);
        counts
    }

    fn jumped(
        &mut self,
        fault: &str,
        lines: &str,
        jumped: Vec<usize>,
        line_of: impl Fn(usize) -> usize,
    ) {
        let threshold = self.conditioning.jump_threshold;
        let criterion = format!(
            "{lines} between median steps beyond {threshold} robust standard deviations of those of all \
             {lines}, up to {LONGEST_RUN} neighbouring ones, or at a step that stays (jump_threshold)"
        );
        let before = map_texture(self.map);
        let (mut after, mut removed) = (before, 0);
        if !jumped.is_empty() {
            let mut has_jumped = vec![false; self.map.points[0].max(self.map.points[1])];
            jumped.iter().for_each(|&line| has_jumped[line] = true);
            let mut map = self.map.clone();
            for (k, height) in map.heights.iter_mut().enumerate() {
                if !height.is_nan() && has_jumped[line_of(k)] {
                    *height = f64::NAN;
                    removed += 1;
                }
            }
            after = map_texture(&map);
            if self.conditioning.level_jumps == Handling::Missing {
                *self.map = map;
            }
        }
        let decision = match self.conditioning.level_jumps {
            Handling::Keep => "kept",
            Handling::Missing => "missing",
        };
        let share = self.share(removed);
        let report = FaultReport::new(fault, criterion, decision, jumped.len(), share);
        self.reports.push(report.with_effect(before, after));
    }

    /// The tilt of the map; `None` if its heights lie on one line.
    fn tilt(&mut self) -> Option<[f64; 2]> {
        let slopes = tilt(self.map)?;
        let criterion = "least-squares plane; removed as `form` says".into();
        let report = FaultReport::new("tilt", criterion, "reported", 0, 0.0);
        self.reports.push(report.measuring("steepest slope [1]", slopes[0].hypot(slopes[1])));
        Some(slopes)
    }

    fn share(&self, count: usize) -> f64 {
        count as f64 / self.map.heights.len().max(1) as f64
    }
}
