//! The strain that waves meet below a contact.
//!
//! Below the displacement `Re Σ w_q e^(iqx)` of an incompressible half-plane the tensor shear strain is
//! `e(x, z) = z Σ q² w_q e^(iqx - qz)`; `|e|` of one wave is `q |w_q| qz e^(-qz)`. A wave `q` meets the strain of the waves up to itself, those
//! that are not shorter, where it works itself:
//!
//! ```text
//! ε_q² = ∫ 4 q³ z² e^(-2qz) <|e_{<=q}(x, z)|²> dz
//! ```
//!
//! with a mean over x that has the pressure as its weight. By itself one wave has `ε_q = sqrt(3/32) q |w_q|`.

use crate::heat::LineLoad;
use crate::numerics::Complex64;
use crate::numerics::interpolation::CubicHermite;
use crate::numerics::plane::fast_length;
use nalgebra::{SMatrix, SymmetricEigen};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use rustfft::FftPlanner;
use std::f64::consts::TAU;

/// Nodes over depth; the rule integrates `y^4 e^(-2y)` to 1e-9.
const NODES: usize = 16;
/// Waves from the longest on that are all computed, and per octave after them; those between are interpolated.
const ALL: usize = 8;
const PER_OCTAVE: f64 = 4.0;

/// Root mean square tensor shear strain ε_q that each wave of a load meets, from the longest on. The load needs at least three
/// points and a positive mean pressure.
pub fn strain_of_waves(load: &LineLoad) -> Vec<f64> {
    let waves = load.moduli.len();
    let strain = Strain::new(load);
    let rule = laguerre();
    let sampled = sampled(waves);
    let values: Vec<f64> = sampled.par_iter().map(|m| strain.of_wave(*m, &rule)).collect();
    if sampled.len() == waves {
        return values;
    }
    let logarithms = sampled.iter().map(|m| (*m as f64).ln()).collect();
    let curve = CubicHermite::monotone_parabolas(logarithms, values);
    (1..=waves).map(|m| curve.at((m as f64).ln())).collect()
}

/// Numbers of the waves that are computed.
fn sampled(waves: usize) -> Vec<usize> {
    let mut list: Vec<usize> = (1..=ALL.min(waves)).collect();
    let mut step = 1;
    while list.last().is_some_and(|m| *m < waves) {
        let next = (ALL as f64 * (f64::from(step) / PER_OCTAVE).exp2()).round() as usize;
        list.push(next.min(waves));
        step += 1;
    }
    list
}

/// Nodes and weights of `∫ y^4 e^(-y) h(y) dy` (Golub & Welsch 1969, doi:10.1090/S0025-5718-69-99647-1).
fn laguerre() -> Vec<(f64, f64)> {
    let power = 4.0;
    let jacobi = SMatrix::<f64, NODES, NODES>::from_fn(|i, j| {
        let k = i.max(j) as f64;
        match i.abs_diff(j) {
            0 => 2.0 * k + power + 1.0,
            1 => (k * (k + power)).sqrt(),
            _ => 0.0,
        }
    });
    let eigen = SymmetricEigen::new(jacobi);
    // The integral of the weight is 4!.
    let weight = |j: usize| 24.0 * eigen.eigenvectors[(0, j)].powi(2);
    (0..NODES).map(|j| (eigen.eigenvalues[j], weight(j))).collect()
}

struct Strain {
    longest: f64,
    /// `q² w_q` of each wave.
    curvature: Vec<Complex64>,
    /// Fourier coefficients of the pressure over its mean.
    weight: Vec<Complex64>,
}

impl Strain {
    fn new(load: &LineLoad) -> Self {
        let longest = TAU / load.period;
        let mut real = load.pressure.to_vec();
        let forward = RealFftPlanner::new().plan_fft_forward(real.len());
        let mut spectrum = forward.make_output_vec();
        forward.process(&mut real, &mut spectrum).expect("buffers are made for this plan");
        let norm = 1.0 / load.pressure.len() as f64;
        let mean = spectrum[0].re * norm;
        let curvature = spectrum[1..]
            .iter()
            .zip(load.moduli)
            .enumerate()
            // w_q = 2 t_q / (q E_r), and t_q is twice the coefficient of a real signal.
            .map(|(i, (t, e))| 4.0 * norm * (i + 1) as f64 * longest * t / e)
            .collect();
        let weight = spectrum.iter().map(|t| t * norm / mean).collect();
        Self { longest, curvature, weight }
    }

