//! What the error of every average is made of, the largest part first, and what would reduce it.

use super::{FrictionRow, Model};
use crate::artifact::{Row, Table};
use crate::stages::bem::Given;
use crate::stages::realise::{Method, SurfaceKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The parts of the error of every average: `budget.arrow`.
pub const BUDGET: Table<BudgetRow> = Table::new("tables", "budget.arrow");

/// A part of the error of friction.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// The scatter between windows of the scans.
    Scans,
    /// The scatter of random phases.
    Phases,
    /// The scatter between stretches of the microscale.
    Stretches,
    /// What the model leaves out: the difference to a better one, or what that was on other surfaces.
    Model,
    /// The grid of the half-space.
    Grid,
    /// The mesh of the finite elements.
    Mesh,
    /// Interpolation between solved pressures.
    Interpolation,
    /// Waves that were left out of most realisations.
    LeftOutWaves,
}

impl Part {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scans => "scans",
            Self::Phases => "phases",
            Self::Stretches => "stretches",
            Self::Model => "model",
            Self::Grid => "grid",
            Self::Mesh => "mesh",
            Self::Interpolation => "interpolation",
            Self::LeftOutWaves => "left-out-waves",
        }
    }
}

/// Why isotropic surfaces have no error by the choice of scans.
const NO_SCAN_ERROR: &str = "isotropic surfaces have the averaged spectrum of all scans, and none is made without some of \
    them; measured profiles or maps tell what the choice of scans does (realise.methods)";

/// One part of the error of one average.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BudgetRow {
    /// Contact model.
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
    /// Place among the parts of this average, 1 for the largest; parts that are not known come first.
    pub rank: u32,
    /// The part.
    pub part: Part,
    /// Its error of the mean friction; absent where it is not known.
    #[schemars(extend("unit" = "1"))]
    pub error: Option<f64>,
    /// The same over the mean friction.
    #[schemars(extend("unit" = "1"))]
    pub relative_error: Option<f64>,
    /// What would reduce it.
    pub remedy: String,
}

impl Row for BudgetRow {
    const SCHEMA: &'static str = "asperity.tables.budget";
    const VERSION: u32 = 1;
}

/// The parts of all averages of models that are solved; theories have no error of their own.
pub(super) fn budget(rows: &[FrictionRow]) -> Vec<BudgetRow> {
    let solved =
        |row: &&FrictionRow| !matches!(row.model, Model::Persson | Model::KlueppelHeinrich);
    rows.iter().filter(solved).flat_map(|row| of_row(row, rows)).collect()
}

fn of_row(row: &FrictionRow, rows: &[FrictionRow]) -> Vec<BudgetRow> {
    let mut parts = parts(row, rows);
    parts.retain(|(_, error, _)| *error != Some(0.0));
    let size = |error: Option<f64>| error.unwrap_or(f64::INFINITY);
    parts.sort_by(|a, b| size(b.1).total_cmp(&size(a.1)).then(a.0.cmp(&b.0)));
    let budget_row =
        |(rank, (part, error, remedy)): (u32, (Part, Option<f64>, String))| BudgetRow {
            model: row.model,
            kind: row.kind,
            speed_mm_s: row.speed_mm_s,
            given: row.given,
            contact_area_fraction: row.contact_area_fraction,
            pressure_mpa: row.pressure_mpa,
            rank,
            part,
            error,
            relative_error: error.map(|error| error / row.mean.abs()),
            remedy,
        };
    (1..).zip(parts).map(budget_row).collect()
}

/// Every part with its error and what would reduce it.
fn parts(row: &FrictionRow, rows: &[FrictionRow]) -> Vec<(Part, Option<f64>, String)> {
    let four_times = |count: usize| 3 * count.max(1);
    let scans = four_times(row.windows as usize);
    let more_scans = if row.windows < 2 {
        "scan the road at more places: one window tells nothing of its scatter".to_owned()
    } else {
        format!("{scans} more windows of scans halve it")
    };
    let mut parts = Vec::new();
    if row.kind.method.of_a_window() {
        parts.push((Part::Scans, row.confidence_95, more_scans));
    } else {
        let more =
            four_times(row.half_space_realisations.map_or(row.realisations.len(), |n| n as usize));
        let more = format!("{more} more realisations halve it (realise.realisations)");
        parts.push((Part::Phases, row.confidence_95, more));
        let scans = match row.kind.method {
            Method::Isotropic => NO_SCAN_ERROR.to_owned(),
            _ => more_scans,
        };
        parts.push((Part::Scans, row.scan_error, scans));
    }
    if row.model == Model::Hybrid {
        let more = "four times as many stretches halve it (micro.stretches)".to_owned();
        parts.push((Part::Stretches, row.microscale_error, more));
    }
    let (part, finer) = match row.model {
        Model::Hybrid => (Part::Mesh, "more elements (micro.columns_per_shortest_wavelength)"),
        Model::Fem => (Part::Mesh, "more elements (fem.columns_per_shortest_wavelength)"),
        Model::Multilevel => {
            (Part::Mesh, "more elements (multilevel.columns_per_shortest_wavelength)")
        }
        _ if row.kind.method.is_areal() => {
            (Part::Grid, "a finer grid (areal.points_per_shortest_wavelength)")
        }
        _ => {
            (Part::Grid, "a finer grid (bem.points_per_shortest_wavelength or bem.grid_tolerance)")
        }
    };
    parts.push((part, row.discretisation_error, finer.to_owned()));
    let denser = match row.model {
        Model::Hybrid => "a smaller micro.tolerance",
        Model::Fem => "a smaller fem.pressure_ratio",
        Model::Multilevel => "a smaller multilevel.pressure_ratio",
        _ if row.kind.method.is_areal() => "a smaller areal.tolerance",
        _ => "a smaller bem.tolerance",
    };
    parts.push((Part::Interpolation, Some(row.interpolation_error), denser.to_owned()));
    let all = "a smaller tolerance, or none".to_owned();
    parts.push((Part::LeftOutWaves, Some(row.left_out_error), all));
    parts.extend(model_part(row, rows));
    parts
}

