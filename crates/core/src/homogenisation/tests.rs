//! Recursion over scales against another program and exact limits.

use super::*;
use crate::fem::profile::RigidProfile;
use crate::numerics::Interrupt;
use crate::numerics::interpolation::CubicHermite;
use crate::rubber::{Rubber, RubberModel};
use crate::surface::Wave;
use approx::assert_relative_eq;

/// No curve ends early.
const ALL: [f64; 2] = [f64::INFINITY, 1.0];

fn sine(wavelength: f64, amplitude: f64) -> RigidProfile {
    RigidProfile::from_waves(&[Wave { wavelength, amplitude, phase: 0.0 }], wavelength)
}

/// The three shortest waves of Table 3.1 as the prototype has them.
fn three_waves() -> [RigidProfile; 3] {
    [sine(6.25e-5, 1.867e-5), sine(1.25e-4, 2.648e-5), sine(2.5e-4, 3.111e-5)]
}

fn friction_at_area(curve: &[ScalePoint], area: f64) -> f64 {
    let rising: Vec<&ScalePoint> = curve.iter().filter(|point| point.area > 0.0).collect();
    let column = |value: fn(&ScalePoint) -> f64| rising.iter().map(|p| value(p)).collect();
    CubicHermite::monotone(column(|p| p.area.ln()), column(|p| p.friction)).at(area.ln())
}

/// `recur.py` of the shared prototypes, whose table `extensions.md` prints.
#[test]
fn the_recursion_on_the_half_space_is_that_of_another_program() {
    let (rubber, interrupt) = (RubberModel::from(Rubber::table_2_1()), Interrupt::default());
    for (speed, expected) in [(0.01, [1.050, 1.037, 1.002]), (0.05, [1.787, 1.848, 1.820])] {
        let setting = Setting {
            rubber: &rubber,
            speed,
            mechanics: Mechanics::HalfSpace,
            resolution: 512,
            pressure_ratio: 1.25,
            interrupt: &interrupt,
        };
        let found =
            homogenise(&setting, &three_waves(), Passed::Friction, [5e4, 6e6], ALL).unwrap();
        for (area, expected) in [0.02, 0.05, 0.1].into_iter().zip(expected) {
            let friction = friction_at_area(&found.curve, area);
            println!("{speed} m/s, area {area}: {friction:.4}, {expected}");
            assert_relative_eq!(friction, expected, max_relative = 0.01);
        }
        assert!(found.curve.iter().all(|point| point.load_beyond < 1e-3));
    }
}

/// Below waves without friction and without height a group is alone.
#[test]
fn a_group_on_flat_ones_is_alone() {
    let (rubber, interrupt) = (RubberModel::from(Rubber::table_2_1()), Interrupt::default());
    for mechanics in [Mechanics::HalfSpace, Mechanics::FiniteDeformation] {
        let setting = Setting {
            rubber: &rubber,
            speed: 0.01,
            mechanics,
            resolution: 64,
            pressure_ratio: 2.0,
            interrupt: &interrupt,
        };
        let (long, range) = (sine(1.25e-4, 2.648e-5), [1e5, 1e6]);
        let groups = [sine(6.25e-5, 1e-12), long.clone()];
        let alone = homogenise(&setting, &[long], Passed::Friction, range, ALL).unwrap().curve;
        for passed in [Passed::Friction, Passed::FrictionAndSeparation] {
            let found = homogenise(&setting, &groups, passed, range, ALL).unwrap().curve;
            assert_eq!(found.len(), alone.len());
            for (point, alone) in found.iter().zip(&alone) {
                assert_relative_eq!(point.friction, alone.friction, max_relative = 1e-5);
                // Under a layer edges are not read between points.
                if passed == Passed::Friction {
                    assert_relative_eq!(point.area, alone.area, max_relative = 0.1);
                }
            }
        }
    }
}

/// Scales far apart: the method is exact in this limit. Waves of 1/64 of the length on the half-space.
#[test]
fn of_scales_far_apart_the_recursion_is_the_whole_surface() {
    let (rubber, interrupt) = (RubberModel::from(Rubber::table_2_1()), Interrupt::default());
    let setting = Setting {
        rubber: &rubber,
        speed: 0.01,
        mechanics: Mechanics::HalfSpace,
        resolution: 128,
        pressure_ratio: 1.3,
        interrupt: &interrupt,
    };
    let long = Wave { wavelength: 4e-3, amplitude: 2e-5, phase: 0.3 };
    let short = Wave { wavelength: 4e-3 / 64.0, amplitude: 5e-7, phase: 0.0 };
    let groups = [
        RigidProfile::from_waves(&[short], short.wavelength),
        RigidProfile::from_waves(&[long], long.wavelength),
    ];
    let whole = RigidProfile::from_waves(&[long, short], long.wavelength);
    let mut exact = Scale::new(&setting, &whole, None, false).unwrap();
    // The long wave alone is in contact on a fifth of its length.
    let range = [3e3, 1e4];
    for (passed, within) in [(Passed::Friction, 0.05), (Passed::FrictionAndSeparation, 0.01)] {
        let found = homogenise(&setting, &groups, passed, range, ALL).unwrap();
        let last = found.curve.last().unwrap();
        let expected = exact.at(last.pressure).unwrap();
        println!("{passed:?}: {last:?} against {expected:?}");
        assert_relative_eq!(last.friction, expected.friction, max_relative = within);
        assert_relative_eq!(last.area, expected.area, max_relative = within);
    }
}
