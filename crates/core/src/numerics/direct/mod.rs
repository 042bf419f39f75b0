//! Sparse direct solver for unsymmetric matrices of 2 x 2 blocks on planar grids: multifrontal LU
//! in single precision (Duff & Reid 1983, doi:10.1145/356044.356047), for the preconditioner of
//! [`flexible_gmres`](crate::numerics::krylov::flexible_gmres) or for refinement.
//!
//! Nodes are ordered by nested dissection of their coordinates. Each separator, and each leaf
//! between separators, is eliminated in a dense matrix, its front, with row exchanges among the
//! rows of the front. Independent subtrees run in parallel on the threads of rayon.
//!
//! Why not the sparse LU of faer 0.24: it exchanges any rows, so it has to provide for the fill of
//! `A^T A`. Measured on periodic grids of nearly incompressible Q4 elements that couple to their upstream
//! neighbours; processor seconds of one factorisation with the symbolic part done, and growth of the resident
//! memory by symbolic part and factors:
//!
//! | nodes | here | faer f64, COLAMD | faer f32, COLAMD | faer f32, this order |
//! |---|---|---|---|---|
//! | 96 x 18 | 0.003 s, 5 MB | 0.02 s, 44 MB | 0.02 s, 24 MB | 0.01 s, 14 MB |
//! | 512 x 24 | 0.028 s, 28 MB | 0.12 s, 0.28 GB | 0.09 s, 0.15 GB | 0.2 s, 0.28 GB |
//! | 4096 x 30 | 0.32 s, 0.28 GB | 1.4 s, 3.1 GB | 1.1 s, 1.6 GB | 7.2 s, 6.3 GB |
//! | 8192 x 40 | 0.49 s, 0.56 GB | 2.9 s, 5.5 GB | 2.2 s, 2.9 GB | 27 s, 15 GB |
//!
//! (The last grid halves its columns where rows are three columns high: 216064 nodes. The last
//! column of figures is wall time.) A solve takes 0.05 processor seconds on 4096 x 30 nodes, whose
//! L and U have 54 million entries; a step of refinement gains two digits on all four grids.

mod dissection;
mod numeric;
mod pattern;
mod scaling;
mod solve;
mod symbolic;
#[cfg(test)]
mod tests;

pub use pattern::{Block, BlockPattern};

use crate::numerics::Interrupt;
use numeric::Elimination;
use scaling::Scaling;
use solve::Factors;
use symbolic::Symbolic;

/// Precision of the factors.
type Real = f32;

/// A pivot of this size or less, relative to the largest entry of its column before its front is
/// eliminated, is round-off.
const TINY: Real = Real::EPSILON;

/// With a relative pivot below this the factors are tested on a vector. The smallest
/// pivot alone does not tell singular matrices (2e-6 to 4e-6 measured on 256 nodes) from merely large
/// grids of nearly incompressible elements (5e-6 on 2048 x 60 nodes, where refinement still gains
/// 1.5 digits a step).
const DOUBTFUL: Real = 1e-3;

/// Why a matrix has no factors.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// A pivot is zero, or round-off.
    #[error(
        "the matrix is singular to single precision: \
         unknown {unknown} has a pivot of {relative:.1e} of its column"
    )]
    Singular {
        /// Index of the column with the smallest pivot.
        unknown: usize,
        /// That pivot relative to the largest entry of its column before elimination in its front.
        relative: f64,
    },
    /// The user stopped it.
    #[error("interrupted")]
    Interrupted,
}

/// Factors `A = L U` of matrices of one pattern.
#[derive(Debug)]
pub struct SparseLu {
    pattern: BlockPattern,
    symbolic: Symbolic,
    scaling: Scaling,
    factors: Vec<Real>,
    exchanges: Vec<u32>,
    factored: bool,
    /// Smallest relative pivot of the factors.
    smallest: Real,
}

impl SparseLu {
    /// Finds the order of elimination and the positions of the factors: once for a pattern.
    ///
    /// The coordinates of the nodes are used for the order alone, so any lengths serve in which neighbours are near
    /// each other; those of a periodic grid need no image across the wrap. Nodes without distinct coordinates are
    /// solved all the same, with more fill.
    ///
    /// # Panics
    /// If the nodes of the pattern and the coordinates differ in number.
    pub fn analyse(pattern: BlockPattern, coordinates: &[[f64; 2]]) -> Self {
        assert_eq!(pattern.nodes(), coordinates.len(), "every node has coordinates");
        let symbolic = Symbolic::new(&pattern, coordinates);
        Self {
            pattern,
            symbolic,
            scaling: Scaling::default(),
            factors: Vec::new(),
            exchanges: Vec::new(),
            factored: false,
            smallest: Real::INFINITY,
        }
    }

