//! The block of rubber: internal forces of all rows and their tangent.

use super::Inverted;
use super::grid::Grid;
use super::long::{Long, Value};
use super::row::{Differences, Material, Row, Validity};
use rayon::prelude::*;

/// The block on a grid. Displacements and forces are arrays over the nodes, row after row from the
/// contact upwards, `(x, z)` of each node together.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub grid: Grid,
    pub material: Material,
    rows: Vec<Row>,
}

impl Block {
    pub fn new(grid: Grid, material: Material) -> Self {
        let rows = (0..grid.rows())
            .map(|row| {
                let size = [grid.period, grid.row_heights[row]];
                Row::new(grid.element(row), grid.columns[row], size, &material)
            })
            .collect();
        Self { grid, material, rows }
    }

    /// The rows of elements, from the contact upwards.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Sets displacements in m and returns the internal forces in N/m.
    ///
    /// # Errors
    /// [`Inverted`].
    pub fn deform(&mut self, displacements: &[Long]) -> Result<(Vec<f64>, Validity), Inverted> {
        let (grid, material) = (&self.grid, &self.material);
        let parts: Result<Vec<_>, Inverted> = self
            .rows
            .par_iter_mut()
            .enumerate()
            .map(|(r, row)| row.deform(material, &differences(grid, displacements, r)))
            .collect();
        let mut forces = vec![0.0; displacements.len()];
        let mut validity = Validity::BEST;
        for (row, (part, valid)) in parts?.iter().enumerate() {
            grid.gather(part, row, &mut forces);
            validity = validity.and(*valid);
        }
        Ok((forces, validity))
    }

    /// Change of the internal forces for a change of the displacements.
    pub fn tangent(&self, changes: &[f64]) -> Vec<f64> {
        let (grid, material) = (&self.grid, &self.material);
        let rows = self.rows.par_iter().enumerate();
        let parts: Vec<_> =
            rows.map(|(r, row)| row.tangent(material, &differences(grid, changes, r))).collect();
        let mut forces = vec![0.0; changes.len()];
        for (row, part) in parts.iter().enumerate() {
            grid.gather(part, row, &mut forces);
        }
        forces
    }

    /// Power in W/m that the branches turn into heat at the last displacements.
    pub fn dissipation(&self, displacements: &[Long]) -> f64 {
        let (grid, material) = (&self.grid, &self.material);
        let rows = self.rows.par_iter().enumerate();
        // In the order of the rows, whatever the number of threads.
        let powers: Vec<f64> = rows
            .map(|(r, row)| row.dissipation(material, &differences(grid, displacements, r)))
            .collect();
        powers.iter().sum()
    }

    /// Largest `I1 - 3` of a spring at the last displacements; `None` under the linear law.
    pub fn largest_invariant(&self, displacements: &[Long]) -> Option<f64> {
        let (grid, material) = (&self.grid, &self.material);
        let rows = self.rows.par_iter().enumerate();
        let largest: Option<Vec<f64>> = rows
            .map(|(r, row)| row.largest_invariant(material, &differences(grid, displacements, r)))
            .collect();
        Some(largest?.into_iter().fold(0.0, f64::max))
    }
}

/// Differences between the corners of a row of elements.
fn differences<T: Value>(grid: &Grid, nodes: &[T], row: usize) -> Differences {
    Differences::new(grid.row(nodes, row), &grid.upper(nodes, row))
}
