//! `asperity synth`: synthetic scans of asphalt.

mod map;
mod slider;

use asperity::units::Units;
pub(super) use slider::SliderOptions;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};

use super::interrupt::Interrupt;
use super::output::{already_exists, note, print, significant, write_file};
use super::{CliError, values};
use asperity::error_kind::HasKind;
use asperity::surface::synthesis::{
    OuterRegime, Stones, SynthesisError, SyntheticAsphalt, write_text,
};

/// All scans are held in memory, 16 bytes a point.
const MAX_TOTAL_POINTS: f64 = (1_u64 << 28) as f64;

const EXAMPLES: &str = "\
Examples:
  The bundled specimen, bit for bit:
    asperity synth --out data/scans/specimen --force
  The bundled rolled road: level stones with deep pits between them, skewness -1.4:
    asperity synth --out data/scans/rolled --texture rolled --force
  Five scans of 100 mm of a smoother road with one self-affine regime:
    asperity synth --out smooth --scans 5 --length-mm 100 --spacing-um 10 --no-outer-regime --perpendicular-correlation-length-mm 0.3 --seed 7
  A look at what came out:
    asperity inspect smooth/scan_01.txt --separator semicolon --comment '#' --x-column x_mm --x-unit mm --z-column z_um --z-unit um";

/// Write synthetic line scans of asphalt, as a profilometer would give them.
///
/// One text file per scan, scan_01.txt, scan_02.txt, ... with the columns x_mm and z_um separated by
/// semicolons; a missing point is BAD. The same options give the same files.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(super) struct Synth {
    #[command(subcommand)]
    other: Option<Other>,
    /// Folder for the scans; made if it is not there.
    #[arg(long, value_name = "DIR", required = true)]
    out: Option<PathBuf>,
    /// Overwrite scans that are there already.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    specimen: SpecimenOptions,
}

/// Other surfaces than line scans of asphalt.
#[derive(Debug, Subcommand)]
enum Other {
    /// Write a synthetic height map instead.
    Map(Box<map::SynthMap>),
    /// Write one period of hard sliders instead.
    Slider(Box<slider::SynthSlider>),
}

/// Surfaces with defaults of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Texture {
    /// A random self-affine surface, its heights skewed point by point: the bundled specimen.
    SelfAffine,
    /// Stones with level faces and deep pits between them, under a random self-affine texture: the bundled
    /// rolled road.
    Rolled,
}

