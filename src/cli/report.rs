//! `asperity report`: everything about a run in one file.

use super::CliError;
use super::last_run::LastRun;
use super::output::{note, write_file};
use super::run_folder;
use asperity::report::html::{Origin, document};
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  All about a run in one file, to be read in any browser, also without a network:
    asperity report runs/asphalt
  The same in another place, over a file that is there already:
    asperity report runs/asphalt --to asphalt.html --force";

/// Write a report of a run: one HTML file with all figures, tables, errors and its provenance.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Report {
    /// Run folder.
    run: PathBuf,
    /// File to write; report.html in the run folder if not given.
    #[arg(long, value_name = "FILE")]
    to: Option<PathBuf>,
    /// Overwrite a file that is there already.
    #[arg(long)]
    force: bool,
}

impl Report {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`].
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        let view = run_folder::view_of_case(&self.run)?;
        let last_run = LastRun::read(&self.run, quiet);
        let origin = last_run.map_or_else(Origin::default, |last| last.origin(&view));
        for doubt in origin.doubts.values() {
            note(quiet, format_args!("warning: {doubt}"));
        }
        let text = document(&view, &origin)?;
        let path = self.to.unwrap_or_else(|| self.run.join("report.html"));
        write_file(&path, self.force, |out| out.write_all(text.as_bytes()))?;
        note(quiet, format_args!("report in {}", path.display()));
        Ok(())
    }
}
