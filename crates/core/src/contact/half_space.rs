//! The half-space operator in Fourier space.

use crate::rubber::{FrequencyRange, RubberError, Viscoelastic};
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// Surface displacement of a viscoelastic half-space under a pressure that is steady in the frame of the profile, on
/// `points` equidistant points of one period: `w_hat(q) = 2 / (|q| E_r(q v)) t_hat(q)` for `q != 0`, `w_hat(0) = 0`.
///
/// The highest wave of a grid has no direction, so a symbol whose phase is not zero there jumps, and its kernel rings
/// with alternating sign; contact sets then fray at the edges. The phase is therefore tapered smoothly towards the
/// highest wave, `arg C` times `cos^2(π/2 (q/q_max)^2)`: a change of order `(q/q_max)^4` for the waves that the grid
/// resolves, and no change at all for an elastic body.
///
/// The operator owns its buffers, so that an application allocates nothing.
pub struct HalfSpace {
    points: usize,
    period: f64,
    compliance: Vec<Complex64>,
    stiffness: Vec<Complex64>,
    forward: Arc<dyn RealToComplex<f64>>,
    backward: Arc<dyn ComplexToReal<f64>>,
    real: Vec<f64>,
    spectrum: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

/// Direction of an application of the operator.
#[derive(Clone, Copy)]
enum Direction {
    PressureToDisplacement,
    DisplacementToPressure,
}

impl HalfSpace {
    /// Operator for a `period` in m, a sliding `speed` in m/s (negative: against `+x`) and a
    /// number of grid `points`, at least two.
    ///
    /// # Errors
    /// [`RubberError::NotMeasured`] if the rubber is not known at the frequency `q v / 2π` of a wave of the grid.
    pub fn new(
        planner: &mut RealFftPlanner<f64>,
        rubber: &dyn Viscoelastic,
        speed: f64,
        period: f64,
        points: usize,
    ) -> Result<Self, RubberError> {
        let waves = [period, period / (points / 2) as f64];
        if let Some(excited) = FrequencyRange::excited(waves, [speed.abs()]) {
            rubber.require(excited)?;
        }
        let forward = planner.plan_fft_forward(points);
        let backward = planner.plan_fft_inverse(points);
        let bins = points / 2 + 1;
        let compliance: Vec<_> = (0..bins)
            .map(|k| {
                let wavenumber = TAU * k as f64 / period;
                compliance(rubber, speed, wavenumber, 2.0 * k as f64 / points as f64)
            })
            .collect();
        let stiffness = compliance
            .iter()
            .map(|c| if *c == Complex64::ZERO { Complex64::ZERO } else { c.inv() })
            .collect();
        let scratch = forward.get_scratch_len().max(backward.get_scratch_len());
        Ok(Self {
            points,
            period,
            compliance,
            stiffness,
            forward,
            backward,
            real: vec![0.0; points],
            spectrum: vec![Complex64::ZERO; bins],
            scratch: vec![Complex64::ZERO; scratch],
        })
    }

    /// Number of grid points.
    pub fn points(&self) -> usize {
        self.points
    }

    /// Displacement in m (mean zero) under a pressure in Pa; both of length `points`.
    pub fn displacement(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        self.real.copy_from_slice(pressure);
        self.apply(Direction::PressureToDisplacement);
        displacement.copy_from_slice(&self.real);
    }

    /// Pressure in Pa (mean zero) that makes a displacement in m: the inverse of
    /// [`Self::displacement`] on mean-free fields.
    pub fn pressure(&mut self, displacement: &[f64], pressure: &mut [f64]) {
        self.real.copy_from_slice(displacement);
        self.apply(Direction::DisplacementToPressure);
        pressure.copy_from_slice(&self.real);
    }

    /// [`Self::displacement`] from and to a subset of the points only.
    pub(crate) fn displacement_on(&mut self, set: &[u32], pressure: &[f64], out: &mut [f64]) {
        self.restricted(set, pressure, out, Direction::PressureToDisplacement);
    }

    /// [`Self::pressure`] from and to a subset of the points only.
    pub(crate) fn pressure_on(&mut self, set: &[u32], displacement: &[f64], out: &mut [f64]) {
        self.restricted(set, displacement, out, Direction::DisplacementToPressure);
    }

