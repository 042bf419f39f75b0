//! The areal surface of a single problem: superposed sines in two directions, or a map.

use asperity::units::Units;
use std::f64::consts::TAU;
use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::map_file::{Map, read_map};
use crate::cli::inspect::ScanOptions;
use crate::cli::{CliError, values};
use asperity::scans::description::LengthUnit;

/// Fewest points along a direction.
const LEAST_POINTS: usize = 8;
/// Most points along a direction.
const MOST_POINTS: usize = 1 << 15;
/// Points of the grid of superposed sines along each direction, at least, and of each of the shortest waves.
const DEFAULT_POINTS: usize = 256;
const DEFAULT_POINTS_PER_WAVE: usize = 32;
/// Fewer cannot tell a wave from a longer one.
const LEAST_POINTS_PER_WAVE: usize = 3;
/// Most waves along a direction.
const MOST_WAVES: i32 = 1 << 20;
/// Largest range of heights of a map over its longer period.
const MOST_HEIGHT: f64 = 10.0;
/// Steps of a map across its end over the largest inside, from which on it is one that does not close.
const CLIFF: f64 = 3.0;

/// What the rubber slides over.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("surface").required(true).args(["modes", "map"])))]
pub(super) struct ArealShapeOptions {
    /// A sine `A sin(2 π (M x/LX + N y/LY) + φ)` as M,N, its amplitude A in mm and, optionally, its phase φ in rad:
    /// `2,1:0.004` has two periods along x and one along y. Repeat it for a sum of sines.
    #[arg(
        long = "mode",
        value_name = "M,N:AMPLITUDE_MM[:PHASE_RAD]",
        value_parser = parse_mode,
        allow_hyphen_values = true,
        requires = "size_mm"
    )]
    modes: Vec<Mode>,
    /// Map of one period: a file of an instrument (SDF, X3P, Digital Surf, Gwyddion text, Wyko ASCII, OpenCRG), or text
    /// of three columns x, y and z, or of heights row by row with --size-mm; any other text with the options under "Text
    /// scans".
    #[arg(long, value_name = "FILE")]
    pub(super) map: Option<PathBuf>,
    /// Unit of a --map of text: nm, um, mm or m; never guessed.
    #[arg(long, value_name = "UNIT", requires = "map", conflicts_with = "modes", value_parser = values::length_unit)]
    map_unit: Option<LengthUnit>,
    /// Mirror the map along both directions, so that it closes: four times the points.
    #[arg(long, requires = "map", conflicts_with = "modes")]
    mirror: bool,
    /// Periods of the surface in mm along x and y; one number is both, or of a --map of heights the length of a row.
    #[arg(long, value_name = "LX[,LY]", value_parser = parse_size, allow_negative_numbers = true)]
    size_mm: Option<Pair<f64>>,
    /// Grid points along x and y; one number is both [default: 32 on each of the shortest waves of --mode and 256 or more;
    /// those of --map].
    #[arg(long, value_name = "NX[,NY]", value_parser = parse_points, conflicts_with = "map", allow_negative_numbers = true)]
    points: Option<Pair<usize>>,
    /// How the text of a map is to be read.
    #[command(flatten)]
    text: ScanOptions,
}

/// A number for x, and one for y if that differs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::cli) struct Pair<T> {
    x: T,
    y: Option<T>,
}

impl Pair<f64> {
    /// Lengths in mm, in m.
    pub(in crate::cli) fn metres(self) -> [Option<f64>; 2] {
        [Some(self.x.mm_to_m()), self.y.map(Units::mm_to_m)]
    }
}

/// One superposed sine.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Mode {
    /// Periods along x and y.
    waves: [i32; 2],
    /// Amplitude in m.
    amplitude: f64,
    phase: f64,
}

/// One period of a surface.
#[derive(Debug)]
pub(super) struct ArealShape {
    map: Map,
    modes: Vec<Mode>,
    /// What looks like a mistake.
    pub(super) warning: Option<String>,
}

impl ArealShape {
    /// Points along x and y.
    pub(super) fn points(&self) -> [usize; 2] {
        self.map.points
    }

    /// Periods along x and y in m.
    pub(super) fn periods(&self) -> [f64; 2] {
        self.map.periods
    }

    /// How often both numbers of points can be halved.
    pub(super) fn halvings(&self) -> u32 {
        let [nx, ny] = self.map.points;
        nx.trailing_zeros().min(ny.trailing_zeros())
    }

