//! The heat source of a half-space that slides in steady contact with an areal surface.
//!
//! For `nu = 1/2` the stress deviator of a wave `q` of the pressure is `t_q |q| z e^(iq·r - |q|z) m ⊗ m` with the null vector `m = q/|q| + i e_z`:
//! five scalar fields. Branch `k` of the rubber carries the part
//!
//! ```text
//! s_k = Σ_q G_k b_k(ω) (|q| t_q / G_q) z e^(iq·r - |q|z) m ⊗ m,    ω = q · v,   b_k = iωτ_k / (1 + iωτ_k),   G = E_r / 4
//! ```
//!
//! of it and makes the heat `s_k : s_k / (2 G_k τ_k)`: five transforms for each branch and depth. Unlike on a line the
//! branches do not drop out, as depth and frequency are not in proportion, so this needs a Prony series. Where the moduli
//! of the waves are not those of the series (softened, warmed, or the phase of the highest waves of a grid), the heat of each wave is scaled
//! to its own loss, and the mixed terms with it.

use super::HeatError;
use super::depth::Depths;
use super::material::positive;
use super::source::{CLOSURE, finite};
use crate::numerics::plane::Transform;
use crate::rubber::{MaxwellBranch, Rubber};
use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// A pressure that is steady in the frame of an areal surface, and the rubber that carries it.
#[derive(Debug, Clone, Copy)]
pub struct ArealLoad<'a> {
    /// The rubber whose branches turn work into heat.
    pub rubber: &'a Rubber,
    /// Velocity of the rubber along `x` and `y` in m/s.
    pub velocity: [f64; 2],
    /// Periods along `x` and `y` in m.
    pub periods: [f64; 2],
    /// Points along `x` and `y`.
    pub points: [usize; 2],
    /// Pressure in Pa, row by row: that of the point `(i, j)` is `pressure[j * nx + i]`.
    pub pressure: &'a [f64],
    /// Reduced moduli in Pa of the waves with `k_x` from 0 to `nx / 2`, in this order the `ny` waves along `y` of each; what stands for
    /// the mean and for the highest waves of an even grid is not used. See `contact::areal::wave_moduli`.
    pub moduli: &'a [Complex64],
}

/// One wave that makes heat.
#[derive(Debug, Clone, Copy)]
struct Wave {
    /// Where it is in the spectrum.
    index: usize,
    direction: [f64; 2],
    wavenumber: f64,
    frequency: f64,
    /// `|q| t_q / G_q`, scaled to its own loss.
    strain: Complex64,
}

/// Heat in W/m³ below an areal contact.
pub struct ArealHeat {
    points: [usize; 2],
    branches: Vec<MaxwellBranch>,
    waves: Vec<Wave>,
    depths: Depths,
    power: f64,
    transform: Transform,
}

impl ArealHeat {
    /// The source under a load.
    ///
    /// # Errors
    /// [`HeatError::OutOfRange`], [`HeatError::Length`] or [`HeatError::NotFinite`] for input that does not fit.
    pub fn new(load: &ArealLoad) -> Result<Self, HeatError> {
        load.check()?;
        let mut transform = Transform::new(load.points);
        transform.real.copy_from_slice(load.pressure);
        transform.forward();
        let reduction = 4.0 * (1.0 - load.rubber.poisson_ratio.powi(2));
        let shear = |b: &MaxwellBranch| MaxwellBranch { modulus: b.modulus / reduction, ..*b };
        let branches: Vec<MaxwellBranch> = load.rubber.branches.iter().map(shear).collect();
        let norm = 1.0 / load.pressure.len() as f64;
        let mut power = 0.0;
        let mut waves = vec![];
        for (index, t) in transform.spectrum.iter().enumerate() {
            let Some((q, both)) = load.wave(index) else { continue };
            let wavenumber = q[0].hypot(q[1]);
            let frequency = q[0] * load.velocity[0] + q[1] * load.velocity[1];
            let modulus = load.moduli[index] / 4.0;
            let strain = wavenumber * t * norm / modulus;
            let own = frequency * modulus.im;
            power += both * own * strain.norm_sqr() / (2.0 * wavenumber.powi(3));
            let made: f64 = branches.iter().map(|b| own_heat(b, frequency)).sum();
            if made > 0.0 && own > 0.0 && strain != Complex64::ZERO {
                let direction = q.map(|q| q / wavenumber);
                let strain = strain * (own / made).sqrt();
                waves.push(Wave { index, direction, wavenumber, frequency, strain });
            }
        }
        let [longest, shortest] = load.range();
        let depths = Depths::new(longest, 2.0 * shortest);
        Ok(Self { points: load.points, branches, waves, depths, power, transform })
    }

    /// Power `Σ 2 ω E_r'' |t_q|² / (|q| |E_r|²)` over all waves in W per m² of nominal area: `mu p v` with the hysteretic friction of the contact.
    pub fn power(&self) -> f64 {
        self.power
    }

