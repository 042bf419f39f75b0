//! The output folder of a run: one subfolder per stage with its current result.
//!
//! A result is written to a temporary folder, forced to the disk, its manifest last, then renamed
//! into place. A manifest in place therefore means that the result is complete, and a kill at any
//! moment leaves the old result or the new one. Only what asperity wrote is replaced or removed (see `own`).
//! Needs a POSIX file system: rename, and flock where one
//! process at a time is to write ([`RunFolder::open`]); a shared folder ([`RunFolder::share`]) needs no lock.

use std::fs::{self, File};
use std::io::{self, Write};
use std::ops::Deref;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::arrays::arrays_content;
use super::lock;
use super::own::{self, Place};
use super::table::{decode_rows, read_bytes};
use super::{
    ArrayDataset, ArrayFile, ArtifactError, Digest, Manifest, Metadata, Output, ResultFile, Row,
    Storage, Table, read_arrays, table_info, write_arrays, write_table,
};

/// Folder of the stored solves in a run folder.
pub const SOLVES_FOLDER: &str = "solves";

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

    /// The manifest of the current result; none if the stage has no finished one.
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

/// The output folder of the one run that may write to it, where the lock ends with the value or the
/// process; or of any number of them, which all compute the same.
#[derive(Debug)]
pub struct RunFolder {
    view: RunView,
    /// None where the folder is shared.
    lock: Option<File>,
}

impl Deref for RunFolder {
    type Target = RunView;

    fn deref(&self) -> &RunView {
        &self.view
    }
}

impl RunFolder {
    /// Creates the folder if needed, locks it and clears away what a killed run left behind.
    ///
    /// # Errors
    /// [`ArtifactError::Locked`] if another run has it, [`ArtifactError::Foreign`] if its lock is a file that asperity
    /// did not write, [`ArtifactError::Io`] if it cannot be created or written to.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self, ArtifactError> {
        let path = path.into();
        fs::create_dir_all(&path).map_err(ArtifactError::io("create", &path))?;
        let lock = lock::take(&path)?;
        own::clear_leftovers(&path)?;
        Ok(Self { view: RunView { path, declared: None }, lock: Some(lock) })
    }

    /// Creates the folder if needed, for one of several processes on any number of machines that bring it up
    /// to the same recipe.
    ///
    /// Takes no lock, which shared file systems may not have or may keep for each machine alone, and clears
    /// nothing away, which may be another's work. Whoever finishes a result first puts it in place; the others
    /// find it and drop theirs.
    ///
    /// # Errors
    /// [`ArtifactError::Io`] if the folder cannot be created.
    pub fn share(path: impl Into<PathBuf>) -> Result<Self, ArtifactError> {
        let path = path.into();
        fs::create_dir_all(&path).map_err(ArtifactError::io("create", &path))?;
        Ok(Self { view: RunView { path, declared: None }, lock: None })
    }

    /// Starts a result of the stage in a temporary folder; dropping it leaves the old result.
    ///
    /// # Errors
    /// [`ArtifactError::Io`] if the temporary folder cannot be created.
    pub fn begin(&self, stage: &str) -> Result<Pending<'_>, ArtifactError> {
        let folder = own::new_folder(self.path(), stage)?;
        Ok(Pending { run: self, stage: stage.to_owned(), folder, outputs: Vec::new() })
    }
}

/// A result that is being written.
#[derive(Debug)]
pub struct Pending<'a> {
    run: &'a RunFolder,
    stage: String,
    folder: PathBuf,
    outputs: Vec<Output>,
}

