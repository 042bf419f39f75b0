//! `asperity theory`: what older theories predict, without a contact being solved.
//!
//! | module | what it holds |
//! |---|---|
//! | `flash` | the heat of the rubber |
//! | `persson` | Persson's theory on an isotropic surface |
//! | `predictions` | its predictions as a table, as CSV and as JSON |
//! | `surface` | the isotropic surface: of a spectrum, a scan or a map |

mod flash;
mod persson;
mod predictions;
mod surface;

use super::CliError;
use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(super) enum Theory {
    Persson(Box<persson::PerssonCommand>),
}

impl Theory {
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        match self {
            Self::Persson(persson) => persson.run(quiet),
        }
    }
}
