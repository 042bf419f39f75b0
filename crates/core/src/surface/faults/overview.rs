//! Where the faults of a scan are, in few enough points to keep and to draw.

use crate::surface::resample::Grid;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Stretches of a track in an overview; a figure has about as many columns.
const STRETCHES: usize = 800;
/// Points on either side of the largest step in its close-up.
const CLOSEUP_HALF_WIDTH: usize = 50;
/// Kind of the points that have no height in the file.
const MISSING: &str = "missing points";
/// Kind whose points are many and no step: no place for a close-up.
const END_PLATES: &str = "end plates";

/// One kind of fault and the points it was found at.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundPoints {
    /// Kind of fault, as in [`FaultReport`](super::FaultReport).
    pub fault: &'static str,
    /// Ascending indices of points of the scan on equal spacing; of a level jump the point before.
    pub points: Vec<usize>,
}

/// A stretch of the track, as measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Stretch {
    /// Middle of the stretch on the track in millimetres.
    pub position_mm: f64,
    /// Lowest height in millimetres; NaN where all are missing.
    pub lowest_mm: f64,
    /// Highest height in millimetres; NaN where all are missing.
    pub highest_mm: f64,
}

/// Points of one kind of fault, as position on the track and height in millimetres; the height of
/// missing points is NaN.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Marks {
    /// Kind of fault.
    pub fault: String,
    /// Position and height in millimetres.
    pub points: Vec<[f64; 2]>,
}

/// The surroundings of the largest step at a fault, point by point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Closeup {
    /// Position and height in millimetres, NaN where missing.
    pub points: Vec<[f64; 2]>,
    /// The faults among them.
    pub marks: Vec<Marks>,
}

/// A scan as measured and the faults on it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FaultOverview {
    /// The track in at most 800 stretches.
    pub stretches: Vec<Stretch>,
    /// The faults; of those in the same stretch the one furthest from the middle height.
    pub marks: Vec<Marks>,
    /// The largest step at a spike, a level jump or a height out of range; none without any.
    pub closeup: Option<Closeup>,
}

impl FaultOverview {
    /// Of a scan as measured, on equal spacing; none if nothing was found and nothing is missing.
    pub fn new(measured: &Grid, found: &[FoundPoints]) -> Option<Self> {
        let heights = &measured.heights;
        let missing: Vec<usize> = (0..heights.len()).filter(|&i| heights[i].is_nan()).collect();
        let missing = FoundPoints { fault: MISSING, points: missing };
        let all: Vec<&FoundPoints> =
            found.iter().chain([&missing]).filter(|kind| !kind.points.is_empty()).collect();
        if all.is_empty() {
            return None;
        }
        let points = heights.len().div_ceil(STRETCHES);
        let stretches: Vec<Stretch> = (0..heights.len())
            .step_by(points)
            .map(|start| stretch(measured, start..(start + points).min(heights.len())))
            .collect();
        let valid = heights.iter().filter(|z| !z.is_nan());
        let (lowest, highest) = valid
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &z| (low.min(z), high.max(z)));
        let middle = 0.5 * (lowest + highest);
        let thin = |kind: &&FoundPoints| {
            let distance = |i: usize| (heights[i] - middle).abs();
            let one_each = kind.points.chunk_by(|a, b| a / points == b / points);
            let furthest = one_each.filter_map(|stretch| {
                stretch.iter().copied().max_by(|&a, &b| distance(a).total_cmp(&distance(b)))
            });
            marks(measured, kind.fault, furthest)
        };
        let marks = all.iter().map(thin).collect();
        let closeup = steepest(heights, found).map(|centre| Closeup::new(measured, &all, centre));
        Some(Self { stretches, marks, closeup })
    }
}

impl Closeup {
    fn new(measured: &Grid, found: &[&FoundPoints], centre: usize) -> Self {
        let end = (centre + CLOSEUP_HALF_WIDTH + 1).min(measured.heights.len());
        let range = centre.saturating_sub(CLOSEUP_HALF_WIDTH)..end;
        let within = |kind: &&FoundPoints| {
            let points = kind.points.iter().copied().filter(|point| range.contains(point));
            marks(measured, kind.fault, points)
        };
        let marks: Vec<Marks> = found.iter().map(within).collect();
        Self {
            points: range.clone().map(|i| point(measured, i)).collect(),
            marks: marks.into_iter().filter(|kind| !kind.points.is_empty()).collect(),
        }
    }
}

fn point(grid: &Grid, i: usize) -> [f64; 2] {
    [1e3 * (grid.origin + i as f64 * grid.spacing), 1e3 * grid.heights[i]]
}

