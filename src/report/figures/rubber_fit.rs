//! Measured and fitted moduli over frequency, and the shift factors.

use super::rubber::{LOSS, STORAGE, frequencies, moduli, modulus_axis};
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::rubber::ShiftLaw;
use crate::rubber::fit::{MasterCurve, ReducedPoint};
use std::f64::consts::TAU;
use std::ops::Range;

/// Points of the curve of a law.
const CURVE_POINTS: usize = 200;
/// Share of the measured range by which curves are drawn beyond it.
const BEYOND: f64 = 0.06;

/// Storage and loss modulus over frequency at the reference temperature, measured and fitted; below, if
/// there are several temperatures, the shift factors with their laws.
pub fn rubber_fit_figure(fit: &MasterCurve) -> Figure {
    let mut panels = vec![master_curve(fit)];
    if !fit.shifts.is_empty() {
        panels.push(shifts(fit));
    }
    Figure {
        caption:
            "Storage and loss modulus over frequency, circles measured, lines fitted, and the \
                  shift factors over temperature with the laws fitted to them."
                .into(),
        panels,
    }
}

fn master_curve(fit: &MasterCurve) -> Panel {
    let measured = |modulus: fn(&ReducedPoint) -> f64| -> Vec<(f64, f64)> {
        let at = |reduced: &ReducedPoint| {
            (reduced.point.angular_frequency / TAU, 1e-6 * modulus(reduced))
        };
        fit.points.iter().map(at).collect()
    };
    let storage = measured(|reduced| reduced.point.storage_modulus);
    let loss = measured(|reduced| reduced.point.loss_modulus);
    let logarithms: Vec<f64> = storage.iter().chain(&loss).map(|point| point.1.log10()).collect();
    let shown = widened(&logarithms);
    let ends = widened(&[fit.measured.lowest_hz.log10(), fit.measured.highest_hz.log10()]);
    let over = frequencies(10_f64.powf(ends.start), 10_f64.powf(ends.end));
    let fitted =
        moduli(&fit.rubber("", 0.5).rubber, &over, &|modulus| shown.contains(&modulus.log10()));
    let [storage_line, loss_line] = fitted.map(|(name, mark, colour)| {
        Series::new(format!("{name}, {} terms", fit.terms.len()), colour, mark)
    });
    let frequency = match fit.reference_c {
        Some(reference) => format!("frequency f / Hz at {reference} °C"),
        None => "frequency f / Hz".into(),
    };
    Panel {
        title: "Moduli".into(),
        x: Axis::logarithmic(frequency),
        y: modulus_axis(),
        series: vec![
            Series::new("measured E′", STORAGE, Mark::OpenCircles(storage)),
            storage_line,
            Series::new("measured E″", LOSS, Mark::OpenCircles(loss)),
            loss_line,
        ],
    }
}

fn shifts(fit: &MasterCurve) -> Panel {
    let temperatures: Vec<f64> = fit.shifts.iter().map(|shift| shift.temperature_c).collect();
    let over = widened(&temperatures);
    let shown = widened(&fit.shifts.iter().map(|shift| shift.log10_shift).collect::<Vec<_>>());
    let reference = fit.reference_c.unwrap_or_default();
    let mut series: Vec<Series> = vec![];
    for (number, fitted) in fit.laws.iter().enumerate() {
        let temperature =
            |k: usize| over.start + (over.end - over.start) * k as f64 / CURVE_POINTS as f64;
        let line = (0..=CURVE_POINTS).map(temperature).map(|t| {
            let log10 = fitted.law.log10_shift(t, reference);
            (t, if shown.contains(&log10) { log10 } else { f64::NAN })
        });
        let name = match &fitted.law {
            ShiftLaw::Wlf { .. } => "WLF",
            ShiftLaw::Arrhenius { .. } => "Arrhenius",
            ShiftLaw::Table(_) => "table",
        };
        let label = format!("{name}, residual {:.3} decades", fitted.residual_decades);
        series.push(Series::new(label, Colour::Nth(number + 2), Mark::Line(line.collect())));
    }
    let bars = fit.shifts.iter().filter_map(|shift| {
        let half = shift.confidence_95?;
        Some((shift.temperature_c, shift.log10_shift - half, shift.log10_shift + half))
    });
    series.push(Series::unnamed(Colour::Black, Mark::ErrorBars(bars.collect())));
    let factors = fit.shifts.iter().map(|shift| (shift.temperature_c, shift.log10_shift)).collect();
    series.push(Series::new(
        "shift factor, bars: 95 %",
        Colour::Black,
        Mark::FilledCircles(factors),
    ));
    Panel {
        title: "Shift factors".into(),
        x: Axis::linear("temperature / °C"),
        y: Axis::linear("log10 of the shift factor"),
        series,
    }
}

/// From a little below the smallest value to a little above the largest.
fn widened(values: &[f64]) -> Range<f64> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let margin = BEYOND * (high - low).max(0.1);
    low - margin..high + margin
}
