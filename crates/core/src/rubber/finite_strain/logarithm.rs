//! The logarithm of the right Cauchy-Green tensor in the plane, with its first two derivatives.

use super::symmetric::{Symmetric, dilatation};

/// `ln C` at one deformation. With half the trace `c`, the deviator `C'`, `q = C' : C' / 2` and
/// `D = det C = c² - q`,
///
/// ```text
/// ln C = ½ ln D 1 + g C',    g = artanh(√q / c) / √q
/// ```
///
/// `g` is analytic in `c` and `q`, so equal eigenvalues are no special case:
///
/// ```text
/// ∂g/∂c = -1/D,    h = ∂g/∂q = (c/D - g) / (2 q)
/// ∂h/∂c = -1/D²,   k = ∂h/∂q = (c/D² - 3 h) / (2 q)
/// ```
///
/// This is the closed form in the plane of what Miehe, Apel and Lambrecht (2002),
/// doi:10.1016/S0045-7825(02)00438-3, write in eigenvectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Logarithm {
    /// c.
    mean: f64,
    determinant: f64,
    deviator: Deviator,
    /// ln D.
    volumetric: f64,
    g: f64,
    h: f64,
    k: f64,
}

/// A symmetric tensor without trace: components xx and xz.
type Deviator = [f64; 2];

/// `q / c²` below which the differences in `h` and `k` lose digits.
const NEARLY_EQUAL: f64 = 0.04;

impl Logarithm {
    /// The logarithm of `1 + strain`, accurate for a small strain; `None` if the tensor is not positive definite.
    pub fn new(strain: &Symmetric) -> Option<Self> {
        let mean = 1.0 + 0.5 * (strain[0] + strain[1]);
        let dilatation = dilatation(strain);
        let determinant = 1.0 + dilatation;
        if !(mean > 0.0 && determinant > 0.0) {
            return None;
        }
        let deviator = [0.5 * (strain[0] - strain[1]), strain[2]];
        let volumetric = dilatation.ln_1p();
        let q = 0.5 * contract(&deviator, &deviator);
        let (by_mean, by_square) = (mean / determinant, mean / (determinant * determinant));
        let ratio = q / (mean * mean);
        let (g, h, k) = if ratio < NEARLY_EQUAL {
            let k = series(ratio) / mean.powi(5);
            let h = (by_square - 2.0 * q * k) / 3.0;
            (by_mean - 2.0 * q * h, h, k)
        } else {
            let root = q.sqrt();
            let g = ((mean + root).ln() - 0.5 * volumetric) / root;
            let h = (by_mean - g) / (2.0 * q);
            (g, h, (by_square - 3.0 * h) / (2.0 * q))
        };
        Some(Self { mean, determinant, deviator, volumetric, g, h, k })
    }

    /// `ln C`.
    pub fn value(&self) -> Symmetric {
        tensor(0.5 * self.volumetric, self.deviator.map(|c| self.g * c))
    }

    /// `d ln C / dC : X`, which is also `X : d ln C / dC`.
    #[inline]
    pub fn derivative(&self, x: &Symmetric) -> Symmetric {
        let (mean, deviator) = split(x);
        let along = contract(&self.deviator, &deviator);
        let growth = mean / self.determinant;
        let turn = self.h * along - growth;
        tensor(
            self.mean * growth - 0.5 * along / self.determinant,
            [0, 1].map(|i| turn * self.deviator[i] + self.g * deviator[i]),
        )
    }

    /// `T : d² ln C / dC² : δC`: the change of `T : d ln C / dC` with `C`.
    #[inline]
    pub fn second_derivative(&self, stress: &Symmetric, change: &Symmetric) -> Symmetric {
        let (t, stress) = split(stress);
        let (dc, change) = split(change);
        let along = contract(&self.deviator, &stress);
        let dq = contract(&self.deviator, &change);
        let per_volume = 1.0 / self.determinant;
        let growth = (2.0 * self.mean * dc - dq) * per_volume;
        let dg = self.h * dq - dc * per_volume;
        let dh = self.k * dq - dc * per_volume * per_volume;
        let dalong = contract(&change, &stress);
        let mean = (dc * t - 0.5 * dalong - (self.mean * t - 0.5 * along) * growth) * per_volume;
        let turn = self.h * along - t * per_volume;
        let dturn = dh * along + self.h * dalong + t * growth * per_volume;
        tensor(mean, [0, 1].map(|i| dturn * self.deviator[i] + turn * change[i] + dg * stress[i]))
    }
}

/// `k c⁵ = Σ (n + 1) (n + 2) / (2 n + 5) (q / c²)^n`.
fn series(ratio: f64) -> f64 {
    // The first term left out is below 3e-17 of the sum.
    (0..13)
        .rev()
        .map(f64::from)
        .fold(0.0, |sum, n| sum * ratio + (n + 1.0) * (n + 2.0) / (2.0 * n + 5.0))
}

