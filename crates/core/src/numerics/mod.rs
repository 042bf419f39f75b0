//! Mathematics without physics and without files.
//!
//! | module | what it holds |
//! |---|---|
//! | [`anderson`] | fixed points of expensive functions |
//! | [`bracket`] | the root of a growing function |
//! | [`direct`] | sparse LU factors of blocks of two unknowns a node, by nested dissection |
//! | [`interpolation`] | cubic Hermite interpolants |
//! | [`interrupt`] | a flag by which a user stops a long computation |
//! | `legendre` | functions by their values at Gauss-Legendre nodes |
//! | [`krylov`] | GMRES for matrix-free, nonsymmetric systems |
//! | `least_squares` | nonlinear least squares: a trust region on the Gauss-Newton model |
//! | `plane` | Fourier transform of real fields over a plane |
//! | [`statistics`] | means, spreads and confidence intervals of small samples, lines through points |

pub mod anderson;
pub mod bracket;
pub mod direct;
pub mod interpolation;
pub mod interrupt;
pub mod krylov;
pub(crate) mod least_squares;
pub(crate) mod legendre;
pub(crate) mod plane;
pub mod statistics;

pub use interrupt::Interrupt;

/// Complex numbers of public functions, so that a user need not depend on the same version.
pub use rustfft::num_complex::Complex64;
