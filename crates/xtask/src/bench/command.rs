//! `cargo xtask bench`: error against time, and how cost grows with size.

use super::figure::figure;
use super::growth::{self, Job};
use super::measure::Effort;
use super::{report, select};
use crate::error::TaskError;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Hidden option by which the executable is started again for one job of the growth.
const GROWTH_JOB: &str = "--growth-job";

const EXAMPLES: &str = "\
Examples:
  Every solver over its accuracy knob, on an idle machine; the tables and the plot of docs/:
    cargo xtask bench --to docs/work_precision.md
  Two cases, as JSON:
    cargo xtask bench --case half-space-1-wave --case hybrid --format json
  How time and memory grow with points, waves, realisations and threads:
    cargo xtask bench --growth --to docs/growth.md";

/// Measure accuracy against run time: the error of every solver over its time, on fixed cases.
///
/// Errors are relative to an answer on a finer grid than any in the list, or to an exact one.
/// Times are medians of repeats after a warm-up. All cases take two to three minutes on two cores.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Bench {
    /// A case to run, several if given several times; all if not given.
    #[arg(long, value_name = "NAME", conflicts_with = "growth")]
    case: Vec<String>,
    /// Measure time and memory over points, waves, realisations and threads instead.
    #[arg(long)]
    growth: bool,
    /// Form of the results.
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = Format::Markdown)]
    format: Format,
    /// Write to this file instead of standard output. In a document with the lines `<!-- bench:
    /// begin -->` and `<!-- bench: end -->` the text between them is replaced. For Markdown of the
    /// cases the plot is written too, to the same name with the extension svg.
    #[arg(long, value_name = "PATH")]
    to: Option<PathBuf>,
    /// Overwrite a file without these lines.
    #[arg(long)]
    force: bool,
    /// Two values of each knob, once: to see that everything runs, not for results.
    #[arg(long)]
    quick: bool,
    /// Run one job of the growth and print what it took.
    #[arg(long, hide = true, value_name = "JOB")]
    growth_job: Option<Job>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Tables.
    Markdown,
    /// All values with full precision.
    Json,
    /// The plot.
    Svg,
}

impl Bench {
    /// Runs the command.
    ///
    /// # Errors
    /// [`TaskError`].
    pub(crate) fn run(&self, quiet: bool) -> Result<(), TaskError> {
        if let Some(job) = self.growth_job {
            return print(&json(&job.run().map_err(TaskError::Failure)?)?);
        }
        if self.growth && self.format == Format::Svg {
            return Err(TaskError::input("--growth has no plot: choose markdown or json"));
        }
        self.refuse_early()?;
        if self.growth { self.growth(quiet) } else { self.precision(quiet) }
    }

    fn effort(&self) -> Effort {
        if self.quick { Effort::Quick } else { Effort::Full }
    }

    /// Fails before the computation if its results could not be written.
    fn refuse_early(&self) -> Result<(), TaskError> {
        let Some(path) = &self.to else { return Ok(()) };
        let document = match renewed(path, "")? {
            Some(_) => Some(fs::read_to_string(path).map_err(TaskError::failure)?),
            None => None,
        };
        refuse_existing(path, self.force || document.is_some())?;
        if self.growth || self.format != Format::Markdown {
            return Ok(());
        }
        // A plot that the document shows is a part of it.
        let plot = path.with_extension("svg");
        let name = plot.file_name().unwrap_or_default().to_string_lossy();
        let shown = document.is_some_and(|document| document.contains(&*name));
        refuse_existing(&plot, self.force || shown)
    }

    fn precision(&self, quiet: bool) -> Result<(), TaskError> {
        let mut results = Vec::new();
        for case in select(&self.case)? {
            let say = |method: &str| note(quiet, &format!("{}: {method}", case.name));
            results.push(case.run(self.effort(), &say)?);
        }
        let plot = || figure(&results).svg();
        match self.format {
            Format::Svg => self.write(&plot()?),
            Format::Json => self.write(&json(&results)?),
            Format::Markdown => {
                self.write(&report::markdown(&results))?;
                match &self.to {
                    Some(path) => write(&path.with_extension("svg"), &plot()?),
                    None => Ok(()),
                }
            }
        }
    }

    fn growth(&self, quiet: bool) -> Result<(), TaskError> {
        let executable = std::env::current_exe().map_err(TaskError::failure)?;
        let say = |job: &str| note(quiet, job);
        let series = growth::run(&executable, &["bench", GROWTH_JOB], self.effort(), &say)?;
        self.write(&match self.format {
            Format::Json => json(&series)?,
            Format::Markdown | Format::Svg => growth::markdown(&series),
        })
    }

    fn write(&self, text: &str) -> Result<(), TaskError> {
        match &self.to {
            None => print(text),
            Some(path) if self.format == Format::Markdown => {
                write(path, &renewed(path, text)?.unwrap_or_else(|| text.to_owned()))
            }
            Some(path) => write(path, text),
        }
    }
}

/// The document at a path with these results, or `None` if it has no place for them.
fn renewed(path: &Path, results: &str) -> Result<Option<String>, TaskError> {
    match fs::read_to_string(path) {
        Ok(document) => Ok(report::renewed(&document, results)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        // To write over it would lose what it says.
        Err(error) => Err(TaskError::input(format!("cannot read {}: {error}", path.display()))),
    }
}

fn refuse_existing(path: &Path, overwrite: bool) -> Result<(), TaskError> {
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    if let Some(folder) = folder.filter(|folder| !folder.exists()) {
        let (path, folder) = (path.display(), folder.display());
        return Err(TaskError::input(format!("cannot write {path}: there is no folder {folder}")));
    }
    if path.exists() && !overwrite {
        let path = path.display();
        return Err(TaskError::input(format!(
            "{path} exists already: choose another place, or give --force"
        )));
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<(), TaskError> {
    fs::write(path, text)
        .map_err(|error| TaskError::failure(format!("cannot write {}: {error}", path.display())))
}

fn print(text: &str) -> Result<(), TaskError> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(TaskError::failure)
}

fn note(quiet: bool, text: &str) {
    if !quiet {
        eprintln!("{text}");
    }
}

fn json(value: &impl Serialize) -> Result<String, TaskError> {
    Ok(serde_json::to_string_pretty(value).map_err(TaskError::failure)? + "\n")
}