    /// Heat in W/m³ at the depth `z` in m, on the points of the surface.
    pub fn at(&mut self, z: f64) -> Vec<f64> {
        let strains: Vec<Complex64> =
            self.waves.iter().map(|w| w.strain * (z * (-w.wavenumber * z).exp())).collect();
        let mut heat = vec![0.0; self.points[0] * self.points[1]];
        let mut trace = heat.clone();
        for branch in &self.branches {
            let factor = |frequency: f64| {
                let x = Complex64::new(0.0, frequency * branch.relaxation_time);
                branch.modulus * x / (1.0 + x)
            };
            let stress: Vec<Complex64> =
                self.waves.iter().zip(&strains).map(|(w, e)| factor(w.frequency) * e).collect();
            let share = 0.5 / (branch.modulus * branch.relaxation_time);
            trace.fill(0.0);
            for (component, weight) in COMPONENTS {
                self.transform.spectrum.fill(Complex64::ZERO);
                for (wave, s) in self.waves.iter().zip(&stress) {
                    self.transform.spectrum[wave.index] = s * component(wave.direction);
                }
                self.transform.backward();
                for (q, s) in heat.iter_mut().zip(&self.transform.real) {
                    *q += share * weight * s * s;
                }
                if weight == 1.0 {
                    trace.iter_mut().zip(&self.transform.real).for_each(|(sum, s)| *sum += s);
                }
            }
            // The deviator has no trace, which leaves its sixth component.
            heat.iter_mut().zip(&trace).for_each(|(q, s)| *q += share * s * s);
        }
        heat
    }

    /// Integral of the source over depth, its mean over the surface, in W/m²: some hundred depths.
    ///
    /// # Errors
    /// [`HeatError::NotClosed`] if it differs from [`Self::power`] by more than [`CLOSURE`].
    pub fn integral(&mut self) -> Result<f64, HeatError> {
        let mut heat = 0.0;
        for (z, weight) in self.depths.nodes() {
            let field = self.at(z);
            heat += weight * field.iter().sum::<f64>() / field.len() as f64;
        }
        let power = self.power;
        if (heat - power).abs() <= CLOSURE * power.abs() {
            return Ok(heat);
        }
        Err(HeatError::NotClosed { heat, power })
    }
}

/// Factor of a component of `m ⊗ m` for the direction of a wave, and how often it counts in `s : s`.
type Component = (fn([f64; 2]) -> Complex64, f64);

const COMPONENTS: [Component; 5] = [
    (|[x, _]| Complex64::from(x * x), 1.0),
    (|[_, y]| Complex64::from(y * y), 1.0),
    (|[x, y]| Complex64::from(x * y), 2.0),
    (|[x, _]| Complex64::new(0.0, x), 2.0),
    (|[_, y]| Complex64::new(0.0, y), 2.0),
];

/// Heat of a branch in a wave of unit strain: `G_k |b_k|² / τ_k`.
fn own_heat(branch: &MaxwellBranch, frequency: f64) -> f64 {
    let x = frequency * branch.relaxation_time;
    branch.modulus * x * x / (1.0 + x * x) / branch.relaxation_time
}

impl ArealLoad<'_> {
    fn check(&self) -> Result<(), HeatError> {
        let [nx, ny] = self.points;
        self.periods.iter().try_for_each(|p| positive("the period in m", *p))?;
        finite("velocity", &self.velocity)?;
        finite("pressure", self.pressure)?;
        for (quantity, found, expected) in [
            ("pressures", self.pressure.len(), nx * ny),
            ("moduli of waves", self.moduli.len(), (nx / 2 + 1) * ny),
        ] {
            if found != expected || found == 0 {
                return Err(HeatError::Length { quantity, found, expected });
            }
        }
        Ok(())
    }

    /// Wavenumbers of a place in the spectrum, and how many waves of the whole plane it stands for; `None` for the mean and the
    /// highest waves of an even grid, which have no direction.
    fn wave(&self, index: usize) -> Option<([f64; 2], f64)> {
        let [nx, ny] = self.points;
        let (bin, row) = (index / ny, index % ny);
        if index == 0 || 2 * bin == nx || 2 * row == ny {
            return None;
        }
        let signed = if 2 * row > ny { row as f64 - ny as f64 } else { row as f64 };
        let q = [TAU * bin as f64 / self.periods[0], TAU * signed / self.periods[1]];
        Some((q, if bin == 0 { 1.0 } else { 2.0 }))
    }

    /// Wavenumbers of the longest and of the shortest wave of the grid.
    fn range(&self) -> [f64; 2] {
        let longest = self.periods.iter().fold(0.0_f64, |a, p| a.max(*p));
        let highest = |a: usize| TAU * (self.points[a] / 2).max(1) as f64 / self.periods[a];
        [TAU / longest, highest(0).hypot(highest(1))]
    }
}
