//! `asperity solve fem`: sliding contact at finite deformation.

use asperity::units::Units;
use std::path::PathBuf;
use std::time::Instant;

use clap::{ArgGroup, Args, ValueEnum};

use super::fem_output::{Summary, write_fields, write_series};
use super::interface_options::InterfaceOptions;
use super::material::MaterialOptions;
use super::refuse_to_overwrite;
use super::resolution;
use super::shape::{Shape, ShapeOptions};
use crate::cli::output::{json, note, print, refuse_existing, write_file};
use crate::cli::progress::Spinner;
use crate::cli::{CliError, threads, values};
use asperity::contact::SlidingContact;
use asperity::contact::refine::{
    FINITE_ELEMENTS, OnGrid, RefineError, Refinement, Watched, on_grid,
};
use asperity::error_kind::HasKind;
use asperity::fem::error::{FemError, PathEnd};
use asperity::fem::profile::RigidProfile;
use asperity::fem::steady::solution::SteadySolution;
use asperity::fem::steady::{BlockOptions, SteadyContact};
use asperity::fem::transient::{FlowRule, TransientContact, TransientOptions};
use asperity::rubber::{Rheology, Rubber};

/// Relative tolerance of the contact area of --area; below what a mesh resolves.
const AREA_TOLERANCE: f64 = 1e-4;
/// Default of --drag-periods, that of the thesis.
const DEFAULT_DRAG_PERIODS: usize = 12;

const EXAMPLES: &str = "\
Examples:
  One sine of wavelength 0.0625 mm and amplitude 0.01867 mm, the rubber of Table 2.1:
    asperity solve fem --wave 0.0625:0.01867 --speed 10 --pressure 1
  On a finer mesh, as JSON:
    asperity solve fem --wave 0.0625:0.01867 --speed 10 --pressure 1 --columns 256 --json
  Pressed in and dragged in time, with friction over time in a file:
    asperity solve fem --wave 0.0625:0.01867 --speed 10 --pressure 1 --columns 32 --route transient --series drag.csv
  With a shear stress of 1 MPa in the contact:
    asperity solve fem --wave 0.0625:0.01867 --speed 10 --pressure 1 --shear-mpa 1
  Stress linear in the logarithmic strain:
    asperity solve fem --wave 0.0625:0.002 --speed 10 --pressure 0.1 --rheology linear

Exit codes: 0 solved, 1 no solution found or not written, 2 bad input.";

