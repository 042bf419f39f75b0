//! Heat flux from the contact into the road.
//!
//! Where rubber and road touch, the flux `q` into the road makes the temperatures of both surfaces differ by that of the
//! interface, elsewhere it is zero. With `T` the temperature of an insulated surface,
//!
//! ```text
//! (R_rubber + R_road + 1/h) q = T   in contact,    q = 0   elsewhere
//! R_rubber = 1 / (κ s),   R_road = erf(|k| sqrt(D_r t_0)) / (κ_r |k|)
//! ```
//!
//! for the wave `k`: the road is at rest in the frame of the profile and is heated by a flux that is taken as constant
//! over the time of sliding. Next to an edge of the contact, where the pressure is below a tenth of its weighted mean, the
//! interface is resistive and lets less through, so that the flux does not jump as points come into contact. The mean has `2 sqrt(D t_0 / π) / κ` of each body. This mixed boundary is solved as it
//! stands, by GMRES on the points in contact.

use super::HeatError;
use super::material::{Road, ThermalSetting};
use crate::numerics::Interrupt;
use crate::numerics::krylov::{KrylovLimits, euclidean_norm, gmres};
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex64;
use statrs::function::erf::erf;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Relative residual of the temperatures in contact.
const TOLERANCE: f64 = 1e-9;
const MOST_ITERATIONS: usize = 400;

/// Decay of the wave `k` in the rubber, `s = sqrt(k² + i k v / D)` in 1/m.
pub(super) fn decay(wavenumber: f64, speed: f64, diffusivity: f64) -> Complex64 {
    Complex64::new(wavenumber * wavenumber, wavenumber * speed / diffusivity).sqrt()
}

/// Rise in K of the surface of the rubber by a heat flux of 1 W/m², for the waves of a period from the mean on.
pub(super) fn of_rubber(
    setting: &ThermalSetting,
    speed: f64,
    period: f64,
    points: usize,
) -> Vec<Complex64> {
    let rubber = setting.rubber;
    let wave = |k: usize| {
        if k == 0 {
            return Complex64::from(rubber.uniform_rise(setting.duration));
        }
        let s = decay(TAU * k as f64 / period, speed, rubber.diffusivity());
        let rise = (rubber.conductivity * s).inv();
        // The highest wave of an even grid has no direction.
        if 2 * k == points { Complex64::from(rise.re) } else { rise }
    };
    (0..=points / 2).map(wave).collect()
}

/// The same of the road, with the resistance of the interface.
fn of_road(road: &Road, duration: f64, period: f64, points: usize) -> Vec<f64> {
    let interface = road.transfer.map_or(0.0, f64::recip);
    let wave = |k: usize| {
        let wavenumber = TAU * k as f64 / period;
        interface
            + road.body.map_or(0.0, |body| match k {
                0 => body.uniform_rise(duration),
                _ => {
                    let reach = (body.diffusivity() * duration).sqrt();
                    erf(wavenumber * reach) / (body.conductivity * wavenumber)
                }
            })
    };
    (0..=points / 2).map(wave).collect()
}

/// An operator on the points of a period, restricted to some of them.
struct OnSet<'a> {
    set: &'a [usize],
    forward: Arc<dyn RealToComplex<f64>>,
    backward: Arc<dyn ComplexToReal<f64>>,
    real: Vec<f64>,
    spectrum: Vec<Complex64>,
}

impl<'a> OnSet<'a> {
    fn new(set: &'a [usize], points: usize) -> Self {
        let mut planner = RealFftPlanner::new();
        let forward = planner.plan_fft_forward(points);
        let (real, spectrum) = (forward.make_input_vec(), forward.make_output_vec());
        Self { set, forward, backward: planner.plan_fft_inverse(points), real, spectrum }
    }

    fn apply(&mut self, symbol: &[Complex64], input: &[f64], output: &mut [f64]) {
        self.real.fill(0.0);
        self.set.iter().zip(input).for_each(|(i, x)| self.real[*i] = *x);
        self.forward
            .process(&mut self.real, &mut self.spectrum)
            .expect("buffers are made for this plan");
        let norm = 1.0 / self.real.len() as f64;
        self.spectrum.iter_mut().zip(symbol).for_each(|(x, c)| *x *= c * norm);
        self.spectrum[0].im = 0.0;
        if self.real.len().is_multiple_of(2) {
            self.spectrum[self.real.len() / 2].im = 0.0;
        }
        self.backward
            .process(&mut self.spectrum, &mut self.real)
            .expect("buffers are made for this plan");
        output.iter_mut().zip(self.set).for_each(|(y, i)| *y = self.real[*i]);
    }
}

