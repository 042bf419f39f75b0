//! Sections on friction, its tables and its error.

use super::Report;
use super::page::{absent, number, optional, percent, table};
use crate::report::About;
use crate::report::ReportError;
use crate::report::figures::reference;
use crate::report::read::rows;
use crate::report::tables::{FrictionTable, friction_tables};
use crate::stages;
use crate::stages::Stage;
use crate::stages::areal::AREAL_SOLVES;
use crate::stages::bem::{Given, REALISATIONS, RealisationsRow, SOLVES};
use crate::stages::tables::{
    BUDGET, BudgetRow, COMPARISON, ComparisonRow, FRICTION, FrictionRow, METHODS, MODELS,
    MethodRow, Model, ModelRow,
};
use maud::{Markup, html};

const NO_TABLES: &str = "This run has no averaged friction yet: the stage tables has not run.";

impl Report<'_> {
    fn friction_rows(&self) -> Result<Vec<FrictionRow>, ReportError> {
        Ok(rows(self.run, FRICTION)?.unwrap_or_default())
    }

    pub(super) fn friction(&self) -> Result<Markup, ReportError> {
        let all = self.friction_rows()?;
        if all.is_empty() {
            return Ok(absent(NO_TABLES));
        }
        let models = rows(self.run, MODELS)?.unwrap_or_default();
        let methods = rows(self.run, METHODS)?.unwrap_or_default();
        Ok(html! {
            (self.warnings(&[stages::tables::STAGE])?)
            p { "Models: " (models_in_words(&all)) "." }
            (self.figure("friction")?)
            (self.figure("methods")?)
            @if !methods.is_empty() { (method_table(&methods)) }
            (self.figure("speed")?)
            (self.figure("area")?)
            @if !models.is_empty() { (model_table(&models)) }
            (self.figure("comparison")?)
        })
    }

    pub(super) fn tables(&self) -> Result<Markup, ReportError> {
        let all = self.friction_rows()?;
        if all.is_empty() {
            return Ok(absent(NO_TABLES));
        }
        let compared = rows(self.run, COMPARISON)?.unwrap_or_default();
        let about = About::of(self.run)?;
        Ok(html! {
            (self.doubt(&[stages::tables::STAGE]))
            @for one in friction_tables(&all) { (friction_table(&one, &about)) }
            @for rows in compared.chunk_by(|a, b| a.published_table == b.published_table) {
                (comparison_table(rows))
            }
        })
    }

    pub(super) fn accuracy(&self) -> Result<Markup, ReportError> {
        let solves = rows(self.run, SOLVES)?.unwrap_or_default();
        let realisations = rows(self.run, REALISATIONS)?.unwrap_or_default();
        let friction = self.friction_rows()?;
        let budget = rows(self.run, BUDGET)?.unwrap_or_default();
        let areal = rows(self.run, AREAL_SOLVES)?.unwrap_or_default();
        let tolerance = self.tolerance()?;
        Ok(html! {
            (self.warnings(&[stages::bem::STAGE, stages::areal::STAGE, stages::multilevel::STAGE])?)
            p { @match tolerance {
                Some(tolerance) => { "The recipe asks for a relative accuracy of the averages of " (percent(tolerance)) "." }
                None => { "The recipe asks for no accuracy of the averages (key tolerance); the errors are estimated nevertheless." }
            } }
            (self.seconds()?)
            (self.figure("budget")?)
            @if !budget.is_empty() { (budget_table(&budget)) }
            (self.figure("accuracy")?)
            @if !friction.is_empty() { (error_table(&friction)) }
            (effort("contacts of the half-space", solves.iter().map(|row| (row.seconds, row.residual))))
            (effort("contacts of areal surfaces", areal.iter().map(|row| (row.seconds, row.residual))))
            @if !realisations.is_empty() { (realisation_table(&realisations)) }
        })
    }

    fn tolerance(&self) -> Result<Option<f64>, ReportError> {
        let manifest = self.run.stage_manifest("tables")?;
        Ok(manifest.and_then(|manifest| {
            manifest
                .parameters
                .pointer("/tables/tolerance")
                .or_else(|| manifest.parameters.get("tolerance"))?
                .as_f64()
        }))
    }

    fn seconds(&self) -> Result<Markup, ReportError> {
        let mut lines = vec![];
        for stage in Stage::ALL {
            if let Some(manifest) = self.run.stage_manifest(stage.name())? {
                lines.push(vec![stage.name().to_owned(), format!("{:.2}", manifest.seconds)]);
            }
        }
        let caption = "Wall time of each stage, when it was last computed";
        Ok(table(caption, &["stage", "wall time / s"], 1, lines))
    }
}

