//! `asperity rubber payne`: softening with strain from strain sweeps.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::cli::CliError;
use crate::cli::output::{json, note, print, refuse_existing, significant, write_file};
use crate::cli::solve::refuse_to_overwrite;
use asperity::rubber::fit::{StrainUnit, TableOptions, read_strain_sweeps, strain_doubts};
use asperity::rubber::payne::{
    Kraus, KrausFit, Payne, PayneCurve, PayneTable, StrainSweep, TableFit, elongation_of_shear,
};
use asperity::rubber::payne_section;

const EXAMPLES: &str = "\
Examples:
  The fit of Kraus' law to each temperature, and the measured factors as a section for a rubber file:
    asperity rubber payne strain_sweep.txt --strain-kind elongation --strain-unit percent --to payne.toml
  The section with Kraus' law:
    asperity rubber payne strain_sweep.txt --strain-kind shear --strain-unit percent --law kraus --to payne.toml

Exit codes: 0 fitted, 1 no fit or not written, 2 bad input.";

/// Which strain was measured.
#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum StrainKind {
    /// Tension or compression: amplitude of elongation.
    Elongation,
    /// Torsion or shear: amplitude of the angle, which is √3 times the elongation of equal energy.
    Shear,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Unit {
    Percent,
    Fraction,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Law {
    Table,
    Kraus,
}

/// Fit the softening of a filled rubber with strain (Payne effect) to strain sweeps.
///
/// The file is text or an .xlsx workbook with a header that names quantities and units: strain_percent (or
/// strain_fraction), storage_mpa, loss_mpa (or loss_factor) and, optionally, temperature_c and frequency_hz. Strains are
/// amplitudes, half of peak to peak. Each temperature gets the factors f = E'(strain)/E'(0) and g = E''(strain)/E''(0), as
/// measured and by Kraus' law. docs/rubber_data.md explains both.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct PayneFit {
    /// Strain sweeps: CSV, text of an instrument, or .xlsx.
    #[arg(value_name = "SWEEP")]
    sweep: PathBuf,
    /// Which strain was measured; never guessed.
    #[arg(long, value_enum, value_name = "KIND")]
    strain_kind: StrainKind,
    /// Unit of the strain, where the header does not say it.
    #[arg(long, value_enum, value_name = "UNIT")]
    strain_unit: Option<Unit>,
    /// Law of the section that is written: the measured factors, or Kraus' law.
    #[arg(long, value_enum, value_name = "LAW", default_value = "table")]
    law: Law,
    /// File for the section [payne], to be pasted into a rubber file.
    #[arg(long, value_name = "SECTION.TOML")]
    to: Option<PathBuf>,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
    /// Overwrite a file that is there already.
    #[arg(long)]
    force: bool,
}

/// What one temperature gives; the names are the keys of the JSON object.
#[derive(Debug, Serialize)]
struct Row {
    temperature_c: Option<f64>,
    strains: usize,
    left_out: usize,
    /// At vanishing strain, in MPa.
    storage_mpa: f64,
    loss_mpa: f64,
    critical_strain: f64,
    exponent: f64,
    storage_limit: f64,
    loss_limit: f64,
    loss_peak: f64,
    highest_strain: f64,
    /// Root mean square deviations of the law, relative.
    storage_rms: f64,
    loss_rms: f64,
    /// The same of Kraus' own law, whose loss modulus is the same at small and large strains.
    own_storage_rms: Option<f64>,
    own_loss_rms: Option<f64>,
}

