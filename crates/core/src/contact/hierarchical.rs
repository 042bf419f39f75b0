//! Dense matrices that are smooth away from the diagonal, compressed and factorised.
//!
//! The displacement under a force is a smooth function at a distance. With the points in the order of their positions,
//! a block off the diagonal therefore has a low rank `r`, and halving the range again and again
//!
//! ```text
//! A = [ A_1        U_1 V_2^T ]      A_1, A_2 of the same form, dense when small
//!     [ U_2 V_1^T  A_2       ]
//! ```
//!
//! stores `n` rows in `O(r n log n)` numbers (Ambikasaran & Darve 2013, doi:10.1007/s10915-013-9714-z). By the formula
//! of Sherman, Morrison and Woodbury the halves `A_1` and `A_2`, once solved for `X_1 = A_1^-1 U_1` and
//! `X_2 = A_2^-1 U_2`, leave a system of the size of the ranks:
//!
//! ```text
//! x_1 = A_1^-1 b_1 - X_1 f_2,   x_2 = A_2^-1 b_2 - X_2 f_1,   [ 1          V_2^T X_2 ] [f_2]   [V_2^T A_2^-1 b_2]
//!                                                              [ V_1^T X_1  1        ] [f_1] = [V_1^T A_1^-1 b_1]
//! ```
//!
//! The factors take `O(r² n log² n)` multiplications, a solve `O(r n log n)`.

use faer::linalg::matmul::matmul;
use faer::linalg::solvers::{DenseSolveCore, PartialPivLu, Solve};
use faer::{Accum, Mat, MatMut, MatRef, Par};
use std::ops::Range;

/// Matrices up to this size are stored and inverted as they are.
const LEAF: usize = 64;
/// Most terms of a block: one that needs more is not smooth, and what is left of it is left to the iteration.
const MOST_TERMS: usize = 40;

/// A square matrix without its diagonal, compressed.
pub(super) enum Compressed {
    Leaf(Mat<f64>),
    Split(Box<Split<Compressed>>),
}

/// The two halves of a range and what acts between them.
pub(super) struct Split<T> {
    halves: [T; 2],
    /// What the second half does to the first, and the first to the second.
    between: [LowRank; 2],
}

/// `left right^T`
struct LowRank {
    left: Mat<f64>,
    right: Mat<f64>,
}

/// Factors of a compressed matrix with a diagonal.
pub(super) enum Factors {
    /// The inverse: a product is faster than two triangular solves.
    Leaf(Mat<f64>),
    /// The halves, with `X_1` and `X_2` for `left`, and the factors of the small system.
    Split(Box<(Split<Factors>, PartialPivLu<f64>)>),
}

impl Compressed {
    /// Compresses the matrix with the entries `entry(row, column)` off its diagonal; each block may lose the part
    /// `tolerance` of its Frobenius norm.
    pub fn new(range: Range<usize>, tolerance: f64, entry: &impl Fn(usize, usize) -> f64) -> Self {
        let size = range.len();
        if size <= LEAF {
            let first = range.start;
            let off_diagonal = |i, j| if i == j { 0.0 } else { entry(first + i, first + j) };
            return Self::Leaf(Mat::from_fn(size, size, off_diagonal));
        }
        let middle = range.start + size / 2;
        let (first, second) = (range.start..middle, middle..range.end);
        let between = [
            LowRank::new(first.clone(), second.clone(), middle - 1, tolerance, entry),
            LowRank::new(second.clone(), first.clone(), middle, tolerance, entry),
        ];
        let halves = [Self::new(first, tolerance, entry), Self::new(second, tolerance, entry)];
        Self::Split(Box::new(Split { halves, between }))
    }

    /// Sum of each row, without the diagonal.
    pub fn row_sums(&self) -> Vec<f64> {
        match self {
            Self::Leaf(matrix) => (0..matrix.nrows()).map(|i| matrix.row(i).iter().sum()).collect(),
            Self::Split(split) => {
                let mut sums = Vec::new();
                for (half, between) in split.halves.iter().zip(&split.between) {
                    let beyond = between.row_sums();
                    sums.extend(half.row_sums().iter().zip(beyond).map(|(a, b)| a + b));
                }
                sums
            }
        }
    }

    /// Factorises the matrix with this diagonal.
    pub fn factorise(self, diagonal: &[f64]) -> Factors {
        self.factorise_and_solve(diagonal, Mat::zeros(diagonal.len(), 0).as_mut())
    }

