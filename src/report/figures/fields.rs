//! Pressure and deformation along a surface.

use super::thinned;
use crate::artifact::{ArrayDataset, Attribute, RunView};
use crate::plot::{Axis, Colour, Figure, Mark, Panel, Points, Series};
use crate::report::ReportError;
use crate::stages::bem::FIELDS;
use crate::stages::realise::{Surface, read_surfaces};
use crate::units::Units;

/// Stretches of a surface that are drawn.
const STRETCHES: usize = 1000;
/// Share of the surface that a close-up shows.
const CLOSE_UP: f64 = 0.06;

/// Pressure and separation of one contact.
struct Field {
    surfaces: String,
    realisation: u32,
    speed_mm_s: f64,
    area: f64,
    spacing_mm: f64,
    /// MPa.
    pressure: Vec<f64>,
    /// mm.
    separation: Vec<f64>,
}

/// The place of a dataset: surfaces, realisation, speed and area.
type Place<'a> = (&'a str, u32, f64, f64);

fn place(name: &str) -> Option<(Place<'_>, &str)> {
    let mut parts = name.split('/');
    let surfaces = parts.next()?;
    let mut part = |prefix: &str| parts.next()?.strip_prefix(prefix);
    let realisation = part("realisation_")?.parse().ok()?;
    let speed = part("speed_")?.strip_suffix("_mm_s")?.parse().ok()?;
    let area = part("area_")?.parse().ok()?;
    Some(((surfaces, realisation, speed, area), parts.next()?))
}

/// For each speed one contact: the surfaces that come last by name, so that measured ones go before sines, the first realisation, the middle one of the areas.
fn fields(run: &RunView) -> Result<Vec<Field>, ReportError> {
    if !run.has(FIELDS)? {
        return Ok(vec![]);
    }
    let datasets = run.read_arrays(FIELDS)?;
    let places: Vec<Place> = datasets
        .iter()
        .filter_map(|dataset| place(&dataset.name))
        .filter(|(_, quantity)| *quantity == "pressure")
        .map(|(place, _)| place)
        .collect();
    let most = places.iter().map(|place| place.0).max();
    let first = places.iter().filter(|p| Some(p.0) == most).map(|p| p.1).min();
    let chosen = places.iter().filter(|p| Some(p.0) == most && Some(p.1) == first);
    let mut chosen: Vec<Place> = chosen.copied().collect();
    chosen.sort_by(|a, b| a.2.total_cmp(&b.2).then(a.3.total_cmp(&b.3)));
    let middles = chosen.chunk_by(|a, b| a.2 == b.2).map(|areas| areas[areas.len() / 2]);
    Ok(middles.filter_map(|place| field(&datasets, place)).collect())
}

fn field(datasets: &[ArrayDataset], wanted: Place<'_>) -> Option<Field> {
    let of = |quantity: &str| {
        datasets.iter().find(|dataset| place(&dataset.name) == Some((wanted, quantity)))
    };
    let (pressure, separation) = (of("pressure")?, of("separation")?);
    let Some(Attribute::Float(spacing)) = pressure.attributes.get("spacing_m") else { return None };
    let (surfaces, realisation, speed_mm_s, area) = wanted;
    Some(Field {
        surfaces: surfaces.to_owned(),
        realisation,
        speed_mm_s,
        area,
        spacing_mm: spacing.m_to_mm(),
        pressure: pressure.values.iter().map(|p| 1e-6 * p).collect(),
        separation: separation.values.iter().map(|u| u.m_to_mm()).collect(),
    })
}

impl Field {
    fn title(&self) -> String {
        let Self { surfaces, realisation, speed_mm_s, area, .. } = self;
        let surfaces = surfaces.replace('_', " ");
        format!("{surfaces}, realisation {realisation}, {speed_mm_s} mm/s, Ac/A0 = {area}")
    }

    fn points(&self, value: impl Fn(usize) -> f64) -> Points {
        (0..self.pressure.len()).map(|i| (self.spacing_mm * i as f64, value(i))).collect()
    }

    /// The points around the largest pressure.
    fn close_up(&self) -> std::ops::Range<usize> {
        let n = self.pressure.len();
        let largest = (0..n).max_by(|a, b| self.pressure[*a].total_cmp(&self.pressure[*b]));
        let width = ((CLOSE_UP * n as f64) as usize).clamp(2, n.max(2));
        let start = largest.unwrap_or(0).saturating_sub(width / 2).min(n.saturating_sub(width));
        start..(start + width).min(n)
    }

    fn panels(&self, y: &Axis, series: &dyn Fn(&Self) -> Vec<(Series, Points)>) -> [Panel; 2] {
        let panel = |title: String, range: std::ops::Range<usize>| Panel {
            title,
            x: Axis::linear("position x / mm"),
            y: y.clone(),
            series: series(self)
                .into_iter()
                .map(|(series, points)| {
                    let points = thinned(&points[range.clone()], STRETCHES);
                    let mark = match series.mark {
                        Mark::Dashed(_) => Mark::Dashed(points),
                        _ => Mark::Line(points),
                    };
                    Series { mark, ..series }
                })
                .collect(),
        };
        [
            panel(self.title(), 0..self.pressure.len()),
            panel(
                format!("Close-up at the largest pressure, {} mm/s", self.speed_mm_s),
                self.close_up(),
            ),
        ]
    }
}

/// Pressure over one period, and around its largest value.
pub(super) fn pressure(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let fields = fields(run)?;
    if fields.is_empty() {
        return Ok(None);
    }
    let series = |field: &Field| {
        let series = Series::unnamed(Colour::Nth(0), Mark::Line(vec![]));
        vec![(series, field.points(|i| field.pressure[i]))]
    };
    let y = Axis::from_zero("contact pressure / MPa");
    Ok(Some(Figure {
        caption: "Contact pressure of the half-space along one period of a realisation, and close \
                  to its largest value."
            .into(),
        panels: fields.iter().flat_map(|field| field.panels(&y, &series)).collect(),
    }))
}

/// Profile and rubber over one period, and around the largest pressure.
pub(super) fn deformation(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let fields = fields(run)?;
    if fields.is_empty() {
        return Ok(None);
    }
    let surfaces = read_surfaces(run)?;
    let series = |field: &Field| {
        let of_field = |surface: &&Surface| {
            surface.kind.file_name() == field.surfaces && surface.realisation == field.realisation
        };
        let Some(surface) = surfaces.iter().find(of_field) else { return vec![] };
        let height = |i: usize| {
            let x = 1e-3 * field.spacing_mm * i as f64;
            surface.profile.iter().map(|wave| wave.height(x)).sum::<f64>().m_to_mm()
        };
        let rubber = Series::new("rubber", Colour::Nth(1), Mark::Line(vec![]));
        let road = Series::new("profile", Colour::Black, Mark::Line(vec![]));
        vec![
            (rubber, field.points(|i| height(i) + field.separation[i])),
            (road, field.points(height)),
        ]
    };
    let y = Axis::linear("height / mm");
    Ok(Some(Figure {
        caption:
            "Deformed rubber on the rigid profile along one period of a realisation, and close \
                  to the largest pressure; the rubber slides to the right."
                .into(),
        panels: fields.iter().flat_map(|field| field.panels(&y, &series)).collect(),
    }))
}
