//! The output folder of a run: one subfolder per stage with its current result.
//!
//! A result is written to a temporary folder, forced to the disk, its manifest last, then renamed
//! into place. A manifest in place therefore means that the result is complete, and a kill at any
//! moment leaves the old result or the new one. Needs a POSIX file system: rename, and flock where one
//! process at a time is to write ([`RunFolder::open`]); a shared folder ([`RunFolder::share`]) needs no lock.

use std::fs::{self, File, Permissions, TryLockError};
use std::io::{self, Write};
use std::ops::Deref;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::Deserialize;
use tempfile::TempDir;

use super::arrays::arrays_content;
use super::table::{decode_rows, read_bytes, table_info};
use super::{
    ArrayDataset, ArtifactError, Digest, Manifest, Metadata, Output, Row, Storage, read_arrays,
    write_arrays, write_table,
};

/// Folder of the stored solves in a run folder.
pub const SOLVES_FOLDER: &str = "solves";
const LOCK_FILE: &str = ".lock";
const PENDING_PREFIX: &str = ".tmp-";
const REPLACED_PREFIX: &str = ".old-";

/// The results in an output folder, for reading; others may be writing at the same time.
#[derive(Debug)]
pub struct RunView {
    path: PathBuf,
}

impl RunView {
    /// View of the folder, which need not exist yet.
    pub fn of(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// The output folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of a file of a result, whether it exists or not.
    pub fn file(&self, stage: &str, file: &str) -> PathBuf {
        self.path.join(stage).join(file)
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
        let bytes = match fs::read(&path) {
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

    /// Reads a table of a result after comparing its bytes with the manifest.
    ///
    /// # Errors
    /// Those of [`RunView::verify`] and [`read_table`](super::read_table),
    /// [`ArtifactError::NoSuchOutput`].
    pub fn read_table<R: Row>(
        &self,
        stage: &str,
        file: &str,
    ) -> Result<(Vec<R>, Metadata), ArtifactError> {
        let output = self.finished_output(stage, file)?;
        let path = self.file(stage, file);
        let bytes = read_bytes(&path)?;
        check_size(&path, output.size, bytes.len() as u64)?;
        ArtifactError::check_digest(&path, output.bytes_digest, Digest::of_bytes(&bytes))?;
        decode_rows(&path, bytes)
    }

    /// Reads a file of arrays of a result after comparing its bytes with the manifest.
    ///
    /// # Errors
    /// Those of [`RunView::verify`] and [`read_arrays`], [`ArtifactError::NoSuchOutput`].
    pub fn read_arrays(
        &self,
        stage: &str,
        file: &str,
        schema: &str,
        version: u32,
    ) -> Result<Vec<ArrayDataset>, ArtifactError> {
        let output = self.finished_output(stage, file)?;
        self.verify_bytes(stage, &output)?;
        read_arrays(&self.file(stage, file), schema, version)
    }

    fn finished(&self, stage: &str) -> Result<Manifest, ArtifactError> {
        self.stage_manifest(stage)?.ok_or_else(|| ArtifactError::NoResult {
            path: self.path.clone(),
            stage: stage.to_owned(),
        })
    }

    fn finished_output(&self, stage: &str, file: &str) -> Result<Output, ArtifactError> {
        let manifest = self.finished(stage)?;
        manifest.output(file).cloned().ok_or_else(|| {
            let names: Vec<_> = manifest.outputs.iter().map(|o| o.file.as_str()).collect();
            ArtifactError::NoSuchOutput {
                stage: stage.to_owned(),
                file: file.to_owned(),
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

/// A program that another thread is just starting holds a copy of every open file until it runs,
/// also of the lock of a folder that was closed meanwhile: a lock counts from this many tries on.
const LOCK_TRIES: u32 = 50;
const BETWEEN_TRIES: Duration = Duration::from_millis(20);

fn lock_patiently(lock: &File) -> Result<(), TryLockError> {
    for _ in 1..LOCK_TRIES {
        match lock.try_lock() {
            Err(TryLockError::WouldBlock) => std::thread::sleep(BETWEEN_TRIES),
            other => return other,
        }
    }
    lock.try_lock()
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
    /// [`ArtifactError::Locked`] if another run has it, [`ArtifactError::Io`] if it cannot be
    /// created or written to.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self, ArtifactError> {
        let path = path.into();
        fs::create_dir_all(&path).map_err(ArtifactError::io("create", &path))?;
        let lock_path = path.join(LOCK_FILE);
        let mut lock = File::options()
            .create(true)
            .truncate(false)
            .read(true)
            .write(true)
            .open(&lock_path)
            .map_err(ArtifactError::io("create", &lock_path))?;
        match lock_patiently(&lock) {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let holder = io::read_to_string(&lock).unwrap_or_default();
                return Err(ArtifactError::Locked { path, holder: holder.trim_end().to_owned() });
            }
            Err(TryLockError::Error(error)) => {
                return Err(ArtifactError::io("lock", &lock_path)(error));
            }
        }
        sign(&mut lock).map_err(ArtifactError::io("write", &lock_path))?;
        clear_leftovers(&path)?;
        Ok(Self { view: RunView { path }, lock: Some(lock) })
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
        Ok(Self { view: RunView { path }, lock: None })
    }

    /// Starts a result of the stage in a temporary folder; dropping it leaves the old result.
    ///
    /// # Errors
    /// [`ArtifactError::Io`] if the temporary folder cannot be created.
    pub fn begin(&self, stage: &str) -> Result<Pending<'_>, ArtifactError> {
        let folder = tempfile::Builder::new()
            .prefix(&format!("{PENDING_PREFIX}{stage}-"))
            // The usual permissions less the umask: results are for colleagues too.
            .permissions(Permissions::from_mode(0o777))
            .tempdir_in(self.path())
            .map_err(ArtifactError::io("create a folder in", self.path()))?;
        Ok(Pending { run: self, stage: stage.to_owned(), folder, outputs: Vec::new() })
    }
}

/// Says in the lock who has it.
fn sign(lock: &mut File) -> io::Result<()> {
    lock.set_len(0)?;
    writeln!(lock, "process {}", std::process::id())
}

/// Removes temporary folders, and temporary files of stored solves. A replaced result goes as well, unless the kill came between moving
/// it aside and moving the new one into place; then it is put back.
fn clear_leftovers(run: &Path) -> Result<(), ArtifactError> {
    for entry in fs::read_dir(run).map_err(ArtifactError::io("read", run))? {
        let path = entry.map_err(ArtifactError::io("read", run))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match name.strip_prefix(REPLACED_PREFIX) {
            Some(stage) if !run.join(stage).exists() => {
                fs::rename(&path, run.join(stage)).map_err(ArtifactError::io("rename", &path))?;
            }
            None if !name.starts_with(PENDING_PREFIX) => {}
            _ => remove(&path)?,
        }
    }
    let solves = run.join(SOLVES_FOLDER);
    // A linked store is that of a sweep, where others write.
    if solves.is_symlink() { Ok(()) } else { clear_solves(&solves) }
}

/// Only with the lock: another process may be writing otherwise.
fn clear_solves(store: &Path) -> Result<(), ArtifactError> {
    let entries = |path: &Path| match fs::read_dir(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        read => read
            .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
            .map_err(ArtifactError::io("read", path)),
    };
    for folder in entries(store)?.into_iter().filter(|path| path.is_dir()) {
        for path in entries(&folder)? {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if name.starts_with(PENDING_PREFIX) {
                remove(&path)?;
            }
        }
    }
    Ok(())
}

/// Removes a folder with all in it, or a file that stands where a folder should.
fn remove(path: &Path) -> Result<(), ArtifactError> {
    let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    removed.map_err(ArtifactError::io("remove", path))
}

/// A result that is being written.
#[derive(Debug)]
pub struct Pending<'a> {
    run: &'a RunFolder,
    stage: String,
    folder: TempDir,
    outputs: Vec<Output>,
}

impl Pending<'_> {
    /// Path at which a file of the result is to be written; [`Pending::record`] makes it an output.
    pub fn path(&self, file: &str) -> PathBuf {
        self.folder.path().join(file)
    }

    /// The outputs so far, for the manifest.
    pub fn outputs(&self) -> &[Output] {
        &self.outputs
    }

    /// Writes a table and records it as an output.
    ///
    /// # Errors
    /// Those of [`write_table`].
    pub fn write_table<R: Row>(
        &mut self,
        file: &str,
        rows: &[R],
        metadata: &Metadata,
    ) -> Result<(), ArtifactError> {
        let content = write_table(&self.path(file), rows, metadata)?;
        self.record(file, R::SCHEMA, R::VERSION, Some(content))
    }

    /// Writes arrays and records them as an output.
    ///
    /// # Errors
    /// Those of [`write_arrays`].
    pub fn write_arrays(
        &mut self,
        file: &str,
        schema: &str,
        version: u32,
        description: &str,
        storage: Storage,
        datasets: &[ArrayDataset],
    ) -> Result<(), ArtifactError> {
        let content =
            write_arrays(&self.path(file), schema, version, description, storage, datasets)?;
        self.record(file, schema, version, Some(content))
    }

    /// Writes a text for people, as Markdown or SVG, and records it as an output of the schema
    /// `asperity.document`.
    ///
    /// # Errors
    /// [`ArtifactError::Io`].
    pub fn write_document(&mut self, file: &str, text: &str) -> Result<(), ArtifactError> {
        let path = self.path(file);
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
        let path = self.path(file);
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
    /// [`ArtifactError::Io`]; the old result then stays, or comes back with the next
    /// [`RunFolder::open`].
    pub fn commit(self, manifest: &Manifest) -> Result<(), ArtifactError> {
        let folder = self.folder.path();
        for entry in fs::read_dir(folder).map_err(ArtifactError::io("read", folder))? {
            synchronise(&entry.map_err(ArtifactError::io("read", folder))?.path())?;
        }
        write_manifest(&folder.join(Manifest::FILE), manifest)?;
        synchronise(folder)?;

        let run = self.run.path();
        let place = run.join(&self.stage);
        let put = if self.run.lock.is_some() {
            self.replace(&place)?;
            true
        } else {
            self.put_beside_others(&place, manifest)?
        };
        if put {
            // The folder has moved; nothing is left for its guard to remove.
            let _ = self.folder.keep();
        }
        synchronise(run)?;
        remove_if_there(&run.join(format!("{REPLACED_PREFIX}{}", self.stage)))
    }

    /// Moves the old result aside, the new one into place. Nobody else writes.
    fn replace(&self, place: &Path) -> Result<(), ArtifactError> {
        let aside = self.run.path().join(format!("{REPLACED_PREFIX}{}", self.stage));
        let replaces = place.exists();
        if replaces {
            fs::rename(place, &aside).map_err(ArtifactError::io("rename", place))?;
        }
        if let Err(error) = fs::rename(self.folder.path(), place) {
            if replaces {
                fs::rename(&aside, place).map_err(ArtifactError::io("restore", place))?;
            }
            return Err(ArtifactError::io("rename a new result to", place)(error));
        }
        Ok(())
    }

    /// Moves the new result into place unless another process has put the same there; returns whether it did.
    /// What else is there is moved aside and removed.
    fn put_beside_others(&self, place: &Path, manifest: &Manifest) -> Result<bool, ArtifactError> {
        loop {
            let Err(error) = fs::rename(self.folder.path(), place) else { return Ok(true) };
            let occupied = [
                io::ErrorKind::AlreadyExists,
                io::ErrorKind::DirectoryNotEmpty,
                io::ErrorKind::NotADirectory,
            ];
            if !occupied.contains(&error.kind()) {
                return Err(ArtifactError::io("rename a new result to", place)(error));
            }
            let there = self.run.stage_manifest(&self.stage).ok().flatten();
            if there.is_some_and(|there| there.key == manifest.key)
                && self.run.verify(&self.stage).is_ok()
            {
                return Ok(false);
            }
            let aside = tempfile::Builder::new()
                .prefix(PENDING_PREFIX)
                .tempdir_in(self.run.path())
                .map_err(ArtifactError::io("create a folder in", self.run.path()))?;
            match fs::rename(place, aside.path().join("old")) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(ArtifactError::io("rename", place)(error));
                }
                // Another process was quicker to move it.
                _ => {}
            }
        }
    }
}

fn remove_if_there(path: &Path) -> Result<(), ArtifactError> {
    if path.exists() || path.is_symlink() { remove(path) } else { Ok(()) }
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
