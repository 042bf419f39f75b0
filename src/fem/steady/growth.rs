//! A profile that grows at constant pressure, from its longest waves to its shortest.
//!
//! A profile of many scales cannot be reached through small pressures: the first of its tips
//! would carry all of the load long before the next one is touched, and end the path. Here the
//! smooth profile of the longest waves carries the load from the start. Then one octave of
//! shorter waves after the other grows out of it, which opens the contact where it was closed and
//! never asks one tip for more than its share. The mesh resolves the waves that are there, so the
//! finest one is only entered at the end.

use super::super::profile::RigidProfile;
use super::newton::Stuck;
use super::path::{Path, Scene};
use super::{BlockOptions, REFINEMENT, Setting};
use std::sync::Arc;

/// Columns on the shortest wave that is there while the next ones grow.
const COLUMNS_PER_WAVE: f64 = 64.0;
/// Columns of the mesh on which the longest waves are met first.
const FEWEST_COLUMNS: usize = 32;
/// Share of an octave that grows in the first step, and the one at which growth is given up.
const FIRST_SHARE: f64 = 0.1;
const SMALLEST_SHARE: f64 = 1e-3;
/// Newton steps of a step of growth below which the next one is longer, and above which it is shorter.
const EASY: usize = 9;
const HARD: usize = 16;
const LONGER: f64 = 1.5;
const SHORTER: f64 = 0.7;

/// The path at the whole profile on the wanted mesh, behind the barrier.
pub(super) fn grow(
    setting: &Setting,
    profile: &RigidProfile,
    options: BlockOptions,
    pressure: f64,
) -> Result<Path, Stuck> {
    let shortest = profile.shortest_waves();
    let mesh = |columns| BlockOptions { columns, ..options }.mesh(profile.period());
    let columns = |waves: f64| {
        let wanted = (COLUMNS_PER_WAVE * waves) as usize;
        wanted.max(FEWEST_COLUMNS).min(options.columns)
    };
    let mut waves = 1.0;
    let mut at = columns(waves);
    let smooth = profile.partial(waves, waves, 1.0);
    let mut path = Path::start(&Arc::new(setting.scene(smooth, at)), mesh(at), pressure)?;
    path.advance_to(pressure)?;
    while waves < shortest {
        let smooth = profile.partial(waves, waves, 1.0);
        let next = (2.0 * waves).min(shortest);
        for finer in finer_columns(at, columns(next)) {
            path.enter(setting.scene(smooth.clone(), finer));
            path.refine(&mesh(finer))?;
            at = finer;
        }
        // What is shorter than the shortest waves that matter grows with them.
        let growing = if next < shortest { next } else { f64::INFINITY };
        let whole = setting.scene(profile.partial(waves, growing, 1.0), at);
        grow_octave(&mut path, |share| Scene {
            profile: profile.partial(waves, growing, share),
            ..whole.clone()
        })?;
        waves = next;
    }
    for finer in finer_columns(at, options.columns) {
        path.enter(setting.scene(profile.clone(), finer));
        path.refine(&mesh(finer))?;
    }
    Ok(path)
}

/// Numbers of columns above the first one up to the last one, no more than the ratio of neighbouring
/// meshes apart.
fn finer_columns(first: usize, last: usize) -> Vec<usize> {
    let ratio = last as f64 / first as f64;
    let meshes = (ratio.ln() / REFINEMENT.ln() - 1e-9).ceil().max(0.0);
    let columns = |step| (first as f64 * ratio.powf(f64::from(step) / meshes)).round() as usize;
    (1..=meshes as u32).map(columns).collect()
}

