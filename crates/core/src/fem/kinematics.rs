//! Kinematics in the plane.

use crate::rubber::finite_strain::{Scalar, Symmetric};

/// A tensor in the plane: components xx, xz, zx, zz.
pub type Tensor = [f64; 4];

/// `C - 1` from the displacement gradient.
#[inline]
pub fn green_strain(h: &Tensor) -> Symmetric {
    [
        2.0 * h[0] + h[0] * h[0] + h[2] * h[2],
        2.0 * h[3] + h[1] * h[1] + h[3] * h[3],
        h[1] + h[2] + h[0] * h[1] + h[2] * h[3],
    ]
}

/// Change of the right Cauchy-Green tensor for a change of the deformation.
#[inline]
pub fn strain_change<T: Scalar>(f: &[T; 4], df: &[T; 4]) -> [T; 3] {
    let (xx, zz) = (f[0] * df[0] + f[2] * df[2], f[1] * df[1] + f[3] * df[3]);
    [xx + xx, zz + zz, f[0] * df[1] + f[2] * df[3] + df[0] * f[1] + df[2] * f[3]]
}

/// Change of `C` when a node moves along x (0) or z (1) by one; `gradient` is that of its shape
/// function.
#[inline]
pub fn nodal_strain_change(f: &Tensor, gradient: &[f64; 2], direction: usize) -> Symmetric {
    let row = [f[2 * direction], f[2 * direction + 1]];
    [
        2.0 * row[0] * gradient[0],
        2.0 * row[1] * gradient[1],
        row[0] * gradient[1] + row[1] * gradient[0],
    ]
}
