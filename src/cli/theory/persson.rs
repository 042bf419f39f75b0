//! `asperity theory persson`: Persson's theory on an isotropic surface.

use std::path::{Path, PathBuf};

use asperity::units::Units;
use clap::{Args, ValueEnum};
use serde::Serialize;

use super::flash::{FlashOptions, FlashRow};
use super::predictions::{Row, flash_table, table, write_csv};
use super::surface::{Roughness, Surface, SurfaceOptions};
use crate::cli::output::{aligned, json, note, print, refuse_existing, significant, write_file};
use crate::cli::solve::{Material, MaterialOptions, refuse_to_overwrite};
use crate::cli::{CliError, values};
use asperity::rubber::Viscoelastic;
use asperity::theory::{Diffusion, IsotropicPersson, PerssonOptions};

const EXAMPLES: &str = "\
Examples:
  A two-dimensional spectrum with q in rad/m and C in m4, at 0.3 MPa and three speeds:
    asperity theory persson --spectrum road.txt --wavenumber-unit rad/m --density-unit m4 --pressure 0.3 --speed 1,10,100
  The spectrum of a line in waves per mm, down to waves of 0.01 mm, over six decades of speed, as CSV:
    asperity theory persson --spectrum line.txt --wavenumber-unit 1/mm --density-unit mm3 --shortest-wavelength-mm 0.01 \
      --rubber tread.toml --temperature-c 20 --pressure 0.3 --speed 0.001:1000:5 --to friction.csv
  A map of an instrument, over the magnification:
    asperity theory persson --map road.x3p --pressure 0.1,0.3 --speed 10 --magnifications-per-decade 4
  The area with the spread of the pressure reduced as the strain is (Yang and Persson 2008):
    asperity theory persson --map road.x3p --pressure 0.3 --speed 10 --diffusion reduced --json

Exit codes: 0 computed, 1 not converged or not written, 2 bad input.";

/// Largest share of unmeasured frequencies without a warning.
const UNMEASURED: f64 = 0.01;
/// Most rows: more are a mistake.
const MOST_ROWS: usize = 100_000;

/// Predict contact area, friction and gap by Persson's theory, for rubber on an isotropic surface.
///
/// The surface is known by its spectrum: of a file (--spectrum), a line scan (--scan) or a height map (--map). The theory
/// has hysteretic friction alone, and no contact is solved; docs/theories.md states formulas and conventions.
#[derive(Debug, Args)]
#[command(name = "persson", after_help = EXAMPLES)]
pub(in crate::cli) struct PerssonCommand {
    #[command(flatten)]
    surface: SurfaceOptions,
    /// Sliding speeds in mm/s: numbers separated by commas, or FROM:TO:PER_DECADE.
    #[arg(long, value_name = "MM_S", required = true, value_delimiter = ',', value_parser = speeds, allow_negative_numbers = true)]
    speed: Vec<Speeds>,
    /// Mean pressures in MPa, separated by commas.
    #[arg(long, value_name = "MPA", required = true, value_delimiter = ',', value_parser = values::positive, allow_negative_numbers = true)]
    pressure: Vec<f64>,
    #[command(flatten)]
    material: MaterialOptions,
    /// Share of the strain of full contact that is left in vanishing contact, 0 to 1: S = gamma + (1 - gamma) P^2. 0.5 is
    /// usual; the theory of 2001 has 1.
    #[arg(long, value_name = "GAMMA", default_value_t = 0.5, value_parser = share, allow_negative_numbers = true)]
    gamma: f64,
    /// What the diffusion of the pressure takes for the stress of the waves: that of full contact, or that times S.
    #[arg(long, value_enum, value_name = "STRESS", default_value_t = Stress::Full)]
    diffusion: Stress,
    /// Also give the predictions with the waves up to so many magnifications in every decade.
    #[arg(long, value_name = "N", value_parser = values::one_or_more::<u32>, allow_negative_numbers = true)]
    magnifications_per_decade: Option<u32>,
    /// Relative accuracy of the quadrature.
    #[arg(long, value_name = "RELATIVE", default_value_t = 1e-6, value_parser = accuracy, allow_negative_numbers = true)]
    tolerance: f64,
    #[command(flatten)]
    flash: FlashOptions,
    /// Print JSON with full precision instead of a table.
    #[arg(long, help_heading = "Options")]
    json: bool,
    /// Also write all columns to this CSV file; with --flash, those of the heated rubber stay empty but for all waves.
    #[arg(long, help_heading = "Options", value_name = "FILE")]
    to: Option<PathBuf>,
    /// Overwrite a file that is there already.
    #[arg(long, help_heading = "Options")]
    force: bool,
}

