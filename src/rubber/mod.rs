//! Rubber: moduli over frequency, and the file that states them.

pub mod finite_strain;

mod file;
mod maxwell;

pub use file::{RubberFileError, parse_rubber, read_rubber};
pub use finite_strain::{FiniteStrainRubber, Rheology};
pub use maxwell::{MaxwellBranch, Rubber, RubberError};
