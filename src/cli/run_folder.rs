//! The run folder that a command reads.

use super::CliError;
use asperity::artifact::RunView;
use asperity::sweep::CASES_FOLDER;
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

/// View of the run folder of one case.
///
/// # Errors
/// [`CliError::Input`] if there is no such folder, or if it is that of a sweep.
pub(super) fn view_of_case(folder: &Path) -> Result<RunView, CliError> {
    let view = view(folder)?;
    let cases = folder.join(CASES_FOLDER);
    if cases.is_dir() {
        return Err(CliError::input(format!(
            "{} is the folder of a sweep: give that of one of its cases, in {}",
            folder.display(),
            cases.display()
        )));
    }
    Ok(view)
}
