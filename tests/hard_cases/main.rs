//! The cases that break contact codes and fits: each is solved to the full residual or refused with
//! a reason, and each has a second route that shares nothing with the first.
//!
//! Every test has its rows in the table of `docs/hard_cases.md`, whose head says how they get there.

mod case;
mod closing;
mod document;
mod finite_deformation;
mod flat_parts;
mod grids;
mod incompressible;
#[path = "../verification/lemke.rs"]
mod lemke;
mod rubbers;
mod scales;
mod small_contacts;
#[path = "../verification/surfaces.rs"]
#[allow(dead_code)]
mod surfaces;
mod wave_fits;