    /// The same, and solves for `columns` in place: those of the blocks that this matrix is part of, which so need no
    /// pass of their own through its factors.
    fn factorise_and_solve(self, diagonal: &[f64], mut columns: MatMut<'_, f64>) -> Factors {
        match self {
            Self::Leaf(mut matrix) => {
                diagonal.iter().enumerate().for_each(|(i, d)| matrix[(i, i)] = *d);
                let inverse = matrix.partial_piv_lu().inverse();
                multiply_in_place(&inverse, columns);
                Factors::Leaf(inverse)
            }
            Self::Split(split) => {
                let Split { halves: [first, second], between: [mut upper, mut lower] } = *split;
                let (before, after) = diagonal.split_at(upper.left.nrows());
                let (x, y) = columns.as_mut().split_at_row_mut(before.len());
                let first = first.factorise_with(before, x, &mut upper.left);
                let second = second.factorise_with(after, y, &mut lower.left);
                let (r, s) = (upper.left.ncols(), lower.left.ncols());
                let mut exchange = Mat::<f64>::identity(r + s, r + s);
                let block = exchange.as_mut().submatrix_mut(0, r, r, s);
                product(block, upper.right.transpose(), lower.left.as_ref());
                let block = exchange.as_mut().submatrix_mut(r, 0, s, r);
                product(block, lower.right.transpose(), upper.left.as_ref());
                let exchange = exchange.partial_piv_lu();
                let split = Split { halves: [first, second], between: [upper, lower] };
                split.couple(&exchange, columns);
                Factors::Split(Box::new((split, exchange)))
            }
        }
    }

    /// Factorises and solves for `columns` and for `own` in one pass.
    fn factorise_with(
        self,
        diagonal: &[f64],
        mut columns: MatMut<'_, f64>,
        own: &mut Mat<f64>,
    ) -> Factors {
        let (size, given) = (columns.nrows(), columns.ncols());
        let mut all = Mat::<f64>::zeros(size, given + own.ncols());
        let (mut all_given, mut all_own) = all.as_mut().split_at_col_mut(given);
        all_given.copy_from(columns.as_ref());
        all_own.copy_from(own.as_ref());
        let factors = self.factorise_and_solve(diagonal, all.as_mut());
        columns.copy_from(all.get(.., ..given));
        own.copy_from(all.get(.., given..));
        factors
    }
}

impl Factors {
    /// Solves for the columns of `rhs`, in place.
    pub fn solve_in_place(&self, mut rhs: MatMut<'_, f64>) {
        match self {
            Self::Leaf(inverse) => multiply_in_place(inverse, rhs),
            Self::Split(both) => {
                let (split, exchange) = &**both;
                let (x, y) = rhs.as_mut().split_at_row_mut(split.between[0].left.nrows());
                split.halves[0].solve_in_place(x);
                split.halves[1].solve_in_place(y);
                split.couple(exchange, rhs);
            }
        }
    }

    /// Solves for one right-hand side, in place.
    pub fn solve_one_in_place(&self, rhs: &mut [f64]) {
        let rows = rhs.len();
        self.solve_in_place(MatMut::from_column_major_slice_mut(rhs, rows, 1));
    }
}

impl Split<Factors> {
    /// Completes `columns` that are solved in each half for itself.
    fn couple(&self, exchange: &PartialPivLu<f64>, columns: MatMut<'_, f64>) {
        let [upper, lower] = &self.between;
        if columns.ncols() == 0 {
            return;
        }
        let (x, y) = columns.split_at_row_mut(upper.left.nrows());
        let (r, s) = (upper.left.ncols(), lower.left.ncols());
        let mut forces = Mat::<f64>::zeros(r + s, x.ncols());
        let (of_second, of_first) = forces.as_mut().split_at_row_mut(r);
        product(of_second, upper.right.transpose(), y.as_ref());
        product(of_first, lower.right.transpose(), x.as_ref());
        exchange.solve_in_place(forces.as_mut());
        let subtract = |to, left: &Mat<f64>, by| {
            matmul(to, Accum::Add, left, by, -1.0, Par::Seq);
        };
        subtract(x, &upper.left, forces.as_ref().subrows(0, r));
        subtract(y, &lower.left, forces.as_ref().subrows(r, s));
    }
}

fn product(to: MatMut<'_, f64>, left: MatRef<'_, f64>, right: MatRef<'_, f64>) {
    matmul(to, Accum::Replace, left, right, 1.0, Par::Seq);
}

fn multiply_in_place(matrix: &Mat<f64>, mut columns: MatMut<'_, f64>) {
    let given = columns.as_ref().to_owned();
    product(columns.as_mut(), matrix.as_ref(), given.as_ref());
}

impl LowRank {
    /// Adaptive cross approximation (Bebendorf 2000, doi:10.1007/PL00005410), begun with the row `nearest` to the columns.
    fn new(
        rows: Range<usize>,
        columns: Range<usize>,
        nearest: usize,
        tolerance: f64,
        entry: &impl Fn(usize, usize) -> f64,
    ) -> Self {
        let mut left: Vec<Vec<f64>> = Vec::new();
        let mut right: Vec<Vec<f64>> = Vec::new();
        let mut used = vec![false; rows.len()];
        let mut row = nearest - rows.start;
        let mut square = 0.0;
        while left.len() < MOST_TERMS.min(rows.len()).min(columns.len()) {
            used[row] = true;
            let mut v: Vec<f64> = columns.clone().map(|j| entry(rows.start + row, j)).collect();
            for (l, r) in left.iter().zip(&right) {
                v.iter_mut().zip(r).for_each(|(v, r)| *v -= l[row] * r);
            }
            let pivot = largest(&v, |_| true);
            if v[pivot] == 0.0 {
                break;
            }
            let mut u: Vec<f64> = rows.clone().map(|i| entry(i, columns.start + pivot)).collect();
            for (l, r) in left.iter().zip(&right) {
                u.iter_mut().zip(l).for_each(|(u, l)| *u -= r[pivot] * l);
            }
            let scale = 1.0 / v[pivot];
            u.iter_mut().for_each(|u| *u *= scale);
            let term = dot(&u, &u) * dot(&v, &v);
            for (l, r) in left.iter().zip(&right) {
                square += 2.0 * dot(l, &u) * dot(r, &v);
            }
            square += term;
            row = largest(&u, |i| !used[i]);
            left.push(u);
            right.push(v);
            if term <= tolerance * tolerance * square || used[row] {
                break;
            }
        }
        let matrix =
            |size, columns: &[Vec<f64>]| Mat::from_fn(size, columns.len(), |i, j| columns[j][i]);
        Self { left: matrix(rows.len(), &left), right: matrix(columns.len(), &right) }
    }