/// What spreads the pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Stress {
    /// The stress of full contact (Persson 2001): gamma reduces friction alone.
    Full,
    /// Reduced by S (Yang and Persson 2008): gamma enlarges the area as well.
    Reduced,
}

/// One speed in mm/s, or a range of them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Speeds(pub(super) Vec<f64>);

pub(super) fn speeds(text: &str) -> Result<Speeds, String> {
    let parts: Vec<&str> = text.split(':').collect();
    match parts[..] {
        [one] => Ok(Speeds(vec![values::positive(one)?])),
        [from, to, per_decade] => {
            let (from, to) = (values::positive(from)?, values::positive(to)?);
            let per_decade = f64::from(values::one_or_more::<u16>(per_decade)?);
            if from >= to {
                return Err(format!("{from} is not below {to}: a range is FROM:TO:PER_DECADE"));
            }
            let steps = (per_decade * (to / from).log10()).round().max(1.0);
            // A decade above 0.001 is 0.01, not that and a round-off.
            let at = |k: usize| rounded(from * (to / from).powf(k as f64 / steps));
            let inside = (1..steps as usize).map(at);
            Ok(Speeds([from].into_iter().chain(inside).chain([to]).collect()))
        }
        _ => Err(format!("`{text}` is neither a speed nor FROM:TO:PER_DECADE")),
    }
}

/// The value to 13 significant digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.12e}").parse().unwrap_or(value)
}

fn share(text: &str) -> Result<f64, String> {
    match values::finite(text)? {
        value if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err(format!("{} is not from 0 to 1", text.trim())),
    }
}

fn accuracy(text: &str) -> Result<f64, String> {
    match values::finite(text)? {
        value if (1e-10..=0.01).contains(&value) => Ok(value),
        _ => Err(format!("{} is not from 1e-10 to 0.01", text.trim())),
    }
}

/// What is printed as JSON.
#[derive(Debug, Serialize)]
struct Summary {
    surface: Roughness,
    rubber: String,
    poisson_ratio: f64,
    temperature_c: Option<f64>,
    gamma: f64,
    diffusion: Stress,
    tolerance: f64,
    rows: Vec<Row>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    flash: Vec<FlashRow>,
}

