//! The exact heat source of a half-plane that slides in steady contact with a line.
//!
//! For `nu = 1/2` the stress deviator below the pressure `t_0 + Re Σ t_q e^(iqx)` is one complex number,
//! `(s_xx - s_zz)/2 + i s_xz = z Σ_{q>0} q t_q e^(iqx - qz)`. In a rubber of springs and dashpots, branch `k` of shear modulus `G_k` and
//! relaxation time `τ_k`, each branch carries the part `S_k` of it and makes the heat `|S_k|² / (G_k τ_k)`. Two waves of
//! frequencies `ω = q v` then contribute in the product of their strains the factor
//!
//! ```text
//! Σ_k G_k/τ_k conj(b_k(ω_1)) b_k(ω_2) = i ω_1 ω_2 / (ω_1 + ω_2) [conj G(ω_1) - G(ω_2)],    b_k(ω) = iωτ_k / (1 + iωτ_k)
//! ```
//!
//! by partial fractions, in which the branches no longer occur: the heat follows from the complex modulus alone, so a table of
//! measured moduli has the same right to it as a Prony series. As `ω_1 + ω_2 = (q_1 + q_2) v` and fields decay like
//! `e^(-(q_1 + q_2) z)`, the quotient is an integral over depth:
//!
//! ```text
//! Q(x, z) = z² ∫_z^∞ 2 v Im[conj(V) U] dz',    U = Σ q² t_q e^(iqx - qz'),    V = Σ q² t_q / G_q e^(iqx - qz'),    G = E_r / 4
//! ```
//!
//! two transforms a depth, whatever the number of branches. One wave heats as `4 q³ z² e^(-2qz)`, uniformly along `x`.
//!
//! With `G = E_r / 4` the total is exact for any Poisson ratio; at 0.49 a share `1 - 2 nu` = 2 % of it has the depth profile of the
//! mean stress instead. Where waves have moduli of their own, softened or shifted by their temperature, the heat of each wave
//! by itself is still exact, and so is the total; the mixed terms then follow from the moduli of both waves by the same formula.

use super::HeatError;
use super::depth::{Depths, NODES};
use super::material::{ThermalSetting, positive};
use crate::numerics::plane::fast_length;
use rayon::prelude::*;
use realfft::RealFftPlanner;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// Amplitudes of waves below this part of the largest pressure are the round-off of their transform.
const ROUND_OFF: f64 = 1e-15;

/// Largest relative difference between the heat of the field and the power of the spectrum.
pub const CLOSURE: f64 = 1e-8;

/// A pressure that is steady in the frame of the profile, and the rubber that carries it.
#[derive(Debug, Clone, Copy)]
pub struct LineLoad<'a> {
    /// Speed v of the rubber in m/s; against `+x` if negative.
    pub speed: f64,
    /// Period L in m.
    pub period: f64,
    /// Pressure in Pa on equidistant points of the period.
    pub pressure: &'a [f64],
    /// Reduced moduli `E_r(q v) = E / (1 - nu²)` in Pa of the waves `q = 2π k / L` for `k` from 1 to `(points - 1) / 2`: all but the
    /// highest of an even grid, which has no direction. See `contact::half_space::wave_moduli`.
    pub moduli: &'a [Complex64],
}

impl LineLoad<'_> {
    fn check(&self) -> Result<(), HeatError> {
        if !(self.speed != 0.0 && self.speed.is_finite()) {
            let (quantity, value) = ("the speed in m/s", self.speed);
            return Err(HeatError::OutOfRange { quantity, value, range: "finite and not zero" });
        }
        positive("the period in m", self.period)?;
        let points = self.pressure.len();
        if points < 3 {
            let (quantity, value) = ("the number of points", points as f64);
            return Err(HeatError::OutOfRange { quantity, value, range: "at least 3" });
        }
        let (found, expected) = (self.moduli.len(), (points - 1) / 2);
        if found != expected {
            return Err(HeatError::Length { quantity: "moduli of waves", found, expected });
        }
        finite("pressure", self.pressure)?;
        for modulus in self.moduli {
            // Of a rubber; the sign of its loss is that of the speed.
            if !(modulus.re > 0.0 && modulus.is_finite()) {
                let (quantity, value) = ("the storage modulus of a wave in Pa", modulus.re);
                return Err(HeatError::OutOfRange {
                    quantity,
                    value,
                    range: "positive and finite",
                });
            }
        }
        Ok(())
    }

    /// Amplitudes `t_q` in Pa of `t_0 + Re Σ t_q e^(iqx)`, without the mean.
    fn amplitudes(&self) -> Vec<Complex64> {
        let largest = self.pressure.iter().fold(0.0_f64, |a, t| a.max(t.abs()));
        let least = ROUND_OFF * largest;
        let amplitude = |t: &Complex64| if t.norm() < least { Complex64::ZERO } else { 2.0 * t };
        spectrum(self.pressure)[1..=self.moduli.len()].iter().map(amplitude).collect()
    }
}

