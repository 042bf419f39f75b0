//! Temperature below a sliding contact.
//!
//! The rubber moves through heat sources that rest in the frame of the profile. Each wave along `x` is steady,
//!
//! ```text
//! T(k, z) = ∫ Q(k, z') [e^(-s|z-z'|) + e^(-s(z+z'))] / (2 κ s) dz' + q(k) e^(-sz) / (κ s),    s = sqrt(k² + i k v / D)
//! ```
//!
//! with the heat flux `q` into the surface: the power of the shear stress in contact, less what the road takes. The mean
//! over the period grows with the time of sliding; it is the exact solution of the transient, its Laplace transform (with `s =
//! sqrt(p / D)`) turned back on the contour of Talbot in the form of Weideman (2006, doi:10.1137/050625837).
//!
//! That the waves are steady supposes a sliding distance of some periods; after less, they are overestimated.

use super::depth::Depths;
use super::material::ThermalSetting;
use super::road::{self, decay};
use super::source::{finite, on_points, spectrum};
use super::{HeatError, HeatSource};
use rayon::prelude::*;
use rustfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Points of the contour, both halves: its error is 4^-N.
const CONTOUR: usize = 24;

/// Rise of the temperature in K over that before sliding.
#[derive(Debug, Clone)]
pub struct Temperatures {
    points: usize,
    contact: Vec<bool>,
    /// Depths and weights in m.
    nodes: Vec<(f64, f64)>,
    /// Fourier coefficients at the surface, from the mean to the highest wave.
    surface: Vec<Complex64>,
    /// Those of each wave, the mean first, at the depths that it reaches, from the surface on.
    waves: Vec<Vec<Complex64>>,
    road_flux: Vec<f64>,
    shear_power: f64,
}

impl Temperatures {
    /// The temperature that a source makes under a contact; `pressure` in Pa is positive where rubber and road touch.
    ///
    /// # Errors
    /// [`HeatError::OutOfRange`], [`HeatError::Length`] or [`HeatError::NotFinite`] for input that does not fit;
    /// [`HeatError::Conduction`] if the flux into the road did not converge.
    pub fn new(
        source: &HeatSource,
        pressure: &[f64],
        setting: &ThermalSetting,
    ) -> Result<Self, HeatError> {
        setting.check()?;
        let points = source.points();
        if pressure.len() != points {
            let (quantity, found) = ("pressures", pressure.len());
            return Err(HeatError::Length { quantity, found, expected: points });
        }
        finite("pressure", pressure)?;
        let contact: Vec<bool> = pressure.iter().map(|t| *t > 0.0).collect();
        let rising = Rising::new(source, setting);
        let (speed, period) = (source.speed(), source.period());
        let of_rubber = road::of_rubber(setting, speed, period, points);
        let shear = setting.shear_stress * speed.abs();
        let coverage = road::coverage(pressure);
        let made: Vec<f64> = coverage.iter().map(|c| shear * c).collect();
        let insulated: Vec<Complex64> = spectrum(&made)
            .iter()
            .zip(&of_rubber)
            .enumerate()
            .map(|(k, (q, r))| q * r + rising.surface.get(k).copied().unwrap_or_default())
            .collect();
        let road_flux = match &setting.road {
            None => vec![0.0; points],
            Some(road) => {
                let insulated = on_points(insulated.iter().copied(), points);
                road::flux(road, setting.duration, period, &of_rubber, &insulated, &coverage)?
            }
        };
        let shear_power = made.iter().sum::<f64>() / points as f64;
        let taken = spectrum(&road_flux);
        let surface =
            insulated.iter().zip(&taken).zip(&of_rubber).map(|((t, q), r)| t - q * r).collect();
        let flux: Vec<Complex64> =
            spectrum(&made).iter().zip(&taken).map(|(made, taken)| made - taken).collect();
        let waves = rising.fall(&flux);
        let nodes = source.layers().nodes();
        Ok(Self { points, contact, nodes, surface, waves, road_flux, shear_power })
    }

    /// Rise in K of the surface on the points of the period.
    pub fn surface(&self) -> Vec<f64> {
        on_points(self.surface.iter().copied(), self.points)
    }

    /// Depths in m of [`Self::at_depth`], those of the source.
    pub fn depths(&self) -> Vec<f64> {
        self.nodes.iter().map(|(z, _)| *z).collect()
    }