/// The parameters of [`SyntheticAsphalt`]; a test compares the defaults with the bundled sets.
#[derive(Debug, Args)]
struct SpecimenOptions {
    /// Kind of surface. `rolled` has other defaults: 9 scans of 48 mm every 20 um, correlation lengths of 2 mm
    /// along and 0.424 mm across, no skewness of the random surface, a spot of 20 um, missing runs of 100 um, seed 1.
    #[arg(long, value_name = "KIND", default_value = "self-affine")]
    texture: Texture,
    /// Mean distance in mm between the pits of a rolled road, the size of its stones; 8 if not given.
    #[arg(long, value_name = "MM", default_value_if("texture", "rolled", "8"), value_parser = values::finite)]
    stone_distance_mm: Option<f64>,
    /// Mean depth in mm of the pits of a rolled road; 2.2 if not given.
    #[arg(long, value_name = "MM", default_value_if("texture", "rolled", "2.2"), value_parser = values::finite)]
    stone_depth_mm: Option<f64>,
    /// Exponent of the fall of a stone towards its pits, from 1 (a ridge) to 32 (a plate with slits); 4 if not given.
    #[arg(long, value_name = "N", default_value_if("texture", "rolled", "4"), value_parser = values::finite)]
    stone_flatness: Option<f64>,
    /// Number of scans.
    #[arg(long, value_name = "N", default_value_if("texture", "rolled", "9"), default_value = "30", value_parser = values::count::<usize>)]
    scans: usize,
    /// Length of a scan in mm.
    #[arg(long, value_name = "MM", default_value_if("texture", "rolled", "48"), default_value = "16", value_parser = values::finite)]
    length_mm: f64,
    /// Distance between raw points in um.
    #[arg(long, value_name = "UM", default_value_if("texture", "rolled", "20"), default_value = "2", value_parser = values::finite)]
    spacing_um: f64,
    /// Hurst exponent of the self-affine regime, the inner one if there are two, between 0 and 1.
    #[arg(long, value_name = "H", default_value = "0.65", value_parser = values::finite)]
    hurst_exponent: f64,
    /// Hurst exponent of the outer regime, between 0 and 1.
    #[arg(long, value_name = "H", default_value = "0.5", value_parser = values::finite)]
    outer_hurst_exponent: f64,
    /// Lag in mm where inner and outer regime meet, below the parallel correlation length.
    #[arg(long, value_name = "MM", default_value = "0.6", value_parser = values::finite)]
    crossover_lag_mm: f64,
    /// One self-affine regime only.
    #[arg(long, conflicts_with_all = ["outer_hurst_exponent", "crossover_lag_mm"])]
    no_outer_regime: bool,
    /// Correlation length along the track in mm, where the power law meets the plateau.
    #[arg(long, value_name = "MM", default_value_if("texture", "rolled", "2"), default_value = "3.5", value_parser = values::finite)]
    parallel_correlation_length_mm: f64,
    /// Correlation length across the surface in mm: the root of the plateau of the height-difference
    /// correlation, sqrt(2) Rq.
    #[arg(long, value_name = "MM", default_value_if("texture", "rolled", "0.424"), default_value = "0.883", value_parser = values::finite)]
    perpendicular_correlation_length_mm: f64,
    /// Sharpness of the bend from power law to plateau, from 1 (gradual) to 32 (a corner).
    #[arg(long, value_name = "P", default_value = "4", value_parser = values::finite)]
    plateau_sharpness: f64,
    /// Skewness, -4 to 4; negative for few deep valleys below a flattened top.
    #[arg(long, value_name = "RSK", default_value_if("texture", "rolled", "0"), default_value = "-1", value_parser = values::finite)]
    skewness: f64,
    /// 1/e^2 diameter in um of the spot over which the instrument averages; 0 for a point.
    #[arg(long, value_name = "UM", default_value_if("texture", "rolled", "20"), default_value = "10", value_parser = values::finite)]
    spot_diameter_um: f64,
    /// Standard deviation of the slope (m/m) of the plane on which a specimen lies.
    #[arg(long, value_name = "SLOPE", default_value = "0.02", value_parser = values::finite)]
    tilt: f64,
    /// Standard deviation in um of the noise of a raw point.
    #[arg(long, value_name = "UM", default_value = "1", value_parser = values::finite)]
    noise_um: f64,
    /// Share of the raw points that are missing, 0 to 0.5.
    #[arg(long, value_name = "FRACTION", default_value = "0.03", value_parser = values::finite)]
    missing_fraction: f64,
    /// Mean length in um of a run of missing points.
    #[arg(long, value_name = "UM", default_value_if("texture", "rolled", "100"), default_value = "40", value_parser = values::finite)]
    missing_run_length_um: f64,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value_if("texture", "rolled", "1"), default_value = "35", value_parser = values::count::<u64>)]
    seed: u64,
}

