//! How far the models of a run are apart.

use super::FrictionRow;
use super::Model::{self, Bem, Fem, Hybrid, KlueppelHeinrich, Multilevel, Persson};
use crate::artifact::{Row, Table};
use crate::stages::bem::Given;
use crate::stages::realise::SurfaceKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How far the models of a run are apart: `models.arrow`, where it has more than the half-space.
pub const MODELS: Table<ModelRow> = Table::new("tables", "models.arrow");

/// Relative difference of one model from another, averaged over contact areas (thesis 5.2.1,
/// 5.4.4).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelRow {
    /// Contact model.
    pub model: Model,
    /// The model that it is measured by.
    pub reference: Model,
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// What friction is given for: contact area fractions or mean pressures.
    pub given: Given,
    /// Smallest contact area fraction that both have.
    #[schemars(extend("unit" = "1"))]
    pub from_area_fraction: f64,
    /// Largest contact area fraction that both have.
    #[schemars(extend("unit" = "1"))]
    pub to_area_fraction: f64,
    /// Number of contact areas that both have.
    pub areas: u32,
    /// Mean over the areas of `|μ - μ_ref| / μ_ref` of the averages over realisations.
    #[schemars(extend("unit" = "1"))]
    pub relative_error_of_averages: f64,
    /// Mean over areas and realisations of `|μ - μ_ref| / μ_ref`; with `multilevel` over those that it has at
    /// finite deformation.
    #[schemars(extend("unit" = "1"))]
    pub relative_error: f64,
    /// Mean over the areas of `(μ - μ_ref) / μ_ref` of the averages over realisations.
    #[schemars(extend("unit" = "1"))]
    pub bias: f64,
}

impl Row for ModelRow {
    const SCHEMA: &'static str = "asperity.tables.models";
    const VERSION: u32 = 2;
}

/// Every pair of models of a run, the better one as the reference; the theories by what is solved.
pub(super) fn comparisons(rows: &[FrictionRow]) -> Vec<ModelRow> {
    let solved = [
        (Bem, Fem),
        (Hybrid, Fem),
        (Multilevel, Fem),
        (Bem, Hybrid),
        (Bem, Multilevel),
        (Hybrid, Multilevel),
    ];
    let theories = [Persson, KlueppelHeinrich]
        .into_iter()
        .flat_map(|theory| [Bem, Hybrid, Fem, Multilevel].map(|reference| (theory, reference)));
    solved
        .into_iter()
        .chain(theories)
        .flat_map(|(model, reference)| apart(rows, model, reference))
        .collect()
}

/// How far a model is from another, for each number of waves and speed.
fn apart(rows: &[FrictionRow], model: Model, reference: Model) -> Vec<ModelRow> {
    // Without a realisation at finite deformation `multilevel` is the half-space over again.
    let of = |name: Model| {
        let own = |row: &&FrictionRow| row.model == name && !row.realisations.is_empty();
        rows.iter().filter(own).collect::<Vec<_>>()
    };
    let (model_rows, reference_rows) = (of(model), of(reference));
    let same_table = |a: &&FrictionRow, b: &&FrictionRow| {
        (a.kind, a.given) == (b.kind, b.given) && a.speed_mm_s == b.speed_mm_s
    };
    let counterpart = |row: &&FrictionRow| {
        reference_rows
            .iter()
            .copied()
            .find(|other| same_table(row, other) && row.condition() == other.condition())
    };
    let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    model_rows
        .chunk_by(same_table)
        .filter_map(|table| {
            let pairs: Vec<(&FrictionRow, &FrictionRow)> =
                table.iter().filter_map(|row| Some((*row, counterpart(row)?))).collect();
            let ((first, _), (last, _)) = (pairs.first()?, pairs.last()?);
            let relative = |a: f64, b: f64| (a - b) / b;
            let averages = || pairs.iter().map(|(a, b)| relative(a.mean, b.mean));
            let each = pairs.iter().flat_map(|(a, b)| {
                a.realisations.iter().zip(&b.realisations).map(|(a, b)| relative(*a, *b).abs())
            });
            Some(ModelRow {
                model,
                reference,
                kind: first.kind,
                speed_mm_s: first.speed_mm_s,
                given: first.given,
                from_area_fraction: first.contact_area_fraction,
                to_area_fraction: last.contact_area_fraction,
                areas: pairs.len() as u32,
                relative_error_of_averages: mean(averages().map(f64::abs).collect()),
                relative_error: mean(each.collect()),
                bias: mean(averages().collect()),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::average::average;
    use super::super::average::tests::curve;
    use super::*;

    #[test]
    fn models_are_compared_where_both_have_a_value() {
        let bem = vec![curve(8, 1, 0.05, 1.1), curve(8, 2, 0.05, 0.9), curve(8, 1, 0.1, 2.0)];
        let fem = vec![curve(8, 1, 0.05, 1.0), curve(8, 2, 0.05, 1.0), curve(9, 1, 0.1, 2.0)];
        let rows = [average(Bem, bem), average(Fem, fem)].concat();
        let apart = apart(&rows, Bem, Fem);
        assert_eq!((apart.len(), apart[0].areas, apart[0].to_area_fraction), (1, 1, 0.05));
        approx::assert_relative_eq!(apart[0].relative_error, 0.1, max_relative = 1e-12);
        assert!(apart[0].bias.abs() < 1e-15 && apart[0].relative_error_of_averages < 1e-15);
    }
}
