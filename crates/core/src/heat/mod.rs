//! Heat of a sliding contact: where the rubber turns work into heat, and how warm that makes it.
//!
//! | module | what it holds |
//! |---|---|
//! | `material` | [`Thermal`], [`Road`] and [`ThermalSetting`]: thermal constants and the time of sliding |
//! | `depth` | depths below the surface and integrals over them |
//! | [`source`] | the exact heat source of a half-plane |
//! | `areal` | [`ArealHeat`]: the heat source below an areal surface |
//! | `road` | heat flux from the contact into the road |
//! | [`temperature`] | the temperature below a sliding contact |
//!
//! All fields are steady in the frame of the profile and periodic along it; only their mean over the period grows with the
//! time of sliding.

mod areal;
mod depth;
mod error;
mod material;
mod road;
pub mod source;
pub mod temperature;

#[cfg(test)]
mod tests;

pub use areal::{ArealHeat, ArealLoad};
pub use error::HeatError;
pub use material::{Road, Thermal, ThermalSetting};
pub use source::{HeatSource, LineLoad};
pub use temperature::Temperatures;
