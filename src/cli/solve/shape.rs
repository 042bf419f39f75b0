//! The profile of a single problem: superposed sines or a file.

use asperity::units::Units;
use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::profile_file::read_profile;
use crate::cli::{CliError, values};
use asperity::contact::sliding::{POINTS_RANGE, resample};
use asperity::fem::profile::RigidProfile;
use asperity::scans::description::LengthUnit;
use asperity::surface::{Wave, wave};

/// Five digits of the friction of one sine need a thousand points over its length.
const LEAST_DEFAULT_POINTS: usize = 1024;
/// Friction of eight waves is then converged to a few tenths of a percent for the usual areas.
const DEFAULT_POINTS_PER_WAVE: usize = 64;
/// Fewer cannot tell a wave from a longer one.
const LEAST_POINTS_PER_WAVE: usize = 3;
/// Largest relative deviation of a wavelength from a divisor of the period.
const COMMENSURABLE: f64 = 1e-9;
/// Longest common period in longest wavelengths.
const MAX_PERIOD: u32 = 1000;

/// What the rubber slides over.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("shape").required(true).args(["waves", "profile"])))]
pub(super) struct ShapeOptions {
    /// A sine as wavelength in mm, amplitude in mm and, optionally, phase in rad; repeat it for
    /// a sum of sines. The period is the smallest length that all wavelengths divide.
    #[arg(
        long = "wave",
        value_name = "WAVELENGTH_MM:AMPLITUDE_MM[:PHASE_RAD]",
        value_parser = parse_wave,
        allow_hyphen_values = true
    )]
    waves: Vec<Wave>,
    /// Text file with the columns x and z of one period, without its repeated end point:
    /// equidistant, separated by blanks, tabulators, commas or semicolons, comments after `#`.
    #[arg(long, value_name = "FILE", requires = "profile_unit")]
    pub(super) profile: Option<PathBuf>,
    /// Unit of x and z in --profile: nm, um, mm or m; never guessed.
    #[arg(long, value_name = "UNIT", requires = "profile", conflicts_with = "waves", value_parser = values::length_unit)]
    profile_unit: Option<LengthUnit>,
    /// Grid points over the period, 8 to 16777216 [default: as many as --tolerance needs; those of
    /// --profile].
    #[arg(long, value_name = "N", value_parser = values::count::<usize>, allow_negative_numbers = true)]
    pub(super) points: Option<usize>,
}

/// One period of a profile.
#[derive(Debug)]
pub(super) struct Shape {
    /// Length in m.
    pub(super) period: f64,
    /// Heights in m at equidistant points.
    pub(super) heights: Vec<f64>,
    /// The sines that were sampled; none for a profile from a file.
    pub(super) waves: Vec<Wave>,
    /// Warnings about the profile.
    pub(super) warning: Option<String>,
}

impl Shape {
    /// Heights in m on another number of points: sines are sampled there, of a profile every second,
    /// fourth ... point is taken.
    pub(super) fn heights_on(&self, points: usize) -> Vec<f64> {
        if self.waves.is_empty() {
            resample(&self.heights, points)
        } else {
            wave::sample(&self.waves, self.period, points)
        }
    }

    /// Wavelengths in m of the sines with an amplitude; of a profile its period and the shortest wave
    /// that matters for its slope.
    pub(super) fn excited_wavelengths(&self) -> Vec<f64> {
        if self.waves.is_empty() {
            let waves = RigidProfile::from_heights(&self.heights, self.period).shortest_waves();
            return vec![self.period, self.period / waves];
        }
        let present = self.waves.iter().filter(|wave| wave.amplitude != 0.0);
        present.map(|wave| wave.wavelength).collect()
    }

    /// Number of the shortest waves in the period; none for a profile.
    pub(super) fn shortest_waves(&self) -> Option<usize> {
        let counts = self.waves.iter().map(|wave| (self.period / wave.wavelength).round() as usize);
        counts.max()
    }
}

impl ShapeOptions {
    /// # Errors
    /// [`CliError::Input`].
    pub(super) fn build(&self) -> Result<Shape, CliError> {
        match (&self.profile, self.profile_unit) {
            (Some(path), Some(unit)) => {
                let shape = read_profile(path, unit).map_err(CliError::input)?;
                let found = shape.heights.len();
                let least = *POINTS_RANGE.start();
                if found < least {
                    return Err(CliError::input(format!(
                        "{} has {found} points, a profile needs {least} or more",
                        path.display()
                    )));
                }
                match self.points.filter(|points| *points != found) {
                    None => Ok(shape),
                    Some(points) => Err(CliError::input(format!(
                        "--points is {points}, but {} has {found} points: a profile is solved on its own points, \
                         leave --points out",
                        path.display()
                    ))),
                }
            }
            _ => superpose(&self.waves, self.points).map_err(CliError::input),
        }
    }
}

