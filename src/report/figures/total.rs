//! Hysteresis, the shear of the contact area, and their sum.

use super::along::{Along, Curve, Place, Value, drawn, horizontal, panels};
use super::friction::{FRICTION_LABEL, abscissa_of};
use super::grouped;
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Panel};
use crate::report::About;
use crate::report::ReportError;
use crate::report::read::rows;
use crate::report::tables::significant;
use crate::stages::tables::{FRICTION, FrictionRow, TOTAL, TotalRow};

/// A panel for each model and kind of surfaces, at each area or pressure over the speed, or at each speed over these.
pub(super) fn total(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let totals = rows(run, TOTAL)?.unwrap_or_default();
    if totals.is_empty() {
        return Ok(None);
    }
    let friction = rows(run, FRICTION)?.unwrap_or_default();
    let about = About::of(run)?;
    let tables = grouped(&totals, |row| (row.given, row.model.name(), row.kind));
    let panels = tables.values().flat_map(|rows| panels(rows, place));
    let panels = panels.map(|(along, rows)| panel(along, &rows, &friction, &about)).collect();
    let sliding = about.sliding().filter(|_| totals.iter().any(|row| row.kind.method.is_areal()));
    Ok(Some(Figure {
        caption: format!(
            "Hysteretic friction, friction by the shear of the contact area, and their sum, in the mean over the \
             realisations; bands are 95 % confidence intervals of the mean by the realisations, of the sum by their sums. \
             The error of the shear stress itself is not in them. Values at one area or pressure alone stand beside each \
             other there.{}",
            sliding.map_or(String::new(), |text| format!(" {text}"))
        ),
        panels,
    }))
}

fn place(row: &TotalRow) -> Place {
    let value = abscissa_of(row.given, row.contact_area_fraction, row.pressure_mpa);
    Place { speed_mm_s: row.speed_mm_s, given: row.given, value }
}

fn panel(along: Along, rows: &[&TotalRow], friction: &[FrictionRow], about: &About) -> Panel {
    let places: Vec<Place> = rows.iter().map(|row| place(row)).collect();
    let first = rows[0];
    let curve = |name: &str, colour, dashed, value: &dyn Fn(&TotalRow) -> (f64, Option<f64>)| {
        let at = |row: &&TotalRow| -> Value {
            let (mean, half) = value(row);
            (place(row).x(along), mean, half)
        };
        Curve { name: name.into(), colour, dashed, values: rows.iter().map(at).collect() }
    };
    let interval = |row: &TotalRow| friction.iter().find(|own| same(own, row))?.confidence_95;
    let curves = vec![
        curve("hysteretic, 95 %", Colour::Nth(0), false, &|row| (row.hysteretic, interval(row))),
        curve("adhesive", Colour::Nth(1), true, &|row| (row.adhesive, None)),
        curve("total, 95 %", Colour::Black, false, &|row| (row.total, row.confidence_95)),
    ];
    Panel {
        title: format!(
            "{}, {}, {} from {} mm, {}",
            places[0].in_common(along),
            first.model,
            first.kind,
            significant(first.shortest_wavelength_mm),
            about.material()
        ),
        x: horizontal(along, &places),
        y: Axis::from_zero(FRICTION_LABEL),
        series: drawn(curves),
    }
}

/// Whether a row of hysteretic friction is that of a total.
fn same(own: &FrictionRow, row: &TotalRow) -> bool {
    let value = abscissa_of(own.given, own.contact_area_fraction, own.pressure_mpa);
    (own.model, own.kind, own.given) == (row.model, row.kind, row.given)
        && (own.speed_mm_s, value) == (row.speed_mm_s, place(row).value)
}
