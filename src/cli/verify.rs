//! `asperity verify`: whether the files of a run folder are unchanged.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::CliError;
use super::last_run::LastRun;
use super::output::{json, print};
use asperity::artifact::{
    Input, Manifest, PACK_EXTENSION, RunView, SOLVES_FOLDER, read_pack_info, read_stored_solve,
};
use asperity::stages::Stage;
use asperity::sweep::{self, CASES_FOLDER, SURFACES_FOLDER};

const EXAMPLES: &str = "\
Examples:
  Check a folder that was copied, or kept on a disk for a year:
    asperity verify runs/asphalt
  Check a sweep with all its cases:
    asperity verify runs/sweep";

/// Compare every file of a run folder with the digest it was written with.
///
/// Results are compared with the manifest of their stage, inputs of a stage with the results of the stages before it,
/// stored solves with the digest in them. Exit code 1 if anything is damaged, missing, from another run or not written
/// by asperity; a run computes such a stage again and ignores damaged solves.
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
                "{damaged} faults in {}, listed above: `asperity run` computes these stages again, once files that \
                 asperity did not write are moved away",
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
        // A linked result is verified in its own folder.
        if !is_stage(&name) || folder.is_symlink() {
            continue;
        }
        findings.push(stage(&RunView::of(run), name)?);
    }
    Ok(findings)
}

/// What is wrong with the result of a stage.
fn stage(view: &RunView, name: String) -> Result<Finding, CliError> {
    let folder = view.path().join(&name);
    let manifest = match view.stage_manifest(&name) {
        Ok(Some(manifest)) => manifest,
        Ok(None) => {
            let missing = format!("{}: missing", folder.join(Manifest::FILE).display());
            return Ok(Finding { name, files: 0, damaged: vec![missing] });
        }
        Err(error) => return Ok(Finding { name, files: 1, damaged: vec![error.to_string()] }),
    };
    let outputs = manifest.outputs.iter();
    let damaged = outputs.filter_map(|output| view.verify_output(&name, output).err());
    let mut damaged: Vec<String> = damaged.map(|error| error.to_string()).collect();
    if manifest.stage != name {
        damaged.push(format!(
            "{}: it is the result of the stage {}: put it back, or run again",
            folder.display(),
            manifest.stage
        ));
    }
    let unlisted = view.unlisted(&name).map_err(CliError::failure)?;
    damaged.extend(unlisted.iter().map(|path| {
        format!(
            "{}: its manifest does not list it, so asperity did not write it: move it away",
            path.display()
        )
    }));
    damaged.extend(manifest.inputs.iter().filter_map(|input| wrong_input(view, &name, input)));
    Ok(Finding { name, files: manifest.outputs.len() + 1, damaged })
}

/// Why an input of a stage is not the present result of the stage before; `None` if it is, or if it came from outside
/// of the folder.
fn wrong_input(view: &RunView, stage: &str, input: &Input) -> Option<String> {
    if input.origin.is_some() {
        return None;
    }
    let (upstream, file) = input.name.rsplit_once('/')?;
    let (folder, upstream) = match upstream.rsplit_once('/') {
        // The tables of a sweep are made of those of its cases.
        Some((case, upstream)) if stage == sweep::STAGE => {
            (view.path().join(CASES_FOLDER).join(case), upstream)
        }
        Some(_) => return None,
        None => (view.path().to_owned(), upstream),
    };
    if !is_stage(upstream) {
        return None;
    }
    let before = RunView::of(folder);
    let path = before.file(upstream, file);
    let what = match before.stage_manifest(upstream) {
        // An unreadable manifest is reported for its own stage.
        Err(_) => return None,
        Ok(manifest) => match manifest.as_ref().and_then(|manifest| manifest.output(file)) {
            Some(output) if output.content_digest == input.digest => return None,
            Some(output) => format!("and holds {:#} now", output.content_digest),
            None => "and is not there now".into(),
        },
    };
    Some(format!(
        "{}: it was computed from another {}, which held {:#} {what}: run again, or move it away if the recipe has no such stage any more",
        view.path().join(stage).display(),
        path.display(),
        input.digest
    ))
}

fn is_stage(name: &str) -> bool {
    let stages = Stage::ALL.iter();
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
        // asperity makes no links here.
        if folder.is_symlink() {
            continue;
        }
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
