//! The tables of all cases of a sweep.

use super::{CliError, Export, Format, csv_text, print};
use asperity::artifact::{ExportTable, RunView};
use asperity::report::{About, friction_tables, latex, markdown};
use asperity::stages::tables::FrictionRow;
use asperity::sweep::{FRICTION, STAGE, SweepFrictionRow};
use asperity::text::{markdown_text, visible_line};
use std::fmt::Write;

impl Export {
    /// One keyed table for programs, or a document with the tables of every case.
    pub(super) fn sweep(&self, view: &RunView) -> Result<(), CliError> {
        if self.comparison {
            return Err(CliError::input("a comparison is of one case: give its folder in cases/"));
        }
        match self.format {
            Format::Csv | Format::Parquet => self.keyed_table(view),
            Format::Markdown => self.document(view, |case, tables, about| {
                format!("## {}\n\n{}\n", markdown_text(case), markdown(tables, about))
            }),
            Format::Latex => self.document(view, |case, tables, about| {
                format!("% {}\n{}\n", visible_line(case), latex(tables, about))
            }),
            Format::Xlsx | Format::Svg => Err(CliError::input(
                "a sweep is exported as csv, parquet, markdown or latex; for a workbook or a figure give the \
                 folder of one case in cases/",
            )),
        }
    }

    fn keyed_table(&self, view: &RunView) -> Result<(), CliError> {
        if self.model.is_some()
            || self.method.is_some()
            || self.waves.is_some()
            || self.speed.is_some()
        {
            return Err(CliError::input(
                "the table of a sweep has model, waves and speed as columns: leave --model, --waves and --speed out",
            ));
        }
        view.verify(STAGE)?;
        let table = ExportTable::read(&view.path_of(FRICTION))?;
        match (self.format, &self.to) {
            (Format::Csv, None) => print(&csv_text(&table)?),
            (Format::Csv, Some(path)) => self.bytes(path, table.csv()),
            (_, Some(path)) => self.bytes(path, table.parquet()),
            (_, None) => Err(CliError::input("Parquet is binary: give a file with --to")),
        }
    }

    fn document(
        &self,
        view: &RunView,
        one: impl Fn(&str, &[asperity::report::FrictionTable], &About) -> String,
    ) -> Result<(), CliError> {
        let rows = view.rows(FRICTION)?;
        let manifest = view.stage_manifest(STAGE)?;
        let parameter = |key: &str| manifest.as_ref().and_then(|m| m.parameters[key].as_f64());
        let mut text = String::new();
        for rows in rows.chunk_by(|a, b| key(a) == key(b)) {
            let friction: Vec<FrictionRow> = rows
                .iter()
                .map(|row| row.friction.clone())
                .filter(|row| self.chosen(row))
                .collect();
            let SweepFrictionRow { rubber, temperature_c, .. } = &rows[0];
            let about = About {
                rubber: rubber.clone(),
                temperature_c: *temperature_c,
                tolerance: parameter("tolerance"),
                angle_deg: parameter("angle_deg"),
                thickness_mm: parameter("thickness_mm"),
            };
            // Writing to a string cannot fail.
            let _ = write!(text, "{}", one(&title(&rows[0]), &friction_tables(&friction), &about));
        }
        self.text(&text)
    }
}

/// What tells the rows of one case from those of another.
fn key(row: &SweepFrictionRow) -> (&Option<String>, &str, Option<u64>, u64) {
    (&row.specimen, &row.rubber, row.temperature_c.map(f64::to_bits), row.seed)
}

fn title(row: &SweepFrictionRow) -> String {
    let specimen = row.specimen.as_ref().map(|name| format!("specimen {name}, "));
    let temperature = row.temperature_c.map(|celsius| format!(" at {celsius} °C"));
    let (specimen, temperature) = (specimen.unwrap_or_default(), temperature.unwrap_or_default());
    format!("{specimen}rubber {}{temperature}, seed {}", row.rubber, row.seed)
}