/// What the model leaves out, as far as this run tells.
fn model_part(row: &FrictionRow, rows: &[FrictionRow]) -> Option<(Part, Option<f64>, String)> {
    let better: &[Model] = match row.model {
        Model::Bem => &[Model::Fem, Model::Multilevel, Model::Hybrid],
        _ => &[],
    };
    let same = |model: &Model| {
        rows.iter().find(|other| {
            other.model == *model
                && other.kind == row.kind
                && other.speed_mm_s == row.speed_mm_s
                && other.condition() == row.condition()
        })
    };
    if let Some(other) = better.iter().find_map(same) {
        let error = (row.mean - other.mean).abs() + other.model_error.unwrap_or(0.0);
        return Some((Part::Model, Some(error), format!("take the model {}", other.model)));
    }
    match row.model {
        Model::Bem if row.kind.method.is_areal() => {
            let remedy = "not known: there is no finite deformation of areal surfaces; that of the profiles is a guide";
            Some((Part::Model, None, remedy.into()))
        }
        Model::Bem => {
            let remedy =
                "not known: finite deformation tells it (a section [micro], [fem] or [multilevel])";
            Some((Part::Model, None, remedy.into()))
        }
        Model::Hybrid => {
            let remedy = "all waves at finite deformation ([fem] or [multilevel])";
            Some((Part::Model, row.model_error, remedy.into()))
        }
        Model::Multilevel => {
            let remedy = "more pairs (multilevel.first_realisations)";
            Some((Part::Model, row.model_error, remedy.into()))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::average::average;
    use super::super::average::tests::curve;
    use super::*;

    #[test]
    fn the_largest_part_comes_first_with_what_would_reduce_it() {
        let values = |friction: [f64; 2]| {
            vec![curve(8, 1, 0.05, friction[0]), curve(8, 2, 0.05, friction[1])]
        };
        let mut rows = average(Model::Bem, values([0.99, 1.01]));
        rows.extend(average(Model::Hybrid, values([0.5, 0.6])));
        for row in &mut rows {
            (row.windows, row.scan_error) = (9, Some(0.2));
        }
        rows[1].model_error = Some(0.05);
        let found = budget(&rows);
        let of = |model: Model| -> Vec<(Part, u32)> {
            let own = found.iter().filter(|row| row.model == model);
            own.map(|row| (row.part, row.rank)).collect()
        };
        let parts = of(Model::Bem);
        // |1 - 0.55| + 0.05, 0.2, t(1) 0.0141 / sqrt 2, and a thousandth and half of it.
        let order = [Part::Model, Part::Scans, Part::Phases, Part::Interpolation, Part::Grid];
        assert_eq!(parts, order.into_iter().zip(1..).collect::<Vec<_>>());
        approx::assert_relative_eq!(found[0].error.unwrap(), 0.5, max_relative = 1e-12);
        assert_eq!(found[1].remedy, "27 more windows of scans halve it");
        assert_eq!(found[2].remedy, "6 more realisations halve it (realise.realisations)");
        assert_eq!(of(Model::Hybrid)[0].0, Part::Phases);
    }

    #[test]
    fn what_is_not_known_comes_before_all_that_is() {
        let mut rows = average(Model::Bem, vec![curve(8, 1, 0.05, 1.0)]);
        rows[0].windows = 1;
        let found = budget(&rows);
        let unknown: Vec<Part> =
            found.iter().filter(|row| row.error.is_none()).map(|row| row.part).collect();
        assert_eq!(unknown, [Part::Scans, Part::Phases, Part::Model]);
        assert!(found[0].remedy.contains("more places"), "{}", found[0].remedy);
    }
}