    /// The pattern, by which values are assembled.
    pub fn pattern(&self) -> &BlockPattern {
        &self.pattern
    }

    /// Number of stored entries of L and U together, 4 bytes each.
    pub fn nonzeros(&self) -> usize {
        self.symbolic.fronts.last().map_or(0, |root| root.offset + root.factors())
    }

    /// Factors the matrix with these blocks, in the order of the pattern.
    ///
    /// # Errors
    /// [`FactorError::Singular`] if a pivot is zero, round-off or not a number, and [`FactorError::Interrupted`]. The
    /// factors are then invalid. Small pivots alone are not an error: such factors may be a poor inverse (see
    /// [`Self::reproduces`]) and still precondition an iteration.
    ///
    /// # Panics
    /// If there are not as many blocks as in the pattern.
    pub fn refactor(&mut self, values: &[Block], interrupt: &Interrupt) -> Result<(), FactorError> {
        assert_eq!(values.len(), self.pattern.blocks(), "one block for each of the pattern");
        self.factored = false;
        self.scaling.update(&self.pattern, values);
        self.factors.resize(self.nonzeros(), 0.0);
        self.exchanges.resize(2 * self.pattern.nodes(), 0);
        let symbolic = &self.symbolic;
        let elimination = Elimination { symbolic, values, scaling: &self.scaling, interrupt };
        let Some(root) = symbolic.fronts.len().checked_sub(1) else {
            self.factored = true;
            return Ok(());
        };
        self.smallest =
            elimination.subtree(root, &mut self.factors, &mut self.exchanges)?.smallest.relative;
        self.factored = true;
        Ok(())
    }

    /// Whether the factors serve as an inverse of the matrix with these blocks: no pivot is small, or
    /// `|x - (LU)^-1 A x| < |x| / 2` for the vector `x = (LU)^-1 b`, `b` of random signs.
    ///
    /// Such an `x` is dominated by the direction that the factors shrink most. If `A` is singular, `A` takes this
    /// direction to zero, and the error is `x` itself; if `(LU)^-1 A` is near the identity, it is small.
    pub fn reproduces(&self, values: &[Block]) -> bool {
        if self.smallest >= DOUBTFUL {
            return true;
        }
        let mut state = 1u32;
        let mut sign = || {
            // Xorshift (Marsaglia 2003, doi:10.18637/jss.v008.i14).
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            if state & 1 == 0 { -1.0 } else { 1.0 }
        };
        let mut x: Vec<f64> = self.scaling.rows.iter().map(|r| sign() / r).collect();
        self.solve(&mut x);
        let mut again = vec![0.0; x.len()];
        self.pattern.multiply(values, &x, &mut again);
        self.solve(&mut again);
        let (mut error, mut size) = (0.0, 0.0);
        for ((x, again), scale) in x.iter().zip(again).zip(&self.scaling.columns) {
            error += ((x - again) / scale).powi(2);
            size += (x / scale).powi(2);
        }
        // Not so if either is not a number.
        error < 0.25 * size
    }

    /// Replaces `rhs` by `(LU)^-1 rhs`: `A^-1 rhs` to single precision, times the condition of `A`.
    ///
    /// # Panics
    /// If there are no factors, or `rhs` has not 2 entries a node.
    pub fn solve(&self, rhs: &mut [f64]) {
        assert!(self.factored, "solve follows a refactor that succeeded");
        assert_eq!(rhs.len(), 2 * self.pattern.nodes(), "two unknowns a node");
        let rows = &self.scaling.rows;
        let largest = rhs.iter().zip(rows).fold(0.0, |m: f64, (b, r)| m.max((b * r).abs()));
        // Keeps single precision from overflow and underflow.
        let size = if largest > 0.0 { largest } else { 1.0 };
        let unknowns = || self.symbolic.unknowns();
        let mut x: Vec<Real> = unknowns().map(|i| (rhs[i] * rows[i] / size) as Real).collect();
        if let Some(root) = self.symbolic.fronts.len().checked_sub(1) {
            let factors = Factors {
                symbolic: &self.symbolic,
                factors: &self.factors,
                exchanges: &self.exchanges,
            };
            factors.forward(root, &mut x);
            factors.backward(root, &mut x, &[]);
        }
        for (i, x) in unknowns().zip(x) {
            rhs[i] = f64::from(x) * self.scaling.columns[i] * size;
        }
    }
}
