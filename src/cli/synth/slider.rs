//! `asperity synth slider`: one period of equal hard sliders.

use crate::cli::output::{print, refuse_existing, write_file};
use crate::cli::{CliError, values};
use asperity::contact::sliding::POINTS_RANGE;
use asperity::surface::Slider;
use asperity::units::Units;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  A cylinder of 10 mm radius, once in 128 mm, and its friction under 1.28 N per mm of its length (0.01 MPa times 128 mm):
    asperity synth slider --shape cylinder --radius-mm 10 --period-mm 128 --out cylinder.txt
    asperity solve bem --profile cylinder.txt --profile-unit mm --speed 100 --pressure 0.01
  A triangle whose flanks rise by 15 degrees, its tip rounded with 0.1 mm:
    asperity synth slider --shape triangle --angle-deg 15 --tip-radius-mm 0.1 --period-mm 64 --out triangle.txt";

/// Grids above this take minutes and gigabytes.
const MOST_POINTS: usize = 1 << 22;

/// Depth between two sliders over their distance: less is flat to round-off, more a mistake.
const DEPTHS: std::ops::Range<f64> = 1e-9..10.0;

/// Write one period of equal hard sliders, a profile for `asperity solve bem`.
///
/// A single slider needs a period much longer than its contact and than the distance that the rubber slides while it recovers:
/// solve with the period doubled, at the same force per length, until friction stays. The force per length in N/mm is the mean
/// pressure in MPa times the period in mm. docs/slider.md compares it with exact solutions.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub(in crate::cli) struct SynthSlider {
    #[command(flatten)]
    slider: SliderOptions,
    /// New file of two columns, x and z in mm.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Overwrite a file that is there already.
    #[arg(long)]
    force: bool,
    /// Distance in mm of one slider from the next.
    #[arg(long, value_name = "MM", value_parser = values::positive)]
    period_mm: f64,
    /// Points of the profile, 8 to 4194304; a contact needs some hundred for three digits.
    #[arg(long, value_name = "N", default_value = "16384", value_parser = values::count::<usize>)]
    points: usize,
}

/// Section of a slider.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Section {
    /// The parabola of a cylinder, as in Hertz' theory.
    Cylinder,
    /// Two straight flanks.
    Triangle,
}

/// A slider.
#[derive(Debug, Args)]
pub(in crate::cli) struct SliderOptions {
    /// Section of the slider.
    #[arg(long, value_name = "SECTION", value_enum)]
    shape: Section,
    /// Radius in mm of a cylinder.
    #[arg(long, value_name = "MM", required_if_eq("shape", "cylinder"), value_parser = values::positive)]
    radius_mm: Option<f64>,
    /// Angle in degrees between a flank of a triangle and the rubber at rest, above 0 and below 90.
    #[arg(long, value_name = "DEG", required_if_eq("shape", "triangle"), conflicts_with = "radius_mm", value_parser = values::positive)]
    angle_deg: Option<f64>,
    /// Radius in mm that rounds the tip of a triangle; 0, a sharp tip, if not given.
    #[arg(long, value_name = "MM", requires = "angle_deg", value_parser = values::finite)]
    tip_radius_mm: Option<f64>,
}

impl SliderOptions {
    /// # Errors
    /// [`CliError::Input`] for options of another shape and numbers that no slider has.
    pub(in crate::cli) fn slider(&self) -> Result<Slider, CliError> {
        match (self.shape, self.radius_mm, self.angle_deg) {
            (Section::Cylinder, Some(radius), None) => {
                Ok(Slider::Cylinder { radius: radius.mm_to_m() })
            }
            (Section::Triangle, None, Some(degrees)) if degrees < 90.0 => {
                let tip = self.tip_radius_mm.unwrap_or(0.0);
                if tip < 0.0 {
                    return Err(CliError::input(format!(
                        "--tip-radius-mm is {tip}: it must be 0 or positive"
                    )));
                }
                let slope = degrees.to_radians().tan();
                Ok(Slider::Triangle { slope, tip_radius: tip.mm_to_m() })
            }
            (Section::Triangle, None, Some(degrees)) => Err(CliError::input(format!(
                "--angle-deg is {degrees}: it must be below 90, the angle between a flank and the rubber at rest"
            ))),
            (Section::Cylinder, ..) => Err(CliError::input(
                "a cylinder has --radius-mm; --angle-deg is for --shape triangle",
            )),
            (Section::Triangle, ..) => Err(CliError::input(
                "a triangle has --angle-deg; --radius-mm is for --shape cylinder",
            )),
        }
    }
}

impl SynthSlider {
    pub(in crate::cli) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let slider = self.slider.slider()?;
        slider.validate().map_err(|error| CliError::input(error.to_string()))?;
        let least = *POINTS_RANGE.start();
        if !(least..=MOST_POINTS).contains(&self.points) {
            return Err(CliError::input(format!(
                "--points is {}: it must be from {least} to {MOST_POINTS}",
                self.points
            )));
        }
        let period = self.period_mm.mm_to_m();
        let spacing = self.period_mm / self.points as f64;
        if matches!(slider, Slider::Cylinder { radius } if spacing.mm_to_m() > radius) {
            return Err(CliError::input(format!(
                "{} points every {spacing:e} mm do not resolve the radius: give more --points or a shorter --period-mm",
                self.points
            )));
        }
        let heights = slider.sample(period, self.points);
        let depth = heights.iter().fold(0.0_f64, |most, z| most.max(-z));
        if !DEPTHS.contains(&(depth / period)) {
            return Err(CliError::input(format!(
                "a slider that is {:e} mm deep every {} mm is none: check the units of its lengths",
                depth.m_to_mm(),
                self.period_mm
            )));
        }
        refuse_existing(Some(&self.out), self.force)?;
        write_file(&self.out, self.force, |out| {
            let lines = heights.iter().enumerate();
            lines
                .into_iter()
                .try_for_each(|(i, z)| writeln!(out, "{:e} {:e}", i as f64 * spacing, z.m_to_mm()))
        })?;
        print(&if quiet {
            String::new()
        } else {
            format!("{}\n{} points every {:e} mm\n", self.out.display(), self.points, spacing)
        })
    }
}
