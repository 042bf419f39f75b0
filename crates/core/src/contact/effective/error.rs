//! What can go wrong with effective moduli.

use crate::contact::ContactError;
use crate::error_kind::{ErrorKind, HasKind};
use crate::heat::HeatError;
use crate::rubber::RubberError;

/// Why there is no contact with effective moduli to report.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EffectiveError {
    /// The contact with the moduli of one step.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// Heat or temperature of one step.
    #[error(transparent)]
    Heat(#[from] HeatError),
    /// The rubber is not known at a temperature that the contact reaches.
    #[error(
        "the rubber has no shift factor at {temperature_c:.1} °C, which a wave of {wavelength:.3e} m meets below the contact: \
         {reason}; lower speed or pressure, or extend the law"
    )]
    Temperature {
        /// The temperature in °C.
        temperature_c: f64,
        /// The wave in m.
        wavelength: f64,
        /// What the law says.
        reason: String,
    },
    /// The rubber is not known at a strain that the contact reaches.
    #[error(
        "the rubber has no strain factors at the strain {strain:.3e}, which a wave of {wavelength:.3e} m meets below the contact: \
         {reason}; lower the pressure, or extend the law"
    )]
    Strain {
        /// The strain, a tensor shear amplitude.
        strain: f64,
        /// The wave in m.
        wavelength: f64,
        /// What the law says.
        reason: String,
    },
    /// The steps ended before the fixed point was reached.
    #[error(
        "the effective moduli did not converge in {steps} steps at p = {pressure:e} Pa, v = {speed:e} m/s: they still change \
         by {moduli:.1e} and friction or area by {contact:.1e} (relative; the tolerance is {tolerance:.0e}); use more points, or a \
         larger tolerance"
    )]
    NotConverged {
        /// Mean pressure in Pa.
        pressure: f64,
        /// Sliding speed in m/s.
        speed: f64,
        /// Contacts solved.
        steps: usize,
        /// Largest change of a factor of the moduli, relative.
        moduli: f64,
        /// Largest change of friction or area, relative.
        contact: f64,
        /// What was wanted.
        tolerance: f64,
    },
}

impl EffectiveError {
    /// Whether the solver ran and found no contact whose moduli are known and agree with it; other errors are wrong input or an
    /// interrupt.
    pub fn is_no_solution(&self) -> bool {
        match self {
            // The rubber without factors is known at all its frequencies, else there is no contact at all.
            Self::Contact(ContactError::Rubber(RubberError::NotMeasured { .. })) => true,
            Self::Contact(error) => error.is_no_solution(),
            Self::Heat(error) => error.kind() == ErrorKind::Failure,
            Self::Temperature { .. } | Self::Strain { .. } | Self::NotConverged { .. } => true,
        }
    }
}

impl HasKind for EffectiveError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Contact(error) => error.kind(),
            Self::Heat(error) => error.kind(),
            Self::Temperature { .. } | Self::Strain { .. } => ErrorKind::Input,
            Self::NotConverged { .. } => ErrorKind::Failure,
        }
    }
}
