//! Panels as SVG, by plotters.

use super::ticks::Ticks;
use super::{Axis, COLOURS, FONT, FigureError, Mark, Panel, Scale, Series};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, ValueFormatter};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use std::ops::Range;

/// Units of the drawing for one of its size: plotters rounds to whole units, which would show.
const FINE: u32 = 8;
const WIDTH: u32 = 640 * FINE;
/// Height of a panel without its legend.
const HEIGHT: u32 = 400 * FINE;
const LEGEND_LINE: u32 = 22 * FINE;
/// Below the last line of a legend.
const GAP: u32 = 8 * FINE;
const LEGEND_MARGIN: u32 = 76 * FINE;
/// Width of the sample of a line or band in the legend, and of a letter: plotters asks no font.
const SAMPLE: u32 = 30 * FINE;
const LETTER: f64 = 7.6 * FINE as f64;
const STROKE: u32 = 2 * FINE;
const DASH: (u32, u32) = (7 * FINE, 5 * FINE);
const DOTTED: (u32, u32) = (2 * FINE, 3 * FINE);
/// Room between the data and the ends of an axis, as a share of its length.
const ROOM: f64 = 0.04;
const TITLE: u32 = 18 * FINE;
const NAME: u32 = 18 * FINE;
const LABEL: u32 = 16 * FINE;

/// A range in coordinates with the ticks of its axis.
struct Coordinate {
    range: Range<f64>,
    ticks: Ticks,
}

impl Ranged for Coordinate {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        limit.0 + (share * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            self.ticks.minor.clone()
        } else {
            self.ticks.labelled.clone()
        }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Coordinate {
    fn format_ext(&self, coordinate: &f64) -> String {
        self.ticks.label(*coordinate)
    }
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Coordinate, Coordinate>>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Panels one below the other.
pub(super) fn svg(panels: &[Panel]) -> Result<String, FigureError> {
    let heights: Vec<u32> = panels.iter().map(height).collect();
    if heights.is_empty() {
        return Err(FigureError("there is nothing to draw".into()));
    }
    let mut svg = String::new();
    let draw = || -> Drawn {
        let size = (WIDTH, heights.iter().sum());
        let mut rest = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        rest.fill(&WHITE)?;
        for (panel, height) in panels.iter().zip(heights) {
            let (area, below) = rest.split_vertically(height);
            draw_panel(&area, panel)?;
            rest = below;
        }
        rest.present()?;
        Ok(())
    };
    draw().map_err(|error| FigureError(error.to_string()))?;
    let height: u32 = panels.iter().map(height).sum();
    let drawn = format!("width=\"{WIDTH}\" height=\"{height}\"");
    let shown = format!("width=\"{}\" height=\"{}\"", WIDTH / FINE, height / FINE);
    Ok(svg.replacen(&drawn, &shown, 1))
}

fn height(panel: &Panel) -> u32 {
    HEIGHT + LEGEND_LINE * Legend::of(panel).lines() + GAP
}

fn draw_panel(area: &Area, panel: &Panel) -> Drawn {
    let (upper, lower) = area.split_vertically(HEIGHT);
    let across = range(&panel.across, panel.series.iter().flat_map(|s| s.mark.across()))?;
    let up = range(&panel.up, panel.series.iter().flat_map(|s| s.mark.up()))?;
    let coordinate = |axis: &Axis, range: &Range<f64>| Coordinate {
        range: range.clone(),
        ticks: Ticks::new(axis.scale, range),
    };
    let mut chart = ChartBuilder::on(&upper)
        .margin_top(12 * FINE)
        .margin_right(24 * FINE)
        .margin_left(8 * FINE)
        .margin_bottom(8 * FINE)
        .caption(&panel.title, (FONT, TITLE))
        .x_label_area_size(44 * FINE)
        .y_label_area_size(76 * FINE)
        .build_cartesian_2d(coordinate(&panel.across, &across), coordinate(&panel.up, &up))?;
    chart
        .configure_mesh()
        .light_line_style(BLACK.mix(0.06).stroke_width(FINE))
        .bold_line_style(BLACK.mix(0.16).stroke_width(FINE))
        .axis_style(BLACK.stroke_width(FINE))
        .set_all_tick_mark_size(5 * FINE)
        .x_desc(&panel.across.label)
        .y_desc(&panel.up.label)
        .axis_desc_style((FONT, NAME))
        .label_style((FONT, LABEL))
        .draw()?;
    for series in &panel.series {
        draw_series(&mut chart, panel, series, (&across, &up))?;
    }
    let corners = [
        (across.start, up.start),
        (across.start, up.end),
        (across.end, up.end),
        (across.end, up.start),
        (across.start, up.start),
    ];
    chart.draw_series([PathElement::new(corners, BLACK.stroke_width(FINE))])?;
    Legend::of(panel).draw(&lower)
}

/// The ends of an axis in its coordinates: the data and some room, or where the axis is to begin.
fn range(axis: &Axis, values: impl Iterator<Item = f64>) -> Result<Range<f64>, FigureError> {
    let start = axis.from.and_then(|from| axis.coordinate(from));
    let coordinates = values.filter_map(|value| axis.coordinate(value)).chain(start);
    let (low, high) = coordinates
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)));
    if low > high {
        return Err(FigureError(format!("{}: there are no values to draw", axis.label)));
    }
    let least = match axis.scale {
        Scale::Linear => (0.1 * high.abs()).max(1e-9),
        Scale::Logarithmic => 0.1,
    };
    let room = ROOM * (high - low).max(least);
    let alone = if high > low { 0.0 } else { least };
    let start = if start == Some(low) { low } else { low - room - alone };
    Ok(start..high + room + alone)
}

