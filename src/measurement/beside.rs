//! What is computed beside every measurement, at its speed, temperature and pressure.

use super::file::MeasuredFile;
use super::run::{Computed, ComputedAt};
use crate::error_kind::{ErrorKind, HasKind};
use crate::interface::MeasuredFriction;
use crate::rubber::{self, RubberFileError, TemperatureDependence, read_rubber_data};
use crate::units::Units;
use std::path::{Path, PathBuf};

/// Temperature in °C that stands for all where none is stated anywhere: without another one it has no effect.
const ANY_C: f64 = 20.0;

/// A measurement and what is computed for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beside {
    /// Both, as the fit of the shear stress takes them.
    pub measured: MeasuredFriction,
    /// Estimated error of the hysteretic friction; `None` where it is not known.
    pub hysteretic_error: Option<f64>,
    /// Relative error of the contact area; `None` where it is not known.
    pub relative_area_error: Option<f64>,
}

/// The temperatures of a computation and of what was measured.
#[derive(Debug, Clone)]
pub struct Temperatures {
    /// That of the computation in °C, if it has one.
    pub computed_c: Option<f64>,
    /// Those of the measurements in °C, in their order.
    pub measured_c: Vec<f64>,
    /// How the rubber shifts, where temperatures differ.
    rubber: Option<TemperatureDependence>,
}

/// Why measurements and a computation have no common temperatures.
#[derive(Debug, thiserror::Error)]
pub enum TemperatureError {
    /// A measurement with a temperature beside a computation without.
    #[error(
        "a measurement is at {celsius} °C and the run states no temperature: set bem.temperature_c in its recipe, and run it again"
    )]
    NotStated {
        /// The first temperature in °C that is stated.
        celsius: f64,
    },
    /// A rubber that cannot be read.
    #[error(transparent)]
    Rubber(#[from] RubberFileError),
    /// A rubber that does not shift.
    #[error(
        "measurements are not at the {computed_c} °C of the run, and {} has no [temperature] section to shift its friction by", .path.display()
    )]
    NoShift {
        /// Temperature of the run in °C.
        computed_c: f64,
        /// The rubber file.
        path: PathBuf,
    },
    /// A rubber whose moduli change with temperature beside their shift.
    #[error(
        "measurements are not at the {computed_c} °C of the run, and the moduli of its rubber change with temperature beside their shift: make a run at each temperature"
    )]
    Vertical {
        /// Temperature of the run in °C.
        computed_c: f64,
    },
}

impl HasKind for TemperatureError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Rubber(error) => error.kind(),
            Self::NotStated { .. } | Self::NoShift { .. } | Self::Vertical { .. } => {
                ErrorKind::Input
            }
        }
    }
}

/// Why there is nothing beside a measurement.
#[derive(Debug, thiserror::Error)]
pub enum BesideError {
    /// The computation does not cover it.
    #[error(transparent)]
    Computed(#[from] super::run::ComputedError),
    /// The rubber does not shift so far.
    #[error(transparent)]
    Shift(#[from] rubber::TemperatureError),
}

impl HasKind for BesideError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Computed(error) => error.kind(),
            Self::Shift(error) => error.kind(),
        }
    }
}

impl Temperatures {
    /// Of measurements, `default_c` for those whose file has none, beside a computation at `computed_c` with the rubber of a
    /// file.
    ///
    /// # Errors
    /// [`TemperatureError`].
    pub fn new(
        file: &MeasuredFile,
        default_c: Option<f64>,
        computed_c: Option<f64>,
        rubber: &Path,
    ) -> Result<Self, TemperatureError> {
        let own = file.points.iter().map(|point| point.temperature_c.or(default_c).or(computed_c));
        let known: Vec<Option<f64>> = own.collect();
        let Some(celsius) = known.iter().flatten().next().copied() else {
            let measured_c = vec![ANY_C; known.len()];
            return Ok(Self { computed_c, measured_c, rubber: None });
        };
        let computed_c = computed_c.ok_or(TemperatureError::NotStated { celsius })?;
        let measured_c: Vec<f64> = known.into_iter().map(|c| c.unwrap_or(computed_c)).collect();
        let rubber = if measured_c.iter().all(|c| *c == computed_c) {
            None
        } else {
            let path = rubber.to_path_buf();
            let law = read_rubber_data(rubber)?.temperature;
            let law = law.ok_or(TemperatureError::NoShift { computed_c, path })?;
            if law.vertical.is_some() {
                return Err(TemperatureError::Vertical { computed_c });
            }
            Some(law)
        };
        Ok(Self { computed_c: Some(computed_c), measured_c, rubber })
    }

    /// Whether all measurements are at one temperature.
    pub fn is_one(&self) -> bool {
        self.measured_c.windows(2).all(|pair| pair[0] == pair[1])
    }

    /// Whether some measurement is not at the temperature of the computation.
    pub fn differ(&self) -> bool {
        self.rubber.is_some()
    }

    /// Factor of the speed by which a measurement at a temperature in °C is one at that of the computation.
    fn factor(&self, celsius: f64) -> Result<f64, rubber::TemperatureError> {
        let (Some(law), Some(computed_c)) = (&self.rubber, self.computed_c) else { return Ok(1.0) };
        Ok(law.shift_factor(celsius)? / law.shift_factor(computed_c)?)
    }
}

/// What a run has beside one measurement, the `index`-th of a file, whose speed is shifted with the temperature: moduli that only
/// shift have the same friction at `v a_T`.
///
/// # Errors
/// [`BesideError`].
pub fn beside(
    file: &MeasuredFile,
    index: usize,
    temperatures: &Temperatures,
    computed: &Computed,
) -> Result<Beside, BesideError> {
    let point = &file.points[index];
    let temperature_c = temperatures.measured_c[index];
    let factor = temperatures.factor(temperature_c)?;
    let ComputedAt { hysteretic, contact_area_fraction, error, relative_area_error } =
        computed.at(point.speed_mm_s * factor, factor != 1.0)?;
    Ok(Beside {
        measured: MeasuredFriction {
            speed: point.speed_mm_s.mm_to_m(),
            temperature_c,
            pressure: computed.pressure_mpa.mpa_to_pa(),
            friction: point.friction,
            hysteretic,
            contact_area_fraction,
        },
        hysteretic_error: error,
        relative_area_error,
    })
}
