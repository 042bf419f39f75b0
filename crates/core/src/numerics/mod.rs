//! Mathematics without physics and without files.

pub mod bracket;
pub mod direct;
pub mod interpolation;
pub mod interrupt;
pub mod krylov;
pub mod statistics;

pub use interrupt::Interrupt;

/// Complex numbers of public functions, so that a user needs no version of their own.
pub use rustfft::num_complex::Complex64;
