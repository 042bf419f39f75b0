//! Equilibration, so that the entries fit single precision and small pivots can be compared.

use super::pattern::{Block, BlockPattern};

/// Factors `r`, `c` by which `diag(r) A diag(c)` has no entry above 1, and a 1 in every column.
#[derive(Debug, Default)]
pub(super) struct Scaling {
    pub rows: Vec<f64>,
    pub columns: Vec<f64>,
}

impl Scaling {
    /// Divides rows, then columns, by their largest entries. A row or column of zeros keeps 1:
    /// its pivot is zero.
    pub fn update(&mut self, pattern: &BlockPattern, values: &[Block]) {
        let unknowns = 2 * pattern.nodes();
        for largest in [&mut self.rows, &mut self.columns] {
            largest.clear();
            largest.resize(unknowns, 0.0);
        }
        let (rows, columns) = (&mut self.rows, &mut self.columns);
        for (row, block) in entries(pattern, values).map(|(row, _, block)| (row, block)) {
            for (i, line) in block.iter().enumerate() {
                let r = &mut rows[2 * row + i];
                *r = line.iter().fold(*r, |m, x| x.abs().max(m));
            }
        }
        invert(rows);
        for (row, column, block) in entries(pattern, values) {
            for (i, line) in block.iter().enumerate() {
                for (j, x) in line.iter().enumerate() {
                    let c = &mut columns[2 * column + j];
                    *c = c.max(x.abs() * rows[2 * row + i]);
                }
            }
        }
        invert(columns);
    }
}

fn entries<'a>(
    pattern: &'a BlockPattern,
    values: &'a [Block],
) -> impl Iterator<Item = (usize, usize, &'a Block)> {
    (0..pattern.nodes()).flat_map(move |row| {
        let columns = pattern.row(row).iter().map(|&column| column as usize);
        columns.zip(&values[pattern.start(row)..]).map(move |(column, block)| (row, column, block))
    })
}

fn invert(largest: &mut [f64]) {
    for x in largest {
        *x = if *x > 0.0 { x.recip() } else { 1.0 };
    }
}
