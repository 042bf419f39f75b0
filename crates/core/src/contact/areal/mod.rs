//! Steady sliding contact of a linear viscoelastic half-space, or layer, with a rigid surface that is periodic in both
//! directions.
//!
//! In the frame of the surface the field is steady. Separation, pressure and load obey
//!
//! ```text
//! u(x, y) = ubar + w(x, y) - z(x, y),   t >= 0,  u >= 0,  u t = 0,   mean(t) = p
//! w_hat(q) = 2 F(|q| h) / (|q| E_r(q · v)) t_hat(q),   mean(w) = mean(z) = 0
//! ```
//!
//! with `F = 1` for a half-space. The real part of `1 / E_r` is positive, so the operator is positive definite and the
//! solution unique; it is symmetric for an elastic body only. Surfaces that do not depend on `y` give the contact of a
//! line, see [`super::SlidingContact`].
//!
//! | module | what it does |
//! |---|---|
//! | `surface` | heights on a grid, and grids of half as many points |
//! | `layer` | compliance of a layer over that of a half-space |
//! | `half_space` | the operator from pressure to displacement |
//! | `linear` | pressures on a given contact set |
//! | `active_set` | the contact set and the pressures on one grid |
//! | `edges` | contact area with edges between grid points |
//! | `solution` | friction, area, separation, dissipation and residual of a solved contact |
//! | `sliding` | nested grids from coarse to fine: the solver that users call |
//! | `search` | the pressure that gives a contact area |

mod active_set;
mod edges;
mod half_space;
mod layer;
mod linear;
mod search;
mod sliding;
mod solution;
mod surface;

#[cfg(test)]
mod tests;

pub use half_space::{Sliding, wave_moduli};
pub use sliding::{ArealContact, ArealSetup, memory_bytes};
pub use solution::ArealSolution;
pub use surface::ArealSurface;
