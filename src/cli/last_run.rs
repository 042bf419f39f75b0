//! The recipe that a run folder was last brought up to date with, so that `export` can tell whether
//! its results still are those of the recipe.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::CliError;
use super::output::{json, note, write_file};
use super::recipe_options::{with_scans, with_tolerance};
use crate::artifact::{Digest, RunView, TOOL_VERSION};
use crate::pipeline::{self, State};
use crate::recipe::Recipe;
use crate::report::html::Origin;
use crate::stages::Stage;
use crate::sweep::slurm::shell_word;

/// What `asperity run` was given, as absolute paths.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct LastRun {
    recipe: PathBuf,
    /// Those of the command line.
    scans: Vec<PathBuf>,
    /// That of the command line.
    #[serde(default)]
    tolerance: Option<f64>,
    /// Text of the recipe, which may be edited later.
    #[serde(default)]
    text: Option<String>,
    #[serde(default)]
    tool_version: Option<String>,
    /// Number of threads.
    #[serde(default)]
    threads: Option<usize>,
    /// Of all other fields, to find damage.
    digest: Digest,
}

impl LastRun {
    /// Beside the folders of the stages; no result.
    pub(super) const FILE: &str = "last_run.json";

    /// # Errors
    /// [`CliError::Failure`] if the working folder is not known.
    pub(super) fn new(
        recipe: &Path,
        text: String,
        scans: &[PathBuf],
        tolerance: Option<f64>,
    ) -> Result<Self, CliError> {
        let absolute = |path: &Path| std::path::absolute(path).map_err(CliError::failure);
        let scans = scans.iter().map(|path| absolute(path)).collect::<Result<_, _>>()?;
        Ok(Self {
            recipe: absolute(recipe)?,
            scans,
            tolerance,
            text: Some(text),
            tool_version: Some(TOOL_VERSION.to_owned()),
            threads: None,
            digest: Digest::of_bytes(&[]),
        })
    }

    /// # Errors
    /// [`CliError::Failure`] if it cannot be written.
    pub(super) fn write(mut self, out: &Path) -> Result<(), CliError> {
        // Known once the pool of threads is.
        self.threads = Some(rayon::current_num_threads());
        self.digest = Digest::seal_of(&self).map_err(CliError::failure)?;
        let text = json(&self)?;
        write_file(&out.join(Self::FILE), true, |out: &mut dyn Write| {
            out.write_all(text.as_bytes())
        })
    }

    /// None where no run left one that is whole; then a warning says what is wrong with it.
    pub(super) fn read(out: &Path, quiet: bool) -> Option<Self> {
        let path = out.join(Self::FILE);
        let read = match std::fs::read(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return None,
            read => read.map_err(|error| error.to_string()).and_then(|bytes| Self::whole(&bytes)),
        };
        match read {
            Ok(last_run) => Some(last_run),
            Err(reason) => {
                let path = path.display();
                note(
                    quiet,
                    format_args!(
                        "warning: {path}: {reason}; whether the results still are those of their recipe \
                         cannot be told (asperity run writes it anew)"
                    ),
                );
                None
            }
        }
    }

    /// Whether the one in the folder is whole, or what is wrong with it; none if there is none.
    pub(super) fn state(out: &Path) -> Option<Result<(), String>> {
        let path = out.join(Self::FILE);
        if !path.exists() {
            return None;
        }
        let whole = std::fs::read(&path)
            .map_err(|error| error.to_string())
            .and_then(|bytes| Self::whole(&bytes));
        Some(whole.map(drop).map_err(|reason| format!("{}: {reason}", path.display())))
    }

    fn whole(bytes: &[u8]) -> Result<Self, String> {
        let read: Self = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
        let digest = Digest::seal_of(&read).map_err(|error| error.to_string())?;
        if digest == read.digest { Ok(read) } else { Err("damaged".into()) }
    }

    /// Where the results of a run come from, for its report.
    pub(super) fn origin(self, view: &RunView) -> Origin {
        Origin {
            doubts: self.doubts(view),
            command: Some(self.command(view.path())),
            recipe: self.text,
            tool_version: self.tool_version,
            threads: self.threads,
        }
    }

    /// Why results are not what the recipe asks for, by stage; nothing of stages that have none.
    pub(super) fn doubts(&self, view: &RunView) -> BTreeMap<Stage, String> {
        let stages = Stage::CHAIN.into_iter().chain([Stage::Sinusoid]);
        let there = stages.filter(|stage| view.path().join(stage.name()).exists());
        there.filter_map(|stage| Some((stage, self.doubt(view.path(), stage.name())?))).collect()
    }

    /// The command that brings the folder up to date, for a shell.
    fn command(&self, out: &Path) -> String {
        let mut words = vec!["asperity".to_owned(), "run".into(), quoted(&self.recipe)];
        if !self.scans.is_empty() {
            words.push("--scans".into());
            words.extend(self.scans.iter().map(|path| quoted(path)));
        }
        if let Some(tolerance) = self.tolerance {
            words.extend(["--tolerance".into(), tolerance.to_string()]);
        }
        words.extend(["--out".into(), quoted(out)]);
        words.join(" ")
    }

    /// Why the result of a stage in the folder `out` is not what the recipe asks for; none if it is.
    pub(super) fn doubt(&self, out: &Path, stage: &str) -> Option<String> {
        let recipe = self.recipe.display();
        let states = Recipe::read(&self.recipe)
            .map_err(CliError::from)
            .and_then(|read| with_scans(read, &self.recipe, &self.scans))
            .and_then(|read| with_tolerance(read, self.tolerance))
            .and_then(|read| Ok(pipeline::status(&read, out)?));
        let states = match states {
            Ok(states) => states,
            Err(error) => {
                return Some(format!(
                    "whether {stage} is up to date cannot be told from the recipe of its last run: \
                     {error}"
                ));
            }
        };
        let Some((_, state)) = states.iter().find(|(known, _)| known.name() == stage) else {
            return Some(format!(
                "{stage} is left over from an earlier run: {recipe} has no such stage any more"
            ));
        };
        let State::Stale(reasons) = state else { return None };
        Some(format!(
            "{stage} is not what {recipe} asks for ({}): `asperity run` brings it up to date",
            first_cause(&states, reasons)
        ))
    }
}

/// A path as one word of a shell.
fn quoted(path: &Path) -> String {
    shell_word(&path.display().to_string())
}

/// The reasons, or those of the stage before that they refer to.
fn first_cause(states: &[(Stage, State)], reasons: &[String]) -> String {
    let inherited = states.iter().find_map(|(stage, state)| match state {
        State::Stale(why) if reasons == [format!("{stage} is stale")] => {
            Some(format!("{stage}: {}", why.join("; ")))
        }
        _ => None,
    });
    inherited.unwrap_or_else(|| reasons.join("; "))
}
