//! Cost of steady contacts in seconds of one thread of the reference machine.
//!
//! Costs are functions of the numbers of elements and pressures, not measured times, so that work is divided in the
//! same way on every machine. `multilevel` chooses its numbers of realisations by them: after a change here, raise the
//! revision of that stage.

use super::profile::RigidProfile;
use super::steady::has_many_scales;

/// Seconds of a pressure of a curve on 128 columns: three waves on 256 columns, five realisations at two speeds.
const SECONDS_PER_SOLVE: f64 = 0.2;
/// Seconds of a path that is sampled as densely as a microscale, for each MPa, on 128 columns: one wave of slope 1.0
/// to 18 and 26 MPa.
const SECONDS_PER_MPA: f64 = 0.33;
const REFERENCE_COLUMNS: f64 = 128.0;
/// Power of the columns with which the cost grows.
const GROWTH: f64 = 1.15;
/// Factor if the mesh of half the columns is solved too, for the error by the mesh.
const WITH_COARSER_MESH: f64 = 1.4;
/// Profiles of many scales, which grow and whose exact contact climbs from half the columns, that mesh included: eight
/// waves on 8192 columns at 10 and 50 mm/s.
const MANY_SCALES: f64 = 1.7;
/// Memory for a column of the mesh: 17 MB for 128, 37 MB for 256, 1.5 GB for 8192 of them.
const MEGABYTES_PER_COLUMN: f64 = 0.18;

/// The mesh of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshCost {
    /// Elements over the period.
    pub columns: usize,
    /// Whether the profile has so many scales that its contact is reached over coarser meshes.
    pub many_scales: bool,
    /// Whether the error by the mesh is estimated.
    pub mesh_error: bool,
}

impl MeshCost {
    /// The mesh of a profile with a number of columns.
    pub fn new(profile: &RigidProfile, columns: usize, mesh_error: bool) -> Self {
        Self { columns, many_scales: has_many_scales(profile), mesh_error }
    }

    /// Seconds for a number of pressures of a curve.
    pub fn seconds_of_solves(&self, solves: f64) -> f64 {
        SECONDS_PER_SOLVE * self.factor() * solves
    }

    /// Seconds for a microscale with all its samples up to a pressure in MPa.
    pub fn seconds_pressed_to(&self, most_pressure_mpa: f64) -> f64 {
        SECONDS_PER_MPA * self.factor() * most_pressure_mpa
    }

    /// Memory of a contact.
    pub fn megabytes(&self) -> f64 {
        MEGABYTES_PER_COLUMN * self.columns as f64
    }

    fn factor(&self) -> f64 {
        let meshes = match (self.many_scales, self.mesh_error) {
            (true, _) => MANY_SCALES,
            (false, true) => WITH_COARSER_MESH,
            (false, false) => 1.0,
        };
        meshes * (self.columns as f64 / REFERENCE_COLUMNS).powf(GROWTH)
    }
}

/// Approximate number of pressures for a curve over these area fractions: area is about proportional to pressure, and
/// one pressure is solved beyond either end.
pub fn solves_of_curve(area_fractions: &[f64], pressure_ratio: f64) -> f64 {
    let range = area_fractions[area_fractions.len() - 1] / area_fractions[0];
    range.ln() / pressure_ratio.ln() + 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coarser_mesh_of_many_scales_is_for_nothing() {
        let one = MeshCost { columns: 256, many_scales: false, mesh_error: false };
        let both = MeshCost { mesh_error: true, ..one };
        approx::assert_relative_eq!(
            both.seconds_of_solves(10.0),
            1.4 * one.seconds_of_solves(10.0),
            max_relative = 1e-12
        );
        let many = MeshCost { many_scales: true, ..one };
        let both = MeshCost { many_scales: true, ..both };
        assert_eq!(many.seconds_of_solves(10.0), both.seconds_of_solves(10.0));
        assert!(many.seconds_pressed_to(1.0) > one.seconds_pressed_to(1.0));
    }

    #[test]
    fn a_curve_of_areas_takes_as_many_pressures_as_their_ratio() {
        // From 0.01 to 0.1 at doubled pressures: 3.3 steps, and two ends.
        approx::assert_relative_eq!(solves_of_curve(&[0.01, 0.1], 2.0), 5.32, max_relative = 1e-3);
    }
}
