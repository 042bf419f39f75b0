//! Which files of a run folder asperity wrote: nothing else is removed, renamed or changed.
//!
//! - The folder of a stage is asperity's if it holds a manifest of that stage and no entry that the manifest does
//!   not list.
//! - A folder in which something is being written, `.asperity-new-STAGE-x`, has a mark (a link, which comes into being
//!   whole) and a list of the files that asperity makes in it, each noted before it is made. A kill leaves it behind;
//!   the next run removes what the list names.
//! - A replaced result waits in `.asperity-old-STAGE-x` to be removed, with its manifest to the last.
//! - A temporary file of a stored solve has the digest in its name under which the solve is kept.
//! - A link is a sweep's own if it leads from a case or a surface to `surfaces` or `solves` of the same sweep.

use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use serde::Deserialize;
use tempfile::NamedTempFile;

use super::{ArtifactError, Manifest, SOLVES_FOLDER};
use crate::files::os;

/// Folder of the surfaces of all specimens and seeds in that of a sweep.
pub const SURFACES_FOLDER: &str = "surfaces";
/// Folder of the cases in that of a sweep.
pub const CASES_FOLDER: &str = "cases";
/// The note of the last run, beside the folders of the stages.
pub const NOTE_FILE: &str = "last_run.json";
/// First bytes of the note of the last run, by which it is recognised.
pub const NOTE_HEAD: &str = "{\n  \"schema\": \"asperity.last_run\",\n";

/// How the names of all that is temporary begin.
const PREFIX: &str = ".asperity-";
/// The mark of a folder in which something is being written: a link with this text in place of a target.
const MARK: &str = ".asperity";
const MARK_TEXT: &str = "asperity is writing here, and removes what .asperity-files lists";
/// The list of files in such a folder.
const JOURNAL: &str = ".asperity-files";
/// Names that are longer leave no room for a temporary one, 255 bytes at most.
const LONGEST_NAME: usize = 200;

/// Looks at a place to which other processes move results.
const MOST_LOOKS: u32 = 100;

/// What is at the place of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// Nothing, or an empty folder.
    Free,
    /// A result, and nothing besides.
    Result,
    /// A link to the result of another folder of the sweep.
    Link,
}

/// What is at the place of the result of a stage in a run folder.
///
/// # Errors
/// [`ArtifactError::Foreign`] names what asperity did not write, or a manifest that cannot be read.
pub(super) fn place(run: &Path, stage: &str) -> Result<Place, ArtifactError> {
    let path = run.join(stage);
    for _ in 1..MOST_LOOKS {
        let before = identity(&path);
        let found = look(&path, stage);
        // Other processes may have put another result there meanwhile (see `RunFolder::share`).
        if found.is_ok() || identity(&path) == before {
            return found;
        }
    }
    look(&path, stage)
}

/// What tells a file, folder or link from another of the same name.
fn identity(path: &Path) -> Option<(u64, u64)> {
    fs::symlink_metadata(path).ok().map(|metadata| os::identity(&metadata))
}

fn look(path: &Path, stage: &str) -> Result<Place, ArtifactError> {
    let absent = [io::ErrorKind::NotFound, io::ErrorKind::NotADirectory];
    let kind = match fs::symlink_metadata(path) {
        Err(error) if absent.contains(&error.kind()) => return Ok(Place::Free),
        read => read.map_err(ArtifactError::io("read", path))?.file_type(),
    };
    if kind.is_symlink() {
        let own = is_link_of_sweep(path, &[CASES_FOLDER, SURFACES_FOLDER], SURFACES_FOLDER);
        return if own { Ok(Place::Link) } else { Err(ArtifactError::foreign_link(path)) };
    }
    if !kind.is_dir() {
        return Err(in_the_way(path, path));
    }
    let entries = entries(path)?;
    let Some(first) = entries.first() else { return Ok(Place::Free) };
    let manifest = path.join(Manifest::FILE);
    let listed = match listed_by_manifest(path, Some(stage)) {
        Ok(listed) => listed,
        Err(_) if !manifest.exists() => return Err(ArtifactError::Foreign {
            path: first.clone(),
            what: "is in a folder that a result would have to replace and that has no manifest to say what asperity wrote".into(),
            remedy: format!("move {} away, or choose another --out", path.display()),
        }),
        Err(reason) => {
            return Err(ArtifactError::Foreign {
                what: format!(
                    "cannot be used ({reason}), so that nothing tells which files beside it asperity wrote"
                ),
                remedy: format!(
                    "if nothing in {} is yours, delete that folder and run again",
                    path.display()
                ),
                path: manifest,
            });
        }
    };
    match entries.iter().find(|entry| !is_listed(entry, &listed)) {
        Some(foreign) => Err(in_the_way(foreign, path)),
        None => Ok(Place::Result),
    }
}

