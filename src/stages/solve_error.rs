//! Why a single solve has no result.

use super::StageError;
use crate::artifact::ArtifactError;
use crate::contact::ContactError;
use crate::contact::effective::EffectiveError;
use crate::error_kind::{ErrorKind, HasKind};

/// Why a single solve has no result.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// The contact.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// A contact with its own heat or strain.
    #[error(transparent)]
    Effective(#[from] EffectiveError),
    /// The finite-deformation contact.
    #[error(transparent)]
    FiniteDeformation(#[from] crate::fem::error::FemError),
    /// The macro surface under a local law.
    #[error(transparent)]
    SoftContact(#[from] crate::multiscale::SoftContactError),
    /// Friction scale by scale.
    #[error(transparent)]
    Homogenisation(#[from] crate::homogenisation::HomogenisationError),
    /// A local law.
    #[error(transparent)]
    Law(#[from] crate::multiscale::LawError),
    /// No grid gives the wanted accuracy.
    #[error("p = {pressure:e} Pa: {reason} (tolerance, bem.grid_tolerance, bem.area_fractions)")]
    Accuracy {
        /// Mean pressure in Pa.
        pressure: f64,
        /// What was reached.
        reason: String,
    },
    /// A contact so small that its friction is the slope of the profile at one point.
    #[error(
        "a contact area fraction of {area:e} is less than two of {points} grid points: leave it out of \
         bem.area_fractions, or raise bem.points_per_shortest_wavelength (of areal surfaces \
         areal.points_per_shortest_wavelength)"
    )]
    Unresolved {
        /// The contact area fraction.
        area: f64,
        /// Points of the finest grid.
        points: usize,
    },
    /// The store of solves.
    #[error(transparent)]
    Artifact(#[from] ArtifactError),
    /// The user's interrupt.
    #[error("interrupted")]
    Interrupted,
}

impl HasKind for SolveError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Contact(source) => source.kind(),
            Self::Effective(source) => source.kind(),
            Self::FiniteDeformation(source) => source.kind(),
            Self::SoftContact(source) => source.kind(),
            Self::Homogenisation(source) => source.kind(),
            Self::Law(source) => source.kind(),
            Self::Accuracy { .. } | Self::Unresolved { .. } => ErrorKind::Failure,
            Self::Artifact(source) => source.kind(),
            Self::Interrupted => ErrorKind::Interrupted,
        }
    }
}

impl SolveError {
    /// Whether there is no solution to be found, as opposed to a solve that was interrupted, asked for
    /// the impossible, or could not be read or kept.
    pub fn is_no_solution(&self) -> bool {
        match self {
            Self::Contact(error) => error.is_no_solution(),
            Self::Effective(error) => error.is_no_solution(),
            Self::FiniteDeformation(error) => error.is_no_solution(),
            Self::Homogenisation(error) => error.is_no_solution(),
            Self::SoftContact(error) => {
                matches!(error, crate::multiscale::SoftContactError::NotConverged { .. })
            }
            Self::Accuracy { .. } | Self::Unresolved { .. } => true,
            Self::Law(_) | Self::Artifact(_) | Self::Interrupted => false,
        }
    }

    /// Whether the user interrupted.
    pub fn is_interrupt(&self) -> bool {
        self.kind() == ErrorKind::Interrupted
    }

    /// The error of the stage: an interrupt and a failed store are that in every stage, for the rest
    /// `contact` says whose contact it is.
    pub fn in_stage(self, contact: impl FnOnce(Box<Self>) -> StageError) -> StageError {
        match self {
            Self::Artifact(error) => error.into(),
            error if error.is_interrupt() => StageError::Interrupted,
            error => contact(Box::new(error)),
        }
    }
}
