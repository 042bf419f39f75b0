//! A profile that grows at constant pressure, from its longest waves to its shortest.
//!
//! A profile of many scales cannot be reached through small pressures: its highest tip would carry all of the load long
//! before the next one is touched, and the path would end. Here the smooth profile of the longest waves carries the
//! load from the start. Then one octave of shorter waves after the other is added with growing amplitude, so that the
//! load is always spread over all tips. The grid resolves the waves present, so the finest grid is used only at the
//! end.

use super::super::profile::RigidProfile;
use super::level::{Level, Surface};
use super::lift::lift;
use super::path::Path;
use super::{BlockOptions, NotConverged, Setting};

/// Columns on the shortest wave present, while it grows.
const COLUMNS_PER_WAVE: f64 = 32.0;
/// Columns of the grid on which the longest waves are solved first.
const FEWEST_COLUMNS: usize = 32;
/// Fraction of an octave added in the first step, and the smallest one before growth is given up.
const FIRST_SHARE: f64 = 0.25;
const SMALLEST_SHARE: f64 = 1e-3;
/// Newton steps below which the next step of growth is longer.
const EASY: usize = 6;
const LONGER: f64 = 1.25;
const SHORTER: f64 = 0.6;

/// The path at the complete profile on the grid asked for, with the barrier.
pub(super) fn grow(
    setting: &Setting,
    profile: &RigidProfile,
    options: BlockOptions,
    pressure: f64,
) -> Result<Path, NotConverged> {
    let shortest = profile.shortest_waves();
    let level = |columns, profile: &RigidProfile| {
        Level::new(setting, &BlockOptions { columns, ..options }, profile)
    };
    let columns = |waves: f64| {
        let columns = (COLUMNS_PER_WAVE * waves) as usize;
        columns.max(FEWEST_COLUMNS).min(options.columns)
    };
    let mut waves = 1.0;
    let mut at = columns(waves);
    let smooth = profile.partial(waves, waves, 1.0);
    let first = setting.first_pressure(&smooth).min(pressure);
    let mut path = Path::start(level(at, &smooth), first)?;
    path.advance_to(pressure)?;
    while waves < shortest {
        let next = (2.0 * waves).min(shortest);
        if columns(next) > at {
            at = columns(next);
            path.refine(level(at, &profile.partial(waves, waves, 1.0)))?;
        }
        // Waves shorter than the shortest that matter grow with them.
        let growing = if next < shortest { next } else { f64::INFINITY };
        grow_octave(&mut path, |share| profile.partial(waves, growing, share))?;
        waves = next;
    }
    if options.columns > at {
        path.refine(level(options.columns, profile))?;
    }
    Ok(path)
}

/// Raises the amplitude of an octave from zero to its full value.
fn grow_octave(path: &mut Path, profile: impl Fn(f64) -> RigidProfile) -> Result<(), NotConverged> {
    let (mut share, mut step) = (0.0_f64, FIRST_SHARE);
    while share < 1.0 {
        // The last step is not a tiny remainder.
        let next = if share + 1.2 * step < 1.0 { share + step } else { 1.0 };
        match reshape(path, &profile(next)) {
            Ok(steps) => {
                share = next;
                if steps < EASY {
                    step *= LONGER;
                }
            }
            Err(NotConverged) => {
                step *= SHORTER;
                if step < SMALLEST_SHARE || path.level.interrupt.is_set() {
                    return Err(NotConverged);
                }
            }
        }
    }
    Ok(())
}

/// Exchanges the profile; returns the Newton steps. If it fails, the state is unchanged.
fn reshape(path: &mut Path, profile: &RigidProfile) -> Result<usize, NotConverged> {
    let surface = Surface::new(profile, path.level.grid().contact_nodes());
    let before = std::mem::replace(&mut path.level.surface, surface);
    let state = path.state.clone();
    let heights = path.level.surface.heights.iter().zip(&before.heights);
    let change: Vec<f64> = heights.map(|(new, old)| new - old).collect();
    lift(path.level.grid(), &change, &mut path.state.displacements);
    let solved = path.resolve();
    if solved.is_err() {
        path.level.surface = before;
        path.state = state;
    }
    solved
}

#[cfg(test)]
mod tests {
    use super::super::SteadyContact;
    use super::super::path::EXACT;
    use super::super::solution::SteadySolution;
    use super::super::tests::setting;
    use super::*;
    use crate::contact::SlidingContact;
    use crate::rubber::{Rheology, Rubber};
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

    #[test]
    fn growth_and_growing_pressure_lead_to_one_solution() {
        let setting = setting(&Rubber::table_2_1(), Rheology::NeoHookean, 0.01);
        let profile = profile(3, 0.05);
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
        let (state, residual) = path.finish(EXACT).unwrap();
        let grown = SteadySolution::read(&path.level, &state, 0.01, residual);
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
}
