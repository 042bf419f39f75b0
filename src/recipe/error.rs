//! What can be wrong with a recipe.

use crate::error_kind::{ErrorKind, HasKind};
use crate::files::{self, TomlError};
use crate::scans::ScanProblem;
use crate::surface::ConditioningError;
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
        violation: Box<Violation>,
    },
}

impl HasKind for RecipeError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Read { .. } | Self::Parse { .. } | Self::Value { .. } => ErrorKind::Input,
        }
    }
}

/// A value of a recipe that does not hold.
#[derive(Debug, thiserror::Error)]
pub enum Violation {
    /// In any other section than `[ingest]`.
    #[error("{key} = {value}: must be {demand}")]
    Demand {
        /// The key with its section, such as `bem.speeds_mm_s`.
        key: &'static str,
        /// The value as text.
        value: String,
        /// What it must be.
        demand: &'static str,
    },
    /// A key that the recipe needs.
    #[error("{key} is missing: {advice}")]
    Missing {
        /// The key with its section.
        key: &'static str,
        /// What to give.
        advice: &'static str,
    },
    /// A section that the recipe needs.
    #[error(
        "missing section [{section}]: a recipe has [approximate], [realise] and [bem], or [sinusoid] alone"
    )]
    MissingSection {
        /// Its name.
        section: &'static str,
    },
    /// A section beside one that stands alone.
    #[error("section [{section}] beside [sinusoid], which stands alone: make two recipes of it")]
    SectionBesideSinusoid {
        /// Its name.
        section: &'static str,
    },
    /// A correction without the microscale that it is made of.
    #[error(
        "section [hybrid] without [micro]: the correction is made of the microscale; add [micro]"
    )]
    HybridWithoutMicro,
    /// A recipe of several cases where one is wanted.
    #[error(
        "the recipe has a section [sweep] of {cases} cases: `asperity run` runs them all, `asperity \
         sweep` spreads them over machines; a finished case CASE has a recipe of its own: \
         CASE/recipe.toml with --out CASE"
    )]
    SeveralCases {
        /// Their number.
        cases: usize,
    },
    /// Cases of the study of one sine.
    #[error("[sinusoid] lists what it solves: there is nothing to sweep")]
    SweepOfSinusoid,
    /// The description of the scan files.
    #[error("[ingest.text]: {0}")]
    Text(#[from] ScanProblem),
    /// The conditioning of the scans.
    #[error("[ingest.conditioning]: {0}")]
    Conditioning(#[from] ConditioningError),
}

impl HasKind for Violation {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Demand { .. }
            | Self::Missing { .. }
            | Self::MissingSection { .. }
            | Self::SectionBesideSinusoid { .. }
            | Self::HybridWithoutMicro
            | Self::SeveralCases { .. }
            | Self::SweepOfSinusoid => ErrorKind::Input,
            Self::Text(_) => ErrorKind::Input,
            Self::Conditioning(source) => source.kind(),
        }
    }
}

impl Violation {
    /// The message, with the value as it was typed if that is known.
    fn in_words(&self, typed: Option<&str>) -> String {
        match (self, typed) {
            (Self::Demand { key, demand, .. }, Some(typed)) => {
                format!("{key} = {typed}: must be {demand}")
            }
            (Self::Conditioning(ConditioningError::Parameter { key, demand, .. }), Some(typed)) => {
                format!("ingest.conditioning.{key} = {typed}: {demand}")
            }
            _ => self.to_string(),
        }
    }
}

/// `Ok` where the demand holds, else the violation.
pub(crate) fn demand(
    holds: bool,
    key: &'static str,
    value: impl std::fmt::Debug,
    demand: &'static str,
) -> Result<(), Violation> {
    if holds { Ok(()) } else { Err(Violation::Demand { key, value: format!("{value:?}"), demand }) }
}
