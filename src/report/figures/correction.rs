//! The correction of the half-space by the microscale.

use super::{grouped, speed_key};
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages::hybrid::{HYBRID, HybridRow};
use crate::stages::micro::{SAMPLES, SampleRow};
use crate::stages::realise::SurfaceKind;

/// Friction of the microscale under both models, their difference, and what it makes of the
/// friction of the whole surface.
pub(super) fn correction(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let samples = rows(run, SAMPLES)?.unwrap_or_default();
    if samples.is_empty() {
        return Ok(None);
    }
    let curves = rows(run, HYBRID)?.unwrap_or_default();
    let mut panels = vec![];
    for (kind, rows) in grouped(&samples, |row| row.kind) {
        panels.push(both_models(kind, &rows));
        panels.push(difference(kind, &rows));
    }
    for (kind, rows) in grouped(&curves, |row| row.kind) {
        panels.extend(whole_surface(kind, &rows));
    }
    Ok(Some(Figure {
        caption:
            "The microscale over its mean pressure: friction at finite deformation and on the \
                  half-space, their difference with bars for the estimated error by interpolation, and \
                  what it changes of the friction of every realisation, over its mean pressure."
                .into(),
        panels,
    }))
}

/// The samples of each speed; each realisation is a curve of its own where waves are several.
fn curves<'a>(rows: &[&'a SampleRow]) -> Vec<(Colour, Vec<&'a SampleRow>, bool)> {
    let mut curves = vec![];
    for (number, of_speed) in
        grouped(rows, |row| speed_key(row.speed_mm_s)).into_values().enumerate()
    {
        let realisations = grouped(&of_speed, |row| row.realisation).into_values();
        for (place, mut curve) in
            realisations.map(|c| c.into_iter().map(|r| **r).collect::<Vec<_>>()).enumerate()
        {
            curve.sort_by(|a, b| a.pressure_mpa.total_cmp(&b.pressure_mpa));
            curves.push((Colour::Nth(number), curve, place == 0));
        }
    }
    curves
}

fn named(label: String, first: bool, colour: Colour, mark: Mark) -> Series {
    Series { label: first.then_some(label), colour, mark }
}

fn pressure() -> Axis {
    Axis::logarithmic("mean pressure p / MPa")
}

fn both_models(kind: SurfaceKind, rows: &[&SampleRow]) -> Panel {
    let mut series = vec![];
    for (colour, curve, first) in curves(rows) {
        let line = |value: fn(&SampleRow) -> f64| -> Vec<_> {
            curve.iter().map(|row| (row.pressure_mpa, value(row))).collect()
        };
        let speed = curve[0].speed_mm_s;
        let finite = Mark::Line(line(|row| row.friction_finite_deformation));
        series.push(named(format!("finite deformation, {speed} mm/s"), first, colour, finite));
        let half_space = Mark::Dashed(line(|row| row.friction_half_space));
        series.push(named(format!("half-space, {speed} mm/s"), first, colour, half_space));
    }
    Panel {
        title: format!("Microscale of {kind}"),
        x: pressure(),
        y: Axis::from_zero("friction coefficient µ"),
        series,
    }
}

fn difference(kind: SurfaceKind, rows: &[&SampleRow]) -> Panel {
    let mut series = vec![];
    for (colour, curve, first) in curves(rows) {
        let value = |row: &SampleRow| row.friction_finite_deformation - row.friction_half_space;
        let bars = curve.iter().map(|row| {
            let (value, error) = (value(row), row.interpolation_error);
            (row.pressure_mpa, value - error, value + error)
        });
        series.push(Series::unnamed(colour, Mark::ErrorBars(bars.collect())));
        let line = curve.iter().map(|row| (row.pressure_mpa, value(row))).collect();
        series.push(named(
            format!("{} mm/s", curve[0].speed_mm_s),
            first,
            colour,
            Mark::Line(line),
        ));
    }
    Panel {
        title: format!("Change by finite deformation, {kind}"),
        x: pressure(),
        y: Axis::linear("change of friction Δµ"),
        series,
    }
}

/// Corrections of the realisations; none where no local pressure was sampled.
fn whole_surface(kind: SurfaceKind, rows: &[&HybridRow]) -> Option<Panel> {
    let speeds = grouped(rows, |row| speed_key(row.speed_mm_s)).into_values().enumerate();
    let series: Vec<Series> = speeds
        .map(|(number, rows)| {
            let points = rows.iter().filter_map(|row| {
                Some((row.pressure_mpa, row.friction_coefficient? - row.friction_half_space))
            });
            let label = format!("{} mm/s", rows[0].speed_mm_s);
            Series::new(label, Colour::Nth(number), Mark::OpenCircles(points.collect()))
        })
        .collect();
    let any =
        series.iter().any(|s| matches!(&s.mark, Mark::OpenCircles(points) if !points.is_empty()));
    any.then(|| Panel {
        title: format!("Correction of the surface, {kind}"),
        x: pressure(),
        y: Axis::linear("correction of friction Δµ"),
        series,
    })
}
