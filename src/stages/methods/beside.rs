//! Averages of the methods beside those of the models of the run.

use super::rows::{MethodCurveRow, MethodFrictionRow};
use super::section::{OlderMethod, ScaleMechanics};
use crate::numerics::statistics::MeanEstimate;
use crate::stages::realise::SurfaceKind;
use crate::stages::tables::{FrictionRow, Model};

/// Seconds of a curve of one realisation, by method and speed.
pub(super) struct CurveSeconds {
    pub method: (OlderMethod, ScaleMechanics, Option<u32>),
    pub kind: SurfaceKind,
    pub speed_mm_s: f64,
    pub seconds: f64,
}

/// Seconds of a curve of one realisation of a model of the tables.
pub(super) struct ModelSeconds {
    pub model: Model,
    pub kind: SurfaceKind,
    pub speed_mm_s: f64,
    pub seconds: f64,
}

impl MethodCurveRow {
    fn method(&self) -> (OlderMethod, ScaleMechanics, Option<u32>) {
        (self.model, self.mechanics, self.split_waves)
    }
}

/// The models of the tables on surfaces of sines, then every method, each at every speed and area or pressure that all of its
/// `realisations` have.
pub(super) fn table(
    curves: &[MethodCurveRow],
    friction: &[FrictionRow],
    times: (&[CurveSeconds], &[ModelSeconds]),
    takes: impl Fn(SurfaceKind) -> bool,
) -> Vec<MethodFrictionRow> {
    let (of_methods, of_models) = times;
    let models = friction.iter().filter(|row| takes(row.kind));
    let mut rows: Vec<MethodFrictionRow> =
        models.clone().map(|row| of_model(row, friction, of_models)).collect();
    let mut open: Vec<&MethodCurveRow> = curves.iter().collect();
    while let Some(first) = open.first().copied() {
        let same = |row: &&MethodCurveRow| {
            (row.method(), row.kind, row.given) == (first.method(), first.kind, first.given)
                && row.speed_mm_s == first.speed_mm_s
                && row.condition() == first.condition()
        };
        let (own, others): (Vec<_>, Vec<_>) = open.into_iter().partition(same);
        open = others;
        let all = curves.iter().filter(|row| row.kind == first.kind).map(|row| row.realisation);
        if Some(own.len() as u32) == all.max() {
            rows.push(of_method(&own, friction, of_methods));
        }
    }
    rows
}

fn of_model(
    row: &FrictionRow,
    friction: &[FrictionRow],
    times: &[ModelSeconds],
) -> MethodFrictionRow {
    let same = |time: &&ModelSeconds| {
        (time.model, time.kind) == (row.model, row.kind) && time.speed_mm_s == row.speed_mm_s
    };
    let reference =
        reference(friction, row.kind, row.speed_mm_s, |other| other.condition() == row.condition());
    // Of `multilevel` the mean is not that of its realisations.
    let paired = if row.model == Model::Multilevel { &[] } else { row.realisations.as_slice() };
    let (from_all_waves, from_all_waves_95) = apart(row.mean, paired, reference);
    MethodFrictionRow {
        model: row.model.name().to_owned(),
        mechanics: None,
        split_waves: None,
        kind: row.kind,
        speed_mm_s: row.speed_mm_s,
        given: row.given,
        contact_area_fraction: row.contact_area_fraction,
        pressure_mpa: row.pressure_mpa,
        realisations: row.realisations.len() as u32,
        mean: row.mean,
        confidence_95: row.confidence_95,
        discretisation_error: row.discretisation_error,
        from_all_waves,
        from_all_waves_95,
        seconds: times.iter().find(same).map(|time| time.seconds),
    }
}

fn of_method(
    own: &[&MethodCurveRow],
    friction: &[FrictionRow],
    times: &[CurveSeconds],
) -> MethodFrictionRow {
    let first = own[0];
    let column = |value: fn(&MethodCurveRow) -> f64| -> Vec<f64> {
        own.iter().map(|row| value(row)).collect()
    };
    let mean = |values: &[f64]| MeanEstimate::of(values).mean;
    let values = column(|row| row.friction_coefficient);
    let estimate = MeanEstimate::of(&values);
    let errors: Option<Vec<f64>> = own.iter().map(|row| row.discretisation_error).collect();
    let same = |time: &&CurveSeconds| {
        (time.method, time.kind) == (first.method(), first.kind)
            && time.speed_mm_s == first.speed_mm_s
    };
    let seconds: Vec<f64> = times.iter().filter(same).map(|time| time.seconds).collect();
    let reference = reference(friction, first.kind, first.speed_mm_s, |other| {
        other.condition() == first.condition()
    });
    let (from_all_waves, from_all_waves_95) = apart(estimate.mean, &values, reference);
    MethodFrictionRow {
        model: first.model.name().to_owned(),
        mechanics: Some(first.mechanics.name().to_owned()),
        split_waves: first.split_waves,
        kind: first.kind,
        speed_mm_s: first.speed_mm_s,
        given: first.given,
        contact_area_fraction: mean(&column(|row| row.contact_area_fraction)),
        pressure_mpa: mean(&column(|row| row.pressure_mpa)),
        realisations: own.len() as u32,
        mean: estimate.mean,
        confidence_95: Some(estimate.confidence_95).filter(|half| half.is_finite()),
        discretisation_error: errors.map(|errors| mean(&errors)),
        from_all_waves,
        from_all_waves_95,
        seconds: (!seconds.is_empty()).then(|| mean(&seconds)),
    }
}

