//! The unknown fields of the steady problem.

use super::super::profile::RigidProfile;
use super::grid::Grid;
use super::long::Long;

/// A block over the profile at one pressure.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    /// Displacements in m of all nodes, `(x, z)` of each together; z of a contact node follows from
    /// its gap.
    pub displacements: Vec<Long>,
    /// The unknown τ in m of each contact node.
    pub contact: Vec<Long>,
    /// Mean pressure in Pa.
    pub pressure: f64,
}

impl State {
    /// Whether the nodes touch the profile, without a barrier.
    pub fn touching(&self) -> Vec<bool> {
        self.contact.iter().map(|tau| tau.value() > 0.0).collect()
    }

    /// Mean shear of the block: the displacement of the upper edge against the contact, over the
    /// height.
    pub fn shear(&self, grid: &Grid) -> f64 {
        let contact = grid.row(&self.displacements, 0);
        let mean =
            contact.iter().step_by(2).map(|q| q.value()).sum::<f64>() / grid.contact_nodes() as f64;
        -mean / grid.height()
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
    pub fn new(profile: &RigidProfile, points: usize) -> Self {
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
