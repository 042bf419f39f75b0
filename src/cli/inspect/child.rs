//! Files of arrays are read in a process of their own, since the HDF5 library may crash on a damaged file.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::cli::CliError;

/// Option of the command in that process.
pub(super) const OPTION: &str = "--in-this-process";

/// What `asperity inspect` prints of the file, from a process of its own.
///
/// # Errors
/// Those of that process; [`CliError::Input`] if the library crashes on the file, [`CliError::Failure`] if the
/// process cannot be started.
pub(super) fn inspect(path: &Path, json: bool) -> Result<String, CliError> {
    let failed = |why: String| {
        CliError::failure(format!("cannot read {} in a process of its own: {why}", path.display()))
    };
    let executable = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
    let mut command = Command::new(executable);
    command.args(["inspect", OPTION]).args(json.then_some("--json")).arg("--").arg(path);
    let output =
        command.stdin(Stdio::null()).output().map_err(|error| failed(error.to_string()))?;
    match output.status.code() {
        // The library does not check the texts of the file.
        Some(0) => String::from_utf8(output.stdout).map_err(|_| {
            let path = path.display();
            CliError::input(format!("{path}: a text in it is not UTF-8, so the file is damaged"))
        }),
        Some(1) => Err(CliError::failure(told(&output))),
        Some(2) => Err(CliError::input(told(&output))),
        _ => Err(CliError::input(format!(
            "{}: cannot be read as an HDF5 file of arrays: the HDF5 library crashed on it ({}), so the file is \
             damaged; copy it again, or compute it anew",
            path.display(),
            output.status
        ))),
    }
}

/// The message of the other process, without the prefix of every message.
fn told(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr);
    let text = text.trim_end();
    text.strip_prefix("error: ").unwrap_or(text).to_owned()
}
