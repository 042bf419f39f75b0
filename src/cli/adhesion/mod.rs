//! `asperity adhesion`: the shear stress of the contact area from measured friction.

mod summary;

use super::last_run::LastRun;
use super::output::{json, note, print, refuse_existing, write_file};
use super::solve::refuse_to_overwrite;
use super::{CliError, run_folder, values};
use asperity::interface::{FittedShear, Fixed, MeasuredFriction, fit_shear};
use asperity::measurement::{Choice, Computed, MeasuredFile, Temperatures, beside, read_measured};
use asperity::recipe::Recipe;
use asperity::stages::realise::{Method, SurfaceKind};
use asperity::stages::tables::Model;
use asperity::units::Units;
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};
use summary::{Summary, section};

const EXAMPLES: &str = "\
Examples:
  The shear stress that explains measured friction, from a run at the pressure of the measurement:
    asperity adhesion fit measured.csv --run runs/road --to adhesion.toml
  With a known activation energy and width, of a run with several kinds of surfaces:
    asperity adhesion fit measured.csv --run runs/road --method measured --activation-ev 0.97 --reference-c 20 --width 0.1
  The file has a header such as speed_mm_s, friction and, optionally, temperature_c and pressure_mpa.

Exit codes: 0 fitted, 1 the measurements determine no law, 2 bad input.";

#[derive(Debug, Subcommand)]
pub(super) enum Adhesion {
    Fit(Fit),
}

/// Fit the shear stress of the contact area to measured friction.
///
/// The run gives hysteretic friction and contact area over the speed at the pressure of the measurement; the rest of the measured friction
/// is put down to a shear stress tau_f of the contact area: tau_f = shear exp(-width log10(v a / speed)^2), with
/// a = exp(activation/k (1/T - 1/T_0)). The shear stress belongs to the shortest wavelength of the run, since the contact area does.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Fit {
    /// Measured friction: a table with a header.
    #[arg(value_name = "MEASURED.CSV")]
    measured: PathBuf,
    /// Run folder with friction at the pressure of the measurement (bem.pressures_mpa).
    #[arg(long, value_name = "RUN")]
    run: PathBuf,
    /// Contact model of the hysteresis [default: bem].
    #[arg(long, value_enum, value_name = "MODEL")]
    model: Option<Model>,
    /// Kind of surfaces, if the run has several.
    #[arg(long, value_enum, value_name = "METHOD")]
    method: Option<Method>,
    /// Number of waves of the sines, beside --method sines.
    #[arg(long, value_name = "N", value_parser = values::count::<u32>, allow_negative_numbers = true)]
    waves: Option<u32>,
    /// Pressure in MPa, if the run has several.
    #[arg(long, value_name = "MPA", value_parser = values::positive, allow_negative_numbers = true)]
    pressure: Option<f64>,
    /// Temperature in °C of measurements whose file has none [default: that of the run].
    #[arg(long, value_name = "C", value_parser = values::finite, allow_negative_numbers = true)]
    temperature_c: Option<f64>,
    /// Fix the speed in mm/s of the largest shear stress; it holds at --reference-c where the law shifts with temperature.
    #[arg(long, value_name = "MM_S", value_parser = values::positive, allow_negative_numbers = true)]
    speed: Option<f64>,
    /// Fix the width.
    #[arg(long, value_name = "C", value_parser = values::positive, allow_negative_numbers = true)]
    width: Option<f64>,
    /// Fix the activation energy in eV.
    #[arg(long, value_name = "EV", value_parser = values::finite, allow_negative_numbers = true)]
    activation_ev: Option<f64>,
    /// Temperature in °C at which the speed of the law holds, given by --speed or fitted [default: that of the run, if
    /// measurements differ in temperature].
    #[arg(long, value_name = "C", value_parser = values::finite, allow_negative_numbers = true)]
    reference_c: Option<f64>,
    /// Write the section [adhesion] of a recipe to this file.
    #[arg(long, value_name = "FILE.TOML")]
    to: Option<PathBuf>,
    /// Overwrite a file that is there already.
    #[arg(long)]
    force: bool,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
}

impl Adhesion {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        match self {
            Self::Fit(fit) => fit.run(quiet),
        }
    }
}

impl Fit {
    fn run(&self, quiet: bool) -> Result<(), CliError> {
        refuse_existing(self.to.as_deref(), self.force)?;
        refuse_to_overwrite(self.to.as_deref(), "--to", &[Some(&self.measured)])?;
        self.refuse_inside_the_run()?;
        let file = read_measured(&self.measured, &[])?;
        let view = run_folder::view_of_case(&self.run)?;
        let last_run = LastRun::read(&self.run, quiet);
        if let Some(doubt) = last_run.as_ref().and_then(|last| last.doubt(&self.run, "tables")) {
            note(quiet, format_args!("warning: {doubt}"));
        }
        let computed = Computed::read(&view, self.choice()?)?;
        self.check_pressures(&file, &computed)?;
        let recipe = last_run.and_then(|last| last.recipe_of(&self.run));
        let temperatures = self.temperatures(&file, recipe.as_ref())?;
        let of = |index: usize| {
            let line = file.lines[index];
            let found = beside(&file, index, &temperatures, &computed);
            found.map(|found| found.measured).map_err(|error| {
                CliError::input(format!("{}, line {line}: {error}", self.measured.display()))
            })
        };
        let measured = (0..file.points.len()).map(of).collect::<Result<Vec<_>, _>>()?;
        let reference_c = self.reference(&temperatures)?;
        let fixed = Fixed {
            peak_speed: self.speed.map(Units::mm_to_m),
            width: self.width,
            energy_ev: self.activation_ev,
        };
        let fit = fit_shear(&measured, reference_c, fixed)?;
        for warning in warnings(&fit, &measured) {
            note(quiet, format_args!("warning: {warning}"));
        }
        let text = section(&fit, &computed, &self.measured, &measured);
        if let Some(path) = &self.to {
            write_file(path, self.force, |out| out.write_all(text.as_bytes()))?;
        }
        let summary = Summary::new(&fit, &computed, &measured);
        print(&if self.json { json(&summary)? } else { summary.table() })
    }

