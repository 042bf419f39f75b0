//! Steady sliding contact of a linear viscoelastic half-space with a rigid periodic profile.
//!
//! In the frame of the profile the field is steady. Separation, pressure and load obey
//!
//! ```text
//! u(x) = ubar + w(x) - z(x),   t >= 0,  u >= 0,  u t = 0,   mean(t) = p
//! w_hat(q) = 2 / (|q| E_r(q v)) t_hat(q),   mean(w) = mean(z) = 0
//! ```
//!
//! | module | what it does |
//! |---|---|
//! | [`half_space`] | the operator from pressure to displacement, by FFT |
//! | `patches`, `preconditioner` | runs of contact points; the operator's approximate inverse on them |
//! | `hierarchical`, `influence` | compressed matrices and their factors; the entries of these matrices |
//! | `active_set` | the contact set and the pressures on one grid |
//! | `direct` | small contacts by dense factors |
//! | [`sliding`] | nested grids from coarse to fine: the solver that users call |
//! | [`solution`] | friction, area, separation, dissipation and residual of a solved contact |
//! | [`area`] | the pressure that gives a contact area |
//! | [`curve`] | friction over contact area, from few solves |
//! | [`areal`] | the same for surfaces that are rough in both directions |
//! | [`effective`] | heat and large strain: moduli of each wave that follow from the contact |
//! | [`refine`] | grids fine enough for a given accuracy of friction |

pub mod area;
pub mod areal;
pub mod curve;
pub mod effective;
pub mod half_space;
pub mod refine;
pub mod sliding;
pub mod solution;

mod active_set;
mod direct;
mod edges;
mod error;
mod hierarchical;
mod influence;
mod patches;
pub(crate) mod preconditioner;

pub use curve::{CurvePoint, CurveValue, friction_curve};
pub use error::ContactError;
pub use sliding::SlidingContact;
pub use solution::ContactSolution;
