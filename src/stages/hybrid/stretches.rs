//! One value from those by several stretches of the microscale.

use super::HybridRow;
use crate::numerics::statistics::MeanEstimate;

/// The values of the curves of a surface at one speed, from those by each stretch, which are of the same curves in the same
/// order: the mean over the stretches, with its statistical error. One without friction by any stretch has none.
pub(super) fn combined(by_stretch: &[Vec<HybridRow>]) -> Vec<HybridRow> {
    match by_stretch {
        [] => Vec::new(),
        [only] if only.iter().all(|row| row.microscale_error == Some(0.0)) => only.clone(),
        [first, ..] => (0..first.len())
            .map(|k| {
                let rows: Vec<&HybridRow> = by_stretch.iter().map(|rows| &rows[k]).collect();
                mean(&rows)
            })
            .collect(),
    }
}

fn mean(rows: &[&HybridRow]) -> HybridRow {
    let count = rows.len() as f64;
    let all = |value: fn(&HybridRow) -> Option<f64>| -> Option<Vec<f64>> {
        rows.iter().map(|row| value(row)).collect()
    };
    let known = |value: fn(&HybridRow) -> Option<f64>| {
        all(value).map(|values| values.iter().sum::<f64>() / count)
    };
    let mean =
        |value: fn(&HybridRow) -> f64| rows.iter().map(|row| value(row)).sum::<f64>() / count;
    let largest =
        |value: fn(&HybridRow) -> f64| rows.iter().map(|row| value(row)).fold(0.0, f64::max);
    let least = |value: fn(&HybridRow) -> f64| {
        rows.iter().map(|row| value(row)).fold(f64::INFINITY, f64::min)
    };
    let friction = all(|row| row.friction_coefficient).map(|values| MeanEstimate::of(&values));
    HybridRow {
        friction_coefficient: friction.map(|estimate| estimate.mean),
        microscale_error: friction.map(|e| e.confidence_95).filter(|error| error.is_finite()),
        correction_points: known(|row| row.correction_points),
        correction_force: known(|row| row.correction_force),
        correction_of_area: known(|row| row.correction_of_area),
        interpolation_error: mean(|row| row.interpolation_error),
        discretisation_error: known(|row| row.discretisation_error),
        contact_points_fraction: mean(|row| row.contact_points_fraction),
        load_beyond_full_contact: mean(|row| row.load_beyond_full_contact),
        largest_pressure_mpa: largest(|row| row.largest_pressure_mpa),
        largest_sample_mpa: least(|row| row.largest_sample_mpa),
        residual: largest(|row| row.residual),
        ..rows[0].clone()
    }
}

#[cfg(test)]
mod tests {
    use super::super::uncorrected;
    use super::*;
    use crate::stages::bem::CurveRow;
    use crate::stages::bem::Given;
    use crate::stages::realise::{Method, SurfaceKind};

    fn row(friction: Option<f64>) -> HybridRow {
        let curve = CurveRow {
            kind: SurfaceKind::of(Method::Measured),
            realisation: 1,
            speed_mm_s: 10.0,
            given: Given::Area,
            contact_area_fraction: 0.05,
            pressure_mpa: 1.0,
            friction_coefficient: 0.5,
            interpolation_error: 0.0,
            discretisation_error: None,
            left_out_error: 0.0,
            relative_area_error: None,
        };
        HybridRow { friction_coefficient: friction, microscale_error: None, ..uncorrected(&curve) }
    }

    #[test]
    fn the_mean_over_stretches_has_their_scatter_and_needs_all_of_them() {
        let stretches = [0.3, 0.4, 0.5].map(|friction| vec![row(Some(friction)), row(Some(0.2))]);
        let combined = combined(&stretches);
        let friction = combined[0].friction_coefficient.unwrap();
        approx::assert_relative_eq!(friction, 0.4, max_relative = 1e-12);
        // t(2) = 4.303, s = 0.1.
        let error = combined[0].microscale_error.unwrap();
        approx::assert_relative_eq!(error, 4.303 * 0.1 / 3.0_f64.sqrt(), max_relative = 1e-3);
        assert_eq!(combined.len(), 2);
        let one = super::combined(&[vec![row(Some(0.3))]]);
        assert_eq!((one[0].friction_coefficient, one[0].microscale_error), (Some(0.3), None));
        let missing = super::combined(&[vec![row(Some(0.3))], vec![row(None)]]);
        assert_eq!(missing[0].friction_coefficient, None);
    }
}
