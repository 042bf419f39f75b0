//! Krylov solvers for matrix-free, nonsymmetric systems.

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

/// A new direction smaller than this, relative, is round-off: the Krylov space is exhausted, and further directions
/// need not even be in the range of the operator.
const EXHAUSTED: f64 = 1e-13;

/// Minimises `|r - B y|` over the Krylov space of `B` and `r` (GMRES without restart, modified
/// Gram-Schmidt; Saad & Schultz 1986, doi:10.1137/0907058) and returns `y` in place of `r`.
///
/// `B` is meant to be a preconditioned operator close to the identity: the complete basis is kept, so memory is
/// `(iterations + 1) * r.len()`. After an `interrupt` the best solution so far is returned.
pub fn gmres(
    mut operator: impl FnMut(&[f64], &mut [f64]),
    residual: &mut [f64],
    limits: KrylovLimits,
    interrupt: &Interrupt,
) -> KrylovReport {
    let mut space = KrylovSpace::new(residual);
    while space.wants_more(limits) && !interrupt.is_set() {
        let mut image = vec![0.0; residual.len()];
        operator(space.last(), &mut image);
        space.extend(image);
    }
    combine(&space.basis, &space.coefficients(), residual);
    space.report()
}

/// Minimises `|r - A x|` over the span of `z_j = M_j^-1 v_j`, `v_j` the orthonormal basis that the
/// images `A z_j` and `r` build (flexible GMRES without restart, Saad 1993,
/// doi:10.1137/0914028), and returns `x` in place of `r`.
///
/// `precondition(v, z)` writes `M^-1 v`; `M` may differ from one application to the next, so it may be
/// as inexact as factors in single precision are: the residual is that of `A` in double
/// precision all the same. Memory is `(2 iterations + 1) * r.len()`. After an `interrupt` the best
/// solution so far is returned.
pub fn flexible_gmres(
    mut operator: impl FnMut(&[f64], &mut [f64]),
    mut precondition: impl FnMut(&[f64], &mut [f64]),
    residual: &mut [f64],
    limits: KrylovLimits,
    interrupt: &Interrupt,
) -> KrylovReport {
    let mut space = KrylovSpace::new(residual);
    let mut directions = Vec::new();
    while space.wants_more(limits) && !interrupt.is_set() {
        let mut direction = vec![0.0; residual.len()];
        precondition(space.last(), &mut direction);
        let mut image = vec![0.0; residual.len()];
        operator(&direction, &mut image);
        directions.push(direction);
        space.extend(image);
    }
    combine(&directions, &space.coefficients(), residual);
    space.report()
}

/// An orthonormal basis that begins with the residual, and the least-squares problem in it: the
/// Hessenberg matrix, made triangular by rotations as it grows.
struct KrylovSpace {
    basis: Vec<Vec<f64>>,
    columns: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    /// Rotated right-hand side; the last entry is the norm of the residual.
    rhs: Vec<f64>,
    exhausted: bool,
}

impl KrylovSpace {
    fn new(residual: &[f64]) -> Self {
        let norm = euclidean_norm(residual);
        let exhausted = norm == 0.0;
        let basis =
            if exhausted { Vec::new() } else { vec![residual.iter().map(|r| r / norm).collect()] };
        Self { basis, columns: Vec::new(), rotations: Vec::new(), rhs: vec![norm], exhausted }
    }

    fn residual_norm(&self) -> f64 {
        self.rhs[self.columns.len()].abs()
    }

    fn wants_more(&self, limits: KrylovLimits) -> bool {
        // A residual that is not a number is not small: it has to show in the solution.
        let small = self.residual_norm() <= limits.tolerance;
        // More basis vectors than unknowns cannot be independent.
        !self.exhausted
            && !small
            && self.columns.len() < limits.max_iterations.min(self.last().len())
    }

    /// The vector whose image comes next.
    fn last(&self) -> &[f64] {
        &self.basis[self.columns.len()]
    }

