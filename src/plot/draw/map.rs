//! Maps in colours: equal scales along both axes, a colour bar, a scale bar, an arrow, and lines of text below.

use super::super::panel::{Map, Panel};
use super::super::raster::Picture;
use super::super::ticks::{Ticks, round_length};
use super::{
    Area, Coordinate, Drawn, FINE, FONT, LABEL, MARGIN_LEFT, NAME, STROKE, WIDTH, heading,
    room_beside,
};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// Above the map, for the title.
const TOP: u32 = 42 * FINE;
/// Largest width of a map, so that its colour bar has room.
const MOST_WIDTH: u32 = 420 * FINE;
const MOST_HEIGHT: u32 = 420 * FINE;
/// Shortest colour bar.
const LEAST_BAR: u32 = 160 * FINE;
const BAR: u32 = 18 * FINE;
/// Between map and colour bar.
const BETWEEN: u32 = 20 * FINE;
const BELOW: u32 = 44 * FINE;
/// Row of scale bar and arrow.
const KEY: u32 = 48 * FINE;
const NOTE: u32 = 21 * FINE;
/// Longest scale bar as a share of the width of the map.
const SCALE_BAR: f64 = 0.25;
const ARROW: f64 = 18.0 * FINE as f64;

/// Width and height of the map, and height of the plot with the colour bar, in units of the drawing.
fn size(map: &Map) -> (u32, u32, u32) {
    let [x, y] = map.size;
    let scale = (f64::from(MOST_WIDTH) / x).min(f64::from(MOST_HEIGHT) / y);
    let (width, height) = ((scale * x).round() as u32, (scale * y).round() as u32);
    (width, height, height.max(LEAST_BAR))
}

/// Height of its panel.
pub(super) fn height(map: &Map) -> u32 {
    TOP + size(map).2 + BELOW + KEY + NOTE * map.notes.len() as u32
}

/// Draws all but the pictures, which it returns.
pub(super) fn draw(
    area: &Area,
    panel: &Panel,
    map: &Map,
) -> Result<[Picture; 2], Box<dyn std::error::Error>> {
    let (width, height, plot) = size(map);
    let (title, letters) = heading(&panel.title);
    let style = TextStyle::from((FONT, letters).into_font()).pos(Pos::new(HPos::Center, VPos::Top));
    area.draw(&Text::new(title, ((WIDTH / 2) as i32, 14 * FINE as i32), style))?;

    let coordinate =
        |range: Range<f64>, scale| Coordinate { ticks: Ticks::new(scale, &range), range };
    let x = coordinate(0.0..map.size[0], panel.x.scale);
    let y = coordinate(0.0..map.size[1], panel.y.scale);
    let beside = room_beside(&y.ticks);
    let left = MARGIN_LEFT + beside;
    // A flat map is at half the height of its colour bar.
    let top = TOP + (plot - height) / 2;
    let place = area.clone().shrink((MARGIN_LEFT, top), (beside + width, height + BELOW));
    let mut chart = ChartBuilder::on(&place)
        .x_label_area_size(BELOW)
        .y_label_area_size(beside)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(BLACK.stroke_width(FINE))
        .set_all_tick_mark_size(5 * FINE)
        .x_desc(&panel.x.label)
        .y_desc(&panel.y.label)
        .axis_desc_style((FONT, NAME))
        .label_style((FONT, LABEL))
        .draw()?;
    let frame = inside(&chart.plotting_area().get_pixel_range());
    let range = colour_range(map)?;
    let bar_area =
        area.clone().shrink((left + width + BETWEEN, TOP), (WIDTH - left - width - BETWEEN, plot));
    let bar = draw_bar(&bar_area, map, &range)?;
    draw_key(area, map, (left, TOP + plot + BELOW), width)?;
    Ok([Picture::of_map(map, &range, frame)?, Picture::of_bar(bar)?])
}

/// Left, top, width and height of a plot.
fn inside((x, y): &(Range<i32>, Range<i32>)) -> [i32; 4] {
    let (left, right) = (x.start.min(x.end), x.start.max(x.end));
    let (top, bottom) = (y.start.min(y.end), y.start.max(y.end));
    [left, top, right - left, bottom - top]
}

/// The ends of the colours in coordinates: those of the values.
fn colour_range(map: &Map) -> Result<Range<f64>, Box<dyn std::error::Error>> {
    let start = map.colours.start.and_then(|start| map.colours.coordinate(start));
    let coordinates = map.values.iter().filter_map(|value| map.colours.coordinate(*value));
    let (low, high) = coordinates
        .chain(start)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)));
    if low > high {
        return Err(format!("{}: there are no values to draw", map.colours.label).into());
    }
    // One value alone has the middle colour.
    let room = if high > low { 0.0 } else { 0.5 };
    Ok(low - room..high + room)
}

