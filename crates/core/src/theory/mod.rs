//! Older theories of hysteretic friction: what they predict on the profiles that the other models
//! solve. Closed formulas, no contact is solved.
//!
//! | item | theory |
//! |---|---|
//! | [`Persson`] | diffusion of the pressure from the long waves to the short ones |
//! | [`IsotropicPersson`] | the same on an isotropic surface with a continuous spectrum |
//! | [`KlueppelHeinrich`] | a layer as thick as the mean penetration, strained as the profile is rough |
//! | [`SliderTheory`] | dissipation under the elastic pressure of a cylinder or a triangle |
//!
//! Both theories were made for isotropic surfaces with a continuous spectrum. [`Persson`] and [`KlueppelHeinrich`] are
//! for superposed sines in plane strain, sliding along them: integrals over the wavenumber become sums over the
//! waves and there is no angle to integrate over. Phases have no effect, and no two waves may have the same length.

mod isotropic;
mod klueppel_heinrich;
mod persson;
mod slider;

pub use isotropic::{
    Diffusion, FlashPrediction, Heating, IsotropicPersson, IsotropicPrediction, PerssonError,
    PerssonOptions, PredictionErrors,
};
pub use klueppel_heinrich::KlueppelHeinrich;
pub use persson::Persson;
pub use slider::{SliderEstimate, SliderTheory};
