//! `asperity theory slider`: a hard cylinder or triangle on lubricated rubber.

use super::persson::{Speeds, speeds};
use super::predictions::columns;
use crate::cli::output::{aligned, json, note, print, significant};
use crate::cli::solve::MaterialOptions;
use crate::cli::synth::SliderOptions;
use crate::cli::{CliError, values};
use asperity::rubber::Viscoelastic;
use asperity::theory::SliderTheory;
use asperity::units::Units;
use clap::Args;
use serde::Serialize;

const EXAMPLES: &str = "\
Examples:
  A cylinder of 10 mm radius under 1 N per mm of its length, over six decades of speed:
    asperity theory slider --shape cylinder --radius-mm 10 --force 1 --speed 0.01:10000:2
  A triangle whose flanks rise by 15 degrees:
    asperity theory slider --shape triangle --angle-deg 15 --force 1 --speed 1,10,100 --rubber tread.toml

Exit codes: 0 computed, 1 not written, 2 bad input.";

/// Most rows: more are a mistake.
const MOST_ROWS: usize = 10_000;

/// Estimate the hysteretic friction of a hard slider on lubricated rubber, without solving its contact.
///
/// The dissipation under the pressure of the elastic contact, as Persson (2010) has it for rolling cylinders. The contact itself is
/// solved by `asperity synth slider` and `asperity solve bem`; docs/slider.md compares them.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub(in crate::cli) struct SliderCommand {
    #[command(flatten)]
    slider: SliderOptions,
    /// Normal force in N per mm of the slider's length.
    #[arg(long, value_name = "N_MM", value_parser = values::positive)]
    force: f64,
    /// Sliding speeds in mm/s: numbers separated by commas, or FROM:TO:PER_DECADE.
    #[arg(long, value_name = "MM_S", required = true, value_delimiter = ',', value_parser = speeds)]
    speed: Vec<Speeds>,
    #[command(flatten)]
    material: MaterialOptions,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
}

/// One estimate; the names are the keys of JSON.
#[derive(Debug, Clone, Copy, Serialize)]
struct Row {
    speed_mm_s: f64,
    half_width_mm: f64,
    mean_pressure_mpa: f64,
    friction_coefficient: f64,
}

#[derive(Debug, Serialize)]
struct Summary {
    rubber: String,
    poisson_ratio: f64,
    temperature_c: Option<f64>,
    force_n_per_mm: f64,
    rows: Vec<Row>,
}

impl SliderCommand {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let slider = self.slider.slider()?;
        slider.validate().map_err(|error| CliError::input(error.to_string()))?;
        let material = self.material.material()?;
        let rubber = material.rubber();
        rubber.validate()?;
        let theory = SliderTheory::new(rubber, slider).ok_or_else(|| {
            CliError::input(
                "--tip-radius-mm: the theory has sharp triangles only; leave it out, or solve the contact \
                 (`asperity synth slider`, `asperity solve bem`)",
            )
        })?;
        let speeds: Vec<f64> = self.speed.iter().flat_map(|speeds| speeds.0.clone()).collect();
        if speeds.len() > MOST_ROWS {
            return Err(CliError::input(format!(
                "{} speeds are asked for, at most {MOST_ROWS} are given",
                speeds.len()
            )));
        }
        let rows: Vec<Row> = speeds.iter().map(|speed| self.row(&theory, *speed)).collect();
        require_finite(&rows)?;
        let mut warnings: Vec<String> = rows
            .iter()
            // A contact of the width 2 a excites waves of about that length most.
            .flat_map(|row| {
                material.warnings(vec![2.0 * row.half_width_mm.mm_to_m()], row.speed_mm_s.mm_to_m())
            })
            .collect();
        warnings.dedup();
        warnings.iter().for_each(|warning| note(quiet, format_args!("warning: {warning}")));
        let summary = Summary {
            rubber: rubber.name().into(),
            poisson_ratio: rubber.poisson_ratio(),
            temperature_c: self.material.temperature_c(),
            force_n_per_mm: self.force,
            rows,
        };
        print(&if self.json { json(&summary)? } else { summary.text() })
    }

    fn row(&self, theory: &SliderTheory, speed_mm_s: f64) -> Row {
        // N/mm is MPa mm.
        let force = self.force.mpa_to_pa().mm_to_m();
        let estimate = theory.estimate(force, speed_mm_s.mm_to_m());
        let half_width_mm = estimate.half_width.m_to_mm();
        Row {
            speed_mm_s,
            half_width_mm,
            mean_pressure_mpa: self.force / (2.0 * half_width_mm),
            friction_coefficient: estimate.friction_coefficient,
        }
    }
}

/// # Errors
/// [`CliError::Input`] for lengths, forces or moduli that overflow.
fn require_finite(rows: &[Row]) -> Result<(), CliError> {
    let finite =
        |row: &&Row| row.friction_coefficient.is_finite() && row.mean_pressure_mpa.is_finite();
    match rows.iter().find(|row| !finite(row)) {
        None => Ok(()),
        Some(row) => Err(CliError::input(format!(
            "the contact at {} mm/s overflows double precision: check the units of --force and of the slider",
            row.speed_mm_s
        ))),
    }
}

impl Summary {
    fn text(&self) -> String {
        let temperature = self.temperature_c.map_or(String::new(), |c| format!(" at {c} °C"));
        let head = aligned(&[
            ("rubber", format!("{}{temperature}, nu = {}", self.rubber, self.poisson_ratio)),
            ("force", format!("{} N/mm", self.force_n_per_mm)),
        ]);
        let cells = |row: &Row| {
            [
                significant(row.speed_mm_s),
                significant(row.half_width_mm),
                significant(row.mean_pressure_mpa),
                significant(row.friction_coefficient),
            ]
        };
        let header = ["mm/s", "half-width / mm", "mean pressure / MPa", "friction"];
        format!("{head}\n{}", columns(header, self.rows.iter().map(cells)))
    }
}
