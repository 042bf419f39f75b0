//! Series in their panel, and what each looks like in the legend.

use super::super::panel::{Mark, Panel, Points, Series};
use super::{Area, Coordinate, DASH, DOTTED, Drawn, FINE, STROKE, colour};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use std::ops::Range;

/// Half the height of a sample in the legend.
const HALF: i32 = 6 * FINE as i32;
/// Length of the ticks on the lower edge over the height of the panel.
const TICK: f64 = 0.035;
const FILLED: u32 = 3 * FINE;
const OPEN: u32 = 4 * FINE;
/// Stroke of an open circle: thinner than a line, so that many of them do not hide one.
const OUTLINE: u32 = 5 * FINE / 4;
const DOT: u32 = 2 * FINE;
const PALE: f64 = 0.4;
const BAND: f64 = 0.18;
const BAR: f64 = 0.45;
const SPAN: f64 = 0.15;

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Coordinate, Coordinate>>;
type Triple = (f64, f64, f64);

/// Draws a series; `x` and `y` are the ranges of the axes in their coordinates.
pub(super) fn draw(
    chart: &mut Chart,
    panel: &Panel,
    series: &Series,
    (x, y): (&Range<f64>, &Range<f64>),
) -> Drawn {
    let colour = colour(series.colour);
    let style = colour.stroke_width(STROKE);
    let place =
        |point: &(f64, f64)| Some((panel.x.coordinate(point.0)?, panel.y.coordinate(point.1)?));
    // A lower end that the axis cannot show, as on a logarithmic axis, is drawn at the end of the axis.
    let between = |row: &Triple| {
        let low = panel.y.coordinate(row.1).unwrap_or(y.start).max(y.start);
        Some((panel.x.coordinate(row.0)?, low, panel.y.coordinate(row.2)?))
    };
    let circles = |chart: &mut Chart, points: &Points, radius: u32, style: ShapeStyle| -> Drawn {
        let points = points.iter().filter_map(place);
        chart.draw_series(points.map(|point| Circle::new(point, radius, style)))?;
        Ok(())
    };
    match &series.mark {
        Mark::Line(points) => {
            for run in runs(points, place) {
                chart.draw_series([PathElement::new(run, style)])?;
            }
        }
        Mark::Dashed(points) => broken(chart, runs(points, place), DASH, style)?,
        Mark::Dotted(points) => broken(chart, runs(points, place), DOTTED, style)?,
        Mark::FilledCircles(points) => circles(chart, points, FILLED, colour.filled())?,
        Mark::OpenCircles(points) => {
            circles(chart, points, OPEN, colour.stroke_width(OUTLINE))?;
        }
        Mark::Dots(points) => circles(chart, points, DOT, colour.mix(PALE).filled())?,
        Mark::Band(rows) => {
            for run in runs(rows, between) {
                let upper = run.iter().map(|row| (row.0, row.2));
                let lower = run.iter().rev().map(|row| (row.0, row.1));
                let outline: Vec<_> = upper.chain(lower).collect();
                chart.draw_series([Polygon::new(outline, colour.mix(BAND))])?;
            }
        }
        Mark::ErrorBars(rows) => {
            error_bars(chart, rows.iter().filter_map(between), style, (x, y))?;
        }
        Mark::Histogram(bars) => {
            chart.draw_series(bars.iter().map(|&(from, to, height)| {
                Rectangle::new([(from, y.start), (to, height)], colour.mix(BAR).filled())
            }))?;
        }
        Mark::Rug(positions) => {
            let top = y.start + TICK * (y.end - y.start);
            let positions = positions.iter().filter_map(|at| panel.x.coordinate(*at));
            let tick = |at| PathElement::new([(at, y.start), (at, top)], style);
            chart.draw_series(positions.map(tick))?;
        }
        Mark::Span(from, to) => {
            let ends = panel.x.coordinate(*from).zip(panel.x.coordinate(*to));
            chart.draw_series(ends.map(|(from, to)| {
                Rectangle::new([(from, y.start), (to, y.end)], colour.mix(SPAN).filled())
            }))?;
        }
        Mark::VerticalLine(at) => {
            let at = panel.x.coordinate(*at);
            broken(chart, at.map(|at| vec![(at, y.start), (at, y.end)]), DOTTED, style)?;
        }
        Mark::HorizontalLine(at) => {
            let at = panel.y.coordinate(*at);
            broken(chart, at.map(|at| vec![(x.start, at), (x.end, at)]), DOTTED, style)?;
        }
        // Fills a panel of its own, see `map`.
        Mark::Map(_) => {}
    }
    Ok(())
}

