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

use super::RunView;
use super::lock;
use super::own::{self, Place};
use super::{
    ArrayDataset, ArrayFile, ArtifactError, Digest, Manifest, Metadata, Output, Row, Storage,
    Table, write_arrays, write_table,
};

/// Folder of the stored solves in a run folder.
pub const SOLVES_FOLDER: &str = "solves";

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
        Ok(Self { view: RunView::of(path), lock: Some(lock) })
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
        Ok(Self { view: RunView::of(path), lock: None })
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
