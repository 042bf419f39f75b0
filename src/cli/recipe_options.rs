//! What `run` and `status` have in common: the recipe, the scans, the run folder.

use std::path::{Path, PathBuf};

use clap::Args;

use super::last_run::LastRun;
use super::{CliError, values};
use asperity::files;
use asperity::recipe::{Recipe, RecipeError};

/// Recipe, scans and run folder.
#[derive(Debug, Args)]
pub(super) struct RecipeOptions {
    /// Recipe, a TOML file.
    recipe: PathBuf,
    /// Scan files or folders to use instead of those of the recipe; texts are read as its section
    /// [ingest.text] says.
    #[arg(long, value_name = "PATH", num_args = 1..)]
    scans: Vec<PathBuf>,
    /// Relative accuracy of the averaged friction, instead of that of the recipe.
    #[arg(long, value_name = "RELATIVE", value_parser = values::tolerance, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Run folder for all results. If not given, runs/NAME beside the recipe NAME.toml; for recipes in a folder
    /// `pipelines`, runs/NAME beside that folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Name of a folder that holds recipes alone: their runs are put beside it.
const RECIPE_FOLDER: &str = "pipelines";

/// A further option of the commands that write into a run folder.
#[derive(Debug, Args)]
pub(super) struct TakeOver {
    /// Use the run folder although its last run was of another recipe file.
    #[arg(long)]
    pub(super) take_over: bool,
}

impl RecipeOptions {
    /// The recipe with the scans of the command line.
    ///
    /// # Errors
    /// [`CliError::Input`].
    pub(super) fn recipe(&self) -> Result<Recipe, CliError> {
        Ok(self.recipe_and_origin()?.0)
    }

    /// The recipe, and the note of what was given that is kept with the results. The file is read once,
    /// since it may be edited during the run.
    ///
    /// # Errors
    /// [`CliError::Input`]; [`CliError::Failure`] if the working folder is not known.
    pub(super) fn recipe_and_origin(&self) -> Result<(Recipe, LastRun), CliError> {
        recipe_and_origin(&self.recipe, &self.scans, self.tolerance)
    }

    /// The run folder.
    pub(super) fn out(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| default_out(&self.recipe))
    }
}

/// The recipe of a file with other scans and another accuracy, if they are given, and the note of what was given.
///
/// # Errors
/// As [`RecipeOptions::recipe_and_origin`].
pub(super) fn recipe_and_origin(
    path: &Path,
    scans: &[PathBuf],
    tolerance: Option<f64>,
) -> Result<(Recipe, LastRun), CliError> {
    let text = files::read_settings(path)
        .map_err(|source| RecipeError::Read { path: path.to_owned(), source })?;
    let recipe = with_scans(Recipe::parse(&text, path)?, path, scans)?;
    let recipe = with_tolerance(recipe, tolerance)?;
    Ok((recipe, LastRun::new(path, text, scans, tolerance)?))
}

/// The run folder of a recipe: it follows from where the recipe is, not from where the command is given.
pub(super) fn default_out(recipe: &Path) -> PathBuf {
    let folder = recipe.parent().unwrap_or(Path::new(""));
    let name = |folder: &Path| folder.file_name() == Some(RECIPE_FOLDER.as_ref());
    let beside = if name(folder) {
        folder.parent().unwrap_or(Path::new("")).to_owned()
    } else if std::path::absolute(folder.join(".")).is_ok_and(|folder| name(&folder)) {
        folder.join("..")
    } else {
        folder.to_owned()
    };
    beside.join("runs").join(recipe.file_stem().unwrap_or("run".as_ref()))
}

/// The recipe at `path` with other scans, if there are some.
///
/// # Errors
/// [`CliError::Input`] if it reads none.
pub(super) fn with_scans(
    mut recipe: Recipe,
    path: &Path,
    scans: &[PathBuf],
) -> Result<Recipe, CliError> {
    if !scans.is_empty() {
        let Some(ingest) = &mut recipe.ingest else {
            return Err(CliError::input(format!(
                "{} states its waves itself ([[approximate.given]] or [sinusoid]) and reads no \
                 scans: leave --scans out",
                path.display()
            )));
        };
        if recipe.sweep.as_ref().is_some_and(|sweep| !sweep.specimens.is_empty()) {
            return Err(CliError::input(format!(
                "{} lists the scans of its specimens in [sweep]: leave --scans out",
                path.display()
            )));
        }
        ingest.scans = scans.to_vec();
    }
    Ok(recipe)
}

/// The recipe with another accuracy, if one is given.
///
/// # Errors
/// [`CliError::Input`] if the recipe cannot have it.
pub(super) fn with_tolerance(
    mut recipe: Recipe,
    tolerance: Option<f64>,
) -> Result<Recipe, CliError> {
    if let Some(tolerance) = tolerance {
        recipe
            .set_tolerance(tolerance)
            .map_err(|violation| CliError::input(format!("--{violation}")))?;
    }
    Ok(recipe)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_run_folder_follows_the_recipe() {
        let cases = [
            ("recipe.toml", "runs/recipe"),
            ("a/recipe.toml", "a/runs/recipe"),
            ("b/recipe.toml", "b/runs/recipe"),
            ("/data/a/recipe.toml", "/data/a/runs/recipe"),
            ("pipelines/asphalt.toml", "runs/asphalt"),
            ("road/pipelines/asphalt.toml", "road/runs/asphalt"),
        ];
        for (recipe, out) in cases {
            assert_eq!(default_out(Path::new(recipe)), Path::new(out), "{recipe}");
        }
    }
}
