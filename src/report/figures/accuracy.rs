//! What accuracy costs, and what the error is made of.

use super::{grouped, heading, speed_key};
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Points, Series};
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages::areal::AREAL_SOLVES;
use crate::stages::bem::{Given, SOLVES};
use crate::stages::fem::{FEM_SOLVES, FemSolveRow};
use crate::stages::micro::SAMPLES;
use crate::stages::multilevel;
use crate::stages::tables::{FRICTION, FrictionRow, Model};

/// Errors below this are round-off; they would stretch the axis.
const LEAST_ERROR: f64 = 1e-12;

/// Seconds of every solve against its estimated error, and the errors of the averages by part.
pub(super) fn accuracy(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let mut panels: Vec<Panel> = solves(run)?.into_iter().collect();
    let friction = rows(run, FRICTION)?.unwrap_or_default();
    let half_space: Vec<FrictionRow> =
        friction.into_iter().filter(|row| row.model == Model::Bem).collect();
    // Values at given pressures lie between those at given areas, with other errors: one line cannot have both.
    let of_areas = half_space.iter().any(|row| row.given == Given::Area);
    let half_space: Vec<FrictionRow> =
        half_space.into_iter().filter(|row| !of_areas || row.given == Given::Area).collect();
    let tables = grouped(&half_space, |row| (row.kind, speed_key(row.speed_mm_s)));
    panels.extend(tables.into_values().filter_map(|rows| parts(&rows)));
    let caption = "Wall time of every contact against the estimated relative error of its friction \
                   by grid or mesh, and the parts of the estimated error of the averaged friction of \
                   the half-space. Parts that are zero are left out."
        .into();
    Ok((!panels.is_empty()).then_some(Figure { caption, panels }))
}

fn solves(run: &RunView) -> Result<Option<Panel>, ReportError> {
    let bem = rows(run, SOLVES)?.unwrap_or_default();
    let areal = rows(run, AREAL_SOLVES)?.unwrap_or_default();
    let micro = rows(run, SAMPLES)?.unwrap_or_default();
    let fem = rows(run, FEM_SOLVES)?.unwrap_or_default();
    let multilevel = rows(run, multilevel::FEM_SOLVES)?.unwrap_or_default();
    let relative = |error: f64, friction: f64, seconds: f64| {
        let error = (error / friction).abs();
        (error.is_finite() && error > LEAST_ERROR && seconds > 0.0).then_some((error, seconds))
    };
    let of_bem = bem.iter().filter_map(|row| {
        relative(row.discretisation_error?, row.friction_coefficient, row.seconds)
    });
    let of_areal = areal.iter().filter_map(|row| {
        relative(row.discretisation_error?, row.friction_coefficient, row.seconds)
    });
    let of_micro = micro.iter().filter_map(|row| {
        let friction = row.friction_finite_deformation;
        relative(friction - row.friction_from_heat, friction, row.seconds)
    });
    let of_all_waves = |row: &FemSolveRow| {
        let friction = row.friction_coefficient;
        relative(friction - row.friction_from_heat, friction, row.seconds)
    };
    let of_fem = fem.iter().filter_map(of_all_waves);
    let of_multilevel = multilevel.iter().filter_map(of_all_waves);
    let kinds: [(&str, usize, Points); 5] = [
        ("half-space, error by the grid", 0, of_bem.collect()),
        ("areal half-space, error by the grid", 3, of_areal.collect()),
        ("microscale, force against heat", 1, of_micro.collect()),
        ("fem, force against heat", 2, of_fem.collect()),
        ("multilevel, force against heat", 4, of_multilevel.collect()),
    ];
    let series: Vec<Series> = kinds
        .into_iter()
        .filter(|(_, _, points)| !points.is_empty())
        .map(|(name, colour, points)| {
            Series::new(name, Colour::Nth(colour), Mark::OpenCircles(points))
        })
        .collect();
    Ok((!series.is_empty()).then(|| Panel {
        title: "Every solved contact".into(),
        x: Axis::logarithmic("estimated relative error of friction"),
        y: Axis::logarithmic("wall time / s"),
        series,
    }))
}

/// Parts of the relative error over contact area; none where none is known.
fn parts(rows: &[&FrictionRow]) -> Option<Panel> {
    type Part = (&'static str, fn(&FrictionRow) -> Option<f64>);
    let parts: [Part; 7] = [
        ("realisations (95 %)", |row| row.confidence_95),
        ("scans (95 %)", |row| row.scan_error),
        ("interpolation", |row| Some(row.interpolation_error)),
        ("grid", |row| row.discretisation_error),
        ("waves left out", |row| Some(row.left_out_error)),
        ("stretches of the microscale", |row| row.microscale_error),
        ("sum", |row| row.error_estimate),
    ];
    let series = parts.into_iter().enumerate().filter_map(|(number, (name, part))| {
        let points: Points = rows
            .iter()
            .filter_map(|row| Some((row.contact_area_fraction, (part(row)? / row.mean).abs())))
            .filter(|(_, error)| error.is_finite() && *error > LEAST_ERROR)
            .collect();
        let is_sum = number + 1 == parts.len();
        let (colour, mark): (_, fn(Points) -> Mark) =
            if is_sum { (Colour::Black, Mark::Dashed) } else { (Colour::Nth(number), Mark::Line) };
        (!points.is_empty()).then(|| Series::new(name, colour, mark(points)))
    });
    let series: Vec<Series> = series.collect();
    (!series.is_empty()).then(|| Panel {
        title: format!("Parts of the error, {}", heading(rows[0].kind, rows[0].speed_mm_s)),
        x: Axis::from_zero("contact area fraction Ac/A0"),
        y: Axis::logarithmic("estimated relative error of friction"),
        series,
    })
}
