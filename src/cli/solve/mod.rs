//! `asperity solve`: a single contact problem.

mod bem;
mod profile_file;
mod shape;

use clap::Subcommand;

use super::CliError;

#[derive(Debug, Subcommand)]
pub(super) enum Solve {
    Bem(Box<bem::Bem>),
}

impl Solve {
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        match self {
            Self::Bem(bem) => bem.run(quiet),
        }
    }
}
