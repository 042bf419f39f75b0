//! What can go wrong between the scales.

use crate::contact::ContactError;
use crate::error_kind::{ErrorKind, HasKind};

/// Errors of samples that make no local law, and of a law outside its samples.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LawError {
    /// Different numbers of pressures and separations, or none at all.
    #[error(
        "the local law has {pressures} pressures and {separations} separations: it takes equally \
         many, at least one"
    )]
    Length {
        /// Number of pressures.
        pressures: usize,
        /// Number of separations.
        separations: usize,
    },
    /// The separation at first touch is not a number.
    #[error("the separation at first touch is {value} m, it must be finite")]
    Touch {
        /// Its value in m.
        value: f64,
    },
    /// Pressures that do not ascend from above zero.
    #[error(
        "pressure {index} of the local law is {value:e} Pa after {before:e} Pa: pressures must be \
         positive, finite and ascend"
    )]
    Pressure {
        /// Zero-based index of the sample.
        index: usize,
        /// Its pressure in Pa.
        value: f64,
        /// The pressure before it, zero for the first.
        before: f64,
    },
    /// Separations that do not descend from that at first touch.
    #[error(
        "separation {index} of the local law is {value:e} m after {before:e} m: separations must \
         be finite and descend from that at first touch; solve the microscale more accurately or \
         take pressures further apart"
    )]
    Separation {
        /// Zero-based index of the sample.
        index: usize,
        /// Its separation in m.
        value: f64,
        /// The separation before it, that at first touch for the first.
        before: f64,
    },
    /// A pressure at which the microscale was not sampled.
    #[error(
        "the local law was asked for {pressure:e} Pa, its samples end at {largest:e} Pa: sample \
         the microscale up to higher pressures"
    )]
    BeyondSamples {
        /// The pressure asked for in Pa.
        pressure: f64,
        /// The largest sampled pressure in Pa.
        largest: f64,
    },
    /// A pressure below zero, or not a number.
    #[error("the local law was asked for {pressure} Pa, pressures are not negative")]
    NotAPressure {
        /// The pressure asked for in Pa.
        pressure: f64,
    },
}

impl HasKind for LawError {
    fn kind(&self) -> ErrorKind {
        match self {
            // Laws are made of computed samples: nothing in them was typed.
            Self::Length { .. }
            | Self::Touch { .. }
            | Self::Pressure { .. }
            | Self::Separation { .. }
            | Self::BeyondSamples { .. }
            | Self::NotAPressure { .. } => ErrorKind::Failure,
        }
    }
}

/// Why the macro surface has no solution to report.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SoftContactError {
    /// The rubber, the profile or a number is out of range.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// A local pressure left the samples of the law.
    #[error("at the mean pressure {mean_pressure:e} Pa: {source}")]
    Law {
        /// Mean pressure in Pa.
        mean_pressure: f64,
        /// What the law said.
        source: LawError,
    },
    /// The iteration ended before the residual was small enough.
    #[error(
        "the contact under a local law did not converge: p = {mean_pressure:e} Pa, v = {speed:e} \
         m/s, {points} points: residual {residual:.1e} after {iterations} iterations; try another \
         number of points"
    )]
    NotConverged {
        /// Mean pressure in Pa.
        mean_pressure: f64,
        /// Sliding speed in m/s.
        speed: f64,
        /// Grid points.
        points: usize,
        /// Residual as in [`crate::multiscale::SoftContactSolution::residual`].
        residual: f64,
        /// Newton iterations on the finest grid.
        iterations: usize,
    },
}

impl HasKind for SoftContactError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Contact(source) => source.kind(),
            Self::Law { source, .. } => source.kind(),
            Self::NotConverged { .. } => ErrorKind::Failure,
        }
    }
}
