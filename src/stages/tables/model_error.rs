//! How far the hybrid is from what it approximates.

use super::{FEM, FrictionRow, HYBRID};

/// Error of the hybrid where the run does not have all waves at finite deformation, as a share of friction: the
/// largest of the averages that were measured on surfaces of eight waves, 0.249 (docs/all_waves.md).
const MEASURED_ELSEWHERE: f64 = 0.25;

/// Gives every average of the hybrid its model error, and the sum of its errors with it: the difference to all
/// waves at finite deformation of the same realisations, or the share measured elsewhere.
pub(super) fn add(rows: &mut [FrictionRow]) {
    let known: Vec<FrictionRow> = rows.iter().filter(|row| row.model == FEM).cloned().collect();
    for row in rows.iter_mut().filter(|row| row.model == HYBRID) {
        let same = known.iter().find(|fem| {
            fem.waves == row.waves
                && fem.speed_mm_s == row.speed_mm_s
                && fem.contact_area_fraction == row.contact_area_fraction
        });
        let error = match same {
            Some(fem) => (row.mean - fem.mean).abs() + fem.discretisation_error.unwrap_or(0.0),
            None => MEASURED_ELSEWHERE * row.mean.abs(),
        };
        row.model_error = Some(error);
        row.error_estimate = row.error_estimate.map(|others| others + error);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::curve;
    use super::super::{BEM, average};
    use super::*;

    #[test]
    fn the_difference_of_this_run_counts_and_elsewhere_the_measured_share() {
        let values = |friction: f64, areas: &[f64]| {
            let of = |area: &f64| [curve(8, 1, *area, friction), curve(8, 2, *area, friction)];
            areas.iter().flat_map(of).collect::<Vec<_>>()
        };
        let mut rows = average(HYBRID, values(1.0, &[0.05, 0.1]));
        rows.extend(average(FEM, values(0.8, &[0.05])));
        rows.extend(average(BEM, values(1.1, &[0.05])));
        let before = rows.clone();
        add(&mut rows);
        // The mesh error of a value is a two thousandth of it.
        approx::assert_relative_eq!(rows[0].model_error.unwrap(), 0.2 + 4e-4, max_relative = 1e-12);
        assert_eq!(rows[1].model_error, Some(MEASURED_ELSEWHERE));
        for (row, before) in rows.iter().zip(&before).take(2) {
            let sum = before.error_estimate.unwrap() + row.model_error.unwrap();
            assert_eq!(row.error_estimate, Some(sum));
        }
        assert_eq!(rows[2..], before[2..]);
    }
}
