//! Symmetric tensors in the plane.

use std::ops::{Add, Div, Mul, Sub};

/// A symmetric tensor in the plane: components xx, zz, xz.
pub type Symmetric = [f64; 3];

/// What tensors consist of: a number, or several side by side.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
}

impl<T> Scalar for T where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Div<Output = T>
{
}

/// The unit tensor.
pub const IDENTITY: Symmetric = [1.0, 1.0, 0.0];

/// Determinant.
pub fn determinant(a: &Symmetric) -> f64 {
    a[0] * a[1] - a[2] * a[2]
}

/// Inverse; infinite or NaN for a singular tensor.
pub fn inverse(a: &Symmetric) -> Symmetric {
    let d = determinant(a);
    [a[1] / d, a[0] / d, -a[2] / d]
}

/// `det(1 + a) - 1`, accurate for a small tensor.
pub fn dilatation(a: &Symmetric) -> f64 {
    a[0] + a[1] + determinant(a)
}

/// `det(1 + a) - det(1 + b)` from `a`, `b` and their difference `d = a - b`, as accurate as that.
pub fn dilatation_difference(a: &Symmetric, b: &Symmetric, d: &Symmetric) -> f64 {
    d[0] + d[1] + (a[0] * d[1] + b[1] * d[0]) - (a[2] + b[2]) * d[2]
}

/// `a - b`.
pub fn difference(a: &Symmetric, b: &Symmetric) -> Symmetric {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `1 + a`.
pub fn one_plus(a: &Symmetric) -> Symmetric {
    [1.0 + a[0], 1.0 + a[1], a[2]]
}

/// Double contraction `a : b`.
#[inline]
pub fn contract<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> T {
    let off = a[2] * b[2];
    a[0] * b[0] + a[1] * b[1] + (off + off)
}

/// The product `G X G` of two symmetric tensors, which is symmetric.
#[inline]
pub fn sandwich<T: Scalar>(g: &[T; 3], x: &[T; 3]) -> [T; 3] {
    // Rows of G X first.
    let (xx, xz) = (g[0] * x[0] + g[2] * x[2], g[0] * x[2] + g[2] * x[1]);
    let (zx, zz) = (g[2] * x[0] + g[1] * x[2], g[2] * x[2] + g[1] * x[1]);
    [xx * g[0] + xz * g[2], zx * g[2] + zz * g[1], xx * g[2] + xz * g[1]]
}
