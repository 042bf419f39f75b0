//! `asperity solve bem`: the steady sliding contact on the linear viscoelastic half-space.

use asperity::units::Units;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{ArgGroup, Args};
use serde::Serialize;

use super::error_estimate::{ErrorEstimate, printed, require_finite};
use super::material::MaterialOptions;
use super::refuse_to_overwrite;
use super::shape::{Shape, ShapeOptions};
use crate::cli::output::{aligned, json, note, print, refuse_existing, significant, write_file};
use crate::cli::{CliError, values};
use asperity::contact::refine::{
    HALF_SPACE, OnGrid, RefineError, Refined, Refinement, Watched, on_grid,
};
use asperity::contact::sliding::POINTS_RANGE;
use asperity::contact::{ContactError, ContactSolution, SlidingContact};
use asperity::rubber::RubberModel;

/// Relative tolerance of the contact area of --area: far below what any grid resolves, at the cost of a solve
/// or two.
const AREA_TOLERANCE: f64 = 1e-6;

/// Fewest points on a contact spot for reliable area and friction: with fewer, those of one sine are off by a
/// fifth and more.
const RESOLVED_SPOT: f64 = 4.0;

/// Default of --tolerance.
const DEFAULT_TOLERANCE: f64 = 1e-3;
/// Points of the coarsest grid; an estimate takes three grids.
const FIRST_POINTS_PER_WAVE: usize = 8;
/// Seconds for a contact.
const MOST_POINTS: usize = 1 << 22;

const EXAMPLES: &str = "\
Examples:
  One sine of wavelength 0.0625 mm and amplitude 0.01867 mm, the rubber of Table 2.1:
    asperity solve bem --wave 0.0625:0.01867 --speed 10 --pressure 3.3
  Two sines, the second with a phase of 1.57 rad, as JSON:
    asperity solve bem --wave 0.0625:0.01867 --wave 0.125:0.02648:1.57 --speed 10 --pressure 3.3 --json
  Friction to a relative accuracy of 1e-5:
    asperity solve bem --wave 0.0625:0.01867 --speed 10 --pressure 3.3 --tolerance 1e-5
  The pressure that brings 5 % of the area into contact:
    asperity solve bem --wave 0.0625:0.01867 --speed 10 --area 0.05
  The same rubber at another temperature than that of its moduli:
    asperity solve bem --wave 0.0625:0.01867 --speed 10 --pressure 3.3 --rubber tread.toml --temperature-c 40
  A measured profile with x and z in micrometres on an elastic half-space:
    asperity solve bem --profile road.txt --profile-unit um --modulus 4.17 --poisson 0.49 --speed 10 --pressure 0.2

Exit codes: 0 solved, 1 not converged or not written, 2 bad input.";

/// Solve the steady sliding contact of a rubber half-space with a periodic profile.
///
/// The profile is a sum of sines (--wave) or a file (--profile). The rubber slides over it at
/// --speed under the mean --pressure, or under the pressure that gives the contact area --area.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
#[command(group(ArgGroup::new("load").required(true).args(["pressure", "area"])))]
pub(in crate::cli) struct Bem {
    #[command(flatten)]
    shape: ShapeOptions,
    /// Sliding speed in mm/s.
    #[arg(long, value_name = "MM_S", value_parser = values::positive, allow_negative_numbers = true)]
    speed: f64,
    /// Mean pressure in MPa.
    #[arg(long, value_name = "MPA", value_parser = values::positive, allow_negative_numbers = true)]
    pressure: Option<f64>,
    /// Contact area as a fraction of the nominal area, between 0 and 1, instead of --pressure. If the grid has
    /// no such area, the nearest one is taken if it is within its own estimated error.
    #[arg(long, value_name = "FRACTION", value_parser = values::fraction, allow_negative_numbers = true)]
    area: Option<f64>,
    #[command(flatten)]
    material: MaterialOptions,
    /// Relative accuracy of friction (of an elastic half-space: of the contact area): the grid is
    /// refined until it is reached [default: 0.001, on 64 points of the shortest wave or more; with
    /// --points or --profile the error of that grid is estimated and reported].
    #[arg(long, value_name = "RELATIVE", conflicts_with_all = ["points", "profile"], value_parser = values::tolerance, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
    /// Also write x, height (about the mean line), pressure and separation at the grid points to
    /// this CSV file: x_mm, height_mm, pressure_mpa, separation_mm.
    #[arg(long, value_name = "FILE")]
    fields: Option<PathBuf>,
    /// Overwrite a file that is there already.
    #[arg(long)]
    force: bool,
}

