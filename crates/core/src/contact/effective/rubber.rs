//! A rubber with effective moduli for each wave.

use crate::numerics::Complex64;
use crate::rubber::{FrequencyRange, RubberError, Viscoelastic};
use std::f64::consts::TAU;

/// Factors of the moduli over the wavenumber: exact at the given waves, linear in `ln q` between them, constant beyond.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveFactors {
    /// Wavenumbers q in rad/m, ascending.
    pub wavenumber: Vec<f64>,
    /// `ln a_q`, of the frequency.
    pub ln_shift: Vec<f64>,
    /// `ln b_q`, of both moduli.
    pub ln_vertical: Vec<f64>,
    /// `f_q`, of the storage modulus.
    pub storage: Vec<f64>,
    /// `g_q`, of the loss modulus.
    pub loss: Vec<f64>,
}

/// Factors of one wave.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Factors {
    shift: f64,
    storage: f64,
    loss: f64,
}

impl WaveFactors {
    /// Factors that change nothing, for waves of ascending wavenumber in rad/m; at least one.
    pub fn none(wavenumber: Vec<f64>) -> Self {
        let n = wavenumber.len();
        let (zeros, ones) = (vec![0.0; n], vec![1.0; n]);
        Self {
            wavenumber,
            ln_shift: zeros.clone(),
            ln_vertical: zeros,
            storage: ones.clone(),
            loss: ones,
        }
    }

    /// The same factors stated at other waves of ascending wavenumber in rad/m; at least one.
    #[must_use]
    pub fn at_waves(&self, wavenumber: Vec<f64>) -> Self {
        let places: Vec<Place> = wavenumber.iter().map(|q| self.place(*q)).collect();
        let of = |values: &[f64]| places.iter().map(|place| place.of(values)).collect();
        Self {
            ln_shift: of(&self.ln_shift),
            ln_vertical: of(&self.ln_vertical),
            storage: of(&self.storage),
            loss: of(&self.loss),
            wavenumber,
        }
    }

    fn place(&self, wavenumber: f64) -> Place {
        let after = self.wavenumber.partition_point(|q| *q < wavenumber);
        let last = self.wavenumber.len() - 1;
        let (left, right) = (after.saturating_sub(1).min(last), after.min(last));
        let (from, to) = (self.wavenumber[left], self.wavenumber[right]);
        let share = if left == right { 0.0 } else { (wavenumber / from).ln() / (to / from).ln() };
        Place { left, right, share }
    }

    fn at(&self, wavenumber: f64) -> Factors {
        let place = self.place(wavenumber);
        let vertical = place.of(&self.ln_vertical).exp();
        Factors {
            shift: place.of(&self.ln_shift).exp(),
            storage: vertical * place.of(&self.storage),
            loss: vertical * place.of(&self.loss),
        }
    }
}

/// Where a wavenumber lies among others.
#[derive(Debug, Clone, Copy)]
struct Place {
    left: usize,
    right: usize,
    /// Of the way from left to right.
    share: f64,
}

impl Place {
    /// The value there; a difference of equal values is zero, so that factors of one stay what they are.
    fn of(self, values: &[f64]) -> f64 {
        let (left, right) = (values[self.left], values[self.right]);
        left + self.share * (right - left)
    }
}

/// A rubber whose moduli have factors for each wave: `E_q(ω) = b_q [f_q E'(a_q ω) + i g_q E''(a_q ω)]`.
///
/// Half-spaces see it as any other rubber, on all their grids, since they ask for the modulus of a wave. What asks for the modulus
/// at a frequency without a wave gets that of the rubber without factors.
#[derive(Clone, Copy)]
pub struct EffectiveRubber<'a> {
    /// The rubber without factors.
    pub rubber: &'a dyn Viscoelastic,
    /// The factors.
    pub factors: &'a WaveFactors,
    /// Sliding speed in m/s, by which the waves excite it.
    pub speed: f64,
}

