//! `asperity status`: which results are up to date.

use clap::Args;

use super::CliError;
use super::output::{json, print};
use super::recipe_options::RecipeOptions;
use asperity::pipeline::{self, State};

const EXAMPLES: &str = "\
Examples:
  What a run would compute, and why:
    asperity status pipelines/asphalt.toml";

/// Show which stages are up to date, and why the others are not.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Status {
    #[command(flatten)]
    recipe: RecipeOptions,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Status {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CliError`].
    pub(super) fn run(self) -> Result<(), CliError> {
        let states = pipeline::status(&self.recipe.recipe()?, &self.recipe.out())?;
        if self.json {
            let stages: Vec<_> = states
                .iter()
                .map(|(stage, state)| match state {
                    State::Fresh => serde_json::json!({ "stage": stage, "fresh": true }),
                    State::Stale(reasons) => {
                        serde_json::json!({ "stage": stage, "fresh": false, "reasons": reasons })
                    }
                })
                .collect();
            return print(&json(&stages)?);
        }
        let line = |(stage, state): &(asperity::stages::Stage, State)| match state {
            State::Fresh => format!("{:<13} fresh\n", stage.name()),
            State::Stale(reasons) => {
                format!("{:<13} stale: {}\n", stage.name(), reasons.join("; "))
            }
        };
        print(&states.iter().map(line).collect::<String>())
    }
}