impl Pending<'_> {
    /// Path at which a file of the result is to be written; [`Pending::record`] makes it an output.
    ///
    /// # Errors
    /// [`ArtifactError::Io`] if it cannot be noted that the file is asperity's.
    pub fn path(&self, file: &str) -> Result<PathBuf, ArtifactError> {
        own::note_in_journal(&self.folder, file)?;
        Ok(self.folder.join(file))
    }

    /// The outputs so far, for the manifest.
    pub fn outputs(&self) -> &[Output] {
        &self.outputs
    }

    /// Writes a table and records it as an output.
    ///
    /// # Errors
    /// Those of [`write_table`].
    pub fn write_rows<R: Row>(&mut self, table: Table<R>, rows: &[R]) -> Result<(), ArtifactError> {
        self.write_table(table, rows, &Metadata::new())
    }

    /// Writes a table with metadata and records it as an output.
    ///
    /// # Errors
    /// Those of [`write_table`].
    pub fn write_table<R: Row>(
        &mut self,
        table: Table<R>,
        rows: &[R],
        metadata: &Metadata,
    ) -> Result<(), ArtifactError> {
        let content = write_table(&self.path(table.name())?, rows, metadata)?;
        self.record(table.name(), R::SCHEMA, R::VERSION, Some(content))
    }

    /// Writes arrays and records them as an output.
    ///
    /// # Errors
    /// Those of [`write_arrays`].
    pub fn write_arrays(
        &mut self,
        arrays: ArrayFile,
        storage: Storage,
        datasets: &[ArrayDataset],
    ) -> Result<(), ArtifactError> {
        let ArrayFile { file, schema, version, description } = arrays;
        let path = self.path(file.name)?;
        let content = write_arrays(&path, schema, version, description, storage, datasets)?;
        self.record(file.name, schema, version, Some(content))
    }

    /// Writes a text for people, as Markdown or SVG, and records it as an output of the schema
    /// `asperity.document`.
    ///
    /// # Errors
    /// [`ArtifactError::Io`].
    pub fn write_document(&mut self, file: &str, text: &str) -> Result<(), ArtifactError> {
        let path = self.path(file)?;
        fs::write(&path, text).map_err(ArtifactError::io("write", &path))?;
        self.record(file, "asperity.document", 1, None)
    }

    /// Records a file written at [`Pending::path`] as an output; without a content digest its
    /// bytes are the content.
    ///
    /// # Errors
    /// [`ArtifactError::Io`] if the file cannot be read.
    pub fn record(
        &mut self,
        file: &str,
        schema: &str,
        schema_version: u32,
        content_digest: Option<Digest>,
    ) -> Result<(), ArtifactError> {
        let path = self.folder.join(file);
        let bytes_digest = Digest::of_file(&path)?;
        let size = fs::metadata(&path).map_err(ArtifactError::io("read", &path))?.len();
        self.outputs.push(Output {
            file: file.to_owned(),
            schema: schema.to_owned(),
            schema_version,
            bytes_digest,
            content_digest: content_digest.unwrap_or(bytes_digest),
            size,
        });
        Ok(())
    }

    /// Makes this the current result of the stage.
    ///
    /// Forces files and folders to the disk, the manifest last; the old result is moved aside
    /// and removed once the new one is in place.
    ///
    /// # Errors
    /// [`ArtifactError::Foreign`] if what is there is not asperity's, [`ArtifactError::Io`]; the old result then stays,
    /// or comes back with the next [`RunFolder::open`].
    pub fn commit(self, manifest: &Manifest) -> Result<(), ArtifactError> {
        let folder = &self.folder;
        for output in &self.outputs {
            synchronise(&folder.join(&output.file))?;
        }
        write_manifest(&self.path(Manifest::FILE)?, manifest)?;
        own::end_journal(folder)?;
        synchronise(folder)?;

        let run = self.run.path();
        let aside = if self.run.lock.is_some() {
            self.replace()?.into_iter().collect()
        } else {
            self.put_beside_others(manifest)?
        };
        synchronise(run)?;
        aside.iter().try_for_each(|aside| own::clear(aside))
    }

    /// Moves the old result aside, the new one into place; returns where the old one is. Nobody else writes.
    fn replace(&self) -> Result<Option<PathBuf>, ArtifactError> {
        let place = self.run.path().join(&self.stage);
        let aside = self.make_room()?;
        if let Err(error) = fs::rename(&self.folder, &place) {
            if let Some(aside) = &aside {
                fs::rename(aside, &place).map_err(ArtifactError::io("restore", &place))?;
            }
            return Err(ArtifactError::io("rename a new result to", &place)(error));
        }
        Ok(aside)
    }

    /// Moves what asperity wrote away from the place of the result; returns where it is.
    fn make_room(&self) -> Result<Option<PathBuf>, ArtifactError> {
        let run = self.run.path();
        let place = run.join(&self.stage);
        match own::place(run, &self.stage)? {
            Place::Free => Ok(None),
            Place::Link => match fs::remove_file(&place) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    Err(ArtifactError::io("remove", &place)(error))
                }
                _ => Ok(None),
            },
            Place::Result => {
                let aside = own::old_folder(run, &self.stage)?;
                match fs::rename(&place, &aside) {
                    // Another process was quicker to move it.
                    Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                    renamed => renamed.map_err(ArtifactError::io("rename", &place))?,
                }
                Ok(Some(aside))
            }
        }
    }

    /// Moves the new result into place unless another process has put the same there. What else is there is moved
    /// aside; returns the folders that are to be removed.
    fn put_beside_others(&self, manifest: &Manifest) -> Result<Vec<PathBuf>, ArtifactError> {
        let place = self.run.path().join(&self.stage);
        let mut aside = Vec::new();
        loop {
            let Err(error) = fs::rename(&self.folder, &place) else { return Ok(aside) };
            let occupied = [
                io::ErrorKind::AlreadyExists,
                io::ErrorKind::DirectoryNotEmpty,
                io::ErrorKind::NotADirectory,
            ];
            if !occupied.contains(&error.kind()) {
                return Err(ArtifactError::io("rename a new result to", &place)(error));
            }
            let there = self.run.stage_manifest(&self.stage).ok().flatten();
            if there.is_some_and(|there| there.key == manifest.key)
                && self.run.verify(&self.stage).is_ok()
            {
                aside.push(self.folder.clone());
                return Ok(aside);
            }
            aside.extend(self.make_room()?);
        }
    }
}

impl Drop for Pending<'_> {
    /// Removes what was begun. A failure leaves it to the next run, which clears it.
    fn drop(&mut self) {
        if self.folder.is_dir() {
            let _ = own::clear(&self.folder);
        }
    }
}

fn write_manifest(path: &Path, manifest: &Manifest) -> Result<(), ArtifactError> {
    let mut text = serde_json::to_string_pretty(manifest).map_err(|error| {
        ArtifactError::NotRepresentable { what: "the manifest".into(), reason: error.to_string() }
    })?;
    text.push('\n');
    let mut file = File::create(path).map_err(ArtifactError::io("create", path))?;
    file.write_all(text.as_bytes())
        .and_then(|()| file.sync_all())
        .map_err(ArtifactError::io("write", path))
}

fn synchronise(path: &Path) -> Result<(), ArtifactError> {
    File::open(path).and_then(|file| file.sync_all()).map_err(ArtifactError::io("write", path))
}
