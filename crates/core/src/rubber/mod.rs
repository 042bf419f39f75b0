//! Rubber: moduli over frequency and temperature, and their fit to measured sweeps.
//!
//! | module | what it holds |
//! |---|---|
//! | `viscoelastic` | [`Viscoelastic`]: what the half-space and the theories ask of a rubber |
//! | `maxwell` | [`Rubber`], the generalised Maxwell model |
//! | `measured`, `clean` | [`MeasuredModuli`], a measured master curve without a model; its rows put in order |
//! | `model` | [`RubberModel`], either of the two |
//! | [`causality`] | whether storage and loss modulus of a table belong together (Kramers-Kronig) |
//! | `table_2_1` | the rubber of the published tables |
//! | `temperature`, `shift_table`, `vertical` | shift of frequency and of moduli with temperature |
//! | [`payne`] | softening of filled rubber with strain |
//! | `data`, `frequencies` | a rubber with what is known of its measurement |
//! | `oddities` | warnings of numbers that look like a mistake |
//! | [`finite_strain`] | stress, tangent and heat at finite deformation |
//! | [`fit`] | a Prony series from measured storage and loss moduli |
//! | [`hyperelastic`] | the law at finite strain from a measured curve of stress over stretch |

pub mod causality;
pub mod finite_strain;
pub mod fit;
pub mod hyperelastic;
pub mod payne;

mod clean;
mod data;
mod frequencies;
mod maxwell;
mod measured;
mod model;
mod oddities;
mod shift_table;
mod table_2_1;
mod temperature;
mod vertical;
mod viscoelastic;

pub use clean::Cleaned;
pub use data::RubberData;
pub use finite_strain::{FiniteStrainRubber, Rheology};
pub use frequencies::FrequencyRange;
pub use maxwell::{MaxwellBranch, Rubber, RubberError};
pub use measured::{Extrapolation, MeasuredModuli};
pub use model::RubberModel;
pub use shift_table::ShiftTable;
pub use temperature::{
    GAS_CONSTANT, HOTTEST_C, ShiftLaw, TemperatureDependence, TemperatureError, ZERO_CELSIUS,
};
pub use vertical::VerticalShift;
pub use viscoelastic::Viscoelastic;
