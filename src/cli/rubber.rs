//! `asperity rubber`: a rubber file from measured moduli.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde::Serialize;

use super::output::{aligned, already_exists, json, note, print, significant, write_file};
use super::{CliError, values};
use crate::report::rubber_figure;
use crate::rubber::fit::{
    Candidate, Estimate, FitOptions, FittedLaw, FittedTerm, MasterCurve, Misfit, ModulusKind,
    ReducedPoint, ShiftFactor, fit_sweeps, read_sweeps,
};
use crate::rubber::{FrequencyRange, ShiftLaw};

const EXAMPLES: &str = "\
Examples:
  A sweep of Young's modulus with the columns frequency_hz, storage_mpa and loss_mpa:
    asperity rubber fit sweep.csv --kind youngs --to tread.toml
  Shear moduli at several temperatures (column temperature_c), shifted to 20 °C, with a plot:
    asperity rubber fit sweeps.csv --kind shear --reference-temperature-c 20 --to tread.toml --plot tread.svg
  Friction of that rubber at 40 °C:
    asperity solve bem --wave 0.0625:0.01867 --speed 10 --pressure 3.3 --rubber tread.toml --temperature-c 40

Exit codes: 0 fitted, 1 no fit or not written, 2 bad input.";

/// Relative misfit (root mean square) above which the fit is called poor.
const POOR: f64 = 0.1;

/// Ratio of a limit of the fitted storage modulus to what was measured next to it, above which that
/// limit is no measured plateau.
const NO_PLATEAU: f64 = 1.2;

#[derive(Debug, Subcommand)]
pub(super) enum Rubber {
    Fit(Fit),
}

/// Fit a rubber to storage and loss moduli over frequency, at one or several temperatures.
///
/// The CSV file has a header with the columns frequency_hz (or angular_frequency_rad_s),
/// storage_mpa, loss_mpa (or _pa, _kpa, _gpa) and, optionally, temperature_c. Sweeps at several
/// temperatures become a master curve; the rubber file then holds the law of the shift, so that
/// it can be had at other temperatures. docs/rubber_data.md explains the method.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Fit {
    /// CSV file of the measured points.
    #[arg(value_name = "SWEEP.CSV")]
    sweep: PathBuf,
    /// Which modulus was measured; never guessed.
    #[arg(long, value_name = "KIND")]
    kind: ModulusKind,
    /// Poisson ratio of the rubber, 0 to 0.5; also makes Young's modulus of shear: E = 2 (1 + nu) G.
    #[arg(long, value_name = "NU", default_value = "0.49", value_parser = values::finite, allow_negative_numbers = true)]
    poisson_ratio: f64,
    /// Number of terms [default: the one with the least criterion of Schwarz].
    #[arg(long, value_name = "N", value_parser = values::count::<usize>, allow_negative_numbers = true)]
    terms: Option<usize>,
    /// Reference temperature in °C, one of those measured [default: the middle one].
    #[arg(long, value_name = "C", value_parser = values::finite, allow_negative_numbers = true)]
    reference_temperature_c: Option<f64>,
    /// Name of the rubber in tables [default: that of the file].
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Rubber file to write.
    #[arg(long, value_name = "RUBBER.TOML")]
    to: PathBuf,
    /// Also draw moduli and shift factors, measured and fitted, to this SVG file.
    #[arg(long, value_name = "PLOT.SVG")]
    plot: Option<PathBuf>,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
    /// Overwrite files that are there already.
    #[arg(long)]
    force: bool,
}

/// What is printed; the names are the keys of the JSON object, in SI but for units in names.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    equilibrium_modulus: Estimate,
    terms: &'a [FittedTerm],
    misfit: Misfit,
    points: usize,
    measured: FrequencyRange,
    reference_c: Option<f64>,
    shifts: &'a [ShiftFactor],
    laws: &'a [FittedLaw],
    candidates: &'a [Candidate],
}

impl Rubber {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        match self {
            Self::Fit(fit) => fit.run(quiet),
        }
    }
}

