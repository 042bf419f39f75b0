//! Hysteretic rubber friction on asphalt, from profilometer scans to tables with an error bar.
//!
//! ```text
//! scans ─ ingest ─ characterise ─ approximate ─ realise ─ bem ─ micro ─ hybrid ─ tables
//! ```
//!
//! Nothing of the mechanics needs the pipeline or a file. Three programs in `examples/` show the ways in: one contact
//! problem (`one_contact`), a rubber of one's own (`custom_rubber`), results of a run in polars (`stage_results`).
//!
//! ```
//! use asperity::contact::SlidingContact;
//! use asperity::rubber::Rubber;
//! use asperity::surface::{Wave, wave};
//!
//! let period = 0.0625e-3;
//! let profile = wave::sample(&[Wave { wavelength: period, amplitude: 2e-6, phase: 0.0 }], period, 256);
//! let mut contact = SlidingContact::new(&Rubber::table_2_1(), 0.01, period, &profile)?; // 10 mm/s
//! let solution = contact.solve(2e5)?; // 0.2 MPa
//! assert!(solution.residual < 1e-10);
//! println!("{} at area {}", solution.friction_coefficient, solution.contact_area_fraction);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Mechanics and roughness**, numbers in, numbers out, a crate of their own (`crates/core`):
//!
//! | module | what it holds |
//! |---|---|
//! | [`surface`] | line scans, roughness parameters, correlation, spectra, superposed sines, realisations |
//! | [`rubber`] | generalised Maxwell model, its fit to measured moduli; here with its file |
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
//!
//! **Files and results**, the lowest first; each module imports from those above it in this table alone:
//!
//! | module | what it holds |
//! |---|---|
//! | [`files`] (`crates/files`) | files that a user gives: read whole, or refused with what to do |
//! | [`scans`] (`crates/scans`) | readers of instrument files and of measured sweeps: bytes in, numbers or error out |
//! | [`text`] | names that come from files, made harmless where they are printed |
//! | [`requirement`] | what the keys of a recipe must hold |
//! | [`plot`] | figures as descriptions, drawn all alike |
//! | [`artifact`] | Arrow, HDF5, manifests, digests, the store; nothing else knows these formats |
//! | [`stages`] | one file a stage: parameters, row types, one function |
//! | [`measurement`] | measured friction, and what a run has beside it |
//! | [`recipe`] | the TOML file that says what a run does |
//! | [`report`] | tables and figures for people |
//! | [`validation`] | measured friction beside what is computed for it |
//! | [`pipeline`] | the one function that wires the stages |
//! | [`sweep`] | the cases of a recipe, spread over many machines |
//! | [`schemas`] | JSON schemas of the recipe and of every file that asperity writes |
//! | [`forecast`] | models, grids, time and memory of a recipe before it runs |
//!
//! The command line is no part of the library: it is the binary, `src/main.rs` and `src/cli`.
//!
//! # Conventions
//! SI in memory (m, Pa, s, rad); mm, MPa and mm/s at the edges only, always with the unit in the
//! name. Heights grow towards the rubber; the rubber slides in `+x` at speed `v > 0`; pressure is
//! positive in compression; a positive friction coefficient opposes the motion. Missing heights
//! are NaN and nothing else is.

pub use asperity_core::{
    contact, error_kind, fem, heat, homogenisation, interface, multiscale, numerics, reference,
    surface, theory, water,
};
pub use asperity_files as files;
pub use asperity_scans as scans;

pub mod artifact;
pub mod cutoff;
pub mod forecast;
#[cfg(test)]
mod layers;
pub mod measurement;
pub mod pipeline;
pub mod plot;
pub mod recipe;
pub mod report;
pub mod requirement;
pub mod rubber;
pub mod schemas;
pub mod stages;
pub mod sweep;
pub mod text;
pub mod units;
pub mod validation;