    /// Pressures on a set that make a displacement there of the half-space under a compliant
    /// layer: at each point a `blend` of the filters `1 / (C(q) + k)` for two neighbouring layer
    /// compliances `k` among `levels`, in m/Pa. The mean counts as a wave of one period.
    pub(crate) fn layered_pressure_on(
        &mut self,
        set: &[u32],
        displacement: &[f64],
        levels: &[f64],
        blend: &[(usize, f64)],
        out: &mut [f64],
    ) {
        self.real.fill(0.0);
        for (i, x) in set.iter().zip(displacement) {
            self.real[*i as usize] = *x;
        }
        self.forward_in_place();
        let spectrum = self.spectrum.clone();
        out.fill(0.0);
        let norm = 1.0 / self.points as f64;
        for (level, k) in levels.iter().enumerate() {
            for (bin, (y, x)) in self.spectrum.iter_mut().zip(&spectrum).enumerate() {
                *y = x * norm / (self.compliance[bin.max(1)] + k);
            }
            self.backward_in_place();
            for ((i, (lower, share)), y) in set.iter().zip(blend).zip(out.iter_mut()) {
                let weight = match level {
                    _ if level == *lower => 1.0 - share,
                    _ if level == lower + 1 => *share,
                    _ => continue,
                };
                *y += weight * self.real[*i as usize];
            }
        }
    }

    /// Compliances `|C(q)|` in m/Pa of the longest and of the shortest wave of the grid.
    pub(crate) fn compliance_range(&self) -> (f64, f64) {
        (self.compliance[1].norm(), self.compliance[self.compliance.len() - 1].norm())
    }

    /// Mean of `f g'` over one period, with the exact derivative of the trigonometric interpolant.
    pub fn mean_of_product_with_slope(&mut self, f: &[f64], g: &[f64]) -> f64 {
        let f_spectrum = self.transform(f);
        let g_spectrum = self.transform(g);
        // Parseval on a real signal: both signs of q give the same real part; the highest wave
        // of an even grid has no slope at the points.
        let last = if self.points.is_multiple_of(2) { self.points / 2 } else { usize::MAX };
        f_spectrum
            .iter()
            .zip(&g_spectrum)
            .enumerate()
            .filter(|(k, _)| *k != last)
            .map(|(k, (f, g))| 2.0 * self.wavenumber(k) * (f.conj() * Complex64::I * g).re)
            .sum()
    }

    /// Mean hysteretic power per area and speed `Σ_q |q| Im(-C(q)) |t_hat|²` in Pa, from the
    /// pressure spectrum alone; divided by the mean pressure it is a friction coefficient.
    pub fn hysteretic_traction(&mut self, pressure: &[f64]) -> f64 {
        let spectrum = self.transform(pressure);
        spectrum
            .iter()
            .zip(&self.compliance)
            .enumerate()
            .map(|(k, (t, c))| -2.0 * self.wavenumber(k) * c.im * t.norm_sqr())
            .sum()
    }

    /// Slope in the dimension of `f` per metre at the grid points, by trigonometric interpolation.
    pub fn slope(&mut self, f: &[f64]) -> Vec<f64> {
        self.spectrum = self.transform(f);
        let bins = self.spectrum.len();
        for k in 0..bins {
            let iq = Complex64::new(0.0, self.wavenumber(k));
            self.spectrum[k] *= iq;
        }
        if self.points.is_multiple_of(2) {
            self.spectrum[bins - 1] = Complex64::ZERO;
        }
        self.backward_in_place();
        self.real.clone()
    }

    fn wavenumber(&self, k: usize) -> f64 {
        TAU * k as f64 / self.period
    }

    /// Fourier coefficients, normalised such that the first is the mean.
    fn transform(&mut self, f: &[f64]) -> Vec<Complex64> {
        self.real.copy_from_slice(f);
        self.forward_in_place();
        let norm = 1.0 / self.points as f64;
        self.spectrum.iter().map(|x| x * norm).collect()
    }

    fn restricted(&mut self, set: &[u32], input: &[f64], out: &mut [f64], direction: Direction) {
        self.real.fill(0.0);
        for (i, x) in set.iter().zip(input) {
            self.real[*i as usize] = *x;
        }
        self.apply(direction);
        for (i, y) in set.iter().zip(out) {
            *y = self.real[*i as usize];
        }
    }

    fn apply(&mut self, direction: Direction) {
        self.forward_in_place();
        let symbol = match direction {
            Direction::PressureToDisplacement => &self.compliance,
            Direction::DisplacementToPressure => &self.stiffness,
        };
        let norm = 1.0 / self.points as f64;
        for (s, c) in self.spectrum.iter_mut().zip(symbol) {
            *s *= c * norm;
        }
        self.backward_in_place();
    }

    fn forward_in_place(&mut self) {
        self.forward
            .process_with_scratch(&mut self.real, &mut self.spectrum, &mut self.scratch)
            .expect("buffers are made for this plan");
    }

