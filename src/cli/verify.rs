//! `asperity verify`: whether a run folder still is what was written.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::CliError;
use super::last_run::LastRun;
use super::output::{json, print};
use crate::artifact::{
    Manifest, PACK_EXTENSION, RunView, SOLVES_FOLDER, read_pack_info, read_stored_solve,
};
use crate::stages::Stage;
use crate::sweep::{self, CASES_FOLDER, SURFACES_FOLDER};

const EXAMPLES: &str = "\
Examples:
  Whether a folder that was copied, or lay on a disk for a year, is whole:
    asperity verify runs/asphalt
  The same of a sweep, with all its cases:
    asperity verify runs/sweep";

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
        for part in [SURFACES_FOLDER, CASES_FOLDER] {
            findings.extend(run_folders(&self.run, &self.run.join(part))?);
        }
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
        // What is linked is verified where it is.
        if !is_stage(&name) || folder.is_symlink() {
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

fn is_stage(name: &str) -> bool {
    let stages = Stage::CHAIN.iter().chain([&Stage::Sinusoid]);
    name == sweep::STAGE || stages.into_iter().any(|stage| stage.name() == name)
}

/// The stages of all run folders below a folder of a sweep, named by their paths in it.
fn run_folders(sweep: &Path, folder: &Path) -> Result<Vec<Finding>, CliError> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let inside = |path: &Path| path.strip_prefix(sweep).unwrap_or(path).display().to_string();
    let mut findings = stages(folder)?;
    for finding in &mut findings {
        finding.name = inside(&folder.join(&finding.name));
    }
    for inner in folders(folder)? {
        let name = inner.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if !is_stage(&name) && !inner.is_symlink() {
            findings.extend(run_folders(sweep, &inner)?);
        }
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
            let kind = path.extension().unwrap_or_default();
            let (key, intact) = if kind == "json" {
                finding.files += 1;
                match read_stored_solve(&path) {
                    Ok(solve) => (solve.key, solve.intact),
                    Err(error) => {
                        finding.damaged.push(error.to_string());
                        continue;
                    }
                }
            } else if kind == PACK_EXTENSION {
                finding.files += 1;
                match read_pack_info(&path) {
                    Ok(pack) => (pack.problem, true),
                    Err(error) => {
                        finding.damaged.push(error.to_string());
                        continue;
                    }
                }
            } else {
                continue;
            };
            if !intact {
                finding.damaged.push(format!("{}: damaged", path.display()));
            } else if path.file_stem().is_none_or(|stem| *stem != *key.to_string()) {
                finding.damaged.push(format!("{}: holds another solve", path.display()));
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
    if path.is_file() {
        let path = path.display();
        return Err(CliError::input(format!(
            "{path} is a file: give the folder of a run, such as runs/asphalt"
        )));
    }
    let entries = fs::read_dir(path).map_err(failed)?;
    let mut entries: Vec<PathBuf> =
        entries.map(|entry| Ok(entry.map_err(failed)?.path())).collect::<Result<_, CliError>>()?;
    entries.sort();
    Ok(entries)
}
