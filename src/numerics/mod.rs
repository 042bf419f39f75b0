//! Mathematics without physics and without files.

pub mod krylov;
pub mod statistics;
