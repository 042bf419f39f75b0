//! Heat and temperature against closed forms and slow sums.
//!
//! | module | what it compares with |
//! |---|---|
//! | `waves` | one wave, two waves, sums over the branches of a rubber |
//! | `surface` | Jaeger's band; uniform flux over time; a road |

mod surface;
mod waves;

use super::*;
use crate::rubber::Rubber;
use rustfft::num_complex::Complex64;
use std::f64::consts::TAU;

pub(super) const RUBBER: Thermal =
    Thermal { conductivity: 0.3, density: 1150.0, heat_capacity: 1500.0 };

pub(super) fn setting() -> ThermalSetting {
    ThermalSetting { rubber: RUBBER, duration: 0.02, shear_stress: 0.0, road: None }
}

/// Reduced moduli of the waves of a grid.
pub(super) fn moduli(rubber: &Rubber, speed: f64, period: f64, points: usize) -> Vec<Complex64> {
    (1..=(points - 1) / 2)
        .map(|k| rubber.reduced_modulus(TAU * k as f64 / period * speed))
        .collect()
}

/// `mean + Σ a cos(k q x + phase)` on the points of a period.
pub(super) fn waves(points: usize, mean: f64, waves: &[(usize, f64, f64)]) -> Vec<f64> {
    let at = |i: usize| {
        let wave = |(k, amplitude, phase): &(usize, f64, f64)| {
            amplitude * (TAU * (k * i) as f64 / points as f64 + phase).cos()
        };
        mean + waves.iter().map(wave).sum::<f64>()
    };
    (0..points).map(at).collect()
}
