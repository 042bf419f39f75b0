//! Hysteretic rubber friction on asphalt, from profilometer scans to tables with an error bar.
//!
//! ```text
//! scans ─ ingest ─ characterise ─ approximate ─ realise ─ bem ─ tables
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | [`numerics`] | FFT-free mathematics: Krylov, interpolation, statistics; no physics, no files |
//! | [`surface`] | line scans, roughness parameters, correlation, spectra, superposed sines, realisations |
//! | [`rubber`] | generalised Maxwell model, its file, its fit to measured moduli |
//! | [`mod@reference`] | exact solutions: Westergaard, full contact, Hertz |
//! | [`contact`] | the viscoelastic half-space: operator, active set, friction over contact area |
//! | [`multiscale`] | long waves on the half-space with the short ones as a local law |
//! | [`fem`] | rubber at finite deformation on a rigid profile: steady and transient |
//! | [`theory`] | Persson, Klüppel-Heinrich: what older theories predict |
//! | [`scans`] | readers of instrument files: bytes in, scan or error out |
//! | [`artifact`] | Arrow, HDF5, manifests, digests, the store; nothing else knows these formats |
//! | [`schemas`] | the documents in `schemas/` |
//! | [`stages`] | one file a stage: parameters, row types, one function |
//! | [`recipe`] | the TOML file that says what a run does |
//! | [`pipeline`] | the one function that wires the stages |
//! | [`mod@bench`] | work against precision, cost of growth |
//! | [`report`] | tables and figures for people |
//! | [`cli`] | arguments, progress bars, printing |
//!
//! # Conventions
//! SI in memory (m, Pa, s, rad); mm, MPa and mm/s at the edges only, always with the unit in the
//! name. Heights grow towards the rubber; the rubber slides in `+x` at speed `v > 0`; pressure is
//! positive in compression; a positive friction coefficient opposes the motion. Missing heights
//! are NaN and nothing else is.

pub mod artifact;
pub mod bench;
pub mod cli;
pub mod contact;
pub mod fem;
pub mod forecast;
pub mod multiscale;
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
pub mod theory;
