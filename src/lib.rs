//! Hysteretic rubber friction on asphalt, from profilometer scans to tables with an error bar.
//!
//! ```text
//! scans ─ ingest ─ characterise ─ approximate ─ realise ─ bem ─ tables
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`artifact`] | tables (Arrow), arrays (HDF5), manifests, digests and the folder of a run |
//! | [`cli`] | arguments, printing, exit codes |
//! | [`numerics`] | FFT, Krylov, interpolation, statistics: no physics, no files |
//! | [`reference`] | exact solutions: Westergaard, full contact, Hertz |
//! | [`scans`] | readers of instrument files |
//! | [`surface`] | line scans, roughness parameters, correlation, spectra, superposed sines |
//!
//! # Conventions
//! SI in memory (m, Pa, s, rad); mm, MPa and mm/s at the edges only, always with the unit in the
//! name. Heights grow towards the rubber; the rubber slides in `+x` at speed `v > 0`; pressure is
//! positive in compression; a positive friction coefficient opposes the motion. Missing heights
//! are NaN and nothing else is.

pub mod artifact;
pub mod cli;
pub mod contact;
pub mod numerics;
pub mod pipeline;
pub mod recipe;
pub mod reference;
pub mod report;
pub mod rubber;
pub mod scans;
pub mod schemas;
pub mod stages;
pub mod surface;
