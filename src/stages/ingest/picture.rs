//! Pictures of the faults of a scan, in SVG.

use crate::artifact::Pending;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Points, Series};
use crate::stages::StageError;
use crate::surface::ConditioningReport;
use crate::surface::faults::{Closeup, FaultOverview, Marks};
use std::collections::BTreeMap;

/// Writes the pictures of the scans that have faults, `most` at most, and returns the file of each
/// by the name of its scan.
pub(super) fn write_pictures(
    reports: &[&ConditioningReport],
    most: usize,
    pending: &mut Pending,
) -> Result<BTreeMap<String, String>, StageError> {
    let mut worst: Vec<_> = reports
        .iter()
        .filter_map(|report| Some((smallest_rest(report), report, fault_figure(report)?)))
        .collect();
    // Stable: scans that are alike keep their order.
    worst.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut pictures = BTreeMap::new();
    for (number, (_, report, figure)) in worst.into_iter().take(most).enumerate() {
        let file = format!("faults_{:02}.svg", number + 1);
        pending.write_document(&file, &figure.svg()?)?;
        pictures.insert(report.scan.clone(), file);
    }
    Ok(pictures)
}

/// What is left of the shortest waves without the fault that makes most of them.
fn smallest_rest(report: &ConditioningReport) -> f64 {
    report.faults.iter().filter_map(|fault| fault.high_frequency_ratio).fold(1.0, f64::min)
}

/// A scan as measured with its faults, and the surroundings of the largest step among them. `None` if
/// the scan has no faults.
pub fn fault_figure(report: &ConditioningReport) -> Option<Figure> {
    let overview = report.overview.as_ref()?;
    let kinds: Vec<&str> = overview.marks.iter().map(|marks| marks.fault.as_str()).collect();
    let mut caption =
        "The scan as measured, with circles at its faults and ticks at missing points".to_owned();
    let mut panels = vec![whole_scan(report, overview, &kinds)];
    if let Some(closeup) = &overview.closeup {
        caption += ", and the points around the largest step at a fault";
        panels.push(largest_step(closeup, &kinds));
    }
    Some(Figure { caption: caption + ".", panels })
}

fn whole_scan(report: &ConditioningReport, overview: &FaultOverview, kinds: &[&str]) -> Panel {
    // From the lowest to the highest of each stretch and back; stretches without heights are gaps.
    let outline = overview.stretches.iter().flat_map(|stretch| {
        [stretch.lowest_mm, stretch.highest_mm].map(|height| (stretch.position_mm, height))
    });
    let mut series = vec![Series::unnamed(Colour::Grey, Mark::Line(outline.collect()))];
    for marks in &overview.marks {
        let label = Some(name(report, &marks.fault));
        series.extend(faults(marks, kinds, label));
    }
    panel(format!("{}: the scan as measured", report.scan), series)
}

fn largest_step(closeup: &Closeup, kinds: &[&str]) -> Panel {
    let points: Points = closeup.points.iter().map(|&[x, z]| (x, z)).collect();
    let mut series = vec![
        Series::unnamed(Colour::Grey, Mark::Line(points.clone())),
        Series::unnamed(Colour::Black, Mark::Dots(points)),
    ];
    series.extend(closeup.marks.iter().flat_map(|marks| faults(marks, kinds, None)));
    panel("the largest step at a fault, point by point".into(), series)
}

fn panel(title: String, series: Vec<Series>) -> Panel {
    Panel {
        title,
        x: Axis::linear("position on the track x / mm"),
        y: Axis::linear("height z / mm"),
        series,
    }
}

/// A circle at each fault and a tick at each one without a height; the label stands at what there is.
fn faults(marks: &Marks, kinds: &[&str], label: Option<String>) -> Vec<Series> {
    let kind = kinds.iter().position(|kind| *kind == marks.fault).unwrap_or(0);
    // Vermilion first, since the first kind is the one that a reader looks for.
    let colour = Colour::Nth(kind + 1);
    let (missing, measured): (Vec<&[f64; 2]>, Vec<_>) =
        marks.points.iter().partition(|point| point[1].is_nan());
    let ticks = Mark::Rug(missing.iter().map(|point| point[0]).collect());
    let circles = Mark::FilledCircles(measured.iter().map(|&&[x, z]| (x, z)).collect());
    let (of_ticks, of_circles) = if measured.is_empty() { (label, None) } else { (None, label) };
    vec![
        Series { label: of_ticks, colour, mark: ticks },
        Series { label: of_circles, colour, mark: circles },
    ]
}

/// Kind, number and decision, as in the table of the faults.
fn name(report: &ConditioningReport, fault: &str) -> String {
    let row = report.faults.iter().find(|row| row.fault == fault);
    row.map_or_else(
        || format!("{} {fault}", report.points_missing_in_file + report.points_absent),
        |row| format!("{} {fault}: {}", row.count, row.decision),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Conditioning, RawScan, condition};

    fn report(heights: Vec<f64>) -> ConditioningReport {
        let positions = (0..heights.len()).map(|i| i as f64 * 1e-5).collect();
        let scan = RawScan { name: "07 <a&b>".into(), positions, heights };
        condition(&scan, &Conditioning::default()).unwrap().1
    }

    fn road(points: usize) -> Vec<f64> {
        (0..points).map(|i| 1e-4 * (0.05 * i as f64).sin()).collect()
    }

    #[test]
    fn faults_are_drawn_with_their_numbers_and_a_close_up() {
        let mut heights = road(5000);
        (heights[1000], heights[3000]) = (1e-3, -1e-3);
        heights[2000..2010].fill(f64::NAN);
        let svg = fault_figure(&report(heights)).unwrap().svg().unwrap();
        for text in ["2 spikes: missing", "10 missing points", "the largest step", "height z / mm"]
        {
            assert!(svg.contains(text), "{text} is not in the figure");
        }
        assert!(svg.contains("07 &lt;a&amp;b&gt;"), "the name is not escaped");
        // Two spikes in the overview, one in the close-up, one in the legend; in the close-up the points of
        // the track are smaller.
        assert_eq!(svg.matches("r=\"24\"").count(), 4);
        assert!(svg.matches("r=\"16\"").count() > 20);
    }

    #[test]
    fn a_scan_without_faults_has_no_picture_and_one_of_gaps_alone_no_close_up() {
        assert_eq!(fault_figure(&report(road(500))), None);
        let mut heights = road(500);
        heights[7] = f64::NAN;
        let svg = fault_figure(&report(heights)).unwrap().svg().unwrap();
        assert!(!svg.contains("the largest step"));
    }
}