pub(super) fn finite(quantity: &'static str, values: &[f64]) -> Result<(), HeatError> {
    match values.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(HeatError::NotFinite { quantity, index, value: values[index] }),
        None => Ok(()),
    }
}

/// Fourier coefficients of values on a period, the first of which is their mean.
pub(super) fn spectrum(values: &[f64]) -> Vec<Complex64> {
    let mut real = values.to_vec();
    let forward = RealFftPlanner::new().plan_fft_forward(values.len());
    let mut result = forward.make_output_vec();
    forward.process(&mut real, &mut result).expect("buffers are made for this plan");
    let norm = 1.0 / values.len() as f64;
    result.iter_mut().for_each(|c| *c *= norm);
    result
}

/// Values on a period of Fourier coefficients, of which the highest may be left out.
pub(super) fn on_points(coefficients: impl Iterator<Item = Complex64>, points: usize) -> Vec<f64> {
    let backward = RealFftPlanner::new().plan_fft_inverse(points);
    let mut input = backward.make_input_vec();
    input.iter_mut().zip(coefficients).for_each(|(a, b)| *a = b);
    input[0].im = 0.0;
    if points.is_multiple_of(2) {
        input[points / 2].im = 0.0;
    }
    let mut result = backward.make_output_vec();
    backward.process(&mut input, &mut result).expect("buffers are made for this plan");
    result
}

/// Heat in W/m³ below a sliding contact.
#[derive(Debug, Clone)]
pub struct HeatSource {
    speed: f64,
    period: f64,
    points: usize,
    depths: Depths,
    /// Fourier coefficients along the period: for each panel those of its waves from the mean on, the nodes of the panel
    /// next to each other.
    panels: Vec<Vec<Complex64>>,
    power: f64,
    heat: f64,
}

impl HeatSource {
    /// The source under a load, at depths that also resolve the temperature that it makes.
    ///
    /// # Errors
    /// [`HeatError::OutOfRange`], [`HeatError::Length`] or [`HeatError::NotFinite`] for input that does not fit;
    /// [`HeatError::NotClosed`] if heat and power differ by more than [`CLOSURE`].
    pub fn new(load: &LineLoad, setting: &ThermalSetting) -> Result<Self, HeatError> {
        load.check()?;
        setting.check()?;
        let diffusivity = setting.rubber.diffusivity();
        let longest = TAU / load.period;
        let shortest = longest * load.moduli.len() as f64;
        let decay = (shortest * shortest).hypot(shortest * load.speed / diffusivity).sqrt();
        let reach = (diffusivity * setting.duration).sqrt();
        let depths = Depths::new(longest, (decay + 2.0 * shortest).max(4.0 / reach));
        let panels = panels(load, &depths);
        let mut source = Self {
            speed: load.speed,
            period: load.period,
            points: load.pressure.len(),
            depths,
            panels,
            power: spectral_power(load),
            heat: 0.0,
        };
        source.heat = source.integral();
        let scale = source.power.abs().max(f64::MIN_POSITIVE);
        // The round-off of the moduli of a rubber without loss is no heat.
        let round_off = 1e-13 * elastic_power(load);
        if (source.heat - source.power).abs() <= CLOSURE * scale + round_off {
            return Ok(source);
        }
        Err(HeatError::NotClosed { heat: source.heat, power: source.power })
    }

    /// Power `v Σ |t_q|² E_r'' / |E_r|²` in W per m² of nominal area, of the spectrum of the pressure: `mu p v` with the hysteretic
    /// friction of the contact.
    pub fn power(&self) -> f64 {
        self.power
    }

    /// Integral of the source over depth, its mean over the period, in W/m².
    pub fn heat(&self) -> f64 {
        self.heat
    }

    /// Depths in m at which the source is known, from the surface on.
    pub fn depths(&self) -> Vec<f64> {
        self.depths.nodes().iter().map(|(z, _)| *z).collect()
    }

    /// Heat in W/m³ on the points of the period at the depth of an index of [`Self::depths`].
    pub fn at_depth(&self, index: usize) -> Vec<f64> {
        let panel = &self.panels[index / NODES];
        on_points(panel.iter().skip(index % NODES).step_by(NODES).copied(), self.points)
    }

    /// Speed in m/s.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Period in m.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Number of points of the period.
    pub fn points(&self) -> usize {
        self.points
    }

    pub(super) fn layers(&self) -> &Depths {
        &self.depths
    }

    /// Waves of the source, without the mean.
    pub(super) fn waves(&self) -> usize {
        self.panels[0].len() / NODES - 1
    }

    /// Fourier coefficients of wave `k`, zero the mean, at all depths that it reaches, from the surface on.
    pub(super) fn wave(&self, k: usize) -> Vec<Complex64> {
        let of_panel =
            |panel: &Vec<Complex64>| panel.get(k * NODES..(k + 1) * NODES).map(Vec::from);
        self.panels.iter().map_while(of_panel).flatten().collect()
    }

