//! Figures in SVG.

use super::FrictionTable;
use crate::plot::{COLOURS, FONT, FigureError};
use plotters::prelude::*;

const SIZE: (u32, u32) = (900, 560);

/// Friction over contact area: for each table the average as a line and the 95 % confidence
/// interval of the mean as a band. Returns the SVG.
///
/// # Errors
/// [`FigureError`] if there is nothing to draw or the drawing fails.
pub fn friction_figure(tables: &[FrictionTable]) -> Result<String, FigureError> {
    let rows = || tables.iter().flat_map(|table| &table.rows);
    let upper =
        |row: &crate::stages::tables::FrictionRow| row.mean + row.confidence_95.unwrap_or(0.0);
    let most_area = rows().map(|row| row.contact_area_fraction).fold(0.0, f64::max);
    let most_friction = rows().map(upper).fold(0.0, f64::max);
    if !(most_area > 0.0 && most_friction > 0.0) {
        return Err(FigureError("there is no friction above zero to draw".into()));
    }
    let mut svg = String::new();
    draw(&mut svg, tables, 1.03 * most_area, 1.1 * most_friction)
        .map_err(|error| FigureError(error.to_string()))?;
    Ok(svg)
}

fn draw(
    svg: &mut String,
    tables: &[FrictionTable],
    most_area: f64,
    most_friction: f64,
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(20)
        .margin_right(30)
        .x_label_area_size(55)
        .y_label_area_size(70)
        .build_cartesian_2d(0.0..most_area, 0.0..most_friction)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("contact area fraction Ac/A0")
        .y_desc("friction coefficient")
        .x_label_formatter(&|x| format!("{x:.2}"))
        .y_label_formatter(&|y| format!("{y:.1}"))
        .axis_desc_style((FONT, 18))
        .label_style((FONT, 15))
        .draw()?;
    for (table, colour) in tables.iter().zip(COLOURS.iter().cycle()) {
        let edge = |sign: f64| {
            let at = move |row: &crate::stages::tables::FrictionRow| {
                let half_width = row.confidence_95.unwrap_or(0.0);
                (row.contact_area_fraction, (row.mean + sign * half_width).max(0.0))
            };
            table.rows.iter().map(at).collect::<Vec<_>>()
        };
        let band: Vec<_> = edge(1.0).into_iter().chain(edge(-1.0).into_iter().rev()).collect();
        chart.draw_series([Polygon::new(band, colour.mix(0.15))])?;
        let line = table.rows.iter().map(|row| (row.contact_area_fraction, row.mean));
        let label = format!("{}, {} waves, {} mm/s", table.model, table.waves, table.speed_mm_s);
        let style = colour.stroke_width(2);
        chart
            .draw_series(LineSeries::new(line.clone(), style).point_size(3))?
            .label(label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], style));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .margin(12)
        .legend_area_size(34)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font((FONT, 16))
        .draw()?;
    root.present()?;
    Ok(())
}
