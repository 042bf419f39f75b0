//! Heights over a plane: maps as instruments deliver them, and what is done with them.
//!
//! | module | what it holds |
//! |---|---|
//! | [`mod@condition`] | faults, resampling, windows and form of a map, in one call |
//! | [`faults`], [`form`], [`gaps`] | spikes and jumped rows, polynomial surfaces, missing points to be filled |
//! | [`parameters`], [`functional`] | parameters of ISO 25178-2, those of the material ratio curve |
//! | [`correlation`] | height-difference correlation along directions, anisotropy |
//! | [`spectrum`] | two-dimensional power spectrum |
//! | [`error`] | maps that cannot be evaluated |
//! | [`periodic`] | a map as a periodic surface without short waves |
//! | [`phases`] | surfaces with the spectrum of a map or of lines, and other phases |

pub mod condition;
pub mod correlation;
pub mod error;
pub mod faults;
pub mod form;
pub mod functional;
pub mod gaps;
pub mod parameters;
pub mod periodic;
pub mod phases;
pub mod spectrum;

mod gradient;
mod lags;
mod transform;

#[cfg(test)]
mod reference;
#[cfg(test)]
mod test_maps;

pub use correlation::ArealCorrelation;
pub use error::ArealError;
pub use parameters::ArealParameters;
pub use periodic::{PeriodicMap, PeriodicMapError};
pub use spectrum::ArealSpectrum;

/// Heights on a grid of equal spacing along each direction.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    /// Name of the map (and of the window, after cutting), unique within a run.
    pub name: String,
    /// Points `[nx, ny]` along `x` and `y`.
    pub points: [usize; 2],
    /// Distances in m between neighbouring points along `x` and `y`.
    pub spacing: [f64; 2],
    /// Heights in m, growing towards the rubber, row by row: that of the point `(i, j)` at `x = i dx`, `y = j dy` is
    /// `heights[j * nx + i]`. NaN where missing.
    pub heights: Vec<f64>,
}

impl HeightMap {
    /// Lengths in m along `x` and `y`, points times spacing: every point stands for one cell.
    pub fn lengths(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.points[axis] as f64 * self.spacing[axis])
    }

    /// Number of missing heights.
    pub fn missing(&self) -> usize {
        self.heights.iter().filter(|z| z.is_nan()).count()
    }
}
