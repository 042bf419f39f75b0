//! Errors of the theory for isotropic surfaces.

use crate::error_kind::{ErrorKind, HasKind};
use crate::rubber::RubberError;

/// Why there is no prediction.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PerssonError {
    /// The rubber, or its modulus at a frequency of the surface.
    #[error(transparent)]
    Rubber(#[from] RubberError),
    /// A number that must be positive and finite.
    #[error("{quantity} is {value}, it must be positive and finite")]
    NotPositive {
        /// What it is, with its unit.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// A γ that is no share.
    #[error("gamma is {value}, it must lie between 0 and 1; 0.5 is usual")]
    Gamma {
        /// The value.
        value: f64,
    },
    /// A tolerance that the quadrature does not reach.
    #[error("the tolerance is {value}, it must lie between 1e-12 and 0.1")]
    Tolerance {
        /// The value.
        value: f64,
    },
    /// Cut-offs that leave no roughness.
    #[error(
        "no roughness between the wavenumbers {:e} and {:e} rad/m: the spectrum is known from {:e} to {:e} rad/m",
        .band[0], .band[1], .table[0], .table[1]
    )]
    Band {
        /// The cut-offs in rad/m.
        band: [f64; 2],
        /// The wavenumbers of the spectrum.
        table: [f64; 2],
    },
    /// A wavenumber at which a prediction is asked for outside the cut-offs.
    #[error(
        "the wavenumber {wavenumber:e} rad/m lies outside the waves of the surface, {:e} to {:e} rad/m",
        .band[0], .band[1]
    )]
    Outside {
        /// The wavenumber in rad/m.
        wavenumber: f64,
        /// The cut-offs in rad/m.
        band: [f64; 2],
    },
    /// A load that is none.
    #[error(
        "the pressure of {pressure:e} Pa is {ratio:.1e} of the root mean square pressure of full contact, {full:e} Pa: less than \
         a billionth is no contact; give a larger pressure"
    )]
    Load {
        /// The mean pressure in Pa.
        pressure: f64,
        /// The root mean square pressure of full contact in Pa.
        full: f64,
        /// The former over the latter.
        ratio: f64,
    },
    /// The quadrature has not settled.
    #[error(
        "{quantity} still changes by {change:.1e} of its value when the quadrature is refined, the tolerance is {tolerance:e}; \
         allow a larger one, or look for jumps in the spectrum or the moduli"
    )]
    NotConverged {
        /// What has not settled.
        quantity: &'static str,
        /// Relative change by the last refinement.
        change: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// A temperature at which the rubber is not known.
    #[error(
        "the flash temperature leads to a rise of {rise:.1} K, where the shift of the rubber is not known: lower speed or pressure, or \
         extend its shift with temperature"
    )]
    NoShift {
        /// Rise in K.
        rise: f64,
    },
    /// A number that overflows.
    #[error(
        "{quantity} is {value}: moduli, heights or pressures are far outside those of any contact"
    )]
    NotFinite {
        /// What it is.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
}

impl HasKind for PerssonError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Rubber(source) => source.kind(),
            Self::NotPositive { .. }
            | Self::Gamma { .. }
            | Self::Tolerance { .. }
            | Self::Band { .. }
            | Self::Load { .. }
            | Self::NoShift { .. }
            | Self::Outside { .. } => ErrorKind::Input,
            Self::NotConverged { .. } | Self::NotFinite { .. } => ErrorKind::Failure,
        }
    }
}