    /// Adds the image of the last vector.
    fn extend(&mut self, mut w: Vec<f64>) {
        let k = self.columns.len();
        let before = euclidean_norm(&w);
        let mut column = orthogonalise(&self.basis, &mut w);
        let mut below = euclidean_norm(&w);
        if below < 0.1 * before {
            // Cancellation has cost orthogonality: a second pass restores it.
            for (h, dh) in column.iter_mut().zip(orthogonalise(&self.basis, &mut w)) {
                *h += dh;
            }
            below = euclidean_norm(&w);
        }
        for (i, &(c, s)) in self.rotations.iter().enumerate() {
            (column[i], column[i + 1]) =
                (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let radius = column[k].hypot(below);
        let (c, s) = if radius > 0.0 { (column[k] / radius, below / radius) } else { (1.0, 0.0) };
        column[k] = radius;
        self.rotations.push((c, s));
        self.columns.push(column);
        self.rhs.push(-s * self.rhs[k]);
        self.rhs[k] *= c;
        self.exhausted = below <= EXHAUSTED * before;
        if !self.exhausted {
            w.iter_mut().for_each(|x| *x /= below);
            self.basis.push(w);
        }
    }

    /// Coefficients of the vectors that minimise the residual.
    fn coefficients(&self) -> Vec<f64> {
        back_substitute(&self.columns, &self.rhs)
    }

    fn report(&self) -> KrylovReport {
        KrylovReport { iterations: self.columns.len(), residual_norm: self.residual_norm() }
    }
}

/// `sum = sum_j coefficients[j] vectors[j]`
fn combine(vectors: &[Vec<f64>], coefficients: &[f64], sum: &mut [f64]) {
    sum.fill(0.0);
    for (v, y) in vectors.iter().zip(coefficients) {
        axpy(*y, v, sum);
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Three diagonals, of unlike neighbours.
    fn multiply(x: &[f64], y: &mut [f64]) {
        for i in 0..x.len() {
            let below = if i > 0 { x[i - 1] } else { 0.0 };
            let above = x.get(i + 1).unwrap_or(&0.0);
            y[i] = (2.5 + (i as f64).sin()) * x[i] - 1.2 * below - 0.4 * above;
        }
    }

    fn residual_of(x: &[f64], rhs: &[f64]) -> f64 {
        let mut image = vec![0.0; x.len()];
        multiply(x, &mut image);
        let difference: Vec<f64> = image.iter().zip(rhs).map(|(y, b)| b - y).collect();
        euclidean_norm(&difference)
    }

    #[test]
    fn flexible_gmres_solves_with_a_preconditioner_that_changes() {
        let rhs: Vec<f64> = (0..200).map(|i| (0.3 * f64::from(i)).cos()).collect();
        let limits = KrylovLimits { tolerance: 1e-11, max_iterations: 200 };
        let mut count = 0;
        let precondition = |v: &[f64], z: &mut [f64]| {
            count += 1;
            for (i, (z, v)) in z.iter_mut().zip(v).enumerate() {
                // Single precision, and another factor each time.
                let diagonal = 2.5 + (i as f64).sin() + 0.1 * f64::from(count % 3);
                *z = f64::from((v / diagonal) as f32);
            }
        };
        let mut x = rhs.clone();
        let report = flexible_gmres(multiply, precondition, &mut x, limits, &Interrupt::default());
        let residual = residual_of(&x, &rhs);
        assert!(residual < 2e-11, "{report:?}, true residual {residual:e}");
        let mut plain = rhs.clone();
        let report = gmres(multiply, &mut plain, limits, &Interrupt::default());
        let residual = residual_of(&plain, &rhs);
        assert!(residual < 2e-11, "{report:?}, true residual {residual:e}");
    }

    #[test]
    fn a_residual_that_is_not_a_number_has_no_solution_that_is() {
        for bad in [f64::NAN, f64::INFINITY] {
            let limits = KrylovLimits { tolerance: 1e-10, max_iterations: 5 };
            let mut x = vec![1.0, bad, 1.0];
            let report = gmres(multiply, &mut x, limits, &Interrupt::default());
            assert!(!report.residual_norm.is_finite() && x.iter().any(|x| x.is_nan()), "{x:?}");
        }
    }

    #[test]
    fn flexible_gmres_stops_at_a_limit_a_zero_and_an_interrupt() {
        let copy = |v: &[f64], z: &mut [f64]| z.copy_from_slice(v);
        let limits = KrylovLimits { tolerance: 0.0, max_iterations: 3 };
        let mut x = vec![1.0; 50];
        let report = flexible_gmres(multiply, copy, &mut x, limits, &Interrupt::default());
        assert_eq!(report.iterations, 3);
        let mut zero = vec![0.0; 50];
        let report = flexible_gmres(multiply, copy, &mut zero, limits, &Interrupt::default());
        assert_eq!((report.iterations, report.residual_norm), (0, 0.0));
        let interrupt = Interrupt::default();
        interrupt.set();
        let mut x = vec![1.0; 50];
        let report = flexible_gmres(multiply, copy, &mut x, limits, &interrupt);
        assert_eq!(report.iterations, 0);
        assert!(x.iter().all(|&x| x == 0.0));
    }
}
