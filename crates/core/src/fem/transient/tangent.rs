//! The tangent of block and contact as a sparse matrix with a fixed pattern.

use super::block::{Linearised, TransientBlock};
use super::contact::Contact;
use super::error::TransientError;
use crate::fem::unknowns::Unknowns;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};

/// The pattern and its elimination, made once for a mesh.
///
/// The unknowns are those of [`Unknowns`] without the common displacement of the upper edge,
/// which is prescribed.
pub struct Tangent {
    unknowns: Unknowns,
    symbolic: SymbolicSparseColMat<usize>,
    argsort: Argsort<usize>,
    symbolic_lu: SymbolicLu<usize>,
}

impl Tangent {
    /// The pattern of a block in contact.
    ///
    /// # Errors
    /// [`TransientError::TooLarge`].
    pub fn new(block: &TransientBlock) -> Result<Self, TransientError> {
        let mesh = block.mesh();
        let unknowns = Unknowns { columns: mesh.columns, rows: mesh.rows() };
        let mut pairs = Vec::new();
        for index in 0..mesh.columns * mesh.rows() {
            let dofs = block.dofs(index).map(|dof| unknowns.index_of(dof));
            pairs.extend(entries(&dofs).map(|(row, col, _, _)| Pair { row, col }));
        }
        for node in 0..mesh.columns {
            let dofs = Contact::dofs(mesh.columns, node);
            pairs.extend(entries(&dofs.map(Some)).map(|(row, col, _, _)| Pair { row, col }));
            let dofs = edge_dofs(&dofs);
            pairs.extend(entries(&dofs).map(|(row, col, _, _)| Pair { row, col }));
        }
        let size = unknowns.free();
        let too_large = TransientError::TooLarge { unknowns: size };
        let (symbolic, argsort) = SymbolicSparseColMat::try_new_from_indices(size, size, &pairs)
            .map_err(|_| too_large.clone())?;
        let symbolic_lu = SymbolicLu::try_new(symbolic.as_ref()).map_err(|_| too_large)?;
        Ok(Self { unknowns, symbolic, argsort, symbolic_lu })
    }

    /// Solves for the change of all displacements; `None` for a singular matrix.
    pub fn solve(
        &self,
        block: &TransientBlock,
        elements: &[Linearised],
        contact: &Contact,
        residual: &[f64],
    ) -> Option<Vec<f64>> {
        let values = self.values(block, elements, contact);
        let matrix =
            SparseColMat::new_from_argsort(self.symbolic.clone(), &self.argsort, &values).ok()?;
        let lu = Lu::try_new_with_symbolic(self.symbolic_lu.clone(), matrix.as_ref()).ok()?;
        let mut free = self.free(residual);
        let size = free.len();
        lu.solve_in_place(faer::MatMut::from_column_major_slice_mut(&mut free, size, 1));
        // The upper edge keeps its prescribed x displacement.
        free.push(0.0);
        free.iter().all(|change| change.is_finite()).then(|| self.unknowns.expand(&free))
    }

    /// The entries of an array over the nodes that belong to unknowns.
    pub fn free(&self, nodes: &[f64]) -> Vec<f64> {
        let mut free = self.unknowns.reduce(nodes, 0.0);
        free.pop();
        free
    }

    /// Values in the order of the pattern.
    fn values(
        &self,
        block: &TransientBlock,
        elements: &[Linearised],
        contact: &Contact,
    ) -> Vec<f64> {
        let mut values = Vec::with_capacity(64 * elements.len() + 40 * contact.nodes());
        for (index, element) in elements.iter().enumerate() {
            let dofs = block.dofs(index).map(|dof| self.unknowns.index_of(dof));
            values.extend(entries(&dofs).map(|(_, _, i, j)| element.stiffness[i][j]));
        }
        for node in 0..contact.nodes() {
            let dofs = Contact::dofs(contact.nodes(), node);
            let stiffness = contact.penalty_stiffness(node);
            values.extend(entries(&dofs.map(Some)).map(|(_, _, i, j)| stiffness[i][j]));
            let stiffness = contact.curvature_stiffness(node);
            values.extend(entries(&edge_dofs(&dofs)).map(|(_, _, i, j)| stiffness[i][j]));
        }
        values
    }
}

/// The x displacements of a node and the one after it.
fn edge_dofs(dofs: &[usize; 6]) -> [Option<usize>; 2] {
    [Some(dofs[2]), Some(dofs[4])]
}

/// Row, column and their positions in a local matrix, for all of its entries that belong to
/// unknowns.
fn entries<const N: usize>(
    dofs: &[Option<usize>; N],
) -> impl Iterator<Item = (usize, usize, usize, usize)> {
    dofs.iter().enumerate().flat_map(move |(j, col)| {
        dofs.iter()
            .enumerate()
            .filter_map(move |(i, row)| row.zip(*col).map(|(row, col)| (row, col, i, j)))
    })
}
