//! `asperity plot`: single figures of a run.

use super::last_run::LastRun;
use super::output::{aligned, note, print};
use super::run_folder;
use super::values::meant;
use super::{CliError, figure_file};
use asperity::report::figures::{ALL, Kind};
use asperity::sweep;
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  The figures that there are:
    asperity plot --list
  Friction over contact area of a run, for the screen and for a paper:
    asperity plot friction runs/asphalt --to friction.png
    asperity plot friction runs/asphalt --to friction.svg
  Friction over speed, of a sweep with a line for each temperature:
    asperity plot speed runs/sweep --to speed.svg";

/// Draw a figure of a run as SVG or PNG.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Plot {
    /// Name of the figure, one of --list.
    #[arg(required_unless_present = "list")]
    figure: Option<String>,
    /// Run folder.
    #[arg(required_unless_present = "list")]
    run: Option<PathBuf>,
    /// File to write, .svg or .png; SVG on standard output if not given.
    #[arg(long, value_name = "FILE")]
    to: Option<PathBuf>,
    /// List the figures.
    #[arg(long, conflicts_with_all = ["figure", "run", "to"])]
    list: bool,
    /// Overwrite a file that is there already.
    #[arg(long)]
    force: bool,
}

impl Plot {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`].
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        let (Some(name), Some(run)) = (&self.figure, &self.run) else {
            let lines: Vec<_> = ALL.iter().map(|kind| (kind.name, kind.shows.to_owned())).collect();
            return print(&aligned(&lines));
        };
        let Some(kind) = Kind::named(name) else {
            let names: Vec<&str> = ALL.iter().map(|kind| kind.name).collect();
            return Err(CliError::input(format!(
                "there is no figure `{name}`; {}",
                meant(name, &names)
            )));
        };
        if let Some(path) = &self.to {
            figure_file::is_png(path)?;
        }
        let of_sweep = kind.name == "speed" && run.join(sweep::CASES_FOLDER).is_dir();
        let view = if of_sweep { run_folder::view(run)? } else { run_folder::view_of_case(run)? };
        let figure = if of_sweep {
            sweep::sweep_speed_figure(&view.rows(sweep::FRICTION)?)
        } else {
            kind.figure(&view)?
        };
        let figure = figure.ok_or_else(|| {
            let run = run.display();
            CliError::input(format!("{run} has no figure `{name}`: it needs {}", kind.requires))
        })?;
        let doubts = LastRun::read(run, quiet).map(|last| last.doubts(&view)).unwrap_or_default();
        for (_, doubt) in doubts.iter().filter(|(stage, _)| kind.stages.contains(stage)) {
            note(quiet, format_args!("warning: {doubt}"));
        }
        match &self.to {
            None => print(&figure.svg()?),
            Some(path) => figure_file::write(path, self.force, &figure),
        }
    }
}
