//! Rubber and surfaces of the thesis, and worse ones.

use asperity::rubber::{MaxwellBranch, Rubber};
use asperity::surface::{SineScale, Wave, wave};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// The rubber of thesis Table 2.1, Poisson ratio 0.49.
pub fn table_2_1() -> Rubber {
    let branch = |modulus_mpa: f64, relaxation_time| MaxwellBranch {
        modulus: 1e6 * modulus_mpa,
        relaxation_time,
    };
    Rubber {
        name: "Table 2.1".into(),
        equilibrium_modulus: 4.17e6,
        branches: vec![
            branch(1.72, 1.134e-2),
            branch(7.36, 2.628e-4),
            branch(70.98, 1.316e-5),
            branch(505.87, 1.295e-6),
            branch(1125.85, 7.708e-8),
            branch(1185.94, 4.200e-10),
        ],
        poisson_ratio: 0.49,
    }
}

/// Wavelengths and amplitudes in mm of thesis Table 3.1.
const TABLE_3_1_MM: [(f64, f64); 8] = [
    (0.0625, 0.01867),
    (0.125, 0.02648),
    (0.25, 0.02939),
    (0.5, 0.06626),
    (1.0, 0.06177),
    (2.0, 0.21635),
    (4.0, 0.14772),
    (8.0, 0.48995),
];

/// The shortest wave of thesis Table 3.1.
pub fn shortest_wave() -> SineScale {
    let (wavelength, amplitude) = TABLE_3_1_MM[0];
    SineScale { wavelength: 1e-3 * wavelength, amplitude: 1e-3 * amplitude }
}

/// A profile of one period.
#[derive(Debug, Clone)]
pub struct Profile {
    pub period: f64,
    pub heights: Vec<f64>,
}

/// The first waves of Table 3.1, one for each phase, on one period of the longest.
pub fn superposed(phases: &[f64], points: usize) -> Profile {
    let waves: Vec<Wave> = TABLE_3_1_MM
        .iter()
        .zip(phases)
        .map(|((wavelength, amplitude), phase)| Wave {
            wavelength: 1e-3 * wavelength,
            amplitude: 1e-3 * amplitude,
            phase: *phase,
        })
        .collect();
    let period = waves.last().expect("at least one phase").wavelength;
    Profile { period, heights: wave::sample(&waves, period, points) }
}

/// Phases uniform on `[0, 2π)`.
pub fn random_phases(count: usize, seed: u64) -> Vec<f64> {
    let mut generator = Pcg64::seed_from_u64(seed);
    (0..count).map(|_| TAU * generator.random::<f64>()).collect()
}

/// Independent heights at every point: the roughest profile a grid can hold.
pub fn white_noise(points: usize, seed: u64) -> Profile {
    let mut generator = Pcg64::seed_from_u64(seed);
    let heights = (0..points).map(|_| 1e-6 * (generator.random::<f64>() - 0.5)).collect();
    Profile { period: 1e-3, heights }
}

/// One point that stands out of a plane.
pub fn single_peak(points: usize) -> Profile {
    let mut heights = vec![0.0; points];
    heights[points / 3] = 1e-6;
    Profile { period: 1e-3, heights }
}