fn in_the_way(path: &Path, folder: &Path) -> ArtifactError {
    ArtifactError::Foreign {
        path: path.to_owned(),
        what: format!(
            "was not written by asperity, which would have to replace {}",
            folder.display()
        ),
        remedy: "move it away, or choose another --out".into(),
    }
}

impl ArtifactError {
    /// The refusal to write through a link.
    pub(crate) fn foreign_link(path: &Path) -> Self {
        Self::Foreign {
            path: path.to_owned(),
            what: "is a link that asperity did not make, and it writes through none".into(),
            remedy: "remove the link, or choose another --out".into(),
        }
    }
}

/// Fails for a folder of solves that is a link, unless it is a sweep's own.
pub(super) fn check_solves(store: &Path) -> Result<(), ArtifactError> {
    if !store.is_symlink() || is_link_of_sweep(store, &[CASES_FOLDER], SOLVES_FOLDER) {
        return Ok(());
    }
    Err(ArtifactError::foreign_link(store))
}

/// Whether a link leads from below one of the folders `from` of a sweep up and to its folder `to`, to what has the
/// name of the link.
fn is_link_of_sweep(link: &Path, from: &[&str], to: &str) -> bool {
    let (Ok(target), Some(name)) = (fs::read_link(link), link.file_name()) else { return false };
    let up = target.components().take_while(|part| *part == Component::ParentDir).count();
    let mut down = target.components().skip(up);
    let folder = link.parent().unwrap_or(Path::new(""));
    let folder = if folder == Path::new("") { Path::new(".") } else { folder };
    let Ok(folder) = fs::canonicalize(folder) else { return false };
    // The folder that lies directly in that of the sweep.
    let outermost = up.checked_sub(1).and_then(|up| folder.ancestors().nth(up)?.file_name());
    outermost.is_some_and(|outermost| from.iter().any(|from| outermost == *from))
        && down.next() == Some(Component::Normal(to.as_ref()))
        && target.file_name() == Some(name)
        && target.components().skip(up).all(|part| matches!(part, Component::Normal(_)))
}

/// Names of the files that a manifest lists, and of itself; that of the stage, if one is given, whether intact or of
/// another version.
fn listed_by_manifest(folder: &Path, stage: Option<&str>) -> Result<BTreeSet<OsString>, String> {
    #[derive(Deserialize)]
    struct Listed {
        schema: String,
        stage: String,
        outputs: Vec<File>,
    }
    #[derive(Deserialize)]
    struct File {
        file: String,
    }
    let path = folder.join(Manifest::FILE);
    if path.is_symlink() {
        return Err("it is a link".into());
    }
    let bytes = fs::read(&path).map_err(|error| error.to_string())?;
    let listed: Listed = serde_json::from_slice(&bytes).map_err(|error| error.to_string())?;
    if listed.schema != Manifest::SCHEMA {
        return Err(format!("it holds {}", listed.schema));
    }
    if let Some(stage) = stage.filter(|stage| *stage != listed.stage) {
        return Err(format!("it is that of the stage {}, not of {stage}", listed.stage));
    }
    let names = listed.outputs.into_iter().map(|output| output.file.into());
    Ok(names.chain([Manifest::FILE.into()]).collect())
}

/// Whether an entry of a folder is a plain file of a listed name.
fn is_listed(entry: &Path, listed: &BTreeSet<OsString>) -> bool {
    let plain = fs::symlink_metadata(entry).is_ok_and(|metadata| metadata.is_file());
    plain && entry.file_name().is_some_and(|name| listed.contains(name))
}

/// A new folder for what is being written.
pub(super) fn new_folder(run: &Path, stage: &str) -> Result<PathBuf, ArtifactError> {
    let folder = empty_folder(run, &format!("{PREFIX}new-{stage}-"))?;
    // File systems without links lack the mark: there an empty list, left by a kill, is not known as asperity's.
    let _ = os::link(MARK_TEXT, folder.join(MARK));
    let journal = folder.join(JOURNAL);
    fs::write(&journal, format!("{JOURNAL}\n")).map_err(|error| {
        // On a full disk: nobody else has put anything there yet. What cannot be removed is left empty.
        let _ = fs::remove_file(&journal);
        let _ = remove_mark(&folder);
        let _ = fs::remove_dir(&folder);
        ArtifactError::io("write", &journal)(error)
    })?;
    Ok(folder)
}

