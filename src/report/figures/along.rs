//! Friction over speed, or over contact area or pressure, in panels and curves.

use super::friction::{axis, beside};
use super::grouped;
use super::speed::SPEED;
use crate::plot::{Axis, Colour, Mark, Series};
use crate::stages::bem::Given;
use std::collections::BTreeSet;

/// Where a value of friction belongs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub speed_mm_s: f64,
    pub given: Given,
    /// Contact area fraction or pressure in MPa, as `given` says.
    pub value: f64,
}

/// What the horizontal axis shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Along {
    Speed,
    Condition,
}

impl Place {
    /// On the horizontal axis.
    pub fn x(&self, along: Along) -> f64 {
        match along {
            Along::Speed => self.speed_mm_s,
            Along::Condition => self.value,
        }
    }

    /// What all values of a panel have in common.
    pub fn in_common(&self, along: Along) -> String {
        match (along, self.given) {
            (Along::Speed, Given::Area) => format!("Ac/A0 = {}", self.value),
            (Along::Speed, Given::Pressure) => format!("{} MPa", self.value),
            (Along::Condition, _) => format!("{} mm/s", self.speed_mm_s),
        }
    }
}

/// Rows by panel, with what the horizontal axis shows: the speed where there are at least as many speeds as areas or
/// pressures, and else these.
pub(super) fn panels<'a, R>(
    rows: &[&'a R],
    place: impl Fn(&R) -> Place,
) -> Vec<(Along, Vec<&'a R>)> {
    let count = |of: &dyn Fn(&Place) -> f64| {
        let keys: BTreeSet<u64> = rows.iter().map(|row| of(&place(row)).to_bits()).collect();
        keys.len()
    };
    let (speeds, conditions) = (count(&|place| place.speed_mm_s), count(&|place| place.value));
    let (along, other) = if speeds > 1 && speeds >= conditions {
        (Along::Speed, Along::Condition)
    } else {
        (Along::Condition, Along::Speed)
    };
    // Speeds, areas and pressures are positive, so that their bits sort like themselves.
    let panels = grouped(rows, |row| place(row).x(other).to_bits());
    panels
        .into_values()
        .map(|panel| {
            let mut rows: Vec<&R> = panel.into_iter().copied().collect();
            rows.sort_by(|a, b| place(a).x(along).total_cmp(&place(b).x(along)));
            (along, rows)
        })
        .collect()
}

/// The horizontal axis of values that are all given for the same.
pub(super) fn horizontal(along: Along, places: &[Place]) -> Axis {
    match (along, places.first()) {
        (Along::Condition, Some(first)) => {
            axis(first.given, places.iter().map(|place| place.value))
        }
        _ => Axis::logarithmic(SPEED),
    }
}

/// A value on the horizontal axis, the friction there, and half the width of its interval, if that is known.
pub(super) type Value = (f64, f64, Option<f64>);

/// One line of a panel.
pub(super) struct Curve {
    pub name: String,
    pub colour: Colour,
    pub dashed: bool,
    pub values: Vec<Value>,
}

/// Curves over all of their bands. Where all are one point at one place, the points stand beside each other with error bars.
pub(super) fn drawn(curves: Vec<Curve>) -> Vec<Series> {
    let places: BTreeSet<u64> =
        curves.iter().flat_map(|curve| &curve.values).map(|value| value.0.to_bits()).collect();
    let only = places.first().filter(|_| places.len() == 1).map(|bits| f64::from_bits(*bits));
    let count = curves.len();
    let curves = curves.into_iter().enumerate();
    let series = curves.flat_map(|(number, curve)| beside(one(curve), (number, count), only));
    let (named, bands): (Vec<Series>, Vec<Series>) =
        series.partition(|series| series.label.is_some());
    [bands, named].concat()
}

fn one(curve: Curve) -> Vec<Series> {
    let between = |&(x, mean, half): &Value| Some((x, (mean - half?).max(0.0), mean + half?));
    let band: Vec<_> = curve.values.iter().filter_map(between).collect();
    let line: Vec<_> = curve.values.iter().map(|value| (value.0, value.1)).collect();
    // A line of one point is not seen.
    let single = line.len() == 1;
    let mark = match (single, curve.dashed) {
        (true, _) => Mark::FilledCircles(line),
        (false, true) => Mark::Dashed(line),
        (false, false) => Mark::Line(line),
    };
    let interval = if single { Mark::ErrorBars(band) } else { Mark::Band(band) };
    vec![Series::unnamed(curve.colour, interval), Series::new(curve.name, curve.colour, mark)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(speeds: &[f64], pressures: &[f64]) -> Vec<Place> {
        let of = |&speed_mm_s| {
            let at = move |&value| Place { speed_mm_s, given: Given::Pressure, value };
            pressures.iter().map(at)
        };
        speeds.iter().flat_map(of).collect()
    }

    fn headings(places: &[Place]) -> Vec<String> {
        let all: Vec<&Place> = places.iter().collect();
        let panels = panels(&all, |place| *place);
        panels.iter().map(|(along, rows)| rows[0].in_common(*along)).collect()
    }

    #[test]
    fn the_horizontal_axis_has_that_of_which_there_is_more() {
        let (several, one) = ([1.0, 10.0, 100.0], [0.3]);
        assert_eq!(headings(&places(&several, &one)), ["0.3 MPa"]);
        assert_eq!(headings(&places(&several, &[0.1, 0.3])), ["0.1 MPa", "0.3 MPa"]);
        assert_eq!(headings(&places(&one, &several)), ["0.3 mm/s"]);
        assert_eq!(headings(&places(&one, &one)), ["0.3 mm/s"]);
    }

    #[test]
    fn single_values_stand_beside_each_other_with_error_bars() {
        let curve = |mean: f64| Curve {
            name: "a".into(),
            colour: Colour::Black,
            dashed: false,
            values: vec![(0.3, mean, Some(0.1))],
        };
        let series = drawn(vec![curve(1.0), curve(1.0)]);
        let [Mark::ErrorBars(bars), Mark::FilledCircles(left), Mark::FilledCircles(right)] =
            [0, 2, 3].map(|k| series[k].mark.clone())
        else {
            panic!("{series:?}")
        };
        assert_eq!((bars[0].0, bars[0].1, bars[0].2), (left[0].0, 0.9, 1.1));
        assert!(left[0].0 < 0.3 && right[0].0 > 0.3, "{series:?}");
    }
}
