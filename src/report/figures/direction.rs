//! Friction of areal surfaces over the direction of sliding.

use super::friction::FRICTION_LABEL;
use super::{grouped, speed_key};
use crate::artifact::RunView;
use crate::numerics::statistics::MeanEstimate;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::report::About;
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages::areal::{AREAL_CURVES, ArealCurveRow};
use crate::stages::bem::Given;
use crate::stages::realise::{AREAL_SURFACES, SurfaceKind};
use std::collections::BTreeMap;

/// The contact area fraction nearest to this is shown.
const AREA: f64 = 0.05;
/// Distance between series at one angle, as a share of the range of the angles.
const BESIDE: f64 = 0.012;

/// The window that every surface is of.
type Windows = BTreeMap<(SurfaceKind, u32), String>;

/// A panel for each speed; in it every kind of surfaces.
pub(super) fn direction(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let curves = rows(run, AREAL_CURVES)?.unwrap_or_default();
    let shown = at_one_condition(&curves);
    let angles = shown.iter().map(|row| row.angle_deg);
    let (low, high) =
        angles.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), a| (low.min(a), high.max(a)));
    if shown.is_empty() || low == high {
        return Ok(None);
    }
    let surfaces = rows(run, AREAL_SURFACES)?.unwrap_or_default();
    let windows: Windows =
        surfaces.into_iter().map(|row| ((row.kind, row.realisation), row.window)).collect();
    let about = About::of(run)?;
    let speeds = grouped(&shown, |row| speed_key(row.speed_mm_s));
    let panels = speeds.values().map(|rows| {
        let kinds = grouped(rows, |row| row.kind);
        let middle = 0.5 * (kinds.len() as f64 - 1.0);
        let series = kinds.values().enumerate().flat_map(|(k, rows)| {
            series(rows, &windows, k, BESIDE * (high - low) * (k as f64 - middle))
        });
        let first = rows[0];
        let condition = match first.given {
            Given::Area => format!("Ac/A0 = {}", first.contact_area_fraction),
            Given::Pressure => format!("{} MPa", first.pressure_mpa),
        };
        Panel {
            title: format!("{} mm/s, {condition}, {}", first.speed_mm_s, about.material()),
            x: Axis::linear("direction of sliding from x towards y / °"),
            y: Axis::from_zero(FRICTION_LABEL),
            series: series.collect(),
        }
    });
    Ok(Some(Figure {
        caption: "Friction of areal surfaces over the direction of sliding, in the mean over realisations with its 95 % \
                  confidence interval by the windows; kinds of surfaces stand beside each other at each direction. The same \
                  windows are slid over in every direction, so that differences between directions can be known better than \
                  the intervals tell."
            .into(),
        panels: panels.collect(),
    }))
}

/// The values at the area nearest to [`AREA`], or at the first pressure where no area is given.
fn at_one_condition(curves: &[ArealCurveRow]) -> Vec<&ArealCurveRow> {
    let far = |row: &&ArealCurveRow| (row.contact_area_fraction / AREA).ln().abs();
    let areas = curves.iter().filter(|row| row.given == Given::Area);
    let nearest = areas.min_by(|a, b| far(a).total_cmp(&far(b)));
    let same = |row: &&ArealCurveRow| match nearest {
        Some(nearest) => {
            row.given == Given::Area && row.contact_area_fraction == nearest.contact_area_fraction
        }
        None => row.pressure_mpa == curves[0].pressure_mpa,
    };
    curves.iter().filter(same).collect()
}

