//! Krylov solver for matrix-free, nonsymmetric systems.

use super::Interrupt;

/// How far a Krylov iteration goes.
#[derive(Debug, Clone, Copy)]
pub struct KrylovLimits {
    /// Stop when the Euclidean norm of the residual is at or below this (absolute).
    pub tolerance: f64,
    /// Give up after this many applications of the operator.
    pub max_iterations: usize,
}

/// What a Krylov iteration did.
#[derive(Debug, Clone, Copy)]
pub struct KrylovReport {
    /// Applications of the operator.
    pub iterations: usize,
    /// Euclidean norm of the residual by the recurrence.
    pub residual_norm: f64,
}

/// A new direction smaller than this, relative, is round-off: the Krylov space is exhausted, and
/// what would come next need not even lie in the range of the operator.
const EXHAUSTED: f64 = 1e-13;

/// Minimises `|r - B y|` over the Krylov space of `B` and `r` (GMRES without restart, modified
/// Gram-Schmidt; Saad & Schultz 1986, doi:10.1137/0907058) and returns `y` in place of `r`.
///
/// `B` is meant to be a preconditioned operator close to the identity: the basis is kept
/// whole, so memory is `(iterations + 1) * r.len()`. After an `interrupt` the best solution so far is returned.
pub fn gmres(
    mut operator: impl FnMut(&[f64], &mut [f64]),
    residual: &mut [f64],
    limits: KrylovLimits,
    interrupt: &Interrupt,
) -> KrylovReport {
    let apply = |v: &[f64]| {
        let mut w = vec![0.0; v.len()];
        operator(v, &mut w);
        w
    };
    let (report, y, basis) = arnoldi(apply, residual, limits, interrupt);
    residual.fill(0.0);
    for (v, y) in basis.iter().zip(&y) {
        axpy(*y, v, residual);
    }
    report
}

/// Solves `A x = b` from zero with a preconditioner on the right: minimises `|b - A Z y|` over the
/// preconditioned Krylov basis Z and returns `x = Z y` (flexible GMRES without restart; Saad 1993,
/// doi:10.1137/0914028). The residual that is watched is that of the equations themselves, whatever the
/// preconditioner is. After an `interrupt` the best solution so far is returned.
pub fn flexible_gmres(
    mut operator: impl FnMut(&[f64]) -> Vec<f64>,
    mut precondition: impl FnMut(&[f64]) -> Vec<f64>,
    right: &[f64],
    limits: KrylovLimits,
    interrupt: &Interrupt,
) -> (Vec<f64>, KrylovReport) {
    let mut directions: Vec<Vec<f64>> = Vec::new();
    let apply = |v: &[f64]| {
        directions.push(precondition(v));
        operator(&directions[directions.len() - 1])
    };
    let (report, y, _) = arnoldi(apply, right, limits, interrupt);
    let mut x = vec![0.0; right.len()];
    for (direction, y) in directions.iter().zip(&y) {
        axpy(*y, direction, &mut x);
    }
    (x, report)
}

/// The Krylov basis of an operator and a right side, and the coefficients of the smallest residual.
fn arnoldi(
    mut operator: impl FnMut(&[f64]) -> Vec<f64>,
    right: &[f64],
    limits: KrylovLimits,
    interrupt: &Interrupt,
) -> (KrylovReport, Vec<f64>, Vec<Vec<f64>>) {
    let n = right.len();
    let norm = euclidean_norm(right);
    if norm <= limits.tolerance || n == 0 {
        let report = KrylovReport { iterations: 0, residual_norm: norm };
        return (report, Vec::new(), Vec::new());
    }
    let mut basis: Vec<Vec<f64>> = vec![right.iter().map(|r| r / norm).collect()];
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<(f64, f64)> = Vec::new();
    let mut rhs = vec![norm];
    // More basis vectors than unknowns cannot be independent.
    for k in 0..limits.max_iterations.min(n) {
        if interrupt.is_set() {
            break;
        }
        let mut w = operator(&basis[k]);
        let before = euclidean_norm(&w);
        let mut column = orthogonalise(&basis, &mut w);
        let mut below = euclidean_norm(&w);
        if below < 0.1 * before {
            // Cancellation has cost orthogonality: a second pass restores it.
            for (h, dh) in column.iter_mut().zip(orthogonalise(&basis, &mut w)) {
                *h += dh;
            }
            below = euclidean_norm(&w);
        }
        for (i, &(c, s)) in rotations.iter().enumerate() {
            (column[i], column[i + 1]) =
                (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let radius = column[k].hypot(below);
        let (c, s) = if radius > 0.0 { (column[k] / radius, below / radius) } else { (1.0, 0.0) };
        column[k] = radius;
        rotations.push((c, s));
        columns.push(column);
        rhs.push(-s * rhs[k]);
        rhs[k] *= c;
        if rhs[k + 1].abs() <= limits.tolerance || below <= EXHAUSTED * before {
            break;
        }
        w.iter_mut().for_each(|x| *x /= below);
        basis.push(w);
    }
    let iterations = columns.len();
    let y = back_substitute(&columns, &rhs);
    (KrylovReport { iterations, residual_norm: rhs[iterations].abs() }, y, basis)
}

/// Removes from `w` its components along the basis; returns them, and a zero for the next one.
fn orthogonalise(basis: &[Vec<f64>], w: &mut [f64]) -> Vec<f64> {
    let mut column = Vec::with_capacity(basis.len() + 1);
    for v in basis {
        let h = dot(v, w);
        axpy(-h, v, w);
        column.push(h);
    }
    column.push(0.0);
    column
}

/// Solves the upper triangular system whose column `j` is `columns[j][..=j]`.
fn back_substitute(columns: &[Vec<f64>], rhs: &[f64]) -> Vec<f64> {
    let mut y = rhs[..columns.len()].to_vec();
    for j in (0..columns.len()).rev() {
        // A zero pivot means that the direction changes nothing: leave it out.
        y[j] = if columns[j][j] == 0.0 { 0.0 } else { y[j] / columns[j][j] };
        for i in 0..j {
            y[i] -= columns[j][i] * y[j];
        }
    }
    y
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Eight independent sums let the compiler use the vector units.
    let mut sums = [0.0; 8];
    let (a8, a_rest) = a.as_chunks::<8>();
    let (b8, b_rest) = b.as_chunks::<8>();
    for (x, y) in a8.iter().zip(b8) {
        for i in 0..8 {
            sums[i] += x[i] * y[i];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}

fn axpy(factor: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

/// Root of the sum of squares.
pub fn euclidean_norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}
