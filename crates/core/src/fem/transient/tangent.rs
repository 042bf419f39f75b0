//! The tangent of block and contact as a sparse matrix with a fixed pattern.

use super::block::{Linearised, TransientBlock};
use super::contact::Contact;
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
    pub fn new(block: &TransientBlock) -> Self {
        let mesh = block.mesh();
        let unknowns = Unknowns { columns: mesh.columns, rows: mesh.rows() };
        let mut pairs = Vec::new();
        for index in 0..mesh.columns * mesh.rows() {
            let places = block.places(index).map(|place| unknowns.of(place));
            pairs.extend(entries(&places).map(|(row, col, _, _)| Pair { row, col }));
        }
        for node in 0..mesh.columns {
            let places = Contact::places(mesh.columns, node);
            pairs.extend(entries(&places.map(Some)).map(|(row, col, _, _)| Pair { row, col }));
            let places = edge_places(&places);
            pairs.extend(entries(&places).map(|(row, col, _, _)| Pair { row, col }));
        }
        let size = unknowns.own();
        let (symbolic, argsort) = SymbolicSparseColMat::try_new_from_indices(size, size, &pairs)
            .expect("indices lie in the matrix");
        let symbolic_lu = SymbolicLu::try_new(symbolic.as_ref()).expect("memory for the pattern");
        Self { unknowns, symbolic, argsort, symbolic_lu }
    }

    /// Solves for the change of all displacements; none for a singular matrix.
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
        let mut own = self.own(residual);
        let size = own.len();
        lu.solve_in_place(faer::MatMut::from_column_major_slice_mut(&mut own, size, 1));
        // The upper edge keeps its prescribed x displacement.
        own.push(0.0);
        own.iter().all(|change| change.is_finite()).then(|| self.unknowns.expand(&own))
    }

    /// The entries of an array over the nodes that belong to unknowns.
    pub fn own(&self, nodes: &[f64]) -> Vec<f64> {
        let mut own = self.unknowns.reduce(nodes, 0.0);
        own.pop();
        own
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
            let places = block.places(index).map(|place| self.unknowns.of(place));
            values.extend(entries(&places).map(|(_, _, i, j)| element.stiffness[i][j]));
        }
        for node in 0..contact.nodes() {
            let places = Contact::places(contact.nodes(), node);
            let stiffness = contact.penalty_stiffness(node);
            values.extend(entries(&places.map(Some)).map(|(_, _, i, j)| stiffness[i][j]));
            let stiffness = contact.curvature_stiffness(node);
            values.extend(entries(&edge_places(&places)).map(|(_, _, i, j)| stiffness[i][j]));
        }
        values
    }
}

/// The x displacements of a node and the one after it.
fn edge_places(places: &[usize; 6]) -> [Option<usize>; 2] {
    [Some(places[2]), Some(places[4])]
}

/// Row, column and their positions in a local matrix, for all of its entries that belong to
/// unknowns.
fn entries<const N: usize>(
    places: &[Option<usize>; N],
) -> impl Iterator<Item = (usize, usize, usize, usize)> {
    places.iter().enumerate().flat_map(move |(j, col)| {
        places
            .iter()
            .enumerate()
            .filter_map(move |(i, row)| row.zip(*col).map(|(row, col)| (row, col, i, j)))
    })
}