/// Solve the sliding contact of a rubber block with a periodic profile at finite deformation.
///
/// The block is one period long; its rubber is that of --rubber with Maxwell branches in finite linear
/// viscoelasticity, under the law that its file names, or neo-Hookean. The profile, the speed and the load are given as for solve bem.
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
    /// Contact area as a fraction of the nominal area, between 0 and 1, instead of --pressure;
    /// steady route only.
    #[arg(long, value_name = "FRACTION", value_parser = values::fraction, allow_negative_numbers = true)]
    area: Option<f64>,
    #[command(flatten)]
    material: MaterialOptions,
    #[command(flatten)]
    interface: InterfaceOptions,
    /// The stationary field in the frame of the profile, or time steps as in the thesis.
    #[arg(long, value_name = "ROUTE", value_enum, default_value_t = Route::Steady)]
    route: Route,
    /// Elements over the period, 8 to 65536 [default: 64 on the shortest wave, at least 128 and at
    /// most 4096; of the transient route a fourth of that].
    #[arg(long, value_name = "N", value_parser = values::count::<usize>, allow_negative_numbers = true)]
    columns: Option<usize>,
    /// Relative accuracy of friction (of an elastic block: of the contact area): the mesh is refined
    /// until it is reached; steady route only. Without it the error of the one mesh is estimated.
    #[arg(long, value_name = "RELATIVE", conflicts_with = "columns", value_parser = values::tolerance, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Law of the springs at finite strain [default: that of the section [finite_strain] of --rubber, neo-hookean
    /// without one].
    #[arg(long, value_name = "LAW", value_enum)]
    rheology: Option<Law>,
    /// Height of the block in periods.
    #[arg(long, value_name = "PERIODS", default_value_t = 0.75, value_parser = values::positive, allow_negative_numbers = true)]
    height: f64,
    /// Periods of the drag, the last third of which is averaged; transient route only [default: 12].
    #[arg(long, value_name = "N", value_parser = values::count::<usize>, allow_negative_numbers = true)]
    drag_periods: Option<usize>,
    /// Time integration of the branches; transient route only [default: trapezoidal].
    #[arg(long, value_name = "RULE", value_enum)]
    flow_rule: Option<Rule>,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
    /// Also write position, height (about the mean line), normal pressure and separation at the
    /// contact nodes to this CSV file: x_mm, height_mm, pressure_mpa, separation_mm. Steady
    /// route only.
    #[arg(long, value_name = "FILE")]
    fields: Option<PathBuf>,
    /// Write the time steps of the transient route to this CSV file: time_s, pressure_mpa,
    /// displacement_mm, friction_coefficient, contact_area_fraction, mean_separation_mm.
    #[arg(long, value_name = "FILE")]
    series: Option<PathBuf>,
    /// Overwrite files that are there already.
    #[arg(long)]
    force: bool,
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
        threads::start(None)?;
        let material = self.material.material_at_finite_deformation()?;
        let rubber = material.rubber().maxwell().map_err(CliError::input)?;
        let shape = self.shape.build()?;
        if let Some(warning) = &shape.warning {
            note(quiet, format_args!("warning: {warning}"));
        }
        for warning in material.warnings(shape.excited_wavelengths(), self.speed.mm_to_m()) {
            note(quiet, format_args!("warning: {warning}"));
        }
        let profile = rigid_profile(&shape);
        let options = self.block(&profile)?;
        for warning in resolution::check(&profile, options.columns)? {
            note(quiet, format_args!("warning: {warning}"));
        }
        let summary = match self.route {
            Route::Steady => self.steady(rubber, profile, options, quiet)?,
            Route::Transient => self.transient(rubber, profile, &shape, options, quiet)?,
        };
        print(&if self.json { json(&summary)? } else { summary.table() })
    }

    /// The law of the option or of the rubber.
    fn rheology(&self, rubber: &Rubber) -> Rheology {
        self.rheology.map_or(rubber.finite_strain, Rheology::from)
    }

    /// Refuses options that contradict each other.
    fn check(&self) -> Result<(), CliError> {
        let transient = self.route == Route::Transient;
        if self.shape.points.is_some() && self.shape.profile.is_none() {
            return Err(CliError::input(
                "--points is the grid of solve bem: give --columns; sines need no grid here",
            ));
        }
        if transient && self.area.is_some() {
            return Err(CliError::input(
                "--area is found by the steady route only: give --pressure",
            ));
        }
        if transient && self.tolerance.is_some() {
            return Err(CliError::input(
                "--tolerance is met by the steady route only: give --columns",
            ));
        }
        if transient && self.fields.is_some() {
            return Err(CliError::input(
                "--fields are those of the steady route: leave it out, or give --series",
            ));
        }
        if transient && let Some(option) = self.interface.given() {
            return Err(CliError::input(format!(
                "{option} is for the steady route only, whose contact slides everywhere in one direction"
            )));
        }
        for (option, given) in [
            ("--series", self.series.is_some()),
            ("--drag-periods", self.drag_periods.is_some()),
            ("--flow-rule", self.flow_rule.is_some()),
        ] {
            if given && !transient {
                return Err(CliError::input(format!(
                    "{option} needs --route transient: the steady route has no time steps"
                )));
            }
        }
        if self.drag_periods == Some(0) {
            return Err(CliError::input(format!(
                "--drag-periods is 0: give at least 1, the default is {DEFAULT_DRAG_PERIODS}"
            )));
        }
        let inputs = [self.shape.profile.as_deref(), self.material.file()];
        refuse_to_overwrite(self.fields.as_deref(), "--fields", &inputs)?;
        refuse_to_overwrite(self.series.as_deref(), "--series", &inputs)?;
        refuse_existing(self.fields.as_deref(), self.force)?;
        refuse_existing(self.series.as_deref(), self.force)
    }

    /// The block of the options, with the default number of columns if none is given.
    fn block(&self, profile: &RigidProfile) -> Result<BlockOptions, CliError> {
        let columns = match (self.columns, self.route) {
            (Some(columns), _) => columns,
            (None, Route::Steady) => resolution::usual_columns(profile)?,
            (None, Route::Transient) => resolution::usual_columns(profile)? / 4,
        };
        let options = BlockOptions::of_profile(columns, profile);
        let options = BlockOptions { height_ratio: self.height, ..options };
        options.check(profile.period())?;
        Ok(options)
    }

    fn steady(
        &self,
        rubber: &Rubber,
        profile: RigidProfile,
        options: BlockOptions,
        quiet: bool,
    ) -> Result<Summary, CliError> {
        let start = Instant::now();
        let waves = profile.steep_waves();
        let least = (resolution::LEAST_COLUMNS_PER_WAVE * waves).ceil() as usize;
        let solve = |columns: usize| {
            let spinner = Spinner::new(quiet, &format!("solving on {columns} columns"));
            let mesh = BlockOptions::of_profile(columns, &profile);
            let mesh = BlockOptions { height_ratio: options.height_ratio, ..mesh };
            let solution = self.steady_on(rubber, &profile, mesh);
            spinner.finish();
            solution
        };
        let refined = match self.tolerance {
            None => {
                let no_solution = |error: &CliError| matches!(error, CliError::Failure(_));
                on_grid(options.columns, least, FINITE_ELEMENTS, solve, no_solution, view)?
            }
            Some(tolerance) => {
                let watched = match rubber.branches.is_empty() {
                    true => Watched::ContactArea,
                    false => Watched::Friction,
                };
                let (first, most) = (least.next_power_of_two(), resolution::MOST_DEFAULT_COLUMNS);
                let optional = |columns: usize| match solve(columns) {
                    Err(CliError::Failure(_)) if 2 * columns <= most => Ok(None),
                    solved => solved.map(Some),
                };
                let orders = FINITE_ELEMENTS;
                let refinement = Refinement { tolerance, watched, orders, first, most };
                refinement.run(optional, view).map_err(|error| match error {
                    RefineError::Solve(error) => error,
                    unreached @ RefineError::NotReached { .. } => {
                        CliError::failure(format!("--tolerance: {unreached}"))
                    }
                })?
            }
        };
        let solution = &refined.solution;
        let heat = solution.hysteretic_friction + solution.interface_friction;
        let friction = solution.friction_coefficient;
        if let Some(warning) = resolution::coarse(friction, heat, solution.mean_separation) {
            note(quiet, format_args!("warning: {warning}; give more --columns"));
        }
        if let Some(path) = &self.fields {
            write_file(path, self.force, |out| write_fields(out, solution))?;
        }
        let sheared = self.interface.given().is_some();
        Ok(Summary::steady(&refined, sheared, start.elapsed().as_secs_f64()))
    }

    fn steady_on(
        &self,
        rubber: &Rubber,
        profile: &RigidProfile,
        options: BlockOptions,
    ) -> Result<SteadySolution, CliError> {
        let (rheology, speed) = (self.rheology(rubber), self.speed.mm_to_m());
        let contact = SteadyContact::new(rubber, rheology, speed, profile.clone(), options)?;
        let law = self.interface.law();
        let mut contact = contact.with_interface(law).map_err(CliError::input)?;
        match (self.pressure, self.area) {
            (Some(pressure_mpa), _) => {
                contact.solve(pressure_mpa.mpa_to_pa()).map_err(|error| with_advice("", error))
            }
            (None, Some(fraction)) => contact
                .solve_for_area(fraction, AREA_TOLERANCE)
                .map_err(|error| with_advice(&format!("--area {fraction}: "), error)),
            (None, None) => Err(CliError::input("give --pressure or --area")),
        }
    }

    fn transient(
        &self,
        rubber: &Rubber,
        profile: RigidProfile,
        shape: &Shape,
        options: BlockOptions,
        quiet: bool,
    ) -> Result<Summary, CliError> {
        let Some(pressure_mpa) = self.pressure else {
            return Err(CliError::input("give --pressure"));
        };
        let (pressure, speed) = (pressure_mpa.mpa_to_pa(), self.speed.mm_to_m());
        let start = Instant::now();
        let mut mesh = options.mesh(profile.period());
        // The shear that the half-space's friction would give; half of it keeps elements usable
        // from the first touch to the full drag.
        let friction = SlidingContact::new(rubber, speed, shape.period, &shape.heights)?
            .solve(pressure)?
            .friction_coefficient;
        let shear_modulus = rubber.equilibrium_modulus / (2.0 * (1.0 + rubber.poisson_ratio));
        mesh.skew = -0.5 * friction * pressure / shear_modulus;
        let elements = [mesh.columns, mesh.rows()];
        let drag_periods = self.drag_periods.unwrap_or(DEFAULT_DRAG_PERIODS);
        let drag = TransientOptions {
            flow: self.flow_rule.unwrap_or(Rule::Trapezoidal).into(),
            drag_periods,
            averaged_periods: (drag_periods / 3).max(1),
            ..TransientOptions::default()
        };
        let contact =
            TransientContact::new(rubber, self.rheology(rubber), speed, profile, mesh, drag)?;
        let spinner = Spinner::new(quiet, "pressing in");
        let solution = contact.run(pressure, |sample| {
            if sample.displacement > 0.0 {
                let periods = sample.displacement / shape.period;
                spinner.say(&format!("dragged {periods:.2} of {drag_periods} periods"));
            }
        })?;
        spinner.finish();
        if let Some(path) = &self.series {
            write_file(path, self.force, |out| write_series(out, &solution.samples))?;
        }
        let seconds = start.elapsed().as_secs_f64();
        let summary = Summary::transient(&solution, pressure, elements, seconds);
        let separation = solution.mean_separation.mean;
        let (friction, heat) = summary.friction_and_heat();
        if let Some(warning) = resolution::coarse(friction, heat, separation) {
            let advice = "give more --columns, or more --drag-periods if it was not steady yet";
            note(quiet, format_args!("warning: {warning}; {advice}"));
        }
        Ok(summary)
    }
}