/// What is printed; the names are the keys of the JSON object.
#[derive(Debug, Serialize)]
struct Summary {
    friction_coefficient: f64,
    contact_area_fraction: f64,
    mean_separation_mm: f64,
    pressure_mpa: f64,
    residual: f64,
    iterations: usize,
    grid_points: usize,
    seconds: f64,
    error_estimate: Option<ErrorEstimate>,
}

impl Bem {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let material = self.material.material()?;
        let rubber = material.rubber();
        let shape = self.shape.build()?;
        if let Some(warning) = &shape.warning {
            note(quiet, format_args!("warning: {warning}"));
        }
        for warning in material.warnings(shape.excited_wavelengths(), self.speed.mm_to_m()) {
            note(quiet, format_args!("warning: {warning}"));
        }
        refuse_to_overwrite(self.fields.as_deref(), "--fields", &self.inputs())?;
        refuse_existing(self.fields.as_deref(), self.force)?;
        let start = Instant::now();
        let refined = self.solve(rubber, &shape)?;
        let solution = &refined.solution;
        let summary = Summary::new(&refined, start.elapsed().as_secs_f64());
        summary.check()?;
        if let Some(warning) = self.distance_of_area(&refined)? {
            note(quiet, format_args!("warning: {warning}"));
        }
        let spot = points_per_spot(&solution.pressure);
        if spot < RESOLVED_SPOT {
            note(
                quiet,
                format_args!(
                    "warning: a contact spot is {} grid points wide on average, too few for reliable numbers: give \
                     more points or more pressure",
                    significant(spot)
                ),
            );
        }
        if refined.error.is_none() {
            note(
                quiet,
                format_args!(
                    "warning: the error of this grid is not known: of coarser grids too few resolve \
                     the contact; give more points"
                ),
            );
        }
        if let Some(path) = &self.fields {
            write_file(path, self.force, |out| write_fields(out, &shape, solution))?;
        }
        print(&if self.json { json(&summary)? } else { summary.table() })
    }

    /// The contact, on a sufficiently fine grid or on the given one.
    fn solve(
        &self,
        rubber: &RubberModel,
        shape: &Shape,
    ) -> Result<Refined<ContactSolution>, CliError> {
        let solve = |points: usize| self.solve_on(rubber, shape, points);
        let given =
            self.shape.points.or(self.shape.profile.is_some().then_some(shape.heights.len()));
        if let Some(points) = given {
            let no_solution = |error: &CliError| matches!(error, CliError::Failure(_));
            return on_grid(points, *POINTS_RANGE.start(), HALF_SPACE, solve, no_solution, view);
        }
        let watched = if rubber.is_elastic() { Watched::ContactArea } else { Watched::Friction };
        let waves = shape.shortest_waves().unwrap_or(1);
        let first = match self.tolerance {
            Some(_) => (FIRST_POINTS_PER_WAVE * waves).next_power_of_two(),
            // The third grid, the first with an estimate, is then the usual one.
            None => shape.heights.len() / 4,
        };
        let tolerance = self.tolerance.unwrap_or(DEFAULT_TOLERANCE);
        let refinement =
            Refinement { tolerance, watched, orders: HALF_SPACE, first, most: MOST_POINTS };
        let optional = |points: usize| match solve(points) {
            // A small contact needs a fine grid, and so may its area.
            Err(CliError::Failure(_)) if 2 * points <= MOST_POINTS => Ok(None),
            solved => solved.map(Some),
        };
        refinement.run(optional, view).map_err(|error| match error {
            RefineError::Solve(error) => error,
            unreached @ RefineError::NotReached { .. } => {
                CliError::failure(format!("--tolerance: {unreached}"))
            }
        })
    }

    fn solve_on(
        &self,
        rubber: &RubberModel,
        shape: &Shape,
        points: usize,
    ) -> Result<ContactSolution, CliError> {
        let heights = shape.heights_on(points);
        let mut contact =
            SlidingContact::new(rubber, self.speed.mm_to_m(), shape.period, &heights)?;
        if self.area.is_some() && contact.height_range() == 0.0 {
            return Err(CliError::input(
                "the profile is flat and in full contact at any pressure: give --pressure",
            ));
        }
        match (self.pressure, self.area) {
            (Some(pressure_mpa), _) => Ok(contact.solve(pressure_mpa.mpa_to_pa())?),
            (None, Some(fraction)) => {
                let nearest = contact.solve_near_area(fraction, AREA_TOLERANCE)?;
                let distance = (nearest.contact_area_fraction - fraction).abs();
                // Further off than a point of the grid is another contact.
                if distance * points as f64 > 1.0 {
                    return Err(not_reached(fraction, &nearest));
                }
                Ok(nearest)
            }
            (None, None) => Err(CliError::input("give --pressure or --area")),
        }
    }

    /// Warns if the nearest contact area of the grid differs from the one asked for by more than its estimated error.
    fn distance_of_area(
        &self,
        refined: &Refined<ContactSolution>,
    ) -> Result<Option<String>, CliError> {
        let Some(fraction) = self.area else { return Ok(None) };
        let solution = &refined.solution;
        let found = solution.contact_area_fraction;
        let distance = (found - fraction).abs();
        if distance <= AREA_TOLERANCE * fraction {
            return Ok(None);
        }
        match refined.error.map(|error| error.contact_area_fraction) {
            Some(error) if distance <= error => Ok(Some(format!(
                "the nearest contact area fraction on {} points is {found:.7}, {distance:.1e} from the {fraction} asked \
                 for, which is within its estimated error of {error:.1e}",
                solution.pressure.len()
            ))),
            _ => Err(not_reached(fraction, solution)),
        }
    }

    fn inputs(&self) -> [Option<&Path>; 2] {
        [self.shape.profile.as_deref(), self.material.file()]
    }
}

