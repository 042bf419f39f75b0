//! Whether the error that a contact at finite deformation reports is the error that it has.

use super::estimate::assert_honest;
use crate::surfaces::table_2_1;
use asperity::contact::refine::{FINITE_ELEMENTS, GridError, OnGrid, on_grid};
use asperity::fem::error::FemError;
use asperity::fem::profile::RigidProfile;
use asperity::fem::steady::{BlockOptions, SteadyContact};
use asperity::rubber::Rheology;
use asperity::surface::Wave;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use std::f64::consts::{PI, SQRT_2, TAU};

/// Cases that are drawn: some three in four have a contact that three meshes resolve, and so an estimate.
const CASES: u64 = 150;
/// Columns on the shortest wave of what is judged, and of what it is judged by.
const JUDGED: usize = 64;
const TRUTH: usize = 256;
/// Fewest columns on a wave that `solve fem` takes for its estimate.
const FEWEST: usize = 8;

struct Case {
    profile: RigidProfile,
    speed: f64,
    pressure: f64,
    /// Shortest waves on the period.
    waves: usize,
}

impl Case {
    /// One or two octaves of slopes 0.05 to 2, 0.1 mm/s to 1 m/s, 0.05 to 25 MPa.
    fn random(seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let octaves = between(1.0, 3.0).floor() as i32;
        let slope = 10_f64.powf(between(-1.3, 0.3));
        let shortest = 10_f64.powf(between(-5.0, -3.5));
        let waves: Vec<Wave> = (0..octaves)
            .map(|octave| {
                let wavelength = shortest * 2_f64.powi(octave);
                let slope = slope * 2_f64.powf(-0.5 * f64::from(octave));
                let amplitude = slope * wavelength / (SQRT_2 * PI);
                Wave { wavelength, amplitude, phase: between(0.0, TAU) }
            })
            .collect();
        let period = waves[waves.len() - 1].wavelength;
        Self {
            profile: RigidProfile::from_waves(&waves, period),
            speed: 10_f64.powf(between(-4.0, 0.0)),
            pressure: 10_f64.powf(between(4.7, 7.4)),
            waves: 1 << (octaves - 1),
        }
    }

    fn solve(&self, columns: usize) -> Result<OnGrid, FemError> {
        let (law, profile) = (Rheology::NeoHookean, self.profile.clone());
        let options = BlockOptions::of_profile(columns, &profile);
        let mut contact = SteadyContact::new(&table_2_1(), law, self.speed, profile, options)?;
        contact.solve(self.pressure).map(|solution| OnGrid {
            points: columns,
            friction_coefficient: solution.friction_coefficient,
            contact_area_fraction: solution.contact_area_fraction,
        })
    }

    /// What is found, its estimated error and the truth; none where one of them cannot be had.
    fn judged(&self) -> Option<(OnGrid, GridError, OnGrid)> {
        let no_solution = |error: &FemError| matches!(error, FemError::PathEnded { .. });
        let (columns, fewest) = (JUDGED * self.waves, FEWEST * self.waves);
        let solve = |columns| self.solve(columns);
        let found =
            on_grid(columns, fewest, FINITE_ELEMENTS, solve, no_solution, |grid| *grid).ok()?;
        Some((found.solution, found.error?, self.solve(TRUTH * self.waves).ok()?))
    }
}

/// Friction and area of the same contacts, some hundred.
#[test]
#[ignore = "takes some fifteen minutes of processor time: .ci/full"]
fn friction_and_area_at_finite_deformation_are_as_accurate_as_they_say() {
    let judged: Vec<(OnGrid, GridError, OnGrid)> =
        (0..CASES).into_par_iter().filter_map(|seed| Case::random(seed).judged()).collect();
    let ratios = |value: fn(&OnGrid) -> f64, error: fn(&GridError) -> f64| -> Vec<f64> {
        let ratio = |(found, estimated, truth): &(OnGrid, GridError, OnGrid)| {
            // In full contact the area is exact.
            let round_off = 1e-7 * value(truth).abs();
            error(estimated).max(round_off) / (value(found) - value(truth)).abs().max(round_off)
        };
        judged.iter().map(ratio).collect()
    };
    let friction = ratios(|grid| grid.friction_coefficient, |error| error.friction_coefficient);
    assert_honest("friction at finite deformation", &friction, 10.0);
    let area = ratios(|grid| grid.contact_area_fraction, |error| error.contact_area_fraction);
    assert_honest("area at finite deformation", &area, 10.0);
}
