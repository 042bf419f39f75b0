//! Friction and contact area of the study of one sine wave, in SVG.

use super::sinusoid::Study;
use crate::plot::{COLOURS, FONT, FigureError};
use crate::stages::sinusoid::{Limit, Model, PointRow};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::ops::Range;

const SIZE: (u32, u32) = (900, 980);

type Panel<'a, 'b, Y> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<plotters::coord::combinators::LogCoord<f64>, Y>>;

/// Friction and contact area over the Deborah number: a colour for each rms slope; the neo-Hookean
/// model as a line, the half-space dashed, the linear rheology as points, Hertz limits as short
/// horizontal lines at the side of fast sliding. Returns the SVG.
///
/// # Errors
/// [`FigureError`] if there is nothing to draw or the drawing fails.
pub fn study_figure(study: &Study) -> Result<String, FigureError> {
    let numbers = || study.points.iter().map(|point| point.deborah_number);
    let (low, high) = (numbers().fold(f64::INFINITY, f64::min), numbers().fold(0.0, f64::max));
    let most = study.points.iter().filter_map(|p| p.friction_coefficient).fold(0.0, f64::max);
    let area = |fold: fn(f64, f64) -> f64, start: f64| {
        study.points.iter().filter_map(|p| p.contact_area_fraction).fold(start, fold)
    };
    let least_area = area(f64::min, f64::INFINITY);
    if !(low < high && most > 0.0 && least_area < area(f64::max, 0.0)) {
        return Err(FigureError("there are no curves over several speeds to draw".into()));
    }
    let mut svg = String::new();
    let across = low / 2.0..high * 2.0;
    draw(&mut svg, study, across, 1.08 * most, least_area / 1.3)
        .map_err(|error| FigureError(error.to_string()))?;
    Ok(svg)
}

fn draw(
    svg: &mut String,
    study: &Study,
    across: Range<f64>,
    most_friction: f64,
    least_area: f64,
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (upper, lower) = root.split_vertically(SIZE.1 / 2);
    let friction = |point: &PointRow| point.friction_coefficient;
    let area = |point: &PointRow| point.contact_area_fraction;

    let mut chart = ChartBuilder::on(&upper)
        .margin(20)
        .margin_right(30)
        .x_label_area_size(55)
        .y_label_area_size(70)
        .build_cartesian_2d(across.clone().log_scale(), 0.0..most_friction)?;
    mesh(&mut chart, "friction coefficient", &|y| format!("{y:.1}"))?;
    curves(&mut chart, study, friction)?;
    models_legend(&mut chart)?;
    slopes_legend(&mut chart, study)?;
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .margin(12)
        .legend_area_size(34)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font((FONT, 15))
        .draw()?;

    let mut chart = ChartBuilder::on(&lower)
        .margin(20)
        .margin_right(30)
        .x_label_area_size(55)
        .y_label_area_size(70)
        .build_cartesian_2d(across.clone().log_scale(), (least_area..1.1).log_scale())?;
    mesh(&mut chart, "contact area fraction Ac/A0", &|y| format!("{y:.2}"))?;
    curves(&mut chart, study, area)?;
    let fast = study.asymptotes.iter().filter(|row| row.limit == Limit::Fast);
    for (row, colour) in fast.zip(COLOURS.iter().cycle()) {
        let line = [across.end / 30.0, across.end].map(|x| (x, row.hertz_area_fraction));
        chart.draw_series(LineSeries::new(line, colour.stroke_width(2)))?;
    }
    root.present()?;
    Ok(())
}

fn mesh<Y>(
    chart: &mut Panel<Y>,
    name: &str,
    format: &dyn Fn(&f64) -> String,
) -> Result<(), Box<dyn std::error::Error>>
where
    Y: Ranged<ValueType = f64> + plotters::coord::ranged1d::ValueFormatter<f64>,
{
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("Deborah number v/v*")
        .y_desc(name)
        .x_label_formatter(&|x| format!("{x:e}"))
        .y_label_formatter(format)
        .axis_desc_style((FONT, 18))
        .label_style((FONT, 15))
        .draw()?;
    Ok(())
}

/// All curves; where a point has no solution a line is interrupted.
fn curves<Y: Ranged<ValueType = f64>>(
    chart: &mut Panel<Y>,
    study: &Study,
    value: fn(&PointRow) -> Option<f64>,
) -> Result<(), Box<dyn std::error::Error>> {
    let slopes = study.points.chunk_by(|a, b| a.aspect_ratio == b.aspect_ratio);
    for (points, colour) in slopes.zip(COLOURS.iter().cycle()) {
        for curve in points.chunk_by(|a, b| a.model == b.model) {
            for part in curve.split(|point| value(point).is_none()) {
                let line = part.iter().filter_map(|p| Some((p.deborah_number, value(p)?)));
                let style = colour.stroke_width(2);
                if curve[0].model == Model::NeoHookean {
                    chart.draw_series(LineSeries::new(line, style))?;
                } else if curve[0].model == Model::HalfSpace {
                    chart.draw_series(DashedLineSeries::new(line, 6, 5, style))?;
                } else {
                    chart.draw_series(line.map(|at| Circle::new(at, 4, style)))?;
                }
            }
        }
    }
    Ok(())
}

/// Entries of the legend without a curve of their own: an empty series carries each.
fn models_legend(chart: &mut Panel<RangedCoordf64>) -> Result<(), Box<dyn std::error::Error>> {
    let nothing = || LineSeries::new(Vec::<(f64, f64)>::new(), BLACK);
    let style = BLACK.stroke_width(2);
    chart
        .draw_series(nothing())?
        .label("neo-Hooke")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], style));
    chart.draw_series(nothing())?.label("half-space").legend(move |(x, y)| {
        plotters::element::DashedPathElement::new([(x, y), (x + 24, y)], 6, 5, style)
    });
    chart
        .draw_series(nothing())?
        .label("linear rheology")
        .legend(move |(x, y)| Circle::new((x + 12, y), 4, style));
    Ok(())
}

fn slopes_legend(
    chart: &mut Panel<RangedCoordf64>,
    study: &Study,
) -> Result<(), Box<dyn std::error::Error>> {
    let slopes = study.points.chunk_by(|a, b| a.aspect_ratio == b.aspect_ratio);
    for (points, colour) in slopes.zip(COLOURS.iter().cycle()) {
        let style = colour.stroke_width(2);
        chart
            .draw_series(LineSeries::new(Vec::<(f64, f64)>::new(), style))?
            .label(format!("rms slope {:.2}", points[0].rms_slope))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], style));
    }
    Ok(())
}
