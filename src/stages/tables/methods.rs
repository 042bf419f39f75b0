//! Friction of one road under the surfaces that stand for it, beside that of its measured profiles.

use super::{FrictionRow, Model};
use crate::artifact::{Row, Table};
use crate::numerics::statistics::{MeanEstimate, student_t_975};
use crate::stages::bem::Given;
use crate::stages::realise::{Method, SurfaceKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Friction of each kind of surfaces over that of the measured profiles: `methods.arrow`, where the recipe has measured
/// profiles and others.
pub const METHODS: Table<MethodRow> = Table::new("tables", "methods.arrow");

/// Friction of one kind of surfaces beside that of the measured profiles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MethodRow {
    /// Contact model of both.
    pub model: Model,
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// What friction is given for: a contact area fraction or a mean pressure.
    pub given: Given,
    /// Contact area fraction, averaged over the realisations where the pressure is given.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure, averaged over the realisations where the area is given.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Realisations.
    pub realisations: u32,
    /// Mean friction coefficient.
    #[schemars(extend("unit" = "1"))]
    pub mean: f64,
    /// Mean friction coefficient over that of the measured profiles.
    #[schemars(extend("unit" = "1"))]
    pub ratio_to_measured: f64,
    /// Half width of the 95 % confidence interval of the ratio by the scatter of both; surfaces of the same windows are
    /// compared window by window. Absent where fewer than two windows were measured.
    #[schemars(extend("unit" = "1"))]
    pub ratio_confidence_95: Option<f64>,
}

impl Row for MethodRow {
    const SCHEMA: &'static str = "asperity.tables.methods";
    const VERSION: u32 = 1;
}

/// Every average of a kind of surfaces beside that of the measured profiles of the same model, at the same speed and area
/// or pressure; those of the measured profiles themselves have the ratio 1. Where no profile was measured, beside that of the
/// measured maps.
pub(super) fn compared(rows: &[FrictionRow]) -> Vec<MethodRow> {
    let has = |method: Method| rows.iter().any(|row| row.kind.method == method);
    let road = if has(Method::Measured) { Method::Measured } else { Method::ArealMeasured };
    let measured = |row: &&FrictionRow| row.kind.method == road;
    let of_row = |row: &FrictionRow| {
        let same = |other: &&FrictionRow| {
            other.model == row.model
                && other.speed_mm_s == row.speed_mm_s
                && other.condition() == row.condition()
        };
        let road = rows.iter().filter(measured).find(same)?;
        let (ratio, confidence) = ratio(row, road);
        Some(MethodRow {
            model: row.model,
            kind: row.kind,
            speed_mm_s: row.speed_mm_s,
            given: row.given,
            contact_area_fraction: row.contact_area_fraction,
            pressure_mpa: row.pressure_mpa,
            realisations: row.realisations.len() as u32,
            mean: row.mean,
            ratio_to_measured: ratio,
            ratio_confidence_95: confidence,
        })
    };
    rows.iter().filter_map(of_row).collect()
}

/// Whether there is anything beside the measured road.
pub(super) fn differ(rows: &[MethodRow]) -> bool {
    rows.windows(2).any(|pair| pair[0].kind != pair[1].kind)
        || rows.iter().any(|row| !row.kind.method.is_measured())
}

/// Ratio of the means and half width of its 95 % interval.
fn ratio(row: &FrictionRow, road: &FrictionRow) -> (f64, Option<f64>) {
    let ratio = row.mean / road.mean;
    if row.kind == road.kind {
        return (ratio, Some(0.0));
    }
    let windows = road.realisations.len();
    // A map and a line of it are not the same window.
    let same_sort = row.kind.method.is_areal() == road.kind.method.is_areal();
    if same_sort && row.kind.method.of_a_window() && row.realisations.len() >= windows {
        return (ratio, of_pairs(&by_window(&row.realisations, windows), &road.realisations));
    }
    let relative = |row: &FrictionRow| row.confidence_95.map(|half| half / row.mean);
    let half = relative(row).zip(relative(road)).map(|(a, b)| ratio.abs() * a.hypot(b));
    (ratio, half)
}

/// Means over the draws of each window, which take turns.
fn by_window(realisations: &[f64], windows: usize) -> Vec<f64> {
    let of_window = |window: usize| {
        let own: Vec<f64> = realisations.iter().skip(window).step_by(windows).copied().collect();
        MeanEstimate::of(&own).mean
    };
    (0..windows).map(of_window).collect()
}

/// Half width of the 95 % interval of the ratio of the means of pairs, by the jackknife.
fn of_pairs(values: &[f64], road: &[f64]) -> Option<f64> {
    let count = road.len();
    if count < 2 {
        return None;
    }
    let sums = (values.iter().sum::<f64>(), road.iter().sum::<f64>());
    let without: Vec<f64> =
        values.iter().zip(road).map(|(a, b)| (sums.0 - a) / (sums.1 - b)).collect();
    let n = count as f64;
    let mean = without.iter().sum::<f64>() / n;
    let variance = (n - 1.0) / n * without.iter().map(|r| (r - mean).powi(2)).sum::<f64>();
    Some(student_t_975(n - 1.0) * variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::average::average;
    use super::super::average::tests::curve;
    use super::*;
    use crate::stages::friction::FrictionAt;

    fn of(method: Method, friction: &[f64]) -> Vec<FrictionRow> {
        let value = |(k, friction): (u32, &f64)| {
            let mut value: FrictionAt = curve(8, k, 0.05, *friction);
            value.curve.kind = match method {
                Method::Sines => SurfaceKind::sines(8),
                method => SurfaceKind::of(method),
            };
            value
        };
        average(Model::Bem, (1..).zip(friction).map(value).collect())
    }

    #[test]
    fn windows_are_compared_one_by_one_and_sines_by_both_scatters() {
        let measured = of(Method::Measured, &[0.1, 0.2, 0.3]);
        let twice = of(Method::Matched, &[0.2, 0.4, 0.6, 0.2, 0.4, 0.6]);
        let sines = of(Method::Sines, &[0.38, 0.4, 0.42]);
        let rows = compared(&[measured, twice, sines].concat());
        assert_eq!(rows.len(), 3);
        assert_eq!((rows[0].ratio_to_measured, rows[0].ratio_confidence_95), (1.0, Some(0.0)));
        // Twice in every window: the scatter of the road does not matter.
        approx::assert_relative_eq!(rows[1].ratio_to_measured, 2.0, max_relative = 1e-12);
        assert!(rows[1].ratio_confidence_95.unwrap() < 1e-12);
        // 2 (t(2) 0.1 / (sqrt 3 0.2)) and a little by the sines.
        let half = rows[2].ratio_confidence_95.unwrap();
        assert!((2.48..2.52).contains(&half), "{half}");
        assert!(compared(&of(Method::Sines, &[0.4])).is_empty());
    }
}
