//! Where a file comes from: the manifest beside it.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::cli::CliError;
use asperity::artifact::{ArtifactError, Digest, Input, Manifest, Output};

/// Whether a file is the one that its manifest lists.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum State {
    /// Byte for byte as the stage wrote it.
    Intact,
    /// Changed or damaged since.
    Changed,
    /// Missing.
    Missing,
    /// Not readable.
    Unreadable,
}

impl State {
    pub(super) fn of(folder: &Path, output: &Output) -> Self {
        match Digest::of_file(&folder.join(&output.file)) {
            Ok(digest) if digest == output.bytes_digest => Self::Intact,
            Ok(_) => Self::Changed,
            Err(_) if folder.join(&output.file).exists() => Self::Unreadable,
            Err(_) => Self::Missing,
        }
    }

    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Intact => "intact",
            Self::Changed => "CHANGED since it was written",
            Self::Missing => "MISSING",
            Self::Unreadable => "UNREADABLE",
        }
    }
}

/// What the manifest beside a file says about it.
#[derive(Debug, Serialize)]
pub(super) struct Provenance {
    stage: String,
    stage_revision: u32,
    key: Digest,
    inputs: Vec<Input>,
    warnings: Vec<String>,
    state: State,
}

impl Provenance {
    /// `None` if there is no manifest beside the file or it does not list the file.
    ///
    /// # Errors
    /// [`CliError::Input`] for a manifest that cannot be read.
    pub(super) fn of(path: &Path) -> Result<Option<Self>, CliError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let beside = folder.join(Manifest::FILE);
        if !beside.exists() {
            return Ok(None);
        }
        let manifest = read_manifest(&beside)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let Some(output) = manifest.output(&name) else { return Ok(None) };
        Ok(Some(Self {
            state: State::of(folder, output),
            stage: manifest.stage,
            stage_revision: manifest.stage_revision,
            key: manifest.key,
            inputs: manifest.inputs,
            warnings: manifest.warnings,
        }))
    }

    pub(super) fn lines(&self) -> Vec<(&str, String)> {
        let mut lines = vec![
            ("made by", stage_text(&self.stage, self.stage_revision, &self.key)),
            ("inputs", inputs_text(&self.inputs)),
            ("bytes", self.state.text().to_owned()),
        ];
        lines.extend(self.warnings.iter().map(|warning| ("warning", warning.clone())));
        lines
    }
}

pub(super) fn stage_text(stage: &str, revision: u32, key: &Digest) -> String {
    format!("stage {stage}, revision {revision}, key {key:#}")
}

pub(super) fn inputs_text(inputs: &[Input]) -> String {
    let one = |input: &Input| match &input.origin {
        Some(origin) => format!("{} {:#} from {origin}", input.name, input.digest),
        None => format!("{} {:#}", input.name, input.digest),
    };
    match inputs {
        [] => "none".into(),
        // A campaign has hundreds of scans; the JSON form lists them all.
        [first, .., last] if inputs.len() > 6 => {
            format!("{} files, {} ... {}", inputs.len(), one(first), one(last))
        }
        _ => inputs.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

/// Reads a manifest, whatever the name of its file.
///
/// # Errors
/// [`CliError::Input`] that names the file.
pub(super) fn read_manifest(path: &Path) -> Result<Manifest, CliError> {
    #[derive(Deserialize)]
    struct Header {
        schema: String,
        version: u32,
    }
    let unreadable = |error: serde_json::Error| {
        // The file may belong to anyone, so the message does not suggest to delete it.
        CliError::input(format!(
            "{} is JSON, but cannot be read as a manifest or a stored solve ({error}): it is truncated, \
             damaged or not made by asperity",
            path.display()
        ))
    };
    let bytes = asperity::files::read(path, asperity::files::LARGEST_NUMBERS)
        .map_err(|error| CliError::input(format!("cannot read {}: {error}", path.display())))?;
    // Another kind or version may have other fields, so only the header is checked.
    let header: Header = serde_json::from_slice(&bytes).map_err(unreadable)?;
    let path = path.to_path_buf();
    if header.schema != Manifest::SCHEMA {
        let expected = Manifest::SCHEMA.into();
        return Err(CliError::input(ArtifactError::WrongSchema {
            path,
            found: header.schema,
            expected,
        }));
    }
    if header.version != Manifest::VERSION {
        return Err(CliError::input(ArtifactError::WrongVersion {
            path,
            schema: header.schema,
            found: header.version,
            expected: Manifest::VERSION,
        }));
    }
    serde_json::from_slice(&bytes).map_err(unreadable)
}
