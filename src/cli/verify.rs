//! `asperity verify`: whether a run folder still is what was written.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::CliError;
use super::last_run::LastRun;
use super::output::{json, print};
use crate::artifact::{Manifest, RunView, SOLVES_FOLDER, read_stored_solve};
use crate::stages::Stage;

const EXAMPLES: &str = "\
Examples:
  Whether a folder that was copied, or lay on a disk for a year, is whole:
    asperity verify runs/asphalt";

/// Compare every file of a run folder with the digest it was written with.
///
/// Results are compared with the manifest of their stage, stored solves with the digest they carry. Exit
/// code 1 if anything is damaged or missing; a run computes a damaged stage anew, and leaves damaged solves out.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Verify {
    /// Run folder.
    run: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// What was found of one stage, or of the stored solves.
#[derive(Debug, Serialize)]
struct Finding {
    name: String,
    files: usize,
    /// One line for each file that is not what was written.
    damaged: Vec<String>,
}

impl Verify {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError::Input`] for a folder without results, [`CliError::Failure`] for damaged ones.
    pub(super) fn run(self) -> Result<(), CliError> {
        let mut findings = stages(&self.run)?;
        findings.extend(LastRun::state(&self.run).map(|damaged| Finding {
            name: LastRun::FILE.into(),
            files: 1,
            damaged: damaged.err().into_iter().collect(),
        }));
        findings.extend(solves(&self.run.join(SOLVES_FOLDER))?);
        if findings.is_empty() {
            return Err(CliError::input(format!(
                "{} holds no result: give the folder of a run, such as runs/asphalt",
                self.run.display()
            )));
        }
        print(&if self.json { json(&findings)? } else { text(&findings) })?;
        let damaged: usize = findings.iter().map(|finding| finding.damaged.len()).sum();
        if damaged > 0 {
            return Err(CliError::failure(format!(
                "{damaged} files of {} are not what was written; `asperity run` makes them anew",
                self.run.display()
            )));
        }
        Ok(())
    }
}

fn text(findings: &[Finding]) -> String {
    let line = |finding: &Finding| {
        let Finding { name, files, damaged } = finding;
        let state = if damaged.is_empty() { "intact" } else { "damaged:" };
        let damaged: String = damaged.iter().map(|reason| format!("\n  {reason}")).collect();
        format!("{name:<13} {files:>6} files {state}{damaged}\n")
    };
    findings.iter().map(line).collect()
}

/// The stages that have a folder, by name.
fn stages(run: &Path) -> Result<Vec<Finding>, CliError> {
    let mut findings = Vec::new();
    for folder in folders(run)? {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if !Stage::CHAIN.iter().chain([&Stage::Sinusoid]).any(|stage| stage.name() == name) {
            continue;
        }
        let view = RunView::of(run);
        let finding = match view.stage_manifest(&name) {
            Ok(Some(manifest)) => {
                let damaged = manifest.outputs.iter();
                let damaged = damaged.filter_map(|output| view.verify_output(&name, output).err());
                let damaged = damaged.map(|error| error.to_string()).collect();
                Finding { name, files: manifest.outputs.len() + 1, damaged }
            }
            Ok(None) => {
                let missing = format!("{}: missing", folder.join(Manifest::FILE).display());
                Finding { name, files: 0, damaged: vec![missing] }
            }
            Err(error) => Finding { name, files: 1, damaged: vec![error.to_string()] },
        };
        findings.push(finding);
    }
    Ok(findings)
}

/// The stored solves, if there are any.
fn solves(store: &Path) -> Result<Option<Finding>, CliError> {
    if !store.is_dir() {
        return Ok(None);
    }
    let mut finding = Finding { name: SOLVES_FOLDER.into(), files: 0, damaged: Vec::new() };
    for folder in folders(store)? {
        for path in entries(&folder)? {
            if path.extension().is_none_or(|extension| extension != "json") {
                continue;
            }
            finding.files += 1;
            match read_stored_solve(&path) {
                Ok(solve) if !solve.intact => {
                    finding.damaged.push(format!("{}: damaged", path.display()));
                }
                Ok(solve)
                    if path.file_stem().is_none_or(|stem| *stem != *solve.key.to_string()) =>
                {
                    finding.damaged.push(format!("{}: holds another solve", path.display()));
                }
                Ok(_) => {}
                Err(error) => finding.damaged.push(error.to_string()),
            }
        }
    }
    Ok(Some(finding))
}

fn folders(path: &Path) -> Result<Vec<PathBuf>, CliError> {
    Ok(entries(path)?.into_iter().filter(|entry| entry.is_dir()).collect())
}

fn entries(path: &Path) -> Result<Vec<PathBuf>, CliError> {
    let failed = |error| CliError::input(format!("cannot read {}: {error}", path.display()));
    let entries = fs::read_dir(path).map_err(failed)?;
    let mut entries: Vec<PathBuf> =
        entries.map(|entry| Ok(entry.map_err(failed)?.path())).collect::<Result<_, CliError>>()?;
    entries.sort();
    Ok(entries)
}