impl SpecimenOptions {
    /// # Errors
    /// Options of stones for a surface that has none.
    fn parameters(&self) -> Result<SyntheticAsphalt, CliError> {
        let stones = [
            ("--stone-distance-mm", self.stone_distance_mm),
            ("--stone-depth-mm", self.stone_depth_mm),
            ("--stone-flatness", self.stone_flatness),
        ];
        let rolled = self.texture == Texture::Rolled;
        let given = stones.iter().find(|(_, value)| value.is_some());
        if let Some((option, _)) = given.filter(|_| !rolled) {
            return Err(CliError::input(format!("{option} needs --texture rolled")));
        }
        let outer_regime = OuterRegime {
            hurst_exponent: self.outer_hurst_exponent,
            crossover_lag: self.crossover_lag_mm.mm_to_m(),
        };
        Ok(SyntheticAsphalt {
            scans: self.scans,
            length: self.length_mm.mm_to_m(),
            spacing: self.spacing_um.um_to_m(),
            hurst_exponent: self.hurst_exponent,
            outer_regime: (!self.no_outer_regime).then_some(outer_regime),
            stones: self.stones(),
            parallel_correlation_length: self.parallel_correlation_length_mm.mm_to_m(),
            perpendicular_correlation_length: self.perpendicular_correlation_length_mm.mm_to_m(),
            plateau_sharpness: self.plateau_sharpness,
            skewness: self.skewness,
            spot_diameter: self.spot_diameter_um.um_to_m(),
            tilt: self.tilt,
            noise: self.noise_um.um_to_m(),
            missing_fraction: self.missing_fraction,
            missing_run_length: self.missing_run_length_um.um_to_m(),
            seed: self.seed,
        })
    }

    /// `None` for a self-affine surface; the options have defaults for a rolled one.
    fn stones(&self) -> Option<Stones> {
        Some(Stones {
            mean_distance: self.stone_distance_mm?.mm_to_m(),
            mean_depth: self.stone_depth_mm?.mm_to_m(),
            flatness: self.stone_flatness?,
        })
    }
}

/// The options of lengths, which are checked in m, with their units in m.
const LENGTHS: [(&str, &str, &str, f64); 14] = [
    ("length_m", "--length-mm", "mm", 1e-3),
    ("spacing_m", "--spacing-um", "um", 1e-6),
    ("outer_regime.crossover_lag_m", "--crossover-lag-mm", "mm", 1e-3),
    ("parallel_correlation_length_m", "--parallel-correlation-length-mm", "mm", 1e-3),
    ("perpendicular_correlation_length_m", "--perpendicular-correlation-length-mm", "mm", 1e-3),
    ("stones.mean_distance_m", "--stone-distance-mm", "mm", 1e-3),
    ("stones.mean_depth_m", "--stone-depth-mm", "mm", 1e-3),
    ("spot_diameter_m", "--spot-diameter-um", "um", 1e-6),
    ("noise_m", "--noise-um", "um", 1e-6),
    ("missing_run_length_m", "--missing-run-length-um", "um", 1e-6),
    ("correlation_length_m", "--correlation-length-mm", "mm", 1e-3),
    ("rms_height_m", "--rms-height-mm", "mm", 1e-3),
    ("digit_m", "--digit-um", "um", 1e-6),
    ("missing_diameter_m", "--missing-diameter-um", "um", 1e-6),
];