    /// Heights in m on a grid halved this often: every second point, and every second of these.
    pub(super) fn heights(&self, halvings: u32) -> Vec<f64> {
        let [nx, ny] = self.map.points;
        let rows = (0..ny).step_by(1 << halvings);
        let row =
            |j: usize| self.map.heights[j * nx..][..nx].iter().step_by(1 << halvings).copied();
        rows.flat_map(row).collect()
    }

    /// Wavelengths in m along the direction of sliding, at `angle` to x, that excite the rubber; of a map its periods and
    /// waves of four points.
    pub(super) fn excited_wavelengths(&self, angle: f64) -> Vec<f64> {
        let Map { points, periods, .. } = self.map;
        let waves: Vec<[f64; 2]> = if self.modes.is_empty() {
            let shortest = points.map(|n| n as f64 / 4.0);
            vec![[1.0, 0.0], [0.0, 1.0], [shortest[0], 0.0], [0.0, shortest[1]]]
        } else {
            let present = self.modes.iter().filter(|mode| mode.amplitude != 0.0);
            present.map(|mode| mode.waves.map(f64::from)).collect()
        };
        let number =
            |[m, n]: [f64; 2]| (m / periods[0] * angle.cos() + n / periods[1] * angle.sin()).abs();
        // Waves across the direction excite nothing; round-off of the angle is no wave.
        let least = 1e-9 / periods[0].max(periods[1]);
        waves.into_iter().map(number).filter(|k| *k > least).map(|k| 1.0 / k).collect()
    }
}

impl ArealShapeOptions {
    /// The surface, if `admit` does not refuse its numbers of points.
    ///
    /// # Errors
    /// [`CliError::Input`], and those of `admit`.
    pub(super) fn build(
        &self,
        admit: impl Fn([usize; 2]) -> Result<(), CliError>,
    ) -> Result<ArealShape, CliError> {
        let given = self.size_mm.map(Pair::metres);
        let Some(path) = &self.map else {
            if let Some(option) = self.text.given().first() {
                return Err(CliError::input(format!(
                    "{option} describes a --map of text, and the surface is given by --mode: leave it out"
                )));
            }
            let [length, width] = given.unwrap_or_default();
            let length = length.unwrap_or_default();
            let points = grid_points(&self.modes, self.points).map_err(CliError::input)?;
            admit(points)?;
            return Ok(superpose(&self.modes, [length, width.unwrap_or(length)], points));
        };
        let mut map = read_map(path, self.map_unit, given, &self.text)?;
        require_surface(path, &map)?;
        admit(if self.mirror { map.points.map(|n| 2 * n) } else { map.points })?;
        if self.mirror {
            map = mirrored(&map);
        }
        let warning = cliff(&map);
        Ok(ArealShape { map, modes: Vec::new(), warning })
    }
}

/// Refuses a map of too few or too many points, and one whose heights are no surface.
///
/// # Errors
/// [`CliError::Input`] with the file.
pub(in crate::cli) fn require_surface(path: &std::path::Path, map: &Map) -> Result<(), CliError> {
    for n in map.points {
        if !(LEAST_POINTS..=MOST_POINTS).contains(&n) {
            let [nx, ny] = map.points;
            return Err(CliError::input(format!(
                "{} has {nx} by {ny} points, a map needs {LEAST_POINTS} to {MOST_POINTS} along each direction",
                path.display()
            )));
        }
    }
    let [low, high] = [f64::min, f64::max]
        .map(|least| map.heights.iter().copied().reduce(least).unwrap_or_default());
    let longest = map.periods[0].max(map.periods[1]);
    if high - low > MOST_HEIGHT * longest {
        return Err(CliError::input(format!(
            "{}: heights from {} to {} mm on a map of {} mm are no surface: check --map-unit, --size-mm, and numbers \
             that stand for missing points",
            path.display(),
            low.m_to_mm(),
            high.m_to_mm(),
            longest.m_to_mm()
        )));
    }
    Ok(())
}

