//! Manifests, folders of stages, folders of runs.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::provenance::{State, inputs_text, read_manifest, stage_text};
use super::{Finding, foreign};
use crate::cli::CliError;
use crate::cli::output::{aligned, significant};
use asperity::artifact::{Manifest, Output};

/// A manifest on its own.
#[derive(Debug, Serialize)]
pub(super) struct ManifestFile {
    #[serde(with = "asperity::files::name::path")]
    path: PathBuf,
    manifest: Manifest,
}

/// The result of a stage.
#[derive(Debug, Serialize)]
pub(super) struct Stage {
    #[serde(with = "asperity::files::name::path")]
    path: PathBuf,
    manifest: Manifest,
    /// In the order of the outputs of the manifest.
    states: Vec<State>,
}

/// The results of a run, by the name of the stage.
#[derive(Debug, Serialize)]
pub(super) struct Run {
    #[serde(with = "asperity::files::name::path")]
    path: PathBuf,
    stages: Vec<Stage>,
}

/// Reads the folder of a stage or of a run.
///
/// # Errors
/// [`CliError::Input`] if it is neither.
pub(super) fn read(path: &Path) -> Result<Finding, CliError> {
    if path.join(Manifest::FILE).exists() {
        return Ok(Finding::Stage(Stage::read(path)?));
    }
    let unreadable = |error| CliError::input(format!("cannot read {}: {error}", path.display()));
    let entries = std::fs::read_dir(path).map_err(unreadable)?;
    let entries: Vec<_> = entries.collect::<Result<_, _>>().map_err(unreadable)?;
    let mut folders: Vec<PathBuf> = entries
        .into_iter()
        // Names of what a killed run left behind start with a point.
        .filter(|entry| !entry.file_name().to_string_lossy().starts_with('.'))
        .map(|entry| entry.path())
        .filter(|path| path.join(Manifest::FILE).exists())
        .collect();
    folders.sort();
    if folders.is_empty() {
        return Err(foreign(
            path,
            "holds neither a manifest.json nor finished stages: give a file, the folder of a stage or of a run",
        ));
    }
    let stages = folders.iter().map(|folder| Stage::read(folder)).collect::<Result<_, _>>()?;
    Ok(Finding::Run(Run { path: path.to_path_buf(), stages }))
}

impl ManifestFile {
    pub(super) fn read(path: &Path) -> Result<Self, CliError> {
        Ok(Self { path: path.to_path_buf(), manifest: read_manifest(path)? })
    }

    pub(super) fn text(&self) -> String {
        let files = self.manifest.outputs.iter().map(|output| output_line(output, None));
        describe("manifest", &self.path, &self.manifest, files)
    }
}

impl Stage {
    fn read(path: &Path) -> Result<Self, CliError> {
        let manifest = read_manifest(&path.join(Manifest::FILE))?;
        let states = manifest.outputs.iter().map(|output| State::of(path, output)).collect();
        Ok(Self { path: path.to_path_buf(), manifest, states })
    }

    fn files(&self) -> impl Iterator<Item = String> {
        let outputs = self.manifest.outputs.iter().zip(&self.states);
        outputs.map(|(output, state)| output_line(output, Some(*state)))
    }

    pub(super) fn text(&self) -> String {
        describe("stage", &self.path, &self.manifest, self.files())
    }
}

impl Run {
    pub(super) fn text(&self) -> String {
        let mut text = format!("run  {}\n", self.path.display());
        for stage in &self.stages {
            let manifest = &stage.manifest;
            let heading = stage_text(&manifest.stage, manifest.stage_revision, &manifest.key);
            text += &format!("\n{heading}, {} s\n", significant(manifest.seconds));
            stage.files().for_each(|line| text += &format!("  {line}\n"));
            manifest.warnings.iter().for_each(|warning| text += &format!("  warning: {warning}\n"));
        }
        text
    }
}

fn describe(
    kind: &str,
    path: &Path,
    manifest: &Manifest,
    files: impl Iterator<Item = String>,
) -> String {
    let mut lines = vec![
        (kind, path.display().to_string()),
        ("schema", format!("{} version {}", manifest.schema, manifest.version)),
        ("made by", stage_text(&manifest.stage, manifest.stage_revision, &manifest.key)),
        ("tool", format!("asperity {}", manifest.tool_version)),
        ("time", significant(manifest.seconds) + " s"),
        ("inputs", inputs_text(&manifest.inputs)),
    ];
    lines.extend(files.map(|line| ("file", line)));
    lines.extend(manifest.warnings.iter().map(|warning| ("warning", warning.clone())));
    format!("{}\nparameters\n{:#}\n", aligned(&lines), manifest.parameters)
}

fn output_line(output: &Output, state: Option<State>) -> String {
    let Output { file, schema, schema_version, size, content_digest, .. } = output;
    let state = state.map(|state| format!(", {}", state.text())).unwrap_or_default();
    format!(
        "{file}: {schema} version {schema_version}, {size} bytes, content {content_digest:#}{state}"
    )
}
