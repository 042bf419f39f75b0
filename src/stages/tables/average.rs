//! Values of friction of every model, and their averages over the realisations.

use super::{FrictionRow, Model, Models};
use crate::artifact::RunView;
use crate::numerics::statistics::MeanEstimate;
use crate::stages::StageError;
use crate::stages::areal::AREAL_CURVES;
use crate::stages::bem::Given;
use crate::stages::friction::{Condition, FrictionAt};
use crate::stages::realise::{ArealRow, SurfaceKind};
use crate::stages::{fem, hybrid};
use std::collections::BTreeMap;

/// The values of every model that solves contacts, in the order of the tables.
pub(super) fn solved(
    models: Models,
    bem: &[FrictionAt],
    areal: &[ArealRow],
    run: &RunView,
) -> Result<Vec<(Model, Vec<FrictionAt>)>, StageError> {
    let mut values = vec![(Model::Bem, bem.to_vec())];
    if let Some(angle_deg) = models.angle_deg {
        let curves = run.rows(AREAL_CURVES)?;
        let first = curves.iter().filter(|row| row.angle_deg == angle_deg);
        values.push((Model::Bem, of_all(first.map(FrictionAt::from).collect(), areal)));
    }
    if models.hybrid.is_some() {
        // Area and pressure are those of the half-space.
        let areas: BTreeMap<_, _> =
            bem.iter().map(|v| (value_key(v), v.relative_area_error)).collect();
        let hybrid = run.rows(hybrid::HYBRID)?;
        let mut corrected: Vec<FrictionAt> =
            hybrid.iter().filter_map(FrictionAt::corrected).collect();
        for value in &mut corrected {
            value.relative_area_error = areas.get(&value_key(value)).copied().flatten();
        }
        values.push((Model::Hybrid, complete(corrected, bem)));
    }
    if models.fem {
        let fem = run.rows(fem::FEM)?;
        values.push((Model::Fem, complete(fem.iter().map(FrictionAt::from).collect(), bem)));
    }
    Ok(values)
}

/// One value of one realisation, whatever model it is of.
fn value_key(value: &FrictionAt) -> (SurfaceKind, u32, u64, Condition) {
    let (kind, speed, condition) = key(value);
    (kind, value.curve.realisation, speed, condition)
}

/// The values at areas for which every realisation of the half-space has one: an average over some of
/// them would be one over the less pressed ones.
fn complete(values: Vec<FrictionAt>, half_space: &[FrictionAt]) -> Vec<FrictionAt> {
    let counts = |values: &[FrictionAt]| {
        let mut counts = BTreeMap::new();
        values.iter().for_each(|value| *counts.entry(key(value)).or_insert(0) += 1);
        counts
    };
    let (present, wanted): (BTreeMap<_, u32>, _) = (counts(&values), counts(half_space));
    let full = |value: &FrictionAt| Some(&present[&key(value)]) == wanted.get(&key(value));
    values.into_iter().filter(full).collect()
}

/// The values that every areal surface of their kind has, for the same reason.
fn of_all(values: Vec<FrictionAt>, surfaces: &[ArealRow]) -> Vec<FrictionAt> {
    let expected = |kind| surfaces.iter().filter(|surface| surface.kind == kind).count();
    let mut present = BTreeMap::new();
    values.iter().for_each(|value| *present.entry(key(value)).or_insert(0) += 1);
    let full = |value: &FrictionAt| present[&key(value)] == expected(value.curve.kind);
    values.into_iter().filter(full).collect()
}

/// What the values of one average have in common.
fn key(value: &FrictionAt) -> (SurfaceKind, u64, Condition) {
    (value.curve.kind, value.curve.speed_mm_s.to_bits(), value.condition())
}

/// One row for each kind of surfaces, speed and area or pressure, ascending.
pub(super) fn average(model: Model, mut curves: Vec<FrictionAt>) -> Vec<FrictionRow> {
    let order = |a: &FrictionAt, b: &FrictionAt| {
        a.curve
            .kind
            .cmp(&b.curve.kind)
            .then(a.curve.speed_mm_s.total_cmp(&b.curve.speed_mm_s))
            .then(a.condition().cmp(&b.condition()))
    };
    curves.sort_by(|a, b| order(a, b).then(a.curve.realisation.cmp(&b.curve.realisation)));
    curves.chunk_by(|a, b| order(a, b).is_eq()).map(|values| row(model, values)).collect()
}

