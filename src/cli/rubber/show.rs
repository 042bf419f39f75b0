//! `asperity rubber summary`: what a rubber file holds.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use std::f64::consts::TAU;

use crate::cli::output::{aligned, json, note, print, significant};
use crate::cli::{CliError, values};
use asperity::rubber::causality::Causality;
use asperity::rubber::{
    FrequencyRange, RubberData, RubberModel, TemperatureDependence, Viscoelastic, read_rubber_at,
    read_rubber_data,
};

const EXAMPLES: &str = "\
Examples:
  A rubber at the temperature of its moduli:
    asperity rubber summary data/rubber/generic_sbr_carbon_black.toml
  The same at 60 °C:
    asperity rubber summary data/rubber/generic_sbr_carbon_black.toml --temperature-c 60

Exit codes: 0 readable, 2 bad input.";

/// Frequencies in Hz of a rubber whose range is not stated.
const USUAL: FrequencyRange = FrequencyRange { lowest_hz: 1e-2, highest_hz: 1e8 };
/// Rows of the table of moduli, at most.
const MOST_ROWS: i32 = 12;

/// Show what a rubber file holds: model, moduli, shift with temperature, softening with strain, and whether a table is causal.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(in crate::cli) struct Show {
    /// Rubber file.
    #[arg(value_name = "RUBBER.TOML")]
    rubber: PathBuf,
    /// Temperature in °C [default: that of the moduli in the file].
    #[arg(long, value_name = "C", value_parser = values::finite, allow_negative_numbers = true)]
    temperature_c: Option<f64>,
    /// Print JSON with full precision instead of tables.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Modulus {
    frequency_hz: f64,
    storage_mpa: f64,
    loss_mpa: f64,
    loss_factor: f64,
}

#[derive(Debug, Serialize)]
struct Summary {
    name: String,
    model: String,
    temperature_c: Option<f64>,
    measured: Option<FrequencyRange>,
    shift: Option<String>,
    moduli: Vec<Modulus>,
    #[serde(skip_serializing_if = "Option::is_none")]
    causality: Option<Causality>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    softening: Vec<Softening>,
}

/// Softening at a few strains, at the temperature of the summary.
#[derive(Debug, Serialize)]
struct Softening {
    strain: f64,
    storage_factor: f64,
    loss_factor: f64,
}

impl Show {
    pub(in crate::cli) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let oddities = read_rubber_data(&self.rubber)?.oddities();
        let data = read_rubber_at(&self.rubber, self.temperature_c)?;
        let of_strain = data.payne.as_ref().zip(data.temperature_c());
        let of_strain = of_strain.and_then(|(payne, celsius)| payne.extrapolation(celsius));
        for warning in oddities.into_iter().chain(data.extrapolations(None)).chain(of_strain) {
            note(quiet, format_args!("warning: {warning}"));
        }
        let summary = Summary::new(&data);
        print(&if self.json { json(&summary)? } else { summary.text() })
    }
}

impl Summary {
    fn new(data: &RubberData) -> Self {
        let range = data.measured.unwrap_or(USUAL);
        let (first, last) =
            (range.lowest_hz.log10().ceil() as i32, range.highest_hz.log10().floor() as i32);
        let step = ((last - first) / MOST_ROWS + 1).max(1);
        let modulus = |decade: i32| {
            let frequency_hz = 10_f64.powi(decade);
            let modulus = data.rubber.complex_modulus(TAU * frequency_hz);
            Modulus {
                frequency_hz,
                storage_mpa: 1e-6 * modulus.re,
                loss_mpa: 1e-6 * modulus.im,
                loss_factor: modulus.im / modulus.re,
            }
        };
        let law = data.payne_law();
        let strains = [1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 3e-1];
        let softening = law.iter().flat_map(|law| {
            strains.iter().filter(|strain| **strain <= law.highest_strain()).map(|strain| {
                let [storage_factor, loss_factor] = law.factors(*strain);
                Softening { strain: *strain, storage_factor, loss_factor }
            })
        });
        Self {
            name: data.rubber.name().into(),
            model: model(&data.rubber),
            temperature_c: data.temperature_c(),
            measured: data.measured,
            shift: data.temperature.as_ref().map(shift),
            moduli: (first..=last).step_by(step as usize).map(modulus).collect(),
            causality: data.rubber.table().map(Causality::of),
            softening: softening.collect(),
        }
    }

    fn text(&self) -> String {
        let mut lines = vec![("rubber", self.name.clone()), ("model", self.model.clone())];
        if let Some(celsius) = self.temperature_c {
            lines.push(("temperature", format!("{celsius} °C")));
        }
        lines.extend(self.shift.iter().map(|shift| ("shift factors", shift.clone())));
        lines.extend(self.measured.map(|range| {
            (
                "measured",
                format!(
                    "{:.3e} to {:.3e} Hz at this temperature",
                    range.lowest_hz, range.highest_hz
                ),
            )
        }));
        lines.extend(self.causality.iter().map(|found| ("causality", found.summary())));
        let mut text = aligned(&lines);
        text += &format!(
            "\n{:>14}  {:>10}  {:>10}  {:>9}\n",
            "frequency / Hz", "E' / MPa", "E'' / MPa", "tan delta"
        );
        for row in &self.moduli {
            text += &format!(
                "{:>14.0e}  {:>10}  {:>10}  {:>9.4}\n",
                row.frequency_hz,
                significant(row.storage_mpa),
                significant(row.loss_mpa),
                row.loss_factor
            );
        }
        if !self.softening.is_empty() {
            text += &format!("\n{:>10}  {:>10}  {:>12}\n", "strain / %", "E'/E'(0)", "E''/E''(0)");
        }
        for row in &self.softening {
            text += &format!(
                "{:>10}  {:>10.4}  {:>12.4}\n",
                significant(100.0 * row.strain),
                row.storage_factor,
                row.loss_factor
            );
        }
        text
    }
}

fn model(rubber: &RubberModel) -> String {
    match rubber {
        RubberModel::Maxwell(rubber) => format!(
            "Maxwell, {} branches, {} to {} MPa, Poisson ratio {}",
            rubber.branches.len(),
            significant(1e-6 * rubber.equilibrium_modulus),
            significant(1e-6 * rubber.glassy_modulus()),
            rubber.poisson_ratio
        ),
        RubberModel::Table(table) => format!(
            "table of {} moduli, Poisson ratio {}, outside its frequencies {}",
            table.points().len(),
            table.poisson_ratio(),
            match table.extrapolation() {
                asperity::rubber::Extrapolation::Refuse => "refused",
                asperity::rubber::Extrapolation::Hold => "held",
            }
        ),
    }
}

fn shift(dependence: &TemperatureDependence) -> String {
    let range =
        dependence.measured_c.map_or(String::new(), |[low, high]| format!(", {low} to {high} °C"));
    format!("{}{range}", dependence.law.name())
}
