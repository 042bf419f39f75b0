//! Rubber: moduli over frequency and temperature, the file that states them, and their fit to
//! measured sweeps.

pub mod finite_strain;
pub mod fit;

mod document;
mod file;
mod frequencies;
mod maxwell;
mod oddities;
mod temperature;
mod vertical;

pub use file::{
    RubberData, RubberFileError, parse_rubber, parse_rubber_data, read_rubber, read_rubber_at,
    read_rubber_data,
};
pub use finite_strain::{FiniteStrainRubber, Rheology};
pub use frequencies::FrequencyRange;
pub use maxwell::{MaxwellBranch, Rubber, RubberError};
pub use temperature::{
    GAS_CONSTANT, HOTTEST_C, ShiftLaw, TemperatureDependence, TemperatureError, ZERO_CELSIUS,
};
pub use vertical::VerticalShift;
