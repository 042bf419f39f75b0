//! The sparse matrix of the local tangents.

use super::block::Block;
use super::grid::Grid;
use super::local::Local;
use crate::numerics::direct::{self, BlockPattern};
use rayon::prelude::*;

/// Positions of the local tangents of the elements in a sparse matrix with one block for each pair of nodes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Positions(Vec<u32>);

/// A corner of an element or of the one before: one node, or the middle between two.
///
/// The corner between two nodes of a coarser row is tied to four by a cubic; here the nearest two do.
struct Corner([(usize, f64); 2]);

impl Corner {
    fn nodes(&self) -> impl Iterator<Item = (usize, f64)> {
        self.0.into_iter().filter(|(_, weight)| *weight != 0.0)
    }
}

/// The four corners of an element, then the left ones of the element before.
fn corners(grid: &Grid, row: usize, column: usize) -> [Corner; 6] {
    let columns = grid.columns[row];
    let (right, left) = ((column + 1) % columns, (column + columns - 1) % columns);
    let lower = |column: usize| Corner([(grid.first_node(row) + column, 1.0), (0, 0.0)]);
    let upper = |column: usize| {
        let first = grid.first_node(row + 1);
        if !grid.coarser_above(row) {
            return Corner([(first + column, 1.0), (0, 0.0)]);
        }
        let (node, count) = (column / 2, columns / 2);
        if column.is_multiple_of(2) {
            Corner([(first + node, 1.0), (0, 0.0)])
        } else {
            Corner([(first + node, 0.5), (first + (node + 1) % count, 0.5)])
        }
    };
    [lower(column), lower(right), upper(column), upper(right), lower(left), upper(left)]
}

/// Corners of the row and of the column with their nodes and the product of their weights.
fn pairs(corners: &[Corner; 6], mut visit: impl FnMut([usize; 2], [usize; 2], f64)) {
    for (i, row) in corners[..4].iter().enumerate() {
        for (j, column) in corners.iter().enumerate() {
            for (r, a) in row.nodes() {
                for (c, b) in column.nodes() {
                    visit([i, j], [r, c], a * b);
                }
            }
        }
    }
}

fn each_element(grid: &Grid, mut visit: impl FnMut(usize, usize)) {
    for row in 0..grid.rows() {
        for column in 0..grid.columns[row] {
            visit(row, column);
        }
    }
}

/// The pairs of nodes that are coupled.
pub(super) fn pattern(grid: &Grid) -> BlockPattern {
    let mut couplings = Vec::new();
    each_element(grid, |row, column| {
        pairs(&corners(grid, row, column), |_, [r, c], _| couplings.push((r as u32, c as u32)));
    });
    BlockPattern::from_couplings(grid.nodes(), &couplings)
}

impl Positions {
    pub fn new(grid: &Grid, pattern: &BlockPattern) -> Self {
        let mut positions = Vec::new();
        each_element(grid, |row, column| {
            pairs(&corners(grid, row, column), |_, [r, c], _| {
                let position = pattern.position(r, c).expect("the pattern is made of these pairs");
                positions.push(position as u32);
            });
        });
        Self(positions)
    }

    /// The matrix of the block's local tangents, x and z of a node together.
    pub fn assemble(&self, block: &Block, pattern: &BlockPattern) -> Vec<direct::Block> {
        let grid = &block.grid;
        let mut values = vec![[[0.0; 2]; 2]; pattern.blocks()];
        let mut positions = self.0.iter();
        for (r, row) in block.rows().iter().enumerate() {
            let depth = 0.5 * (grid.levels[r] + grid.levels[r + 1]);
            let columns = (0..row.columns).into_par_iter().with_min_len(32);
            let locals: Vec<Local> =
                columns.map(|column| row.local(&block.material, depth, column)).collect();
            for (column, local) in locals.iter().enumerate() {
                pairs(&corners(grid, r, column), |[i, j], _, weight| {
                    let Some(position) = positions.next() else { return };
                    let value = &mut values[*position as usize];
                    for x in 0..2 {
                        for y in 0..2 {
                            value[x][y] += weight * local[2 * i + x][2 * j + y];
                        }
                    }
                });
            }
        }
        values
    }
}

/// Replaces the z displacements of the lowest nodes by the contact unknowns: multiplies their columns
/// by the first factor and adds the other two to x and z of the node's own rows.
pub(super) fn touch(pattern: &BlockPattern, values: &mut [direct::Block], nodes: &[[f64; 3]]) {
    for row in 0..pattern.nodes() {
        for (position, column) in (pattern.start(row)..).zip(pattern.row(row)) {
            let Some([gap, along, up]) = nodes.get(*column as usize) else { continue };
            let value = &mut values[position];
            value[0][1] *= gap;
            value[1][1] *= gap;
            if *column as usize == row {
                value[0][1] += along;
                value[1][1] += up;
            }
        }
    }
}

/// Replaces the equations of the nodes from `first` on by one for x alone, with the given diagonal.
pub(super) fn fix_x(
    pattern: &BlockPattern,
    values: &mut [direct::Block],
    first: usize,
    diagonal: f64,
) {
    for row in 0..pattern.nodes() {
        for (position, column) in (pattern.start(row)..).zip(pattern.row(row)) {
            let (column, value) = (*column as usize, &mut values[position]);
            if row >= first {
                value[0] = [0.0; 2];
            }
            if column >= first {
                value[0][0] = 0.0;
                value[1][0] = 0.0;
            }
            if row == column && row >= first {
                value[0][0] = diagonal;
            }
        }
    }
}