/// Half the trace and the deviator.
#[inline]
fn split(x: &Symmetric) -> (f64, Deviator) {
    (0.5 * (x[0] + x[1]), [0.5 * (x[0] - x[1]), x[2]])
}

#[inline]
fn tensor(mean: f64, deviator: Deviator) -> Symmetric {
    [mean + deviator[0], mean - deviator[0], deviator[1]]
}

#[inline]
fn contract(a: &Deviator, b: &Deviator) -> f64 {
    2.0 * (a[0] * b[0] + a[1] * b[1])
}

#[cfg(test)]
mod tests {
    use super::super::symmetric::one_plus;
    use super::*;
    use nalgebra::{Matrix2, SymmetricEigen};

    /// Relative difference of the eigenvalues of `C`: none, in the range of the series, at its end,
    /// beyond it. A ratio of 1.5 is `q / c² = 0.04`.
    const RATIOS: [f64; 12] =
        [0.0, 1e-16, 1e-12, 1e-8, 1e-5, 1e-3, 0.03, 0.4, 0.4999, 0.5001, 3.0, 60.0];

    fn matrix(x: &Symmetric) -> Matrix2<f64> {
        Matrix2::new(x[0], x[2], x[2], x[1])
    }

    fn strains() -> impl Iterator<Item = Symmetric> {
        RATIOS.into_iter().flat_map(|ratio| {
            [0.2, 1.0, 3.0].into_iter().flat_map(move |smallest: f64| {
                [0.0, 0.3, 1.1, 2.5].map(|angle: f64| {
                    let (sine, cosine) = angle.sin_cos();
                    let more = ratio * smallest;
                    [
                        smallest - 1.0 + more * cosine * cosine,
                        smallest - 1.0 + more * sine * sine,
                        more * sine * cosine,
                    ]
                })
            })
        })
    }

    /// `(ln(1 + x) - x) / x²`.
    fn second_order(x: f64) -> f64 {
        if x.abs() > 0.1 {
            return (x.ln_1p() - x) / (x * x);
        }
        (2..20).rev().fold(0.0, |sum, n| 1.0 / f64::from(n) - x * sum).copysign(-1.0)
    }

    /// Divided difference of the logarithm at three eigenvalues, two of which are one.
    fn divided(a: f64, b: f64, c: f64) -> f64 {
        let (twice, once) = if a == b {
            (a, c)
        } else if a == c {
            (a, b)
        } else {
            (b, a)
        };
        second_order((once - twice) / twice) / (twice * twice)
    }

    /// First and second derivative in the basis of the eigenvectors (Daleckii and Krein).
    fn oracle(c: &Matrix2<f64>, h: &Matrix2<f64>, k: &Matrix2<f64>) -> [Matrix2<f64>; 3] {
        let SymmetricEigen { eigenvectors: q, eigenvalues: l } = c.symmetric_eigen();
        let (h, k) = (q.transpose() * h * q, q.transpose() * k * q);
        let value = Matrix2::from_diagonal(&l.map(f64::ln));
        let first = Matrix2::from_fn(|i, j| {
            let x = (l[j] - l[i]) / l[i];
            h[(i, j)] * (1.0 + x * second_order(x)) / l[i]
        });
        let second = Matrix2::from_fn(|i, j| {
            (0..2)
                .map(|n| {
                    let product = h[(i, n)] * k[(n, j)] + k[(i, n)] * h[(n, j)];
                    divided(l[i], l[j], l[n]) * product
                })
                .sum()
        });
        [value, first, second].map(|x| q * x * q.transpose())
    }

    #[test]
    fn value_and_derivatives_are_those_of_the_eigenvectors() {
        let (h, k) = ([0.7, -0.4, 0.9], [-0.2, 1.3, 0.5]);
        for strain in strains() {
            let logarithm = Logarithm::new(&strain).unwrap();
            let ours =
                [logarithm.value(), logarithm.derivative(&h), logarithm.second_derivative(&h, &k)];
            let theirs = oracle(&matrix(&one_plus(&strain)), &matrix(&h), &matrix(&k));
            for (order, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
                let error = (matrix(ours) - theirs).amax();
                // Round-off of C over its smallest eigenvalue of 0.2, to the power of the order.
                let scale = theirs.amax().max(1.0);
                assert!(error < 1e-12 * scale, "{strain:?}, order {order}: {error} of {scale}");
            }
        }
    }

    #[test]
    fn a_tensor_that_is_not_positive_has_none() {
        for strain in [[-1.0, 0.0, 0.0], [-3.0, -3.0, 0.0], [0.0, 0.0, 1.1], [f64::NAN; 3]] {
            assert_eq!(Logarithm::new(&strain), None, "{strain:?}");
        }
    }
}