impl Viscoelastic for EffectiveRubber<'_> {
    fn name(&self) -> &str {
        self.rubber.name()
    }

    fn complex_modulus(&self, angular_frequency: f64) -> Complex64 {
        self.rubber.complex_modulus(angular_frequency)
    }

    fn poisson_ratio(&self) -> f64 {
        self.rubber.poisson_ratio()
    }

    fn validate(&self) -> Result<(), RubberError> {
        self.rubber.validate()
    }

    fn measured(&self) -> Option<FrequencyRange> {
        self.rubber.measured()
    }

    fn reduced_modulus_of_wave(&self, wavenumber: f64, angular_frequency: f64) -> Complex64 {
        let factors = self.factors.at(wavenumber);
        let modulus = self.rubber.reduced_modulus(angular_frequency * factors.shift);
        Complex64::new(modulus.re * factors.storage, modulus.im * factors.loss)
    }

    /// Checks the frequencies that the waves have after their shift.
    fn require(&self, asked: FrequencyRange) -> Result<(), RubberError> {
        let shifted =
            |frequency_hz: f64, wavenumber: f64| frequency_hz * self.factors.at(wavenumber).shift;
        let wave = |frequency_hz: f64| TAU * frequency_hz / self.speed.abs();
        let ends = [asked.lowest_hz, asked.highest_hz].map(|f| shifted(f, wave(f)));
        let mut range =
            FrequencyRange { lowest_hz: ends[0].min(ends[1]), highest_hz: ends[0].max(ends[1]) };
        for q in &self.factors.wavenumber {
            let frequency = q * self.speed.abs() / TAU;
            if frequency > asked.lowest_hz && frequency < asked.highest_hz {
                let there = shifted(frequency, *q);
                range.lowest_hz = range.lowest_hz.min(there);
                range.highest_hz = range.highest_hz.max(there);
            }
        }
        self.rubber.require(range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::MeasuredModuli;
    use crate::rubber::fit::SweepPoint;

    #[test]
    fn a_measured_rubber_is_asked_at_the_shifted_frequencies() {
        let point = |decade: i32| SweepPoint {
            angular_frequency: TAU * 10_f64.powi(decade),
            storage_modulus: 1e6 * 1.5_f64.powi(decade),
            loss_modulus: 3e5 * 1.5_f64.powi(decade),
        };
        let points: Vec<SweepPoint> = (1..7).map(point).collect();
        let rubber = MeasuredModuli::new("measured", 0.5, &points).unwrap();
        // Waves of 1 mm to 1 µm at 0.1 m/s: 100 Hz to 100 kHz.
        let wavenumber: Vec<f64> = (1..=1000).map(|k| 1e3 * TAU * f64::from(k)).collect();
        let mut factors = WaveFactors::none(wavenumber);
        let asked = FrequencyRange { lowest_hz: 100.0, highest_hz: 1e5 };
        let require = |factors: &WaveFactors| {
            EffectiveRubber { rubber: &rubber, factors, speed: 0.1 }.require(asked)
        };
        assert!(require(&factors).is_ok());
        factors.ln_shift.fill(-2.0);
        assert!(require(&factors).is_ok());
        factors.ln_shift.fill(-3.0);
        let error = require(&factors).unwrap_err().to_string();
        assert!(error.contains("4.979e0 Hz"), "{error}");
        // One wave alone, the shift of which leads out of the measurement.
        factors.ln_shift.fill(0.0);
        factors.ln_shift[499] = -9.0;
        let error = require(&factors).unwrap_err().to_string();
        assert!(error.contains("6.170e0 Hz"), "{error}");
        let modulus = EffectiveRubber { rubber: &rubber, factors: &factors, speed: 0.1 };
        let q = 500e3 * TAU;
        let expected = rubber.reduced_modulus(0.1 * q * (-9.0_f64).exp());
        let found = modulus.reduced_modulus_of_wave(q, 0.1 * q);
        assert!((found - expected).norm() < 1e-11 * expected.norm(), "{found} {expected}");
    }
}
