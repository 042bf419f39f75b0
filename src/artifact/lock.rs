//! The lock of a run folder: a file `.lock` that says which process has it.

use std::fs::{self, File, TryLockError};
use std::io::{self, Read};
use std::path::Path;
use std::time::Duration;

use super::ArtifactError;
use crate::files::os;

const FILE: &str = ".lock";
const HEAD: &str = "locked by asperity, process ";
/// Beginning of the lock of earlier versions, which is shorter than the text that replaces it.
const OLD_HEAD: &str = "process ";

/// A program that another thread is just starting holds a copy of every open file until it runs,
/// also of the lock of a folder that was closed meanwhile: a lock counts from this many tries on.
const TRIES: u32 = 50;
const BETWEEN_TRIES: Duration = Duration::from_millis(20);

/// Locks a folder for as long as the file is open, and says in it who has it.
///
/// # Errors
/// [`ArtifactError::Locked`] if another process has it, [`ArtifactError::Foreign`] for a file of that name that
/// asperity did not write, [`ArtifactError::Io`].
pub(super) fn take(folder: &Path) -> Result<File, ArtifactError> {
    let path = folder.join(FILE);
    let (lock, new) = open(&path)?;
    match patiently(&lock) {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            let holder = holder(&path).unwrap_or_default();
            return Err(ArtifactError::Locked { path: folder.to_owned(), holder });
        }
        Err(TryLockError::Error(error)) => return Err(ArtifactError::io("lock", &path)(error)),
    }
    // An empty one that was there may be another's: it serves without a name in it.
    let empty = lock.metadata().map_err(ArtifactError::io("read", &path))?.len() == 0;
    if new || !empty {
        // Of one length and in one piece, so that a kill leaves a text that is known again.
        let text = format!("{HEAD}{:>10}\n", std::process::id());
        os::write_at_start(&lock, text.as_bytes()).map_err(ArtifactError::io("write", &path))?;
    }
    Ok(lock)
}

/// Opens the lock of asperity, or makes one; says whether it was made.
fn open(path: &Path) -> Result<(File, bool), ArtifactError> {
    let mut options = File::options();
    options.read(true).write(true);
    match options.clone().create_new(true).open(path) {
        Ok(file) => return Ok((file, true)),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
        Err(error) => return Err(ArtifactError::io("create", path)(error)),
    }
    let plain = fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_file());
    if !plain || holder(path).is_none() {
        return Err(ArtifactError::Foreign {
            path: path.to_owned(),
            what: "is the name of asperity's lock, and asperity did not write it".into(),
            remedy: "move it away, or choose another --out".into(),
        });
    }
    let file = options.open(path).map_err(ArtifactError::io("open", path))?;
    Ok((file, false))
}

/// The process that a lock names; empty if it names none yet, none if it is not asperity's.
fn holder(path: &Path) -> Option<String> {
    let mut text = Vec::new();
    File::open(path).ok()?.take(100).read_to_end(&mut text).ok()?;
    let text = String::from_utf8(text).ok()?;
    if text.is_empty() {
        return Some(text);
    }
    let process = text.strip_prefix(HEAD).or(text.strip_prefix(OLD_HEAD))?.strip_suffix('\n')?;
    let digits = process.trim_start();
    let number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    number.then(|| format!("process {digits}"))
}

fn patiently(lock: &File) -> Result<(), TryLockError> {
    for _ in 1..TRIES {
        match lock.try_lock() {
            Err(TryLockError::WouldBlock) => std::thread::sleep(BETWEEN_TRIES),
            other => return other,
        }
    }
    lock.try_lock()
}
