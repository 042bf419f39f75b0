//! What can go wrong with heat.

use crate::error_kind::{ErrorKind, HasKind};

/// Why there is no temperature to report.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HeatError {
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
    /// A list whose length does not fit the others.
    #[error("there are {found} {quantity}, {expected} are needed")]
    Length {
        /// What the list holds.
        quantity: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
    /// A number of a list that is not one.
    #[error("{quantity} number {index} (from zero) is {value}: it must be finite")]
    NotFinite {
        /// What the list holds.
        quantity: &'static str,
        /// Zero-based index.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The heat of the field is not the power of the spectrum.
    #[error(
        "the heat of the field is {heat:e} W/m² and the power of the pressures {power:e} W/m²: the depths do not resolve it"
    )]
    NotClosed {
        /// Integral of the heat source in W/m².
        heat: f64,
        /// Power by the spectrum in W/m².
        power: f64,
    },
    /// The heat flux into the road did not converge.
    #[error(
        "the heat flux from the contact to the road did not converge: residual {residual:.1e} after {iterations} iterations"
    )]
    Conduction {
        /// Relative residual.
        residual: f64,
        /// Iterations.
        iterations: usize,
    },
}

impl HasKind for HeatError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::OutOfRange { .. } | Self::Length { .. } | Self::NotFinite { .. } => {
                ErrorKind::Input
            }
            Self::NotClosed { .. } | Self::Conduction { .. } => ErrorKind::Failure,
        }
    }
}
