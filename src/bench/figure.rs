//! Error against seconds, in SVG.

use super::{CaseResult, Line};
use crate::plot::{COLOURS, FONT, FigureError};
use plotters::prelude::*;
use std::ops::Range;

const SIZE: (u32, u32) = (1000, 1120);
/// Double precision: errors below are drawn there.
const SMALLEST_ERROR: f64 = 1e-16;

/// Error over seconds, both logarithmic, a line for each method: above those whose result is a
/// friction, below those of scans. Returns the SVG.
///
/// # Errors
/// [`FigureError`] if there is nothing to draw or the drawing fails.
pub fn figure(results: &[CaseResult]) -> Result<String, FigureError> {
    let of = |friction: bool| -> Vec<&Line> {
        let lines = results.iter().flat_map(|result| &result.lines);
        lines.filter(|line| line.points.iter().all(|p| p.result.is_some()) == friction).collect()
    };
    let panels: Vec<(Vec<&Line>, &str)> =
        [(of(true), "relative error of friction"), (of(false), "relative error, scans")]
            .into_iter()
            .filter(|(lines, _)| !lines.is_empty())
            .collect();
    if panels.is_empty() {
        return Err(FigureError("there are no results to draw".into()));
    }
    let mut svg = String::new();
    draw(&mut svg, &panels).map_err(|error| FigureError(error.to_string()))?;
    Ok(svg)
}

fn draw(svg: &mut String, panels: &[(Vec<&Line>, &str)]) -> Result<(), Box<dyn std::error::Error>> {
    let size = (SIZE.0, SIZE.1 / 2 * panels.len() as u32);
    let root = SVGBackend::with_string(svg, size).into_drawing_area();
    root.fill(&WHITE)?;
    let areas = root.split_evenly((panels.len(), 1));
    for (area, (lines, name)) in areas.iter().zip(panels) {
        panel(area, lines, name)?;
    }
    root.present()?;
    Ok(())
}

fn panel(
    area: &DrawingArea<SVGBackend, plotters::coord::Shift>,
    lines: &[&Line],
    name: &str,
) -> Result<(), Box<dyn std::error::Error>> {
    let points = || lines.iter().flat_map(|line| &line.points);
    let across = range(points().map(|point| point.seconds));
    let up = range(points().map(|point| point.relative_error.max(SMALLEST_ERROR)));
    // Lines fall to the lower right; beyond their ends there is room for the legend.
    let across = across.start..across.end * 4.0;
    let mut chart = ChartBuilder::on(area)
        .margin(20)
        .margin_right(30)
        .x_label_area_size(55)
        .y_label_area_size(80)
        .build_cartesian_2d(across.log_scale(), up.log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("seconds")
        .y_desc(name)
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .axis_desc_style((FONT, 18))
        .label_style((FONT, 15))
        .draw()?;
    for (index, line) in lines.iter().enumerate() {
        let style = COLOURS[index % COLOURS.len()].stroke_width(2);
        let places = line.points.iter().map(|p| (p.seconds, p.relative_error.max(SMALLEST_ERROR)));
        let places: Vec<(f64, f64)> = places.collect();
        chart.draw_series(LineSeries::new(places.clone(), style))?;
        // Colours come round after six lines; the marks tell them apart.
        let filled = index < COLOURS.len();
        chart
            .draw_series(places.iter().map(|place| mark(*place, filled, style)))?
            .label(line.method)
            .legend(move |(x, y)| {
                EmptyElement::at((x, y))
                    + PathElement::new([(0, 0), (24, 0)], style)
                    + Circle::new((12, 0), 4, if filled { style.filled() } else { style })
            });
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .margin(12)
        .legend_area_size(34)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font((FONT, 15))
        .draw()?;
    Ok(())
}

fn mark(at: (f64, f64), filled: bool, style: ShapeStyle) -> Circle<(f64, f64), i32> {
    Circle::new(at, 4, if filled { style.filled() } else { style })
}

/// From a bit below the smallest to a bit above the largest.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    low / 2.0..high * 2.0
}