    /// Nothing is written among the results that are read.
    fn refuse_inside_the_run(&self) -> Result<(), CliError> {
        let Some(folder) = self.to.as_deref().map(|to| to.parent().unwrap_or(Path::new(""))) else {
            return Ok(());
        };
        let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        match (here.canonicalize(), self.run.canonicalize()) {
            (Ok(here), Ok(run)) if here.starts_with(&run) => Err(CliError::input(format!(
                "--to would write into the run folder {}: choose another place",
                self.run.display()
            ))),
            _ => Ok(()),
        }
    }

    fn choice(&self) -> Result<Choice, CliError> {
        let kind = match (self.method, self.waves) {
            (Some(Method::Sines) | None, Some(waves)) => Some(SurfaceKind::sines(waves)),
            (Some(Method::Sines), None) => {
                return Err(CliError::input("--method sines needs --waves, the number of waves"));
            }
            (Some(method), None) => Some(SurfaceKind::of(method)),
            (Some(method), Some(_)) => {
                let name = method.name();
                return Err(CliError::input(format!(
                    "--waves is for --method sines: leave it out beside {name}"
                )));
            }
            (None, None) => None,
        };
        Ok(Choice { model: self.model, kind, pressure_mpa: self.pressure, effect: None })
    }

    /// Measurements at another pressure than that of the run have another friction.
    fn check_pressures(&self, file: &MeasuredFile, computed: &Computed) -> Result<(), CliError> {
        let run = computed.pressure_mpa;
        let other = |pressure: f64| (pressure / run - 1.0).abs() > 0.01;
        for (point, line) in file.points.iter().zip(&file.lines) {
            if let Some(pressure) = point.pressure_mpa.filter(|pressure| other(*pressure)) {
                let path = self.measured.display();
                return Err(CliError::input(format!(
                    "{path}, line {line}: the pressure is {pressure} MPa, that of the run {run} MPa: fit measurements of one pressure, \
                     with a run at it (bem.pressures_mpa)"
                )));
            }
        }
        Ok(())
    }

    fn temperatures(
        &self,
        file: &MeasuredFile,
        recipe: Option<&Recipe>,
    ) -> Result<Temperatures, CliError> {
        let stated = file.points.iter().any(|point| point.temperature_c.is_some());
        if let Some(celsius) = self.temperature_c.filter(|_| stated) {
            return Err(CliError::input(format!(
                "--temperature-c {celsius} beside the column temperature_c of {}: leave one of them out",
                self.measured.display()
            )));
        }
        let bem = recipe.and_then(|recipe| recipe.bem.as_ref());
        let run_c = bem.and_then(|bem| bem.temperature_c);
        // Read only if temperatures differ from that of `bem`, which then is there.
        let rubber = bem.map(|bem| bem.rubber.clone()).unwrap_or_default();
        Ok(Temperatures::new(file, self.temperature_c, run_c, &rubber)?)
    }

    /// T_0 of the law, if it shifts with temperature.
    fn reference(&self, temperatures: &Temperatures) -> Result<Option<f64>, CliError> {
        let shifts = !temperatures.is_one() || self.activation_ev.is_some();
        match (self.reference_c, temperatures.computed_c) {
            (Some(_), _) if !shifts => Err(CliError::input(
                "--reference-c has no effect on measurements at one temperature: leave it out, or give --activation-ev",
            )),
            (Some(reference_c), _) => Ok(Some(reference_c)),
            (None, Some(run_c)) if shifts => Ok(Some(run_c)),
            (None, None) if shifts => Err(CliError::input(
                "--activation-ev needs --reference-c: neither run nor file states a temperature",
            )),
            _ => Ok(None),
        }
    }
}

/// What a reader of the law should know.
fn warnings(fit: &FittedShear, measured: &[MeasuredFriction]) -> Vec<String> {
    let mut warnings = Vec::new();
    let below = measured.iter().filter(|m| m.friction < m.hysteretic).count();
    if below > 0 {
        warnings.push(format!(
            "{below} of {} measurements have less friction than the computed hysteresis: no shear stress explains them",
            measured.len()
        ));
    }
    let wide = |[low, high]: [f64; 2]| high > 10.0 * low;
    let open = [
        ("speed", fit.peak_speed.ends),
        ("shear stress", fit.peak_stress.ends),
        ("width", fit.width.ends),
    ];
    for (name, _) in open.into_iter().filter(|(_, ends)| ends.is_some_and(wide)) {
        warnings.push(format!(
            "the {name} of the law is known within more than a factor of ten only: it does not hold outside the measured speeds"
        ));
    }
    warnings
}
