//! The spectrum of an isotropic surface as a table.

use super::isotropic::{IsotropicError, abel_inverse};
use std::f64::consts::TAU;

/// Two-dimensional power spectral density of an isotropic surface, a power law between the points of a table.
///
/// `C(q)` in m⁴ over angular wavenumbers `q` in rad/m is normalised over the whole plane: the mean square height is
/// `∫ C d²q = 2 π ∫ q C dq`. Outside the table there is no roughness.
///
/// ```
/// use asperity_core::surface::spectrum::IsotropicSpectrum;
///
/// // C = 1e-14 m4 (q / 1e3)^-3.6, H = 0.8, from 1e3 to 1e5 rad/m.
/// let density = |q: f64| 1e-14 * (q / 1e3).powf(-3.6);
/// let surface = IsotropicSpectrum::new(vec![1e3, 1e5], vec![density(1e3), density(1e5)])?;
/// assert!((surface.density(1e4) / density(1e4) - 1.0).abs() < 1e-12);
/// println!("{} m rms", surface.rms_height(surface.band()));
/// # Ok::<(), asperity_core::surface::spectrum::IsotropicError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct IsotropicSpectrum {
    /// Ascending, in rad/m.
    wavenumbers: Vec<f64>,
    /// In m⁴.
    densities: Vec<f64>,
}

impl IsotropicSpectrum {
    /// The spectrum through densities in m⁴ at ascending wavenumbers in rad/m.
    ///
    /// # Errors
    /// [`IsotropicError::Count`] for fewer than two points or unequal numbers, [`IsotropicError::NoDensity`] for a number
    /// that is not positive and finite, or a wavenumber that is not above the one before.
    pub fn new(wavenumbers: Vec<f64>, densities: Vec<f64>) -> Result<Self, IsotropicError> {
        if wavenumbers.len() != densities.len() || wavenumbers.len() < 2 {
            let (wavenumbers, densities) = (wavenumbers.len(), densities.len());
            return Err(IsotropicError::Count { wavenumbers, densities });
        }
        let mut before = 0.0;
        for (&wavenumber, &density) in wavenumbers.iter().zip(&densities) {
            let sound = [wavenumber, density].iter().all(|x| x.is_finite() && *x > 0.0);
            if !(sound && wavenumber > before) {
                return Err(IsotropicError::NoDensity { wavenumber, density });
            }
            before = wavenumber;
        }
        Ok(Self { wavenumbers, densities })
    }

    /// The spectrum of an isotropic surface of which a line has the one-sided densities in m³ at ascending wavenumbers in
    /// rad/m, by the Abel inverse ([`abel_inverse`]), and the number of points that were left out because their density
    /// came out at zero or below, where scatter makes the line density rise.
    ///
    /// # Errors
    /// Those of [`abel_inverse`]; [`IsotropicError::Count`] if fewer than two points are left.
    pub fn from_line(
        wavenumbers: &[f64],
        densities: &[f64],
    ) -> Result<(Self, usize), IsotropicError> {
        let plane = abel_inverse(wavenumbers, densities)?;
        let kept = wavenumbers.iter().zip(plane).filter(|(_, c)| c.is_finite() && *c > 0.0);
        let (kept_wavenumbers, kept_densities): (Vec<f64>, Vec<f64>) = kept.unzip();
        let left_out = wavenumbers.len() - kept_wavenumbers.len();
        Ok((Self::new(kept_wavenumbers, kept_densities)?, left_out))
    }

    /// Wavenumbers of the table in rad/m.
    pub fn wavenumbers(&self) -> &[f64] {
        &self.wavenumbers
    }

    /// The smallest and the largest wavenumber in rad/m.
    pub fn band(&self) -> [f64; 2] {
        [self.wavenumbers[0], self.wavenumbers[self.wavenumbers.len() - 1]]
    }

    /// Density in m⁴ at a wavenumber in rad/m; zero outside the table.
    pub fn density(&self, wavenumber: f64) -> f64 {
        let [first, last] = self.band();
        // Wavenumbers that went through a logarithm are met at the ends.
        let outside = wavenumber < first * (1.0 - ROUNDING) || wavenumber > last * (1.0 + ROUNDING);
        if outside || !wavenumber.is_finite() {
            return 0.0;
        }
        let piece = self.piece(wavenumber.clamp(first, last));
        self.densities[piece] * (wavenumber / self.wavenumbers[piece]).powf(-self.exponent(piece))
    }

    /// Root mean square height in m of the waves between two wavenumbers in rad/m: `sqrt(2 π ∫ q C dq)`.
    pub fn rms_height(&self, band: [f64; 2]) -> f64 {
        (TAU * self.moment(1.0, band)).sqrt()
    }

    /// Root mean square of the gradient over the plane of the waves between two wavenumbers in rad/m,
    /// `sqrt(2 π ∫ q³ C dq)`; a line across the surface has the slope of this over `sqrt(2)`.
    pub fn rms_gradient(&self, band: [f64; 2]) -> f64 {
        (TAU * self.moment(3.0, band)).sqrt()
    }

