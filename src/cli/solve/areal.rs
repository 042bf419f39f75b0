//! `asperity solve areal`: the steady sliding contact of an areal surface on the linear viscoelastic half-space.

use asperity::units::Units;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{ArgGroup, Args};
use serde::Serialize;

use super::areal_shape::{ArealShape, ArealShapeOptions};
use super::error_estimate::{ErrorEstimate, printed, require_finite};
use super::material::MaterialOptions;
use super::refuse_to_overwrite;
use crate::cli::output::{aligned, json, note, print, refuse_existing, significant, write_file};
use crate::cli::{CliError, values};
use asperity::contact::areal::{
    ArealContact, ArealSetup, ArealSolution, ArealSurface, Sliding, memory_bytes,
};
use asperity::contact::refine::{AREAL, OnGrid, Refined, on_grid};
use asperity::rubber::RubberModel;

/// Relative tolerance of the contact area of --area; where a grid has no such area, the nearest one within two points.
const AREA_TOLERANCE: f64 = 1e-6;
/// Fewest points along a direction of the coarser grids that tell the error.
const LEAST_POINTS: usize = 16;
const BYTES_PER_GB: f64 = 1e9;
/// Default of --memory-gb: 4096 by 4096 points.
const MEMORY_GB: f64 = 4.5;

const EXAMPLES: &str = "\
Examples:
  A sine with two periods along x and one along y, on 1 by 1 mm, the rubber of Table 2.1:
    asperity solve areal --size-mm 1 --mode 2,1:0.004 --speed 10 --pressure 0.5
  The pressure that brings 5 % of the area into contact, sliding at 30 degrees to x:
    asperity solve areal --size-mm 1 --mode 2,1:0.004 --mode 5,-3:0.002:1.2 --speed 10 --angle 30 --area 0.05
  A map of an instrument, mirrored so that it closes, as JSON:
    asperity solve areal --map road.x3p --mirror --speed 10 --pressure 0.2 --json
  Heights in micrometres, row by row, on rows of 12 mm, under a tread of 8 mm:
    asperity solve areal --map heights.txt --map-unit um --size-mm 12 --speed 10 --pressure 0.2 --thickness-mm 8

Exit codes: 0 solved, 1 not converged or not written, 2 bad input.";

/// Solve the steady sliding contact of a rubber half-space, or layer, with a surface that is periodic in both directions.
///
/// The surface is a sum of sines (--mode) or a map (--map). The rubber slides over it at --speed along --angle under the
/// mean --pressure, or under the pressure that gives the contact area --area.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
#[command(group(ArgGroup::new("load").required(true).args(["pressure", "area"])))]
pub(in crate::cli) struct Areal {
    #[command(flatten)]
    shape: ArealShapeOptions,
    /// Sliding speed in mm/s.
    #[arg(long, value_name = "MM_S", value_parser = speed, allow_negative_numbers = true)]
    speed: f64,
    /// Direction in which the rubber slides, in degrees from x towards y.
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = values::finite, allow_negative_numbers = true)]
    angle: f64,
    /// Mean pressure in MPa.
    #[arg(long, value_name = "MPA", value_parser = values::positive, allow_negative_numbers = true)]
    pressure: Option<f64>,
    /// Contact area as a fraction of the nominal area, between 0 and 1, instead of --pressure. Areas of lossy rubbers jump by
    /// about a grid point; the nearest one is taken.
    #[arg(long, value_name = "FRACTION", value_parser = values::fraction, allow_negative_numbers = true)]
    area: Option<f64>,
    /// Thickness in mm of a rubber layer that is bonded to a rigid base [default: a half-space].
    #[arg(long, value_name = "MM", value_parser = thickness, allow_negative_numbers = true)]
    thickness_mm: Option<f64>,
    #[command(flatten)]
    material: MaterialOptions,
    /// Most memory in GB; a surface that needs more is refused before it is solved.
    #[arg(long, value_name = "GB", default_value_t = MEMORY_GB, value_parser = values::positive, allow_negative_numbers = true)]
    memory_gb: f64,
    /// Print JSON with full precision instead of a table.
    #[arg(long)]
    json: bool,
    /// Also write position, height (about the mean plane), pressure and separation at the grid points to this CSV file:
    /// x_mm, y_mm, height_mm, pressure_mpa, separation_mm.
    #[arg(long, value_name = "FILE")]
    fields: Option<PathBuf>,
    /// Overwrite a file that is there already.
    #[arg(long)]
    force: bool,
}

/// A thickness in mm that is no mistake.
fn thickness(text: &str) -> Result<f64, String> {
    match values::positive(text)? {
        mm if (1e-6..=1e6).contains(&mm) => Ok(mm),
        _ => Err(format!("{} is not from 1e-6 to 1e6", text.trim())),
    }
}

/// A speed in mm/s as recipes allow it.
fn speed(text: &str) -> Result<f64, String> {
    match values::positive(text)? {
        speed if (1e-9..=1e9).contains(&speed) => Ok(speed),
        _ => Err(format!("{} is not from 1e-9 to 1e9", text.trim())),
    }
}

