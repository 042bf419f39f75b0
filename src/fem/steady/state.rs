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
    /// An undeformed block above the profile under a small `pressure` in Pa, as high as the
    /// `barrier` in m carries it: `Σ_j barrier / gap_j = N`.
    pub fn above(mesh: &Mesh, profile: &RigidProfile, pressure: f64, barrier: f64) -> Self {
        let heights = profile.sample(mesh.columns);
        let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let carried = |clearance: f64| {
            heights.iter().map(|z| barrier / (highest - z + clearance)).sum::<f64>()
        };
        // The highest node alone carries at least its share, all together no more than that.
        let wanted = mesh.columns as f64;
        let (mut low, mut high) = (barrier / wanted, barrier);
        while high / low > 1.0 + 1e-12 {
            let middle = (low * high).sqrt();
            if carried(middle) > wanted { low = middle } else { high = middle }
        }
        let lift = highest + high;
        let mut displacements = vec![0.0; 2 * mesh.columns * (mesh.rows() + 1)];
        displacements.iter_mut().skip(1).step_by(2).for_each(|z| *z = lift);
        let gaps: Vec<f64> = heights.iter().map(|z| lift - z).collect();
        let force = barrier * pressure * mesh.spacing();
        let forces = gaps.iter().map(|gap| force / gap).collect();
        Self { displacements, forces, gaps }
    }

    /// Mean shear of the block: the displacement of the upper edge over its height.
    pub fn shear(&self, mesh: &Mesh) -> f64 {
        self.displacements[2 * mesh.columns * mesh.rows()] / mesh.height()
    }
}

/// Heights of the profile in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Heights {
    pub mean: f64,
    /// Mean peak to valley over pieces as long as the shortest wave: the scale of gaps next to a
    /// contact. For a flat profile a small length in its place.
    pub roughness: f64,
}

impl Heights {
    pub fn of(profile: &RigidProfile, points: usize) -> Self {
        let heights = profile.sample(points);
        let mean = heights.iter().sum::<f64>() / points as f64;
        let pieces = profile.shortest_waves();
        let piece = (points as f64 / pieces).ceil() as usize;
        let ranges = heights.chunks(piece).map(|piece| {
            let extremes = piece
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), z| (a.min(*z), b.max(*z)));
            extremes.1 - extremes.0
        });
        let roughness = ranges.sum::<f64>() / pieces;
        Self { mean, roughness: roughness.max(1e-6 * profile.period() / pieces) }
    }
}
