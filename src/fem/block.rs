//! The block of rubber: internal forces of all rows, their tangent, and the unknowns.

use super::mesh::Mesh;
use super::row::{Inverted, Material, Row};
use rayon::prelude::*;

/// The steady block: congruent elements in graded rows.
///
/// Displacements and forces are arrays over the nodes, row after row from the contact upwards,
/// `(x, z)` of each node together: `2 N (rows + 1)` numbers.
#[derive(Debug, Clone)]
pub struct Block {
    mesh: Mesh,
    material: Material,
    rows: Vec<Row>,
}

impl Block {
    /// The undeformed block.
    pub fn new(mesh: Mesh, material: Material) -> Self {
        let rows = (0..mesh.rows())
            .map(|row| Row::new(mesh.element(row), mesh.columns, material.filters.len()))
            .collect();
        Self { mesh, material, rows }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The rubber with its memory.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// The rows of elements, from the contact upwards.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Numbers in a row of nodes.
    pub fn row_len(&self) -> usize {
        2 * self.mesh.columns
    }

    /// Takes over displacements in m and returns the internal forces in N/m.
    ///
    /// # Errors
    /// [`Inverted`].
    pub fn deform(&mut self, displacements: &[f64]) -> Result<Vec<f64>, Inverted> {
        let row_len = self.row_len();
        let material = &self.material;
        let parts: Result<Vec<_>, Inverted> = self
            .rows
            .par_iter_mut()
            .enumerate()
            .map(|(r, row)| {
                let mut below = vec![0.0; row_len];
                let mut above = vec![0.0; row_len];
                let nodes = neighbours(displacements, r, row_len);
                row.deform(material, nodes, [&mut below, &mut above])?;
                Ok((below, above))
            })
            .collect();
        Ok(gather(&parts?, row_len))
    }

    /// Power in W/m that the branches turn into heat at displacements of the block.
    pub fn dissipation(&self, displacements: &[f64]) -> f64 {
        let row_len = self.row_len();
        let rows = self.rows.par_iter().enumerate();
        // In the order of the rows, whatever the number of threads.
        let powers: Vec<f64> = rows
            .map(|(r, row)| row.dissipation(&self.material, neighbours(displacements, r, row_len)))
            .collect();
        powers.iter().sum()
    }

    /// Change of the internal forces for a change of the displacements.
    pub fn tangent(&self, changes: &[f64]) -> Vec<f64> {
        let row_len = self.row_len();
        let parts: Vec<_> = self
            .rows
            .par_iter()
            .enumerate()
            .map(|(r, row)| {
                let mut below = vec![0.0; row_len];
                let mut above = vec![0.0; row_len];
                let nodes = neighbours(changes, r, row_len);
                row.tangent(&self.material, nodes, [&mut below, &mut above]);
                (below, above)
            })
            .collect();
        gather(&parts, row_len)
    }
}

/// The rows of nodes below and above a row of elements.
fn neighbours(nodes: &[f64], row: usize, row_len: usize) -> [&[f64]; 2] {
    let (below, above) = nodes[row * row_len..(row + 2) * row_len].split_at(row_len);
    [below, above]
}

/// Adds up what the rows of elements contribute to the rows of nodes.
fn gather(parts: &[(Vec<f64>, Vec<f64>)], row_len: usize) -> Vec<f64> {
    let mut forces = vec![0.0; row_len * (parts.len() + 1)];
    for (r, (below, above)) in parts.iter().enumerate() {
        let rows = &mut forces[r * row_len..(r + 2) * row_len];
        for (force, part) in rows.iter_mut().zip(below.iter().chain(above)) {
            *force += part;
        }
    }
    forces
}
