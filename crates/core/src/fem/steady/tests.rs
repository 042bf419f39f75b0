//! The steady block against differences and exact results.

use super::block::Block;
use super::grid::Grid;
use super::long::Long;
use super::{BlockOptions, Setting, SteadyContact};
use crate::fem::error::FemError;
use crate::fem::mesh::Grading;
use crate::fem::profile::RigidProfile;
use crate::numerics::Interrupt;
use crate::rubber::{FiniteStrainRubber, Rheology, Rubber};
use crate::surface::Wave;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::time::{Duration, Instant};

pub(super) const PERIOD: f64 = 6.25e-5;

const YEOH: Rheology = Rheology::Yeoh { c2_over_c1: -0.1, c3_over_c1: 0.01 };
const ARRUDA_BOYCE: Rheology = Rheology::ArrudaBoyce { locking_stretch: 2.0 };
const LAWS: [Rheology; 4] = [Rheology::NeoHookean, Rheology::Linear, YEOH, ARRUDA_BOYCE];

pub(super) fn setting(rubber: &Rubber, rheology: Rheology, speed: f64) -> Setting {
    let finite = FiniteStrainRubber::new(rubber, rheology).unwrap();
    let (interface, layer, interrupt) = Default::default();
    Setting { rubber: rubber.clone(), finite, speed, interface, layer, interrupt }
}

fn block(rubber: &Rubber, rheology: Rheology, options: &BlockOptions, speed: f64) -> Block {
    let material = setting(rubber, rheology, speed).material(PERIOD);
    Block::new(Grid::new(options, PERIOD), material)
}

