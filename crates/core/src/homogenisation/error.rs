//! What can go wrong between scales.

use crate::contact::ContactError;
use crate::error_kind::{ErrorKind, HasKind};
use crate::fem::error::FemError;
use crate::interface::ShearError;
use crate::multiscale::{LawError, SoftContactError};

/// Errors of friction scale by scale.
#[derive(Debug, thiserror::Error)]
pub enum HomogenisationError {
    /// Of the half-space.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// Of the half-space on a layer of short waves.
    #[error(transparent)]
    Soft(#[from] SoftContactError),
    /// Of finite deformation.
    #[error(transparent)]
    FiniteDeformation(#[from] FemError),
    /// Of the law of friction.
    #[error(transparent)]
    Friction(#[from] ShearError),
    /// Of the law of separation.
    #[error(transparent)]
    Separation(#[from] LawError),
    /// No group of waves.
    #[error("there is no group of waves to be solved")]
    NoGroups,
    /// A group without contacts that could become a law.
    #[error(
        "group {group} of the waves, counted from the shortest, has {solved} contact(s) between {:.4} and {:.4} MPa, too few for a \
         law{}", .range[0] / 1e6, .range[1] / 1e6, .reason.as_ref().map_or(String::new(), |reason| format!(": {reason}"))
    )]
    TooFewContacts {
        /// Number of the group from 1, the shortest waves.
        group: usize,
        /// Pressures with a solution.
        solved: usize,
        /// Lowest and highest pressure in Pa that were tried.
        range: [f64; 2],
        /// Why the last one that failed did.
        reason: Option<String>,
    },
}

impl HasKind for HomogenisationError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Contact(error) => error.kind(),
            Self::Soft(error) => error.kind(),
            Self::FiniteDeformation(error) => error.kind(),
            Self::Friction(error) => error.kind(),
            Self::Separation(_) | Self::TooFewContacts { .. } => ErrorKind::Failure,
            Self::NoGroups => ErrorKind::Input,
        }
    }
}

impl HomogenisationError {
    /// Whether a contact has no solution, while others of the same group may have one.
    pub fn is_no_solution(&self) -> bool {
        match self {
            Self::Contact(error) => error.is_no_solution(),
            Self::FiniteDeformation(error) => error.is_no_solution(),
            Self::Soft(error) => error.kind() == ErrorKind::Failure,
            Self::Separation(_) | Self::TooFewContacts { .. } => true,
            Self::Friction(_) | Self::NoGroups => false,
        }
    }
}
