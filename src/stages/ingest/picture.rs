//! Pictures of the faults of a scan, in SVG.

use crate::artifact::Pending;
use crate::plot::{COLOURS, FONT, FigureError};
use crate::stages::StageError;
use crate::surface::ConditioningReport;
use crate::surface::faults::{FaultOverview, Marks};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;

const WIDTH: u32 = 900;
const PANEL_HEIGHT: u32 = 340;
/// Share of the height of a panel that the ticks of missing points take, at its bottom.
const TICK: f64 = 0.03;
/// Room above the heights for the legend, as a share of their range.
const LEGEND: f64 = 0.4;

type Panel<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Writes the pictures of the scans that have faults, `most` at most, and returns the file of each
/// by the name of its scan.
pub(super) fn write_pictures(
    reports: &[&ConditioningReport],
    most: usize,
    pending: &mut Pending,
) -> Result<BTreeMap<String, String>, StageError> {
    let mut worst: Vec<_> = reports.iter().filter(|report| report.overview.is_some()).collect();
    // Stable: scans that are alike keep their order.
    worst.sort_by(|a, b| smallest_rest(a).total_cmp(&smallest_rest(b)));
    let mut pictures = BTreeMap::new();
    for (number, report) in worst.into_iter().take(most).enumerate() {
        let file = format!("faults_{:02}.svg", number + 1);
        pending.write_document(&file, &fault_picture(report)?)?;
        pictures.insert(report.scan.clone(), file);
    }
    Ok(pictures)
}

/// What is left of the shortest waves without the fault that makes most of them.
fn smallest_rest(report: &ConditioningReport) -> f64 {
    report.faults.iter().filter_map(|fault| fault.high_frequency_ratio).fold(1.0, f64::min)
}

/// A scan as measured with its faults, and the surroundings of the largest step among them. Returns
/// the SVG.
///
/// # Errors
/// [`FigureError`] if the scan has no faults, or the drawing fails.
pub fn fault_picture(report: &ConditioningReport) -> Result<String, FigureError> {
    let overview = report
        .overview
        .as_ref()
        .ok_or_else(|| FigureError(format!("{} has no faults to draw", report.scan)))?;
    let mut svg = String::new();
    draw(&mut svg, report, overview).map_err(|error| FigureError(error.to_string()))?;
    Ok(svg)
}

