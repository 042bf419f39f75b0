//! Softening of filled rubber with strain: the Payne effect.
//!
//! ```text
//! E'(ω, ε) = E'(ω) f(ε),   E''(ω, ε) = E''(ω) g(ε),   f(0) = g(0) = 1
//! ```
//!
//! **Harmonic linearisation.** A strain sweep states the first harmonic of the stress under `ε sin ωt`. With f and g the rubber
//! answers every amplitude by a linear modulus of its own: higher harmonics, the history of larger strains (Mullins) and the
//! time in which the filler network heals are left out, and a sum of waves has no exact amplitude. Who uses f and g for a
//! strain that is not harmonic says which amplitude stands for it.
//!
//! **Which strain.** ε is the amplitude (half of peak to peak) of elongation, dimensionless. Shear sweeps are converted by
//! equal elastic energy of an incompressible solid, `E ε² = G γ²` with `E = 3 G`, which is also equal octahedral shear:
//! `ε = γ/√3` ([`elongation_of_shear`]); for the amplitude e of a tensor component of shear, `γ = 2 e`
//! ([`elongation_of_tensor_shear`]). f and g are ratios, so it does not matter which modulus was measured.
//!
//! Sweeps are measured at one frequency, and f and g are taken to be the same at all. They depend on temperature: between the
//! temperatures of two sweeps both are interpolated linearly in temperature, outside them the nearest sweep holds.
//!
//! | module | what it holds |
//! |---|---|
//! | `sweep` | a strain sweep, put in order; modulus at vanishing strain, outliers |
//! | `kraus` | Kraus' law and its fit |
//! | `table` | the measured factors themselves |
//! | `law` | [`Payne`] over temperature, [`PayneLaw`] at one |

mod kraus;
mod law;
mod sweep;
mod table;

#[cfg(test)]
mod tests;

pub use kraus::{Kraus, KrausFit};
pub use law::{Payne, PayneCurve, PayneLaw};
pub use sweep::{StrainPoint, StrainSweep};
pub use table::{PayneTable, TableFit};

use crate::error_kind::{ErrorKind, HasKind};

/// Amplitude of elongation with the elastic energy of a shear of amplitude γ (the change of an angle): `γ/√3`.
pub fn elongation_of_shear(shear: f64) -> f64 {
    shear / 3_f64.sqrt()
}

/// Amplitude of elongation with the elastic energy of a shear whose tensor component has the amplitude e: `2 e/√3`.
pub fn elongation_of_tensor_shear(shear: f64) -> f64 {
    elongation_of_shear(2.0 * shear)
}

/// Why there is no law of softening.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PayneError {
    /// No sweep.
    #[error("there is no strain sweep: give one for each temperature")]
    Empty,
    /// A sweep of too few strains.
    #[error("the strain sweep{} has {points} strains, it needs at least {needed}", at(.temperature_c))]
    TooFewPoints {
        /// Temperature in °C.
        temperature_c: Option<f64>,
        /// How many there are.
        points: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A number that is not positive and finite, or out of its range.
    #[error("the {quantity}{} is {value}, it must be {wanted}", at(.temperature_c))]
    Number {
        /// Temperature in °C.
        temperature_c: Option<f64>,
        /// Which number.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        wanted: &'static str,
    },
    /// Strains of a table out of order.
    #[error("the strain {strain}{} comes after {before}, strains must ascend", at(.temperature_c))]
    NotAscending {
        /// Temperature in °C.
        temperature_c: Option<f64>,
        /// The strain.
        strain: f64,
        /// The one before.
        before: f64,
    },
    /// Columns of a table of different lengths.
    #[error("the table{} has {strains} strains, {storage} storage factors and {loss} loss factors, one of each is needed", at(.temperature_c))]
    Lengths {
        /// Temperature in °C.
        temperature_c: Option<f64>,
        /// Number of strains.
        strains: usize,
        /// Number of storage factors.
        storage: usize,
        /// Number of loss factors.
        loss: usize,
    },
    /// Several laws, and not every one has its own temperature.
    #[error("several strain sweeps need a temperature each, different from the others")]
    Temperatures,
    /// Kraus' law has no fit.
    #[error(
        "Kraus' law does not fit the strain sweep{}: the fit did not converge; use the measured factors (law = \"table\")",
        at(.temperature_c)
    )]
    NoFit {
        /// Temperature in °C.
        temperature_c: Option<f64>,
    },
}

fn at(temperature_c: &Option<f64>) -> String {
    temperature_c.map_or(String::new(), |celsius| format!(" at {celsius} °C"))
}

impl HasKind for PayneError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoFit { .. } => ErrorKind::Failure,
            _ => ErrorKind::Input,
        }
    }
}
