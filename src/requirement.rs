//! What the keys of a recipe must hold: below the stages, which check their own sections, and below the recipe, which
//! says where in the file the key is.

use crate::error_kind::{ErrorKind, HasKind};
use crate::scans::ScanProblem;
use crate::surface::ConditioningError;
use crate::surface::map::condition::MapConditioningError;

/// A key or section of a recipe that cannot be used as it is.
#[derive(Debug, thiserror::Error)]
pub enum InvalidRecipe {
    /// In any other section than `[ingest]`.
    #[error("{key} = {value}: must be {required}")]
    Value {
        /// The key with its section, such as `bem.speeds_mm_s`.
        key: &'static str,
        /// The value as text.
        value: String,
        /// What it must be.
        required: &'static str,
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
    /// A recipe of several cases, given to a command that takes one.
    #[error(
        "the recipe has a section [sweep] of {cases} cases: `asperity run` runs them all, `asperity \
         sweep` spreads them over machines; a finished case CASE has a recipe of its own: \
         CASE/recipe.toml with --out CASE"
    )]
    SeveralCases {
        /// Their number.
        cases: usize,
    },
    /// A spectrum in place of surfaces, given to a command that runs stages.
    #[error(
        "the recipe has the spectrum of [validation] and neither scans nor waves, so there is nothing to run: `asperity \
         validate` puts Persson's theory beside its measurement"
    )]
    SpectrumAlone,
    /// Cases of the study of one sine.
    #[error("[sinusoid] lists what it solves: there is nothing to sweep")]
    SweepOfSinusoid,
    /// The description of the scan files.
    #[error("[ingest.text]: {0}")]
    Text(#[from] ScanProblem),
    /// The conditioning of the scans.
    #[error("[ingest.conditioning]: {0}")]
    Conditioning(#[from] ConditioningError),
    /// The conditioning of maps.
    #[error("[ingest.maps]: {0}")]
    MapConditioning(#[from] MapConditioningError),
}

impl HasKind for InvalidRecipe {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Value { .. }
            | Self::Missing { .. }
            | Self::MissingSection { .. }
            | Self::SectionBesideSinusoid { .. }
            | Self::HybridWithoutMicro
            | Self::SeveralCases { .. }
            | Self::SpectrumAlone
            | Self::SweepOfSinusoid => ErrorKind::Input,
            Self::Text(_) => ErrorKind::Input,
            Self::Conditioning(source) => source.kind(),
            Self::MapConditioning(source) => source.kind(),
        }
    }
}

impl InvalidRecipe {
    /// The message, with the value as it was typed if that is known.
    pub(crate) fn in_words(&self, typed: Option<&str>) -> String {
        match (self, typed) {
            (Self::Value { key, required, .. }, Some(typed)) => {
                format!("{key} = {typed}: must be {required}")
            }
            (Self::Conditioning(ConditioningError::Parameter { key, demand, .. }), Some(typed)) => {
                format!("ingest.conditioning.{key} = {typed}: {demand}")
            }
            (
                Self::MapConditioning(MapConditioningError::Parameter { key, require, .. }),
                Some(typed),
            ) => format!("ingest.maps.{key} = {typed}: {require}"),
            _ => self.to_string(),
        }
    }
}

/// `Ok` if `holds`, else that `key`, which is `value`, must be `required`.
pub(crate) fn require(
    holds: bool,
    key: &'static str,
    value: impl std::fmt::Debug,
    required: &'static str,
) -> Result<(), InvalidRecipe> {
    if holds {
        Ok(())
    } else {
        Err(InvalidRecipe::Value { key, value: format!("{value:?}"), required })
    }
}