impl Mark {
    /// The values that the horizontal axis must have room for.
    fn across(&self) -> Vec<f64> {
        match self {
            Self::Line(points)
            | Self::Dashed(points)
            | Self::Discs(points)
            | Self::Dots(points)
            | Self::Circles(points) => points.iter().map(|point| point.0).collect(),
            Self::Band(rows) | Self::Bars(rows) => rows.iter().map(|row| row.0).collect(),
            Self::Columns(rows) => rows.iter().flat_map(|row| [row.0, row.1]).collect(),
            Self::Span(from, to) => vec![*from, *to],
            Self::Vertical(at) => vec![*at],
            Self::Horizontal(_) => vec![],
        }
    }

    /// The values that the vertical axis must have room for.
    fn up(&self) -> Vec<f64> {
        match self {
            Self::Line(points)
            | Self::Dashed(points)
            | Self::Discs(points)
            | Self::Dots(points)
            | Self::Circles(points) => points.iter().map(|point| point.1).collect(),
            Self::Band(rows) | Self::Bars(rows) => {
                rows.iter().flat_map(|row| [row.1, row.2]).collect()
            }
            Self::Columns(rows) => rows.iter().map(|row| row.2).collect(),
            Self::Span(..) | Self::Vertical(_) => vec![],
            Self::Horizontal(at) => vec![*at],
        }
    }
}

fn draw_series(
    chart: &mut Chart,
    panel: &Panel,
    series: &Series,
    (across, up): (&Range<f64>, &Range<f64>),
) -> Drawn {
    let colour = colour(series.colour);
    let style = colour.stroke_width(STROKE);
    let place = |point: &(f64, f64)| {
        Some((panel.across.coordinate(point.0)?, panel.up.coordinate(point.1)?))
    };
    // A limit without a place, such as the lower end of an error bar on a logarithmic axis, lies at
    // the end of the axis.
    let between = |row: &(f64, f64, f64)| {
        let low = panel.up.coordinate(row.1).unwrap_or(up.start).max(up.start);
        Some((panel.across.coordinate(row.0)?, low, panel.up.coordinate(row.2)?))
    };
    match &series.mark {
        Mark::Line(points) => {
            for run in runs(points, place) {
                chart.draw_series([PathElement::new(run, style)])?;
            }
        }
        Mark::Dashed(points) => {
            for run in runs(points, place) {
                chart.draw_series([DashedPathElement::new(run, DASH.0, DASH.1, style)])?;
            }
        }
        Mark::Discs(points) => {
            chart.draw_series(
                points.iter().filter_map(place).map(|p| Circle::new(p, 3 * FINE, colour.filled())),
            )?;
        }
        Mark::Dots(points) => {
            let dots = points.iter().filter_map(place);
            chart.draw_series(dots.map(|p| Circle::new(p, 2 * FINE, colour.mix(0.4).filled())))?;
        }
        Mark::Circles(points) => {
            chart.draw_series(
                points.iter().filter_map(place).map(|p| Circle::new(p, 4 * FINE, style)),
            )?;
        }
        Mark::Band(rows) => {
            let rows: Vec<_> = rows.iter().filter_map(between).collect();
            let upper = rows.iter().map(|row| (row.0, row.2));
            let lower = rows.iter().rev().map(|row| (row.0, row.1));
            let outline: Vec<_> = upper.chain(lower).collect();
            chart.draw_series([Polygon::new(outline, colour.mix(0.18))])?;
        }
        Mark::Bars(rows) => {
            let cap = 0.006 * (across.end - across.start);
            for (x, low, high) in rows.iter().filter_map(between) {
                // A bar that goes on below the axis has no end to mark.
                let ends = [low, high].into_iter().filter(|end| *end > up.start);
                let caps = ends.map(|y| [(x - cap, y), (x + cap, y)]);
                chart.draw_series([PathElement::new([(x, low), (x, high)], style)])?;
                chart.draw_series(caps.map(|cap| PathElement::new(cap, style)))?;
            }
        }
        Mark::Columns(rows) => {
            chart.draw_series(rows.iter().map(|&(from, to, height)| {
                Rectangle::new([(from, up.start), (to, height)], colour.mix(0.45).filled())
            }))?;
        }
        Mark::Span(from, to) => {
            let ends = (panel.across.coordinate(*from), panel.across.coordinate(*to));
            if let (Some(from), Some(to)) = ends {
                let corners = [(from, up.start), (to, up.end)];
                chart.draw_series([Rectangle::new(corners, colour.mix(0.15).filled())])?;
            }
        }
        Mark::Vertical(at) => {
            if let Some(x) = panel.across.coordinate(*at) {
                let line = [(x, up.start), (x, up.end)];
                chart.draw_series([DashedPathElement::new(line, DOTTED.0, DOTTED.1, style)])?;
            }
        }
        Mark::Horizontal(at) => {
            if let Some(y) = panel.up.coordinate(*at) {
                let line = [(across.start, y), (across.end, y)];
                chart.draw_series([DashedPathElement::new(line, DOTTED.0, DOTTED.1, style)])?;
            }
        }
    }
    Ok(())
}

