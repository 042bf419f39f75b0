//! Rubber: moduli over frequency, and the file that states them.

mod file;
mod maxwell;

pub use file::{RubberFileError, parse_rubber, read_rubber};
pub use maxwell::{MaxwellBranch, Rubber, RubberError};