/// The error with a hint at options that may help.
fn with_advice(of: &str, error: FemError) -> CliError {
    let advice = match &error {
        FemError::Rubber(_) | FemError::OutOfRange { .. } | FemError::Interrupted => "",
        FemError::PathEnded { beyond: Some(_), .. } => "",
        FemError::PathEnded { reached: PathEnd::NotStarted | PathEnd::NotGrown, .. } => {
            "; try other --columns"
        }
        FemError::PathEnded { reached: PathEnd::At { .. }, .. } => {
            "; try other --columns, or a pressure below that"
        }
        FemError::AreaNotReached { .. } => "; give more --columns for a smaller area",
    };
    CliError::of(error.kind(), format!("{of}{error}{advice}"))
}

fn view(solution: &SteadySolution) -> OnGrid {
    OnGrid {
        points: solution.elements[0],
        friction_coefficient: solution.friction_coefficient,
        contact_area_fraction: solution.contact_area_fraction,
    }
}

fn rigid_profile(shape: &Shape) -> RigidProfile {
    if shape.waves.is_empty() {
        RigidProfile::from_heights(&shape.heights, shape.period)
    } else {
        RigidProfile::from_waves(&shape.waves, shape.period)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_that_never_began_has_no_pressure_below() {
        let ended = |reached| {
            with_advice(
                "",
                FemError::PathEnded { wanted: 24e6, columns: 48, reached, beyond: None },
            )
            .to_string()
        };
        let never = ended(PathEnd::NotStarted);
        assert!(
            never.ends_with("before the first contact was found; try other --columns"),
            "{never}"
        );
        let (pressure, friction_coefficient, contact_area_fraction) = (2e6, 0.3, 0.2);
        let at = ended(PathEnd::At { pressure, friction_coefficient, contact_area_fraction });
        assert!(at.contains("at 2.0000 MPa") && at.ends_with("or a pressure below that"), "{at}");
    }
}
