//! Friction of one road under the surfaces that stand for it.

use super::friction::{FRICTION_LABEL, abscissa, axis, curve};
use super::{grouped, speed_key};
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Points, Series};
use crate::report::ReportError;
use crate::report::read::rows;
use crate::report::tables::{About, significant};
use crate::stages::realise::{Method, SurfaceKind};
use crate::stages::tables::{FRICTION, FrictionRow, METHODS, MethodRow};

/// Distance between kinds of surfaces that stand beside each other, as a share of the area or pressure.
const BESIDE: f64 = 0.04;

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
    let places = grouped(rows, |row| abscissa(row).to_bits());
    let middle = 0.5 * (kinds.len() as f64 - 1.0);
    let series = kinds.values().enumerate().flat_map(|(number, rows)| {
        let rows: Vec<&FrictionRow> = rows.iter().map(|row| **row).collect();
        let name = match ratio(&rows, compared) {
            Some(ratio) => format!("{}, {ratio:.2} of measured", rows[0].kind),
            None => rows[0].kind.to_string(),
        };
        // At one place alone all kinds would hide each other.
        let shift = if places.len() == 1 { BESIDE * (number as f64 - middle) } else { 0.0 };
        let at = abscissa(rows[0]);
        curve(&rows, &name, Colour::Nth(number), false)
            .into_iter()
            .map(move |series| Series { mark: shifted(series.mark, shift * at), ..series })
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

/// Points and error bars, further to the right.
fn shifted(mark: Mark, by: f64) -> Mark {
    let points =
        |points: Points| -> Points { points.into_iter().map(|(x, y)| (x + by, y)).collect() };
    match mark {
        Mark::FilledCircles(of) => Mark::FilledCircles(points(of)),
        Mark::Dots(of) => Mark::Dots(points(of)),
        Mark::ErrorBars(bars) => {
            Mark::ErrorBars(bars.into_iter().map(|(x, low, high)| (x + by, low, high)).collect())
        }
        other => other,
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
