//! Mathematics without physics and without files.

pub mod statistics;
