//! Forward and backward substitution, subtrees in parallel.

use super::Real;
use super::symbolic::{Front, Symbolic};

/// Subtrees with fewer factors than this are not worth a separate task.
const SERIAL_FACTORS: usize = 200_000;

/// The factors and row exchanges of a subtree, which belong to the `x` of its unknowns.
#[derive(Clone, Copy)]
pub(super) struct Factors<'a> {
    pub symbolic: &'a Symbolic,
    pub factors: &'a [Real],
    pub exchanges: &'a [u32],
}

impl<'a> Factors<'a> {
    fn own(&self, front: &Front) -> (&'a [Real], &'a [Real], &'a [u32]) {
        let own = &self.factors[front.offset..][..front.factors()];
        let (panel, right) = own.split_at(front.panel());
        (panel, right, &self.exchanges[2 * front.own.start..2 * front.own.end])
    }

    /// `x <- L^-1 P x` for the unknowns `x` of the subtree of front `k`; returns what is to be
    /// added to those of its border.
    pub fn forward(&self, k: usize, x: &mut [Real]) -> Vec<Real> {
        let front = &self.symbolic.fronts[k];
        let (p, b) = (front.pivots(), front.remaining());
        let (below, own) = x.split_at_mut(x.len() - p);
        let mut all = vec![0.0; p + b];
        all[..p].copy_from_slice(own);
        let left = self.beside(front, below, |k, x| self.forward(k, x));
        for (&child, border) in front.children.iter().zip(left.iter().flatten()) {
            let places = &self.symbolic.fronts[child].in_parent;
            for (&place, from) in places.iter().zip(border.as_chunks::<2>().0) {
                all[2 * place as usize] += from[0];
                all[2 * place as usize + 1] += from[1];
            }
        }
        let (panel, _, exchanges) = self.own(front);
        for (x, &from) in own.iter_mut().zip(exchanges) {
            *x = all[from as usize];
        }
        all[..p].copy_from_slice(own);
        eliminate_lower(panel, p + b, &mut all, p);
        own.copy_from_slice(&all[..p]);
        all.split_off(p)
    }

    /// `x <- U^-1 x` in the subtree of front `k` with the solution on its border.
    pub fn backward(&self, k: usize, x: &mut [Real], border: &[Real]) {
        let front = &self.symbolic.fronts[k];
        let p = front.pivots();
        let (below, own) = x.split_at_mut(x.len() - p);
        let (panel, right, _) = self.own(front);
        subtract_product(own, right, border);
        eliminate_upper(panel, p + border.len(), own);
        self.beside(front, below, |child, x| {
            let places = &self.symbolic.fronts[child].in_parent;
            let mut values = Vec::with_capacity(2 * places.len());
            for &place in places {
                let at = 2 * place as usize;
                let pair = if at < p { &own[at..at + 2] } else { &border[at - p..at - p + 2] };
                values.extend_from_slice(pair);
            }
            self.backward(child, x, &values);
        });
    }

    /// Does the same in both children, in parallel if they are large.
    fn beside<R: Send>(
        &self,
        front: &Front,
        x: &mut [Real],
        task: impl Fn(usize, &mut [Real]) -> R + Sync,
    ) -> Option<[R; 2]> {
        let [a, b] = front.children[..] else { return None };
        let fronts = &self.symbolic.fronts;
        let (x_a, x_b) =
            x.split_at_mut(2 * (fronts[a].own.end - fronts[fronts[a].first].own.start));
        let length = |k: usize| fronts[k].offset - fronts[fronts[k].first].offset;
        let (a, b) = if length(a).min(length(b)) < SERIAL_FACTORS {
            (task(a, x_a), task(b, x_b))
        } else {
            rayon::join(|| task(a, x_a), || task(b, x_b))
        };
        Some([a, b])
    }
}

/// Number of columns that are subtracted in one pass over `x`.
const WIDTH: usize = 4;

/// Solves with the unit lower triangle of the first `p` rows of the panel, and subtracts the
/// product with the rows below from the rest of `x`.
fn eliminate_lower(panel: &[Real], height: usize, x: &mut [Real], p: usize) {
    for first in (0..p).step_by(WIDTH) {
        let width = WIDTH.min(p - first);
        let columns = &panel[first * height..(first + width) * height];
        for j in 0..width {
            for i in j + 1..width {
                x[first + i] -= columns[j * height + first + i] * x[first + j];
            }
        }
        let (solved, rest) = x[first..].split_at_mut(width);
        subtract_columns(rest, columns, height, first + width, solved);
    }
}

/// Solves with the upper triangle of the panel.
fn eliminate_upper(panel: &[Real], height: usize, x: &mut [Real]) {
    let mut end = x.len();
    while end > 0 {
        let width = if end.is_multiple_of(WIDTH) { WIDTH } else { end % WIDTH };
        let first = end - width;
        let columns = &panel[first * height..end * height];
        for j in (0..width).rev() {
            x[first + j] /= columns[j * height + first + j];
            for i in 0..j {
                x[first + i] -= columns[j * height + first + i] * x[first + j];
            }
        }
        let (rest, solved) = x[..end].split_at_mut(first);
        subtract_columns(rest, columns, height, 0, solved);
        end = first;
    }
}

/// `x <- x - A y` with `A` stored by columns.
fn subtract_product(x: &mut [Real], a: &[Real], y: &[Real]) {
    let height = x.len();
    if height > 0 {
        for (columns, y) in a.chunks(WIDTH * height).zip(y.chunks(WIDTH)) {
            subtract_columns(x, columns, height, 0, y);
        }
    }
}

/// Subtracts the columns times `y`, from row `first` of each on, from `x`.
fn subtract_columns(x: &mut [Real], columns: &[Real], height: usize, first: usize, y: &[Real]) {
    let n = x.len();
    if let &[y0, y1, y2, y3] = y {
        let [a, b, c, d] = [0, 1, 2, 3].map(|j| &columns[j * height + first..][..n]);
        for i in 0..n {
            x[i] -= (a[i] * y0 + b[i] * y1) + (c[i] * y2 + d[i] * y3);
        }
    } else {
        for (j, y) in y.iter().enumerate() {
            let column = &columns[j * height + first..][..n];
            x.iter_mut().zip(column).for_each(|(x, a)| *x -= a * y);
        }
    }
}
