//! Rubber and surfaces of the thesis, and worse ones.

use asperity::rubber::Rubber;
use asperity::surface::{SineScale, TABLE_3_1_MM, Wave, wave};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// The rubber of thesis Table 2.1, Poisson ratio 0.49.
pub fn table_2_1() -> Rubber {
    Rubber::table_2_1()
}

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