/// An empty folder, to which a result that is replaced is moved.
pub(super) fn old_folder(run: &Path, stage: &str) -> Result<PathBuf, ArtifactError> {
    empty_folder(run, &format!("{PREFIX}old-{stage}-"))
}

fn empty_folder(run: &Path, prefix: &str) -> Result<PathBuf, ArtifactError> {
    let folder = tempfile::Builder::new()
        .prefix(prefix)
        // The usual permissions less the umask: results are for colleagues too.
        .permissions(os::shared_folder())
        .tempdir_in(run)
        .map_err(ArtifactError::io("create a folder in", run))?;
    Ok(folder.keep())
}

/// Notes that asperity is about to make a file in a folder of [`new_folder`].
pub(super) fn note_in_journal(folder: &Path, file: &str) -> Result<(), ArtifactError> {
    let path = folder.join(JOURNAL);
    fs::File::options()
        .append(true)
        .open(&path)
        .and_then(|mut journal| io::Write::write_all(&mut journal, format!("{file}\n").as_bytes()))
        .map_err(ArtifactError::io("write", &path))
}

/// Removes list and mark, once the manifest says what is in the folder.
pub(super) fn end_journal(folder: &Path) -> Result<(), ArtifactError> {
    let path = folder.join(JOURNAL);
    fs::remove_file(&path).map_err(ArtifactError::io("remove", &path))?;
    remove_mark(folder)
}

/// Removes the mark, if it is there.
fn remove_mark(folder: &Path) -> Result<(), ArtifactError> {
    let path = folder.join(MARK);
    if !is_marked(folder) {
        return Ok(());
    }
    fs::remove_file(&path).map_err(ArtifactError::io("remove", &path))
}

fn is_marked(folder: &Path) -> bool {
    fs::read_link(folder.join(MARK)).is_ok_and(|text| text == Path::new(MARK_TEXT))
}

/// Names in the list of a folder in which something was being written; a kill may have come before its first line.
fn listed_by_journal(folder: &Path) -> BTreeSet<OsString> {
    let path = folder.join(JOURNAL);
    if path.is_symlink() {
        return BTreeSet::new();
    }
    match fs::read_to_string(&path).as_deref() {
        Ok("") if is_marked(folder) => [JOURNAL.into()].into(),
        Ok(text) if text.lines().next() == Some(JOURNAL) => {
            text.lines().map(OsString::from).collect()
        }
        _ => BTreeSet::new(),
    }
}

/// Writes the note of the last run into a run folder, in one step: after a crash the note is the old or the new one.
///
/// # Errors
/// [`ArtifactError::Io`].
pub fn write_note(run: &Path, bytes: &[u8]) -> Result<(), ArtifactError> {
    let folder = new_folder(run, "note")?;
    let begun = folder.join(NOTE_FILE);
    let write = || -> Result<(), ArtifactError> {
        note_in_journal(&folder, NOTE_FILE)?;
        fs::write(&begun, bytes).map_err(ArtifactError::io("write", &begun))?;
        for path in [&begun, &folder] {
            let file = fs::File::open(path).and_then(|file| file.sync_all());
            file.map_err(ArtifactError::io("write", path))?;
        }
        let place = run.join(NOTE_FILE);
        fs::rename(&begun, &place).map_err(ArtifactError::io("rename to", &place))?;
        let synchronised = fs::File::open(run).and_then(|folder| folder.sync_all());
        synchronised.map_err(ArtifactError::io("write", run))
    };
    let written = write();
    let cleared = clear(&folder);
    written.and(cleared)
}

