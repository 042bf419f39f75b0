//! Friction of one road under the surfaces that stand for it.

use super::friction::{FRICTION_LABEL, abscissa, axis, beside, curve, only_place};
use super::{grouped, speed_key};
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Panel};
use crate::report::About;
use crate::report::ReportError;
use crate::report::read::rows;
use crate::report::tables::significant;
use crate::stages::realise::{Method, SurfaceKind};
use crate::stages::tables::{FRICTION, FrictionRow, METHODS, MethodRow};

/// A panel for each model and speed; in it every kind of surfaces, with the ratio of its friction to that of the measured
/// profiles, or of the measured maps where no profile was measured.
pub(super) fn methods(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let Some(compared) = rows(run, METHODS)? else { return Ok(None) };
    let friction = rows(run, FRICTION)?.unwrap_or_default();
    let about = About::of(run)?;
    let tables = grouped(&friction, |row| (row.given, row.model.name(), speed_key(row.speed_mm_s)));
    let several = |rows: &&Vec<&FrictionRow>| rows.iter().any(|row| row.kind != rows[0].kind);
    let panels = tables.values().filter(several).map(|rows| panel(rows, &compared, &about));
    let areal = compared.iter().any(|row| row.kind.method.is_areal());
    Ok(Some(Figure {
        caption: format!(
            "Friction of one road under the surfaces that stand for it, in the mean over realisations, with the 95 % \
             confidence interval of the mean and, in the legend, the mean ratio to the {}. Where friction is given at one \
             area or pressure alone, the surfaces stand beside each other there.{}",
            reference(&compared),
            about.sliding().filter(|_| areal).map_or(String::new(), |text| format!(" {text}"))
        ),
        panels: panels.collect(),
    }))
}

/// The surfaces that all are compared with.
pub(in crate::report) fn reference(compared: &[MethodRow]) -> SurfaceKind {
    let of = |method| compared.iter().any(|row| row.kind.method == method);
    let method = if of(Method::Measured) { Method::Measured } else { Method::ArealMeasured };
    SurfaceKind::of(method)
}

/// Shortest wavelengths of the surfaces, which may be of scans and of maps.
fn shortest(rows: &[&FrictionRow]) -> String {
    let mut shortest: Vec<f64> = rows.iter().map(|row| row.shortest_wavelength_mm).collect();
    shortest.sort_by(f64::total_cmp);
    shortest.dedup();
    shortest.into_iter().map(significant).collect::<Vec<_>>().join(" or ")
}

fn panel(rows: &[&FrictionRow], compared: &[MethodRow], about: &About) -> Panel {
    let kinds = grouped(rows, |row| row.kind);
    let place = only_place(rows);
    let series = kinds.values().enumerate().flat_map(|(number, rows)| {
        let rows: Vec<&FrictionRow> = rows.iter().map(|row| **row).collect();
        let name = match ratio(&rows, compared) {
            Some(ratio) => format!("{}, {ratio:.2} of measured", rows[0].kind),
            None => rows[0].kind.to_string(),
        };
        let series = curve(&rows, &name, Colour::Nth(number), false);
        beside(series, (number, kinds.len()), place)
    });
    Panel {
        title: format!(
            "Model {}, {} mm/s, waves from {} mm, {}",
            rows[0].model,
            rows[0].speed_mm_s,
            shortest(rows),
            about.material()
        ),
        x: axis(rows[0].given, rows.iter().map(|row| abscissa(row))),
        y: Axis::from_zero(FRICTION_LABEL),
        series: series.collect(),
    }
}

/// Mean over the areas or pressures.
fn ratio(rows: &[&FrictionRow], compared: &[MethodRow]) -> Option<f64> {
    let first = rows[0];
    let own: Vec<f64> = compared
        .iter()
        .filter(|row| {
            (row.model, row.kind, row.given) == (first.model, first.kind, first.given)
                && row.speed_mm_s == first.speed_mm_s
        })
        .map(|row| row.ratio_to_measured)
        .collect();
    (!own.is_empty()).then(|| own.iter().sum::<f64>() / own.len() as f64)
}
