//! Store of single results, so that a stopped run or sweep continues where it stopped.

mod pack;

pub use pack::{PACK_EXTENSION, PACK_SCHEMA, PackInfo, Solves, read_pack_info};

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::own::{self, temporary_beside};
use super::{ArtifactError, Digest};

/// Schema name of the file of a stored solve.
pub const SOLVE_SCHEMA: &str = "asperity.solve";
const VERSION: u32 = 1;

/// A folder of results, each under the digest of all that determines it.
///
/// A result is one JSON file `ab/<64 digits>.json` with the digest of its payload, written under a
/// temporary name and renamed. It is not forced to the disk: a plain write takes some 0.1 ms, an
/// fsync milliseconds, which over hundreds of results would dominate a sweep. What a power cut
/// leaves torn, or a disk flips, fails its digest and counts as absent, so at worst a solve is
/// repeated. Any number of processes may use one store, also for the same key: each rename puts a
/// complete file.
#[derive(Debug, Clone)]
pub struct SolveStore {
    dir: PathBuf,
    packed: bool,
    /// What was kept since, for a store that is to be filled anew.
    anew: Option<Arc<Mutex<BTreeSet<Digest>>>>,
}

#[derive(Serialize, Deserialize)]
struct Entry {
    schema: String,
    version: u32,
    key: Digest,
    digest_of_payload: Digest,
    payload: Value,
}

impl SolveStore {
    /// Opens a store, creating its folder if needed.
    ///
    /// # Errors
    /// [`ArtifactError::Foreign`] if the folder is a link that asperity did not make, [`ArtifactError::Io`] if it
    /// cannot be created.
    pub fn open(dir: impl Into<PathBuf>) -> Result<Self, ArtifactError> {
        let dir = dir.into();
        own::check_solves(&dir)?;
        fs::create_dir_all(&dir).map_err(ArtifactError::io("create", &dir))?;
        Ok(Self { dir, packed: false, anew: None })
    }

    /// The same store, in which only what is kept from now on counts as there: the solves of a stage that is to be
    /// computed again replace the old ones one by one, and those of other stages stay.
    #[must_use]
    pub fn anew(self) -> Self {
        Self { anew: Some(Arc::default()), ..self }
    }

    /// Whether what is kept under that key counts.
    fn counts(&self, key: &Digest) -> bool {
        let kept =
            self.anew.as_ref().map(|kept| kept.lock().unwrap_or_else(PoisonError::into_inner));
        kept.is_none_or(|kept| kept.contains(key))
    }

    /// Opens a store that keeps all solves of a problem in one file (see [`Solves`]), for the shards of a sweep:
    /// a file for each of a million solves is more than shared file systems bear.
    ///
    /// # Errors
    /// As [`SolveStore::open`].
    pub fn open_packed(dir: impl Into<PathBuf>) -> Result<Self, ArtifactError> {
        Ok(Self { packed: true, ..Self::open(dir)? })
    }

    /// The result under that key; none if there is none, if it is damaged or of another version,
    /// in which cases the file is removed. Floats come back with the same bits.
    ///
    /// # Errors
    /// [`ArtifactError::Io`] if a file that exists cannot be read or removed.
    pub fn get<T: DeserializeOwned>(&self, key: &Digest) -> Result<Option<T>, ArtifactError> {
        if !self.counts(key) {
            return Ok(None);
        }
        let path = self.path(key);
        let bytes = match fs::read(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            read => read.map_err(ArtifactError::io("read", &path))?,
        };
        if let Some(payload) = intact_payload(&bytes, key)
            && let Ok(value) = serde_json::from_value(payload)
        {
            return Ok(Some(value));
        }
        // Another process may have removed it or, rarely, put a good one: then that is repeated.
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(ArtifactError::io("remove", &path)(error))
            }
            _ => Ok(None),
        }
    }

    /// Keeps a result under a key, in place of any other.
    ///
    /// # Errors
    /// [`ArtifactError::NotRepresentable`] if the value would not read back (a number that is not
    /// finite), [`ArtifactError::Io`].
    pub fn put<T: Serialize + DeserializeOwned>(
        &self,
        key: &Digest,
        value: &T,
    ) -> Result<(), ArtifactError> {
        let payload = representable(key, value)?;
        let entry = Entry {
            schema: SOLVE_SCHEMA.to_owned(),
            version: VERSION,
            key: *key,
            digest_of_payload: Digest::of_value(&payload),
            payload,
        };
        let bytes = serde_json::to_vec(&entry).map_err(|error| unfit(key, &error))?;
        write_by_rename(&self.path(key), &bytes)?;
        if let Some(kept) = &self.anew {
            kept.lock().unwrap_or_else(PoisonError::into_inner).insert(*key);
        }
        Ok(())
    }

    /// 256 folders at most, so that none grows large.
    fn path(&self, key: &Digest) -> PathBuf {
        let digits = key.to_string();
        self.dir.join(&digits[..2]).join(format!("{digits}.json"))
    }
}