/// What is printed; the names are the keys of the JSON object.
#[derive(Debug, Serialize)]
struct Summary {
    friction_coefficient: f64,
    lateral_coefficient: f64,
    contact_area_fraction: f64,
    mean_separation_mm: f64,
    pressure_mpa: f64,
    residual: f64,
    iterations: usize,
    grid_points: usize,
    points_x: usize,
    points_y: usize,
    operator_applications: f64,
    seconds: f64,
    error_estimate: Option<ErrorEstimate>,
}

impl Areal {
    pub(super) fn run(&self, quiet: bool) -> Result<(), CliError> {
        let material = self.material.material()?;
        let shape = self.shape.build(|points| self.require_memory(points))?;
        if let Some(warning) = &shape.warning {
            note(quiet, format_args!("warning: {warning}"));
        }
        let excited = shape.excited_wavelengths(self.angle.to_radians());
        for warning in material.warnings(excited, self.speed.mm_to_m()) {
            note(quiet, format_args!("warning: {warning}"));
        }
        refuse_to_overwrite(self.fields.as_deref(), "--fields", &self.inputs())?;
        refuse_existing(self.fields.as_deref(), self.force)?;
        let start = Instant::now();
        let refined = self.solve(material.rubber(), &shape)?;
        let summary = Summary::new(&refined, shape.points(), start.elapsed().as_secs_f64());
        summary.check()?;
        for warning in unresolved(&refined.solution, shape.points()) {
            note(quiet, format_args!("warning: {warning}"));
        }
        if refined.error.is_none() {
            note(
                quiet,
                format_args!(
                    "warning: the error of this grid is not known: of grids with half and a quarter of the points too few \
                     resolve the contact, or the points along a direction are no multiple of four"
                ),
            );
        }
        if let Some(path) = &self.fields {
            write_file(path, self.force, |out| write_fields(out, &shape, &refined.solution))?;
        }
        print(&if self.json { json(&summary)? } else { summary.table() })
    }

    /// Refuses what does not fit into the memory that may be taken.
    fn require_memory(&self, [nx, ny]: [usize; 2]) -> Result<(), CliError> {
        let needed = memory_bytes(nx, ny) as f64 / BYTES_PER_GB;
        if needed <= self.memory_gb {
            return Ok(());
        }
        Err(CliError::input(format!(
            "{nx} by {ny} points need about {needed:.1} GB of memory, --memory-gb allows {}: take fewer points, a part of the \
             map, or allow more",
            self.memory_gb
        )))
    }

    /// The contact on the grid of the shape, with its error by the grids of half, a quarter and an eighth of the points.
    fn solve(
        &self,
        rubber: &RubberModel,
        shape: &ArealShape,
    ) -> Result<Refined<ArealSolution>, CliError> {
        let [nx, ny] = shape.points();
        let solve = |points: usize| self.solve_on(rubber, shape, (nx / points).ilog2());
        let no_solution = |error: &CliError| matches!(error, CliError::Failure(_));
        // Coarser grids are every second point, so both numbers must be even that often.
        let least = (nx >> shape.halvings()).max(LEAST_POINTS * nx.div_ceil(ny.min(nx)));
        on_grid(nx, least, AREAL, solve, no_solution, view)
    }

    fn solve_on(
        &self,
        rubber: &RubberModel,
        shape: &ArealShape,
        halvings: u32,
    ) -> Result<ArealSolution, CliError> {
        let heights = shape.heights(halvings);
        let mut contact = ArealContact::new(&ArealSetup {
            rubber,
            sliding: Sliding { speed: self.speed.mm_to_m(), angle: self.angle.to_radians() },
            surface: ArealSurface {
                heights: &heights,
                points: shape.points().map(|n| n >> halvings),
                periods: shape.periods(),
            },
            thickness: self.thickness_mm.map(Units::mm_to_m),
            memory_limit: None,
        })?;
        match (self.pressure, self.area) {
            (Some(pressure_mpa), _) => Ok(contact.solve(pressure_mpa.mpa_to_pa())?),
            (None, Some(fraction)) => {
                if contact.smallest_full_contact_pressure() == 0.0 {
                    return Err(CliError::input(
                        "the surface is flat and in full contact at any pressure: give --pressure",
                    ));
                }
                let nearest = contact.solve_near_area(fraction, AREA_TOLERANCE)?;
                let distance = (nearest.contact_area_fraction - fraction).abs();
                // Further off than two points of the grid is another contact.
                if distance > AREA_TOLERANCE * fraction && distance * heights.len() as f64 > 2.0 {
                    return Err(CliError::failure(format!(
                        "no pressure gives the contact area fraction {fraction} on {} points: the nearest found is {:.6} at \
                         {} MPa; ask for that, or take more points",
                        heights.len(),
                        nearest.contact_area_fraction,
                        significant(nearest.mean_pressure.pa_to_mpa())
                    )));
                }
                Ok(nearest)
            }
            (None, None) => Err(CliError::input("give --pressure or --area")),
        }
    }

    fn inputs(&self) -> [Option<&Path>; 2] {
        [self.shape.map.as_deref(), self.material.file()]
    }
}

