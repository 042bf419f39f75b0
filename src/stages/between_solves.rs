//! Friction at wanted contact areas and pressures from contacts that were solved at others.

use super::bem::{Given, Wanted};
use super::friction::Condition;
use crate::multiscale::sampling::interpolation_errors;
use crate::numerics::interpolation::CubicHermite;

/// A solved contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SolvedPoint {
    pub pressure_mpa: f64,
    pub friction_coefficient: f64,
    pub contact_area_fraction: f64,
}

/// Friction between solved contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ValueBetween {
    pub given: Given,
    pub contact_area_fraction: f64,
    pub pressure_mpa: f64,
    pub friction_coefficient: f64,
    /// Estimated error by interpolation, absolute.
    pub interpolation_error: f64,
}

impl ValueBetween {
    /// What it is given for.
    pub fn condition(&self) -> Condition {
        Condition::of(self.given, self.contact_area_fraction, self.pressure_mpa)
    }
}

/// Friction at the areas and pressures that lie between contacts at ascending pressures: friction over pressure, at the
/// pressure of the area.
///
/// Nodes come into contact one by one, so that the area stands still from one pressure to the next, or nearly
/// so, and friction as a function of it would have any slope there. Friction over pressure is smooth. The pressure
/// of an area is monotone, from the solves that add some; its error counts by the slope of friction.
pub(crate) fn values_at(wanted: &Wanted, solved: &[SolvedPoint]) -> Vec<ValueBetween> {
    let touching: Vec<SolvedPoint> =
        solved.iter().filter(|point| point.contact_area_fraction > 0.0).copied().collect();
    let mut rising: Vec<SolvedPoint> = Vec::new();
    for point in &touching {
        let before = rising.last().map_or(0.0, |last| last.contact_area_fraction);
        if point.contact_area_fraction > before {
            rising.push(*point);
        }
    }
    let column = |points: &[SolvedPoint], value: fn(&SolvedPoint) -> f64| -> Vec<f64> {
        points.iter().map(value).collect()
    };
    let areas_solved = column(&rising, |point| point.contact_area_fraction);
    let (Some(first), Some(last)) = (areas_solved.first(), areas_solved.last()) else {
        return Vec::new();
    };
    let log_areas: Vec<f64> = areas_solved.iter().map(|area| area.ln()).collect();
    let rising_pressures = column(&rising, |point| point.pressure_mpa.ln());
    let pressure_errors = interpolation_errors(&areas_solved, &rising_pressures);
    let pressure_errors = CubicHermite::linear(log_areas.clone(), pressure_errors);
    let area = CubicHermite::monotone(rising_pressures.clone(), log_areas.clone());
    let pressure = CubicHermite::monotone(log_areas, rising_pressures);
    let pressures = column(&touching, |point| point.pressure_mpa);
    let friction = column(&touching, |point| point.friction_coefficient);
    let log_pressures: Vec<f64> = pressures.iter().map(|pressure| pressure.ln()).collect();
    let errors =
        CubicHermite::linear(log_pressures.clone(), interpolation_errors(&pressures, &friction));
    let friction = CubicHermite::smooth(log_pressures, friction);
    let at_area = |area: &f64| {
        let log_pressure = pressure.at(area.ln());
        let by_area = friction.derivative(log_pressure).abs() * pressure_errors.at(area.ln());
        ValueBetween {
            given: Given::Area,
            contact_area_fraction: *area,
            pressure_mpa: log_pressure.exp(),
            friction_coefficient: friction.at(log_pressure),
            interpolation_error: errors.at(log_pressure) + by_area,
        }
    };
    let at_pressure = |pressure_mpa: &f64| {
        let log_pressure = pressure_mpa.ln();
        ValueBetween {
            given: Given::Pressure,
            contact_area_fraction: area.at(log_pressure).exp(),
            pressure_mpa: *pressure_mpa,
            friction_coefficient: friction.at(log_pressure),
            interpolation_error: errors.at(log_pressure),
        }
    };
    let (least, most) = (pressures[0], pressures[pressures.len() - 1]);
    let areas = wanted.area_fractions.iter().filter(|area| (*first..=*last).contains(*area));
    let reached = wanted.pressures_mpa.iter().filter(|p| (least..=most).contains(*p));
    areas.map(at_area).chain(reached.map(at_pressure)).collect()
}