impl Fit {
    fn run(&self, quiet: bool) -> Result<(), CliError> {
        self.check()?;
        let factor = self.kind.factor(self.poisson_ratio);
        let sweeps = read_sweeps(&self.sweep, factor)?;
        let options = FitOptions { terms: self.terms, reference_c: self.reference_temperature_c };
        let fit = fit_sweeps(&sweeps, &options).map_err(|error| self.refusal(error))?;
        for warning in warnings(&fit) {
            note(quiet, format_args!("warning: {warning}"));
        }
        let source = format!("asperity rubber fit to {}", file_name(&self.sweep));
        let text = fit.rubber(&self.name(), self.poisson_ratio).to_toml(&source);
        let svg = self.plot.as_ref().map(|_| rubber_figure(&fit)).transpose();
        let svg = svg.map_err(CliError::failure)?;
        write_file(&self.to, self.force, |out| out.write_all(text.as_bytes()))?;
        if let (Some(path), Some(svg)) = (&self.plot, svg) {
            write_file(path, self.force, |out| out.write_all(svg.as_bytes()))?;
        }
        let summary = Summary::new(&fit);
        print(&if self.json { json(&summary)? } else { summary.table() })
    }

    /// What is wrong before anything is read or written.
    fn check(&self) -> Result<(), CliError> {
        if !(0.0..=0.5).contains(&self.poisson_ratio) {
            let ratio = self.poisson_ratio;
            return Err(CliError::input(format!(
                "--poisson-ratio is {ratio}, it must lie between 0 and 0.5"
            )));
        }
        if self.terms == Some(0) {
            return Err(CliError::input("--terms is 0: give at least 1, or leave it out"));
        }
        if self.plot.as_ref() == Some(&self.to) {
            return Err(CliError::input("--to and --plot are the same file: choose another one"));
        }
        let outputs = [Some(&self.to), self.plot.as_ref()];
        let same = |output: &Path| match (output.canonicalize(), self.sweep.canonicalize()) {
            (Ok(output), Ok(input)) => output == input,
            _ => false,
        };
        for output in outputs.into_iter().flatten() {
            if same(output) {
                let path = output.display();
                return Err(CliError::input(format!(
                    "{path} is the measured sweep: choose another file for the result"
                )));
            }
            if output.exists() && !self.force {
                return Err(already_exists(output));
            }
        }
        Ok(())
    }

    fn refusal(&self, error: crate::rubber::fit::FitError) -> CliError {
        use crate::rubber::fit::FitError;
        let text = format!("{}: {error}", self.sweep.display());
        match error {
            FitError::NoFit { .. } => CliError::failure(text),
            FitError::Reference { measured_c, .. } if measured_c.is_empty() => {
                CliError::input(format!(
                    "{}: there is no column temperature_c: add it, or leave out --reference-temperature-c",
                    self.sweep.display()
                ))
            }
            _ => CliError::input(text),
        }
    }

    fn name(&self) -> String {
        let of_file = || self.to.file_stem().map(crate::files::name::text);
        self.name.clone().or_else(of_file).unwrap_or_else(|| "rubber".into())
    }
}

fn file_name(path: &Path) -> String {
    crate::files::name::text(path.file_name().unwrap_or(path.as_os_str()))
}

/// What a user should know before using the rubber.
fn warnings(fit: &MasterCurve) -> Vec<String> {
    let mut warnings = Vec::new();
    let equilibrium = fit.equilibrium_modulus.value;
    let glassy = equilibrium + fit.terms.iter().map(|term| term.modulus.value).sum::<f64>();
    let by_frequency = |a: &&ReducedPoint, b: &&ReducedPoint| {
        a.point.angular_frequency.total_cmp(&b.point.angular_frequency)
    };
    let slowest = fit.points.iter().min_by(by_frequency).map(|p| p.point.storage_modulus);
    let fastest = fit.points.iter().max_by(by_frequency).map(|p| p.point.storage_modulus);
    for (end, limit, ratio) in [
        ("lowest", "slow", slowest.map(|storage| storage / equilibrium)),
        ("highest", "fast", fastest.map(|storage| glassy / storage)),
    ] {
        if let Some(ratio) = ratio.filter(|ratio| *ratio > NO_PLATEAU) {
            warnings.push(format!(
                "at the {end} measured frequency the storage modulus is a factor of {ratio:.2} from the fit's \
                 limit of {limit} loading: that limit is extrapolated, its intervals mean little"
            ));
        }
    }
    let misfit = &fit.misfit;
    let worst = misfit.storage_modulus.rms.max(misfit.loss_modulus.rms);
    if worst > POOR {
        warnings.push(format!(
            "the fit is {:.0} % off (root mean square): moduli that do not belong together, noise, or \
             temperatures that do not superpose; look at --plot",
            100.0 * worst
        ));
    }
    if fit.shifts.len() > 1 && fit.laws.is_empty() {
        warnings.push(
            "the shift factors follow no law that gets softer with heat: the rubber file has no [temperature] \
             section"
                .into(),
        );
    }
    warnings
}