    fn row_sums(&self) -> Vec<f64> {
        let sums: Vec<f64> =
            (0..self.right.ncols()).map(|j| self.right.col(j).iter().sum()).collect();
        let row = |i| self.left.row(i).iter().zip(&sums).map(|(u, v)| u * v).sum();
        (0..self.left.nrows()).map(row).collect()
    }
}

/// Index of the largest of the eligible values, 0 if there is none.
fn largest(values: &[f64], eligible: impl Fn(usize) -> bool) -> usize {
    let mut best = (0, -1.0);
    for (i, value) in values.iter().enumerate() {
        if value.abs() > best.1 && eligible(i) {
            best = (i, value.abs());
        }
    }
    best.0
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kernel of a half-space of `period` points, with the mean zero, and with a part without symmetry as losses
    /// make it; positions with gaps.
    fn entry(size: usize) -> (Vec<f64>, impl Fn(usize, usize) -> f64) {
        let period = 4 * size + 3;
        let at = |i: usize| (3 * i + (i / 5) % 3) as f64;
        let entry = move |i: usize, j: usize| {
            let angle = std::f64::consts::PI * (at(i) - at(j)) / period as f64;
            -(2.0 * angle.sin().abs()).ln() + 0.3 * (2.0 * angle).sin()
        };
        (vec![2.0 + (period as f64 / 6.0).ln(); size], entry)
    }

    fn dense(size: usize, diagonal: &[f64], entry: &impl Fn(usize, usize) -> f64) -> Mat<f64> {
        Mat::from_fn(size, size, |i, j| if i == j { diagonal[i] } else { entry(i, j) })
    }

    const SIZES: [usize; 7] = [1, 2, LEAF, LEAF + 1, 2 * LEAF + 1, 333, 1000];

    #[test]
    fn the_row_sums_are_those_of_the_dense_matrix() {
        for size in SIZES {
            let (_, entry) = entry(size);
            let sums = Compressed::new(0..size, 1e-9, &entry).row_sums();
            for (i, sum) in sums.iter().enumerate() {
                let row: Vec<f64> = (0..size).filter(|j| *j != i).map(|j| entry(i, j)).collect();
                let scale: f64 = row.iter().map(|a| a.abs()).sum();
                assert!((sum - row.iter().sum::<f64>()).abs() <= 1e-8 * scale, "{size}: row {i}");
            }
        }
    }

    #[test]
    fn a_solve_multiplied_by_the_dense_matrix_is_the_right_hand_side() {
        // The error of a solve is that of the blocks times the condition number, here some hundreds.
        for (tolerance, most) in [(1e-2, 0.3), (1e-6, 1e-4), (1e-11, 1e-8)] {
            for size in SIZES {
                let (diagonal, entry) = entry(size);
                let factors = Compressed::new(0..size, tolerance, &entry).factorise(&diagonal);
                let rhs = Mat::from_fn(size, 2, |i, j| ((i * i + 3 * j) as f64 * 0.7).sin());
                let mut solved = rhs.clone();
                factors.solve_in_place(solved.as_mut());
                let difference = dense(size, &diagonal, &entry) * &solved - &rhs;
                let error = difference.norm_l2() / rhs.norm_l2();
                assert!(error < most, "{size} points to {tolerance}: {error:e}");
                let mut one: Vec<f64> = rhs.col(1).iter().copied().collect();
                factors.solve_one_in_place(&mut one);
                let alike = one.iter().zip(solved.col(1).iter());
                let scale = solved.norm_max();
                // Round-off only.
                assert!(alike.into_iter().all(|(a, b)| (a - b).abs() < 1e-12 * scale), "{size}");
            }
        }
    }

    #[test]
    fn a_block_has_few_terms_and_one_that_is_zero_none() {
        let (_, entry) = entry(1000);
        let block = LowRank::new(0..500, 500..1000, 499, 1e-2, &entry);
        assert!(block.left.ncols() <= 12, "{}", block.left.ncols());
        assert_eq!(LowRank::new(0..9, 9..20, 8, 1e-2, &|_, _| 0.0).left.ncols(), 0);
    }
}