fn error_bars(
    chart: &mut Chart,
    bars: impl Iterator<Item = Triple>,
    style: ShapeStyle,
    (x, y): (&Range<f64>, &Range<f64>),
) -> Drawn {
    let cap = 0.006 * (x.end - x.start);
    for (at, low, high) in bars {
        // A bar that goes on below the axis has no end to mark.
        let ends = [low, high].into_iter().filter(|end| *end > y.start);
        let caps = ends.map(|end| [(at - cap, end), (at + cap, end)]);
        chart.draw_series([PathElement::new([(at, low), (at, high)], style)])?;
        chart.draw_series(caps.map(|cap| PathElement::new(cap, style)))?;
    }
    Ok(())
}

/// Lines of dashes of a length with gaps of a length.
fn broken(
    chart: &mut Chart,
    lines: impl IntoIterator<Item = Vec<(f64, f64)>>,
    (dash, gap): (u32, u32),
    style: ShapeStyle,
) -> Drawn {
    let lines = lines.into_iter();
    chart.draw_series(lines.map(|line| DashedPathElement::new(line, dash, gap, style)))?;
    Ok(())
}

/// Stretches of values that have a place in the panel.
fn runs<T: Copy>(values: &[T], place: impl Fn(&T) -> Option<T>) -> Vec<Vec<T>> {
    let places: Vec<Option<T>> = values.iter().map(place).collect();
    let runs = places.split(Option::is_none).filter(|run| !run.is_empty());
    runs.map(|run| run.iter().flatten().copied().collect()).collect()
}

/// Draws what a series looks like, `width` wide from `(x, y)` on.
pub(super) fn sample(area: &Area, series: &Series, (x, y): (i32, i32), width: i32) -> Drawn {
    let colour = colour(series.colour);
    let style = colour.stroke_width(STROKE);
    let line = [(x, y), (x + width, y)];
    let block = [(x, y - HALF), (x + width, y + HALF)];
    let middle = (x + width / 2, y);
    match series.mark {
        Mark::Line(_) => area.draw(&PathElement::new(line, style))?,
        Mark::Dashed(_) => area.draw(&DashedPathElement::new(line, DASH.0, DASH.1, style))?,
        Mark::Dotted(_) | Mark::VerticalLine(_) | Mark::HorizontalLine(_) => {
            area.draw(&DashedPathElement::new(line, DOTTED.0, DOTTED.1, style))?;
        }
        Mark::FilledCircles(_) => area.draw(&Circle::new(middle, FILLED, colour.filled()))?,
        Mark::OpenCircles(_) => {
            area.draw(&Circle::new(middle, OPEN, colour.stroke_width(OUTLINE)))?;
        }
        Mark::Dots(_) => area.draw(&Circle::new(middle, DOT, colour.mix(PALE).filled()))?,
        Mark::ErrorBars(_) => {
            area.draw(&PathElement::new([(middle.0, y - HALF), (middle.0, y + HALF)], style))?;
        }
        Mark::Rug(_) => {
            area.draw(&PathElement::new([(middle.0, y - HALF / 2), (middle.0, y + HALF)], style))?;
        }
        Mark::Map(_) => {}
        Mark::Band(_) => area.draw(&Rectangle::new(block, colour.mix(BAND).filled()))?,
        Mark::Span(..) => area.draw(&Rectangle::new(block, colour.mix(SPAN).filled()))?,
        Mark::Histogram(_) => area.draw(&Rectangle::new(block, colour.mix(BAR).filled()))?,
    }
    Ok(())
}