/// Lets the shares of an octave grow from nothing to the whole.
fn grow_octave(path: &mut Path, scene: impl Fn(f64) -> Scene) -> Result<(), Stuck> {
    let (mut share, mut step) = (0.0_f64, FIRST_SHARE);
    while share < 1.0 {
        let next = (share + step).min(1.0);
        match path.reshape(scene(next)) {
            Ok(newton_steps) => {
                share = next;
                if newton_steps < EASY {
                    step *= LONGER;
                } else if newton_steps > HARD {
                    step *= SHORTER;
                }
            }
            Err(Stuck) => {
                step *= 0.5;
                if step < SMALLEST_SHARE {
                    return Err(Stuck);
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{SteadyContact, conclude};
    use super::*;
    use crate::contact::SlidingContact;
    use crate::rubber::{FiniteStrainRubber, Rheology, Rubber};
    use crate::surface::Wave;
    use approx::assert_relative_eq;

    const PERIOD: f64 = 1e-3;

    /// `octaves` waves of equal slope.
    fn profile(octaves: i32, amplitude_per_wavelength: f64) -> RigidProfile {
        let wave = |octave: i32| {
            let wavelength = PERIOD / 2_f64.powi(octave);
            let amplitude = amplitude_per_wavelength * wavelength;
            Wave { wavelength, amplitude, phase: 1.3 * f64::from(octave * octave) }
        };
        let waves: Vec<Wave> = (0..octaves).map(wave).collect();
        RigidProfile::from_waves(&waves, PERIOD)
    }

    fn setting() -> Setting {
        let rubber = Rubber::table_2_1();
        let finite = FiniteStrainRubber::new(&rubber, Rheology::NeoHookean).unwrap();
        Setting { rubber, finite, speed: 0.01, interrupt: Default::default() }
    }

    #[test]
    fn growth_and_growing_pressure_lead_to_one_solution() {
        let (setting, profile) = (setting(), profile(3, 0.05));
        let (options, pressure) = (BlockOptions::new(128), 4e4);
        let mut contact = SteadyContact::new(
            &setting.rubber,
            Rheology::NeoHookean,
            0.01,
            profile.clone(),
            options,
        )
        .unwrap();
        let expected = contact.solve(pressure).unwrap();
        let mut path = grow(&setting, &profile, options, pressure).unwrap();
        let grown = conclude(&mut path, &setting.scene(profile, 128), 0.01).unwrap();
        assert!(expected.shear < 0.05, "rows shifted differently are another mesh");
        assert!(expected.contact_area_fraction < 0.5);
        // The residuals of both.
        assert_relative_eq!(
            grown.friction_coefficient,
            expected.friction_coefficient,
            max_relative = 1e-6
        );
        assert_relative_eq!(
            grown.contact_area_fraction,
            expected.contact_area_fraction,
            max_relative = 1e-6
        );
    }

    #[test]
    fn five_octaves_of_small_slopes_have_the_friction_of_the_half_space() {
        // rms slope 0.04, as one wave; 16 waves on 512 columns.
        let profile = profile(5, 0.004);
        let rubber = Rubber::table_2_1();
        let pressure = 1e4;
        let mut half_space =
            SlidingContact::new(&rubber, 0.01, PERIOD, &profile.sample(4096)).unwrap();
        let expected = half_space.solve(pressure).unwrap();
        let options = BlockOptions::new(512);
        let mut contact =
            SteadyContact::new(&rubber, Rheology::NeoHookean, 0.01, profile, options).unwrap();
        let solution = contact.solve(pressure).unwrap();
        assert!(expected.contact_area_fraction < 0.5);
        // Slope and mesh: 32 columns on the shortest wave.
        assert_relative_eq!(
            solution.friction_coefficient,
            expected.friction_coefficient,
            max_relative = 0.03
        );
        let further = contact.solve(2.0 * pressure).unwrap();
        assert!(further.contact_area_fraction > solution.contact_area_fraction);
    }

    #[test]
    fn meshes_between_two_are_no_further_apart_than_neighbours() {
        assert_eq!(finer_columns(64, 64), Vec::<usize>::new());
        assert_eq!(finer_columns(64, 128), [91, 128]);
        assert_eq!(finer_columns(100, 150), [150]);
    }
}
