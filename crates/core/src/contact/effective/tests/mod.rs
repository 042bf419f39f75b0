//! Contacts with effective moduli.
//!
//! | module | what it compares with |
//! |---|---|
//! | `limits` | the plain contact, monotone laws, input that has to be refused |
//! | `areal` | the line, and the friction of areal contacts |
//! | `full_contact` | closed forms of one sine in full contact |
//! | `heat` | power of the contact, temperatures over speed |

mod areal;
mod full_contact;
mod heat;
mod limits;

use super::*;
use crate::contact::{ContactSolution, SlidingContact};
use crate::heat::{Thermal, ThermalSetting};
use crate::rubber::{Rubber, ShiftLaw, TemperatureDependence};
use crate::surface::{Wave, wave};

const PERIOD: f64 = 1e-3;

/// The WLF law of `data/rubber/example_wlf.toml`.
pub(super) fn wlf() -> TemperatureDependence {
    let law = ShiftLaw::Wlf { c1: 8.86, c2_k: 101.6 };
    TemperatureDependence { reference_c: 20.0, law, measured_c: None, vertical: None }
}

pub(super) fn thermal() -> ThermalSetting {
    let rubber = Thermal { conductivity: 0.3, density: 1150.0, heat_capacity: 1500.0 };
    ThermalSetting { rubber, duration: 0.02, shear_stress: 0.0, road: None }
}

/// The five shortest waves of Table 3.1 with two fifths of about their amplitudes.
pub(super) fn five_waves(points: usize) -> Vec<f64> {
    let scales = [
        (0.0625, 0.01867, 0.5),
        (0.125, 0.02648, 4.4),
        (0.25, 0.03111, 5.0),
        (0.5, 0.04, 3.65),
        (1.0, 0.05, 0.6),
    ];
    let waves = scales.map(|(length, amplitude, phase)| Wave {
        wavelength: length * 1e-3,
        amplitude: 0.4e-3 * amplitude,
        phase,
    });
    wave::sample(&waves, PERIOD, points)
}

pub(super) fn plain(
    rubber: &Rubber,
    speed: f64,
    heights: &[f64],
    pressure: f64,
) -> ContactSolution {
    SlidingContact::new(rubber, speed, PERIOD, heights).unwrap().solve(pressure).unwrap()
}
