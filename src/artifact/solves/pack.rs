//! All solves of one problem in one file, for sweeps that would otherwise leave a file for each solve.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{ArtifactError, Digest, SolveStore, representable, write_by_rename};
use crate::artifact::TOOL_VERSION;

/// Schema name of a pack of solves.
pub const PACK_SCHEMA: &str = "asperity.solves";
const VERSION: u32 = 1;
/// How the name of a pack ends.
pub const PACK_EXTENSION: &str = "pack";
/// Work that a kill may cost, besides the solve under way.
const BETWEEN_SAVES: Duration = Duration::from_secs(30);

#[derive(Debug, Serialize, Deserialize)]
struct Pack {
    schema: String,
    version: u32,
    tool_version: String,
    problem: Digest,
    /// Tasks whose every solve is there.
    finished: BTreeSet<Digest>,
    solves: BTreeMap<Digest, Value>,
    digest: Digest,
}

/// What a pack says about itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PackInfo {
    /// Version of the tool that wrote it.
    pub tool_version: String,
    /// Digest of the problem.
    pub problem: Digest,
    /// Digests of the tasks whose every solve is there.
    pub finished: BTreeSet<Digest>,
    /// Number of solves.
    pub solves: usize,
}

/// Reads what a pack says about itself, after comparing its content with its digest.
///
/// # Errors
/// [`ArtifactError::Io`]; [`ArtifactError::Unreadable`], [`ArtifactError::WrongSchema`],
/// [`ArtifactError::WrongVersion`] or [`ArtifactError::Damaged`] for another file.
pub fn read_pack_info(path: &Path) -> Result<PackInfo, ArtifactError> {
    let Pack { tool_version, problem, finished, solves, .. } = Pack::read(path)?;
    Ok(PackInfo { tool_version, problem, finished, solves: solves.len() })
}

impl Pack {
    fn empty(problem: Digest) -> Self {
        Self {
            schema: PACK_SCHEMA.to_owned(),
            version: VERSION,
            tool_version: TOOL_VERSION.to_owned(),
            problem,
            finished: BTreeSet::new(),
            solves: BTreeMap::new(),
            digest: Digest::of_bytes(&[]),
        }
    }

    /// The pack at a path; none if there is none, or a damaged one. One that cannot be read may be whole:
    /// to take it for absent would overwrite what others have solved.
    fn find(path: &Path) -> Result<Option<Self>, ArtifactError> {
        match Self::read(path) {
            Ok(pack) => Ok(Some(pack)),
            Err(ArtifactError::Io { cause, action, path })
                if cause.kind() != io::ErrorKind::NotFound =>
            {
                Err(ArtifactError::Io { action, path, cause })
            }
            Err(_) => Ok(None),
        }
    }

    fn read(path: &Path) -> Result<Self, ArtifactError> {
        #[derive(Deserialize)]
        struct Header {
            schema: String,
            version: u32,
        }
        let bytes = fs::read(path).map_err(ArtifactError::io("read", path))?;
        let unreadable = |error: serde_json::Error| {
            ArtifactError::unreadable(path, "pack of solves", error.to_string())
        };
        let header: Header = serde_json::from_slice(&bytes).map_err(unreadable)?;
        let found = (header.schema.as_str(), header.version);
        ArtifactError::check_schema(path, found, (PACK_SCHEMA, VERSION))?;
        let pack: Self = serde_json::from_slice(&bytes).map_err(unreadable)?;
        ArtifactError::check_digest(path, pack.digest, Digest::seal_of(&pack)?)?;
        Ok(pack)
    }
}

/// The stored solves of one problem: one surface, rubber and speed.
///
/// In a store of single files each solve is written as it comes. In a packed store all solves of the
/// problem are one file, renamed into place when a task is finished, every half minute before that, and when
/// the value is dropped; the pack of another version of the tool, or a damaged one, counts as absent there. Both kinds
/// read packs and single files.
#[derive(Debug)]
pub struct Solves<'a> {
    store: &'a SolveStore,
    pack: Pack,
    saved: Instant,
    changed: bool,
}

