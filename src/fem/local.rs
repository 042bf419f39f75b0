//! The tangent without its memory, factorised: the preconditioner of the steady solver.
//!
//! At a depth z the strains are those of waves of about the length z and shorter ones have died
//! out. A row is therefore given the stiffness that its branches have at the wavenumber
//! `1 / z`: the internal tensors follow their own point by the fraction `1 / (1 + (q v τ)²)`.
//! What remains local is sparse and is factorised exactly, with all of the deformation, of the
//! stresses and of the contact in it.

use super::block::Block;
use super::unknowns::Unknowns;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};
use std::sync::Arc;

/// Wavenumber times depth at which the stiffness of a row is taken: on the stiff side, since the
/// contact and the stresses then lose less of their weight than the softest waves gain.
const WAVES_AT_DEPTH: f64 = 6.0;

/// Threads pay for large factors only.
const PARALLEL: Par = Par::Seq;

/// Stiffness of one contact node: its 2×2 block.
pub type NodeStiffness = [[f64; 2]; 2];

/// The pattern of the sparse matrix, made once for a mesh.
pub struct LocalPattern {
    unknowns: Unknowns,
    symbolic: SymbolicSparseColMat<usize>,
    argsort: Argsort<usize>,
    symbolic_factor: Arc<SymbolicCholesky<usize>>,
    /// Fraction by which each branch follows, for each row.
    follows: Vec<Vec<f64>>,
}

/// A factorised local tangent.
pub struct LocalTangent {
    unknowns: Unknowns,
    symbolic: Arc<SymbolicCholesky<usize>>,
    values: Vec<f64>,
    subdiagonal: Vec<f64>,
    permutation: [Vec<usize>; 2],
    /// Response of all unknowns to the displacement of the upper edge.
    edge_response: Vec<f64>,
}

