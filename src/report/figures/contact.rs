//! Contact area over pressure.

use super::{grouped, speed_key};
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages::bem::SOLVES;

/// A panel for each number of waves; in it every solved contact, a colour for each speed.
pub(super) fn area(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some(solves) = rows(run, SOLVES)? else { return Ok(None) };
    let panels = grouped(&solves, |row| row.kind).into_iter().map(|(kind, rows)| {
        let speeds = grouped(&rows, |row| speed_key(row.speed_mm_s)).into_values().enumerate();
        let series = speeds.map(|(number, rows)| {
            let points = rows.iter().map(|row| (row.pressure_mpa, row.contact_area_fraction));
            let label = format!("{} mm/s", rows[0].speed_mm_s);
            Series::new(label, Colour::Nth(number), Mark::OpenCircles(points.collect()))
        });
        Panel {
            title: format!("{kind}, half-space"),
            x: Axis::logarithmic("mean pressure p / MPa"),
            y: Axis::logarithmic("contact area fraction Ac/A0"),
            series: series.collect(),
        }
    });
    Ok(Some(Figure {
        caption:
            "Contact area fraction over mean pressure: every solved contact of the half-space."
                .into(),
        panels: panels.collect(),
    }))
}
