//! `asperity solve`: a single contact problem.
//!
//! | module | what it holds |
//! |---|---|
//! | `areal` | the steady sliding contact of a surface that is rough in both directions |
//! | `areal_shape` | the areal surface of a single problem: superposed sines or a map |
//! | `bem` | the steady sliding contact on the linear viscoelastic half-space |
//! | `error_estimate` | the error of a single solve, as it is printed |
//! | `fem` | sliding contact at finite deformation |
//! | `fem_output` | what `asperity solve fem` prints and writes |
//! | `heat` | the same as `bem`, with the heat that the contact makes |
//! | `map_file` | a height map of an instrument or of a text file |
//! | `material` | the rubber of a single problem |
//! | `profile_file` | a periodic profile in a text file of two columns |
//! | `resolution` | what `asperity solve fem` requires of a mesh, and its warnings about a coarse one |
//! | `shape` | the profile of a single problem: superposed sines or a file |
//! | `soft` | the same as `bem`, with the softening of the rubber by its strain |
//! | `thermal` | thermal constants and the time of sliding |

mod areal;
mod areal_shape;
mod bem;
mod error_estimate;
mod fem;
mod fem_output;
mod heat;
mod interface_options;
mod map_file;
mod material;
mod profile_file;
mod resolution;
mod shape;
mod soft;
mod thermal;

use std::path::Path;

use clap::Subcommand;

use super::CliError;
pub(super) use areal_shape::{Pair, cliff, mirrored, parse_size, require_surface};
pub(super) use map_file::{Map, read_map, read_map_with_gaps};
pub(super) use material::{Material, MaterialOptions};

#[derive(Debug, Subcommand)]
pub(super) enum Solve {
    Areal(Box<areal::Areal>),
    Bem(Box<bem::Bem>),
    Fem(Box<fem::Fem>),
    Heat(Box<heat::Heat>),
    Soft(Box<soft::Soft>),
}

impl Solve {
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        match self {
            Self::Areal(areal) => areal.run(quiet),
            Self::Bem(bem) => bem.run(quiet),
            Self::Fem(fem) => fem.run(quiet),
            Self::Heat(heat) => heat.run(quiet),
            Self::Soft(soft) => soft.run(quiet),
        }
    }
}

/// Refuses to overwrite an input.
///
/// # Errors
/// [`CliError::Input`] naming the option and the file.
pub(super) fn refuse_to_overwrite(
    output: Option<&Path>,
    option: &str,
    inputs: &[Option<&Path>],
) -> Result<(), CliError> {
    let Some(output) = output else { return Ok(()) };
    let same = |input: &Path| match (input.canonicalize(), output.canonicalize()) {
        (Ok(input), Ok(output)) => input == output,
        _ => false,
    };
    match inputs.iter().flatten().find(|input| same(input)) {
        Some(input) => Err(CliError::input(format!(
            "{option} would overwrite the input {}: choose another file",
            input.display()
        ))),
        None => Ok(()),
    }
}
