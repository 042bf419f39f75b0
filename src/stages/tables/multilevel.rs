//! The averages of the stage multilevel as rows of the friction tables.

use super::{FrictionRow, Model};
use crate::artifact::{ArtifactError, RunView};
use crate::numerics::statistics::MeanEstimate;
use crate::stages::bem::Given;
use crate::stages::multilevel::{AVERAGES, AverageRow, PAIRS, PairRow};

/// The rows of the model `multilevel`: the realisations that were solved at finite deformation, and the
/// average, which rests on those of the half-space too.
pub(super) fn read(run: &RunView) -> Result<Vec<FrictionRow>, ArtifactError> {
    let averages = run.rows(AVERAGES)?;
    let pairs = run.rows(PAIRS)?;
    let mut rows: Vec<FrictionRow> =
        averages.iter().map(|average| row(average, &realisations(average, &pairs))).collect();
    rows.sort_by(|a, b| {
        a.kind
            .cmp(&b.kind)
            .then(a.speed_mm_s.total_cmp(&b.speed_mm_s))
            .then(a.contact_area_fraction.total_cmp(&b.contact_area_fraction))
    });
    Ok(rows)
}

/// Friction at finite deformation of the pairs of an average, in the order of the realisations.
fn realisations(average: &AverageRow, pairs: &[PairRow]) -> Vec<f64> {
    let own = |pair: &&PairRow| {
        (pair.kind, pair.speed_mm_s) == (average.kind, average.speed_mm_s)
            && pair.contact_area_fraction == average.contact_area_fraction
    };
    let mut own: Vec<&PairRow> = pairs.iter().filter(own).collect();
    own.sort_by_key(|pair| pair.realisation);
    own.iter().map(|pair| pair.friction_finite_deformation).collect()
}

fn row(average: &AverageRow, realisations: &[f64]) -> FrictionRow {
    let deviation = MeanEstimate::of(realisations).standard_deviation;
    FrictionRow {
        model: Model::Multilevel,
        kind: average.kind,
        speed_mm_s: average.speed_mm_s,
        given: Given::Area,
        contact_area_fraction: average.contact_area_fraction,
        shortest_wavelength_mm: 0.0,
        windows: 0,
        realisations: realisations.to_vec(),
        half_space_realisations: Some(average.half_space_realisations),
        mean: average.friction_coefficient,
        standard_deviation: deviation.is_finite().then_some(deviation),
        confidence_95: average.confidence_95,
        scan_error: None,
        interpolation_error: average.interpolation_error,
        discretisation_error: average.discretisation_error,
        left_out_error: average.left_out_error,
        microscale_error: None,
        model_error: Some(average.model_error),
        error_estimate: average.error_estimate,
        pressure_mpa: average.pressure_mpa,
        shortest_reliable_wavelength_mm: None,
    }
}
