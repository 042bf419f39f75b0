//! Figures as files: SVG or PNG, by the ending of the name.

use super::CliError;
use super::output::write_file;
use asperity::plot::{Figure, png};
use std::path::Path;

/// Whether a file is a PNG.
///
/// # Errors
/// [`CliError::Input`] if it is neither PNG nor SVG.
pub(super) fn is_png(path: &Path) -> Result<bool, CliError> {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => Ok(false),
        Some("png") => Ok(true),
        _ => Err(CliError::input(format!("{}: figures are .svg or .png files", path.display()))),
    }
}

/// Writes a figure.
///
/// # Errors
/// [`CliError`]: another ending, a file that is there already without `force`, a full disk.
pub(super) fn write(path: &Path, force: bool, figure: &Figure) -> Result<(), CliError> {
    let as_png = is_png(path)?;
    let svg = figure.svg()?;
    let bytes = if as_png { png(&svg).map_err(CliError::failure)? } else { svg.into_bytes() };
    write_file(path, force, |out| out.write_all(&bytes))
}