/// Means with their intervals, `shift` degrees beside their directions.
fn series(rows: &[&&&ArealCurveRow], windows: &Windows, colour: usize, shift: f64) -> Vec<Series> {
    let directions = {
        let mut rows: Vec<&ArealCurveRow> =
            rows.iter().map(|row| **row as &ArealCurveRow).collect();
        rows.sort_by(|a, b| a.angle_deg.total_cmp(&b.angle_deg));
        rows
    };
    let (mut means, mut bars) = (vec![], vec![]);
    let of_one = || directions.chunk_by(|a, b| a.angle_deg == b.angle_deg);
    let count = of_one().map(<[_]>::len).max();
    // A mean over some of the surfaces alone is not to be compared with those over all.
    for rows in of_one().filter(|rows| Some(rows.len()) == count) {
        let at = rows[0].angle_deg + shift;
        let estimate = mean(rows, windows);
        means.push((at, estimate.mean));
        if estimate.confidence_95.is_finite() {
            let half = estimate.confidence_95;
            bars.push((at, (estimate.mean - half).max(0.0), estimate.mean + half));
        }
    }
    let colour = Colour::Nth(colour);
    let label = match count {
        None | Some(0 | 1) => format!("{}, 1 surface", directions[0].kind),
        Some(count) => format!("{}, mean of {count}, 95 %", directions[0].kind),
    };
    vec![
        Series::unnamed(colour, Mark::Dotted(means.clone())),
        Series::unnamed(colour, Mark::ErrorBars(bars)),
        Series::new(label, colour, Mark::FilledCircles(means)),
    ]
}

/// Mean over the surfaces. Its interval is that of the means of the windows: draws of one window share its spectrum.
fn mean(rows: &[&ArealCurveRow], windows: &Windows) -> MeanEstimate {
    let values: Vec<f64> = rows.iter().map(|row| row.friction_coefficient).collect();
    let all = MeanEstimate::of(&values);
    if rows.iter().any(|row| !row.kind.method.of_a_window()) {
        return all;
    }
    let of_windows = grouped(rows, |row| windows.get(&(row.kind, row.realisation)));
    let means: Vec<f64> = of_windows
        .values()
        .map(|rows| {
            rows.iter().map(|row| row.friction_coefficient).sum::<f64>() / rows.len() as f64
        })
        .collect();
    MeanEstimate { confidence_95: MeanEstimate::of(&means).confidence_95, ..all }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::realise::Method;

    fn row(method: Method, realisation: u32, area: f64, friction: f64) -> ArealCurveRow {
        ArealCurveRow {
            kind: SurfaceKind::of(method),
            realisation,
            speed_mm_s: 10.0,
            angle_deg: 0.0,
            given: Given::Area,
            contact_area_fraction: area,
            pressure_mpa: 0.3,
            friction_coefficient: friction,
            interpolation_error: 0.0,
            discretisation_error: None,
            relative_area_error: None,
        }
    }

    #[test]
    fn the_area_nearest_to_five_percent_is_shown() {
        let method = Method::ArealMeasured;
        let rows = [0.01, 0.04, 0.1].map(|area| row(method, 1, area, 0.5));
        assert_eq!(at_one_condition(&rows), [&rows[1]]);
        let pressures = [0.2, 0.3].map(|mpa| ArealCurveRow {
            given: Given::Pressure,
            pressure_mpa: mpa,
            ..row(method, 1, 0.05, 0.5)
        });
        assert_eq!(at_one_condition(&pressures), [&pressures[0]]);
        assert!(at_one_condition(&[]).is_empty());
    }

    #[test]
    fn draws_of_one_window_count_once() {
        let method = Method::ArealMatched;
        let draws = [0.4, 0.6, 0.5, 0.7];
        let rows: Vec<ArealCurveRow> =
            (1..).zip(draws).map(|(k, friction)| row(method, k, 0.05, friction)).collect();
        let rows: Vec<&ArealCurveRow> = rows.iter().collect();
        let windows: Windows =
            (1..=4).map(|k| ((SurfaceKind::of(method), k), format!("window {}", k % 2))).collect();
        let estimate = mean(&rows, &windows);
        approx::assert_relative_eq!(estimate.mean, 0.55, max_relative = 1e-12);
        let of_windows = MeanEstimate::of(&[0.45, 0.65]).confidence_95;
        approx::assert_relative_eq!(estimate.confidence_95, of_windows, max_relative = 1e-12);
    }
}
