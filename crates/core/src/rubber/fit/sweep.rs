//! Measured sweeps and their errors.

use crate::error_kind::{ErrorKind, HasKind};
use std::ops::RangeInclusive;

/// One measured point, in SI.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SweepPoint {
    /// Angular frequency in rad/s.
    pub angular_frequency: f64,
    /// Storage modulus E' in Pa.
    pub storage_modulus: f64,
    /// Loss modulus E'' in Pa.
    pub loss_modulus: f64,
}

/// A frequency sweep at one temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Temperature in °C; may be left out if there is one sweep only.
    pub temperature_c: Option<f64>,
    /// Points in any order.
    pub points: Vec<SweepPoint>,
}

/// Which modulus was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ModulusKind {
    /// Young's modulus E: tension, compression, bending.
    Youngs,
    /// Shear modulus G: torsion, shear; becomes `E = 2 (1 + ν) G`.
    Shear,
}

impl ModulusKind {
    /// What a measured modulus is multiplied by to be Young's.
    pub fn factor(self, poisson_ratio: f64) -> f64 {
        match self {
            Self::Youngs => 1.0,
            Self::Shear => 2.0 * (1.0 + poisson_ratio),
        }
    }
}

/// How moduli change with temperature in addition to the shift of the frequency.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum VerticalChoice {
    /// Nothing: moduli are the same at all temperatures.
    #[default]
    None,
    /// They grow with density times absolute temperature.
    RhoT {
        /// Volume expansion in 1/K.
        expansion_per_k: f64,
    },
    /// A factor is fitted for every temperature; those that the moduli do not determine are near
    /// density times absolute temperature.
    Free {
        /// Volume expansion in 1/K.
        expansion_per_k: f64,
    },
}

/// A given shift factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenShift {
    /// Temperature in °C.
    pub temperature_c: f64,
    /// `log10 a_T` about any reference temperature, the same one for all.
    pub log10_shift: f64,
}

/// Options of a fit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FitOptions {
    /// Number of terms; by the criterion if not given.
    pub terms: Option<usize>,
    /// Reference temperature in °C, one of the measured; the middle one if not given.
    pub reference_c: Option<f64>,
    /// Vertical shift.
    pub vertical: VerticalChoice,
    /// Shift factors to take as they are; fitted if not given.
    pub shift_factors: Option<Vec<GivenShift>>,
}

/// Errors of a fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// No point at all.
    #[error("there are no points to fit")]
    Empty,
    /// A number that cannot be one of a sweep.
    #[error(
        "{quantity} is {value:e} in SI, it must lie between {:e} and {:e}: check the number and its unit",
        .range[0], .range[1]
    )]
    OutOfRange {
        /// Which quantity.
        quantity: &'static str,
        /// Its value in SI.
        value: f64,
        /// Smallest and largest possible value.
        range: [f64; 2],
    },
    /// The same frequency twice at one temperature.
    #[error(
        "the frequency {frequency_hz} Hz occurs twice in one sweep: average the points, or give each \
         its temperature"
    )]
    Duplicate {
        /// Frequency in Hz.
        frequency_hz: f64,
    },
    /// Several sweeps and not every temperature.
    #[error("several sweeps need a temperature each, different from the others")]
    Temperatures,
    /// Not enough to determine what is asked for.
    #[error(
        "{points} points are too few: {needed} or more are needed; measure more, or fit fewer terms"
    )]
    TooFewPoints {
        /// Number of points.
        points: usize,
        /// Least number of points.
        needed: usize,
    },
    /// Neighbouring temperatures without common moduli.
    #[error(
        "the sweeps at {colder_c} °C (storage modulus {:.4} to {:.4} MPa) and {hotter_c} °C ({:.4} to {:.4} MPa) \
         cannot be shifted onto each other: they have fewer than two points each in common storage moduli, and \
         loss modulus and tan delta do not join them either. Measure at a temperature between them or over more \
         frequencies, give shift factors that you know, or fit them apart",
        .colder_mpa[0], .colder_mpa[1], .hotter_mpa[0], .hotter_mpa[1]
    )]
    NoOverlap {
        /// Temperature of the colder sweep in °C.
        colder_c: f64,
        /// Temperature of the hotter sweep in °C.
        hotter_c: f64,
        /// Smallest and largest storage modulus of the colder one in MPa.
        colder_mpa: [f64; 2],
        /// Smallest and largest storage modulus of the hotter one in MPa.
        hotter_mpa: [f64; 2],
    },
    /// A reference temperature without a sweep.
    #[error(
        "there is no sweep at the reference temperature {wanted_c} °C: choose one of [{}] °C",
        .measured_c.iter().map(|t| format!("{t}")).collect::<Vec<_>>().join(", ")
    )]
    Reference {
        /// The temperature asked for, in °C.
        wanted_c: f64,
        /// Those of the sweeps in °C.
        measured_c: Vec<f64>,
    },
    /// Shift factors are given, but not for every sweep.
    #[error(
        "there is no shift factor for the sweep at {temperature_c} °C among those given for [{}] °C: add it, or \
         leave the sweep out",
        .given_c.iter().map(|t| format!("{t}")).collect::<Vec<_>>().join(", ")
    )]
    NoShiftFactor {
        /// Temperature of the sweep in °C.
        temperature_c: f64,
        /// Temperatures of the given factors in °C.
        given_c: Vec<f64>,
    },
    /// Shift factors for a master curve without a temperature, none of them 1.
    #[error(
        "the moduli have no temperature and none of the shift factors is 1: give the temperature of the master \
         curve"
    )]
    NoReference,
    /// A vertical shift asks for absolute temperatures.
    #[error("a vertical shift needs sweeps at several temperatures")]
    VerticalWithoutTemperature,
    /// No number of terms, or not the given one, gives a rubber.
    #[error(
        "the sweeps have no fit{}: {reason}; give fewer terms, or data over a wider range",
        .terms.map_or(String::new(), |terms| format!(" of {terms} terms"))
    )]
    NoFit {
        /// The given number.
        terms: Option<usize>,
        /// Why the last one was rejected.
        reason: &'static str,
    },
}

