//! Steady contact under a shear traction against exact results, balances and differences.

use super::level::Level;
use super::long::Long;
use super::solution::SteadySolution;
use super::tests::{PERIOD, largest, setting};
use super::{BlockOptions, Setting, SteadyContact, UpperEdge};
use crate::contact::SlidingContact;
use crate::fem::profile::RigidProfile;
use crate::interface::{FrictionOverPressure, LocalFriction};
use crate::rubber::{Rheology, Rubber};
use crate::surface::Wave;
use approx::assert_relative_eq;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const SPEED: f64 = 0.01;
/// The steepest wave of Table 3.1 of the thesis.
const STEEP: f64 = 1.867e-5;

fn sine(amplitude: f64) -> RigidProfile {
    let wave = Wave { wavelength: PERIOD, amplitude, phase: 0.0 };
    RigidProfile::from_waves(&[wave], PERIOD)
}

fn coulomb(coefficient: f64) -> LocalFriction {
    LocalFriction::Coulomb { coefficient }
}

fn table() -> LocalFriction {
    let points = [[1e5, 0.9], [1e6, 0.7], [1e7, 0.2]];
    LocalFriction::Table(FrictionOverPressure::new(&points).unwrap())
}

fn solve(
    law: LocalFriction,
    profile: RigidProfile,
    columns: usize,
    pressure: f64,
) -> SteadySolution {
    let options = BlockOptions::new(columns);
    let contact =
        SteadyContact::new(&Rubber::table_2_1(), Rheology::NeoHookean, SPEED, profile, options);
    contact.unwrap().with_interface(law).unwrap().solve(pressure).unwrap()
}

#[test]
fn on_a_flat_profile_friction_is_that_of_the_interface() {
    let stress = LocalFriction::Stress { stress: 2e6, largest_coefficient: 3.0 };
    for (law, pressure) in [(coulomb(0.4), 5e5), (table(), 2e6), (stress, 1e6)] {
        let flat = solve(law.clone(), sine(0.0), 16, pressure);
        // The pressure is met within the residual of 1e-9.
        let met = flat.nodes[0].pressure;
        assert_relative_eq!(met, pressure, max_relative = 1e-9);
        let expected = law.at(met).stress / met;
        // Laws in which the coefficient hangs on the pressure are met within the residual as well.
        let within = if let LocalFriction::Coulomb { .. } = law { 1e-12 } else { 1e-9 };
        assert_relative_eq!(flat.friction_coefficient, expected, max_relative = within);
        assert_relative_eq!(flat.interface_friction, expected, max_relative = within);
        assert!(flat.hysteretic_friction.abs() < 1e-12, "{}", flat.hysteretic_friction);
    }
}

/// On slight slopes hysteresis and shear add up like the slopes of two inclines,
/// `μ = (μ_h + μ_loc) / (1 - μ_h μ_loc)`, since the shear carries a part of the load; what is left falls with the
/// square of the slope.
#[test]
fn on_slight_slopes_friction_is_the_sum() {
    for amplitude in [1e-7, 2e-7, 4e-7, 8e-7, 1.6e-6] {
        // The same contact at every slope: pressure in proportion to it.
        let pressure = 2e4 * amplitude / 1e-7;
        let [with, without] = [coulomb(0.4), LocalFriction::None]
            .map(|law| solve(law, sine(amplitude), 64, pressure));
        let area = with.contact_area_fraction;
        assert!((0.1..0.9).contains(&area), "{area}");
        let alone = without.friction_coefficient;
        let inclines = (alone + 0.4) / (1.0 - 0.4 * alone);
        let slope = std::f64::consts::TAU * amplitude / PERIOD;
        let left = with.friction_coefficient / inclines - 1.0;
        // The first part is the coupling of shear and pressure at ν = 0.49.
        assert!(left.abs() < 0.02 * slope + 0.2 * slope * slope, "{left} at {slope}");
        let beyond_the_sum = with.friction_coefficient - alone - 0.4;
        assert_relative_eq!(beyond_the_sum, 0.16 * alone, max_relative = 0.3);
    }
}

/// Work of the drag is heat of the branches and power of the interface: what is left is the mesh's, and no more of it
/// than without an interface.
#[test]
fn work_is_heat_and_power_of_the_interface() {
    let gap = |law: LocalFriction, amplitude: f64, columns: usize, pressure: f64| {
        let found = solve(law, sine(amplitude), columns, pressure);
        (found.hysteretic_friction + found.interface_friction) / found.friction_coefficient - 1.0
    };
    for law in [LocalFriction::None, coulomb(0.4), table()] {
        // Full contact, without edges.
        let full = [32, 64, 128].map(|columns| gap(law.clone(), 3e-6, columns, 3e6));
        let steep = [64, 128, 256].map(|columns| gap(law.clone(), STEEP, columns, 5e5));
        println!("{law:?}: full {full:?}, steep {steep:?}");
        assert!(full[2].abs() < 1e-4, "{law:?}: {full:?}");
        assert!(full[2].abs() < 0.3 * full[1].abs(), "{law:?}: {full:?}");
        assert!(steep[2].abs() < 5e-3, "{law:?}: {steep:?}");
    }
}

