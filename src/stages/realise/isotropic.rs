//! Isotropic areal surfaces with the spectrum of lines.

use super::areal::{ArealRow, ArealSurface, ArealSurfaces, row};
use super::{Method, Realise, SurfaceKind};
use crate::stages::StageError;
use crate::stages::characterise::IsotropicRow;
use crate::surface::LineScan;
use crate::surface::map::phases::isotropic_map;
use crate::units::Units;
use rayon::prelude::*;

/// Shortest waves in the period of an isotropic surface: as many as a map must have, and 16384 points along a side.
const FEWEST_WAVES: f64 = 4.0;
const MOST_WAVES: f64 = 8192.0;

/// Isotropic surfaces of random phases whose lines have the averaged spectrum of the line scans.
///
/// # Errors
/// [`StageError::NoIsotropicSpectrum`] where the line scans have none; [`StageError::IsotropicPeriod`].
pub(super) fn isotropic(
    parameters: &Realise,
    windows: &[LineScan],
    spectrum: &[IsotropicRow],
    shortest: f64,
) -> Result<ArealSurfaces, StageError> {
    let length = windows.first().map_or(0.0, LineScan::length);
    let period = parameters.isotropic_period_mm.map_or(length, Units::mm_to_m);
    let waves = period / shortest;
    if !(FEWEST_WAVES..=MOST_WAVES).contains(&waves) {
        return Err(StageError::IsotropicPeriod {
            period_mm: period.m_to_mm(),
            shortest_mm: shortest.m_to_mm(),
            fewest: FEWEST_WAVES,
            most: MOST_WAVES,
        });
    }
    let density = Density::new(spectrum)?;
    let seed = parameters.seed.unwrap_or_default();
    let made: Vec<(ArealSurface, ArealRow)> = (1..=parameters.areal_drawn())
        .into_par_iter()
        .map(|realisation| {
            let draw = u64::from(realisation);
            let map = isotropic_map(|q| density.at(q), period, shortest, seed, draw);
            let kind = SurfaceKind::of(Method::Isotropic);
            let surface = ArealSurface { kind, realisation, map };
            let average = crate::stages::characterise::AVERAGE;
            let row = row(&surface, average, [0.0, 0.0], None);
            (surface, row)
        })
        .collect();
    let (surfaces, rows) = made.into_iter().unzip();
    Ok((surfaces, rows, Vec::new()))
}

/// A two-dimensional density between the points of a table: a power law from one to the next, and beyond them that of the two
/// last ones.
struct Density(Vec<[f64; 2]>);

impl Density {
    fn new(spectrum: &[IsotropicRow]) -> Result<Self, StageError> {
        let point = |row: &IsotropicRow| {
            let positive = |density: &f64| *density > 0.0;
            let abel = row.abel_density_mm4.filter(positive);
            let density = abel.or(row.self_affine_density_mm4.filter(positive))?;
            let q = row.wavenumber_rad_mm.per_mm_to_per_m();
            Some([q.ln(), density.mm4_to_m4().ln()])
        };
        let points: Vec<[f64; 2]> = spectrum.iter().filter_map(point).collect();
        if points.len() < 2 { Err(StageError::NoIsotropicSpectrum) } else { Ok(Self(points)) }
    }

    /// In m⁴ at a wavenumber in rad/m.
    fn at(&self, wavenumber: f64) -> f64 {
        let q = wavenumber.ln();
        let right = self.0.partition_point(|point| point[0] < q).clamp(1, self.0.len() - 1);
        let [[q0, c0], [q1, c1]] = [self.0[right - 1], self.0[right]];
        (c0 + (c1 - c0) * (q - q0) / (q1 - q0)).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_density_is_a_power_law_between_its_points() {
        let row = |q: f64, abel: Option<f64>| IsotropicRow {
            wavenumber_rad_mm: q,
            abel_density_mm4: abel,
            self_affine_density_mm4: Some(1e-3 * q.powf(-3.0)),
        };
        // The Abel inverse where it is positive, the self-affine form elsewhere.
        let rows = [row(1.0, Some(-1.0)), row(10.0, None), row(100.0, Some(1e-9))];
        let density = Density::new(&rows).unwrap();
        for q in [0.5, 1.0, 3.0, 50.0, 300.0] {
            let expected = 1e-3_f64 * f64::powf(q, -3.0) * 1e-12;
            approx::assert_relative_eq!(density.at(1e3 * q), expected, max_relative = 1e-10);
        }
        assert!(matches!(Density::new(&rows[..1]), Err(StageError::NoIsotropicSpectrum)));
    }
}
