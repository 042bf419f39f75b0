//! `asperity theory`: what older theories predict, without a contact being solved.
//!
//! | module | what it holds |
//! |---|---|
//! | `flash` | the heat of the rubber |
//! | `persson` | Persson's theory on an isotropic surface |
//! | `predictions` | its predictions as a table, as CSV and as JSON |
//! | `slider` | a hard cylinder or triangle on lubricated rubber |
//! | `surface` | the isotropic surface: of a spectrum, a scan or a map |

mod flash;
mod persson;
mod predictions;
mod slider;
mod surface;

use super::CliError;
use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(super) enum Theory {
    Persson(Box<persson::PerssonCommand>),
    Slider(Box<slider::SliderCommand>),
}

impl Theory {
    pub(super) fn run(self, quiet: bool) -> Result<(), CliError> {
        match self {
            Self::Persson(persson) => persson.run(quiet),
            Self::Slider(slider) => slider.run(quiet),
        }
    }
}
