//! The factors of the preconditioner.

use super::stiffness::Pattern;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};

/// Sparse LU factors of matrices with one pattern.
pub(super) struct Factor {
    matrix: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLu<usize>,
    factors: Option<Lu<usize, f64>>,
}

/// The matrix is singular to working precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Singular;

impl Factor {
    /// Orders the unknowns of a pattern.
    pub fn new(pattern: &Pattern) -> Result<Self, Singular> {
        let (mut starts, mut rows) = (vec![0], Vec::with_capacity(4 * pattern.rows.len()));
        for column in pattern.start.windows(2) {
            for _ in 0..2 {
                let blocks = &pattern.rows[column[0]..column[1]];
                rows.extend(blocks.iter().flat_map(|r| [2 * *r as usize, 2 * *r as usize + 1]));
                starts.push(rows.len());
            }
        }
        let size = pattern.size();
        let matrix = SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
        let symbolic = SymbolicLu::try_new(matrix.as_ref()).map_err(|_| Singular)?;
        Ok(Self { matrix, symbolic, factors: None })
    }

    /// Factorises a matrix with these values.
    pub fn refactor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let matrix = SparseColMatRef::new(self.matrix.as_ref(), values);
        self.factors = None;
        let factors = Lu::try_new_with_symbolic(self.symbolic.clone(), matrix);
        self.factors = Some(factors.map_err(|_| Singular)?);
        Ok(())
    }

    /// Solves with the factors; without any, leaves the right side as it is.
    pub fn solve(&self, right: &mut [f64]) {
        let size = right.len();
        if let Some(factors) = &self.factors {
            factors.solve_in_place(faer::MatMut::from_column_major_slice_mut(right, size, 1));
        }
    }
}
