//! Mathematics without physics and without files.

pub mod bracket;
pub mod interpolation;
pub mod krylov;
pub mod statistics;
