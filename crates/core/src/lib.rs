//! Contact mechanics and roughness: numbers in, numbers out.
//!
//! No file, no command line, no C library, nothing of one operating system. The crate `asperity` has these modules under
//! the same names and adds scans, stages and results.
//!
//! | module | what it holds |
//! |---|---|
//! | [`surface`] | line scans, roughness parameters, correlation, spectra, superposed sines, realisations |
//! | [`rubber`] | generalised Maxwell model, temperature, finite strain, its fit to measured moduli |
//! | [`heat`] | heat source and temperature of a sliding contact |
//! | [`contact`] | the viscoelastic half-space: operator, active set, friction over contact area |
//! | [`interface`] | shear in the area of contact: its law, its fit, its effect on the contact |
//! | [`multiscale`] | long waves on the half-space with the short ones as a local law |
//! | [`fem`] | rubber at finite deformation on a rigid profile: steady and transient |
//! | [`homogenisation`] | friction scale by scale: the older multiscale methods |
//! | [`theory`] | Persson, Klüppel-Heinrich: what older theories predict |
//! | [`water`] | sealed pools, squeeze-out of a film |
//! | [`mod@reference`] | exact solutions: Westergaard, full contact, Hertz |
//! | [`numerics`] | mathematics without physics: Krylov, interpolation, statistics |
//! | [`error_kind`] | who can mend an error |
//!
//! # Conventions
//! SI throughout (m, Pa, s, rad). Heights grow towards the rubber; the rubber slides in `+x` at speed `v > 0`; pressure is
//! positive in compression; a positive friction coefficient opposes the motion. Missing heights are NaN and nothing else
//! is.

pub mod contact;
pub mod error_kind;
pub mod fem;
pub mod heat;
pub mod homogenisation;
pub mod interface;
pub mod multiscale;
pub mod numerics;
pub mod reference;
pub mod rubber;
pub mod surface;
pub mod theory;
pub mod water;
