//! Errors of the shear in the area of contact.

use crate::contact::ContactError;
use crate::error_kind::{ErrorKind, HasKind};

/// Errors of a law of the shear stress, of its fit and of contact under shear.
#[derive(Debug, thiserror::Error)]
pub enum ShearError {
    /// A number that is out of range.
    #[error("{quantity} is {value}, it must be {range}")]
    OutOfRange {
        /// Which number, with its unit.
        quantity: &'static str,
        /// Its value in that unit.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// A table of the shear stress with fewer than two speeds.
    #[error("the table of the shear stress has {points} speed(s), it needs at least two")]
    TooFewSpeeds {
        /// How many there are.
        points: usize,
    },
    /// Speeds of a table that do not ascend.
    #[error(
        "the speed {speed} m/s comes after {before} m/s: speeds of the table of the shear stress must ascend"
    )]
    NotAscending {
        /// The speed in m/s.
        speed: f64,
        /// The one before it in m/s.
        before: f64,
    },
    /// A table of friction with fewer than two pressures.
    #[error("the table of friction has {points} pressure(s), it needs at least two")]
    TooFewPressures {
        /// How many there are.
        points: usize,
    },
    /// Pressures of a table that do not ascend.
    #[error(
        "the pressure {pressure} Pa comes after {before} Pa: pressures of the table of friction must ascend"
    )]
    PressuresNotAscending {
        /// The pressure in Pa.
        pressure: f64,
        /// The one before it in Pa.
        before: f64,
    },
    /// A speed outside a table.
    #[error(
        "the table of the shear stress goes from {:e} to {:e} m/s and has no value at {speed:e} m/s{}",
        .range[0],
        .range[1],
        if *.shifted { " (the speed times the shift factor of the temperature)" } else { "" }
    )]
    OutsideTable {
        /// The speed in m/s.
        speed: f64,
        /// Lowest and highest speed in m/s.
        range: [f64; 2],
        /// Whether the speed was shifted with the temperature.
        shifted: bool,
    },
    /// Too few measurements for the constants.
    #[error(
        "{measurements} measurement(s) cannot determine {constants} constant(s) and their intervals: measure at least {}, or \
         fix a constant",
        .constants + 1
    )]
    TooFewMeasurements {
        /// How many measurements there are.
        measurements: usize,
        /// How many constants are fitted.
        constants: usize,
    },
    /// Measurements at one temperature do not determine an activation energy.
    #[error(
        "all measurements are at one temperature, which does not determine the activation energy: fix it, or measure at \
         several temperatures"
    )]
    OneTemperature,
    /// No measurement exceeds the hysteretic friction.
    #[error(
        "the measured friction is nowhere above the hysteretic friction: no shear stress of the contact area explains it"
    )]
    NothingLeft,
    /// The fit did not reach a minimum.
    #[error(
        "the constants of the shear law do not settle: the measurements do not determine them; measure over more speeds (and temperatures, for the activation energy), or fix the constants that are known"
    )]
    NotConverged,
    /// Contact under shear did not settle.
    #[error(
        "contact under shear did not settle within {steps} steps: the last changed friction by {change:e}"
    )]
    CouplingNotConverged {
        /// How many steps were done.
        steps: usize,
        /// The last change of friction, relative.
        change: f64,
    },
    /// The contact itself.
    #[error(transparent)]
    Contact(#[from] ContactError),
}

impl HasKind for ShearError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::OutOfRange { .. }
            | Self::TooFewSpeeds { .. }
            | Self::TooFewPressures { .. }
            | Self::PressuresNotAscending { .. }
            | Self::NotAscending { .. }
            | Self::OutsideTable { .. }
            | Self::TooFewMeasurements { .. }
            | Self::OneTemperature
            | Self::NothingLeft => ErrorKind::Input,
            Self::NotConverged | Self::CouplingNotConverged { .. } => ErrorKind::Failure,
            Self::Contact(error) => error.kind(),
        }
    }
}