    /// Rise in K on the points of the period at the depth of an index of [`Self::depths`].
    pub fn at_depth(&self, index: usize) -> Vec<f64> {
        on_points(self.waves.iter().map_while(|wave| wave.get(index).copied()), self.points)
    }

    /// Rise in K of the surface, its mean over the period.
    pub fn background(&self) -> f64 {
        self.surface[0].re
    }

    /// Power of the shear stress in W per m² of nominal area; next to the edges of the contact, where the pressure is below a tenth
    /// of its weighted mean, the stress goes to zero with the pressure.
    pub fn shear_power(&self) -> f64 {
        self.shear_power
    }

    /// Rise in K of the surface, its mean over the points in contact; zero without any.
    pub fn contact_mean(&self) -> f64 {
        let surface = self.surface();
        let hot = surface.iter().zip(&self.contact).filter(|(_, c)| **c).map(|(t, _)| *t);
        let count = self.contact.iter().filter(|c| **c).count();
        if count == 0 { 0.0 } else { hot.sum::<f64>() / count as f64 }
    }

    /// Highest rise in K, at the surface or below it, and its depth in m.
    pub fn highest(&self) -> (f64, f64) {
        let highest = |values: Vec<f64>| values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let below: Vec<(f64, f64)> = (0..self.nodes.len())
            .into_par_iter()
            .map(|index| (highest(self.at_depth(index)), self.nodes[index].0))
            .collect();
        let surface = (highest(self.surface()), 0.0);
        below.into_iter().fold(surface, |best, next| if next.0 > best.0 { next } else { best })
    }

    /// Heat flux in W/m² from rubber to road on the points of the period; zero outside the contact and for an insulated one.
    pub fn road_flux(&self) -> &[f64] {
        &self.road_flux
    }

    /// Rise in K at each depth, its mean over the period with the `weights` of its points.
    ///
    /// # Errors
    /// [`HeatError::Length`] or [`HeatError::OutOfRange`] for weights that do not fit or have no positive sum.
    pub fn mean_below(&self, weights: &[f64]) -> Result<Vec<f64>, HeatError> {
        if weights.len() != self.points {
            let (quantity, found) = ("weights", weights.len());
            return Err(HeatError::Length { quantity, found, expected: self.points });
        }
        let weights = spectrum(weights);
        super::material::positive("the mean of the weights", weights[0].re)?;
        let mut mean = vec![0.0; self.nodes.len()];
        for (k, (wave, weight)) in self.waves.iter().zip(&weights).enumerate() {
            let both = if k == 0 { 1.0 } else { 2.0 } / weights[0].re;
            for (m, t) in mean.iter_mut().zip(wave) {
                *m += both * (t * weight.conj()).re;
            }
        }
        Ok(mean)
    }

    /// Rise in K that waves of the `wavenumbers` in rad/m feel: the mean over depth where each makes its heat, with the weight
    /// `4 q³ z² e^(-2qz)`, of the mean along the period with the `weights` of its points.
    ///
    /// # Errors
    /// As [`Self::mean_below`].
    pub fn felt_by_waves(
        &self,
        weights: &[f64],
        wavenumbers: &[f64],
    ) -> Result<Vec<f64>, HeatError> {
        let mean = self.mean_below(weights)?;
        let of_wave = |q: &f64| {
            let at = |((z, weight), t): (&(f64, f64), &f64)| {
                let x = q * z;
                4.0 * q * x * x * (-2.0 * x).exp() * weight * t
            };
            self.nodes.iter().zip(&mean).map(at).sum()
        };
        Ok(wavenumbers.par_iter().map(of_wave).collect())
    }
}

/// What rises to the surface from the source.
struct Rising<'a> {
    source: &'a HeatSource,
    conductivity: f64,
    diffusivity: f64,
    duration: f64,
    /// Temperature of the insulated surface by the source alone.
    surface: Vec<Complex64>,
    /// What comes up from below at the depths of each wave but the mean, and at the surface; empty without a source.
    risen: Vec<(Vec<Complex64>, Complex64)>,
}