impl SolveStore {
    /// The solves of the problem with that digest.
    ///
    /// # Errors
    /// [`ArtifactError::Io`] if its pack exists and cannot be read.
    pub fn problem(&self, problem: &Digest) -> Result<Solves<'_>, ArtifactError> {
        let ours = |pack: &Pack| {
            self.anew.is_none()
                && pack.problem == *problem
                && (!self.packed || pack.tool_version == TOOL_VERSION)
        };
        let there = Pack::find(&self.pack_path(problem))?.filter(ours);
        let pack = there.unwrap_or_else(|| Pack::empty(*problem));
        Ok(Solves { store: self, pack, saved: Instant::now(), changed: false })
    }

    /// Where the pack of a problem is kept: 256 folders at most, as for single solves.
    pub fn pack_path(&self, problem: &Digest) -> PathBuf {
        self.path(problem).with_extension(PACK_EXTENSION)
    }

    /// What the pack of a problem says about itself; none if there is none.
    ///
    /// # Errors
    /// Those of [`read_pack_info`]; [`ArtifactError::Damaged`] for the pack of another problem.
    pub fn pack_info(&self, problem: &Digest) -> Result<Option<PackInfo>, ArtifactError> {
        let path = self.pack_path(problem);
        match read_pack_info(&path) {
            Err(ArtifactError::Io { cause, .. }) if cause.kind() == io::ErrorKind::NotFound => {
                Ok(None)
            }
            Err(error) => Err(error),
            Ok(info) => {
                ArtifactError::check_digest(&path, *problem, info.problem)?;
                Ok(Some(info))
            }
        }
    }
}

impl Solves<'_> {
    /// The result under that key; none if there is none or if it is damaged.
    ///
    /// # Errors
    /// As [`SolveStore::get`].
    pub fn get<T: DeserializeOwned>(&self, key: &Digest) -> Result<Option<T>, ArtifactError> {
        if let Some(value) = self.pack.solves.get(key)
            && let Ok(value) = T::deserialize(value)
        {
            return Ok(Some(value));
        }
        self.store.get(key)
    }

    /// Keeps a result under a key, in place of any other.
    ///
    /// # Errors
    /// As [`SolveStore::put`].
    pub fn put<T: Serialize + DeserializeOwned>(
        &mut self,
        key: &Digest,
        value: &T,
    ) -> Result<(), ArtifactError> {
        if !self.store.packed {
            return self.store.put(key, value);
        }
        self.pack.solves.insert(*key, representable(key, value)?);
        self.changed = true;
        if self.saved.elapsed() >= BETWEEN_SAVES { self.save() } else { Ok(()) }
    }

    /// Whether a packed store has every solve of that task.
    pub fn is_finished(&self, task: &Digest) -> bool {
        self.pack.finished.contains(task)
    }

    /// Notes in a packed store that every solve of a task is there, and writes the pack.
    ///
    /// # Errors
    /// [`ArtifactError::Io`].
    pub fn finish(&mut self, task: &Digest) -> Result<(), ArtifactError> {
        if !self.store.packed || !self.pack.finished.insert(*task) {
            return Ok(());
        }
        self.changed = true;
        self.save()
    }

    /// Writes the pack with what another process has put there since it was read: a second copy of a shard that
    /// is behind must not undo what the first has finished.
    fn save(&mut self) -> Result<(), ArtifactError> {
        let there = Pack::find(&self.store.pack_path(&self.pack.problem))?;
        if let Some(there) = there
            && there.problem == self.pack.problem
            && there.tool_version == TOOL_VERSION
        {
            self.pack.finished.extend(there.finished);
            for (key, value) in there.solves {
                self.pack.solves.entry(key).or_insert(value);
            }
        }
        self.pack.tool_version = TOOL_VERSION.to_owned();
        self.pack.digest = Digest::seal_of(&self.pack)?;
        let bytes = serde_json::to_vec(&self.pack).map_err(|error| {
            let what = format!("the solves of problem {:#}", self.pack.problem);
            ArtifactError::NotRepresentable { what, reason: error.to_string() }
        })?;
        write_by_rename(&self.store.pack_path(&self.pack.problem), &bytes)?;
        (self.saved, self.changed) = (Instant::now(), false);
        Ok(())
    }
}

impl Drop for Solves<'_> {
    /// Keeps what an interrupted task has solved. A failure costs these solves and nothing else: they are
    /// solved again.
    fn drop(&mut self) {
        if self.changed {
            let _ = self.save();
        }
    }
}
