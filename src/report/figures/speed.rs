//! Friction over speed, the figure of the field.

use super::friction::FRICTION_LABEL;
use super::grouped;
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::report::About;
use crate::report::ReportError;
use crate::report::read::rows;
use crate::report::tables::significant;
use crate::stages::bem::Given;
use crate::stages::tables::{FRICTION, FrictionRow};
use std::collections::BTreeSet;

/// Name of the axis of speeds.
pub(super) const SPEED: &str = "sliding speed v / (mm/s); 1 km/h is 278 mm/s";
/// 1 km/h in mm/s.
const KM_H: f64 = 1e6 / 3600.0;

/// Friction of a run over speed; `None` for a run of one speed.
pub(super) fn speed(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let rows = rows(run, FRICTION)?.unwrap_or_default();
    let rows: Vec<(String, &FrictionRow)> =
        rows.iter().map(|row| (row.model.name().to_owned(), row)).collect();
    let about = About::of(run)?;
    Ok(speed_figure(&rows, &about.material()))
}

/// Friction over speed: a panel for each contact area or pressure, a line for each name and kind of surfaces. `None` for
/// rows of one speed. The title says what all have in common.
pub fn speed_figure(rows: &[(String, &FrictionRow)], title: &str) -> Option<Figure> {
    let speeds: BTreeSet<u64> = rows.iter().map(|(_, row)| row.speed_mm_s.to_bits()).collect();
    if speeds.len() < 2 {
        return None;
    }
    let tables = grouped(rows, |(_, row)| row.condition());
    let panels = tables.values().map(|rows| {
        let first = rows[0].1;
        let condition = match first.given {
            Given::Area => format!("Ac/A0 = {}", first.contact_area_fraction),
            Given::Pressure => format!("{} MPa", first.pressure_mpa),
        };
        let full_name = |(name, row): &(String, &FrictionRow)| {
            let shortest = significant(row.shortest_wavelength_mm);
            format!("{name}, {} from {shortest} mm", row.kind)
        };
        let names = grouped(rows, |named| full_name(named));
        // In the order of the rows, as temperatures are listed.
        let mut order: Vec<String> = Vec::new();
        for named in rows {
            let name = full_name(named);
            if !order.contains(&name) {
                order.push(name);
            }
        }
        let series = order.into_iter().enumerate().flat_map(|(number, name)| {
            let mut own: Vec<&FrictionRow> = names[&name].iter().map(|(_, row)| *row).collect();
            own.sort_by(|a, b| a.speed_mm_s.total_cmp(&b.speed_mm_s));
            let line = own.iter().map(|row| (row.speed_mm_s, row.mean)).collect();
            let band: Vec<(f64, f64, f64)> = own
                .iter()
                .filter_map(|row| {
                    let half = row.confidence_95?;
                    Some((row.speed_mm_s, (row.mean - half).max(0.0), row.mean + half))
                })
                .collect();
            let band =
                (!band.is_empty()).then(|| Series::unnamed(Colour::Nth(number), Mark::Band(band)));
            let line = Series::new(name, Colour::Nth(number), Mark::Line(line));
            band.into_iter().chain([line])
        });
        Panel {
            title: match title {
                "" => condition,
                title => format!("{condition}, {title}"),
            },
            x: Axis::logarithmic(SPEED),
            y: Axis::from_zero(FRICTION_LABEL),
            series: series.collect(),
        }
    });
    let ends = |pick: fn(f64, f64) -> f64, start: f64| {
        rows.iter().map(|(_, row)| row.speed_mm_s).fold(start, pick) / KM_H
    };
    Some(Figure {
        caption: format!(
            "Friction over sliding speed, in the mean over realisations with its 95 % confidence interval, from {:.2e} \
             to {:.2e} km/h.",
            ends(f64::min, f64::INFINITY),
            ends(f64::max, 0.0)
        ),
        panels: panels.collect(),
    })
}
