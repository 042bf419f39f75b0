//! Long waves of a profile under the rubber, with the short ones as a local law (thesis 5.1).
//!
//! The short waves answer a local mean pressure p with a local mean separation g(p). The long
//! waves z then meet the half-space at
//!
//! ```text
//! gap(x) = ubar + w(x) - z(x),   p > 0 => gap = g(p),   p = 0 => gap >= g(0),   mean(p) given
//! ```
//!
//! with the displacement w of [`crate::contact`]. A constant g is its hard wall.
//!
//! | module | what it does |
//! |---|---|
//! | [`scales`] | which waves are the microscale |
//! | [`sampling`] | how densely the microscale must be sampled |
//! | [`law`] | the local law between samples, and what it refuses |
//! | [`correction`] | what the microscale changes of friction and area |
//! | [`soft`] | nested grids from coarse to fine: the solver that users call |
//! | [`solution`] | local pressures, gaps, friction and residual of a solved contact |
//! | `newton` | pressures and mean separation on one grid |
//! | `layer` | the linear operator of a Newton step and its approximate inverse |

pub mod correction;
pub mod law;
pub mod sampling;
pub mod scales;
pub mod soft;
pub mod solution;

mod error;
mod layer;
mod newton;

pub use error::{LawError, SoftContactError};
pub use law::{LawEnd, LocalLaw};
pub use soft::SoftContact;
pub use solution::SoftContactSolution;

#[cfg(test)]
mod tests;
