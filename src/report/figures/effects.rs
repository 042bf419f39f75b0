//! Friction with the heat and the strain of the contact, and without.

use super::along::{Along, Curve, Place, Value, drawn, horizontal, panels};
use super::grouped;
use crate::artifact::RunView;
use crate::plot::{Axis, Colour, Figure, Panel};
use crate::report::About;
use crate::report::ReportError;
use crate::report::read::rows;
use crate::report::tables::significant;
use crate::stages::bem::Given;
use crate::stages::tables::{EFFECTS, Effect, EffectRow};

/// A quantity of the figure.
struct Quantity {
    axis: &'static str,
    /// What its bands are, in the legend.
    band: &'static str,
    value: fn(&EffectRow) -> Option<Banded>,
}

/// A value and half the width of its band.
type Banded = (f64, Option<f64>);

const QUANTITIES: [Quantity; 2] = [
    Quantity {
        axis: "hysteretic friction coefficient µ",
        band: "95 %",
        value: |row| Some((row.hysteretic, row.confidence_95)),
    },
    Quantity {
        axis: "total friction coefficient µ",
        band: "all errors",
        value: |row| Some((row.total?, row.error_estimate)),
    },
];

/// For each kind of surfaces a panel of the hysteretic and, with adhesion, one of the total friction, at each pressure over
/// the speed, or at each speed over the pressure.
pub(super) fn effects(run: &RunView) -> Result<Option<Figure>, ReportError> {
    let rows = rows(run, EFFECTS)?.unwrap_or_default();
    if rows.is_empty() {
        return Ok(None);
    }
    let about = About::of(run)?;
    let of_kind = grouped(&rows, |row| row.kind);
    let panels = of_kind.values().flat_map(|rows| panels(rows, place));
    let panels = panels.flat_map(|(along, rows)| {
        let own = QUANTITIES.iter().filter_map(|quantity| panel(along, &rows, quantity, &about));
        own.collect::<Vec<_>>()
    });
    let total = if rows.iter().any(|row| row.total.is_some()) {
        " of hysteretic friction, and the error of total friction by all parts but the shear stress"
    } else {
        ""
    };
    Ok(Some(Figure {
        caption: format!(
            "Friction of the half-space cold, softened by strain (soft), heated by the contact (hot), and both (soft-hot), \
             in the mean over the realisations; bands are 95 % confidence intervals of the mean{total}. Values at one pressure alone stand beside each other there."
        ),
        panels: panels.collect(),
    }))
}

fn place(row: &EffectRow) -> Place {
    Place { speed_mm_s: row.speed_mm_s, given: Given::Pressure, value: row.pressure_mpa }
}

/// `None` where no row has the quantity.
fn panel(along: Along, rows: &[&EffectRow], quantity: &Quantity, about: &About) -> Option<Panel> {
    let curve = |effect: Effect| {
        let own = rows.iter().filter(|row| row.effect == effect);
        let value = |row: &&EffectRow| -> Option<Value> {
            let (mean, half) = (quantity.value)(row)?;
            Some((place(row).x(along), mean, half))
        };
        let values: Vec<Value> = own.filter_map(value).collect();
        let (colour, dashed) = look(effect);
        let name = format!("{effect}, {}", quantity.band);
        (!values.is_empty()).then_some(Curve { name, colour, dashed, values })
    };
    let curves: Vec<Curve> = Effect::ALL.into_iter().filter_map(curve).collect();
    let places: Vec<Place> = rows.iter().map(|row| place(row)).collect();
    let first = rows[0];
    (!curves.is_empty()).then(|| Panel {
        title: format!(
            "{}, {} from {} mm, {}",
            places[0].in_common(along),
            first.kind,
            significant(first.shortest_wavelength_mm),
            about.material()
        ),
        x: horizontal(along, &places),
        y: Axis::from_zero(quantity.axis),
        series: drawn(curves),
    })
}

/// Colour of an effect and whether its line is dashed.
fn look(effect: Effect) -> (Colour, bool) {
    let (number, dashed) = match effect {
        Effect::Cold => (0, false),
        Effect::Soft => (2, true),
        Effect::Hot => (1, false),
        Effect::SoftHot => (3, true),
    };
    (Colour::Nth(number), dashed)
}
