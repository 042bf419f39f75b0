//! The grid of labels `(s, Z)`: columns above fixed points of the profile, and rows of the undeformed block, with fewer
//! columns away from the contact.

use super::super::mesh::Element;
use super::BlockOptions;
use super::long::Value;
use std::borrow::Cow;

/// Height over width of the elements of a row above which the next rows have half as many columns.
const COARSEN: f64 = 4.0;
/// Fewest columns that are halved on: a row that is not has at least half as many.
const FEWEST_COLUMNS: usize = 64;

/// Weights of the cubic through four nodes at the middle between the second
/// and the third.
const HANGING: [f64; 4] = [-0.0625, 0.5625, 0.5625, -0.0625];

/// Rows of elements and of nodes.
///
/// The row of nodes above a row of elements belongs to the elements above it. Where those are twice
/// as wide, the elements below have a corner in the middle of each, which is tied to the nodes by the
/// cubic through four of them: straight lines there would have a strain that alternates from column
/// to column, and the branches would turn that into heat.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    /// Length of the period in m.
    pub period: f64,
    /// Heights in m of the rows of elements, from the contact upwards.
    pub row_heights: Vec<f64>,
    /// Heights Z in m of the rows of nodes.
    pub levels: Vec<f64>,
    /// Columns of the rows of elements.
    pub columns: Vec<usize>,
    /// First node of each row of nodes, and the number of nodes.
    first: Vec<usize>,
}

impl Grid {
    /// The grid of a block of one `period` in m.
    pub fn new(options: &BlockOptions, period: f64) -> Self {
        let mesh = options.mesh(period);
        let mut columns = vec![options.columns];
        for height in &mesh.row_heights[1..] {
            let below = columns[columns.len() - 1];
            let flat = *height > COARSEN * period / below as f64;
            let halved = options.coarsening
                && flat
                && below.is_multiple_of(2)
                && below / 2 >= FEWEST_COLUMNS;
            columns.push(if halved { below / 2 } else { below });
        }
        let mut first = vec![0];
        let mut nodes = 0;
        for count in columns.iter().chain(columns.last()) {
            nodes += count;
            first.push(nodes);
        }
        let levels = mesh.node_heights();
        Self { period, row_heights: mesh.row_heights, levels, columns, first }
    }

    /// Rows of elements.
    pub fn rows(&self) -> usize {
        self.row_heights.len()
    }

    /// Nodes of all rows.
    pub fn nodes(&self) -> usize {
        self.first[self.rows() + 1]
    }

    /// Positions of all nodes in m.
    pub fn coordinates(&self) -> Vec<[f64; 2]> {
        let row = |row: usize| {
            let (count, z) = (self.nodes_in(row), self.levels[row]);
            (0..count).map(move |j| [j as f64 * self.period / count as f64, z])
        };
        (0..=self.rows()).flat_map(row).collect()
    }

    /// First node of a row of nodes.
    pub fn first_node(&self, row: usize) -> usize {
        self.first[row]
    }

    /// Nodes in a row of nodes.
    pub fn nodes_in(&self, row: usize) -> usize {
        self.first[row + 1] - self.first[row]
    }

    /// Contact nodes.
    pub fn contact_nodes(&self) -> usize {
        self.columns[0]
    }

    /// Height of the block in m.
    pub fn height(&self) -> f64 {
        self.levels[self.rows()]
    }

    /// Width in m of the elements in a row.
    pub fn spacing(&self, row: usize) -> f64 {
        self.period / self.columns[row] as f64
    }

    /// Gradients and weights of the elements in a row.
    pub fn element(&self, row: usize) -> Element {
        Element::new(self.spacing(row), self.row_heights[row], 0.0)
    }

    /// Whether the elements above a row of elements are twice as wide.
    pub fn coarser_above(&self, row: usize) -> bool {
        self.nodes_in(row + 1) < self.columns[row]
    }

    /// The values `(x, z)` of a row of nodes in an array over the nodes.
    pub fn row<'a, T>(&self, nodes: &'a [T], row: usize) -> &'a [T] {
        &nodes[2 * self.first[row]..2 * self.first[row + 1]]
    }

    /// The values `(x, z)` at the upper corners of a row of elements, including tied ones.
    pub fn upper<'a, T: Value>(&self, nodes: &'a [T], row: usize) -> Cow<'a, [T]> {
        let above = self.row(nodes, row + 1);
        if !self.coarser_above(row) {
            return above.into();
        }
        let count = above.len() / 2;
        let mut corners = Vec::with_capacity(2 * above.len());
        for node in 0..count {
            corners.extend_from_slice(&above[2 * node..2 * node + 2]);
            for i in 0..2 {
                let own = above[2 * node + i];
                let from_own = masters(node, count)
                    .map(|(master, weight)| weight * above[2 * master + i].minus(own));
                corners.push(own.plus(from_own.iter().sum()));
            }
        }
        corners.into()
    }

    /// Adds forces at the lower and upper corners of a row of elements to those of the nodes.
    pub fn gather(&self, corners: &[Vec<f64>; 2], row: usize, nodes: &mut [f64]) {
        let rows = &mut nodes[2 * self.first[row]..2 * self.first[row + 2]];
        let (below, above) = rows.split_at_mut(2 * self.nodes_in(row));
        below.iter_mut().zip(&corners[0]).for_each(|(node, corner)| *node += corner);
        if !self.coarser_above(row) {
            above.iter_mut().zip(&corners[1]).for_each(|(node, corner)| *node += corner);
            return;
        }
        let count = above.len() / 2;
        for (node, pair) in corners[1].chunks_exact(4).enumerate() {
            for i in 0..2 {
                above[2 * node + i] += pair[i];
                for (master, weight) in masters(node, count) {
                    above[2 * master + i] += weight * pair[2 + i];
                }
            }
        }
    }
}

/// The nodes that the corner between a node and the next one is tied to, with their weights.
fn masters(node: usize, count: usize) -> [(usize, f64); 4] {
    [0, 1, 2, 3].map(|k| ((node + count + k - 1) % count, HANGING[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tied_corners_do_the_work_of_their_nodes() {
        let options = BlockOptions { coarsening: true, ..BlockOptions::new(512) };
        let grid = Grid::new(&options, 1.0);
        assert!(grid.columns[grid.rows() - 1] < 512 && grid.columns[grid.rows() - 1] >= 64);
        let values = |seed: f64, count: usize| -> Vec<f64> {
            (0..count).map(|i| (seed + 7.3 * i as f64).sin()).collect()
        };
        let nodes = values(0.3, 2 * grid.nodes());
        for row in 0..grid.rows() {
            let corners = 2 * grid.columns[row];
            let upper = grid.upper(&nodes, row);
            assert_eq!(upper.len(), corners);
            let forces = [values(0.1, corners), values(0.2, corners)];
            let mut gathered = vec![0.0; nodes.len()];
            grid.gather(&forces, row, &mut gathered);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let work = dot(&forces[0], grid.row(&nodes, row)) + dot(&forces[1], &upper);
            assert!((work - dot(&gathered, &nodes)).abs() < 1e-9);
        }
    }

    #[test]
    fn a_constant_stays_one_at_tied_corners() {
        let options = BlockOptions { coarsening: true, ..BlockOptions::new(256) };
        let grid = Grid::new(&options, 1.0);
        let nodes = vec![2.5; 2 * grid.nodes()];
        for row in 0..grid.rows() {
            assert!(grid.upper(&nodes, row).iter().all(|x| (x - 2.5).abs() < 1e-14));
        }
    }
}