/// Removes what asperity wrote in a temporary folder, and the folder if nothing else is in it.
pub(super) fn clear(folder: &Path) -> Result<(), ArtifactError> {
    let mut own = listed_by_journal(folder);
    own.extend(listed_by_manifest(folder, None).unwrap_or_default());
    let lists = [JOURNAL, Manifest::FILE];
    let (lists, files): (Vec<PathBuf>, Vec<PathBuf>) = entries(folder)?
        .into_iter()
        .filter(|entry| is_listed(entry, &own))
        .partition(|entry| lists.iter().any(|list| entry.ends_with(list)));
    // The lists go last: a kill in between leaves what tells the rest.
    for path in files.iter().chain(&lists) {
        fs::remove_file(path).map_err(ArtifactError::io("remove", path))?;
    }
    remove_mark(folder)?;
    match fs::remove_dir(folder) {
        Err(error) if error.kind() != io::ErrorKind::DirectoryNotEmpty => {
            Err(ArtifactError::io("remove", folder)(error))
        }
        _ => Ok(()),
    }
}

/// Removes what killed runs left in a run folder; a result that was moved aside and not yet replaced is put back.
/// Only with the lock: another process may be writing otherwise.
pub(super) fn clear_leftovers(run: &Path) -> Result<(), ArtifactError> {
    for path in entries(run)? {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let Some(rest) = name.strip_prefix(PREFIX) else { continue };
        let kind =
            fs::symlink_metadata(&path).map_err(ArtifactError::io("read", &path))?.file_type();
        if kind.is_dir() && rest.starts_with("new-") {
            clear(&path)?;
        } else if let Some(stage) = rest.strip_prefix("old-").filter(|_| kind.is_dir()) {
            let stage = stage.rsplit_once('-').map_or(stage, |(stage, _)| stage);
            put_back_or_clear(run, stage, &path)?;
        }
    }
    let solves = run.join(SOLVES_FOLDER);
    // A linked store is that of a sweep, where others write.
    if solves.is_symlink() { Ok(()) } else { clear_solves(&solves) }
}

fn put_back_or_clear(run: &Path, stage: &str, aside: &Path) -> Result<(), ArtifactError> {
    let listed = listed_by_manifest(aside, Some(stage)).unwrap_or_default();
    let whole = !listed.is_empty() && entries(aside)?.iter().all(|entry| is_listed(entry, &listed));
    let place = run.join(stage);
    let free = !place.exists() && !place.is_symlink();
    if whole && free {
        return fs::rename(aside, &place).map_err(ArtifactError::io("rename", aside));
    }
    clear(aside)
}

fn clear_solves(store: &Path) -> Result<(), ArtifactError> {
    if !store.is_dir() {
        return Ok(());
    }
    for folder in entries(store)?.into_iter().filter(|path| path.is_dir() && !path.is_symlink()) {
        for path in entries(&folder)? {
            let plain = fs::symlink_metadata(&path).is_ok_and(|metadata| metadata.is_file());
            if plain && path.file_name().is_some_and(is_temporary_of_solve) {
                fs::remove_file(&path).map_err(ArtifactError::io("remove", &path))?;
            }
        }
    }
    Ok(())
}

/// Whether a name is that of a temporary file of a solve: 64 hexadecimal digits are in it.
fn is_temporary_of_solve(name: &OsStr) -> bool {
    let name = name.to_string_lossy();
    let key = name.strip_prefix(PREFIX).and_then(|rest| rest.split_once('.'));
    key.is_some_and(|(key, _)| key.parse::<super::Digest>().is_ok())
}

/// Creates a temporary file in the folder of `path`, to be renamed to `path`, with the usual permissions.
///
/// # Errors
/// Those of the operating system.
pub fn temporary_beside(path: &Path) -> io::Result<NamedTempFile> {
    let name = path.file_name().unwrap_or_default();
    let mut prefix = OsString::from(PREFIX);
    if name.len() <= LONGEST_NAME {
        prefix.push(name);
        prefix.push("-");
    }
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    tempfile::Builder::new().prefix(&prefix).permissions(os::shared_file()).tempfile_in(folder)
}

/// Entries of a folder, sorted.
fn entries(path: &Path) -> Result<Vec<PathBuf>, ArtifactError> {
    let mut entries: Vec<PathBuf> = fs::read_dir(path)
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
        .map_err(ArtifactError::io("read", path))?;
    entries.sort();
    Ok(entries)
}

/// Entries of the folder of a stage that its manifest does not list; none where there is no manifest.
///
/// # Errors
/// [`ArtifactError::Io`].
pub(super) fn unlisted(folder: &Path) -> Result<Vec<PathBuf>, ArtifactError> {
    let Ok(listed) = listed_by_manifest(folder, None) else { return Ok(Vec::new()) };
    Ok(entries(folder)?.into_iter().filter(|entry| !is_listed(entry, &listed)).collect())
}