impl Summary {
    fn new(refined: &Refined<ArealSolution>, points: [usize; 2], seconds: f64) -> Self {
        let solution = &refined.solution;
        Self {
            friction_coefficient: solution.friction_coefficient,
            lateral_coefficient: solution.lateral_coefficient,
            contact_area_fraction: solution.contact_area_fraction,
            mean_separation_mm: solution.mean_separation.m_to_mm(),
            pressure_mpa: solution.mean_pressure.pa_to_mpa(),
            residual: solution.residual,
            iterations: solution.iterations,
            grid_points: solution.pressure.len(),
            points_x: points[0],
            points_y: points[1],
            operator_applications: solution.operator_applications,
            seconds,
            error_estimate: refined.error.map(ErrorEstimate::of_grid),
        }
    }

    /// Refuses a result that is not finite: lengths or moduli far from those of any road overflow.
    fn check(&self) -> Result<(), CliError> {
        require_finite(&[
            self.friction_coefficient,
            self.lateral_coefficient,
            self.contact_area_fraction,
            self.mean_separation_mm,
            self.residual,
        ])?;
        if self.contact_area_fraction > 0.0 {
            return Ok(());
        }
        Err(CliError::failure(
            "the contact is smaller than this grid shows: give more points or more pressure",
        ))
    }

    fn table(&self) -> String {
        let error = |value: fn(&ErrorEstimate) -> f64| printed(self.error_estimate.as_ref(), value);
        aligned(&[
            ("friction coefficient", significant(self.friction_coefficient)),
            ("estimated error", error(|estimate| estimate.total)),
            ("lateral coefficient", significant(self.lateral_coefficient)),
            ("contact area fraction", significant(self.contact_area_fraction)),
            ("its estimated error", error(|estimate| estimate.contact_area_fraction)),
            ("mean separation", significant(self.mean_separation_mm) + " mm"),
            ("mean pressure", significant(self.pressure_mpa) + " MPa"),
            ("residual", significant(self.residual)),
            ("iterations", self.iterations.to_string()),
            ("grid points", format!("{} by {}", self.points_x, self.points_y)),
            ("time", significant(self.seconds) + " s"),
        ])
    }
}

/// Fewest points across a contact spot for reliable area and friction.
const RESOLVED_SPOT: f64 = 4.0;
/// Largest difference of the friction by work and by dissipation, relative, on a grid that resolves the contact; and the
/// dissipation of a rubber that is as good as elastic.
const RESOLVED_WORK: f64 = 0.1;
const LEAST_FRICTION: f64 = 1e-5;

/// Warnings where the grid is too coarse for the contact.
fn unresolved(solution: &ArealSolution, [nx, ny]: [usize; 2]) -> Vec<String> {
    let touches = |j: usize, i: usize| solution.pressure[(j % ny) * nx + i % nx] > 0.0;
    let places = || (0..ny).flat_map(|j| (0..nx).map(move |i| (j, i)));
    let touching = places().filter(|(j, i)| touches(*j, *i)).count() as f64;
    let ends = |down: usize, right: usize| {
        places().filter(|(j, i)| touches(*j, *i) && !touches(j + down, i + right)).count() as f64
    };
    let spot = touching / ends(0, 1).max(ends(1, 0));
    let mut warnings = Vec::new();
    if spot < RESOLVED_SPOT {
        warnings.push(format!(
            "a contact spot is {} grid points across on average, too few for reliable numbers: give more points or more \
             pressure",
            significant(spot)
        ));
    }
    let (work, power) = (solution.friction_coefficient, solution.hysteretic_friction);
    let apart = (work - power).abs() > RESOLVED_WORK * power.abs();
    if apart && power.abs() > LEAST_FRICTION {
        warnings.push(format!(
            "the friction by the work on the slopes, {}, differs from that by the dissipation of the rubber, {}: the grid does \
             not resolve the contact; give more points",
            significant(work),
            significant(power)
        ));
    }
    warnings
}

fn view(solution: &ArealSolution) -> OnGrid {
    OnGrid {
        points: solution.pressure.len(),
        friction_coefficient: solution.friction_coefficient,
        contact_area_fraction: solution.contact_area_fraction,
    }
}

fn write_fields(
    out: &mut dyn Write,
    shape: &ArealShape,
    solution: &ArealSolution,
) -> std::io::Result<()> {
    let [nx, ny] = shape.points();
    let [period_x, period_y] = shape.periods();
    let heights = shape.heights(0);
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    writeln!(out, "x_mm,y_mm,height_mm,pressure_mpa,separation_mm")?;
    for (k, height) in heights.iter().enumerate() {
        let x_mm = (k % nx) as f64 * (period_x / nx as f64).m_to_mm();
        let y_mm = (k / nx) as f64 * (period_y / ny as f64).m_to_mm();
        let height_mm = (height - mean).m_to_mm();
        let pressure_mpa = solution.pressure[k].pa_to_mpa();
        let separation_mm = solution.separation[k].m_to_mm();
        writeln!(out, "{x_mm},{y_mm},{height_mm:e},{pressure_mpa:e},{separation_mm:e}")?;
    }
    Ok(())
}