impl PayneFit {
    pub(in crate::cli) fn run(&self, quiet: bool) -> Result<(), CliError> {
        refuse_existing(self.to.as_deref(), self.force)?;
        refuse_to_overwrite(self.to.as_deref(), "--to", &[Some(&self.sweep)])?;
        let unit = self.strain_unit.map(|unit| match unit {
            Unit::Percent => StrainUnit::Percent,
            Unit::Fraction => StrainUnit::Fraction,
        });
        let mut sweeps = read_strain_sweeps(&self.sweep, &TableOptions::default(), unit)?;
        for doubt in strain_doubts(&sweeps) {
            note(quiet, format_args!("warning: {}: {doubt}", self.sweep.display()));
        }
        let (mut rows, mut curves) = (Vec::new(), Vec::new());
        for sweep in &mut sweeps {
            if self.strain_kind == StrainKind::Shear {
                for point in &mut sweep.points {
                    point.strain = elongation_of_shear(point.strain);
                }
            }
            let table = PayneTable::fit(sweep).map_err(|error| self.named(error))?;
            let kraus = Kraus::fit(sweep).map_err(|error| self.named(error))?;
            for point in &table.left_out {
                let at = at(sweep.temperature_c);
                note(
                    quiet,
                    format_args!(
                        "warning: the point at a strain of {:.4} %{at} lies off its neighbours and is left out",
                        100.0 * point.strain
                    ),
                );
            }
            rows.push(Row::new(sweep, &kraus));
            curves.push((sweep.temperature_c, self.curve(table, &kraus)));
        }
        let payne = Payne::new(curves).map_err(|error| self.named(error))?;
        if let Some(path) = &self.to {
            let text = payne_section(&payne).trim_start().to_owned() + "\n";
            write_file(path, self.force, |out| out.write_all(text.as_bytes()))?;
        }
        print(&if self.json { json(&rows)? } else { text(&rows) })
    }

    fn curve(&self, table: TableFit, kraus: &KrausFit) -> PayneCurve {
        match self.law {
            Law::Table => PayneCurve::Table(table.table),
            Law::Kraus => PayneCurve::Kraus(kraus.law),
        }
    }

    fn named(&self, error: asperity::rubber::payne::PayneError) -> CliError {
        use asperity::error_kind::{ErrorKind, HasKind};
        let text = format!("{}: {error}", self.sweep.display());
        match error.kind() {
            ErrorKind::Input => CliError::input(text),
            _ => CliError::failure(text),
        }
    }
}

fn at(temperature_c: Option<f64>) -> String {
    temperature_c.map_or(String::new(), |celsius| format!(" at {celsius} °C"))
}

impl Row {
    fn new(sweep: &StrainSweep, fit: &KrausFit) -> Self {
        let law = fit.law;
        Self {
            temperature_c: sweep.temperature_c,
            strains: sweep.points.len() - fit.left_out.len(),
            left_out: fit.left_out.len(),
            storage_mpa: 1e-6 * fit.storage_modulus,
            loss_mpa: 1e-6 * fit.loss_modulus,
            critical_strain: law.critical_strain,
            exponent: law.exponent,
            storage_limit: law.storage_limit,
            loss_limit: law.loss_limit,
            loss_peak: law.loss_peak,
            highest_strain: law.highest_strain,
            storage_rms: fit.rms[0],
            loss_rms: fit.rms[1],
            own_storage_rms: fit.rms_of_own_law.map(|rms| rms[0]),
            own_loss_rms: fit.rms_of_own_law.map(|rms| rms[1]),
        }
    }
}

fn text(rows: &[Row]) -> String {
    let mut text = String::from(
        "f = f_inf + (1 - f_inf)/(1 + x^2m), g = g_inf + (1 - g_inf)/(1 + x^2m) + 2 g_p x^m/(1 + x^2m), x = strain/critical\n\n",
    );
    text += &format!(
        "{:>16}  {:>7}  {:>8}  {:>8}  {:>10}  {:>6}  {:>6}  {:>6}  {:>6}  {:>9}  {:>9}  {}\n",
        "temperature / °C",
        "strains",
        "E' / MPa",
        "E''/ MPa",
        "critical/%",
        "m",
        "f_inf",
        "g_inf",
        "g_p",
        "rms of E'",
        "rms of E''",
        "with g_inf = 1 (Kraus)"
    );
    for row in rows {
        let own = row.own_storage_rms.zip(row.own_loss_rms);
        let own = own.map_or("no fit".into(), |(storage, loss)| {
            format!("{:.1} %, {:.1} %", 100.0 * storage, 100.0 * loss)
        });
        text += &format!(
            "{:>16}  {:>7}  {:>8}  {:>8}  {:>10}  {:>6.3}  {:>6.3}  {:>6.3}  {:>6.3}  {:>7.1} %  {:>8.1} %  {own}\n",
            row.temperature_c.map_or("not stated".into(), |celsius| celsius.to_string()),
            row.strains,
            significant(row.storage_mpa),
            significant(row.loss_mpa),
            significant(100.0 * row.critical_strain),
            row.exponent,
            row.storage_limit,
            row.loss_limit,
            row.loss_peak,
            100.0 * row.storage_rms,
            100.0 * row.loss_rms,
        );
    }
    text
}