/// Share of the amplitudes below which heights are what double precision rounds off.
const ROUND_OFF: f64 = 1e-9;

fn superpose(waves: &[Wave], points: Option<usize>) -> Result<Shape, String> {
    let period = common_period(waves)?;
    // Wavelengths that miss their divisor by rounding would leave a step at the end of the period.
    let counts = waves.iter().map(|wave| (period / wave.wavelength).round());
    let fitted: Vec<Wave> = counts
        .clone()
        .zip(waves)
        .map(|(count, wave)| Wave { wavelength: period / count, ..*wave })
        .collect();
    let most = counts.fold(1.0, f64::max);
    let points = grid_points(most, points)?;
    let heights = wave::sample(&fitted, period, points);
    let amplitudes: f64 = waves.iter().map(|wave| wave.amplitude.abs()).sum();
    let left = heights.iter().fold(0.0_f64, |most, z| most.max(z.abs()));
    if left < ROUND_OFF * amplitudes {
        return Err(format!(
            "the waves cancel each other: of amplitudes of {} mm in all, heights of {:.1e} mm are left, which is \
             round-off; change an amplitude or a phase, or leave the waves out",
            amplitudes.m_to_mm(),
            left.m_to_mm()
        ));
    }
    Ok(Shape { period, heights, waves: fitted, warning: None })
}

/// The smallest length that all wavelengths divide, in the unit of the wavelengths.
fn common_period(waves: &[Wave]) -> Result<f64, String> {
    let longest = waves.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
    let divides = |period: f64, wavelength: f64| {
        let count = period / wavelength;
        (count - count.round()).abs() <= COMMENSURABLE * count
    };
    (1..=MAX_PERIOD)
        .map(|multiple| f64::from(multiple) * longest)
        .find(|period| waves.iter().all(|wave| divides(*period, wave.wavelength)))
        .ok_or_else(|| {
            let wavelengths: Vec<String> =
                waves.iter().map(|wave| (wave.wavelength.m_to_mm()).to_string()).collect();
            format!(
                "the wavelengths {} mm have no common period up to {MAX_PERIOD} times the longest: \
                 choose wavelengths whose ratios are simple fractions",
                wavelengths.join(", ")
            )
        })
}

/// Points for a period with `count` of the shortest waves.
fn grid_points(count: f64, wanted: Option<usize>) -> Result<usize, String> {
    let most = *POINTS_RANGE.end();
    let Some(points) = wanted else {
        let least = count * DEFAULT_POINTS_PER_WAVE as f64;
        if least > most as f64 {
            return Err(format!(
                "the period holds {count} of the shortest waves, for which {DEFAULT_POINTS_PER_WAVE} points each \
                 exceed the limit of {most}: leave out the shortest or the longest waves"
            ));
        }
        return Ok((least as usize).next_power_of_two().max(LEAST_DEFAULT_POINTS));
    };
    if !POINTS_RANGE.contains(&points) {
        let least = POINTS_RANGE.start();
        return Err(format!("--points is {points}, it must be from {least} to {most}"));
    }
    let needed = count * LEAST_POINTS_PER_WAVE as f64;
    if (points as f64) < needed {
        return Err(format!(
            "--points is {points}, but the period holds {count} of the shortest waves: give at least {needed}, \
             better {}",
            count * DEFAULT_POINTS_PER_WAVE as f64
        ));
    }
    Ok(points)
}

