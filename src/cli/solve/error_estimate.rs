//! The error of a single solve, as it is printed.

use serde::Serialize;

use asperity::contact::refine::GridError;

/// Estimated absolute errors, those of the friction coefficient first. For a single solve at a given load,
/// those of realisations and interpolation are zero.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct ErrorEstimate {
    /// Of friction by the grid or mesh, from coarser ones.
    pub discretisation: f64,
    /// Of friction by interpolation between solves.
    pub interpolation: f64,
    /// Of friction by the number of realisations.
    pub statistical: f64,
    /// Their sum.
    pub total: f64,
    /// Of the contact area fraction by the grid or mesh.
    pub contact_area_fraction: f64,
}

impl ErrorEstimate {
    pub(super) fn of_grid(error: GridError) -> Self {
        Self {
            discretisation: error.friction_coefficient,
            interpolation: 0.0,
            statistical: 0.0,
            total: error.friction_coefficient,
            contact_area_fraction: error.contact_area_fraction,
        }
    }
}