impl Summary {
    fn new(refined: &Refined<ContactSolution>, seconds: f64) -> Self {
        let solution = &refined.solution;
        Self {
            error_estimate: refined.error.map(ErrorEstimate::of_grid),
            friction_coefficient: solution.friction_coefficient,
            contact_area_fraction: solution.contact_area_fraction,
            mean_separation_mm: solution.mean_separation.m_to_mm(),
            pressure_mpa: solution.mean_pressure.pa_to_mpa(),
            residual: solution.residual,
            iterations: solution.iterations,
            grid_points: solution.pressure.len(),
            seconds,
        }
    }

    /// Refuses a result that is not finite: lengths or moduli far from those of any road overflow.
    fn check(&self) -> Result<(), CliError> {
        require_finite(&[
            self.friction_coefficient,
            self.contact_area_fraction,
            self.mean_separation_mm,
            self.residual,
        ])
    }

    fn table(&self) -> String {
        let error = |value: fn(&ErrorEstimate) -> f64| printed(self.error_estimate.as_ref(), value);
        aligned(&[
            ("friction coefficient", significant(self.friction_coefficient)),
            ("estimated error", error(|estimate| estimate.total)),
            ("contact area fraction", significant(self.contact_area_fraction)),
            ("its estimated error", error(|estimate| estimate.contact_area_fraction)),
            ("mean separation", significant(self.mean_separation_mm) + " mm"),
            ("mean pressure", significant(self.pressure_mpa) + " MPa"),
            ("residual", significant(self.residual)),
            ("iterations", self.iterations.to_string()),
            ("grid points", self.grid_points.to_string()),
            ("time", significant(self.seconds) + " s"),
        ])
    }
}

/// The error for a contact area that the grid does not have.
fn not_reached(wanted: f64, nearest: &ContactSolution) -> CliError {
    CliError::from(ContactError::AreaNotReached {
        wanted,
        found: nearest.contact_area_fraction,
        pressure: nearest.mean_pressure,
        points: nearest.pressure.len(),
    })
}

/// Mean number of neighbouring grid points in contact; infinite in full contact.
fn points_per_spot(pressure: &[f64]) -> f64 {
    let touches = |index: usize| pressure[index % pressure.len()] > 0.0;
    let touching = (0..pressure.len()).filter(|index| touches(*index)).count();
    let ends = (0..pressure.len()).filter(|index| touches(*index) && !touches(index + 1)).count();
    touching as f64 / ends as f64
}

fn view(solution: &ContactSolution) -> OnGrid {
    OnGrid {
        points: solution.pressure.len(),
        friction_coefficient: solution.friction_coefficient,
        contact_area_fraction: solution.contact_area_fraction,
    }
}

fn write_fields(
    out: &mut dyn Write,
    shape: &Shape,
    solution: &ContactSolution,
) -> std::io::Result<()> {
    let points = solution.pressure.len();
    let heights = shape.heights_on(points);
    let mean = heights.iter().sum::<f64>() / points as f64;
    let spacing_mm = shape.period.m_to_mm() / points as f64;
    writeln!(out, "x_mm,height_mm,pressure_mpa,separation_mm")?;
    for (i, height) in heights.iter().enumerate() {
        let x_mm = i as f64 * spacing_mm;
        let height_mm = (height - mean).m_to_mm();
        let pressure_mpa = solution.pressure[i].pa_to_mpa();
        let separation_mm = solution.separation[i].m_to_mm();
        writeln!(out, "{x_mm},{height_mm:e},{pressure_mpa:e},{separation_mm:e}")?;
    }
    Ok(())
}
