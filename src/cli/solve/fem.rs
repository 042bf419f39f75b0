//! `asperity solve fem`: sliding contact at finite deformation.

use std::path::PathBuf;
use std::time::Instant;

use clap::{ArgGroup, Args, ValueEnum};

use super::fem_output::{Summary, write_fields, write_series};
use super::material::MaterialOptions;
use super::refuse_to_overwrite;
use super::shape::{Shape, ShapeOptions};
use crate::cli::output::{json, note, print, significant, write_file};
use crate::cli::{CliError, values};
use crate::contact::SlidingContact;
use crate::fem::profile::RigidProfile;
use crate::fem::steady::{BlockOptions, SteadyContact};
use crate::fem::transient::{FlowRule, TransientContact, TransientOptions};
use crate::rubber::{Rheology, Rubber};

/// Relative to the wanted fraction; below what a mesh resolves.
const AREA_TOLERANCE: f64 = 1e-4;
/// Columns on the shortest wave without --columns: friction is then within about half a percent
/// of the limit for usual areas.
const DEFAULT_COLUMNS_PER_WAVE: f64 = 64.0;

/// Relative difference of heat and work from which the user is warned; converged meshes have 1e-3.
const COARSE: f64 = 0.05;

const EXAMPLES: &str = "\
Examples:
  One sine of wavelength 0.0625 mm and amplitude 0.01867 mm, the rubber of Table 2.1:
    asperity solve fem --wave 0.0625:0.01867 --speed 10 --pressure 1
  On a finer mesh, as JSON:
    asperity solve fem --wave 0.0625:0.01867 --speed 10 --pressure 1 --columns 256 --json
  Pressed in and dragged in time, with friction over time in a file:
    asperity solve fem --wave 0.0625:0.01867 --speed 10 --pressure 1 --columns 32 --route transient --series drag.csv
  Stress linear in the logarithmic strain:
    asperity solve fem --wave 0.0625:0.002 --speed 10 --pressure 0.1 --rheology linear

Exit codes: 0 solved, 1 no solution found or not written, 2 bad input.";

