//! Contact pressure and contact patches of areal surfaces.

use super::patches::Patches;
use crate::artifact::{ArrayDataset, Attribute, RunView};
use crate::plot::{Axis, Colour, Figure, Map, Mark, Panel, Series};
use crate::report::About;
use crate::report::ReportError;
use crate::report::html::number;
use crate::report::read::rows;
use crate::stages::areal::AREAL_FIELDS;
use crate::stages::realise::{AREAL_SURFACES, ArealRow, Method, SurfaceKind};
use crate::units::Units;
use std::collections::BTreeMap;

/// Most cells of a map along a direction.
const MOST_CELLS: usize = 512;

/// Share of the points in contact whose pressures have colours of their own.
const MOST_PRESSURES: f64 = 0.99;

/// Pressure of one contact.
struct Contact {
    kind: SurfaceKind,
    realisation: u32,
    speed_mm_s: f64,
    angle_deg: f64,
    points: [usize; 2],
    periods_mm: [f64; 2],
    mean_pressure_mpa: f64,
    area: f64,
    friction: f64,
    /// MPa, row by row.
    pressure: Vec<f64>,
}

/// What decides between contacts of one speed: the first is shown.
type Rank = (Method, u32, bool, f64);

/// For each speed one contact: of the measured maps where there are any, the first realisation, in the first direction of the
/// recipe, at the smallest area that was kept.
fn contacts(run: &RunView) -> Result<Vec<Contact>, ReportError> {
    if !run.has(AREAL_FIELDS)? {
        return Ok(vec![]);
    }
    let first_angle = About::of(run)?.angle_deg;
    let mut chosen: BTreeMap<u64, (Rank, Contact)> = BTreeMap::new();
    run.visit_arrays(AREAL_FIELDS, |dataset| {
        if !dataset.name.ends_with("/pressure") {
            return;
        }
        let Some(contact) = Contact::of(dataset) else { return };
        let Contact { kind, realisation, angle_deg, area, speed_mm_s, .. } = contact;
        let rank = (kind.method, realisation, Some(angle_deg) != first_angle, area);
        let known = chosen.get(&super::speed_key(speed_mm_s));
        if known.is_none_or(|(best, _)| rank < *best) {
            chosen.insert(super::speed_key(speed_mm_s), (rank, contact));
        }
    })?;
    Ok(chosen.into_values().map(|(_, contact)| contact).collect())
}

impl Contact {
    fn of(dataset: ArrayDataset) -> Option<Self> {
        let float = |key: &str| match dataset.attributes.get(key) {
            Some(Attribute::Float(value)) => Some(*value),
            _ => None,
        };
        let integer = |key: &str| match dataset.attributes.get(key) {
            Some(Attribute::Integer(value)) => u32::try_from(*value).ok(),
            _ => None,
        };
        let Some(Attribute::Text(method)) = dataset.attributes.get("method") else { return None };
        let method = Method::ALL.into_iter().find(|known| known.name() == method)?;
        let points = [integer("points_x")? as usize, integer("points_y")? as usize];
        if points[0] == 0 || points[0] * points[1] != dataset.values.len() {
            return None;
        }
        Some(Self {
            kind: SurfaceKind::of(method),
            realisation: integer("realisation")?,
            speed_mm_s: float("speed_mm_s")?,
            angle_deg: float("angle_deg")?,
            points,
            periods_mm: [float("period_x_m")?.m_to_mm(), float("period_y_m")?.m_to_mm()],
            mean_pressure_mpa: float("mean_pressure_pa")?.pa_to_mpa(),
            area: float("contact_area_fraction")?,
            friction: float("friction_coefficient")?,
            pressure: dataset.values.iter().map(|p| p.pa_to_mpa()).collect(),
        })
    }

    /// Points along a direction that one cell of a picture stands for.
    fn block(&self) -> usize {
        self.points[0].max(self.points[1]).div_ceil(MOST_CELLS)
    }

    /// Cells of a picture: the largest value of each block of points, NaN where all of them are.
    fn cells(&self, values: &[f64]) -> ([usize; 2], Vec<f64>) {
        let (block, [nx, ny]) = (self.block(), self.points);
        let cells = [nx.div_ceil(block), ny.div_ceil(block)];
        let mut largest = vec![f64::NAN; cells[0] * cells[1]];
        for (row, values) in values.chunks_exact(nx).enumerate() {
            for (column, value) in values.iter().enumerate() {
                let cell = &mut largest[cells[0] * (row / block) + column / block];
                *cell = cell.max(*value);
            }
        }
        (cells, largest)
    }

    fn panel(&self, what: &str, values: &[f64], colours: Axis, notes: Vec<String>) -> Panel {
        let Self { kind, realisation, speed_mm_s, angle_deg, .. } = self;
        let (cells, values) = self.cells(values);
        let map = Map {
            cells,
            size: self.periods_mm,
            unit: "mm",
            values,
            colours,
            arrow: Some((*angle_deg, format!("the rubber slides, {angle_deg}° from x"))),
            notes,
        };
        Panel {
            title: format!("{what}, {kind}, realisation {realisation}, {speed_mm_s} mm/s"),
            x: Axis::linear("position x / mm"),
            y: Axis::linear("position y / mm"),
            series: vec![Series::unnamed(Colour::Black, Mark::Map(map))],
        }
    }

    /// Pressures with NaN out of contact, up to one that few exceed, with their largest.
    fn shown_pressure(&self) -> (Vec<f64>, f64) {
        let mut sorted: Vec<f64> = self.pressure.iter().copied().filter(|p| *p > 0.0).collect();
        sorted.sort_by(f64::total_cmp);
        let largest = sorted.last().copied().unwrap_or(0.0);
        let place = (MOST_PRESSURES * sorted.len() as f64) as usize;
        let end = sorted.get(place).copied().unwrap_or(largest);
        let shown = |p: &f64| if *p > 0.0 { p.min(end) } else { f64::NAN };
        (self.pressure.iter().map(shown).collect(), largest)
    }