    fn integral(&self) -> f64 {
        let mean = self.wave(0);
        self.depths.nodes().iter().zip(&mean).map(|((_, weight), q)| weight * q.re).sum()
    }
}

/// The source on all panels, from the deepest on, as what lies below goes into what lies above.
fn panels(load: &LineLoad, depths: &Depths) -> Vec<Vec<Complex64>> {
    let longest = TAU / load.period;
    let stress: Vec<Complex64> = load
        .amplitudes()
        .iter()
        .enumerate()
        .map(|(i, t)| t * ((i + 1) as f64 * longest).powi(2))
        .collect();
    let strain: Vec<Complex64> =
        stress.iter().zip(load.moduli).map(|(u, modulus)| 4.0 * u / modulus).collect();
    let highest = stress.iter().rposition(|u| *u != Complex64::ZERO).map_or(0, |i| i + 1);
    let mut below = vec![];
    let mut result = vec![];
    for p in (0..depths.panels.len()).rev() {
        let waves = depths.waves_in(p, stress.len(), longest);
        let excited = waves.min(highest);
        let (stress, strain) = (&stress[..excited], &strain[..excited]);
        let mut rates = Rates { longest, speed: load.speed, stress, strain }
            .at((0..NODES).map(|j| depths.depth(p, j)).collect());
        rates.iter_mut().for_each(|rates| rates.resize(waves + 1, Complex64::ZERO));
        below.resize(waves + 1, Complex64::ZERO);
        result.push(integrated(depths, p, &rates, &mut below));
    }
    result.reverse();
    result
}

/// Spectra of what the source integrates over depth.
struct Rates<'a> {
    longest: f64,
    speed: f64,
    stress: &'a [Complex64],
    strain: &'a [Complex64],
}

impl Rates<'_> {
    /// Fourier coefficients of `2 v Im[conj(V) U]` at each depth.
    fn at(&self, depths: Vec<f64>) -> Vec<Vec<Complex64>> {
        let waves = self.stress.len();
        if waves == 0 {
            return vec![vec![]; depths.len()];
        }
        let points = fast_length(2 * waves + 1);
        let backward = FftPlanner::new().plan_fft_inverse(points);
        let forward = RealFftPlanner::<f64>::new().plan_fft_forward(points);
        let at_depth = |z: f64| {
            let mut scratch = vec![Complex64::ZERO; backward.get_inplace_scratch_len()];
            let mut field = |amplitudes: &[Complex64]| {
                let mut field = vec![Complex64::ZERO; points];
                for (k, (f, a)) in field[1..].iter_mut().zip(amplitudes).enumerate() {
                    *f = a * (-((k + 1) as f64 * self.longest * z)).exp();
                }
                backward.process_with_scratch(&mut field, &mut scratch);
                field
            };
            let (u, v) = (field(self.stress), field(self.strain));
            let factor = 2.0 * self.speed / points as f64;
            let mut real: Vec<f64> =
                u.iter().zip(&v).map(|(u, v)| factor * (v.conj() * u).im).collect();
            let mut result = forward.make_output_vec();
            forward.process(&mut real, &mut result).expect("buffers are made for this plan");
            result.truncate(waves + 1);
            result
        };
        depths.into_par_iter().map(at_depth).collect()
    }
}

/// Integrates the rates of a panel from each of its nodes down, and adds to what lies `below` for the panel above it.
fn integrated(
    depths: &Depths,
    p: usize,
    rates: &[Vec<Complex64>],
    below: &mut [Complex64],
) -> Vec<Complex64> {
    let half = depths.panels[p].half;
    let squares: Vec<f64> = (0..NODES).map(|j| depths.depth(p, j).powi(2)).collect();
    let mut result = Vec::with_capacity(below.len() * NODES);
    for (k, below) in below.iter_mut().enumerate() {
        let rate: Vec<Complex64> = rates.iter().map(|r| r[k]).collect();
        let sum = |weights: &[f64; NODES]| -> Complex64 {
            rate.iter().zip(weights).map(|(r, w)| r * (w * half)).sum()
        };
        let nodes = depths.rule.beyond.iter().zip(&squares);
        result.extend(nodes.map(|(weights, square)| square * (*below + sum(weights))));
        *below += sum(&depths.rule.weights);
    }
    result
}

fn spectral_power(load: &LineLoad) -> f64 {
    let waves = load.amplitudes().into_iter().zip(load.moduli);
    load.speed * waves.map(|(t, e)| t.norm_sqr() * e.im / e.norm_sqr()).sum::<f64>()
}

/// The power that a rubber would have whose modulus is all loss: the scale of round-off.
fn elastic_power(load: &LineLoad) -> f64 {
    let waves = load.amplitudes().into_iter().zip(load.moduli);
    load.speed.abs() * waves.map(|(t, e)| t.norm_sqr() / e.norm()).sum::<f64>()
}