/// Points along x and y for the modes.
fn grid_points(modes: &[Mode], given: Option<Pair<usize>>) -> Result<[usize; 2], String> {
    let shortest = |axis: usize| {
        modes.iter().map(|mode| mode.waves[axis].unsigned_abs() as usize).max().unwrap_or(1).max(1)
    };
    let along = |axis: usize| -> Result<usize, String> {
        let waves = shortest(axis);
        let Some(Pair { x, y }) = given else {
            let wanted = (DEFAULT_POINTS_PER_WAVE * waves).next_power_of_two().max(DEFAULT_POINTS);
            return if wanted <= MOST_POINTS {
                Ok(wanted)
            } else {
                Err(format!(
                    "{waves} waves along a direction need {wanted} points: give fewer waves, or --points"
                ))
            };
        };
        let given = if axis == 0 { x } else { y.unwrap_or(x) };
        if !(LEAST_POINTS..=MOST_POINTS).contains(&given) {
            return Err(format!(
                "--points is {given}, it must be from {LEAST_POINTS} to {MOST_POINTS}"
            ));
        }
        if given < LEAST_POINTS_PER_WAVE * waves {
            return Err(format!(
                "--points is {given}, but the period holds {waves} of the shortest waves: give at least {}, better {}",
                LEAST_POINTS_PER_WAVE * waves,
                DEFAULT_POINTS_PER_WAVE * waves
            ));
        }
        Ok(given)
    };
    Ok([along(0)?, along(1)?])
}

fn superpose(modes: &[Mode], periods: [f64; 2], points: [usize; 2]) -> ArealShape {
    let [nx, ny] = points;
    let height = |j: usize, i: usize| -> f64 {
        let place = [i as f64 / nx as f64, j as f64 / ny as f64];
        let of = |mode: &Mode| {
            let turns: f64 = mode.waves.iter().zip(place).map(|(m, x)| f64::from(*m) * x).sum();
            mode.amplitude * (TAU * turns.fract() + mode.phase).sin()
        };
        modes.iter().map(of).sum()
    };
    let heights = (0..ny).flat_map(|j| (0..nx).map(move |i| (j, i))).map(|(j, i)| height(j, i));
    let map = Map { points, periods, heights: heights.collect() };
    ArealShape { map, modes: modes.to_vec(), warning: None }
}

/// The map and its mirror images along x, y and both.
pub(in crate::cli) fn mirrored(map: &Map) -> Map {
    let [nx, ny] = map.points;
    let fold = |k: usize, n: usize| if k < n { k } else { 2 * n - 1 - k };
    let places = (0..2 * ny).flat_map(|j| (0..2 * nx).map(move |i| (j, i)));
    let heights = places.map(|(j, i)| map.heights[fold(j, ny) * nx + fold(i, nx)]).collect();
    Map { points: [2 * nx, 2 * ny], periods: map.periods.map(|period| 2.0 * period), heights }
}

/// A warning for a map that ends where it does not begin.
pub(in crate::cli) fn cliff(map: &Map) -> Option<String> {
    let [nx, ny] = map.points;
    let height = |j: usize, i: usize| map.heights[j * nx + i];
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |a, b| a.max(b.abs()));
    let steps = [
        (
            "x",
            largest(
                &mut (0..ny)
                    .flat_map(|j| (1..nx).map(move |i| (j, i)))
                    .map(|(j, i)| height(j, i) - height(j, i - 1)),
            ),
            largest(&mut (0..ny).map(|j| height(j, 0) - height(j, nx - 1))),
        ),
        (
            "y",
            largest(
                &mut (1..ny)
                    .flat_map(|j| (0..nx).map(move |i| (j, i)))
                    .map(|(j, i)| height(j, i) - height(j - 1, i)),
            ),
            largest(&mut (0..nx).map(|i| height(0, i) - height(ny - 1, i))),
        ),
    ];
    steps.into_iter().find(|(_, inside, end)| *end > CLIFF * inside).map(|(axis, inside, end)| {
        format!(
            "the map ends along {axis} up to {:.6} mm from the heights that it begins with, {:.0} times its largest step: as a \
             period it has a cliff there; give --mirror, or cut it where it closes",
            end.m_to_mm(),
            end / inside
        )
    })
}

/// Lengths in mm that are no mistake.
const SIZES_MM: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

pub(in crate::cli) fn parse_size(text: &str) -> Result<Pair<f64>, String> {
    parse_pair(text, |part| match values::positive(part)? {
        mm if SIZES_MM.contains(&mm) => Ok(mm),
        _ => Err(format!("{} is not from 1e-6 to 1e6", part.trim())),
    })
}

fn parse_points(text: &str) -> Result<Pair<usize>, String> {
    parse_pair(text, |part| values::count(part.trim()))
}

fn parse_pair<T>(text: &str, one: impl Fn(&str) -> Result<T, String>) -> Result<Pair<T>, String> {
    match text.split(',').collect::<Vec<_>>()[..] {
        [x] => Ok(Pair { x: one(x)?, y: None }),
        [x, y] => Ok(Pair { x: one(x)?, y: Some(one(y)?) }),
        _ => Err("give one number, or two with a comma between them".into()),
    }
}

