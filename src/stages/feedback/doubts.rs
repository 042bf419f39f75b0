//! What a user is told of the contacts.

use super::laws::Laws;
use super::{ContactRow, Feedback, Task, UNSOLVED, UnsolvedRow};
use crate::contact::refine::LEAST_FRICTION;
use crate::rubber::RubberData;
use crate::units::Units;

/// Largest relative error by the grid that is not told of.
const COARSE: f64 = 0.1;

/// Which contact it was, and why it has no solution.
pub(super) fn named(row: &UnsolvedRow) -> String {
    let UnsolvedRow { kind, realisation, effect, speed_mm_s, pressure_mpa, reason } = row;
    format!(
        "{kind}, realisation {realisation}, {speed_mm_s} mm/s, {pressure_mpa} MPa, {effect}: {reason}"
    )
}

/// Warnings of contacts without a solution, and of those whose grid is too coarse.
pub(super) fn of_contacts(contacts: &[ContactRow], unsolved: &[UnsolvedRow]) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(first) = unsolved.first() {
        warnings.push(format!(
            "{} of {} contacts have no solution ({UNSOLVED}), and averages that lack a surface are left out of the tables; the \
             first: {}",
            unsolved.len(),
            unsolved.len() + contacts.len(),
            named(first)
        ));
    }
    let relative = |row: &ContactRow| {
        let friction =
            row.discretisation_error? / row.friction_coefficient.abs().max(LEAST_FRICTION);
        Some(friction.max(row.relative_area_error?))
    };
    let coarse: Vec<f64> = contacts.iter().filter_map(relative).filter(|e| *e > COARSE).collect();
    let unknown = contacts.iter().filter(|row| row.discretisation_error.is_none()).count();
    let worst = coarse.iter().copied().fold(0.0, f64::max);
    let remedy = "raise bem.points_per_shortest_wavelength";
    if worst > 0.0 {
        warnings.push(format!(
            "{} of {} contacts have an error of friction or area by the grid above {:.0} %, up to {:.0} %; {remedy}",
            coarse.len(),
            contacts.len(),
            100.0 * COARSE,
            100.0 * worst
        ));
    }
    if unknown > 0 {
        warnings.push(format!(
            "{unknown} of {} contacts have no estimate of their error by the grid, because coarser grids do not resolve them; \
             {remedy}",
            contacts.len()
        ));
    }
    warnings
}

/// Warnings of contacts beyond what was measured of the rubber.
pub(super) fn of_laws(
    laws: &Laws,
    material: &RubberData,
    feedback: &Feedback,
    contacts: &[ContactRow],
) -> Vec<String> {
    let most =
        |of: fn(&ContactRow) -> Option<f64>| contacts.iter().filter_map(of).fold(0.0, f64::max);
    let mut warnings =
        laws.extrapolations(most(|row| row.highest_rise_k), most(|row| row.largest_strain));
    let sweeps = material.payne.as_ref().filter(|_| feedback.strain);
    warnings
        .extend(sweeps.zip(material.temperature_c()).and_then(|(payne, c)| payne.extrapolation(c)));
    warnings
}

/// A warning where the rubber slides less than a period: waves along it are taken as steady.
pub(super) fn of_sliding(laws: &Laws, tasks: &[Task]) -> Option<String> {
    let short = |task: &&Task| {
        let distance_mm = laws.sliding_distance_mm(task.speed_mm_s);
        distance_mm.is_some_and(|mm| mm < task.surface.period().m_to_mm())
    };
    let fastest = tasks.iter().filter(short).map(|task| task.speed_mm_s).fold(0.0, f64::max);
    (fastest > 0.0).then(|| {
        format!(
            "up to {fastest} mm/s the rubber slides less than a period of the surfaces: its temperatures there are overestimated, \
             since waves along the period are taken as steady"
        )
    })
}
