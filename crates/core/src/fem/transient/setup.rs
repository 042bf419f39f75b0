//! The block at rest.

use super::contact::{Contact, Multipliers};
use super::error::TransientError;
use super::options::positive;
use super::step::State;
use crate::fem::mesh::Mesh;
use crate::fem::profile::RigidProfile;

/// The block above the profile, its lowest weighted gap closed.
pub fn first_touch(mesh: &Mesh, profile: &RigidProfile, penalty: f64) -> State {
    let n = mesh.columns;
    let multipliers = Multipliers { values: vec![0.0; n], penalty };
    let contact = Contact::at(mesh, profile, &vec![0.0; 2 * n], &multipliers);
    let lift = -contact.gaps.iter().copied().fold(f64::INFINITY, f64::min);
    let nodes = [0.0, lift].repeat(n * (mesh.rows() + 1));
    State { nodes, multipliers }
}

/// Range of the heights of the profile, or the width of an element for a flat one.
pub fn height_range(profile: &RigidProfile, columns: usize) -> f64 {
    let heights = profile.sample(4 * columns);
    let most = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = heights.iter().copied().fold(f64::INFINITY, f64::min);
    if most > least { most - least } else { profile.period() / columns as f64 }
}

/// Checks the mesh and that its period is that of the profile.
///
/// # Errors
/// [`TransientError::OutOfRange`] and [`TransientError::PeriodMismatch`].
pub fn check_mesh(mesh: &Mesh, profile: &RigidProfile) -> Result<(), TransientError> {
    positive("the period of the mesh in m", mesh.period)?;
    positive("the height of the mesh in m", mesh.height())?;
    if mesh.columns < 3 {
        return Err(TransientError::OutOfRange {
            quantity: "the number of columns",
            value: mesh.columns as f64,
            range: "at least 3, so that a node has two neighbours",
        });
    }
    // Lengths written in decimals differ by round-off.
    if (mesh.period - profile.period()).abs() > 1e-12 * mesh.period {
        return Err(TransientError::PeriodMismatch {
            mesh: mesh.period,
            profile: profile.period(),
        });
    }
    Ok(())
}