/// An average without what it rests on, see [`Basis::complete`].
fn row(model: Model, curves: &[FrictionAt]) -> FrictionRow {
    let realisations: Vec<f64> = curves.iter().map(|c| c.friction_coefficient).collect();
    let estimate = MeanEstimate::of(&realisations);
    let present = |value: f64| value.is_finite().then_some(value);
    let first = &curves[0];
    let count = curves.len() as f64;
    let mean = |error: fn(&FrictionAt) -> f64| curves.iter().map(error).sum::<f64>() / count;
    let discretisation_error = curves
        .iter()
        .map(|curve| curve.discretisation_error)
        .try_fold(0.0, |sum, error| Some(sum + error? / count));
    let interpolation_error = mean(|curve| curve.interpolation_error);
    let left_out_error = mean(|curve| curve.left_out_error);
    let statistical_error = present(estimate.confidence_95);
    let microscale_error = curves
        .iter()
        .map(|curve| curve.microscale_error)
        .try_fold(0.0, |sum, error| Some(sum + error? / count));
    FrictionRow {
        model,
        kind: first.curve.kind,
        speed_mm_s: first.curve.speed_mm_s,
        given: first.given,
        contact_area_fraction: match first.given {
            Given::Area => first.contact_area_fraction,
            Given::Pressure => mean(|curve| curve.contact_area_fraction),
        },
        shortest_wavelength_mm: 0.0,
        windows: 0,
        realisations,
        half_space_realisations: None,
        mean: estimate.mean,
        standard_deviation: present(estimate.standard_deviation),
        confidence_95: statistical_error,
        scan_error: None,
        interpolation_error,
        discretisation_error,
        left_out_error,
        microscale_error: microscale_error.filter(|_| model == Model::Hybrid),
        model_error: None,
        error_estimate: None,
        pressure_mpa: match first.given {
            Given::Area => mean(|curve| curve.pressure_mpa),
            Given::Pressure => first.pressure_mpa,
        },
        shortest_reliable_wavelength_mm: None,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::basis;
    use super::*;
    use crate::stages::friction::CurveId;

    pub(in crate::stages::tables) fn curve(
        waves: u32,
        realisation: u32,
        area: f64,
        friction: f64,
    ) -> FrictionAt {
        FrictionAt {
            curve: CurveId { kind: SurfaceKind::sines(waves), realisation, speed_mm_s: 10.0 },
            given: Given::Area,
            contact_area_fraction: area,
            pressure_mpa: friction,
            friction_coefficient: friction,
            interpolation_error: friction / 1e3,
            discretisation_error: (realisation < 9).then_some(friction / 2e3),
            left_out_error: 0.0,
            microscale_error: Some(0.0),
            relative_area_error: Some(0.01),
        }
    }

    #[test]
    fn an_average_needs_every_realisation() {
        let values = vec![curve(8, 1, 0.05, 1.0), curve(8, 2, 0.05, 2.0), curve(8, 1, 0.1, 1.0)];
        let half_space = [values.clone(), vec![curve(8, 2, 0.1, 1.0)]].concat();
        let complete = complete(values, &half_space);
        assert_eq!(complete.len(), 2);
        assert!(complete.iter().all(|value| value.contact_area_fraction == 0.05));
    }

    #[test]
    fn rows_are_averaged_over_realisations_whatever_their_order() {
        let mut rows = average(
            Model::Bem,
            vec![
                curve(9, 1, 0.1, 7.0),
                curve(8, 2, 0.1, 3.0),
                curve(8, 1, 0.05, 1.5),
                curve(8, 1, 0.1, 1.0),
                curve(8, 2, 0.05, 2.5),
            ],
        );
        assert_eq!(rows.len(), 3);
        assert_eq!(rows[0].realisations, [1.5, 2.5]);
        assert_eq!((rows[1].mean, rows[1].interpolation_error), (2.0, 2e-3));
        // t(0.975, 1) = 12.7062 in every table.
        let expected = 12.7062 * 2.0_f64.sqrt() / 2.0_f64.sqrt();
        approx::assert_relative_eq!(rows[1].confidence_95.unwrap(), expected, max_relative = 1e-5);
        // Means of grid 1e-3 and of interpolation 2e-3, statistics.
        for row in &mut rows {
            row.scan_error = Some(0.0);
            row.error_estimate = basis::sum_of_errors(row);
        }
        approx::assert_relative_eq!(
            rows[1].error_estimate.unwrap(),
            3e-3 + rows[1].confidence_95.unwrap(),
            max_relative = 1e-12
        );
        assert_eq!((rows[2].kind.waves, rows[2].confidence_95), (9, None));
        assert_eq!((rows[2].discretisation_error, rows[2].error_estimate), (Some(3.5e-3), None));
        let unknown = row(Model::Bem, &[curve(8, 1, 0.1, 1.0), curve(8, 9, 0.1, 1.1)]);
        assert_eq!((unknown.discretisation_error, unknown.error_estimate), (None, None));
    }
}