/// Stretches of points that have a place.
fn runs(
    points: &[(f64, f64)],
    place: impl Fn(&(f64, f64)) -> Option<(f64, f64)>,
) -> Vec<Vec<(f64, f64)>> {
    let places: Vec<_> = points.iter().map(place).collect();
    let runs = places.split(Option::is_none).filter(|run| !run.is_empty());
    runs.map(|run| run.iter().flatten().copied().collect()).collect()
}

fn colour(number: usize) -> RGBColor {
    match number {
        0 => BLACK,
        number => COLOURS[(number - 1) % COLOURS.len()],
    }
}

/// The names of the series below the axes, in columns, where they cannot hide anything.
struct Legend<'a> {
    entries: Vec<(&'a str, &'a Series)>,
    columns: usize,
}

impl<'a> Legend<'a> {
    fn of(panel: &'a Panel) -> Self {
        let named = panel.series.iter().filter_map(|s| Some((s.label.as_deref()?, s)));
        let entries: Vec<_> = named.collect();
        let longest = entries.iter().map(|entry| entry.0.chars().count()).max().unwrap_or(0);
        let width = f64::from(SAMPLE + 26 * FINE) + LETTER * longest as f64;
        let room = f64::from(WIDTH - LEGEND_MARGIN);
        let columns = ((room / width) as usize).clamp(1, 4).min(entries.len().max(1));
        Self { entries, columns }
    }

    fn lines(&self) -> u32 {
        self.entries.len().div_ceil(self.columns) as u32
    }

    fn draw(&self, area: &Area) -> Drawn {
        let width = (WIDTH - LEGEND_MARGIN) / self.columns as u32;
        for (number, (label, series)) in self.entries.iter().enumerate() {
            let x = (LEGEND_MARGIN + width * (number % self.columns) as u32) as i32;
            let y = (LEGEND_LINE * (number / self.columns) as u32 + 8 * FINE) as i32;
            sample(area, series, (x, y))?;
            let style = TextStyle::from((FONT, LABEL).into_font());
            let place = (x + (SAMPLE + 8 * FINE) as i32, y - 6 * FINE as i32);
            area.draw(&Text::new((*label).to_owned(), place, style))?;
        }
        Ok(())
    }
}

/// What a series looks like, in the legend.
fn sample(area: &Area, series: &Series, (x, y): (i32, i32)) -> Drawn {
    let colour = colour(series.colour);
    let style = colour.stroke_width(STROKE);
    let (width, half) = (SAMPLE as i32, 6 * FINE as i32);
    let line = [(x, y), (x + width, y)];
    let block = [(x, y - half), (x + width, y + half)];
    let middle = (x + width / 2, y);
    match series.mark {
        Mark::Line(_) => area.draw(&PathElement::new(line, style))?,
        Mark::Dashed(_) => area.draw(&DashedPathElement::new(line, DASH.0, DASH.1, style))?,
        Mark::Vertical(_) | Mark::Horizontal(_) => {
            area.draw(&DashedPathElement::new(line, DOTTED.0, DOTTED.1, style))?;
        }
        Mark::Discs(_) => area.draw(&Circle::new(middle, 3 * FINE, colour.filled()))?,
        Mark::Dots(_) => area.draw(&Circle::new(middle, 2 * FINE, colour.mix(0.4).filled()))?,
        Mark::Circles(_) => area.draw(&Circle::new(middle, 4 * FINE, style))?,
        Mark::Bars(_) => {
            area.draw(&PathElement::new([(middle.0, y - half), (middle.0, y + half)], style))?;
        }
        Mark::Band(_) => area.draw(&Rectangle::new(block, colour.mix(0.18).filled()))?,
        Mark::Span(..) => area.draw(&Rectangle::new(block, colour.mix(0.15).filled()))?,
        Mark::Columns(_) => area.draw(&Rectangle::new(block, colour.mix(0.45).filled()))?,
    }
    Ok(())
}