/// Draws the axis of the colours; returns the place of the bar.
fn draw_bar(
    area: &Area,
    map: &Map,
    range: &Range<f64>,
) -> Result<[i32; 4], Box<dyn std::error::Error>> {
    let ticks = Ticks::new(map.colours.scale, range);
    let (width, height) = area.dim_in_pixel();
    let beside = room_beside(&ticks).min(width - BAR);
    let area = area.clone().shrink((0, 0), (BAR + beside, height));
    let colours = Coordinate { ticks, range: range.clone() };
    let across = Coordinate { ticks: Ticks::none(), range: 0.0..1.0 };
    let mut chart = ChartBuilder::on(&area)
        .right_y_label_area_size(beside)
        .build_cartesian_2d(across, colours)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .disable_x_axis()
        .axis_style(BLACK.stroke_width(FINE))
        .set_all_tick_mark_size(5 * FINE)
        .y_desc(&map.colours.label)
        .axis_desc_style((FONT, NAME))
        .label_style((FONT, LABEL))
        .draw()?;
    Ok(inside(&chart.plotting_area().get_pixel_range()))
}

/// Scale bar, arrow and notes.
fn draw_key(area: &Area, map: &Map, (left, top): (u32, u32), width: u32) -> Drawn {
    let (left, top) = (left as i32, top as i32);
    let fine = FINE as i32;
    let text = |text: String, at: (i32, i32), horizontal: HPos| {
        let style =
            TextStyle::from((FONT, LABEL).into_font()).pos(Pos::new(horizontal, VPos::Center));
        area.draw(&Text::new(text, at, style))
    };
    let length = round_length(SCALE_BAR * map.size[0]);
    let drawn = (length / map.size[0] * f64::from(width)).round() as i32;
    let middle = top + (KEY / 2) as i32;
    let bar = [(left, middle - 2 * fine), (left + drawn, middle + 2 * fine)];
    area.draw(&Rectangle::new(bar, BLACK.filled()))?;
    text(format!("{length} {}", map.unit), (left + drawn + 8 * fine, middle), HPos::Left)?;
    if let Some((degrees, label)) = &map.arrow {
        let centre = (left + (width * 2 / 5) as i32, middle);
        draw_arrow(area, centre, degrees.to_radians())?;
        text(label.clone(), (centre.0 + ARROW as i32 + 10 * fine, middle), HPos::Left)?;
    }
    for (number, note) in map.notes.iter().enumerate() {
        let at = top + (KEY + NOTE * number as u32 + NOTE / 2) as i32;
        text(note.clone(), (left, at), HPos::Left)?;
    }
    Ok(())
}

/// An arrow about its centre, at an angle from x towards y.
fn draw_arrow(area: &Area, centre: (i32, i32), angle: f64) -> Drawn {
    let at = |along: f64, across: f64| {
        let x = along * angle.cos() - across * angle.sin();
        let y = along * angle.sin() + across * angle.cos();
        (centre.0 + x.round() as i32, centre.1 - y.round() as i32)
    };
    let line = [at(-ARROW, 0.0), at(0.5 * ARROW, 0.0)];
    area.draw(&PathElement::new(line, BLACK.stroke_width(STROKE)))?;
    let head = [at(ARROW, 0.0), at(0.4 * ARROW, 0.35 * ARROW), at(0.4 * ARROW, -0.35 * ARROW)];
    area.draw(&Polygon::new(head, BLACK))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::super::panel::{Axis, Colour, Mark, Series};
    use super::super::svg;
    use super::*;

    fn map(size: [f64; 2], values: Vec<f64>) -> Map {
        Map {
            cells: [values.len(), 1],
            size,
            unit: "mm",
            values,
            colours: Axis::logarithmic("pressure"),
            arrow: Some((90.0, "slides".into())),
            notes: vec!["a note".into()],
        }
    }

    fn drawn(map: Map) -> Result<String, super::super::FigureError> {
        svg(&[Panel {
            title: "title".into(),
            x: Axis::linear("x"),
            y: Axis::linear("y"),
            series: vec![Series::unnamed(Colour::Black, Mark::Map(map))],
        }])
    }

    #[test]
    fn maps_have_equal_scales_and_fit_their_panel() {
        for size_mm in [[1.0, 1.0], [20.0, 1.0], [0.3, 4.0]] {
            let (width, height, _) = size(&map(size_mm, vec![]));
            assert!(width <= MOST_WIDTH && height <= MOST_HEIGHT);
            let scales = (f64::from(width) / size_mm[0], f64::from(height) / size_mm[1]);
            assert!((scales.0 / scales.1 - 1.0).abs() < 2e-3, "{scales:?}");
            let text = drawn(map(size_mm, vec![1.0, 2.0])).unwrap();
            let image = text.split("<image").nth(1).unwrap();
            assert!(
                image.contains(&format!("width=\"{width}\" height=\"{height}\"")),
                "{size_mm:?}"
            );
        }
    }

    #[test]
    fn one_value_has_a_colour_bar_and_none_is_an_error() {
        let text = drawn(map([1.0, 1.0], vec![3.0, f64::NAN])).unwrap();
        assert_eq!(text.matches("<image").count(), 2);
        for label in ["slides", "a note", "0.2 mm", "pressure"] {
            assert!(text.contains(label), "{label}");
        }
        let nothing = drawn(map([1.0, 1.0], vec![f64::NAN])).unwrap_err().to_string();
        assert!(nothing.contains("pressure: there are no values"), "{nothing}");
    }
}
