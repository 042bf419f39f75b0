//! A rigid plate on the upper edge of the block.
//!
//! Without it the edge carries an even pressure and its nodes move up and down each by itself (traction given); under the
//! plate they move up and down together (displacement given), and the pressure is the mean. Neighbouring nodes are tied by
//! springs so stiff that the edge bends by a thousandth or less of what it would.

use super::grid::Grid;
#[cfg(test)]
use super::level::Level;
use super::long::Value;
use crate::numerics::direct::{Block, BlockPattern};

/// Stiffness of the springs over that of the block's longest wave.
const STIFFNESS: f64 = 1e4;

/// Springs between the nodes of the upper edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plate {
    first: usize,
    nodes: usize,
    /// In Pa, force per length over displacement.
    stiffness: f64,
}

impl Plate {
    /// The plate on a block whose rubber has the modulus in Pa.
    pub fn new(grid: &Grid, modulus: f64) -> Self {
        let first = grid.first_node(grid.rows());
        let nodes = grid.nodes() - first;
        // The longest wave bends n springs by 2 pi / n each.
        Self { first, nodes, stiffness: STIFFNESS * modulus * nodes as f64 }
    }

    /// Adds the forces of the springs at displacements of all nodes, `(x, z)` of each together.
    pub fn add<T: Value>(&self, displacements: &[T], forces: &mut [f64]) {
        let at = |j: usize| displacements[2 * (self.first + j % self.nodes) + 1];
        for j in 0..self.nodes {
            let bent = at(j).minus(at(j + 1)) + at(j).minus(at(j + self.nodes - 1));
            forces[2 * (self.first + j) + 1] += self.stiffness * bent;
        }
    }

    /// Adds their derivatives to a sparse matrix.
    pub fn add_to(&self, pattern: &BlockPattern, values: &mut [Block]) {
        let node = |j: usize| self.first + j % self.nodes;
        for j in 0..self.nodes {
            let couplings =
                [(j, 2.0), (j + 1, -1.0), (j + self.nodes - 1, -1.0)].map(|(k, c)| (node(k), c));
            for (column, share) in couplings {
                if let Some(position) = pattern.position(node(j), column) {
                    values[position][1][1] += share * self.stiffness;
                }
            }
        }
    }
}

#[cfg(test)]
impl Level {
    /// Largest difference in height in m of two nodes of the upper edge.
    pub fn unevenness(&self, state: &super::state::State) -> f64 {
        let z = state.displacements[self.upper_edge()].iter().skip(1).step_by(2);
        let heights: Vec<f64> = z.map(|z| z.value()).collect();
        let (low, high) = heights
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), z| (a.min(*z), b.max(*z)));
        high - low
    }
}
