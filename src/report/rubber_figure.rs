//! Measured and fitted moduli over frequency, and the shift factors, in SVG.

use crate::plot::{COLOURS, FONT, FigureError};
use crate::rubber::fit::{MasterCurve, ReducedPoint};
use crate::rubber::{Rubber, ShiftLaw};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::f64::consts::TAU;
use std::ops::Range;

const PANEL: (u32, u32) = (900, 520);
/// Points of a fitted curve.
const CURVE_POINTS: usize = 400;
/// Share of the measured range by which curves are drawn beyond it, in logarithms.
const BEYOND: f64 = 0.06;

type Drawing<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Storage and loss modulus over frequency at the reference temperature, measured as points and fitted
/// as lines; below, if there are several temperatures, the shift factors with their laws. Returns
/// the SVG.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub fn rubber_figure(fit: &MasterCurve) -> Result<String, FigureError> {
    let mut svg = String::new();
    draw(&mut svg, fit).map_err(|error| FigureError(error.to_string()))?;
    Ok(svg)
}

fn draw(svg: &mut String, fit: &MasterCurve) -> Drawn {
    let panels = if fit.shifts.is_empty() { 1 } else { 2 };
    let root = SVGBackend::with_string(svg, (PANEL.0, PANEL.1 * panels)).into_drawing_area();
    root.fill(&WHITE)?;
    let areas = root.split_evenly((panels as usize, 1));
    moduli(&areas[0], fit)?;
    if let Some(area) = areas.get(1) {
        shifts(area, fit)?;
    }
    root.present()?;
    Ok(())
}

fn moduli(area: &Drawing, fit: &MasterCurve) -> Drawn {
    let across = widened(&[fit.measured.lowest_hz, fit.measured.highest_hz]);
    let rubber = fit.rubber("", 0.5).rubber;
    let measured = fit.points.iter().flat_map(|reduced| {
        [reduced.point.storage_modulus / 1e6, reduced.point.loss_modulus / 1e6]
    });
    let up = widened(&measured.collect::<Vec<_>>());
    let mut chart = ChartBuilder::on(area)
        .margin(20)
        .margin_right(30)
        .x_label_area_size(55)
        .y_label_area_size(80)
        .build_cartesian_2d(across.clone().log_scale(), up.clone().log_scale())?;
    let frequency = match fit.reference_c {
        Some(reference) => format!("frequency / Hz at {reference} °C"),
        None => "frequency / Hz".into(),
    };
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc(frequency)
        .y_desc("Young's modulus / MPa")
        .x_label_formatter(&|x| format!("{x:e}"))
        .y_label_formatter(&|y| format!("{y}"))
        .axis_desc_style((FONT, 18))
        .label_style((FONT, 15))
        .draw()?;
    type Part = (&'static str, fn(&ReducedPoint) -> f64, fn(&Rubber, f64) -> f64);
    let parts: [Part; 2] = [
        ("storage E'", |r| r.point.storage_modulus, |rubber, w| rubber.complex_modulus(w).re),
        ("loss E''", |r| r.point.loss_modulus, |rubber, w| rubber.complex_modulus(w).im),
    ];
    for ((name, of_point, of_rubber), colour) in parts.into_iter().zip(COLOURS) {
        let at = |reduced: &ReducedPoint| {
            (reduced.point.angular_frequency / TAU, of_point(reduced) / 1e6)
        };
        let points = fit.points.iter().map(|r| Circle::new(at(r), 3, colour.mix(0.6)));
        chart.draw_series(points)?;
        let style = colour.stroke_width(2);
        // What leaves the panel would be drawn along its edge.
        let line = logarithmic(&across)
            .map(|f| (f, of_rubber(&rubber, TAU * f) / 1e6))
            .filter(|(_, modulus)| up.contains(modulus));
        chart
            .draw_series(LineSeries::new(line, style))?
            .label(format!("{name}: points measured, line of {} terms", fit.terms.len()))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], style));
    }
    legend(&mut chart, SeriesLabelPosition::UpperLeft)
}

fn shifts(area: &Drawing, fit: &MasterCurve) -> Drawn {
    let temperatures: Vec<f64> = fit.shifts.iter().map(|shift| shift.temperature_c).collect();
    let across = padded(&temperatures);
    let up = padded(&fit.shifts.iter().map(|shift| shift.log10_shift).collect::<Vec<_>>());
    let mut chart = ChartBuilder::on(area)
        .margin(20)
        .margin_right(30)
        .x_label_area_size(55)
        .y_label_area_size(80)
        .build_cartesian_2d(across.clone(), up.clone())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("temperature / °C")
        .y_desc("log10 of the shift factor")
        .axis_desc_style((FONT, 18))
        .label_style((FONT, 15))
        .draw()?;
    let reference = fit.reference_c.unwrap_or_default();
    for (fitted, colour) in fit.laws.iter().zip(&COLOURS[2..]) {
        let style = colour.stroke_width(2);
        let (from, to) = (across.start, across.end);
        let temperature = |k: usize| from + (to - from) * k as f64 / CURVE_POINTS as f64;
        let line = (0..=CURVE_POINTS).map(temperature);
        let line = line
            .map(|t| (t, fitted.law.log10_shift(t, reference)))
            .filter(|(_, log10)| up.contains(log10));
        let name = match fitted.law {
            ShiftLaw::Wlf { .. } => "WLF",
            ShiftLaw::Arrhenius { .. } => "Arrhenius",
        };
        chart
            .draw_series(LineSeries::new(line, style))?
            .label(format!("{name}, residual {:.3} decades", fitted.residual_decades))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], style));
    }
    chart.draw_series(fit.shifts.iter().map(|shift| {
        let half = shift.confidence_95.unwrap_or(0.0);
        let ends = [shift.log10_shift - half, shift.log10_shift + half];
        PathElement::new(ends.map(|log10| (shift.temperature_c, log10)), BLACK)
    }))?;
    chart.draw_series(
        fit.shifts
            .iter()
            .map(|shift| Circle::new((shift.temperature_c, shift.log10_shift), 4, BLACK.filled())),
    )?;
    legend(&mut chart, SeriesLabelPosition::UpperRight)
}

fn legend<'a, 'b: 'a, X, Y>(
    chart: &mut ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>,
    position: SeriesLabelPosition,
) -> Drawn
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    chart
        .configure_series_labels()
        .position(position)
        .margin(12)
        .legend_area_size(34)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font((FONT, 15))
        .draw()?;
    Ok(())
}

fn padded(values: &[f64]) -> Range<f64> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let margin = BEYOND * (high - low).max(0.1);
    low - margin..high + margin
}

fn widened(values: &[f64]) -> Range<f64> {
    let range = padded(&values.iter().map(|value| value.log10()).collect::<Vec<_>>());
    10_f64.powf(range.start)..10_f64.powf(range.end)
}

fn logarithmic(range: &Range<f64>) -> impl Iterator<Item = f64> + use<> {
    let (from, to) = (range.start.ln(), range.end.ln());
    (0..=CURVE_POINTS).map(move |k| (from + (to - from) * k as f64 / CURVE_POINTS as f64).exp())
}