/// All waves at finite deformation at the same place.
fn reference(
    friction: &[FrictionRow],
    kind: SurfaceKind,
    speed_mm_s: f64,
    same: impl Fn(&FrictionRow) -> bool,
) -> Option<&FrictionRow> {
    friction.iter().find(|row| {
        row.model == Model::Fem && row.kind == kind && row.speed_mm_s == speed_mm_s && same(row)
    })
}

/// Relative difference of a mean from the reference, and half width of its interval by the differences of the realisations.
fn apart(mean: f64, values: &[f64], reference: Option<&FrictionRow>) -> (Option<f64>, Option<f64>) {
    let Some(reference) = reference else { return (None, None) };
    let half = (values.len() == reference.realisations.len()).then(|| {
        let pairs = values.iter().zip(&reference.realisations);
        let differences: Vec<f64> = pairs.map(|(value, exact)| value - exact).collect();
        MeanEstimate::of(&differences).confidence_95 / reference.mean.abs()
    });
    (Some(mean / reference.mean - 1.0), half.filter(|half| half.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::bem::Given;
    use approx::assert_relative_eq;

    fn curve(realisation: u32, friction_coefficient: f64, split_waves: u32) -> MethodCurveRow {
        MethodCurveRow {
            model: OlderMethod::Split,
            mechanics: ScaleMechanics::HalfSpace,
            split_waves: Some(split_waves),
            kind: SurfaceKind::sines(3),
            realisation,
            speed_mm_s: 10.0,
            given: Given::Area,
            contact_area_fraction: 0.05,
            pressure_mpa: 0.4,
            friction_coefficient,
            interpolation_error: 0.0,
            discretisation_error: Some(0.01),
            load_beyond_law: 0.0,
        }
    }

    fn all_waves(realisations: &[f64]) -> FrictionRow {
        let estimate = MeanEstimate::of(realisations);
        FrictionRow {
            model: Model::Fem,
            kind: SurfaceKind::sines(3),
            speed_mm_s: 10.0,
            given: Given::Area,
            contact_area_fraction: 0.05,
            shortest_wavelength_mm: 0.1,
            windows: 0,
            realisations: realisations.to_vec(),
            half_space_realisations: None,
            mean: estimate.mean,
            standard_deviation: Some(estimate.standard_deviation),
            confidence_95: Some(estimate.confidence_95),
            scan_error: Some(0.0),
            interpolation_error: 0.0,
            discretisation_error: Some(0.001),
            left_out_error: 0.0,
            microscale_error: None,
            model_error: None,
            error_estimate: None,
            pressure_mpa: 0.4,
            shortest_reliable_wavelength_mm: None,
        }
    }

    #[test]
    fn methods_stand_beside_all_waves_one_realisation_beside_the_other() {
        let curves = [curve(1, 0.6, 1), curve(2, 0.9, 1), curve(1, 0.7, 2)];
        let friction = [all_waves(&[0.5, 0.7])];
        let times = [CurveSeconds {
            method: curves[0].method(),
            kind: curves[0].kind,
            speed_mm_s: 10.0,
            seconds: 2.0,
        }];
        let rows = table(&curves, &friction, (&times, &[]), |_| true);
        // The split after two waves lacks a realisation: its average would be of other surfaces.
        let names: Vec<_> = rows.iter().map(|row| (row.model.as_str(), row.split_waves)).collect();
        assert_eq!(names, [("fem", None), ("split", Some(1))]);
        assert_eq!((rows[0].from_all_waves, rows[0].from_all_waves_95), (Some(0.0), Some(0.0)));
        assert_relative_eq!(rows[1].from_all_waves.unwrap(), 0.25, max_relative = 1e-12);
        // Differences 0.1 and 0.2: t(1) 0.0707 / sqrt 2, over 0.6.
        let half = 12.706_204_736_432_1 * 0.05 / 0.6;
        assert_relative_eq!(rows[1].from_all_waves_95.unwrap(), half, max_relative = 1e-6);
        assert_eq!((rows[1].seconds, rows[1].discretisation_error), (Some(2.0), Some(0.01)));
    }

    #[test]
    fn without_all_waves_nothing_is_compared() {
        let rows = table(&[curve(1, 0.6, 1)], &[], (&[], &[]), |_| true);
        assert_eq!((rows.len(), rows[0].from_all_waves, rows[0].confidence_95), (1, None, None));
    }
}