/// Six significant digits without zeros at the end.
fn shortest(number: f64) -> String {
    let text = significant(number);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// What a length may be, such as `from 0.001 to 0.4`, from m into the unit of its option.
fn in_unit(allowed: &str, unit: &str, metres: f64) -> String {
    let mut has_length = false;
    let word = |word: &str| match word.parse::<f64>() {
        Ok(0.0) => "0".to_owned(),
        Ok(length) => {
            has_length = true;
            shortest(length / metres)
        }
        Err(_) => word.to_owned(),
    };
    let words: Vec<String> = allowed.split(' ').map(word).collect();
    let unit = if has_length { format!(" {unit}") } else { String::new() };
    words.join(" ") + &unit
}

/// The error under the name of the option, with the value and its limits in its unit.
fn impossible(error: SynthesisError) -> CliError {
    let SynthesisError::OutOfRange { parameter, value, allowed } = &error else {
        return CliError::of(error.kind(), error.to_string());
    };
    if let Some((_, option, unit, metres)) = LENGTHS.iter().find(|known| known.0 == *parameter) {
        let typed = shortest(value / metres);
        return CliError::input(format!(
            "{option} is {typed} {unit}: it must be {}",
            in_unit(allowed, unit, *metres)
        ));
    }
    let option = parameter.replace("outer_regime.", "outer-").replace("stones.", "stone-");
    let option = format!("--{}", option.replace('_', "-"));
    CliError::input(format!("{option} is {value}: it must be {allowed}"))
}

impl Synth {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        match &self.other {
            Some(Other::Map(map)) => return map.run(quiet),
            Some(Other::Slider(slider)) => return slider.run(quiet),
            None => {}
        }
        let Some(out) = &self.out else {
            return Err(CliError::input("give a folder for the scans as --out"));
        };
        let parameters = self.specimen.parameters()?;
        parameters.validate().map_err(impossible)?;
        let total = parameters.scans as f64 * (parameters.length / parameters.spacing);
        if total > MAX_TOTAL_POINTS {
            return Err(CliError::input(format!(
                "{total:.1e} points are more than the {MAX_TOTAL_POINTS:.1e} that are made at once: lower --scans \
                 or --length-mm, or raise --spacing-um"
            )));
        }
        let scans = parameters.generate().map_err(impossible)?;
        let file = |name: &str| out.join(format!("{name}.txt"));
        let present = scans.iter().map(|scan| file(&scan.name)).find(|path| path.exists());
        if let Some(path) = present.filter(|_| !self.force) {
            return Err(already_exists(&path));
        }
        fs::create_dir_all(out).map_err(|error| CliError::no_folder(out, &error))?;
        let interrupt = Interrupt::install()?;
        for scan in &scans {
            interrupt.check()?;
            write_file(&file(&scan.name), self.force, |mut out| write_text(scan, &mut out))?;
        }
        let names: Vec<OsString> =
            scans.iter().map(|scan| format!("{}.txt", scan.name).into()).collect();
        let others = other_scans(out, &names).map_err(|error| {
            let folder = out.display();
            CliError::failure(format!("cannot look for other scans in {folder}: {error}"))
        })?;
        if others > 0 {
            note(
                quiet,
                format_args!("warning: {} holds {others} other scans as well", out.display()),
            );
        }
        let points = scans.first().map_or(0, |scan| scan.heights.len());
        let lines = scans.iter().map(|scan| format!("{}\n", file(&scan.name).display()));
        print(&if quiet {
            String::new()
        } else {
            lines.collect::<String>()
                + &format!("{points} points in each of {} files\n", scans.len())
        })
    }
}

/// Number of other scans in the folder, which a recipe would take for scans of the same specimen.
fn other_scans(folder: &Path, written: &[OsString]) -> std::io::Result<usize> {
    let other = |name: &OsString| {
        let text = name.to_string_lossy();
        text.starts_with("scan_") && text.ends_with(".txt") && !written.contains(name)
    };
    let names = fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name()));
    let names: Vec<OsString> = names.collect::<std::io::Result<_>>()?;
    Ok(names.iter().filter(|name| other(name)).count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        synth: Synth,
    }

    #[test]
    fn the_defaults_are_the_bundled_sets() {
        let parameters = |options: &[&str]| {
            let words = ["synth", "--out", "scans"].iter().chain(options);
            Command::parse_from(words).synth.specimen.parameters().unwrap()
        };
        assert_eq!(parameters(&[]), SyntheticAsphalt::specimen());
        assert_eq!(parameters(&["--texture", "self-affine"]), SyntheticAsphalt::specimen());
        assert_eq!(parameters(&["--texture", "rolled"]), SyntheticAsphalt::rolled());
        let deep = parameters(&["--stone-depth-mm", "3", "--texture", "rolled", "--scans", "2"]);
        assert_eq!((deep.stones.unwrap().mean_depth, deep.scans), (3e-3, 2));
    }
}