/// The file of a stored solve, for a reader who does not know its key.
#[derive(Debug, Clone, Serialize)]
pub struct StoredSolve {
    /// Version of the file.
    pub version: u32,
    /// Digest of all that determines the result.
    pub key: Digest,
    /// Whether the result is that which was written.
    pub intact: bool,
    /// The result.
    pub payload: Value,
}

/// Reads the file of a stored solve, intact or not.
///
/// # Errors
/// [`ArtifactError::Io`]; [`ArtifactError::Unreadable`], [`ArtifactError::WrongSchema`] or
/// [`ArtifactError::WrongVersion`] for a file of another kind.
pub fn read_stored_solve(path: &Path) -> Result<StoredSolve, ArtifactError> {
    let bytes = fs::read(path).map_err(ArtifactError::io("read", path))?;
    let entry: Entry = serde_json::from_slice(&bytes)
        .map_err(|error| ArtifactError::unreadable(path, "stored solve", error))?;
    ArtifactError::check_schema(path, (&entry.schema, entry.version), (SOLVE_SCHEMA, VERSION))?;
    let intact = Digest::of_value(&entry.payload) == entry.digest_of_payload;
    Ok(StoredSolve { version: entry.version, key: entry.key, intact, payload: entry.payload })
}

fn intact_payload(bytes: &[u8], key: &Digest) -> Option<Value> {
    let entry: Entry = serde_json::from_slice(bytes).ok()?;
    let as_asked = entry.schema == SOLVE_SCHEMA && entry.version == VERSION && entry.key == *key;
    (as_asked && Digest::of_value(&entry.payload) == entry.digest_of_payload)
        .then_some(entry.payload)
}

/// The JSON form of a value that reads back.
fn representable<T: Serialize + DeserializeOwned>(
    key: &Digest,
    value: &T,
) -> Result<Value, ArtifactError> {
    let payload = serde_json::to_value(value).map_err(|error| unfit(key, &error))?;
    T::deserialize(&payload).map_err(|error| unfit(key, &error))?;
    Ok(payload)
}

fn unfit(key: &Digest, error: &serde_json::Error) -> ArtifactError {
    let what = format!("result {key:#}");
    ArtifactError::NotRepresentable { what, reason: error.to_string() }
}

/// Writes a file under a temporary name beside its place and renames it; it is not forced to the disk.
///
/// # Errors
/// [`ArtifactError::Io`].
pub(crate) fn write_by_rename(path: &Path, bytes: &[u8]) -> Result<(), ArtifactError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    if folder.is_symlink() {
        return Err(ArtifactError::foreign_link(folder));
    }
    fs::create_dir_all(folder).map_err(ArtifactError::io("create", folder))?;
    let mut file = temporary_beside(path).map_err(ArtifactError::io("create a file in", folder))?;
    file.write_all(bytes).map_err(ArtifactError::io("write", path))?;
    file.persist(path).map_err(|error| ArtifactError::io("rename to", path)(error.error))?;
    Ok(())
}