    /// Pressure, and the patches.
    fn panels(&self, about: &About, shortest_mm: Option<f64>) -> [Panel; 2] {
        let in_contact: Vec<bool> = self.pressure.iter().map(|p| *p > 0.0).collect();
        let patches = Patches::of(&in_contact, self.points);
        let (pressure, largest) = self.shown_pressure();
        let waves = shortest_mm.map(|mm| format!("waves from {} mm, ", number(mm, 3)));
        let of_pressure = vec![
            format!(
                "mean pressure {} MPa, largest {} MPa, Ac/A0 = {}, µ = {}",
                number(self.mean_pressure_mpa, 3),
                number(largest, 3),
                number(self.area, 3),
                number(self.friction, 3)
            ),
            format!("{}{}", waves.unwrap_or_default(), about.material()),
        ];
        let cell_mm2 = self.periods_mm[0] * self.periods_mm[1] / self.pressure.len() as f64;
        let areas: Vec<f64> =
            patches.size_at_points().into_iter().map(|points| points * cell_mm2).collect();
        let of_patches = vec![
            match patches.count() {
                1 => "1 contact patch".to_owned(),
                count => format!("{count} contact patches"),
            },
            format!(
                "the largest has {} % of the contact",
                number(100.0 * patches.largest_share(), 2)
            ),
        ];
        [
            self.panel(
                "Pressure",
                &pressure,
                Axis::from_zero("contact pressure / MPa"),
                of_pressure,
            ),
            self.panel("Patches", &areas, Axis::logarithmic("area of the patch / mm²"), of_patches),
        ]
    }
}

/// Maps of pressure and of patches, for each speed of one contact.
pub(super) fn pressure_map(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let contacts = contacts(run)?;
    let Some(first) = contacts.first() else { return Ok(None) };
    let about = About::of(run)?;
    let surfaces = rows(run, AREAL_SURFACES)?.unwrap_or_default();
    let shortest = |contact: &Contact| {
        let own =
            |row: &&ArealRow| (row.kind, row.realisation) == (contact.kind, contact.realisation);
        surfaces.iter().find(own).map(|row| row.shortest_wavelength_mm)
    };
    let largest = contacts.iter().map(Contact::block).max().unwrap_or(1);
    let blocks = match largest {
        1 => String::new(),
        block => format!(
            " Each cell of a picture is the largest value of {block} × {block} grid points, so that contacts look larger \
             than they are."
        ),
    };
    Ok(Some(Figure {
        caption: format!(
            "Contact of the half-space with one period of {}, realisation {}: pressure, and contact patches coloured by \
             their area, for each speed at the smallest area that was kept. Grey is out of contact; the largest hundredth \
             of the pressures has the last colour. Patches are points in contact that touch along an edge of their grid \
             cells (4 neighbours); surface and contact go on periodically beyond the edges.{blocks}",
            first.kind, first.realisation
        ),
        panels: contacts.iter().flat_map(|one| one.panels(&about, shortest(one))).collect(),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(points: [usize; 2]) -> Contact {
        Contact {
            kind: SurfaceKind::of(Method::ArealMeasured),
            realisation: 1,
            speed_mm_s: 10.0,
            angle_deg: 0.0,
            points,
            periods_mm: [2.0, 1.0],
            mean_pressure_mpa: 0.3,
            area: 0.05,
            friction: 0.4,
            pressure: vec![0.0; points[0] * points[1]],
        }
    }

    #[test]
    fn large_maps_are_shown_by_the_largest_value_of_each_block() {
        let mut large = contact([1030, 5]);
        assert_eq!(large.block(), 3);
        let mut values = vec![f64::NAN; 1030 * 5];
        (values[0], values[1], values[1030 * 4 + 1029]) = (1.0, 3.0, 2.0);
        let (cells, shown) = large.cells(&values);
        assert_eq!(cells, [344, 2]);
        assert_eq!((shown[0], shown[687]), (3.0, 2.0));
        assert_eq!(shown.iter().filter(|value| value.is_nan()).count(), 344 * 2 - 2);
        large.points = [4, 2];
        assert_eq!(large.block(), 1);
    }

    #[test]
    fn notes_state_what_the_contact_is_of() {
        let mut one = contact([4, 2]);
        (one.pressure[0], one.pressure[3], one.pressure[5]) = (1.0, 2.0, 4.0);
        let about = About {
            rubber: "tread".into(),
            temperature_c: Some(20.0),
            tolerance: None,
            angle_deg: Some(0.0),
            thickness_mm: None,
        };
        let [pressure, patches] = one.panels(&about, Some(0.4));
        assert_eq!(pressure.title, "Pressure, measured maps, realisation 1, 10 mm/s");
        let map = |panel: &Panel| match &panel.series[0].mark {
            Mark::Map(map) => map.clone(),
            _ => panic!("no map"),
        };
        assert_eq!(
            map(&pressure).notes,
            [
                "mean pressure 0.300 MPa, largest 4.00 MPa, Ac/A0 = 0.0500, µ = 0.400",
                "waves from 0.400 mm, rubber tread at 20 °C"
            ]
        );
        // The first and the last point of a row are neighbours.
        assert_eq!(
            map(&patches).notes,
            ["2 contact patches", "the largest has 67 % of the contact"]
        );
        assert_eq!(map(&patches).values[0], 0.5);
        assert!(map(&pressure).values[1].is_nan());
    }
}
