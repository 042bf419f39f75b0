//! What can go wrong in a contact problem.

use crate::error_kind::{ErrorKind, HasKind};

/// Why there is no solution to report.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContactError {
    /// The numbers of the rubber are out of range, or it was not measured at a frequency that is needed.
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
    /// A height that is not a number.
    #[error("height {index} of the profile is {value}: fill or cut missing points first")]
    BadHeight {
        /// Zero-based index of the first bad height.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A height of an areal surface that is not a number.
    #[error(
        "the height in column {column} of row {row} of the surface is {value} (both count from zero): fill or cut missing \
         points first"
    )]
    BadHeightOfSurface {
        /// Zero-based index along `x`.
        column: usize,
        /// Zero-based index along `y`.
        row: usize,
        /// Its value.
        value: f64,
    },
    /// An areal contact would need more memory than the caller allows.
    #[error(
        "the contact needs about {needed} bytes of memory, the limit is {limit}: use fewer grid points or a higher limit"
    )]
    TooMuchMemory {
        /// Estimated most memory in bytes.
        needed: u64,
        /// The limit in bytes.
        limit: u64,
    },
    /// The iteration ended before the residual was small enough.
    #[error(
        "the contact did not converge: p = {pressure:e} Pa, v = {speed:e} m/s, {points} points: \
         residual {residual:.1e} after {iterations} iterations with {changes} points still \
         changing sides; try another number of points, or a lower pressure"
    )]
    NotConverged {
        /// Mean pressure in Pa.
        pressure: f64,
        /// Sliding speed in m/s.
        speed: f64,
        /// Grid points.
        points: usize,
        /// Residual as in [`crate::contact::ContactSolution::residual`].
        residual: f64,
        /// Active-set iterations on the finest grid.
        iterations: usize,
        /// Points that changed between contact and gap in the last iteration.
        changes: usize,
    },
    /// The user's interrupt.
    #[error("interrupted")]
    Interrupted,
    /// No pressure was found that gives the contact area.
    #[error(
        "no pressure gives the contact area fraction {wanted} on {points} points: the nearest \
         found is {found} at {pressure:e} Pa; use more points for a smaller area"
    )]
    AreaNotReached {
        /// The contact area fraction asked for.
        wanted: f64,
        /// The nearest one found.
        found: f64,
        /// Its mean pressure in Pa.
        pressure: f64,
        /// Grid points.
        points: usize,
    },
}

impl HasKind for ContactError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Rubber(_)
            | Self::OutOfRange { .. }
            | Self::BadHeight { .. }
            | Self::BadHeightOfSurface { .. }
            | Self::TooMuchMemory { .. } => ErrorKind::Input,
            Self::NotConverged { .. } | Self::AreaNotReached { .. } => ErrorKind::Failure,
            Self::Interrupted => ErrorKind::Interrupted,
        }
    }
}

impl ContactError {
    /// Whether the solver ran and found no solution; other errors are wrong input or an interrupt.
    pub fn is_no_solution(&self) -> bool {
        matches!(self, Self::NotConverged { .. } | Self::AreaNotReached { .. })
    }
}