fn draw(svg: &mut String, report: &ConditioningReport, overview: &FaultOverview) -> Drawn {
    let panels = 1 + u32::from(overview.closeup.is_some());
    let root = SVGBackend::with_string(svg, (WIDTH, panels * PANEL_HEIGHT)).into_drawing_area();
    root.fill(&WHITE)?;
    let kinds: Vec<&str> = overview.marks.iter().map(|marks| marks.fault.as_str()).collect();
    let areas = root.split_evenly((panels as usize, 1));

    let stretches = &overview.stretches;
    let positions = stretches.iter().map(|stretch| stretch.position_mm);
    let heights = stretches.iter().flat_map(|stretch| [stretch.lowest_mm, stretch.highest_mm]);
    let title = format!("{}: the scan as measured", report.scan);
    let heights = range(heights);
    let above_legend = heights.end + LEGEND * (heights.end - heights.start);
    let (mut chart, bottom) =
        panel(&areas[0], &title, range(positions), heights.start..above_legend)?;
    for run in stretches.split(|stretch| stretch.lowest_mm.is_nan()) {
        let upper = run.iter().map(|stretch| (stretch.position_mm, stretch.highest_mm));
        let lower = run.iter().rev().map(|stretch| (stretch.position_mm, stretch.lowest_mm));
        let outline: Vec<(f64, f64)> = upper.chain(lower).collect();
        chart.draw_series([Polygon::new(outline.clone(), BLACK.mix(0.25))])?;
        chart.draw_series([PathElement::new(outline, BLACK.mix(0.6))])?;
    }
    for marks in &overview.marks {
        let colour = colour(&kinds, &marks.fault);
        mark(&mut chart, marks, colour, &bottom)?;
        chart
            .draw_series(LineSeries::new(Vec::<(f64, f64)>::new(), colour))?
            .label(caption(report, &marks.fault))
            .legend(move |(x, y)| Circle::new((x + 12, y), 4, colour.filled()));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font((FONT, 14))
        .draw()?;

    if let Some(closeup) = &overview.closeup {
        let positions = closeup.points.iter().map(|point| point[0]);
        let heights = closeup.points.iter().map(|point| point[1]);
        let title = "the largest step at a fault, point by point";
        let (mut chart, bottom) = panel(&areas[1], title, range(positions), range(heights))?;
        for run in closeup.points.split(|point| point[1].is_nan()) {
            let line = run.iter().map(|point| (point[0], point[1]));
            chart.draw_series(LineSeries::new(line, BLACK.mix(0.6)).point_size(2))?;
        }
        for marks in &closeup.marks {
            mark(&mut chart, marks, colour(&kinds, &marks.fault), &bottom)?;
        }
    }
    root.present()?;
    Ok(())
}

/// Axes of a panel, and the range of heights at its bottom where missing points are ticked.
fn panel<'a, 'b>(
    area: &'a DrawingArea<SVGBackend<'b>, plotters::coord::Shift>,
    title: &str,
    across: Range<f64>,
    heights: Range<f64>,
) -> Result<(Panel<'a, 'b>, Range<f64>), Box<dyn std::error::Error>> {
    let bottom = heights.start..heights.start + TICK * (heights.end - heights.start);
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_right(25)
        .caption(title, (FONT, 17))
        .x_label_area_size(45)
        .y_label_area_size(65)
        .build_cartesian_2d(across, heights)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("position on the track [mm]")
        .y_desc("height [mm]")
        .axis_desc_style((FONT, 15))
        .label_style((FONT, 13))
        .draw()?;
    Ok((chart, bottom))
}

/// A dot at each fault; points without a height are ticks at the bottom.
fn mark(chart: &mut Panel, marks: &Marks, colour: RGBColor, bottom: &Range<f64>) -> Drawn {
    let (missing, valid): (Vec<&[f64; 2]>, Vec<_>) =
        marks.points.iter().partition(|point| point[1].is_nan());
    let ticks = missing.iter().map(|&&[x, _]| {
        PathElement::new([(x, bottom.start), (x, bottom.end)], colour.stroke_width(1))
    });
    chart.draw_series(ticks)?;
    let dots = valid.iter().map(|&&[x, z]| Circle::new((x, z), 3, colour.filled()));
    chart.draw_series(dots)?;
    Ok(())
}

/// Kind, number and decision, as in the table of the faults.
fn caption(report: &ConditioningReport, fault: &str) -> String {
    let row = report.faults.iter().find(|row| row.fault == fault);
    row.map_or_else(
        || format!("{} {fault}", report.points_missing_in_file + report.points_absent),
        |row| format!("{} {fault}: {}", row.count, row.decision),
    )
}

fn colour(kinds: &[&str], fault: &str) -> RGBColor {
    let place = kinds.iter().position(|kind| *kind == fault).unwrap_or(0);
    // Vermilion first, since the first kind is the one that a reader looks for.
    COLOURS[(place + 1) % COLOURS.len()]
}

/// The range of the valid values with a margin of 4 % on both sides.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let valid = values.filter(|value| !value.is_nan());
    let (low, high) = valid.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return -1.0..1.0;
    }
    let margin = (0.04 * (high - low)).max(1e-9 * high.abs()).max(1e-9);
    low - margin..high + margin
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
        let svg = fault_picture(&report(heights)).unwrap();
        for text in ["2 spikes: missing", "10 missing points", "the largest step", "height [mm]"] {
            assert!(svg.contains(text), "{text} is not in the figure");
        }
        assert!(svg.contains("07 &lt;a&amp;b&gt;"), "the name is not escaped");
        // Two in the overview, one in the close-up, one in the legend, and that of missing points.
        assert_eq!(svg.matches("<circle").count() - closeup_dots(&svg), 5);
    }

    /// The dots of the line in the close-up, which are smaller than those of the faults.
    fn closeup_dots(svg: &str) -> usize {
        svg.matches("r=\"2\"").count()
    }

    #[test]
    fn a_scan_without_faults_has_no_picture_and_one_of_gaps_alone_no_close_up() {
        assert!(fault_picture(&report(road(500))).is_err());
        let mut heights = road(500);
        heights[7] = f64::NAN;
        let svg = fault_picture(&report(heights)).unwrap();
        assert!(!svg.contains("the largest step"));
    }
}
