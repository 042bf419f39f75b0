//! The run folder that a command reads.

use super::CliError;
use crate::artifact::RunView;
use std::path::Path;

/// View of a run folder.
///
/// # Errors
/// [`CliError::Input`] if there is no such folder.
pub(super) fn view(folder: &Path) -> Result<RunView, CliError> {
    if !folder.is_dir() {
        let what = if folder.exists() { "is a file" } else { "does not exist" };
        return Err(CliError::input(format!(
            "{} {what}: give the folder of a run, such as runs/asphalt",
            folder.display()
        )));
    }
    Ok(RunView::of(folder))
}
