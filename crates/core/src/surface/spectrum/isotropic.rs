//! The spectrum of an isotropic surface from that of a line across it.
//!
//! The two-dimensional density `C2D(q)` in m⁴ is normalised over the whole plane, `integral of C2D
//! d²q = mean of z^2`. A line sees the sum of all waves with the same wavenumber along it, so that of
//! the one-sided line density (an Abel transform, and its inverse)
//!
//! ```text
//! C1D(q) = 4 integral from q to infinity of C2D(k) k dk / sqrt(k^2 - q^2)
//! C2D(q) = -1/(2 π) integral from q to infinity of C1D'(k) dk / sqrt(k^2 - q^2)
//! ```
//!
//! B.N.J. Persson et al., J. Phys.: Condens. Matter 17 (2005) R1, doi:10.1088/0953-8984/17/1/R01;
//! T.D.B. Jacobs, T. Junge, L. Pastewka, Surf. Topogr.: Metrol. Prop. 5 (2017) 013001,
//! doi:10.1088/2051-672X/aa51f8. Whether a surface is isotropic no single line can tell.

use crate::error_kind::{ErrorKind, HasKind};
use statrs::function::beta::{beta, beta_reg};
use statrs::function::gamma::gamma;
use std::f64::consts::PI;
use thiserror::Error;

/// Nodes and weights of Gauss and Legendre's rule of ninth degree on [-1, 1].
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// A line spectrum that has no isotropic counterpart.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum IsotropicError {
    /// Fewer than two points, or as many wavenumbers as densities are not there.
    #[error("{wavenumbers} wavenumbers with {densities} densities; give two of each at least")]
    Count {
        /// Number of wavenumbers.
        wavenumbers: usize,
        /// Number of densities.
        densities: usize,
    },
    /// No power law joins the points.
    #[error(
        "wavenumber {wavenumber} rad/m with density {density} m3: both must be positive, the wavenumbers ascending; leave the point out"
    )]
    NoPowerLaw {
        /// The wavenumber in rad/m.
        wavenumber: f64,
        /// The density in m³.
        density: f64,
    },
    /// A point of a spectrum over the plane that is not one.
    #[error(
        "wavenumber {wavenumber} rad/m with density {density} m4: both must be positive, the wavenumbers ascending; leave the point out"
    )]
    NoDensity {
        /// The wavenumber in rad/m.
        wavenumber: f64,
        /// The density in m⁴.
        density: f64,
    },
}

impl HasKind for IsotropicError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Count { .. } | Self::NoPowerLaw { .. } | Self::NoDensity { .. } => {
                ErrorKind::Input
            }
        }
    }
}

/// Two-dimensional density in m⁴ at the wavenumber `q` (rad/m) of an isotropic self-affine surface,
/// of which a line has the one-sided density `line_density` (m³) there, falling like `q^(-1 - 2 H)`:
/// `C2D = C1D / (2 q) Γ(1 + H) / (sqrt(π) Γ(1/2 + H))`.
///
/// Exact for a power law without end; it fails near a roll-off or a cut-off.
pub fn self_affine_isotropic(q: f64, line_density: f64, hurst_exponent: f64) -> f64 {
    let ratio = gamma(1.0 + hurst_exponent) / (PI.sqrt() * gamma(0.5 + hurst_exponent));
    line_density / (2.0 * q) * ratio
}

/// Two-dimensional density in m⁴ of an isotropic surface at each of the `wavenumbers` (rad/m,
/// ascending) at which a line has the one-sided `densities` (m³): the Abel inverse.
///
/// Between the points the line density is a power law, and beyond the last the one before goes on,
/// or nothing does if it does not fall. With `k = q cosh t` the integrand is smooth. The inverse is
/// that of a derivative and enlarges scatter; where the line density rises it may be negative.
///
/// # Errors
/// Unequal or too few numbers, densities that are not positive.
pub fn abel_inverse(wavenumbers: &[f64], densities: &[f64]) -> Result<Vec<f64>, IsotropicError> {
    if wavenumbers.len() != densities.len() || wavenumbers.len() < 2 {
        let (wavenumbers, densities) = (wavenumbers.len(), densities.len());
        return Err(IsotropicError::Count { wavenumbers, densities });
    }
    let mut before = 0.0;
    for (&wavenumber, &density) in wavenumbers.iter().zip(densities) {
        let joins = wavenumber > before && wavenumber.is_finite();
        if !(joins && density > 0.0 && density.is_finite()) {
            return Err(IsotropicError::NoPowerLaw { wavenumber, density });
        }
        before = wavenumber;
    }
    let pieces: Vec<PowerLaw> = wavenumbers
        .windows(2)
        .zip(densities.windows(2))
        .map(|(q, c)| PowerLaw {
            from: q[0],
            to: q[1],
            density: c[0],
            exponent: (c[0] / c[1]).ln() / (q[1] / q[0]).ln(),
        })
        .collect();
    let last = pieces[pieces.len() - 1];
    let tail = PowerLaw {
        from: last.to,
        density: densities[densities.len() - 1],
        to: f64::INFINITY,
        ..last
    };
    let at = |(i, &q): (usize, &f64)| {
        let within: f64 = pieces[i..].iter().map(|piece| piece.integral(q)).sum();
        (within + tail.integral_to_infinity(q)) / (2.0 * PI)
    };
    Ok(wavenumbers.iter().enumerate().map(at).collect())
}

