//! The scan files of a recipe: what is at its paths, with digests.

use super::super::StageError;
use super::super::characterise::AVERAGE;
use crate::artifact::{Digest, Input};
use crate::scans::{Source, admit_source};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A scan file with its digest.
#[derive(Debug, Clone)]
pub struct ScanFile {
    /// Where it is.
    pub path: PathBuf,
    /// Name of the scan, from the file.
    pub name: String,
    /// Digest of its bytes.
    pub digest: Digest,
}

/// Finds the scan files of `paths`, in the order of their names within each folder, and digests
/// them.
///
/// # Errors
/// [`StageError::ScanIo`], [`StageError::NoScans`], [`StageError::SameName`],
/// [`StageError::ReservedName`].
pub fn find_scans(paths: &[PathBuf]) -> Result<Vec<ScanFile>, StageError> {
    let mut files = Vec::new();
    for path in paths {
        files.extend(files_at(path)?);
    }
    if files.is_empty() {
        return Err(StageError::NoScans { paths: paths.to_vec() });
    }
    let mut seen: BTreeMap<String, PathBuf> = BTreeMap::new();
    for path in &files {
        if let Some(first) = seen.insert(scan_name(path), path.clone()) {
            let (name, second) = (scan_name(path), path.clone());
            return Err(StageError::SameName { name, first, second });
        }
        // Tables tell the windows from their average by this name.
        if scan_name(path) == AVERAGE {
            return Err(StageError::ReservedName { path: path.clone() });
        }
    }
    files
        .into_par_iter()
        .map(|path| {
            admit(&path).map_err(|source| StageError::ScanIo { path: path.clone(), source })?;
            let digest = Digest::of_file(&path)?;
            Ok(ScanFile { name: scan_name(&path), digest, path })
        })
        .collect()
}

/// Before anything is read: a device may have no end, a large file takes long to digest.
fn admit(path: &Path) -> std::io::Result<()> {
    crate::files::admit(path, u64::MAX)?;
    let file = std::fs::File::open(path)?;
    let length = file.metadata()?.len();
    admit_source(Source::new(file, length)?)
}

fn files_at(path: &Path) -> Result<Vec<PathBuf>, StageError> {
    let io = |source| StageError::ScanIo { path: path.to_owned(), source };
    if !std::fs::metadata(path).map_err(io)?.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).map_err(io)? {
        let entry = entry.map_err(io)?;
        let hidden = entry.file_name().to_string_lossy().starts_with('.');
        if hidden {
            continue;
        }
        // A link to a drive that is not there is a scan that would be missed in silence.
        let found = std::fs::metadata(entry.path())
            .map_err(|source| StageError::ScanIo { path: entry.path(), source })?;
        if found.is_file() {
            files.push(entry.path());
        }
    }
    files.sort();
    Ok(files)
}

fn scan_name(path: &Path) -> String {
    crate::files::name::text(path.file_stem().unwrap_or(path.as_os_str()))
}

/// The scan files as inputs of the stage.
pub fn inputs(files: &[ScanFile]) -> Vec<Input> {
    files
        .iter()
        .map(|file| Input {
            name: file.name.clone(),
            digest: file.digest,
            origin: Some(file.path.display().to_string()),
        })
        .collect()
}
