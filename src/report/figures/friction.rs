//! Friction over contact area.

use super::{grouped, heading};
use crate::artifact::RunView;
use crate::plot::{Axis, Figure, Mark, Panel, Series};
use crate::report::ReportError;
use crate::report::read::rows;
use crate::stages::tables::{COMPARISON, ComparisonRow, FRICTION, FrictionRow, Model};

const AREA: &str = "contact area fraction Ac/A0";
const FRICTION_LABEL: &str = "friction coefficient µ";

/// A panel for each number of waves and speed; in it each model with its band.
pub(super) fn friction(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some(all) = rows(run, FRICTION)? else { return Ok(None) };
    let tables = grouped(&all, |row| (row.waves, super::speed_key(row.speed_mm_s)));
    let panels = tables.into_values().map(|rows| Panel {
        title: heading(rows[0].waves, rows[0].speed_mm_s),
        across: Axis::from_zero(AREA),
        up: Axis::from_zero(FRICTION_LABEL),
        series: rows.chunk_by(|a, b| a.model == b.model).flat_map(model).collect(),
    });
    Ok(Some(Figure {
        caption:
            "Friction coefficient over contact area fraction, averaged over the realisations; \
                  bands are 95 % confidence intervals of the mean, thin points single realisations."
                .into(),
        panels: panels.collect(),
    }))
}

/// Average, band and realisations of a model.
fn model(rows: &[&FrictionRow]) -> Vec<Series> {
    let (colour, dashed) = look(rows[0].model);
    let count = rows[0].realisations.len();
    let average = rows.iter().map(|row| (row.contact_area_fraction, row.mean)).collect();
    let band: Vec<_> = rows
        .iter()
        .filter_map(|row| {
            let half = row.confidence_95?;
            Some((row.contact_area_fraction, (row.mean - half).max(0.0), row.mean + half))
        })
        .collect();
    let mut series = vec![];
    if !band.is_empty() {
        series.push(Series::unnamed(colour, Mark::Band(band)));
    }
    let label = match (rows[0].half_space_realisations, count) {
        (Some(half_space), pairs) => {
            format!("{}, {half_space} of the half-space and {pairs} pairs, 95 %", rows[0].model)
        }
        (None, 0 | 1) => format!("{}, 1 surface", rows[0].model),
        (None, count) => format!("{}, mean of {count}, 95 %", rows[0].model),
    };
    let mark = if dashed { Mark::Dashed(average) } else { Mark::Line(average) };
    series.push(Series::new(label, colour, mark));
    if count > 1 {
        let points = rows.iter().flat_map(|row| {
            row.realisations.iter().map(|friction| (row.contact_area_fraction, *friction))
        });
        series.push(Series::unnamed(colour, Mark::Dots(points.collect())));
    }
    series
}

/// Colour of a model and whether its line is dashed, the same in all figures.
pub(super) fn look(model: Model) -> (usize, bool) {
    match model {
        Model::Bem => (1, false),
        Model::Hybrid => (2, true),
        Model::Fem => (3, false),
        Model::Multilevel => (5, false),
        Model::Persson => (4, true),
        Model::KlueppelHeinrich => (6, true),
    }
}

/// Published friction as discs beside the computed line and its band.
pub(super) fn comparison(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some(all) = rows(run, COMPARISON)? else {
        return Ok(None);
    };
    let tables = all.chunk_by(|a, b| a.published_table == b.published_table);
    let panels = tables.map(|rows| {
        let line = |value: fn(&ComparisonRow) -> f64| -> Vec<_> {
            rows.iter().map(|row| (row.contact_area_fraction, value(row))).collect()
        };
        let band = rows.iter().filter_map(|row| {
            let half = row.confidence_95?;
            Some((row.contact_area_fraction, (row.computed - half).max(0.0), row.computed + half))
        });
        Panel {
            title: format!(
                "{}: {}",
                rows[0].published_table,
                heading(rows[0].waves, rows[0].speed_mm_s)
            ),
            across: Axis::from_zero(AREA),
            up: Axis::from_zero(FRICTION_LABEL),
            series: vec![
                Series::new("95 % interval", 1, Mark::Band(band.collect())),
                Series::new("computed mean", 1, Mark::Line(line(|row| row.computed))),
                Series::new("published mean", 0, Mark::Circles(line(|row| row.published))),
            ],
        }
    });
    Ok(Some(Figure {
        caption: "Computed friction with the 95 % confidence interval of its mean beside the \
                  published averages that the recipe names."
            .into(),
        panels: panels.collect(),
    }))
}