    /// `∫ q^n C dq` between two wavenumbers, exact for the power laws of the table.
    fn moment(&self, n: f64, [from, to]: [f64; 2]) -> f64 {
        let piece = |(k, q): (usize, &[f64])| {
            let (a, b) = (q[0].max(from), q[1].min(to));
            if a >= b {
                return 0.0;
            }
            let (length, growth) = ((b / a).ln(), n + 1.0 - self.exponent(k));
            let x = growth * length;
            let mean = if x == 0.0 { 1.0 } else { x.exp_m1() / x };
            let density = self.densities[k] * (a / q[0]).powf(-self.exponent(k));
            density * a.powf(n + 1.0) * length * mean
        };
        self.wavenumbers.windows(2).enumerate().map(piece).sum()
    }

    /// The piece of the table that holds a wavenumber.
    fn piece(&self, wavenumber: f64) -> usize {
        let above = self.wavenumbers.partition_point(|q| *q <= wavenumber);
        above.saturating_sub(1).min(self.wavenumbers.len() - 2)
    }

    /// The power with which the density falls in a piece.
    fn exponent(&self, piece: usize) -> f64 {
        let ratio = |values: &[f64]| (values[piece + 1] / values[piece]).ln();
        -ratio(&self.densities) / ratio(&self.wavenumbers)
    }
}

/// Relative round-off of a wavenumber that went through a logarithm.
const ROUNDING: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn power_law(exponent: f64, points: usize) -> IsotropicSpectrum {
        let q = |k: usize| 1e2 * 1e3_f64.powf(k as f64 / (points - 1) as f64);
        let wavenumbers: Vec<f64> = (0..points).map(q).collect();
        let densities = wavenumbers.iter().map(|q| 1e-3 * q.powf(-exponent)).collect();
        IsotropicSpectrum::new(wavenumbers, densities).unwrap()
    }

    #[test]
    fn roughness_is_the_closed_integral_of_a_power_law() {
        for points in [2, 31] {
            let surface = power_law(3.6, points);
            let band: [f64; 2] = [3e2, 7e4];
            let integral = |n: f64| {
                let power = n - 2.6;
                1e-3 * (band[1].powf(power) - band[0].powf(power)) / power
            };
            assert_relative_eq!(
                surface.rms_height(band),
                (TAU * integral(1.0)).sqrt(),
                max_relative = 1e-12
            );
            assert_relative_eq!(
                surface.rms_gradient(band),
                (TAU * integral(3.0)).sqrt(),
                max_relative = 1e-12
            );
            assert_relative_eq!(
                surface.density(1e3),
                1e-3 * 1e3_f64.powf(-3.6),
                max_relative = 1e-12
            );
        }
        // A logarithm: n + 1 is the exponent.
        let height = power_law(2.0, 2).rms_height([1e2, 1e5]);
        assert_relative_eq!(height, (TAU * 1e-3 * 1e3_f64.ln()).sqrt(), max_relative = 1e-12);
    }

    #[test]
    fn nothing_is_outside_the_table() {
        let surface = power_law(3.6, 5);
        assert_eq!((surface.density(99.0), surface.density(1.1e5)), (0.0, 0.0));
        assert_eq!(surface.density(f64::NAN), 0.0);
        assert_relative_eq!(surface.rms_height([1.0, 1e9]), surface.rms_height(surface.band()));
    }

    #[test]
    fn a_line_and_the_plane_have_one_mean_square() {
        // The line density of C = A q^-3 is 4 A / q^2 (H = 1/2).
        let q: Vec<f64> = (0..=60).map(|k| 10_f64.powf(2.0 + f64::from(k) / 20.0)).collect();
        let line: Vec<f64> = q.iter().map(|q| 4e-3 / (q * q)).collect();
        let (surface, left_out) = IsotropicSpectrum::from_line(&q, &line).unwrap();
        assert_eq!(left_out, 0);
        // Gauss' rule of the Abel inverse on pieces of a twentieth of a decade.
        assert_relative_eq!(surface.density(1e3), 1e-3 * 1e-9, max_relative = 1e-6);
        // A point where the line density rises steeply has no density over the plane.
        let mut rising = line.clone();
        rising[30] *= 0.5;
        let (_, left_out) = IsotropicSpectrum::from_line(&q, &rising).unwrap();
        assert!(left_out > 0);
    }

    #[test]
    fn what_is_no_spectrum_is_refused() {
        for (q, c) in [
            ([1.0, 2.0], [1.0, -1.0]),
            ([2.0, 1.0], [1.0, 1.0]),
            ([1.0, 1.0], [1.0, 1.0]),
            ([f64::NAN, 1.0], [1.0, 1.0]),
            ([1.0, f64::INFINITY], [1.0, 1.0]),
            ([1.0, 2.0], [0.0, 1.0]),
        ] {
            let refused = IsotropicSpectrum::new(q.to_vec(), c.to_vec());
            assert!(matches!(refused, Err(IsotropicError::NoDensity { .. })), "{q:?} {c:?}");
        }
        for (q, c) in [(vec![1.0], vec![1.0]), (vec![1.0, 2.0], vec![1.0]), (vec![], vec![])] {
            assert!(matches!(IsotropicSpectrum::new(q, c), Err(IsotropicError::Count { .. })));
        }
    }
}
