//! Rubber: moduli over frequency.

mod maxwell;

pub use maxwell::{MaxwellBranch, Rubber, RubberError};
