//! Rubber: moduli over frequency and temperature, and their fit to measured sweeps.
//!
//! | module | what it holds |
//! |---|---|
//! | [`finite_strain`] | stress, tangent and heat at finite deformation |
//! | [`fit`] | a Prony series from measured storage and loss moduli |

pub mod finite_strain;
pub mod fit;

mod data;
mod frequencies;
mod maxwell;
mod oddities;
mod table_2_1;
mod temperature;
mod vertical;

pub use data::RubberData;
pub use finite_strain::{FiniteStrainRubber, Rheology};
pub use frequencies::FrequencyRange;
pub use maxwell::{MaxwellBranch, Rubber, RubberError};
pub use temperature::{
    GAS_CONSTANT, HOTTEST_C, ShiftLaw, TemperatureDependence, TemperatureError, ZERO_CELSIUS,
};
pub use vertical::VerticalShift;