/// Solve the sliding contact of a rubber block with a periodic profile at finite deformation.
///
/// The block is one period long; its rubber is neo-Hookean with Maxwell branches in finite linear
/// viscoelasticity. The profile, the speed and the load are given as for solve bem.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
#[command(group(ArgGroup::new("load").required(true).args(["pressure", "area"])))]
pub(in crate::cli) struct Fem {
    #[command(flatten)]
    shape: ShapeOptions,
    /// Sliding speed in mm/s.
    #[arg(long, value_name = "MM_S", value_parser = values::positive, allow_negative_numbers = true)]
    speed: f64,
    /// Mean pressure in MPa.
    #[arg(long, value_name = "MPA", value_parser = values::positive, allow_negative_numbers = true)]
    pressure: Option<f64>,
    /// Contact area as a fraction of the nominal area, between 0 and 1, in place of --pressure;
    /// steady route only.
    #[arg(long, value_name = "FRACTION", value_parser = values::fraction, allow_negative_numbers = true)]
    area: Option<f64>,
    #[command(flatten)]
    material: MaterialOptions,
    /// The stationary field in the frame of the profile, or time steps as in the thesis.
    #[arg(long, value_name = "ROUTE", value_enum, default_value_t = Route::Steady)]
    route: Route,
    /// Elements over the period, 8 to 65536 [default: 64 on the shortest wave, at least 128; of
    /// the transient route a fourth of that].
    #[arg(long, value_name = "N", value_parser = values::count::<usize>, allow_negative_numbers = true)]
    columns: Option<usize>,
    /// Law of the springs at finite strain.
    #[arg(long, value_name = "LAW", value_enum, default_value_t = Law::NeoHookean)]
    rheology: Law,
    /// Height of the block in periods.
    #[arg(long, value_name = "PERIODS", default_value_t = 0.75, value_parser = values::positive, allow_negative_numbers = true)]
    height: f64,
    /// Periods of the drag, the last third of which is averaged; transient route only.
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = values::count::<usize>, allow_negative_numbers = true)]
    drag_periods: usize,
    /// Time integration of the branches; transient route only.
    #[arg(long, value_name = "RULE", value_enum, default_value_t = Rule::Trapezoidal)]
    flow_rule: Rule,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
    /// Also write position, height (about the mean line), normal pressure and separation at the
    /// contact nodes to this CSV file: x_mm, height_mm, pressure_mpa, separation_mm. An existing
    /// file is replaced; steady route only.
    #[arg(long, value_name = "FILE")]
    fields: Option<PathBuf>,
    /// Write the time steps of the transient route to this CSV file: time_s, pressure_mpa,
    /// displacement_mm, friction_coefficient, contact_area_fraction, mean_separation_mm. An
    /// existing file is replaced.
    #[arg(long, value_name = "FILE")]
    series: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Route {
    Steady,
    Transient,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Law {
    NeoHookean,
    Linear,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Rule {
    Trapezoidal,
    Exponential,
}

impl From<Law> for Rheology {
    fn from(law: Law) -> Self {
        match law {
            Law::NeoHookean => Self::NeoHookean,
            Law::Linear => Self::Linear,
        }
    }
}

impl From<Rule> for FlowRule {
    fn from(rule: Rule) -> Self {
        match rule {
            Rule::Trapezoidal => Self::Trapezoidal,
            Rule::Exponential => Self::Exponential,
        }
    }
}

impl Fem {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        self.check()?;
        let rubber = self.material.rubber()?;
        let shape = self.shape.build()?;
        if let Some(warning) = &shape.warning {
            note(quiet, format_args!("warning: {warning}"));
        }
        let profile = rigid_profile(&shape);
        let summary = match self.route {
            Route::Steady => self.steady(&rubber, profile, quiet)?,
            Route::Transient => self.transient(&rubber, profile, &shape)?,
        };
        print(&if self.json { json(&summary)? } else { summary.table() })
    }

    /// Options that contradict each other, before anything is computed.
    fn check(&self) -> Result<(), CliError> {
        let transient = self.route == Route::Transient;
        if self.shape.points.is_some() && self.shape.profile.is_none() {
            return Err(CliError::input(
                "--points is the grid of solve bem: give --columns, the sines are used as they are",
            ));
        }
        if transient && self.area.is_some() {
            return Err(CliError::input(
                "--area is found by the steady route only: give --pressure",
            ));
        }
        if transient && self.fields.is_some() {
            return Err(CliError::input(
                "--fields are those of the steady route: leave it out, or give --series",
            ));
        }
        if !transient && self.series.is_some() {
            return Err(CliError::input(
                "--series needs --route transient: the steady field has no time",
            ));
        }
        let inputs = [self.shape.profile.as_deref(), self.material.file()];
        refuse_to_overwrite(self.fields.as_deref(), "--fields", &inputs)?;
        refuse_to_overwrite(self.series.as_deref(), "--series", &inputs)
    }

    fn columns(&self, profile: &RigidProfile) -> usize {
        let usual = (DEFAULT_COLUMNS_PER_WAVE * profile.shortest_waves()).max(128.0) as usize;
        self.columns.unwrap_or(match self.route {
            Route::Steady => usual,
            Route::Transient => usual / 4,
        })
    }

    fn steady(
        &self,
        rubber: &Rubber,
        profile: RigidProfile,
        quiet: bool,
    ) -> Result<Summary, CliError> {
        let options =
            BlockOptions { height_ratio: self.height, ..BlockOptions::new(self.columns(&profile)) };
        let start = Instant::now();
        let rheology = self.rheology.into();
        let mut contact = SteadyContact::new(rubber, rheology, self.speed / 1e3, profile, options)?;
        let solution = match (self.pressure, self.area) {
            (Some(pressure_mpa), _) => contact.solve(pressure_mpa * 1e6)?,
            (None, Some(fraction)) => contact.solve_for_area(fraction, AREA_TOLERANCE)?,
            (None, None) => return Err(CliError::input("give --pressure or --area")),
        };
        let imbalance = solution.hysteretic_friction / solution.friction_coefficient - 1.0;
        if imbalance.abs() > COARSE && solution.hysteretic_friction != 0.0 {
            note(
                quiet,
                format_args!(
                    "warning: the heat of the branches differs from the work of the drag by {} %, \
                     the mesh is too coarse for reliable figures: give more --columns",
                    significant(100.0 * imbalance)
                ),
            );
        }
        if let Some(path) = &self.fields {
            write_file(path, true, |out| write_fields(out, &solution))?;
        }
        Ok(Summary::steady(&solution, start.elapsed().as_secs_f64()))
    }

    fn transient(
        &self,
        rubber: &Rubber,
        profile: RigidProfile,
        shape: &Shape,
    ) -> Result<Summary, CliError> {
        let Some(pressure_mpa) = self.pressure else {
            return Err(CliError::input("give --pressure"));
        };
        let (pressure, speed) = (pressure_mpa * 1e6, self.speed / 1e3);
        let options =
            BlockOptions { height_ratio: self.height, ..BlockOptions::new(self.columns(&profile)) };
        let start = Instant::now();
        options.check(profile.period())?;
        let mut mesh = options.mesh(profile.period());
        // The shear that the half-space's friction would give; half of it keeps elements usable
        // from the first touch to the full drag.
        let friction = SlidingContact::new(rubber, speed, shape.period, &shape.heights)?
            .solve(pressure)?
            .friction_coefficient;
        let shear_modulus = rubber.equilibrium_modulus / (2.0 * (1.0 + rubber.poisson_ratio));
        mesh.skew = -0.5 * friction * pressure / shear_modulus;
        let elements = [mesh.columns, mesh.rows()];
        let drag = TransientOptions {
            flow: self.flow_rule.into(),
            drag_periods: self.drag_periods,
            averaged_periods: (self.drag_periods / 3).max(1),
            ..TransientOptions::default()
        };
        let contact =
            TransientContact::new(rubber, self.rheology.into(), speed, profile, mesh, drag)?;
        let solution = contact.run(pressure, |_| {})?;
        if let Some(path) = &self.series {
            write_file(path, true, |out| write_series(out, &solution.samples))?;
        }
        let seconds = start.elapsed().as_secs_f64();
        Ok(Summary::transient(&solution, pressure, elements, seconds))
    }
}

fn rigid_profile(shape: &Shape) -> RigidProfile {
    if shape.waves.is_empty() {
        RigidProfile::from_heights(&shape.heights, shape.period)
    } else {
        RigidProfile::from_waves(&shape.waves, shape.period)
    }
}