fn marks(grid: &Grid, fault: &str, points: impl Iterator<Item = usize>) -> Marks {
    Marks { fault: fault.to_owned(), points: points.map(|i| point(grid, i)).collect() }
}

fn stretch(grid: &Grid, range: Range<usize>) -> Stretch {
    let middle = 0.5 * (range.start + range.end - 1) as f64;
    let valid = || grid.heights[range.clone()].iter().copied();
    // The smaller of a number and NaN is the number.
    Stretch {
        position_mm: 1e3 * (grid.origin + middle * grid.spacing),
        lowest_mm: 1e3 * valid().fold(f64::NAN, f64::min),
        highest_mm: 1e3 * valid().fold(f64::NAN, f64::max),
    }
}

/// The faulty point with the largest step to a neighbour.
fn steepest(heights: &[f64], found: &[FoundPoints]) -> Option<usize> {
    let step = |i: usize| {
        let before = i.checked_sub(1).map_or(f64::NAN, |before| heights[i] - heights[before]);
        let after = heights.get(i + 1).map_or(f64::NAN, |after| after - heights[i]);
        before.abs().max(after.abs())
    };
    let points = found.iter().filter(|kind| kind.fault != END_PLATES);
    let steps = points.flat_map(|kind| &kind.points).map(|&i| (i, step(i)));
    let known = steps.filter(|(_, step)| !step.is_nan());
    known.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(heights: Vec<f64>) -> Grid {
        Grid { origin: 2e-3, spacing: 1e-5, heights }
    }

    #[test]
    fn a_scan_without_faults_needs_no_overview() {
        let none = FoundPoints { fault: "spikes", points: vec![] };
        assert_eq!(FaultOverview::new(&grid(vec![1.0; 10]), &[none]), None);
        assert_eq!(FaultOverview::new(&grid(vec![]), &[]), None);
    }

    #[test]
    fn the_outline_holds_all_heights_and_the_marks_the_worst_of_each_stretch() {
        let mut heights = vec![0.0; 8000];
        (heights[25], heights[27], heights[4000]) = (1e-3, 3e-3, -2e-3);
        heights[7000..7500].fill(f64::NAN);
        let spikes = FoundPoints { fault: "spikes", points: vec![25, 27, 4000] };
        let overview = FaultOverview::new(&grid(heights), &[spikes]).unwrap();
        assert_eq!(overview.stretches.len(), 800);
        assert_eq!((overview.stretches[2].lowest_mm, overview.stretches[2].highest_mm), (0.0, 3.0));
        assert!(overview.stretches[720].highest_mm.is_nan());
        approx::assert_abs_diff_eq!(overview.stretches[2].position_mm, 2.245, epsilon = 1e-12);
        assert_eq!(overview.marks[0].points.len(), 2);
        approx::assert_abs_diff_eq!(overview.marks[0].points[0][0], 2.27, epsilon = 1e-12);
        assert_eq!(overview.marks[0].points[0][1], 3.0);
        assert_eq!(
            (overview.marks[1].fault.as_str(), overview.marks[1].points.len()),
            (MISSING, 50)
        );
    }

    #[test]
    fn the_close_up_is_at_the_largest_step_that_is_no_plate() {
        let mut heights = vec![0.0; 300];
        heights[..30].fill(9e-3);
        (heights[100], heights[200], heights[203]) = (1e-3, -2e-3, f64::NAN);
        let found = [
            FoundPoints { fault: END_PLATES, points: (0..30).collect() },
            FoundPoints { fault: "spikes", points: vec![100, 200] },
        ];
        let overview = FaultOverview::new(&grid(heights), &found).unwrap();
        let closeup = overview.closeup.unwrap();
        assert_eq!(closeup.points.len(), 101);
        assert_eq!(closeup.points[50][1], -2.0);
        let kinds: Vec<_> =
            closeup.marks.iter().map(|m| (m.fault.as_str(), m.points.len())).collect();
        assert_eq!(kinds, [("spikes", 1), (MISSING, 1)]);
    }

    #[test]
    fn a_fault_at_the_very_end_and_one_between_gaps_are_no_trouble() {
        let jump = |points: Vec<usize>| [FoundPoints { fault: "level jumps", points }];
        let ends = FaultOverview::new(&grid(vec![0.0, 1e-3]), &jump(vec![0])).unwrap();
        assert_eq!(ends.closeup.unwrap().points.len(), 2);
        let lonely = grid(vec![f64::NAN, 1e-3, f64::NAN]);
        let found = [FoundPoints { fault: "out of range", points: vec![1] }];
        assert_eq!(FaultOverview::new(&lonely, &found).unwrap().closeup, None);
    }
}