fn long(values: &[f64]) -> Vec<Long> {
    values.iter().map(|value| Long::from(*value)).collect()
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

/// Of a contact that lasts for no time the mean of a row is that of the glass, and what varies along it is that of
/// the rubber.
#[test]
fn in_a_short_contact_the_mean_is_glassy_and_the_rest_relaxes() {
    let (rubber, speed) = (Rubber::table_2_1(), 0.01);
    let glassy =
        rubber.equilibrium_modulus + rubber.branches.iter().map(|b| b.modulus).sum::<f64>();
    let options = BlockOptions::new(32);
    let forces = |finite: FiniteStrainRubber| {
        let setting = Setting { finite, ..setting(&rubber, Rheology::NeoHookean, speed) };
        let mut block = Block::new(Grid::new(&options, PERIOD), setting.material(PERIOD));
        let grid = block.grid.clone();
        let sheared = |row: usize| {
            let z = grid.levels[row];
            [2.0 * z, -0.05 * z].map(Long::from).repeat(grid.nodes_in(row))
        };
        let displacements: Vec<Long> = (0..=grid.rows()).flat_map(sheared).collect();
        block.deform(&displacements).unwrap().0
    };
    let finite = |rubber: &Rubber| FiniteStrainRubber::new(rubber, Rheology::NeoHookean).unwrap();
    let glass = forces(finite(&Rubber::elastic(glassy, rubber.poisson_ratio)));
    let short = forces(finite(&rubber).in_a_contact_that_lasts(0.0, PERIOD / speed));
    let scale = largest(&glass);
    let apart: Vec<f64> = short.iter().zip(&glass).map(|(short, glass)| short - glass).collect();
    assert!(largest(&apart) < 1e-8 * scale, "{} of {scale}", largest(&apart));
    let friction = |length: Option<f64>| {
        let wave = Wave { wavelength: PERIOD, amplitude: 1e-7, phase: 0.0 };
        let profile = RigidProfile::from_waves(&[wave], PERIOD);
        let contact =
            SteadyContact::new(&rubber, Rheology::NeoHookean, speed, profile, options).unwrap();
        let mut contact = match length {
            Some(length) => contact.lasting(length),
            None => contact,
        };
        contact.solve(1e4).unwrap().friction_coefficient
    };
    let (relaxed, short) = (friction(None), friction(Some(1e-2 * PERIOD)));
    assert!((short / relaxed - 1.0).abs() < 2e-3, "{short} {relaxed}");
}

#[test]
fn homogeneous_deformation_is_in_equilibrium() {
    let grading = Grading { first: 0.8, growth: 1.3 };
    for (law, coarsening) in [
        (Rheology::NeoHookean, true),
        (Rheology::Linear, false),
        (YEOH, true),
        (ARRUDA_BOYCE, false),
    ] {
        let options = BlockOptions { grading, coarsening, ..BlockOptions::new(128) };
        let mut block = block(&Rubber::table_2_1(), law, &options, 0.01);
        let grid = block.grid.clone();
        // A large shear and compression of the rows: u = (6 Z, -0.1 Z).
        let displacements: Vec<Long> = (0..=grid.rows())
            .flat_map(|row| {
                let z = grid.levels[row];
                [6.0 * z, -0.1 * z].map(Long::from).repeat(grid.nodes_in(row))
            })
            .collect();
        let (forces, validity) = block.deform(&displacements).unwrap();
        assert!((validity.label - 1.0).abs() < 1e-12 && (validity.volume - 0.9).abs() < 1e-9);
        let inner = 2 * grid.first_node(1)..2 * grid.first_node(grid.rows());
        let outer = largest(&forces[..inner.start]);
        // Round-off of the glassy stiffness, 1e3 times the forces of the outer rows.
        assert!(largest(&forces[inner]) < 1e-9 * outer, "{law:?}");
        assert!(block.dissipation(&displacements).abs() < 1e-9, "nothing flows at rest");
    }
}

#[test]
fn the_tangent_is_the_derivative_of_the_forces() {
    let grading = Grading { first: 0.8, growth: 1.3 };
    for law in LAWS {
        // The last one is coarsened; speeds at which all branches remember, some, and none.
        for (columns, speed) in [(10, 1e-6), (10, 0.01), (10, 10.0), (128, 0.01)] {
            let coarsening = columns == 128;
            let options = BlockOptions { grading, coarsening, ..BlockOptions::new(columns) };
            let mut block = block(&Rubber::table_2_1(), law, &options, speed);
            let mut generator = Pcg64::seed_from_u64(3);
            let scale = PERIOD / columns as f64;
            let count = 2 * block.grid.nodes();
            let mut random = |size: f64| -> Vec<f64> {
                (0..count).map(|_| size * scale * (generator.random::<f64>() - 0.5)).collect()
            };
            let (at, direction) = (random(0.2), random(1.0));
            let step = 1e-5;
            let mut shifted = |by: f64| {
                let displacements: Vec<Long> =
                    at.iter().zip(&direction).map(|(u, d)| (u + by * d).into()).collect();
                block.deform(&displacements).unwrap().0
            };
            let (after, before) = (shifted(step), shifted(-step));
            block.deform(&long(&at)).unwrap();
            let tangent = block.tangent(&direction);
            let difference: Vec<f64> = after
                .iter()
                .zip(&before)
                .zip(&tangent)
                .map(|((a, b), t)| (a - b) / (2.0 * step) - t)
                .collect();
            let error = largest(&difference) / largest(&tangent);
            assert!(error < 1e-6, "{law:?}, {columns} columns, {speed} m/s: {error}");
        }
    }
}

/// With branches that follow at once or not at all the local tangent is the whole one.
#[test]
fn the_local_tangent_is_exact_without_relaxation_history() {
    use super::stiffness::{Positions, pattern};
    let rubber = Rubber::elastic(4e6, 0.49);
    for law in LAWS {
        let mut block = block(&rubber, law, &BlockOptions::new(12), 0.01);
        let mut generator = Pcg64::seed_from_u64(5);
        let count = 2 * block.grid.nodes();
        let mut random = |size: f64| -> Vec<f64> {
            (0..count).map(|_| size * PERIOD / 12.0 * (generator.random::<f64>() - 0.5)).collect()
        };
        let (at, direction) = (random(0.2), random(1.0));
        block.deform(&long(&at)).unwrap();
        let pattern = pattern(&block.grid);
        let values = Positions::new(&block.grid, &pattern).assemble(&block, &pattern);
        let mut product = vec![0.0; count];
        pattern.multiply(&values, &direction, &mut product);
        let expected = block.tangent(&direction);
        let difference: Vec<f64> = product.iter().zip(&expected).map(|(a, b)| a - b).collect();
        assert!(largest(&difference) < 1e-6 * largest(&expected), "{law:?}");
    }
}

#[test]
fn an_interrupt_ends_a_solve_and_is_no_end_of_a_path() {
    let wave = Wave { wavelength: 6.25e-5, amplitude: 1.867e-5, phase: 0.0 };
    let profile = RigidProfile::from_waves(&[wave], wave.wavelength);
    let (rubber, law) = (Rubber::table_2_1(), Rheology::NeoHookean);
    let interrupt = Interrupt::default();
    let mut contact = SteadyContact::new(&rubber, law, 0.01, profile, BlockOptions::new(1024))
        .unwrap()
        .interruptible(&interrupt);
    let user = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(500));
        interrupt.set();
        Instant::now()
    });
    assert_eq!(contact.solve(3e6).err(), Some(FemError::Interrupted));
    let heard = user.join().unwrap().elapsed();
    assert!(heard < Duration::from_secs(1), "{heard:?}");
    assert_eq!(contact.solve(3e5).err(), Some(FemError::Interrupted));
}
