//! The factors: dense elimination in each front, subtrees in parallel.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, Par};

use super::pattern::Block;
use super::scaling::Scaling;
use super::symbolic::{Front, Symbolic};
use super::{FactorError, Real, TINY};
use crate::numerics::Interrupt;

/// Subtrees with fewer multiplications than this are not worth a separate task.
const SERIAL_WORK: f64 = 1e6;

/// What all fronts read.
pub(super) struct Elimination<'a> {
    pub symbolic: &'a Symbolic,
    pub values: &'a [Block],
    pub scaling: &'a Scaling,
    pub interrupt: &'a Interrupt,
}

/// Contribution of a subtree to its parent.
pub(super) struct Remainder {
    /// Matrix to be added to that of the border, column by column.
    schur: Vec<Real>,
    pub smallest: Pivot,
}

/// A pivot relative to the largest entry of its column before its front is eliminated.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pivot {
    pub relative: Real,
    /// Position of its column in the order of elimination.
    pub place: usize,
}

impl Pivot {
    /// Larger than any.
    const NONE: Self = Self { relative: Real::INFINITY, place: 0 };

    fn smaller(self, other: Self) -> Self {
        if other.relative < self.relative { other } else { self }
    }
}

impl Elimination<'_> {
    /// Factors the subtree of front `k` into its part of the factors and of the row exchanges.
    pub fn subtree(
        &self,
        k: usize,
        factors: &mut [Real],
        pivots: &mut [u32],
    ) -> Result<Remainder, FactorError> {
        let front = &self.symbolic.fronts[k];
        let (below, own) = factors.split_at_mut(factors.len() - front.factors());
        let (pivots_below, own_pivots) = pivots.split_at_mut(pivots.len() - front.pivots());
        let left = self.children(front, below, pivots_below)?;
        if self.interrupt.is_set() {
            return Err(FactorError::Interrupted);
        }
        own.fill(0.0);
        self.insert_blocks(front, own);
        let remaining = front.remaining();
        let mut schur = vec![0.0; remaining * remaining];
        let mut smallest = Pivot::NONE;
        for (&child, left) in front.children.iter().zip(left) {
            add_contribution(&self.symbolic.fronts[child], &left.schur, front, own, &mut schur);
            smallest = smallest.smaller(left.smallest);
        }
        smallest = smallest.smaller(self.eliminate(front, own, own_pivots, &mut schur)?);
        Ok(Remainder { schur, smallest })
    }

    fn children(
        &self,
        front: &Front,
        factors: &mut [Real],
        pivots: &mut [u32],
    ) -> Result<Vec<Remainder>, FactorError> {
        let fronts = &self.symbolic.fronts;
        let [a, b] = front.children[..] else { return Ok(Vec::new()) };
        let (factors_a, factors_b) =
            factors.split_at_mut(fronts[fronts[b].first].offset - fronts[fronts[a].first].offset);
        let nodes = fronts[a].own.end - fronts[fronts[a].first].own.start;
        let (pivots_a, pivots_b) = pivots.split_at_mut(2 * nodes);
        let (a, b) = if fronts[a].work.min(fronts[b].work) < SERIAL_WORK {
            (self.subtree(a, factors_a, pivots_a), self.subtree(b, factors_b, pivots_b))
        } else {
            rayon::join(
                || self.subtree(a, factors_a, pivots_a),
                || self.subtree(b, factors_b, pivots_b),
            )
        };
        Ok(vec![a?, b?])
    }

    /// Writes the scaled blocks of the matrix to their positions.
    fn insert_blocks(&self, front: &Front, own: &mut [Real]) {
        let (p, height) = (front.pivots(), front.pivots() + front.remaining());
        let panel = front.panel();
        for entry in &front.blocks {
            let to = entry.to as usize;
            let stride = if to < panel { height } else { p };
            let block = &self.values[entry.value as usize];
            let (row, column) = (2 * entry.row as usize, 2 * entry.column as usize);
            for (i, line) in block.iter().enumerate() {
                for (j, value) in line.iter().enumerate() {
                    let scale = self.scaling.rows[row + i] * self.scaling.columns[column + j];
                    own[to + j * stride + i] = (value * scale) as Real;
                }
            }
        }
    }

    /// `P A11 = L11 U11`, `L21 = A21 U11^-1`, `U12 = L11^-1 P A12`, `S = A22 - L21 U12`, with row
    /// exchanges `P` among the own rows. Returns the smallest pivot.
    fn eliminate(
        &self,
        front: &Front,
        own: &mut [Real],
        pivots: &mut [u32],
        schur: &mut [Real],
    ) -> Result<Pivot, FactorError> {
        let (p, b) = (front.pivots(), front.remaining());
        let mut smallest = Pivot::NONE;
        if p == 0 {
            return Ok(smallest);
        }
        let (panel, right) = own.split_at_mut(front.panel());
        let largest: Vec<Real> =
            panel.chunks(p + b).map(|c| c.iter().fold(0.0, |m, x| x.abs().max(m))).collect();
        let panel = MatMut::from_column_major_slice_mut(panel, p + b, p);
        let (mut a11, mut a21) = panel.split_at_row_mut(p);
        exchange_and_factor(a11.rb_mut(), pivots);
        for (j, largest) in largest.into_iter().enumerate() {
            // A column of zeros has no scale.
            let relative = if largest > 0.0 { a11[(j, j)].abs() / largest } else { 0.0 };
            let pivot = Pivot { relative, place: 2 * front.own.start + j };
            if relative.is_nan() || relative <= TINY {
                return Err(self.symbolic.singular(pivot));
            }
            smallest = smallest.smaller(pivot);
        }
        if b == 0 {
            return Ok(smallest);
        }
        let upper = a11.rb().transpose();
        solve_lower_triangular_in_place(upper, a21.rb_mut().transpose_mut(), Par::Seq);
        exchange_rows(right, pivots);
        let mut a12 = MatMut::from_column_major_slice_mut(right, p, b);
        solve_unit_lower_triangular_in_place(a11.rb(), a12.rb_mut(), Par::Seq);
        let schur = MatMut::from_column_major_slice_mut(schur, b, b);
        matmul(schur, Accum::Add, a21.rb(), a12.rb(), -1.0, Par::Seq);
        Ok(smallest)
    }
}