    fn backward_in_place(&mut self) {
        // The symbols are real at both ends, so only round-off can be there; realfft refuses it.
        self.spectrum[0].im = 0.0;
        if self.points.is_multiple_of(2) {
            self.spectrum[self.points / 2].im = 0.0;
        }
        self.backward
            .process_with_scratch(&mut self.spectrum, &mut self.real, &mut self.scratch)
            .expect("buffers are made for this plan");
    }
}

/// Reduced moduli in Pa that the operator of a grid has for its waves `q = 2π k / period`, `k` from 1 to `(points - 1) / 2`:
/// those of the rubber with the tapered phase of [`HalfSpace`].
pub fn wave_moduli(
    rubber: &dyn Viscoelastic,
    speed: f64,
    period: f64,
    points: usize,
) -> Vec<Complex64> {
    let modulus = |k: usize| {
        let wavenumber = TAU * k as f64 / period;
        let relative = 2.0 * k as f64 / points as f64;
        2.0 / (wavenumber * compliance(rubber, speed, wavenumber, relative))
    };
    (1..=(points - 1) / 2).map(modulus).collect()
}

/// Compliance in m/Pa of the wave with `wavenumber` in rad/m, which is the `relative` part of the
/// highest wavenumber of the grid.
pub(super) fn compliance(
    rubber: &dyn Viscoelastic,
    speed: f64,
    wavenumber: f64,
    relative: f64,
) -> Complex64 {
    if wavenumber == 0.0 {
        return Complex64::ZERO;
    }
    let modulus = rubber.reduced_modulus_of_wave(wavenumber, wavenumber * speed);
    let untapered = 2.0 / (wavenumber * modulus);
    let (modulus, phase) = untapered.to_polar();
    if relative == 1.0 {
        return Complex64::new(modulus, 0.0);
    }
    let taper = (FRAC_PI_2 * relative.powi(2)).cos().powi(2);
    Complex64::from_polar(modulus, phase * taper)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::{MaxwellBranch, Rubber};

    fn rubber() -> Rubber {
        Rubber {
            name: "one branch".into(),
            equilibrium_modulus: 2e6,
            branches: vec![MaxwellBranch { modulus: 5e8, relaxation_time: 1e-4 }],
            poisson_ratio: 0.45,
            finite_strain: Default::default(),
        }
    }

    #[test]
    fn one_wave_is_scaled_and_shifted_by_the_modulus() {
        let (n, period, speed) = (4096, 1e-3, 0.2);
        let mut space =
            HalfSpace::new(&mut RealFftPlanner::new(), &rubber(), speed, period, n).unwrap();
        let q = TAU * 3.0 / period;
        let x = |i: usize| i as f64 * period / n as f64;
        let pressure: Vec<f64> = (0..n).map(|i| 7.0 + (q * x(i)).cos()).collect();
        let mut w = vec![0.0; n];
        space.displacement(&pressure, &mut w);
        let c = 2.0 / (q * rubber().reduced_modulus(q * speed));
        for (i, w) in w.iter().enumerate() {
            let exact = (c * Complex64::from_polar(1.0, q * x(i))).re;
            // The taper changes the phase by (π²/4) (6/4096)^4 = 1e-11.
            assert!((w - exact).abs() < 3e-11 * c.norm(), "{i}: {w} {exact}");
        }
    }

    #[test]
    fn pressure_inverts_displacement_on_odd_and_even_grids() {
        for n in [64, 65] {
            let mut space =
                HalfSpace::new(&mut RealFftPlanner::new(), &rubber(), 1.0, 1e-3, n).unwrap();
            let t: Vec<f64> = (0..n).map(|i| ((i * i) as f64 * 0.7).sin()).collect();
            let mean = t.iter().sum::<f64>() / n as f64;
            let (mut w, mut back) = (vec![0.0; n], vec![0.0; n]);
            space.displacement(&t, &mut w);
            space.pressure(&w, &mut back);
            for (a, b) in t.iter().zip(&back) {
                approx::assert_abs_diff_eq!(a - mean, *b, epsilon = 1e-13);
            }
        }
    }

    #[test]
    fn the_power_of_the_pressure_is_the_work_on_the_slope_of_the_displacement() {
        let n = 500;
        let mut space =
            HalfSpace::new(&mut RealFftPlanner::new(), &rubber(), 0.3, 1e-3, n).unwrap();
        let t: Vec<f64> = (0..n).map(|i| ((i * i) as f64 * 0.11).sin().max(0.0)).collect();
        let mut w = vec![0.0; n];
        space.displacement(&t, &mut w);
        let slope = space.slope(&w);
        let work = t.iter().zip(&slope).map(|(t, s)| t * s).sum::<f64>() / n as f64;
        let power = space.hysteretic_traction(&t);
        assert!(power > 0.0);
        approx::assert_relative_eq!(work, power, max_relative = 1e-12);
        let product = space.mean_of_product_with_slope(&t, &w);
        approx::assert_relative_eq!(product, power, max_relative = 1e-12);
    }
}