impl<'a> Summary<'a> {
    fn new(fit: &'a MasterCurve) -> Self {
        Self {
            equilibrium_modulus: fit.equilibrium_modulus,
            terms: &fit.terms,
            misfit: fit.misfit,
            points: fit.points.len(),
            measured: fit.measured,
            reference_c: fit.reference_c,
            shifts: &fit.shifts,
            laws: &fit.laws,
            candidates: &fit.candidates,
        }
    }

    fn table(&self) -> String {
        let mut text = format!(
            "{:<12}  {:<34}  relaxation time / s\n",
            "term", "modulus / MPa (95 % interval)"
        );
        let equilibrium = interval(&self.equilibrium_modulus, 1e6);
        text += &format!("{:<12}  {equilibrium}\n", "equilibrium");
        for (k, term) in self.terms.iter().enumerate() {
            let (modulus, time) =
                (interval(&term.modulus, 1e6), interval(&term.relaxation_time, 1.0));
            text += &format!("{:<12}  {modulus:<34}  {time}\n", k + 1);
        }
        text += "\n";
        let percent = |value: f64| format!("{} %", significant(100.0 * value));
        let of = |d: &crate::rubber::fit::Deviation| {
            format!("{} rms, {} at most", percent(d.rms), percent(d.largest))
        };
        let range = self.measured;
        let at = self.reference_c.map_or(String::new(), |reference| format!(" at {reference} °C"));
        text += &aligned(&[
            ("terms", format!("{} ({} numbers tried)", self.terms.len(), self.candidates.len())),
            ("points", self.points.to_string()),
            ("measured", format!("{:.3e} to {:.3e} Hz{at}", range.lowest_hz, range.highest_hz)),
            ("error of E'", of(&self.misfit.storage_modulus)),
            ("error of E''", of(&self.misfit.loss_modulus)),
            ("error of tan delta", of(&self.misfit.loss_factor)),
        ]);
        if !self.shifts.is_empty() {
            text += "\ntemperature / °C  log10 of the shift factor\n";
            for shift in self.shifts {
                let half =
                    shift.confidence_95.map_or("reference".into(), |half| format!("± {half:.1e}"));
                text +=
                    &format!("{:>16}  {:>9.4} {half}\n", shift.temperature_c, shift.log10_shift);
            }
            text += "\n";
            text += &self.laws.iter().map(law).collect::<String>();
        }
        text
    }
}

fn interval(estimate: &Estimate, unit: f64) -> String {
    let number = |value: f64| significant(value / unit);
    match estimate.confidence_95 {
        Some([low, high]) => {
            format!("{} ({} to {})", number(estimate.value), number(low), number(high))
        }
        None => format!("{} (at the limit)", number(estimate.value)),
    }
}

fn law(fitted: &FittedLaw) -> String {
    let half = |k: usize| {
        let half_widths = fitted.confidence_95.as_ref();
        half_widths.map_or(String::new(), |half| format!(" ± {}", significant(half[k])))
    };
    let coefficients = match fitted.law {
        ShiftLaw::Wlf { c1, c2_k } => {
            format!(
                "WLF        c1 {}{}, c2 {}{} K",
                significant(c1),
                half(0),
                significant(c2_k),
                half(1)
            )
        }
        ShiftLaw::Arrhenius { activation_energy_kj_mol: energy } => {
            format!("Arrhenius  activation energy {}{} kJ/mol", significant(energy), half(0))
        }
    };
    format!("{coefficients}; residual {} decades\n", significant(fitted.residual_decades))
}
