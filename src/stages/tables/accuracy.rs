//! Whether the averages have the accuracy that the recipe asks for.

use super::basis::sum_of_errors;
use super::{FrictionRow, Model};
use crate::numerics::statistics::MeanEstimate;
use crate::stages::bem::NEGLIGIBLE;

/// Says so where averages of the half-space miss the wanted relative accuracy, by how much and what would mend it:
/// realisations, or scans, whose choice no number of realisations makes up for.
pub(super) fn missed(tolerance: f64, rows: &[FrictionRow]) -> Vec<String> {
    of_realisations(tolerance, rows).into_iter().chain(of_scans(tolerance, rows)).collect()
}

/// Errors by the choice of scans that exceed the tolerance by themselves.
fn of_scans(tolerance: f64, rows: &[FrictionRow]) -> Option<String> {
    let by_scans = |row: &FrictionRow| {
        let error = if row.kind.method.of_a_window() { row.confidence_95 } else { row.scan_error };
        Some(error? / row.mean.abs())
    };
    let of_scans = rows.iter().filter(|row| row.model == Model::Bem && row.windows > 0);
    let known = of_scans.filter_map(|row| Some((row, by_scans(row)?)));
    let (worst, most) = known.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (most > tolerance).then(|| {
        format!(
            "the choice of scans alone makes up to {:.1} % of the friction uncertain ({}, {} mm/s, {} windows), more than \
             the tolerance {tolerance}: no number of realisations mends that, more scans do",
            100.0 * most,
            worst.kind,
            worst.speed_mm_s,
            worst.windows
        )
    })
}

/// All other errors keep to a part of the tolerance, so that it is the realisations that are too few: the recipe allows no
/// more. Where the scatter of phases adds little to the error by scans, more realisations were not solved, and would not help;
/// of windows the scatter is that of the road.
fn of_realisations(tolerance: f64, rows: &[FrictionRow]) -> Option<String> {
    let relative = |row: &FrictionRow| {
        let of_one_choice = FrictionRow { scan_error: Some(0.0), ..row.clone() };
        sum_of_errors(&of_one_choice).map(|error| error / row.mean.abs())
    };
    let by_phases = |row: &&FrictionRow| {
        let scans = NEGLIGIBLE * row.scan_error.unwrap_or(0.0);
        row.model == Model::Bem
            && (!row.kind.method.of_a_window() || row.windows == 1)
            && !row.kind.method.is_measured()
            && row.confidence_95.unwrap_or(f64::INFINITY) > scans
    };
    let half_space: Vec<&FrictionRow> = rows.iter().filter(by_phases).collect();
    let known = half_space.iter().filter_map(|row| Some((row, relative(row)?)));
    let (worst, most) = known.clone().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let missing = known.filter(|(_, error)| *error > tolerance).count();
    if missing == 0 {
        return None;
    }
    let spread = MeanEstimate::of(&worst.realisations);
    let statistical = worst.confidence_95.unwrap_or(0.0) / worst.mean.abs();
    let left = tolerance - (most - statistical);
    let advice = spread.count_for(left * worst.mean.abs()).map_or_else(
        || "raise the tolerance".into(),
        |needed| format!("about {needed} would do (realise.most_realisations)"),
    );
    let realisations = spread.count;
    Some(format!(
        "the error of {missing} of {} averages exceeds the tolerance {tolerance}: the largest is {:.1} % of the \
         friction, {:.1} % of it by only {realisations} realisations ({}, {} mm/s, area {}); {advice}",
        half_space.len(),
        100.0 * most,
        100.0 * statistical,
        worst.kind,
        worst.speed_mm_s,
        worst.contact_area_fraction
    ))
}

#[cfg(test)]
mod tests {
    use super::super::average::{average, tests::curve};
    use super::*;

    #[test]
    fn too_few_realisations_are_named_with_the_number_that_would_do() {
        let curves = (1..=4).map(|k| curve(8, k, 0.05, 1.0 + 0.01 * f64::from(k))).collect();
        let rows = average(Model::Bem, curves);
        assert!(missed(0.5, &rows).is_empty());
        let warnings = missed(0.01, &rows);
        let warning = &warnings[0];
        // Mean 1.025, 95 % of four: 3.182 * 0.01291 / 2 = 0.02054, 2.00 %; grid and interpolation
        // 0.15 %, so 0.0087 is left: t(11) 0.01291 / sqrt(12) = 0.0082, t(10) 0.01291 / sqrt(11) = 0.0087.
        assert!(warning.contains("1 of 1 averages"), "{warning}");
        assert!(warning.contains("2.2 % of the friction, 2.0 % of it by only 4"), "{warning}");
        assert!(warning.contains("about 11 would do"), "{warning}");
        assert!(missed(0.001, &rows)[0].contains("raise the tolerance"));
        let mut rows = rows;
        (rows[0].windows, rows[0].scan_error) = (9, Some(0.3));
        let warnings = missed(0.05, &rows);
        assert!(warnings.len() == 1 && warnings[0].contains("9 windows"), "{warnings:?}");
        // The phases alone miss 1 %, and matter little beside the scans.
        let warnings = missed(0.01, &rows);
        assert!(warnings.len() == 1 && warnings[0].contains("9 windows"), "{warnings:?}");
    }
}
