//! What was measured beside the scans, friction and spectra, and what a run has beside measured friction.
//!
//! | module | what it holds |
//! |---|---|
//! | `beside` | what is computed beside every measurement |
//! | `file` | measured friction over speed as a table of text |
//! | `spectrum` | a power spectrum as a table of text |
//! | `run` | hysteretic friction and contact area of a run, over the speed at one pressure |

mod beside;
mod file;
mod run;
mod spectrum;

pub use beside::{Beside, BesideError, TemperatureError, Temperatures, beside};
pub(crate) use file::LARGEST_MPA;
pub use file::{MeasuredFile, MeasuredFileError, MeasuredPoint, read_measured};
pub use run::{Available, Choice, Computed, ComputedAt, ComputedError};
pub use spectrum::{
    Conventions, DensityUnit, FoundSpectrum, Sides, WavenumberUnit, density_unit, read_spectrum,
    wavenumber_unit,
};
