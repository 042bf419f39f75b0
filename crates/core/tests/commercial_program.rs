//! The isotropic theory of Persson against a commercial program, on the public set of `../shared/validation`.
//!
//! The set gives the spectrum, the moduli, their shift factors and 300 values of area and friction over speed, at 0.3 MPa and
//! 20 °C with linear moduli. It does not state the conventions of the program. These are those of the published theory, none
//! is fitted:
//!
//! - γ = 1/2 in `S = γ + (1 - γ) P²`, which reduces friction and the spread of the pressure ([`Diffusion::Reduced`]);
//! - ν = 1/2;
//! - all waves of the spectrum, up to its end at 1.05128e6 rad/m (the README of the set says 1.05129e5, a tenth, with which
//!   the area is 4 to 13 times as large);
//! - moduli interpolated in the log plane, and the logarithm of the shift factor in the temperature.

use asperity_core::rubber::MeasuredModuli;
use asperity_core::rubber::fit::SweepPoint;
use asperity_core::surface::spectrum::IsotropicSpectrum;
use asperity_core::theory::{Diffusion, IsotropicPersson, PerssonOptions};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

const PRESSURE: f64 = 0.3e6;
const TEMPERATURE_C: f64 = 20.0;

/// Rows of numbers; `None` if the set is not there.
fn numbers(name: &str) -> Option<Vec<Vec<f64>>> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/validation"));
    let text = read(&folder, name)?;
    let rows = text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
    let row = |line: &str| line.split_whitespace().map(|cell| cell.parse().unwrap()).collect();
    Some(rows.map(row).collect())
}

fn read(folder: &Path, name: &str) -> Option<String> {
    let text = std::fs::read_to_string(folder.join(name)).ok();
    if text.is_none() {
        eprintln!("skipped: {} is not there", folder.join(name).display());
    }
    text
}

/// The compound S100 at 20 °C. Frequencies that are repeated are one point, the geometric mean.
fn rubber() -> Option<MeasuredModuli> {
    let mut points = numbers("S100_master_curve.txt")?;
    let shifts = numbers("S100_shift_factors.txt")?;
    let above = shifts.iter().position(|row| row[0] > TEMPERATURE_C)?;
    let (low, high) = (&shifts[above - 1], &shifts[above]);
    let share = (TEMPERATURE_C - low[0]) / (high[0] - low[0]);
    let shift = (low[1].ln() + share * (high[1] / low[1]).ln()).exp();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let merged: Vec<SweepPoint> = points
        .chunk_by(|a, b| a[0] == b[0])
        .map(|same| {
            let mean = |column: usize| {
                let sum: f64 = same.iter().map(|row| row[column].ln()).sum();
                (sum / same.len() as f64).exp()
            };
            SweepPoint {
                angular_frequency: TAU * same[0][0] / shift,
                storage_modulus: mean(1),
                loss_modulus: mean(2),
            }
        })
        .collect();
    Some(MeasuredModuli::new("S100", 0.5, &merged).unwrap())
}

/// `log10 v`, and `ln` of the theory over the program for area and friction, at every sixth of the speeds.
fn deviations(options: PerssonOptions) -> Option<Vec<[f64; 3]>> {
    let rubber = rubber()?;
    let spectrum = numbers("idiada_psd.txt")?;
    let column = |column: usize| spectrum.iter().map(|row| row[column]).collect();
    let surface = IsotropicSpectrum::new(column(0), column(1)).unwrap();
    let areas = numbers("program_S100_contact_area_linear.txt")?;
    let frictions = numbers("program_S100_mu_visc_linear.txt")?;
    assert_eq!((areas.len(), frictions.len()), (300, 300));
    let theory = IsotropicPersson::new(&surface, &rubber, surface.band(), options).unwrap();
    let rows = areas.iter().zip(&frictions).step_by(6);
    let deviation = |(area, friction): (&Vec<f64>, &Vec<f64>)| {
        assert_eq!(area[0], friction[0]);
        let at = theory.at(10_f64.powf(area[0]), PRESSURE).unwrap();
        // Waves across the sliding, at frequencies below the measured ones.
        assert!(at.unmeasured_share < 0.01, "{}", at.unmeasured_share);
        let ratio = |ours: f64, theirs: f64| (ours / theirs).ln();
        [
            area[0],
            ratio(at.contact_area_fraction, area[1]),
            ratio(at.friction_coefficient, friction[1]),
        ]
    };
    Some(rows.map(deviation).collect())
}

/// Mean and largest size of a column, and the share of it within 3 %, of the speeds in a range of `log10 v`.
fn summary(rows: &[[f64; 3]], column: usize, [from, to]: [f64; 2]) -> [f64; 3] {
    let values: Vec<f64> =
        rows.iter().filter(|row| from <= row[0] && row[0] < to).map(|row| row[column]).collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let largest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let within = values.iter().filter(|value| value.abs() <= 0.03).count() as f64 / count;
    [mean, largest, within]
}

/// The program is met within 3 % where its moduli are known well: the area up to 1 m/s, friction from 0.1 mm/s on but for
/// single speeds. Above 1 m/s the waves excite 1e8 Hz and more, where the modulus grows with the power 0.4 to 0.6 of the
/// frequency: the area is 7 to 18 % below the program's, which a shift factor of 76 instead of the interpolated 92 would
/// explain. What the program takes at 20 °C, between measurements at 10.5 and 20.2 °C, is not stated.
#[test]
fn the_reduced_diffusion_is_the_commercial_program_but_for_a_few_percent() {
    // Their values have three digits.
    let options = PerssonOptions { gamma: 0.5, diffusion: Diffusion::Reduced, tolerance: 1e-4 };
    let Some(rows) = deviations(options) else { return };
    let area = |range| summary(&rows, 1, range);
    let friction = |range| summary(&rows, 2, range);
    let [mean, largest, within] = area([-6.0, 0.0]);
    assert!(mean.abs() < 0.02 && largest < 0.035 && within > 0.9, "{:?}", area([-6.0, 0.0]));
    let [_, largest, _] = area([0.0, 4.0]);
    assert!(largest < 0.19, "{largest}");
    let [mean, largest, within] = friction([-4.0, 4.0]);
    assert!(mean.abs() < 0.025 && largest < 0.06 && within > 0.8, "{:?}", friction([-4.0, 4.0]));
    // The slowest speeds excite the lowest measured frequencies.
    let [_, largest, _] = friction([-6.0, -4.0]);
    assert!(largest < 0.09, "{largest}");
}

/// With γ on friction alone, area and friction are 0.70 of the program's at all speeds up to 1 m/s: a convention, not a
/// modulus.
#[test]
fn without_the_reduction_area_and_friction_are_a_constant_factor_off() {
    let options = PerssonOptions { gamma: 0.5, diffusion: Diffusion::Full, tolerance: 1e-4 };
    let Some(rows) = deviations(options) else { return };
    for column in [1, 2] {
        let [mean, largest, _] = summary(&rows, column, [-4.5, 0.0]);
        assert!((-0.38..-0.34).contains(&mean), "{mean}");
        assert!(largest + mean < 0.06, "{largest} {mean}");
    }
}
