//! The error of a single solve, as it is printed.

use serde::Serialize;

use crate::cli::CliError;
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

/// An estimated error as it is printed.
pub(super) fn printed(
    estimate: Option<&ErrorEstimate>,
    error: fn(&ErrorEstimate) -> f64,
) -> String {
    estimate.map_or_else(|| "unknown".into(), |estimate| format!("{:.1e}", error(estimate)))
}

/// Refuses results that are not finite: lengths or moduli far from those of any road overflow.
///
/// # Errors
/// [`CliError::Failure`].
pub(super) fn require_finite(results: &[f64]) -> Result<(), CliError> {
    if results.iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    Err(CliError::failure(
        "the result is not finite: lengths, moduli or pressure are too large or too small for double precision; check their \
         units",
    ))
}
