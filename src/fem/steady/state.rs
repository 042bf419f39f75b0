//! The unknown fields of the steady problem.

use super::super::mesh::Mesh;
use super::super::profile::RigidProfile;

/// Displacements of the nodes, forces and gaps of the contact nodes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    /// Displacements in m, as [`crate::fem::block::Block`] has them.
    pub displacements: Vec<f64>,
    /// Vertical contact force in N/m on each contact node, not negative.
    pub forces: Vec<f64>,
    /// Vertical gap in m under each contact node, not negative.
    pub gaps: Vec<f64>,
}

impl State {
    /// An undeformed block just above the profile under a small `pressure` in Pa.
    pub fn above(mesh: &Mesh, profile: &RigidProfile, heights: &Heights, pressure: f64) -> Self {
        let lift = heights.highest + 0.1 * heights.range;
        let mut displacements = vec![0.0; 2 * mesh.columns * (mesh.rows() + 1)];
        displacements.iter_mut().skip(1).step_by(2).for_each(|z| *z = lift);
        let gaps: Vec<f64> = profile.sample(mesh.columns).iter().map(|z| lift - z).collect();
        let inverse = gaps.iter().map(|gap| 1.0 / gap).sum::<f64>();
        // Forces for which the product with the gap is the same everywhere.
        let forces = gaps.iter().map(|gap| pressure * mesh.period / (gap * inverse)).collect();
        Self { displacements, forces, gaps }
    }

    /// Mean shear of the block: the displacement of the upper edge over its height.
    pub fn shear(&self, mesh: &Mesh) -> f64 {
        self.displacements[2 * mesh.columns * mesh.rows()] / mesh.height()
    }
}

/// Extremes of the profile in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Heights {
    pub highest: f64,
    /// Peak to valley; for a flat profile a small length in its place.
    pub range: f64,
    pub mean: f64,
}

impl Heights {
    pub fn of(profile: &RigidProfile, points: usize) -> Self {
        let heights = profile.sample(points);
        let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let mean = heights.iter().sum::<f64>() / points as f64;
        // Gaps and their errors are measured in this.
        let range = (highest - lowest).max(1e-6 * profile.period());
        Self { highest, range, mean }
    }
}
