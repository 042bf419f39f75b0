//! The results in an output folder, for reading.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::arrays::arrays_content;
use super::own;
use super::table::{decode_rows, read_bytes};
use super::{
    ArrayDataset, ArrayFile, ArtifactError, Digest, Manifest, Metadata, Output, ResultFile, Row,
    SOLVES_FOLDER, Table, read_arrays, table_info, visit_arrays,
};

/// The results in an output folder, for reading; others may be writing at the same time.
#[derive(Debug)]
pub struct RunView {
    path: PathBuf,
    /// The files that may be read; all if `None`.
    declared: Option<Vec<ResultFile>>,
}

impl RunView {
    /// View of the folder, which need not exist yet.
    pub fn of(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), declared: None }
    }

    /// The same folder, of which only these files may be read: what a stage reads without declaring it would be
    /// missing in the key of its result.
    #[must_use]
    pub fn declaring(&self, files: Vec<ResultFile>) -> Self {
        Self { path: self.path.clone(), declared: Some(files) }
    }

    /// The output folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of a file of a result, whether it exists or not.
    pub fn file(&self, stage: &str, file: &str) -> PathBuf {
        self.path.join(stage).join(file)
    }

    /// Path of a file of a result, whether it exists or not.
    pub fn path_of(&self, file: impl Into<ResultFile>) -> PathBuf {
        let ResultFile { stage, name } = file.into();
        self.file(stage, name)
    }

    /// Whether the result of a stage has that file.
    ///
    /// # Errors
    /// Those of [`RunView::stage_manifest`].
    pub fn has(&self, file: impl Into<ResultFile>) -> Result<bool, ArtifactError> {
        let ResultFile { stage, name } = file.into();
        Ok(self.stage_manifest(stage)?.is_some_and(|manifest| manifest.output(name).is_some()))
    }

    /// The manifest of the current result; `None` if the stage has no finished one.
    ///
    /// # Errors
    /// [`ArtifactError::Unreadable`] if it is no manifest, [`ArtifactError::WrongVersion`] if it
    /// is one of another version, [`ArtifactError::Damaged`], [`ArtifactError::Io`].
    pub fn stage_manifest(&self, stage: &str) -> Result<Option<Manifest>, ArtifactError> {
        #[derive(Deserialize)]
        struct Header {
            schema: String,
            version: u32,
        }
        let path = self.file(stage, Manifest::FILE);
        let bytes = match crate::files::read(&path, crate::files::LARGEST_NUMBERS) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            read => read.map_err(ArtifactError::io("read", &path))?,
        };
        let unreadable = |error: serde_json::Error| {
            ArtifactError::unreadable(&path, "manifest", error.to_string())
        };
        // Another version may have other fields, so the header is judged alone.
        let header: Header = serde_json::from_slice(&bytes).map_err(unreadable)?;
        let found = (header.schema.as_str(), header.version);
        ArtifactError::check_schema(&path, found, (Manifest::SCHEMA, Manifest::VERSION))?;
        let manifest: Manifest = serde_json::from_slice(&bytes).map_err(unreadable)?;
        ArtifactError::check_digest(&path, manifest.digest, Digest::seal_of(&manifest)?)?;
        Ok(Some(manifest))
    }

    /// Compares size, digest and content of every output with the manifest.
    ///
    /// # Errors
    /// [`ArtifactError::NoResult`], or for the first bad file [`ArtifactError::Io`] if it is
    /// missing, [`ArtifactError::WrongSize`] or [`ArtifactError::Damaged`].
    pub fn verify(&self, stage: &str) -> Result<(), ArtifactError> {
        let manifest = self.finished(stage)?;
        manifest.outputs.iter().try_for_each(|output| self.verify_output(stage, output))
    }

    /// The rows of a table of a result.
    ///
    /// # Errors
    /// Those of [`RunView::read_table`].
    pub fn rows<R: Row>(&self, table: Table<R>) -> Result<Vec<R>, ArtifactError> {
        Ok(self.read_table(table)?.0)
    }

    /// Reads a table of a result with its metadata, after comparing its bytes with the manifest.
    ///
    /// # Errors
    /// Those of [`RunView::verify`] and [`read_table`](super::read_table),
    /// [`ArtifactError::NoSuchOutput`], [`ArtifactError::Undeclared`].
    pub fn read_table<R: Row>(&self, table: Table<R>) -> Result<(Vec<R>, Metadata), ArtifactError> {
        let output = self.finished_output(table.file())?;
        let path = self.path_of(table);
        let bytes = read_bytes(&path)?;
        check_size(&path, output.size, bytes.len() as u64)?;
        ArtifactError::check_digest(&path, output.bytes_digest, Digest::of_bytes(&bytes))?;
        decode_rows(&path, bytes)
    }

    /// Reads a file of arrays of a result after comparing its bytes with the manifest.
    ///
    /// # Errors
    /// Those of [`RunView::verify`] and [`read_arrays`], [`ArtifactError::NoSuchOutput`].
    pub fn read_arrays(&self, arrays: ArrayFile) -> Result<Vec<ArrayDataset>, ArtifactError> {
        let output = self.finished_output(arrays.file)?;
        self.verify_bytes(arrays.file.stage, &output)?;
        read_arrays(&self.path_of(arrays), arrays.schema, arrays.version)
    }

    /// Hands over the arrays of a file of a result one by one, see [`visit_arrays`].
    ///
    /// # Errors
    /// Those of [`RunView::read_arrays`].
    pub fn visit_arrays(
        &self,
        arrays: ArrayFile,
        each: impl FnMut(ArrayDataset),
    ) -> Result<(), ArtifactError> {
        let output = self.finished_output(arrays.file)?;
        self.verify_bytes(arrays.file.stage, &output)?;
        visit_arrays(&self.path_of(arrays), arrays.schema, arrays.version, each)
    }

    /// Fails if a new result of the stage would have to replace what asperity did not write.
    ///
    /// # Errors
    /// [`ArtifactError::Foreign`] names it; [`ArtifactError::Io`].
    pub fn check_place(&self, stage: &str) -> Result<(), ArtifactError> {
        own::place(&self.path, stage).map(drop)
    }

    /// Fails for a folder of solves that is a link which asperity did not make.
    ///
    /// # Errors
    /// [`ArtifactError::Foreign`].
    pub fn check_solves(&self) -> Result<(), ArtifactError> {
        own::check_solves(&self.path.join(SOLVES_FOLDER))
    }

    /// Entries of the folder of a stage that its manifest does not list.
    ///
    /// # Errors
    /// [`ArtifactError::Io`].
    pub fn unlisted(&self, stage: &str) -> Result<Vec<PathBuf>, ArtifactError> {
        own::unlisted(&self.path.join(stage))
    }

    fn finished(&self, stage: &str) -> Result<Manifest, ArtifactError> {
        self.stage_manifest(stage)?.ok_or_else(|| ArtifactError::NoResult {
            path: self.path.clone(),
            stage: stage.to_owned(),
        })
    }

    fn finished_output(&self, file: ResultFile) -> Result<Output, ArtifactError> {
        let ResultFile { stage, name } = file;
        if self.declared.as_ref().is_some_and(|declared| !declared.contains(&file)) {
            let (stage, file) = (stage.to_owned(), name.to_owned());
            return Err(ArtifactError::Undeclared { stage, file });
        }
        let manifest = self.finished(stage)?;
        manifest.output(name).cloned().ok_or_else(|| {
            let names: Vec<_> = manifest.outputs.iter().map(|o| o.file.as_str()).collect();
            ArtifactError::NoSuchOutput {
                stage: stage.to_owned(),
                file: name.to_owned(),
                available: names.join(", "),
            }
        })
    }

    /// Compares size, digest and content of one output with what is expected: first the bytes, which a
    /// library must not see if they are damaged.
    ///
    /// # Errors
    /// As [`Self::verify`].
    pub fn verify_output(&self, stage: &str, output: &Output) -> Result<(), ArtifactError> {
        self.verify_bytes(stage, output)?;
        let path = self.file(stage, &output.file);
        let content = match path.extension().and_then(|extension| extension.to_str()) {
            Some("h5") => arrays_content(&path)?,
            Some("arrow") => table_info(&path)?.content_digest,
            _ => output.bytes_digest,
        };
        ArtifactError::check_digest(&path, output.content_digest, content)
    }

    fn verify_bytes(&self, stage: &str, output: &Output) -> Result<(), ArtifactError> {
        let path = self.file(stage, &output.file);
        let size = fs::metadata(&path).map_err(ArtifactError::io("read", &path))?.len();
        check_size(&path, output.size, size)?;
        ArtifactError::check_digest(&path, output.bytes_digest, Digest::of_file(&path)?)
    }
}

fn check_size(path: &Path, expected: u64, found: u64) -> Result<(), ArtifactError> {
    if expected == found {
        return Ok(());
    }
    Err(ArtifactError::WrongSize { path: path.to_path_buf(), expected, found })
}
