//! What `run` and `status` have in common: the recipe, the scans, the run folder.

use std::path::PathBuf;

use clap::Args;

use super::CliError;
use crate::pipeline::PipelineError;
use crate::recipe::{Recipe, RecipeError};
use crate::stages::StageError;

/// Recipe, scans and run folder.
#[derive(Debug, Args)]
pub(super) struct RecipeOptions {
    /// Recipe, a TOML file.
    recipe: PathBuf,
    /// Scan files or folders in place of those of the recipe; they are read as the recipe's
    /// section [ingest.text] says.
    #[arg(long, value_name = "PATH", num_args = 1..)]
    scans: Vec<PathBuf>,
    /// Run folder for all results; runs/NAME for the recipe NAME.toml if not given.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl RecipeOptions {
    /// The recipe with the scans of the command line.
    ///
    /// # Errors
    /// [`CliError::Input`].
    pub(super) fn recipe(&self) -> Result<Recipe, CliError> {
        let mut recipe = Recipe::read(&self.recipe)?;
        if !self.scans.is_empty() {
            let Some(ingest) = &mut recipe.ingest else {
                return Err(CliError::input(format!(
                    "{} states its waves itself ([[approximate.given]] or [sinusoid]) and reads no \
                     scans: leave --scans out",
                    self.recipe.display()
                )));
            };
            ingest.scans.clone_from(&self.scans);
        }
        Ok(recipe)
    }

    /// The run folder.
    pub(super) fn out(&self) -> PathBuf {
        let stem = || self.recipe.file_stem().unwrap_or("run".as_ref());
        self.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(stem()))
    }
}

impl From<RecipeError> for CliError {
    fn from(error: RecipeError) -> Self {
        Self::input(error)
    }
}

impl From<PipelineError> for CliError {
    fn from(error: PipelineError) -> Self {
        if error.is_interrupt() {
            return Self::Interrupted;
        }
        let is_input = match &error {
            PipelineError::StaleInput { .. }
            | PipelineError::Recipe(_)
            | PipelineError::NoSuchStage { .. } => true,
            PipelineError::Artifact(_) => false,
            PipelineError::Stage { source, .. } => matches!(
                **source,
                StageError::Scan(_)
                    | StageError::Conditioning(_)
                    | StageError::NoScans { .. }
                    | StageError::ScanIo { .. }
                    | StageError::ReservedName { .. }
                    | StageError::SameName { .. }
                    | StageError::UnequalScans { .. }
                    | StageError::Parameter(_)
                    | StageError::Ladder(_)
                    | StageError::NoWaves { .. }
                    | StageError::Rubber(_)
                    | StageError::NoRelaxation { .. }
            ),
        };
        if is_input { Self::input(error) } else { Self::failure(error) }
    }
}
