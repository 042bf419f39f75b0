//! `asperity plan`: what a recipe will compute, before it runs.

use std::fmt::Write;

use clap::Args;

use super::interrupt::Interrupt;
use super::output::{json, print, significant};
use super::progress::Spinner;
use super::recipe_options::RecipeOptions;
use super::{CliError, threads, values};
use asperity::forecast::{Forecast, ScaleModel, forecast};

const EXAMPLES: &str = "\
Examples:
  Models, grids, time and memory of the bundled recipe:
    asperity plan pipelines/asphalt.toml
  What two per cent of accuracy would cost:
    asperity plan pipelines/asphalt.toml --tolerance 0.02";

/// Show which model each wave gets, on which grids, and what that costs.
///
/// Runs the cheap stages and the half-space of one realisation, or of eight if the recipe asks for an
/// accuracy, in a temporary folder; nothing is written to the run folder.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct PlanCommand {
    #[command(flatten)]
    recipe: RecipeOptions,
    /// Number of threads of the run; all cores if not given.
    #[arg(long, value_name = "N", value_parser = values::count::<usize>, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl PlanCommand {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`].
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        let recipe = self.recipe.recipe()?;
        let here = threads::start(None)?;
        let threads = threads::checked(self.threads)?.unwrap_or(here);
        let interrupt = Interrupt::install()?;
        let spinner = Spinner::new(quiet, "trying the half-space");
        let forecast = forecast(&recipe, threads, interrupt.flag())?;
        spinner.finish();
        print(&if self.json { json(&forecast)? } else { text(&forecast) })
    }
}

fn text(forecast: &Forecast) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    for curve in &forecast.curves {
        let [low, high] = curve.pressures_mpa.map(significant);
        let [coarse, fine] = curve.grid_points;
        let grids = if coarse == fine { fine.to_string() } else { format!("{coarse} to {fine}") };
        let _ = writeln!(
            text,
            "{}, {} mm/s: {} realisations, {low} to {high} MPa, {} pressures each on {grids} points",
            curve.kind, curve.speed_mm_s, curve.realisations, curve.solves
        );
        let _ = writeln!(
            text,
            "  wavelength  amplitude  rms slope  full contact  pressed flat  model            why"
        );
        for scale in &curve.scales {
            let model = match scale.model {
                ScaleModel::LeftOut => "none",
                ScaleModel::HalfSpace => "half-space",
                ScaleModel::FiniteElements => "finite elements",
            };
            let _ = writeln!(
                text,
                "  {:>7.4} mm {:>7.4} mm {:>10.4} {:>9.3} MPa {:>11.0} %  {model:<15}  {}",
                scale.wavelength_mm,
                scale.amplitude_mm,
                scale.rms_slope,
                scale.full_contact_mpa,
                100.0 * scale.pressed_flat,
                scale.reason
            );
        }
    }
    finite_deformation(&mut text, forecast);
    for pairs in &forecast.multilevel {
        let count = match (pairs.pairs, pairs.most_pairs) {
            (0, _) => "no finite elements, the surface is gentle enough for the half-space".into(),
            (least, most) if least == most => format!("{least} pairs"),
            (least, most) => {
                format!("{least} pairs, up to {most} if their differences vary too much")
            }
        };
        let (kind, speed) = (pairs.kind, pairs.speed_mm_s);
        let _ = write!(text, "multilevel of {kind}, {speed} mm/s: {count}");
        let _ = if pairs.pairs > 0 {
            let (columns, seconds) = (pairs.columns, pairs.seconds_each);
            writeln!(text, ", {columns} columns, about {seconds:.0} s each")
        } else {
            writeln!(text)
        };
    }
    let seconds = |seconds: Option<f64>| {
        seconds.map_or_else(|| "not known".into(), |seconds| format!("{seconds:.2} s"))
    };
    for stage in &forecast.stages {
        let _ = writeln!(text, "{:<13} {:>12}", stage.stage.name(), seconds(stage.seconds));
    }
    let known: f64 = forecast.stages.iter().filter_map(|stage| stage.seconds).sum();
    let _ =
        writeln!(text, "together      {:>12}, {:.0} MB", seconds(Some(known)), forecast.megabytes);
    text
}

/// The microscales and the curves with all waves at finite deformation.
fn finite_deformation(text: &mut String, forecast: &Forecast) {
    for micro in &forecast.micro {
        let _ = writeln!(
            text,
            "microscale of {}, {} mm/s: {} columns, pressed to {} MPa, about {:.0} s",
            micro.kind,
            micro.speed_mm_s,
            micro.columns,
            significant(micro.most_pressure_mpa),
            micro.seconds
        );
    }
    for curve in &forecast.fem {
        let _ = writeln!(
            text,
            "{} at finite deformation, {} mm/s: {} realisations, {} columns, about {} pressures and {:.0} s each",
            curve.kind,
            curve.speed_mm_s,
            curve.realisations,
            curve.columns,
            curve.solves,
            curve.seconds_each
        );
    }
}
