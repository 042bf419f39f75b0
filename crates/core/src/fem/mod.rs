//! Rubber at finite deformation on a rigid periodic profile.
//!
//! A block of one period, in plane strain, of a spring with Maxwell branches in finite linear viscoelasticity (thesis,
//! chapters 2 and 4; the law of the springs is a [`Rheology`](crate::rubber::Rheology)) slides without friction in the contact over the profile; all loss is
//! hysteresis. Two solvers check each other:
//!
//! - [`steady`]: the stationary field in the frame of the profile. One Newton solve a pressure.
//! - [`transient`]: the procedure of the thesis, time steps of a block that is pressed on and dragged.
//!
//! | module | what it holds |
//! |---|---|
//! | [`profile`] | the rigid profile: height, slope and curvature anywhere |
//! | [`mesh`] | graded rows of parallelograms, the integration of an element |
//! | `unknowns` | the unknowns of a block whose upper edge moves as a whole |
//! | [`cost`] | cost of a contact in seconds and memory |
//! | [`error`] | what can go wrong |
//!
//! Elements are bilinear; their volumetric part is integrated at the centre alone (selective
//! reduced integration), which keeps them from locking at ν = 0.49.

pub mod cost;
pub mod error;
mod kinematics;
#[cfg(test)]
mod laws;
pub mod mesh;
pub mod profile;
pub mod steady;
pub mod transient;
mod unknowns;
