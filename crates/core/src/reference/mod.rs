//! Contacts with an exact solution: what every solver is checked against.
//!
//! | item | what it solves |
//! |---|---|
//! | [`Westergaard`] | elastic half-plane on one sine, from the first touch to full contact |
//! | [`FullContact`] | viscoelastic half-plane sliding in full contact with one sine |
//! | [`SineCrest`] | Hertz contact with the crest of one sine: small loads, high speed |
//! | [`SlidingCylinder`] | viscoelastic half-plane with one relaxation time under a sliding cylinder |
//!
//! Pressures are means over the whole period, in Pa; lengths in m; a reduced modulus is
//! `E_r = E / (1 - ν²)`.

mod full_contact;
mod hertz;
mod sliding_cylinder;
mod westergaard;

pub use full_contact::FullContact;
pub use hertz::SineCrest;
pub use sliding_cylinder::{CylinderContact, SlidingCylinder};
pub use westergaard::Westergaard;
