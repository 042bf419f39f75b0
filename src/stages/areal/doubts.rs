//! What a user is told of the curves.

use super::curve::CurveResult;
use super::{AREAL_UNSOLVED, ArealCurveRow, ArealUnsolvedRow};
use crate::stages::bem::Given;

/// Largest relative error by the grid that is not told of.
const COARSE: f64 = 0.1;

/// Warnings of values that are missing, and of those whose grid is too coarse for them.
pub(super) fn of_curves(results: &[CurveResult]) -> Vec<String> {
    let unsolved: Vec<&ArealUnsolvedRow> = results.iter().flat_map(|r| &r.unsolved).collect();
    let values: Vec<(&ArealCurveRow, f64)> = results
        .iter()
        .flat_map(|result| result.curve.iter().map(|row| (row, result.least_friction)))
        .collect();
    let mut warnings: Vec<String> = missing(&unsolved, values.len()).into_iter().collect();
    warnings.extend(unresolved(&values));
    warnings
}

/// That some values could not be had.
fn missing(unsolved: &[&ArealUnsolvedRow], values: usize) -> Option<String> {
    let first = unsolved.first()?;
    let asked = match first.given {
        Given::Area => format!("area {}", first.contact_area_fraction.unwrap_or_default()),
        Given::Pressure => format!("{} MPa", first.pressure_mpa.unwrap_or_default()),
    };
    Some(format!(
        "{} of {} values of areal surfaces could not be had and are left out ({AREAL_UNSOLVED}); averages over some of the \
         surfaces alone are left out of the tables; the first: {}, realisation {}, {} mm/s at {} degrees, {asked}: {}",
        unsolved.len(),
        unsolved.len() + values,
        first.kind,
        first.realisation,
        first.speed_mm_s,
        first.angle_deg,
        first.reason
    ))
}

/// That grids are too coarse for values, which are given with the least friction that relative errors refer to.
fn unresolved(values: &[(&ArealCurveRow, f64)]) -> Vec<String> {
    let mut warnings = Vec::new();
    let remedy = "raise areal.points_per_shortest_wavelength, or ask for larger areas";
    let unknown = values.iter().filter(|(row, _)| row.discretisation_error.is_none()).count();
    if unknown > 0 {
        warnings.push(format!(
            "{unknown} of {} values of areal surfaces have no estimate of their error by the grid, because coarser grids do \
             not resolve their contacts; {remedy}",
            values.len()
        ));
    }
    let vanishes = |row: &ArealCurveRow, least: f64| row.friction_coefficient.abs() < least;
    let errors = |of_vanishing: bool| -> Vec<(f64, f64)> {
        let own = values.iter().filter(|(row, least)| vanishes(row, *least) == of_vanishing);
        let error = |(row, least): &(&ArealCurveRow, f64)| {
            let error = row.discretisation_error?;
            Some((error, error / row.friction_coefficient.abs().max(*least)))
        };
        own.filter_map(error).filter(|(_, relative)| *relative > COARSE).collect()
    };
    let relative = errors(false);
    let worst = relative.iter().map(|(_, relative)| *relative).fold(0.0, f64::max);
    if worst > 0.0 {
        warnings.push(format!(
            "{} of {} values of areal surfaces have an error by the grid above {:.0} %, up to {:.0} %; {remedy}",
            relative.len(),
            values.len(),
            100.0 * COARSE,
            100.0 * worst
        ));
    }
    let absolute = errors(true);
    let worst = absolute.iter().map(|(error, _)| *error).fold(0.0, f64::max);
    if worst > 0.0 {
        warnings.push(format!(
            "{} of {} values of areal surfaces have next to no friction and an error by the grid of up to {worst:.1e}; {remedy}",
            absolute.len(),
            values.len()
        ));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::realise::{Method, SurfaceKind};

    fn value(friction_coefficient: f64, error: f64) -> ArealCurveRow {
        ArealCurveRow {
            kind: SurfaceKind::of(Method::ArealMeasured),
            realisation: 1,
            speed_mm_s: 10.0,
            angle_deg: 90.0,
            given: Given::Area,
            contact_area_fraction: 0.05,
            pressure_mpa: 0.1,
            friction_coefficient,
            interpolation_error: 0.0,
            discretisation_error: Some(error),
            relative_area_error: None,
        }
    }

    #[test]
    fn errors_of_friction_that_vanishes_are_told_as_they_are() {
        let (usual, nothing) = (value(0.1, 0.02), value(1e-9, 5e-4));
        let told = unresolved(&[(&usual, 1e-3), (&nothing, 1e-3)]);
        assert_eq!(told.len(), 2, "{told:?}");
        assert!(told[0].starts_with("1 of 2") && told[0].contains("up to 20 %"), "{told:?}");
        assert!(told[1].starts_with("1 of 2") && told[1].contains("up to 5.0e-4"), "{told:?}");
        // An error that is small beside the scale of friction is none.
        let small = value(1e-9, 5e-5);
        assert!(unresolved(&[(&small, 1e-3)]).is_empty());
    }
}