/// Time and largest residual of solves, given as pairs of these.
fn effort(what: &str, solves: impl Iterator<Item = (f64, f64)>) -> Markup {
    let (mut count, mut seconds, mut largest) = (0, 0.0, 0.0_f64);
    for (time, residual) in solves {
        (count, seconds, largest) = (count + 1, seconds + time, largest.max(residual));
    }
    html! { @if count > 0 {
        p { (count) " " (what) " took " (number(seconds, 3)) " s of all threads together; the largest residual is "
            (number(largest, 2)) "." }
    } }
}

fn models_in_words(rows: &[FrictionRow]) -> String {
    let mut models: Vec<Model> = rows.iter().map(|row| row.model).collect();
    models.sort_unstable_by_key(|model| model.name());
    models.dedup();
    let words = models.into_iter().map(|model| match model {
        Model::Bem => "bem, the viscoelastic half-space".to_owned(),
        Model::Hybrid => "hybrid, the half-space corrected by its steepest waves".into(),
        Model::Fem => "fem, all waves at finite deformation".into(),
        Model::Multilevel => {
            "multilevel, the half-space with the mean difference to all waves at finite deformation"
                .into()
        }
        theory @ (Model::Persson | Model::KlueppelHeinrich) => format!("{theory}, a theory"),
    });
    words.collect::<Vec<_>>().join("; ")
}

fn friction_table(one: &FrictionTable, about: &About) -> Markup {
    let count = one.rows.iter().map(|row| row.realisations.len()).max().unwrap_or(0);
    // Single values of more realisations than this fill pages; they are in the exported tables.
    let shown = if count <= 10 { count } else { 0 };
    let mut header: Vec<String> = match one.given {
        Given::Area => vec!["Ac/A0".into(), "pressure / MPa".into()],
        Given::Pressure => vec!["pressure / MPa".into(), "Ac/A0".into()],
    };
    header.extend((1..=shown).map(|k| format!("µ {k}")));
    header
        .extend(["mean µ", "standard deviation", "± 95 %", "error, all parts"].map(str::to_owned));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    table(
        &one.caption(about),
        &header,
        1,
        one.rows.iter().map(|row| {
            let mut cells = one.conditions(row).to_vec();
            cells.extend((0..shown).map(|k| optional(row.realisations.get(k).copied(), 4)));
            cells.push(number(row.mean, 4));
            let errors = [row.standard_deviation, row.confidence_95, row.error_estimate];
            cells.extend(errors.map(|error| optional(error, 2)));
            cells
        }),
    )
}

fn comparison_table(rows: &[ComparisonRow]) -> Markup {
    table(
        &format!(
            "{}, published and computed, {} waves, {} mm/s, {}",
            rows[0].published_table, rows[0].waves, rows[0].speed_mm_s, rows[0].model
        ),
        &["Ac/A0", "published µ", "computed µ", "± 95 %", "grid or mesh", "difference"],
        1,
        rows.iter().map(|row| {
            vec![
                row.contact_area_fraction.to_string(),
                number(row.published, 3),
                number(row.computed, 3),
                optional(row.confidence_95, 2),
                optional(row.discretisation_error, 2),
                percent(row.relative_difference),
            ]
        }),
    )
}