    /// Strain that wave `m` meets.
    fn of_wave(&self, m: usize, rule: &[(f64, f64)]) -> f64 {
        let points = fast_length(2 * m + 1);
        let backward = FftPlanner::new().plan_fft_inverse(points);
        let real = RealFftPlanner::<f64>::new().plan_fft_inverse(points);
        let mut spectrum = real.make_input_vec();
        spectrum[..=m].copy_from_slice(&self.weight[..=m]);
        let mut weight = real.make_output_vec();
        real.process(&mut spectrum, &mut weight).expect("buffers are made for this plan");
        let q = m as f64 * self.longest;
        let mut field = vec![Complex64::ZERO; points];
        let mut sum = 0.0;
        for (y, part) in rule {
            let depth = 0.5 * y / q;
            field.fill(Complex64::ZERO);
            for (k, (f, a)) in field[1..].iter_mut().zip(&self.curvature[..m]).enumerate() {
                *f = a * (-((k + 1) as f64 * self.longest * depth)).exp();
            }
            backward.process(&mut field);
            let mean: f64 = field.iter().zip(&weight).map(|(e, w)| e.norm_sqr() * w).sum();
            sum += part * mean / points as f64;
        }
        // The pressure weighs with its waves up to m alone, so a mean of next to nothing may be below zero.
        (sum.max(0.0) / 8.0).sqrt() / q
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load<'a>(pressure: &'a [f64], moduli: &'a [Complex64]) -> LineLoad<'a> {
        LineLoad { speed: 0.1, period: 1e-3, pressure, moduli }
    }

    #[test]
    fn one_wave_has_its_closed_form_and_shorter_ones_meet_less_of_it() {
        let points = 256;
        let at = |i: usize| 1e5 + 4e4 * (TAU * (3 * i) as f64 / points as f64).cos();
        let pressure: Vec<f64> = (0..points).map(at).collect();
        let moduli = vec![Complex64::new(4e6, 1e6); 127];
        let strain = strain_of_waves(&load(&pressure, &moduli));
        let slope = 2.0 * 4e4 / moduli[0].norm();
        approx::assert_relative_eq!(
            strain[2],
            (3.0_f64 / 32.0).sqrt() * slope,
            max_relative = 1e-7
        );
        assert!(strain[0].abs() < 1e-12 && strain[1].abs() < 1e-12);
        // At depths of less than its length the strain of a long wave is q² |w| z: sqrt(4/32 5!/...) of y^4 e^-y.
        for (m, met) in (4..=127).zip(&strain[3..]) {
            let ratio = 3.0 / f64::from(m);
            // ∫ y^4 e^(-y (1 + ratio)) dy = 24 / (1 + ratio)^5.
            let expected = slope * ratio * (3.0 / (1.0 + ratio).powi(5)).sqrt();
            // Between the waves that are computed it is interpolated.
            assert!((met / expected - 1.0).abs() < 3e-3, "{m}: {met} {expected}");
        }
    }

    #[test]
    fn strains_are_those_of_a_plain_sum_over_points_and_depths() {
        let points = 40;
        let pressure: Vec<f64> =
            (0..points).map(|i| 1e5 * (f64::from(i) * 0.31).sin().max(0.0)).collect();
        let moduli: Vec<Complex64> =
            (1..20).map(|k| Complex64::new(4e6, 2e5 * f64::from(k))).collect();
        let load = load(&pressure, &moduli);
        let found = strain_of_waves(&load);
        let coefficient = |k: usize| -> Complex64 {
            let wave = |(i, t): (usize, &f64)| {
                t * Complex64::from_polar(1.0, -TAU * (k * i) as f64 / 40.0) / 40.0
            };
            pressure.iter().enumerate().map(wave).sum()
        };
        let coefficients: Vec<Complex64> = (0..20).map(coefficient).collect();
        let coefficient = |k: usize| coefficients[k];
        let longest = TAU / load.period;
        for m in [1_usize, 4, 8] {
            let q = m as f64 * longest;
            let n = 2000;
            let step = 20.0 / q / f64::from(n);
            let mut sum = 0.0;
            for j in 0..n {
                let z = (f64::from(j) + 0.5) * step;
                // Points between those of the grid do not matter: the pressure is its trigonometric interpolant.
                for i in 0..80 {
                    let x = load.period * f64::from(i) / 80.0;
                    let mut e = Complex64::ZERO;
                    let mut weight = coefficient(0).re;
                    for k in 1..20 {
                        let wave = Complex64::from_polar(1.0, longest * k as f64 * x);
                        weight += 2.0 * (coefficient(k) * wave).re;
                        if k <= m {
                            let w = longest * k as f64;
                            let t = 2.0 * coefficient(k);
                            e += z * 2.0 * w * t / moduli[k - 1] * wave * (-w * z).exp();
                        }
                    }
                    weight /= coefficient(0).re * 80.0;
                    sum += 4.0
                        * q.powi(3)
                        * z
                        * z
                        * (-2.0 * q * z).exp()
                        * step
                        * weight
                        * e.norm_sqr();
                }
            }
            approx::assert_relative_eq!(found[m - 1], sum.sqrt(), max_relative = 1e-5);
        }
    }
}