impl HasKind for FitError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Empty
            | Self::OutOfRange { .. }
            | Self::Duplicate { .. }
            | Self::Temperatures
            | Self::TooFewPoints { .. }
            | Self::NoOverlap { .. }
            | Self::NoShiftFactor { .. }
            | Self::NoReference
            | Self::VerticalWithoutTemperature
            | Self::Reference { .. } => ErrorKind::Input,
            Self::NoFit { .. } => ErrorKind::Failure,
        }
    }
}

/// From a creep of ages to the vibrations of molecules, in rad/s.
const FREQUENCIES: RangeInclusive<f64> = 1e-15..=1e20;
/// Nothing that holds together is softer or stiffer, in Pa.
const MODULI: RangeInclusive<f64> = 1e-3..=1e15;
const TEMPERATURES_C: RangeInclusive<f64> = -273.0..=2000.0;

/// The sweeps by ascending temperature, their points by ascending frequency.
pub(super) fn checked(sweeps: &[Sweep]) -> Result<Vec<Sweep>, FitError> {
    let mut sweeps = sweeps.to_vec();
    if sweeps.is_empty() || sweeps.iter().any(|sweep| sweep.points.is_empty()) {
        return Err(FitError::Empty);
    }
    for sweep in &mut sweeps {
        if let Some(temperature) = sweep.temperature_c {
            within("the temperature", temperature, TEMPERATURES_C)?;
        }
        for point in &sweep.points {
            within("an angular frequency", point.angular_frequency, FREQUENCIES)?;
            within("a storage modulus", point.storage_modulus, MODULI)?;
            within("a loss modulus", point.loss_modulus, MODULI)?;
        }
        let frequency = |point: &SweepPoint| point.angular_frequency;
        sweep.points.sort_by(|a, b| frequency(a).total_cmp(&frequency(b)));
        let twice = sweep.points.windows(2).find(|pair| frequency(&pair[0]) == frequency(&pair[1]));
        if let Some([point, ..]) = twice {
            let frequency_hz = frequency(point) / std::f64::consts::TAU;
            return Err(FitError::Duplicate { frequency_hz });
        }
    }
    if sweeps.len() > 1 {
        let temperature = |sweep: &Sweep| sweep.temperature_c.unwrap_or(f64::NAN);
        sweeps.sort_by(|a, b| temperature(a).total_cmp(&temperature(b)));
        let ascending = |pair: &[Sweep]| temperature(&pair[0]) < temperature(&pair[1]);
        if !sweeps.windows(2).all(ascending) {
            return Err(FitError::Temperatures);
        }
    }
    Ok(sweeps)
}

fn within(quantity: &'static str, value: f64, range: RangeInclusive<f64>) -> Result<(), FitError> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(FitError::OutOfRange { quantity, value, range: [*range.start(), *range.end()] })
}
