//! `asperity synth map`: a synthetic height map.

use super::impossible;
use crate::cli::output::{print, refuse_existing, write_file};
use crate::cli::{CliError, values};
use asperity::scans::file::{Grid, ScanFile, write_sdf, write_x3p};
use asperity::surface::HeightMap;
use asperity::surface::synthesis::SyntheticMap;
use asperity::units::Units;
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  The bundled map, a rolled road that is smoother along x:
    asperity synth map --out data/scans/map/road.x3p --force
  A larger isotropic one of 1024 by 1024 points with normally distributed heights:
    asperity synth map --out road.x3p --length-mm 51.2 --correlation-length-mm 0.5 --skewness 0";

/// Write a synthetic height map, as an areal instrument would give it.
///
/// A square map of a self-affine surface, as X3P or SDF by the name of the file. The same options give the same map on the same
/// kind of machine.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub(in crate::cli) struct SynthMap {
    /// New file, *.x3p or *.sdf.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Overwrite a file that is there already.
    #[arg(long)]
    force: bool,
    /// Length of a side in mm.
    #[arg(long, value_name = "MM", default_value = "19.2", value_parser = values::finite)]
    length_mm: f64,
    /// Distance between points in um.
    #[arg(long, value_name = "UM", default_value = "50", value_parser = values::finite)]
    spacing_um: f64,
    /// Hurst exponent of the self-affine regime, between 0 and 1.
    #[arg(long, value_name = "H", default_value = "0.75", value_parser = values::finite)]
    hurst_exponent: f64,
    /// Lengths in mm along x and y below which the surface is self-affine; one for both.
    #[arg(long, value_name = "MM", num_args = 1..=2, default_values = ["0.6", "0.4"], value_parser = values::finite)]
    correlation_length_mm: Vec<f64>,
    /// Root mean square height in mm of the unbounded surface; a map shows less of its long waves.
    #[arg(long, value_name = "MM", default_value = "0.1", value_parser = values::finite)]
    rms_height_mm: f64,
    /// Skewness of the heights, -4 to 4; negative for few deep valleys below a flattened top.
    #[arg(long, value_name = "SSK", default_value = "-1", value_parser = values::finite)]
    skewness: f64,
    /// Slopes (m/m) of the plane on which it lies, along x and y.
    #[arg(long, value_name = "SLOPE", num_args = 2, default_values = ["0.01", "-0.02"], value_parser = values::finite)]
    tilt: Vec<f64>,
    /// Standard deviation in um of the noise of a point.
    #[arg(long, value_name = "UM", default_value = "0.5", value_parser = values::finite)]
    noise_um: f64,
    /// Digit in um to which the instrument rounds; 2^-24 m if not given, 0 for none.
    #[arg(long, value_name = "UM", value_parser = values::finite)]
    digit_um: Option<f64>,
    /// Share of missing points, 0 to 0.5.
    #[arg(long, value_name = "FRACTION", default_value = "0.01", value_parser = values::finite)]
    missing_fraction: f64,
    /// Diameter in um of a patch of missing points.
    #[arg(long, value_name = "UM", default_value = "150", value_parser = values::finite)]
    missing_diameter_um: f64,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value = "1", value_parser = values::count::<u64>)]
    seed: u64,
}

impl SynthMap {
    fn parameters(&self) -> SyntheticMap {
        let [first, .., last] = self.correlation_length_mm[..] else {
            let length = self.correlation_length_mm.first().map_or(0.0, |mm| mm.mm_to_m());
            return SyntheticMap {
                correlation_lengths: [length; 2],
                ..self.with_lengths([0.0; 2])
            };
        };
        self.with_lengths([first.mm_to_m(), last.mm_to_m()])
    }

    fn with_lengths(&self, correlation_lengths: [f64; 2]) -> SyntheticMap {
        SyntheticMap {
            length: self.length_mm.mm_to_m(),
            spacing: self.spacing_um.um_to_m(),
            hurst_exponent: self.hurst_exponent,
            correlation_lengths,
            rms_height: self.rms_height_mm.mm_to_m(),
            skewness: self.skewness,
            tilt: [self.tilt[0], self.tilt[1]],
            noise: self.noise_um.um_to_m(),
            digit: self.digit_um.map_or(SyntheticMap::bundled().digit, Units::um_to_m),
            missing_fraction: self.missing_fraction,
            missing_diameter: self.missing_diameter_um.um_to_m(),
            seed: self.seed,
        }
    }

    pub(in crate::cli) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let parameters = self.parameters();
        parameters.validate().map_err(impossible)?;
        let extension = self.out.extension().unwrap_or_default().to_ascii_lowercase();
        let is_x3p = match extension.to_str() {
            Some("x3p") => true,
            Some("sdf") => false,
            _ => {
                let name = self.out.display();
                return Err(CliError::input(format!("{name}: call the new file *.x3p or *.sdf")));
            }
        };
        refuse_existing(Some(&self.out), self.force)?;
        // The name of the file is that of the map.
        let map = file_of(parameters.generate("map").map_err(impossible)?);
        let bytes = if is_x3p {
            write_x3p(&map).map_err(CliError::failure)?
        } else {
            write_sdf(&map).into_bytes()
        };
        write_file(&self.out, self.force, |out| out.write_all(&bytes))?;
        print(&if quiet {
            String::new()
        } else {
            let n = parameters.points();
            format!("{}\n{n} by {n} points\n", self.out.display())
        })
    }
}

fn file_of(map: HeightMap) -> ScanFile {
    let ([columns, rows], [spacing_x, spacing_y]) = (map.points, map.spacing);
    ScanFile {
        format: "synthetic".into(),
        detected: String::new(),
        grid: Grid::Map { columns, rows, spacing_x, spacing_y },
        heights: map.heights,
        instrument: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        map: SynthMap,
    }

    /// Other processors transform with other round-off, which the digit of the instrument takes away but for heights near
    /// the middle between two digits.
    #[test]
    fn the_bundled_map_is_made_again() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/data/scans/map/road.x3p");
        let bundled = asperity::scans::file::read_file(path.as_ref()).unwrap().unwrap();
        let map = SyntheticMap::bundled();
        let made = map.generate("map").unwrap();
        assert_eq!(bundled.heights.len(), made.heights.len());
        let mut others = 0;
        for (a, b) in bundled.heights.iter().zip(&made.heights) {
            assert_eq!(a.is_nan(), b.is_nan());
            if !a.is_nan() && a != b {
                assert!((a - b).abs() < 1.5 * map.digit, "{a} {b}");
                others += 1;
            }
        }
        assert!(others < 10, "{others} heights differ");
    }

    fn parameters(options: &[&str]) -> SyntheticMap {
        let words = ["map", "--out", "road.x3p"].iter().chain(options);
        Command::parse_from(words).map.parameters()
    }

    #[test]
    fn the_defaults_are_the_bundled_map() {
        assert_eq!(parameters(&[]), SyntheticMap::bundled());
        let isotropic = parameters(&["--correlation-length-mm", "0.5", "--tilt", "0", "-0.1"]);
        assert_eq!(isotropic.correlation_lengths, [0.5e-3; 2]);
        assert_eq!(isotropic.tilt, [0.0, -0.1]);
    }
}
