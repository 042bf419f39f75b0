//! Older theories of hysteretic friction: what they predict on the profiles that the other models
//! solve. Closed formulas, no contact is solved.
//!
//! | item | theory |
//! |---|---|
//! | [`Persson`] | diffusion of the pressure from the long waves to the short ones |
//! | [`KlueppelHeinrich`] | a layer as thick as the mean penetration, strained as the profile is rough |
//!
//! Both were made for isotropic surfaces with a continuous spectrum. Here they stand for superposed
//! sines in plane strain, sliding along them: integrals over the wavenumber become sums over the
//! waves and there is no angle to integrate over. Phases have no effect, and no two waves may have the same length.

mod klueppel_heinrich;
mod persson;

pub use klueppel_heinrich::KlueppelHeinrich;
pub use persson::Persson;
