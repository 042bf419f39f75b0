//! Panels as SVG, by plotters: the only place that draws.

mod legend;
mod map;
mod marks;

use super::FigureError;
use super::panel::{Axis, Colour, Panel, Scale};
use super::raster::Picture;
use super::ticks::Ticks;
use legend::Legend;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, ValueFormatter};
use plotters::prelude::*;
use std::ops::Range;

/// Units of the drawing for one of its size: plotters rounds to whole units, which would show.
const FINE: u32 = 8;
const WIDTH: u32 = 640 * FINE;
/// Height of a panel without its legend.
const HEIGHT: u32 = 400 * FINE;
/// Below the last line of a legend.
const GAP: u32 = 8 * FINE;
const STROKE: u32 = 2 * FINE;
const DASH: (u32, u32) = (7 * FINE, 5 * FINE);
const DOTTED: (u32, u32) = (2 * FINE, 3 * FINE);
/// Room between the data and the ends of an axis, as a share of its length.
const ROOM: f64 = 0.04;
const MARGIN_LEFT: u32 = 8 * FINE;
const MARGIN_RIGHT: u32 = 24 * FINE;
/// Sizes of the letters of a title: the largest that fits the width is taken.
const TITLES: [u32; 4] = [18 * FINE, 16 * FINE, 14 * FINE, 12 * FINE];
/// Mean width of a letter of a title over its size: plotters asks no font.
const TITLE_LETTER: f64 = 0.6;
const NAME: u32 = 18 * FINE;
const LABEL: u32 = 16 * FINE;
/// Width of a letter at a tick.
const TICK_LETTER: f64 = 8.4 * FINE as f64;
/// Room beside the vertical axis for its name, and for name and ticks together at least.
const BESIDE: (u32, u32) = (34 * FINE, 76 * FINE);
const FONT: &str = "sans-serif";

/// Distinct for readers who do not see all colours (Okabe & Ito).
const COLOURS: [RGBColor; Colour::COUNT] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];
const GREY: RGBColor = RGBColor(150, 150, 150);

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

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Panels one below the other.
pub(super) fn svg(panels: &[Panel]) -> Result<String, FigureError> {
    let heights: Vec<u32> = panels.iter().map(height).collect();
    if heights.is_empty() {
        return Err(FigureError("it has no panel".into()));
    }
    let mut svg = String::new();
    let mut pictures = vec![];
    let draw = || -> Drawn {
        let size = (WIDTH, heights.iter().sum());
        let mut rest = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        rest.fill(&WHITE)?;
        for (panel, height) in panels.iter().zip(heights) {
            let (area, below) = rest.split_vertically(height);
            match panel.map() {
                Some(map) => pictures.extend(map::draw(&area, panel, map)?),
                None => draw_panel(&area, panel)?,
            }
            rest = below;
        }
        rest.present()?;
        Ok(())
    };
    draw().map_err(|error| FigureError(error.to_string()))?;
    let svg = with_pictures(&svg, &pictures);
    let height: u32 = panels.iter().map(height).sum();
    let drawn = format!("width=\"{WIDTH}\" height=\"{height}\"");
    let shown = format!("width=\"{}\" height=\"{}\"", WIDTH / FINE, height / FINE);
    Ok(svg.replacen(&drawn, &shown, 1))
}

/// Plotters draws no pictures: they are put over what it has drawn.
fn with_pictures(svg: &str, pictures: &[Picture]) -> String {
    let Some((content, end)) = svg.rsplit_once("</svg>") else { return svg.to_owned() };
    let elements: String = pictures.iter().map(Picture::element).collect();
    format!("{content}{elements}</svg>{end}")
}

fn height(panel: &Panel) -> u32 {
    if let Some(map) = panel.map() {
        return map::height(map) + GAP;
    }
    HEIGHT + Legend::of(panel).height() + GAP
}

fn draw_panel(area: &Area, panel: &Panel) -> Drawn {
    let (upper, lower) = area.split_vertically(HEIGHT);
    let x = range(&panel.x, panel.series.iter().flat_map(|series| series.mark.x()))?;
    let y = range(&panel.y, panel.series.iter().flat_map(|series| series.mark.y()))?;
    let coordinate = |axis: &Axis, range: &Range<f64>| Coordinate {
        range: range.clone(),
        ticks: Ticks::new(axis.scale, range),
    };
    let (title, size) = heading(&panel.title);
    let (x_coordinate, y_coordinate) = (coordinate(&panel.x, &x), coordinate(&panel.y, &y));
    let beside = room_beside(&y_coordinate.ticks);
    let mut chart = ChartBuilder::on(&upper)
        .margin_top(12 * FINE)
        .margin_right(MARGIN_RIGHT)
        .margin_left(MARGIN_LEFT)
        .margin_bottom(8 * FINE)
        .caption(title, (FONT, size))
        .x_label_area_size(44 * FINE)
        .y_label_area_size(beside)
        .build_cartesian_2d(x_coordinate, y_coordinate)?;
    chart
        .configure_mesh()
        .light_line_style(BLACK.mix(0.06).stroke_width(FINE))
        .bold_line_style(BLACK.mix(0.16).stroke_width(FINE))
        .axis_style(BLACK.stroke_width(FINE))
        .set_all_tick_mark_size(5 * FINE)
        .x_desc(&panel.x.label)
        .y_desc(&panel.y.label)
        .axis_desc_style((FONT, NAME))
        .label_style((FONT, LABEL))
        .draw()?;
    for series in &panel.series {
        marks::draw(&mut chart, panel, series, (&x, &y))?;
    }
    let corners = [
        (x.start, y.start),
        (x.start, y.end),
        (x.end, y.end),
        (x.end, y.start),
        (x.start, y.start),
    ];
    chart.draw_series([PathElement::new(corners, BLACK.stroke_width(FINE))])?;
    Legend::of(panel).draw(&lower)
}

