//! What can go wrong in the transient contact.

use super::solution::Sample;
use crate::error_kind::{ErrorKind, HasKind};
use crate::fem::error::BeyondLaw;

/// Why a time step has no solution.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StepFailure {
    /// An element is inverted, or an internal tensor is not positive.
    #[error("an element is inverted")]
    Inverted,
    /// The tangent is singular.
    #[error("the tangent is singular")]
    Singular,
    /// Newton did not converge.
    #[error("the equilibrium did not converge (residual {residual:.1e} of the load)")]
    EquilibriumNotConverged {
        /// Residual over the load.
        residual: f64,
    },
    /// Uzawa did not converge.
    #[error("the contact pressures did not converge")]
    ContactNotConverged,
    /// The law of the rubber does not hold in the solution.
    #[error("{0}")]
    BeyondLaw(BeyondLaw),
}

/// Why there is no transient solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TransientError {
    /// The numbers of the rubber are out of range for large strains.
    #[error(transparent)]
    Rubber(#[from] crate::rubber::RubberError),
    /// A number outside its range.
    #[error("{quantity} is {value}, it must be {range}")]
    OutOfRange {
        /// Which number, with its unit.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// The range it must lie in.
        range: &'static str,
    },
    /// Block and profile do not repeat together.
    #[error(
        "the block's period is {:.5e} mm, the profile's {:.5e} mm: they must be the same length",
        .mesh * 1e3, .profile * 1e3
    )]
    PeriodMismatch {
        /// Period of the mesh in m.
        mesh: f64,
        /// Period of the profile in m.
        profile: f64,
    },
    /// The matrix of the mesh does not fit into memory or its indices.
    #[error("no memory for a matrix of {unknowns} unknowns: use fewer columns")]
    TooLarge {
        /// Number of unknowns.
        unknowns: usize,
    },
    /// Even the smallest time step found no solution.
    #[error(
        "no step from t = {time:.5e} s (pressure {:.6} MPa, {:.6} mm dragged) even with \
         {time_step:.5e} s: {failure}; use more columns or a smaller pressure",
        .pressure / 1e6, .displacement * 1e3
    )]
    Stopped {
        /// Time of the last solution in s.
        time: f64,
        /// Pressure at that time in Pa.
        pressure: f64,
        /// Distance dragged by then in m.
        displacement: f64,
        /// The smallest step tried, in s.
        time_step: f64,
        /// What happened in it.
        failure: StepFailure,
        /// The solution up to that time.
        samples: Vec<Sample>,
    },
}

impl HasKind for TransientError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Rubber(_) | Self::OutOfRange { .. } | Self::PeriodMismatch { .. } => {
                ErrorKind::Input
            }
            Self::TooLarge { .. } | Self::Stopped { .. } => ErrorKind::Failure,
        }
    }
}
