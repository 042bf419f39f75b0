//! `asperity cutoff`: friction over the shortest wavelength.

use super::interrupt::Interrupt;
use super::output::{json, note, print, significant};
use super::progress::Spinner;
use super::recipe_options::RecipeOptions;
use super::{CliError, figure_file, threads, values};
use asperity::cutoff::{Cutoff, study};
use asperity::pipeline::Event;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  What the last four octaves of a road add to its friction:
    asperity cutoff pipelines/captif.toml
  The same as a figure, with more octaves:
    asperity cutoff pipelines/captif.toml --octaves 6 --to cutoff.svg";

/// Show friction over the shortest wavelength, one per octave.
///
/// Runs the recipe on the half-space down to its own shortest wavelength, and with its shortest octaves left out one by one:
/// where friction still grows from octave to octave, it is a number for that shortest wavelength and no other.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct CutoffCommand {
    #[command(flatten)]
    recipe: RecipeOptions,
    /// Octaves that are left out at most.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = values::count::<u32>, allow_negative_numbers = true)]
    octaves: u32,
    /// Number of threads; all cores if not given.
    #[arg(long, value_name = "N", value_parser = values::count::<usize>, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Print JSON with full precision.
    #[arg(long)]
    json: bool,
    /// File for a figure, .svg or .png.
    #[arg(long, value_name = "FILE")]
    to: Option<PathBuf>,
    /// Overwrite a figure that is there already.
    #[arg(long)]
    force: bool,
}

impl CutoffCommand {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`].
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        let recipe = self.recipe.recipe()?;
        threads::start(self.threads)?;
        let interrupt = Interrupt::install()?;
        let mut out = self.recipe.out().into_os_string();
        out.push("_cutoff");
        let out = PathBuf::from(out);
        let spinner = Spinner::new(quiet, "all octaves");
        let observer = |octave: u32, event: Event| {
            if let Event::Started(stage) = event {
                spinner.say(&format!("{octave} octaves less: {stage}"));
            }
        };
        let found = study(&recipe, self.octaves, &out, interrupt.flag(), &observer)?;
        spinner.finish();
        if let Some(path) = &self.to {
            let figure = found
                .figure()
                .ok_or_else(|| CliError::failure("there is nothing to draw".to_owned()))?;
            figure_file::write(path, self.force, &figure)?;
        }
        print(&if self.json { json(&found)? } else { text(&found) })?;
        note(quiet, format_args!("runs in {}", out.display()));
        Ok(())
    }
}

fn text(found: &Cutoff) -> String {
    let mut text = format!(
        "half-space, {}\n\n{:<28} {:>10} {:>9} {:>9} {:>13} {:>9} {:>8} {:>10}\n",
        found.material,
        "surfaces",
        "mm/s",
        "Ac/A0",
        "MPa",
        "shortest / mm",
        "friction",
        "± 95 %",
        "octave adds"
    );
    for row in &found.rows {
        let half = row.confidence_95.map_or_else(|| "–".into(), |half| format!("{half:.4}"));
        let growth = row.growth.map_or_else(|| "–".into(), |g| format!("{:+.0} %", 100.0 * g));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<28} {:>10} {:>9.4} {:>9} {:>13.4} {:>9.4} {:>8} {:>10}",
            row.kind.to_string(),
            row.speed_mm_s,
            row.contact_area_fraction,
            significant(row.pressure_mpa),
            row.shortest_wavelength_mm,
            row.mean,
            half,
            growth
        );
    }
    text
}