/// Pressure, over the mean of the pressure with itself as weight, from which on a point conducts and shears in full.
const EDGE: f64 = 0.1;

/// How far points are in contact: 1 from a tenth of the mean pressure in contact on, in proportion to the pressure below it, zero
/// outside. The number of points in contact jumps, this does not.
pub(super) fn coverage(pressure: &[f64]) -> Vec<f64> {
    let sum: f64 = pressure.iter().map(|t| t.max(0.0)).sum();
    let squares: f64 = pressure.iter().map(|t| t.max(0.0).powi(2)).sum();
    if sum == 0.0 {
        return vec![0.0; pressure.len()];
    }
    let full = EDGE * squares / sum;
    pressure.iter().map(|t| (t / full).clamp(0.0, 1.0)).collect()
}

/// Flux in W/m² into the road on the points of the period, for the `insulated` temperature in K of the surface of the
/// rubber there, its rise by a unit flux and the [`coverage`].
///
/// A point of the coverage `c` has the further resistance `R (1/c - 1)`, with `R` that of the highest wave; the unknowns are the fluxes
/// over `sqrt(c)`.
///
/// # Errors
/// [`HeatError::Conduction`].
pub(super) fn flux(
    road: &Road,
    duration: f64,
    period: f64,
    of_rubber: &[Complex64],
    insulated: &[f64],
    coverage: &[f64],
) -> Result<Vec<f64>, HeatError> {
    let points = coverage.len();
    let mut flux = vec![0.0; points];
    let set: Vec<usize> = (0..points).filter(|i| coverage[*i] > 0.0).collect();
    let roots: Vec<f64> = set.iter().map(|i| coverage[*i].sqrt()).collect();
    let wanted: Vec<f64> = set.iter().zip(&roots).map(|(i, c)| c * insulated[*i]).collect();
    let scale = euclidean_norm(&wanted);
    if scale == 0.0 {
        return Ok(flux);
    }
    let symbol: Vec<Complex64> = of_road(road, duration, period, points)
        .iter()
        .zip(of_rubber)
        .map(|(road, rubber)| rubber + road)
        .collect();
    let inverse: Vec<Complex64> = symbol.iter().map(Complex64::inv).collect();
    let edge = symbol.last().map_or(0.0, |c| c.norm());
    let mut on_set = OnSet::new(&set, points);
    let resist = |on_set: &mut OnSet, x: &[f64], y: &mut [f64]| {
        let scaled: Vec<f64> = x.iter().zip(&roots).map(|(x, c)| c * x).collect();
        on_set.apply(&symbol, &scaled, y);
        for ((y, x), c) in y.iter_mut().zip(x).zip(&roots) {
            *y = c * *y + (1.0 - c * c) * edge * x;
        }
    };
    let mut solution = vec![0.0; set.len()];
    on_set.apply(&inverse, &wanted, &mut solution);
    let tolerance = 0.1 * TOLERANCE * euclidean_norm(&solution);
    let limits = KrylovLimits { tolerance, max_iterations: MOST_ITERATIONS };
    let mut image = vec![0.0; set.len()];
    let operator = |x: &[f64], y: &mut [f64]| {
        resist(&mut on_set, x, &mut image);
        on_set.apply(&inverse, &image, y);
    };
    let report = gmres(operator, &mut solution, limits, &Interrupt::default());
    resist(&mut on_set, &solution, &mut image);
    let gap: Vec<f64> = image.iter().zip(&wanted).map(|(a, b)| a - b).collect();
    let residual = euclidean_norm(&gap) / scale;
    if residual.is_nan() || residual > TOLERANCE {
        return Err(HeatError::Conduction { residual, iterations: report.iterations });
    }
    for ((i, q), c) in set.iter().zip(&solution).zip(&roots) {
        flux[*i] = c * q;
    }
    Ok(flux)
}