impl PerssonCommand {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let warn = |warning: &str| note(quiet, format_args!("warning: {warning}"));
        let material = self.material.material()?;
        let [spectrum, scan, map] = self.surface.inputs();
        let inputs: [Option<&Path>; 4] = [spectrum, scan, map, self.material.file()];
        refuse_to_overwrite(self.to.as_deref(), "--to", &inputs)?;
        refuse_existing(self.to.as_deref(), self.force)?;
        let surface = self.surface.surface()?;
        surface.warnings.iter().for_each(|warning| warn(warning));
        let (rows, flash) = self.rows(&material, &surface)?;
        let excited = self
            .extreme_speeds()
            .map(|speed| material.warnings(surface.wavelengths(), speed.mm_to_m()));
        let all = excited.concat();
        let first = |(k, warning): &(usize, &String)| !all[..*k].contains(warning);
        all.iter().enumerate().filter(first).for_each(|(_, warning)| warn(warning));
        let unmeasured = rows.iter().map(|row| row.unmeasured_share).fold(0.0, f64::max);
        if unmeasured > UNMEASURED {
            warn(&format!(
                "{:.1} % of a result come from waves across the sliding, at frequencies below those that were measured",
                100.0 * unmeasured
            ));
        }
        if let Some((law, _)) = self.flash.asked(&material)?
            && let Some([_, known]) = law.measured_c
        {
            let rise = flash.iter().map(|row| row.rise_k).fold(0.0, f64::max);
            if law.reference_c + rise > known {
                warn(&format!(
                    "the rubber becomes up to {:.1} °C warm, and its shift with temperature was measured up to {known} °C: beyond \
                     that it is extrapolated",
                    law.reference_c + rise
                ));
            }
        }
        if let Some(path) = &self.to {
            write_file(path, self.force, |out| write_csv(out, &rows, &flash))?;
        }
        let summary = Summary {
            surface: surface.roughness(),
            rubber: material.rubber().name().into(),
            poisson_ratio: material.rubber().poisson_ratio(),
            temperature_c: self.material.temperature_c(),
            gamma: self.gamma,
            diffusion: self.diffusion,
            tolerance: self.tolerance,
            rows,
            flash,
        };
        print(&if self.json { json(&summary)? } else { summary.text() })
    }

    /// The predictions, and those with heat for all waves if they are asked for.
    fn rows(
        &self,
        material: &Material,
        surface: &Surface,
    ) -> Result<(Vec<Row>, Vec<FlashRow>), CliError> {
        let options = PerssonOptions {
            gamma: self.gamma,
            diffusion: match self.diffusion {
                Stress::Full => Diffusion::Full,
                Stress::Reduced => Diffusion::Reduced,
            },
            tolerance: self.tolerance,
        };
        let speeds: Vec<f64> = self.speed.iter().flat_map(|speeds| speeds.0.clone()).collect();
        let per_decade = self.magnifications_per_decade.map_or(1.0, f64::from);
        if per_decade > MOST_ROWS as f64 {
            return Err(CliError::input(format!(
                "--magnifications-per-decade is {per_decade}, at most {MOST_ROWS} rows are given: ask for fewer"
            )));
        }
        let marks = self.marks(surface.band);
        let count = speeds.len() * self.pressure.len() * marks.len();
        if count > MOST_ROWS {
            return Err(CliError::input(format!(
                "{count} rows are asked for, at most {MOST_ROWS} are given: ask for fewer speeds, pressures or magnifications"
            )));
        }
        let rubber = material.rubber();
        let theory = IsotropicPersson::new(&surface.spectrum, rubber, surface.band, options)?;
        let heat = self.flash.asked(material)?;
        let (mut rows, mut flash) = (Vec::with_capacity(count), Vec::new());
        for &speed in &speeds {
            for &pressure in &self.pressure {
                let predictions =
                    theory.over_wavenumbers(speed.mm_to_m(), pressure.mpa_to_pa(), &marks)?;
                rows.extend(predictions.iter().map(|at| Row::new(speed, pressure, at)));
                if let Some(heat) = &heat {
                    flash.push(self.flash.row(&theory, heat, speed, pressure)?);
                }
            }
        }
        Ok((rows, flash))
    }

    /// Wavenumbers in rad/m up to which predictions are given; the last is that of the shortest wave.
    fn marks(&self, [first, last]: [f64; 2]) -> Vec<f64> {
        let Some(per_decade) = self.magnifications_per_decade else { return vec![last] };
        let step = 10_f64.powf(f64::from(per_decade).recip());
        let at = |k: i32| first * step.powi(k);
        // The last step may be short, but not a matter of round-off.
        let inside = (1..).map(at).take_while(|q| *q < last * (1.0 - 1e-9));
        inside.chain([last]).collect()
    }

    fn extreme_speeds(&self) -> [f64; 2] {
        let all = || self.speed.iter().flat_map(|speeds| speeds.0.iter().copied());
        [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)]
    }
}

impl Summary {
    fn text(&self) -> String {
        let mut lines = self.surface.lines();
        let temperature = self.temperature_c.map_or(String::new(), |c| format!(" at {c} °C"));
        lines
            .push(("rubber", format!("{}{temperature}, nu = {}", self.rubber, self.poisson_ratio)));
        let diffusion = match self.diffusion {
            Stress::Full => "diffusion with the stress of full contact",
            Stress::Reduced => "diffusion with the reduced stress",
        };
        lines.push(("theory", format!("gamma = {}, {diffusion}", self.gamma)));
        lines.push(("quadrature", format!("relative error below {}", significant(self.tolerance))));
        let cold = format!("{}\n{}", aligned(&lines), table(&self.rows));
        match self.flash[..] {
            [] => cold,
            _ => format!(
                "{cold}\ncold, and hot by Persson's flash temperature\n{}",
                flash_table(&self.rows, &self.flash)
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_speeds_hold_both_ends() {
        assert_eq!(speeds("10").unwrap(), Speeds(vec![10.0]));
        let Speeds(range) = speeds("0.1:100:2").unwrap();
        assert_eq!((range.len(), range[0], range[6]), (7, 0.1, 100.0));
        approx::assert_relative_eq!(range[1], 0.1 * 10_f64.sqrt(), max_relative = 1e-12);
        let decades = Speeds([0.001, 0.01, 0.1, 1.0, 10.0, 100.0].to_vec());
        assert_eq!(speeds("0.001:100:1").unwrap(), decades);
        for text in ["", "0", "-1", "1:2", "2:1:3", "1:2:0", "1:2:3:4", "a:b:c", "nan"] {
            assert!(speeds(text).is_err(), "{text}");
        }
    }
}
