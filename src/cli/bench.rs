//! `asperity bench`: error against seconds, and the cost of growth.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::output::{json, note, print, refuse_existing, write_file};
use super::{CliError, threads};
use asperity::bench::figure::figure;
use asperity::bench::growth::{self, Job};
use asperity::bench::measure::Effort;
use asperity::bench::{report, select};

/// Hidden option by which the executable is started again for one job of the growth.
const GROWTH_JOB: &str = "--growth-job";

const EXAMPLES: &str = "\
Examples:
  Every solver over its accuracy knob, on an idle machine; the tables and the plot of docs/:
    asperity bench --to docs/work_precision.md
  Two cases, as JSON:
    asperity bench --case half-space-1-wave --case hybrid --format json
  How time and memory grow with points, waves, realisations and threads:
    asperity bench --growth --to docs/growth.md";

/// Measure what precision costs: error against seconds of every solver on fixed cases.
///
/// Errors are relative to an answer on a finer grid than any in the list, or to an exact one.
/// Seconds are medians of repeats after a warm-up. All cases take two to three minutes on two cores.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Bench {
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
    /// begin -->` and `<!-- bench: end -->` what stands between them is replaced. Beside Markdown
    /// of the cases the plot is written, with the extension svg.
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
    /// All figures with full precision.
    Json,
    /// The plot.
    Svg,
}

impl Bench {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`].
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        threads::start(None)?;
        if let Some(job) = self.growth_job {
            return print(&json(&job.run().map_err(CliError::Failure)?)?);
        }
        if self.growth && self.format == Format::Svg {
            return Err(CliError::input("--growth has no plot: choose markdown or json"));
        }
        self.refuse_early()?;
        if self.growth { self.growth(quiet) } else { self.precision(quiet) }
    }

    fn effort(&self) -> Effort {
        if self.quick { Effort::Quick } else { Effort::Full }
    }

    /// Whether the results have a place is known before they are computed.
    fn refuse_early(&self) -> Result<(), CliError> {
        let Some(path) = &self.to else { return Ok(()) };
        let document = match renewed(path, "")? {
            Some(_) => Some(fs::read_to_string(path).map_err(CliError::failure)?),
            None => None,
        };
        refuse_existing(Some(path), self.force || document.is_some())?;
        if self.growth || self.format != Format::Markdown {
            return Ok(());
        }
        // A plot that the document shows is a part of it.
        let plot = path.with_extension("svg");
        let name = plot.file_name().unwrap_or_default().to_string_lossy();
        let shown = document.is_some_and(|document| document.contains(&*name));
        refuse_existing(Some(&plot), self.force || shown)
    }

    fn precision(&self, quiet: bool) -> Result<(), CliError> {
        let mut results = Vec::new();
        for case in select(&self.case)? {
            let say = |method: &str| note(quiet, format_args!("{}: {method}", case.name));
            results.push(case.run(self.effort(), &say)?);
        }
        let plot = || figure(&results).svg().map_err(CliError::failure);
        match self.format {
            Format::Svg => self.write(&plot()?),
            Format::Json => self.write(&json(&results)?),
            Format::Markdown => {
                self.write(&report::markdown(&results))?;
                match &self.to {
                    Some(path) => write_text(&path.with_extension("svg"), &plot()?),
                    None => Ok(()),
                }
            }
        }
    }

    fn growth(&self, quiet: bool) -> Result<(), CliError> {
        let executable = std::env::current_exe().map_err(CliError::failure)?;
        let say = |job: &str| note(quiet, job);
        let series = growth::run(&executable, &["bench", GROWTH_JOB], self.effort(), &say)?;
        self.write(&match self.format {
            Format::Json => json(&series)?,
            Format::Markdown | Format::Svg => growth::markdown(&series),
        })
    }

    fn write(&self, text: &str) -> Result<(), CliError> {
        match &self.to {
            None => print(text),
            Some(path) if self.format == Format::Markdown => {
                write_text(path, &renewed(path, text)?.unwrap_or_else(|| text.to_owned()))
            }
            Some(path) => write_text(path, text),
        }
    }
}

/// The document at a path with these results, if it has a place for them.
fn renewed(path: &Path, results: &str) -> Result<Option<String>, CliError> {
    match fs::read_to_string(path) {
        Ok(document) => Ok(report::renewed(&document, results)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        // To write over it would lose what it says.
        Err(error) => Err(CliError::input(format!("cannot read {}: {error}", path.display()))),
    }
}

fn write_text(path: &Path, text: &str) -> Result<(), CliError> {
    write_file(path, true, |out| out.write_all(text.as_bytes()))
}
