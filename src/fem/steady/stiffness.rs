//! The sparse matrix of the local tangents.

use super::block::Block;
use super::grid::Grid;
use super::local::Local;
use rayon::prelude::*;

/// A sparse matrix of 2 x 2 blocks, one a pair of nodes, by columns.
///
/// The scalar matrix by columns has block column `C` at `4 start[C]`: its two columns one after the
/// other, each with the two rows of the first block, of the second, and so on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pattern {
    /// First block of each block column, and the number of blocks.
    pub start: Vec<usize>,
    /// Ascending block rows of each block column.
    pub rows: Vec<u32>,
    /// The block of each pair of corners of each element, in the order of [`pairs`].
    places: Vec<u32>,
}

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
        if column % 2 == 0 {
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

impl Pattern {
    pub fn new(grid: &Grid) -> Self {
        let mut columns: Vec<Vec<u32>> = vec![Vec::new(); grid.nodes()];
        each_element(grid, |row, column| {
            pairs(&corners(grid, row, column), |_, [r, c], _| {
                if !columns[c].contains(&(r as u32)) {
                    columns[c].push(r as u32);
                }
            });
        });
        let (mut start, mut rows) = (vec![0], Vec::new());
        for column in &mut columns {
            column.sort_unstable();
            rows.extend_from_slice(column);
            start.push(rows.len());
        }
        let mut pattern = Self { start, rows, places: Vec::new() };
        let mut places = Vec::new();
        each_element(grid, |row, column| {
            pairs(&corners(grid, row, column), |_, [r, c], _| {
                places.push(pattern.place(r, c) as u32);
            });
        });
        pattern.places = places;
        pattern
    }

    /// Numbers of rows and columns of the scalar matrix.
    pub fn size(&self) -> usize {
        2 * (self.start.len() - 1)
    }

    /// The block of a pair of nodes, which must be coupled.
    fn place(&self, row: usize, column: usize) -> usize {
        let (start, end) = (self.start[column], self.start[column + 1]);
        let found = self.rows[start..end].partition_point(|r| (*r as usize) < row);
        start + found
    }

    /// Where the entry `(x, y)` of a block in a block column is.
    fn entry(&self, column: usize, block: usize, [x, y]: [usize; 2]) -> usize {
        let (start, end) = (self.start[column], self.start[column + 1]);
        4 * start + 2 * y * (end - start) + 2 * (block - start) + x
    }

    /// The matrix of the block's local tangents, x and z of a node together.
    pub fn assemble(&self, block: &Block) -> Vec<f64> {
        let grid = &block.grid;
        let mut values = vec![0.0; 4 * self.rows.len()];
        let mut places = self.places.iter();
        for (r, row) in block.rows().iter().enumerate() {
            let depth = 0.5 * (grid.levels[r] + grid.levels[r + 1]);
            let columns = (0..row.columns).into_par_iter().with_min_len(32);
            let locals: Vec<Local> =
                columns.map(|column| row.local(&block.material, depth, column)).collect();
            for (column, local) in locals.iter().enumerate() {
                pairs(&corners(grid, r, column), |[i, j], [_, c], weight| {
                    let Some(place) = places.next() else { return };
                    for x in 0..2 {
                        for y in 0..2 {
                            values[self.entry(c, *place as usize, [x, y])] +=
                                weight * local[2 * i + x][2 * j + y];
                        }
                    }
                });
            }
        }
        values
    }

    /// Multiplies the column of the z unknown of a node.
    pub fn scale_z(&self, values: &mut [f64], node: usize, factor: f64) {
        let (start, end) = (self.start[node], self.start[node + 1]);
        let column = 4 * start + 2 * (end - start)..4 * end;
        values[column].iter_mut().for_each(|value| *value *= factor);
    }

    /// Adds to the rows of a node in the column of its z unknown.
    pub fn add_z(&self, values: &mut [f64], node: usize, added: [f64; 2]) {
        let block = self.place(node, node);
        for (x, added) in added.into_iter().enumerate() {
            values[self.entry(node, block, [x, 1])] += added;
        }
    }

    /// Puts an equation for x alone, with the given diagonal, in place of those of the nodes from
    /// `first` on.
    pub fn fix_x(&self, values: &mut [f64], first: usize, diagonal: f64) {
        for column in 0..self.start.len() - 1 {
            for block in self.start[column]..self.start[column + 1] {
                let row = self.rows[block] as usize;
                if row >= first {
                    (0..2).for_each(|y| values[self.entry(column, block, [0, y])] = 0.0);
                }
                if column >= first {
                    (0..2).for_each(|x| values[self.entry(column, block, [x, 0])] = 0.0);
                }
                if row == column && row >= first {
                    values[self.entry(column, block, [0, 0])] = diagonal;
                }
            }
        }
    }

    /// The product of a matrix with a vector.
    #[cfg(test)]
    pub fn multiply(&self, values: &[f64], vector: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; vector.len()];
        for column in 0..self.start.len() - 1 {
            for block in self.start[column]..self.start[column + 1] {
                let row = self.rows[block] as usize;
                for (x, y) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let entry = values[self.entry(column, block, [x, y])];
                    product[2 * row + x] += entry * vector[2 * column + y];
                }
            }
        }
        product
    }
}