impl LocalPattern {
    /// The pattern for a block and its relaxation lengths `v τ` in m.
    pub fn new(block: &Block, relaxation_lengths: &[f64]) -> Self {
        let mesh = block.mesh();
        let unknowns = Unknowns { columns: mesh.columns, rows: mesh.rows() };
        let mut pairs = Vec::new();
        for_each_entry(unknowns, |row, col| pairs.push(Pair { row, col }));
        for node in 0..mesh.columns {
            for (i, j) in [(0, 0), (1, 0), (1, 1)] {
                pairs.push(Pair { row: 2 * node + i, col: 2 * node + j });
            }
        }
        let size = unknowns.own();
        let (symbolic, argsort) = SymbolicSparseColMat::try_new_from_indices(size, size, &pairs)
            .expect("indices lie in the matrix");
        let symbolic_factor = factorize_symbolic_cholesky(
            symbolic.as_ref(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .expect("memory for the pattern");
        let symbolic_factor = Arc::new(symbolic_factor);
        let heights = mesh.node_heights();
        let follows = (0..mesh.rows())
            .map(|row| {
                let depth = 0.5 * (heights[row] + heights[row + 1]);
                let q = WAVES_AT_DEPTH / depth;
                relaxation_lengths.iter().map(|length| 1.0 / (1.0 + (q * length).powi(2))).collect()
            })
            .collect();
        Self { unknowns, symbolic, argsort, symbolic_factor, follows }
    }

    /// Fraction by which the internal tensors of each branch follow their point, for each row of
    /// elements.
    pub fn follows(&self) -> &[Vec<f64>] {
        &self.follows
    }

    /// Factorises the local tangent of the block with the stiffness of its contact nodes.
    pub fn factorise(&self, block: &Block, contact: &[NodeStiffness]) -> Option<LocalTangent> {
        let unknowns = self.unknowns;
        let mut values = Vec::new();
        let mut edge = vec![0.0; unknowns.own()];
        for (r, row) in block.rows().iter().enumerate() {
            for column in 0..unknowns.columns {
                let stiffness = row.local_stiffness(block.material(), &self.follows[r], column);
                let places = entries(unknowns, r, column);
                for (j, col) in places.iter().enumerate() {
                    for (i, row) in places.iter().enumerate() {
                        match (row, col) {
                            (Some(row), Some(col)) if row >= col => {
                                values.push(stiffness[i][j]);
                            }
                            (Some(row), None) => edge[*row] += stiffness[i][j],
                            _ => {}
                        }
                    }
                }
            }
        }
        values.extend(contact.iter().flat_map(|k| [k[0][0], k[1][0], k[1][1]]));
        let matrix =
            SparseColMat::new_from_argsort(self.symbolic.clone(), &self.argsort, &values).ok()?;
        let mut tangent = LocalTangent::factorise(unknowns, &self.symbolic_factor, &matrix);
        tangent.solve_own(&mut edge);
        tangent.edge_response = edge;
        Some(tangent)
    }
}

impl LocalTangent {
    fn factorise(
        unknowns: Unknowns,
        symbolic: &Arc<SymbolicCholesky<usize>>,
        matrix: &SparseColMat<usize, f64>,
    ) -> Self {
        let size = unknowns.own();
        let mut values = vec![0.0; symbolic.len_val()];
        let mut subdiagonal = vec![0.0; size];
        let mut permutation = [vec![0; size], vec![0; size]];
        let scratch =
            symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(PARALLEL, Default::default());
        let [forward, inverse] = &mut permutation;
        symbolic.factorize_numeric_intranode_lblt(
            &mut values,
            &mut subdiagonal,
            forward,
            inverse,
            matrix.as_ref(),
            Side::Lower,
            PARALLEL,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        );
        let symbolic = Arc::clone(symbolic);
        Self { unknowns, symbolic, values, subdiagonal, permutation, edge_response: Vec::new() }
    }

    /// Solves with the local tangent: forces and, at the end, the mean displacement of the
    /// contact nodes in; unknowns out.
    pub fn solve(&self, right: &mut [f64]) {
        let own = self.unknowns.own();
        let (nodes, common) = right.split_at_mut(own);
        self.solve_own(nodes);
        let missing = common[0] - self.unknowns.mean_contact_displacement(nodes);
        let common_displacement =
            -missing / self.unknowns.mean_contact_displacement(&self.edge_response);
        for (node, response) in nodes.iter_mut().zip(&self.edge_response) {
            *node -= response * common_displacement;
        }
        common[0] = common_displacement;
    }

    fn solve_own(&self, right: &mut [f64]) {
        let size = right.len();
        let [forward, inverse] = &self.permutation;
        let factor = IntranodeLbltRef::new(
            &self.symbolic,
            &self.values,
            &self.subdiagonal,
            PermRef::new_checked(forward, inverse, size),
        );
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(1, PARALLEL);
        factor.solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(right, size, 1),
            PARALLEL,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}

/// Unknowns of the eight displacements of an element.
fn entries(unknowns: Unknowns, row: usize, column: usize) -> [Option<usize>; 8] {
    let row_len = 2 * unknowns.columns;
    let right = (column + 1) % unknowns.columns;
    let mut places = [None; 8];
    for (node, at) in [column, right, column, right].into_iter().enumerate() {
        let first = (row + node / 2) * row_len + 2 * at;
        places[2 * node] = unknowns.of(first);
        places[2 * node + 1] = unknowns.of(first + 1);
    }
    places
}

/// Calls back with row and column of every entry of every element, in the order of assembly.
fn for_each_entry(unknowns: Unknowns, mut entry: impl FnMut(usize, usize)) {
    for row in 0..unknowns.rows {
        for column in 0..unknowns.columns {
            let places = entries(unknowns, row, column);
            for col in places.into_iter().flatten() {
                for row in places.into_iter().flatten().filter(|row| *row >= col) {
                    entry(row, col);
                }
            }
        }
    }
}