fn parse_wave(text: &str) -> Result<Wave, String> {
    let parts: Vec<&str> = text.split(':').collect();
    let (wavelength, amplitude, phase) = match parts[..] {
        [wavelength, amplitude] => (wavelength, amplitude, "0"),
        [wavelength, amplitude, phase] => (wavelength, amplitude, phase),
        _ => {
            return Err(
                "give WAVELENGTH_MM:AMPLITUDE_MM or WAVELENGTH_MM:AMPLITUDE_MM:PHASE_RAD, \
                 such as 0.0625:0.01867"
                    .into(),
            );
        }
    };
    let named = |name: &str| {
        let name = name.to_owned();
        move |problem: String| format!("the {name}: {problem}")
    };
    Ok(Wave {
        wavelength: LengthUnit::Mm
            .metres(values::positive(wavelength).map_err(named("wavelength in mm"))?),
        amplitude: LengthUnit::Mm
            .metres(values::finite(amplitude).map_err(named("amplitude in mm"))?),
        phase: values::finite(phase).map_err(named("phase in rad"))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn waves(wavelengths: &[f64]) -> Vec<Wave> {
        let wave = |&wavelength: &f64| Wave { wavelength, amplitude: 1e-6, phase: 0.3 };
        wavelengths.iter().map(wave).collect()
    }

    #[test]
    fn the_period_is_the_longest_wave_if_the_others_divide_it() {
        assert_eq!(common_period(&waves(&[0.0625, 8.0, 0.125])), Ok(8.0));
        // 0.1 and 0.3 are no binary fractions: the ratio is 3 only up to rounding.
        assert_eq!(common_period(&waves(&[0.1, 0.3])), Ok(0.3));
        assert_eq!(common_period(&waves(&[0.2, 0.3])), Ok(2.0 * 0.3));
        assert_eq!(common_period(&waves(&[1.0, 1.001])), Ok(1000.0 * 1.001));
    }

    #[test]
    fn wavelengths_without_common_period_are_refused() {
        let message = common_period(&waves(&[1.0, 2_f64.sqrt()])).unwrap_err();
        assert!(message.contains("no common period up to 1000"), "{message}");
        assert!(message.contains("1000, 1414.2135"), "{message}");
        assert!(common_period(&waves(&[1.0, 1.0009])).is_err());
    }

    #[test]
    fn points_resolve_the_shortest_wave() {
        let points = |wavelengths: &[f64]| {
            superpose(&waves(wavelengths), None).map(|shape| shape.heights.len())
        };
        assert_eq!(points(&[1.0]), Ok(1024));
        assert_eq!(points(&[1.0, 8.0]), Ok(1024));
        assert_eq!(points(&[0.0625, 8.0]), Ok(8192));
        // 51 waves of 64 points are 3264.
        assert_eq!(points(&[1.0, 51.0]), Ok(4096));
        assert!(points(&[1.0, 1e6]).unwrap_err().contains("limit of 16777216"));
        let few = superpose(&waves(&[1.0, 100.0]), Some(256)).unwrap_err();
        assert!(few.contains("at least 300, better 6400"), "{few}");
    }

    proptest! {
        /// Whatever the rounding of their ratios, the surface of commensurable waves is periodic.
        #[test]
        fn the_end_of_the_period_meets_its_start(a in 1_u32..30, b in 1_u32..30, unit in 1e-5..1e-2_f64) {
            let waves = waves(&[f64::from(a) * unit, f64::from(b) * unit]);
            let period = common_period(&waves).unwrap();
            for wave in &waves {
                // 1e-12 of the amplitude: rounding of a phase of at most 30 turns.
                let step = wave.height(period) - wave.height(0.0);
                prop_assert!(step.abs() < 1e-12 * wave.amplitude);
            }
        }
    }

    #[test]
    fn waves_are_read_in_millimetres_and_radians() {
        let wave = Wave { wavelength: 0.125 / 1e3, amplitude: -0.02648 / 1e3, phase: 1.57 };
        assert_eq!(parse_wave("0.125:-0.02648:1.57"), Ok(wave));
        assert_eq!(parse_wave(" 0.125 :-2.648e-2").map(|wave| wave.phase), Ok(0.0));
    }

    #[test]
    fn mistaken_waves_are_explained() {
        let cases = [
            ("0.0625", "WAVELENGTH_MM:AMPLITUDE_MM"),
            ("1:2:3:4", "WAVELENGTH_MM:AMPLITUDE_MM"),
            ("", "WAVELENGTH_MM:AMPLITUDE_MM"),
            ("a:b", "the wavelength in mm: `a` is not a number"),
            ("0:1", "the wavelength in mm: 0 is not positive"),
            ("-1:1", "the wavelength in mm: -1 is not positive"),
            ("1:", "the amplitude in mm: `` is not a number"),
            ("1:nan", "the amplitude in mm: `nan` is not a finite number"),
            ("1:0,5", "the decimal mark is a point"),
            ("1:1:inf", "the phase in rad: `inf` is not a finite number"),
        ];
        for (text, part) in cases {
            let message = parse_wave(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