/// A half-space under shear: the same pressures as without, where ν = 1/2.
#[test]
fn on_slight_slopes_pressures_are_those_of_the_half_space() {
    let (columns, amplitude, pressure) = (256, 1e-7, 5e4);
    let law = table();
    let found = solve(law.clone(), sine(amplitude), columns, pressure);
    let mut space =
        SlidingContact::new(&Rubber::table_2_1(), SPEED, PERIOD, &sine(amplitude).sample(columns))
            .unwrap();
    let exact = space.solve(pressure).unwrap();
    let shear: f64 = exact.pressure.iter().map(|p| law.at(*p).stress).sum();
    let sum = exact.friction_coefficient + shear / columns as f64 / pressure;
    println!("{} against {sum}", found.friction_coefficient);
    // The block is finite and its Poisson ratio 0.49.
    assert_relative_eq!(found.friction_coefficient, sum, max_relative = 0.02);
}

#[test]
fn the_tangent_is_the_derivative_of_the_residual() {
    for law in [coulomb(0.4), table()] {
        let setting = Setting {
            interface: law.clone(),
            ..setting(&Rubber::table_2_1(), Rheology::NeoHookean, SPEED)
        };
        let mut level = Level::new(&setting, &BlockOptions::new(16), &sine(STEEP));
        let (pressure, barrier) = (3e5, 0.1);
        let mut at = level.above(pressure, barrier);
        let mut generator = Pcg64::seed_from_u64(7);
        let count = at.displacements.len();
        let mut direction: Vec<f64> =
            (0..count).map(|_| 1e-2 * PERIOD * (generator.random::<f64>() - 0.5)).collect();
        direction[level.upper_edge()].iter_mut().step_by(2).for_each(|x| *x = 0.0);
        let step = 1e-5;
        let mut shifted = |by: f64| {
            let mut state = at.clone();
            let moved = |value: &mut Long, change: f64| *value += by * change;
            state.displacements.iter_mut().zip(&direction).for_each(|(u, d)| moved(u, *d));
            let contact = direction.chunks_exact(2).map(|node| node[1]);
            state.contact.iter_mut().zip(contact).for_each(|(tau, d)| moved(tau, d));
            level.balance(&mut state, barrier).unwrap().residual
        };
        let (after, before) = (shifted(step), shifted(-step));
        let pairs = level.balance(&mut at, barrier).unwrap().pairs;
        let tangent = level.tangent(&pairs, &direction);
        // The equations of the fixed x displacements of the upper edge are their own.
        let free = level.upper_edge().start;
        let difference: Vec<f64> =
            (0..free).map(|i| (after[i] - before[i]) / (2.0 * step) - tangent[i]).collect();
        assert!(largest(&difference) < 1e-6 * largest(&tangent[..free]), "{law:?}");
    }
}

/// Under a high block the edge is far from the contact and what holds it does not matter; under a low one it does.
#[test]
fn a_plate_holds_the_edge_flat() {
    let friction = |height_ratio: f64, upper_edge: UpperEdge| {
        let options = BlockOptions { height_ratio, upper_edge, ..BlockOptions::new(32) };
        let (rubber, profile) = (Rubber::table_2_1(), sine(1e-5));
        let contact = SteadyContact::new(&rubber, Rheology::NeoHookean, SPEED, profile, options);
        let mut contact = contact.unwrap();
        let solution = contact.solve(5e5).unwrap();
        let path = contact.path.as_ref().unwrap();
        (solution.friction_coefficient, path.level.unevenness(&path.state))
    };
    let [low, high] = [0.3, 1.5].map(|height| {
        let [free, plate] = [UpperEdge::Pressure, UpperEdge::Plate].map(|e| friction(height, e));
        assert!(plate.1 < 2e-3 * free.1.max(1e-6 * PERIOD), "{plate:?} {free:?}");
        plate.0 / free.0 - 1.0
    });
    println!("plate over even pressure: {low:e} at 0.3, {high:e} at 1.5 periods");
    assert!(high.abs() < 1e-3 && low.abs() > 10.0 * high.abs(), "{low} {high}");
}