impl<'a> Rising<'a> {
    fn new(source: &'a HeatSource, setting: &ThermalSetting) -> Self {
        let mut rising = Self {
            source,
            conductivity: setting.rubber.conductivity,
            diffusivity: setting.rubber.diffusivity(),
            duration: setting.duration,
            surface: vec![],
            risen: vec![],
        };
        let risen = |k: usize| rising.rise(rising.decay(k), source.wave(k));
        rising.risen = (1..=source.waves()).into_par_iter().map(risen).collect();
        let mean = source.wave(0);
        let at_surface = |s: Complex64, up: Complex64| up / (rising.conductivity * s);
        let mean = rising.mean(|s| at_surface(s, rising.rise(s, mean.clone()).1));
        let waves = rising.risen.iter().enumerate();
        let waves = waves.map(|(k, (_, up))| at_surface(rising.decay(k + 1), *up));
        rising.surface = std::iter::once(Complex64::from(mean)).chain(waves).collect();
        rising
    }

    /// Temperatures of all waves at all depths, with the flux into the surface.
    fn fall(mut self, flux: &[Complex64]) -> Vec<Vec<Complex64>> {
        let risen = std::mem::take(&mut self.risen);
        let values = self.source.wave(0);
        let mut mean = vec![Complex64::ZERO; values.len()];
        for (s, factor) in self.contour() {
            let column = self.column(s, &values, self.rise(s, values.clone()), flux[0]);
            mean.iter_mut().zip(column).for_each(|(m, t)| m.re += (factor * t).im);
        }
        let wave = |(k, risen)| {
            let k: usize = k + 1;
            self.column(self.decay(k), &self.source.wave(k), risen, flux[k])
        };
        let mut waves: Vec<Vec<Complex64>> = risen.into_par_iter().enumerate().map(wave).collect();
        waves.insert(0, mean);
        waves
    }

    fn depths(&self) -> &Depths {
        self.source.layers()
    }

    fn decay(&self, k: usize) -> Complex64 {
        decay(TAU * k as f64 / self.source.period(), self.source.speed(), self.diffusivity)
    }

    /// What comes up from below with the decay `s`, at all depths and at the surface; empty without a source.
    fn rise(&self, s: Complex64, mut values: Vec<Complex64>) -> (Vec<Complex64>, Complex64) {
        if values.iter().all(|q| *q == Complex64::ZERO) {
            return (vec![], Complex64::ZERO);
        }
        let at_surface = self.depths().sweep_up(s, &mut values);
        (values, at_surface)
    }

    /// Temperature at all depths for a source, what comes up of it, and a flux into the surface, steady with the decay `s`.
    fn column(
        &self,
        s: Complex64,
        values: &[Complex64],
        (mut result, at_surface): (Vec<Complex64>, Complex64),
        flux: Complex64,
    ) -> Vec<Complex64> {
        if result.is_empty() {
            let nodes = self.depths().nodes();
            let below = |(z, _): &(f64, f64)| flux / (self.conductivity * s) * (-s * z).exp();
            return nodes.iter().take(values.len()).map(below).collect();
        }
        self.depths().sweep_down(s, values, at_surface + 2.0 * flux, &mut result);
        let factor = (2.0 * self.conductivity * s).inv();
        result.iter_mut().for_each(|t| *t *= factor);
        result
    }

    /// Decays `sqrt(p / D)` and factors of which the imaginary part of the sum, over a response to a steady source, is the
    /// response to a source that began a `duration` ago.
    fn contour(&self) -> Vec<(Complex64, Complex64)> {
        let n = CONTOUR as f64;
        let node = |k: usize| {
            let theta = (2 * k + 1) as f64 * PI / n;
            let (a, b, c, d) = (0.5017, 0.6407, 0.6122, 0.2645);
            let cotangent = (b * theta).tan().recip();
            let p = n * Complex64::new(a * theta * cotangent - c, d * theta);
            let slope = a * (cotangent - b * theta * (1.0 + cotangent * cotangent));
            let slope = n * Complex64::new(slope, d);
            ((p / (self.duration * self.diffusivity)).sqrt(), 2.0 / n * p.exp() * slope / p)
        };
        (0..CONTOUR / 2).map(node).collect()
    }

    fn mean(&self, response: impl Fn(Complex64) -> Complex64) -> f64 {
        self.contour().iter().map(|(s, factor)| (factor * response(*s)).im).sum()
    }
}