fn model_table(models: &[ModelRow]) -> Markup {
    table(
        "Difference between models, means over the contact areas that both have",
        &[
            "model",
            "reference",
            "surfaces",
            "speed / (mm/s)",
            "Ac/A0 from",
            "to",
            "areas",
            "of averages",
            "of realisations",
            "bias",
        ],
        2,
        models.iter().map(|row| {
            vec![
                row.model.to_string(),
                row.reference.to_string(),
                row.kind.to_string(),
                row.speed_mm_s.to_string(),
                row.from_area_fraction.to_string(),
                row.to_area_fraction.to_string(),
                row.areas.to_string(),
                percent(row.relative_error_of_averages),
                percent(row.relative_error),
                percent(row.bias),
            ]
        }),
    )
}

fn method_table(methods: &[MethodRow]) -> Markup {
    table(
        &format!(
            "Friction of the same road under the surfaces that stand for it, and its ratio to that of the {}",
            reference(methods)
        ),
        &[
            "model",
            "surfaces",
            "speed / (mm/s)",
            "Ac/A0",
            "pressure / MPa",
            "realisations",
            "mean µ",
            "ratio",
            "± 95 %",
        ],
        2,
        methods.iter().map(|row| {
            vec![
                row.model.to_string(),
                row.kind.to_string(),
                row.speed_mm_s.to_string(),
                number(row.contact_area_fraction, 4),
                number(row.pressure_mpa, 4),
                row.realisations.to_string(),
                number(row.mean, 4),
                number(row.ratio_to_measured, 3),
                optional(row.ratio_confidence_95, 2),
            ]
        }),
    )
}

/// The two largest parts of every average.
fn budget_table(budget: &[BudgetRow]) -> Markup {
    table(
        "The largest parts of the error of the averaged friction, and what would reduce them; the others are in \
         tables/budget.arrow",
        &[
            "model",
            "surfaces",
            "speed / (mm/s)",
            "Ac/A0",
            "pressure / MPa",
            "part",
            "error",
            "relative",
            "what would reduce it",
        ],
        2,
        budget.iter().filter(|row| row.rank <= 2).map(|row| {
            vec![
                row.model.to_string(),
                row.kind.to_string(),
                row.speed_mm_s.to_string(),
                number(row.contact_area_fraction, 4),
                number(row.pressure_mpa, 4),
                row.part.name().to_owned(),
                optional(row.error, 2),
                row.relative_error.map_or_else(|| "not known".into(), percent),
                row.remedy.clone(),
            ]
        }),
    )
}

fn error_table(rows: &[FrictionRow]) -> Markup {
    table(
        "Estimated errors of the averaged friction by part, absolute",
        &[
            "model",
            "surfaces",
            "speed / (mm/s)",
            "Ac/A0",
            "pressure / MPa",
            "mean µ",
            "realisations (95 %)",
            "scans",
            "interpolation",
            "grid",
            "waves left out",
            "stretches",
            "model",
            "sum",
            "sum, relative",
        ],
        1,
        rows.iter().map(|row| {
            vec![
                row.model.to_string(),
                row.kind.to_string(),
                row.speed_mm_s.to_string(),
                number(row.contact_area_fraction, 4),
                number(row.pressure_mpa, 4),
                number(row.mean, 4),
                optional(row.confidence_95, 2),
                optional(row.scan_error, 2),
                number(row.interpolation_error, 2),
                optional(row.discretisation_error, 2),
                number(row.left_out_error, 2),
                optional(row.microscale_error, 2),
                optional(row.model_error, 2),
                optional(row.error_estimate, 2),
                row.error_estimate.map_or_else(|| "–".into(), |error| percent(error / row.mean)),
            ]
        }),
    )
}

fn realisation_table(rows: &[RealisationsRow]) -> Markup {
    table(
        "Number of realisations in the averages",
        &[
            "surfaces",
            "speed / (mm/s)",
            "realisations",
            "with all waves",
            "left out of the others / mm",
        ],
        1,
        rows.iter().map(|row| {
            let left_out = row.left_out_wavelengths_mm.iter().map(|mm| number(*mm, 4));
            vec![
                row.kind.to_string(),
                row.speed_mm_s.to_string(),
                row.realisations.to_string(),
                row.with_all_waves.to_string(),
                left_out.collect::<Vec<_>>().join(", "),
            ]
        }),
    )
}