/// `P A = L U` in place; `exchanges[i]` is the row of `A` that becomes row `i`.
fn exchange_and_factor(a: MatMut<'_, Real>, exchanges: &mut [u32]) {
    let p = a.nrows();
    let mut inverse = vec![0u32; p];
    let mut memory =
        MemBuffer::new(lu_in_place_scratch::<u32, Real>(p, p, Par::Seq, Default::default()));
    let stack = MemStack::new(&mut memory);
    lu_in_place(a, exchanges, &mut inverse, Par::Seq, stack, Default::default());
}

/// Puts the rows of a matrix, stored by columns, in the order of the exchanges.
fn exchange_rows(columns: &mut [Real], exchanges: &[u32]) {
    let mut copy = vec![0.0; exchanges.len()];
    for column in columns.chunks_exact_mut(exchanges.len()) {
        copy.copy_from_slice(column);
        for (x, &from) in column.iter_mut().zip(exchanges) {
            *x = copy[from as usize];
        }
    }
}

/// Adds the contribution of a child to the front of its parent.
fn add_contribution(
    child: &Front,
    contribution: &[Real],
    parent: &Front,
    own: &mut [Real],
    schur: &mut [Real],
) {
    let (p, b) = (parent.pivots(), parent.remaining());
    let places = &child.in_parent;
    let split = places.partition_point(|&at| 2 * (at as usize) < p);
    let (in_own, in_border) = places.split_at(split);
    let (panel, right) = own.split_at_mut(parent.panel());
    for (j, column) in contribution.chunks_exact((2 * places.len()).max(1)).enumerate() {
        let c = 2 * places[j / 2] as usize + j % 2;
        if c < p {
            add_at(&mut panel[c * (p + b)..][..p + b], places, 0, column);
        } else {
            let (upper, lower) = column.split_at(2 * split);
            add_at(&mut right[(c - p) * p..][..p], in_own, 0, upper);
            add_at(&mut schur[(c - p) * b..][..b], in_border, p, lower);
        }
    }
}

/// Adds pairs of entries at these nodes, counted from entry `first`.
fn add_at(to: &mut [Real], places: &[u32], first: usize, from: &[Real]) {
    for (&place, from) in places.iter().zip(from.as_chunks::<2>().0) {
        let to = &mut to[2 * place as usize - first..][..2];
        to[0] += from[0];
        to[1] += from[1];
    }
}
