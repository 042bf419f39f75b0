//! What the error of friction is made of.

use super::friction::{abscissa_of, axis};
use super::{grouped, speed_key};
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Series};
use crate::report::About;
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages::tables::{BUDGET, BudgetRow, Part};
use std::collections::BTreeMap;

/// Half the width of the bar of a single area or pressure, relative to it.
const BAR: f64 = 0.05;

/// A panel for each model, kind of surfaces and speed: the parts of the error one above the other.
pub(super) fn budget(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some(all) = rows(run, BUDGET)? else { return Ok(None) };
    let about = About::of(run)?;
    let key = |row: &BudgetRow| (row.given, row.model.name(), row.kind, speed_key(row.speed_mm_s));
    let panels: Vec<Panel> =
        grouped(&all, key).values().filter_map(|rows| panel(rows, &about)).collect();
    let caption = "Parts of the error of the averaged friction, relative to it, one above the other: the largest at the \
                   bottom. Parts that are not known are not drawn."
        .into();
    Ok((!panels.is_empty()).then_some(Figure { caption, panels }))
}

fn panel(rows: &[&BudgetRow], about: &About) -> Option<Panel> {
    let place =
        |row: &BudgetRow| abscissa_of(row.given, row.contact_area_fraction, row.pressure_mpa);
    // The largest part in the mean over the areas comes first.
    let mut sums: BTreeMap<Part, f64> = BTreeMap::new();
    for row in rows {
        *sums.entry(row.part).or_default() += row.relative_error.unwrap_or(0.0);
    }
    let mut parts: Vec<Part> = sums.keys().copied().filter(|part| sums[part] > 0.0).collect();
    parts.sort_by(|a, b| sums[b].total_cmp(&sums[a]));
    let mut places: Vec<f64> = rows.iter().map(|row| place(row)).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let percent = |x: f64, part: Part| {
        let own = rows.iter().find(|row| place(row) == x && row.part == part);
        100.0 * own.and_then(|row| row.relative_error).unwrap_or(0.0)
    };
    let mut floor = vec![0.0; places.len()];
    let series = parts.iter().enumerate().map(|(number, part)| {
        let mut band = Vec::with_capacity(places.len());
        for (x, low) in places.iter().zip(&mut floor) {
            let high = *low + percent(*x, *part);
            band.push((*x, *low, high));
            *low = high;
        }
        if let [(x, low, high)] = band[..] {
            band = vec![(x * (1.0 - BAR), low, high), (x * (1.0 + BAR), low, high)];
        }
        Series::new(part.name(), Colour::Nth(number), Mark::Band(band))
    });
    let series: Vec<Series> = series.collect();
    let first = rows.first()?;
    (!series.is_empty()).then(|| Panel {
        title: format!(
            "Model {}, {}, {} mm/s, {}",
            first.model,
            first.kind,
            first.speed_mm_s,
            about.material()
        ),
        x: axis(first.given, places.iter().copied()),
        y: Axis::from_zero("error of friction / %"),
        series,
    })
}
