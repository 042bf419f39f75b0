//! What can be wrong with a recipe.

use crate::error_kind::{ErrorKind, HasKind};
use crate::files::{self, TomlError};
use crate::requirement::InvalidRecipe;
use std::path::PathBuf;

/// Why a recipe cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RecipeError {
    /// The file cannot be read.
    #[error("recipe {}: cannot be read: {source}{}", path.display(), files::advice(source))]
    Read {
        /// The recipe.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The text is no recipe.
    #[error(
        "recipe {}{problem}{}",
        path.display(),
        if *is_rubber { "\n  this is the file of a rubber: give the recipe" } else { "" }
    )]
    Parse {
        /// The recipe.
        path: PathBuf,
        /// Line, key and what to write.
        problem: TomlError,
        /// Whether it is the file of a rubber.
        is_rubber: bool,
    },
    /// A value out of its range, or two that contradict each other.
    #[error(
        "recipe {}{}: {}",
        path.display(),
        line.map_or_else(String::new, |line| format!(", line {line}")),
        violation.in_words(typed.as_deref())
    )]
    Value {
        /// The recipe.
        path: PathBuf,
        /// Line of the key, from 1, if the recipe has it.
        line: Option<usize>,
        /// The value as the recipe has it.
        typed: Option<String>,
        /// The key, its value and what it must be.
        violation: Box<InvalidRecipe>,
    },
}

impl HasKind for RecipeError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Read { .. } | Self::Parse { .. } | Self::Value { .. } => ErrorKind::Input,
        }
    }
}