/// `density (k / from)^-exponent` between two wavenumbers.
#[derive(Debug, Clone, Copy)]
struct PowerLaw {
    from: f64,
    to: f64,
    density: f64,
    exponent: f64,
}

impl PowerLaw {
    /// Integral of `-C1D'(k) / sqrt(k^2 - q^2)` over the piece, for `q` not above it.
    fn integral(self, q: f64) -> f64 {
        let (start, end) = ((self.from / q).max(1.0).acosh(), (self.to / q).acosh());
        let (middle, half) = (f64::midpoint(start, end), (end - start) / 2.0);
        let term =
            |&(node, weight): &(f64, f64)| weight * self.fall(q * (middle + half * node).cosh());
        half * GAUSS.iter().map(term).sum::<f64>()
    }

    /// The same from `from` on without end:
    /// `n C(from) / from (from/q)^(n+1) B(q²/from²; (n+1)/2, 1/2) / 2`.
    fn integral_to_infinity(self, q: f64) -> f64 {
        let n = self.exponent;
        if n <= 0.0 {
            return 0.0;
        }
        let (a, x) = (f64::midpoint(n, 1.0), (q / self.from).powi(2).min(1.0));
        let scale = self.fall(self.from) * (self.from / q).powf(n + 1.0);
        scale * beta(a, 0.5) * beta_reg(a, 0.5, x) / 2.0
    }

    /// `-C1D'(k)`.
    fn fall(self, k: f64) -> f64 {
        self.exponent * self.density / self.from * (k / self.from).powf(-self.exponent - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// `per_decade` wavenumbers a decade from `from` on.
    fn grid(from: f64, decades: usize, per_decade: usize) -> Vec<f64> {
        let at = |j: usize| from * 10_f64.powf(j as f64 / per_decade as f64);
        (0..=decades * per_decade).map(at).collect()
    }

    #[test]
    fn a_power_law_has_the_gamma_form_by_either_route() {
        let q = grid(10.0, 3, 5);
        for hurst in [0.2, 0.65, 1.0] {
            let line: Vec<f64> = q.iter().map(|q| 3e-9 * q.powf(-1.0 - 2.0 * hurst)).collect();
            let found = abel_inverse(&q, &line).unwrap();
            for ((&q, &line), &found) in q.iter().zip(&line).zip(&found) {
                // Gauss' rule on pieces of a fifth of a decade leaves some 1e-7.
                let expected = self_affine_isotropic(q, line, hurst);
                assert_relative_eq!(found, expected, max_relative = 1e-6);
            }
        }
    }

    #[test]
    fn the_gamma_form_is_the_line_integral_of_its_power_law() {
        // H = 1/2: C2D = A q^-3 and C1D = 4 A integral of dk / (k^2 sqrt(k^2 - q^2)) = 4 A / q^2.
        assert_relative_eq!(
            self_affine_isotropic(7.0, 4.0 / 49.0, 0.5),
            7_f64.powi(-3),
            max_relative = 1e-12
        );
    }

    #[test]
    fn a_gaussian_has_the_gaussian_of_its_exact_pair() {
        // C2D = exp(-q² a²/2) a²/(2 π) and C1D = 2 a exp(-q² a²/2) / sqrt(2 π), mean square 1.
        let a = 1e-3;
        let bell = |q: f64| (-(q * a).powi(2) / 2.0).exp();
        // Power laws instead of a Gaussian: the slope is wrong by the width of a piece where the
        // integrand has its inverse root, so the error is of order 3/2 in it.
        for (per_decade, tolerance) in [(50, 2e-2), (200, 2e-2 / 8.0)] {
            let mut q = grid(1.0, 4, per_decade);
            q.retain(|q| q * a < 5.0);
            let line: Vec<f64> = q.iter().map(|&q| 2.0 * a / (2.0 * PI).sqrt() * bell(q)).collect();
            let found = abel_inverse(&q, &line).unwrap();
            for (&q, &found) in q.iter().zip(&found).filter(|(q, _)| **q * a < 3.0) {
                assert_relative_eq!(found, a * a / (2.0 * PI) * bell(q), max_relative = tolerance);
            }
        }
    }

    #[test]
    fn what_no_power_law_joins_is_refused() {
        let count = abel_inverse(&[1.0], &[1.0]).unwrap_err();
        assert_eq!(count, IsotropicError::Count { wavenumbers: 1, densities: 1 });
        for (q, c) in
            [([1.0, 2.0], [1.0, 0.0]), ([2.0, 1.0], [1.0, 1.0]), ([1.0, 2.0], [f64::NAN, 1.0])]
        {
            assert!(matches!(abel_inverse(&q, &c), Err(IsotropicError::NoPowerLaw { .. })));
        }
    }
}
