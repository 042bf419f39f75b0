//! Contact area over pressure.

use super::{grouped, speed_key};
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages::areal::AREAL_SOLVES;
use crate::stages::bem::SOLVES;
use crate::stages::realise::SurfaceKind;

/// Surfaces, speed, pressure and area of a solved contact.
type Solved = (SurfaceKind, f64, f64, f64);

/// A panel for each kind of surfaces; in it every solved contact, a colour for each speed.
pub(super) fn area(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some(solves) = rows(run, SOLVES)? else { return Ok(None) };
    let areal = rows(run, AREAL_SOLVES)?.unwrap_or_default();
    let of_lines = solves
        .iter()
        .map(|row| (row.kind, row.speed_mm_s, row.pressure_mpa, row.contact_area_fraction));
    let of_maps = areal
        .iter()
        .map(|row| (row.kind, row.speed_mm_s, row.pressure_mpa, row.contact_area_fraction));
    let all: Vec<Solved> = of_lines.chain(of_maps).collect();
    if all.is_empty() {
        return Ok(None);
    }
    let panels = grouped(&all, |row| row.0).into_iter().map(|(kind, rows)| {
        let speeds = grouped(&rows, |row| speed_key(row.1)).into_values().enumerate();
        let series = speeds.map(|(number, rows)| {
            let points = rows.iter().map(|row| (row.2, row.3));
            let label = format!("{} mm/s", rows[0].1);
            Series::new(label, Colour::Nth(number), Mark::OpenCircles(points.collect()))
        });
        Panel {
            title: format!("{kind}, half-space"),
            x: Axis::logarithmic("mean pressure p / MPa"),
            y: Axis::logarithmic("contact area fraction Ac/A0"),
            series: series.collect(),
        }
    });
    let directions =
        if areal.is_empty() { "" } else { "; areal surfaces in all directions of sliding" };
    Ok(Some(Figure {
        caption: format!(
            "Contact area fraction over mean pressure: every solved contact of the half-space{directions}."
        ),
        panels: panels.collect(),
    }))
}
