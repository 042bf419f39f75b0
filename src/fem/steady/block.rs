//! The block of rubber: internal forces of all rows and their tangent.

use super::Inverted;
use super::grid::Grid;
use super::row::{Material, Row, Validity};
use rayon::prelude::*;
use std::borrow::Cow;

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
            .map(|row| Row::new(grid.element(row), grid.columns[row], grid.period, &material))
            .collect();
        Self { grid, material, rows }
    }

    /// The rows of elements, from the contact upwards.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Takes over displacements in m and returns the internal forces in N/m.
    ///
    /// # Errors
    /// [`Inverted`].
    pub fn deform(&mut self, displacements: &[f64]) -> Result<(Vec<f64>, Validity), Inverted> {
        let (grid, material) = (&self.grid, &self.material);
        let parts: Result<Vec<_>, Inverted> = self
            .rows
            .par_iter_mut()
            .enumerate()
            .map(|(r, row)| {
                row.deform(material, corners(grid, displacements, r).each_ref().map(|c| &**c))
            })
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
        let parts: Vec<_> = rows
            .map(|(r, row)| {
                row.tangent(material, corners(grid, changes, r).each_ref().map(|c| &**c))
            })
            .collect();
        let mut forces = vec![0.0; changes.len()];
        for (row, part) in parts.iter().enumerate() {
            grid.gather(part, row, &mut forces);
        }
        forces
    }

    /// Power in W/m that the branches turn into heat at the displacements taken over last.
    pub fn dissipation(&self, displacements: &[f64]) -> f64 {
        let (grid, material) = (&self.grid, &self.material);
        let rows = self.rows.par_iter().enumerate();
        // In the order of the rows, whatever the number of threads.
        let powers: Vec<f64> = rows
            .map(|(r, row)| {
                let corners = corners(grid, displacements, r);
                row.dissipation(material, corners.each_ref().map(|c| &**c))
            })
            .collect();
        powers.iter().sum()
    }
}

/// Values at the lower and upper corners of a row of elements.
fn corners<'a>(grid: &Grid, nodes: &'a [f64], row: usize) -> [Cow<'a, [f64]>; 2] {
    [grid.row(nodes, row).into(), grid.upper(nodes, row)]
}
