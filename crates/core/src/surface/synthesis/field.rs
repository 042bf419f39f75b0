//! Gaussian fields of prescribed autocorrelation by circulant embedding.
//!
//! The autocorrelation at the lags of a ring of n points is the first row of a circulant matrix,
//! whose eigenvalues are its Fourier transform; white noise weighted with their roots has exactly
//! that autocorrelation (Dietrich & Newsam 1997, doi:10.1137/S1064827592240555). It exists if no
//! eigenvalue is negative.

use super::random::normal_pair;
use rand::Rng;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner};
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

/// Largest share of negative power taken for rounding (which is near 1e-13) and set to zero.
const ROUNDING_SHARE: f64 = 1e-9;

/// A stationary Gaussian field of unit variance on a ring.
pub(super) struct GaussianField {
    /// `sqrt(eigenvalue / n)` at the wavenumbers 0 ... n/2.
    amplitudes: Vec<f64>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl GaussianField {
    /// The field on `points` (even) points, from its autocorrelation at a distance of so many points.
    ///
    /// # Errors
    /// The share of negative power, if there is no such field.
    pub(super) fn new(points: usize, autocorrelation: impl Fn(usize) -> f64) -> Result<Self, f64> {
        let mut planner = RealFftPlanner::new();
        let forward = planner.plan_fft_forward(points);
        let mut row: Vec<f64> = (0..points).map(|i| autocorrelation(i.min(points - i))).collect();
        let mut spectrum = forward.make_output_vec();
        forward
            .process(&mut row, &mut spectrum)
            .expect("the planner made the output for this input");
        let total: f64 = spectrum.iter().map(|power| power.re.abs()).sum();
        let negative: f64 = spectrum.iter().map(|power| (-power.re).max(0.0)).sum();
        if negative > ROUNDING_SHARE * total {
            return Err(negative / total);
        }
        let amplitude = |power: &Complex<f64>| (power.re.max(0.0) / points as f64).sqrt();
        Ok(Self {
            amplitudes: spectrum.iter().map(amplitude).collect(),
            inverse: planner.plan_fft_inverse(points),
        })
    }

    /// One realisation on the whole ring.
    pub(super) fn realise(&self, rng: &mut impl Rng) -> Vec<f64> {
        let mut spectrum: Vec<Complex<f64>> = self
            .amplitudes
            .iter()
            .map(|amplitude| {
                let (re, im) = normal_pair(rng);
                Complex::new(re, im) * (amplitude * FRAC_1_SQRT_2)
            })
            .collect();
        // The mean and the alternating mode of a real field are real, with the whole variance.
        let last = spectrum.len() - 1;
        for end in [0, last] {
            spectrum[end] = Complex::new(spectrum[end].re / FRAC_1_SQRT_2, 0.0);
        }
        let mut field = self.inverse.make_output_vec();
        self.inverse
            .process(&mut spectrum, &mut field)
            .expect("the ends are real and the lengths are the plan's");
        field
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::statistics::MeanEstimate;
    use rand_pcg::Pcg64;
    use std::f64::consts::TAU;

    const POINTS: usize = 64;

    fn exponential(lag: usize) -> f64 {
        (-0.3 * lag as f64).exp()
    }

    #[test]
    fn amplitudes_carry_the_autocorrelation() {
        let field = GaussianField::new(POINTS, exponential).unwrap();
        for lag in [0, 1, 7, 31, 32] {
            let mode = |k: usize| {
                let power = field.amplitudes[k].powi(2);
                let weight = if k == 0 || k == POINTS / 2 { 1.0 } else { 2.0 };
                weight * power * (TAU * (k * lag) as f64 / POINTS as f64).cos()
            };
            let found: f64 = (0..=POINTS / 2).map(mode).sum();
            // 64 terms of at most unit size.
            assert!((found - exponential(lag)).abs() < 1e-14, "lag {lag}");
        }
    }

    #[test]
    fn realisations_have_the_autocorrelation() {
        let field = GaussianField::new(POINTS, exponential).unwrap();
        let mut rng = Pcg64::new(5, 6);
        let fields: Vec<_> = (0..4000).map(|_| field.realise(&mut rng)).collect();
        for lag in [0, 1, 5, 32] {
            let products: Vec<f64> = fields.iter().map(|y| y[3] * y[3 + lag]).collect();
            let estimate = MeanEstimate::of(&products);
            // Two half widths of the 95 % interval are four standard errors.
            let tolerance = 2.0 * estimate.confidence_95;
            assert!((estimate.mean - exponential(lag)).abs() < tolerance, "lag {lag}");
        }
    }

    #[test]
    fn an_impossible_autocorrelation_is_refused() {
        let boxcar = |lag: usize| if lag < 5 { 1.0 } else { 0.0 };
        let share = GaussianField::new(POINTS, boxcar).err().unwrap();
        assert!(share > 0.1 && share < 0.5);
    }
}
