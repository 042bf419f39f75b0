//! Friction of the cases of a sweep over speed.

use super::SweepFrictionRow;
use crate::plot::Figure;
use crate::report::figures::speed_figure;
use crate::stages::tables::FrictionRow;
use std::collections::BTreeSet;

/// What tells one case from another.
type Part = fn(&SweepFrictionRow) -> String;

/// Friction of the cases of a sweep over speed: a line for each, such as each temperature.
pub fn sweep_speed_figure(rows: &[SweepFrictionRow]) -> Option<Figure> {
    let differ = |value: fn(&SweepFrictionRow) -> String| {
        rows.iter().map(value).collect::<BTreeSet<_>>().len() > 1
    };
    let parts: [(bool, Part); 5] = [
        (differ(|row| row.friction.model.to_string()), |row| row.friction.model.to_string()),
        (differ(specimen), specimen),
        (differ(|row| row.rubber.clone()), |row| row.rubber.clone()),
        (differ(temperature), temperature),
        (differ(|row| row.seed.to_string()), |row| format!("seed {}", row.seed)),
    ];
    let name = |row: &SweepFrictionRow| {
        let told = parts.iter().filter(|(differs, _)| *differs).map(|(_, part)| part(row));
        let told: Vec<String> = told.collect();
        if told.is_empty() { row.friction.model.to_string() } else { told.join(", ") }
    };
    let named: Vec<(String, &FrictionRow)> =
        rows.iter().map(|row| (name(row), &row.friction)).collect();
    speed_figure(&named, "")
}

fn specimen(row: &SweepFrictionRow) -> String {
    row.specimen.clone().unwrap_or_default()
}

fn temperature(row: &SweepFrictionRow) -> String {
    row.temperature_c.map_or_else(String::new, |celsius| format!("{celsius} °C"))
}