/// Width for the name and the tick labels of a vertical axis.
fn room_beside(ticks: &Ticks) -> u32 {
    let letters = ticks.labelled.iter().map(|tick| ticks.label(*tick).chars().count()).max();
    let labels = TICK_LETTER * letters.unwrap_or(0) as f64;
    (BESIDE.0 + labels as u32).max(BESIDE.1)
}

/// A title and the size of its letters, cut where the smallest letters do not fit either.
fn heading(title: &str) -> (String, u32) {
    let letters = |size: u32| {
        (f64::from(WIDTH - MARGIN_LEFT - MARGIN_RIGHT) / (TITLE_LETTER * f64::from(size))) as usize
    };
    let count = title.chars().count();
    if let Some(size) = TITLES.into_iter().find(|size| count <= letters(*size)) {
        return (title.to_owned(), size);
    }
    let smallest = TITLES[TITLES.len() - 1];
    let shown: String = title.chars().take(letters(smallest) - 1).collect();
    (shown + "…", smallest)
}

/// The ends of an axis in its coordinates: the data and some room, or where the axis is to start.
fn range(axis: &Axis, values: impl Iterator<Item = f64>) -> Result<Range<f64>, FigureError> {
    let start = axis.start.and_then(|start| axis.coordinate(start));
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

fn colour(colour: Colour) -> RGBColor {
    match colour {
        Colour::Black => BLACK,
        Colour::Grey => GREY,
        Colour::Nth(number) => COLOURS[number % COLOURS.len()],
    }
}

#[cfg(test)]
mod tests {
    use super::super::panel::{Mark, Series};
    use super::*;

    fn panel(marks: impl IntoIterator<Item = Mark>) -> Panel {
        Panel {
            title: "title".into(),
            x: Axis::linear("x"),
            y: Axis::logarithmic("y"),
            series: marks
                .into_iter()
                .map(|mark| Series::new("name", Colour::Nth(0), mark))
                .collect(),
        }
    }

    fn line(length: usize) -> String {
        (0..length).map(|_| 'm').collect()
    }

    #[test]
    fn titles_shrink_and_are_cut_before_they_leave_the_panel() {
        assert_eq!(heading(&line(40)), (line(40), TITLES[0]));
        assert_eq!(heading(&line(70)).1, TITLES[2]);
        let (cut, size) = heading(&line(500));
        assert!(cut.ends_with('…') && cut.chars().count() < 90 && size == TITLES[3], "{cut}");
    }

    #[test]
    fn what_an_axis_cannot_show_interrupts_lines_and_bands() {
        let gap =
            |y: f64| svg(&[panel([Mark::Line(vec![(0.0, 1.0), (1.0, y), (2.0, 2.0)])])]).unwrap();
        let lines = |svg: &str| svg.matches("<polyline").count();
        assert_eq!(lines(&gap(-1.0)), lines(&gap(f64::NAN)));
        assert_eq!(lines(&gap(-1.0)), lines(&gap(1.5)) + 1);
        let band = |high: f64| {
            let rows = [0.0, 1.0, 2.0, 3.0, 4.0]
                .map(|x| (x, 1.0, if x == 2.0 { high } else { 2.0 }))
                .to_vec();
            svg(&[panel([Mark::Band(rows)])]).unwrap()
        };
        let areas = |svg: &str| svg.matches("<polygon").count();
        assert_eq!((areas(&band(3.0)), areas(&band(f64::NAN))), (1, 2));
    }

    #[test]
    fn a_series_without_values_is_an_entry_of_the_legend() {
        let with = svg(&[panel([Mark::Line(vec![(0.0, 1.0), (1.0, 2.0)]), Mark::Dashed(vec![])])]);
        assert_eq!(with.unwrap().matches("name").count(), 2);
    }

    #[test]
    fn long_tick_labels_get_room() {
        let beside = |range: Range<f64>| room_beside(&Ticks::new(Scale::Logarithmic, &range));
        assert_eq!(beside(0.0..4.0), BESIDE.1);
        assert!(beside(-16.0..-14.5) > BESIDE.1);
    }

    #[test]
    fn a_figure_without_panels_or_values_is_an_error() {
        assert!(svg(&[]).is_err());
        let nothing = panel([Mark::Line(vec![(0.0, -1.0)])]);
        assert!(svg(&[nothing]).unwrap_err().to_string().contains("y: there are no values"));
    }

    #[test]
    fn missing_points_are_ticks_on_the_lower_edge() {
        let rug = |positions: Vec<f64>| {
            let points = Mark::OpenCircles(vec![(0.0, 1.0), (9.0, 10.0)]);
            svg(&[panel([points, Mark::Rug(positions)])]).unwrap().matches("<polyline").count()
        };
        assert_eq!(rug(vec![1.0, 2.0, 5.0]), rug(vec![]) + 3);
    }
}