fn parse_mode(text: &str) -> Result<Mode, String> {
    let parts: Vec<&str> = text.split(':').collect();
    let (waves, amplitude, phase) = match parts[..] {
        [waves, amplitude] => (waves, amplitude, "0"),
        [waves, amplitude, phase] => (waves, amplitude, phase),
        _ => {
            return Err(
                "give M,N:AMPLITUDE_MM or M,N:AMPLITUDE_MM:PHASE_RAD, such as 2,1:0.004".into()
            );
        }
    };
    let whole = |text: &str| match text.trim().parse::<i32>() {
        Ok(number) if (-MOST_WAVES..=MOST_WAVES).contains(&number) => Ok(number),
        _ => Err(format!("`{}` is not a whole number of waves", text.trim())),
    };
    let waves = match waves.split(',').collect::<Vec<_>>()[..] {
        [m, n] => [whole(m)?, whole(n)?],
        _ => return Err(format!("`{waves}`: give waves along x and y, such as 2,1")),
    };
    if waves == [0, 0] {
        return Err("0,0 is a constant height, which changes nothing: leave it out".into());
    }
    let named = |name: &str| {
        let name = name.to_owned();
        move |problem: String| format!("the {name}: {problem}")
    };
    Ok(Mode {
        waves,
        amplitude: values::finite(amplitude).map_err(named("amplitude in mm"))?.mm_to_m(),
        phase: values::finite(phase).map_err(named("phase in rad"))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_read_with_their_signs_and_phases() {
        let mode = parse_mode("2,-1:0.004:1.57").unwrap();
        assert_eq!((mode.waves, mode.phase), ([2, -1], 1.57));
        approx::assert_relative_eq!(mode.amplitude, 4e-6, max_relative = 1e-15);
        for (text, part) in [
            ("2:0.004", "`2`: give waves along x and y"),
            ("2,1", "M,N:AMPLITUDE_MM"),
            ("2.5,1:0.004", "`2.5` is not a whole number of waves"),
            ("0,0:1", "0,0 is a constant height"),
            ("1,1:0,5", "the decimal mark is a point"),
            ("1,1:1:inf", "the phase in rad: `inf` is not a finite number"),
        ] {
            let message = parse_mode(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn a_mode_is_a_sine_on_the_grid_of_both_directions() {
        let modes = [parse_mode("2,1:1000:0.3").unwrap()];
        let shape = superpose(&modes, [2.0, 3.0], [32, 16]);
        assert_eq!((shape.points(), shape.halvings()), ([32, 16], 4));
        let (i, j) = (5, 11);
        let (x, y) = (2.0 * 5.0 / 32.0, 3.0 * 11.0 / 16.0);
        let expected = (TAU * (2.0 * x / 2.0 + y / 3.0) + 0.3).sin();
        approx::assert_abs_diff_eq!(shape.heights(0)[j * 32 + i], expected, epsilon = 1e-12);
        // Every second point of both directions.
        assert_eq!(shape.heights(1)[3 * 16 + 2], shape.heights(0)[6 * 32 + 4]);
        // Along x one metre a wave; along the crests none.
        approx::assert_relative_eq!(shape.excited_wavelengths(0.0)[0], 1.0, max_relative = 1e-12);
        let along_crests = (-3.0_f64).atan2(1.0);
        assert!(shape.excited_wavelengths(along_crests).is_empty());
        assert_eq!(grid_points(&modes, None), Ok([256, 256]));
        let both = parse_points("64,32").unwrap();
        assert_eq!(grid_points(&modes, Some(both)), Ok([64, 32]));
        assert!(parse_points("8,8,8").is_err() && parse_size("1,0").is_err());
        let sixteen = parse_points("16").ok();
        let few = grid_points(&[parse_mode("9,1:1").unwrap()], sixteen).unwrap_err();
        assert!(few.contains("at least 27, better 288"), "{few}");
    }

    #[test]
    fn a_mirrored_map_closes_and_a_tilted_one_is_told() {
        let heights: Vec<f64> =
            (0..64).map(|k| f64::from(k % 8) + 0.1 * f64::from(k / 8)).collect();
        let map = Map { points: [8, 8], periods: [1e-3, 2e-3], heights };
        let warning = cliff(&map).unwrap();
        assert!(warning.contains("along x") && warning.contains("7 times"), "{warning}");
        let mirrored = mirrored(&map);
        assert_eq!((mirrored.points, mirrored.periods), ([16, 16], [2e-3, 4e-3]));
        assert_eq!(mirrored.heights[9 * 16 + 15], map.heights[6 * 8]);
        assert_eq!(cliff(&mirrored), None);
    }
}
