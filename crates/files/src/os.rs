//! What is different on another operating system: all that keeps asperity from Windows. macOS has all of it.
//!
//! | item | what another system needs |
//! |---|---|
//! | [`link`] | links to files and folders, by which cases of a sweep share surfaces and solves |
//! | [`identity`] | what tells a file from another of the same name |
//! | [`kind`] | what an entry is that is neither file nor folder |
//! | [`name_of_bytes`] | file names that are not Unicode |
//! | [`shared_file`], [`shared_folder`] | permissions of new files, less the umask |
//! | [`write_at_start`] | a text that replaces another of its length in one piece |
//! | [`signals_to_end`] | the signals that ask a process to end |
//!
//! Besides, `rename` must replace a file or an empty folder in one step, and a lock must end with its process.

use std::ffi::OsString;
use std::fs::{File, Metadata, Permissions};
use std::io;
use std::os::unix::ffi::OsStringExt;
use std::os::unix::fs::{FileExt, FileTypeExt, MetadataExt, PermissionsExt, symlink};
use std::path::Path;

/// Makes `place` a link to `target`, which need not exist.
///
/// # Errors
/// Those of the operating system; [`io::ErrorKind::AlreadyExists`] if there is something at `place`.
pub fn link(target: impl AsRef<Path>, place: impl AsRef<Path>) -> io::Result<()> {
    symlink(target, place)
}

/// What tells a file, folder or link from another of the same name: device and number.
pub fn identity(metadata: &Metadata) -> (u64, u64) {
    (metadata.dev(), metadata.ino())
}

/// What an entry is that is neither a file nor a folder.
pub fn kind(metadata: &Metadata) -> &'static str {
    let kind = metadata.file_type();
    if kind.is_fifo() {
        "a pipe"
    } else if kind.is_socket() {
        "a socket"
    } else {
        "a device"
    }
}

/// The file name of these bytes.
pub fn name_of_bytes(bytes: Vec<u8>) -> OsString {
    OsString::from_vec(bytes)
}

/// Permissions of a new file that colleagues may read as the umask says; temporary files are private otherwise.
pub fn shared_file() -> Permissions {
    Permissions::from_mode(0o666)
}

/// Permissions of a new folder, likewise.
pub fn shared_folder() -> Permissions {
    Permissions::from_mode(0o777)
}

/// Replaces the beginning of a file in one piece, so that a kill leaves the old text or the new one.
///
/// # Errors
/// Those of the operating system.
pub fn write_at_start(file: &File, text: &[u8]) -> io::Result<()> {
    file.write_all_at(text, 0)
}

/// The signals that ask a process to end: of the keyboard, of a scheduler, of a terminal that closes.
pub fn signals_to_end() -> [i32; 3] {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    [SIGINT, SIGTERM, SIGHUP]
}
