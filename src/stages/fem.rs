//! fem: friction over contact area with all waves at finite deformation, for surfaces that are
//! small enough; what the other models are measured by.

use super::bem::Bem;
use super::micro::{columns, is_of};
use super::realise::{Surface, read_surfaces};
use super::{Context, SolveError, StageError, schema_of};
use crate::artifact::{Digest, Metadata, Row, RunView, SchemaVersion, SolveStore};
use crate::fem::error::FemError;
use crate::fem::profile::RigidProfile;
use crate::fem::steady::{BlockOptions, COLUMNS_RANGE, SteadyContact};
use crate::multiscale::sampling::interpolation_errors;
use crate::numerics::interpolation::CubicHermite;
use crate::recipe::{Violation, demand};
use crate::rubber::{Rheology, Rubber};
use crate::stages::bem::CURVES_FILE as BEM_CURVES;
use crate::stages::bem::CurveRow;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 4;
/// Revision of the solver: part of the key of every stored solve.
const SOLVER_REVISION: u32 = 3;

/// Section `[fem]` of a recipe.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Fem {
    /// Elements on the shortest wave.
    pub columns_per_shortest_wavelength: u32,
    /// Ratio of neighbouring pressures that are solved; friction is interpolated between them.
    pub pressure_ratio: f64,
    /// Whether the curves are solved on half the columns too, for the error by the mesh: two fifths more
    /// work. Set by the key `tolerance` of the recipe.
    pub estimate_mesh_error: bool,
}

impl Default for Fem {
    fn default() -> Self {
        Self {
            columns_per_shortest_wavelength: 96,
            pressure_ratio: 1.25,
            estimate_mesh_error: false,
        }
    }
}

impl Fem {
    pub(crate) fn check(&self) -> Result<(), Violation> {
        let columns = self.columns_per_shortest_wavelength;
        let key = "fem.columns_per_shortest_wavelength";
        demand((16..=1024).contains(&columns), key, columns, "16 to 1024")?;
        let ratio = self.pressure_ratio;
        demand((1.01..=2.0).contains(&ratio), "fem.pressure_ratio", ratio, "between 1.01 and 2")
    }
}

/// Friction at the wanted contact areas: `curves.arrow`.
pub const FEM_FILE: &str = "curves.arrow";
/// All solves: `solves.arrow`.
pub const FEM_SOLVES_FILE: &str = "solves.arrow";

/// Friction of one realisation at one wanted contact area, at finite deformation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FemCurveRow {
    /// Number of waves of the approximation.
    pub waves: u32,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean pressure, interpolated.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient, interpolated.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// Estimated error of the friction coefficient by interpolation, absolute.
    #[schemars(extend("unit" = "1"))]
    pub interpolation_error: f64,
    /// Estimated error of the friction coefficient by the mesh: its difference to that on half the
    /// columns, three times the error where friction converges with their square; absent where that is
    /// not solved.
    #[schemars(extend("unit" = "1"))]
    pub discretisation_error: Option<f64>,
}

impl Row for FemCurveRow {
    const SCHEMA: &'static str = "asperity.fem.curves";
    const VERSION: u32 = 2;
}

/// One solved contact at finite deformation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FemSolveRow {
    /// Number of waves of the approximation.
    pub waves: u32,
    /// Number of the realisation, from 1.
    pub realisation: u32,
    /// Sliding speed.
    #[schemars(extend("unit" = "mm/s"))]
    pub speed_mm_s: f64,
    /// Mean pressure.
    #[schemars(extend("unit" = "MPa"))]
    pub pressure_mpa: f64,
    /// Friction coefficient.
    #[schemars(extend("unit" = "1"))]
    pub friction_coefficient: f64,
    /// The same from the heat of the branches; the difference measures the mesh.
    #[schemars(extend("unit" = "1"))]
    pub friction_from_heat: f64,
    /// Contact area fraction.
    #[schemars(extend("unit" = "1"))]
    pub contact_area_fraction: f64,
    /// Mean separation.
    #[schemars(extend("unit" = "mm"))]
    pub mean_separation_mm: f64,
    /// Residual, relative.
    #[schemars(extend("unit" = "1"))]
    pub residual: f64,
    /// Newton steps since the solve before.
    pub newton_steps: u64,
    /// Columns of the mesh.
    pub columns: u64,
    /// Wall time of the solve.
    #[schemars(extend("unit" = "s", "volatile" = true))]
    pub seconds: f64,
}

impl Row for FemSolveRow {
    const SCHEMA: &'static str = "asperity.fem.solves";
    const VERSION: u32 = 1;
}

/// Schemas of the results.
pub fn schemas() -> Vec<SchemaVersion> {
    vec![schema_of::<FemCurveRow>(), schema_of::<FemSolveRow>()]
}

/// Solves the contacts that are not in the store and writes the results; returns warnings.
///
/// # Errors
/// [`StageError::FiniteDeformation`] for a curve that cannot be had; [`StageError::Interrupted`]. Solves that
/// are done are kept in the store.
pub fn run(
    parameters: &Fem,
    bem: &Bem,
    rubber: &Rubber,
    run: &RunView,
    store: &SolveStore,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let surfaces = read_surfaces(run)?;
    let (half_space, _) = run.read_table::<CurveRow>("bem", BEM_CURVES)?;
    let tasks: Vec<(&Surface, f64)> = surfaces
        .iter()
        .flat_map(|surface| bem.speeds_mm_s.iter().map(move |speed| (surface, *speed)))
        .filter(|(surface, speed)| half_space.iter().any(|row| is_of(row, surface, *speed)))
        .collect();
    let (done, total) = (AtomicU64::new(0), tasks.len() as u64);
    (context.progress)(0, total);
    let results: Vec<CurveResult> = tasks
        .par_iter()
        .map(|(surface, speed)| {
            context.check_interrupt()?;
            let guess = first_guess(&half_space, surface, *speed);
            let result = one_curve(parameters, bem, rubber, surface, *speed, guess, store, context);
            (context.progress)(1 + done.fetch_add(1, Ordering::Relaxed), total);
            result
        })
        .collect::<Result<_, StageError>>()?;
    let none = Metadata::new();
    let curves: Vec<_> = results.iter().flat_map(|result| result.rows.iter().cloned()).collect();
    context.pending.write_table(FEM_FILE, &curves, &none)?;
    let solves: Vec<_> = results.iter().flat_map(|result| result.solves.iter().cloned()).collect();
    context.pending.write_table(FEM_SOLVES_FILE, &solves, &none)?;
    Ok(results.into_iter().flat_map(|result| result.warnings).collect())
}

/// Pressure in Pa of the smallest wanted area on the half-space.
fn first_guess(half_space: &[CurveRow], surface: &Surface, speed_mm_s: f64) -> f64 {
    let first = half_space.iter().find(|row| is_of(row, surface, speed_mm_s));
    first.map_or(1e5, |row| row.pressure_mpa * 1e6)
}

#[allow(clippy::too_many_arguments)]
fn one_curve(
    parameters: &Fem,
    bem: &Bem,
    rubber: &Rubber,
    surface: &Surface,
    speed_mm_s: f64,
    guess: f64,
    store: &SolveStore,
    context: &Context,
) -> Result<CurveResult, StageError> {
    let (waves, realisation) = (surface.waves, surface.realisation);
    let failed = |source: SolveError| match context.check_interrupt() {
        Err(interrupt) => interrupt,
        Ok(()) => StageError::FiniteDeformation {
            waves,
            realisation,
            speed_mm_s,
            source: Box::new(source),
        },
    };
    let columns = columns_of(parameters, surface);
    let new =
        |columns| Solver::new(columns, parameters, rubber, surface, speed_mm_s, store, context);
    let mut solver = new(columns).map_err(failed)?;
    let ended = match solver.sweep(&bem.area_fractions, guess) {
        Err(SolveError::FiniteDeformation(error @ FemError::PathEnded { .. })) => Some(error),
        other => other.map_err(failed)?,
    };
    let mut rows = solver.values(&bem.area_fractions);
    if parameters.estimate_mesh_error {
        let mut coarser = new((columns / 2).max(*COLUMNS_RANGE.start())).map_err(failed)?;
        match coarser.sweep(&bem.area_fractions, guess) {
            Ok(_) | Err(SolveError::FiniteDeformation(FemError::PathEnded { .. })) => {}
            Err(error) => return Err(failed(error)),
        }
        add_mesh_errors(&mut rows, &coarser.values(&bem.area_fractions));
    }
    let missing = bem.area_fractions.len() - rows.len();
    let warning = (missing > 0).then(|| {
        let why = ended.map_or_else(
            || "its area does not get there".into(),
            |error| format!("{error}; try another fem.columns_per_shortest_wavelength"),
        );
        format!(
            "{waves} waves, realisation {realisation}, {speed_mm_s} mm/s: {missing} of the contact \
             areas are not reached: {why}"
        )
    });
    let coarse = solver.coarse_mesh();
    Ok(CurveResult {
        rows,
        solves: solver.solves,
        warnings: warning.into_iter().chain(coarse).collect(),
    })
}

/// Writes the differences to the values of a coarser mesh, where it has them.
fn add_mesh_errors(rows: &mut [FemCurveRow], coarser: &[FemCurveRow]) {
    for row in rows {
        let same =
            coarser.iter().find(|other| other.contact_area_fraction == row.contact_area_fraction);
        row.discretisation_error =
            same.map(|other| (row.friction_coefficient - other.friction_coefficient).abs());
    }
}

/// Columns of the mesh of a surface.
fn columns_of(parameters: &Fem, surface: &Surface) -> usize {
    let waves = &surface.profile;
    let period = waves.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
    let present = waves.iter().filter(|wave| wave.amplitude != 0.0);
    let shortest = present.map(|wave| wave.wavelength).fold(period, f64::min);
    columns(parameters.columns_per_shortest_wavelength, period, shortest)
}

/// The curve of one surface at one speed.
struct CurveResult {
    rows: Vec<FemCurveRow>,
    solves: Vec<FemSolveRow>,
    warnings: Vec<String>,
}

/// One surface at one speed.
struct Solver<'a> {
    surface: &'a Surface,
    speed_mm_s: f64,
    columns: usize,
    key: serde_json::Value,
    block: SteadyContact,
    ratio: f64,
    store: &'a SolveStore,
    context: &'a Context<'a>,
    /// Pressures in Pa that the store knew and the block did not pass. It passes them before it goes
    /// on, so that a run that was stopped gives the numbers of one that was not.
    skipped: Vec<f64>,
    /// Of ascending pressure.
    solves: Vec<FemSolveRow>,
}

/// Friction and heat may be this far apart, relative to a friction that is not next to nothing.
const MOST_APART: f64 = 0.05;
const LEAST_FRICTION: f64 = 0.05;
/// Solves beyond which a sweep is not led on.
const MOST_SOLVES: usize = 120;

impl<'a> Solver<'a> {
    fn new(
        columns: usize,
        parameters: &Fem,
        rubber: &Rubber,
        surface: &'a Surface,
        speed_mm_s: f64,
        store: &'a SolveStore,
        context: &'a Context<'a>,
    ) -> Result<Self, SolveError> {
        let waves = &surface.profile;
        let period = waves.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
        let profile = RigidProfile::from_waves(waves, period);
        let (rheology, options) = (Rheology::NeoHookean, BlockOptions::new(columns));
        let block = SteadyContact::new(rubber, rheology, speed_mm_s / 1e3, profile, options)?;
        let key = json!({
            "solver": ["fem", SOLVER_REVISION],
            "equilibrium_modulus": rubber.equilibrium_modulus,
            "branches": rubber.branches,
            "poisson_ratio": rubber.poisson_ratio,
            "profile": waves,
            "speed_mm_s": speed_mm_s,
            "columns": columns,
        });
        let (ratio, solves) = (parameters.pressure_ratio, Vec::new());
        let skipped = Vec::new();
        Ok(Self {
            surface,
            speed_mm_s,
            columns,
            key,
            block,
            ratio,
            store,
            context,
            skipped,
            solves,
        })
    }

    /// Solves pressures at the ratio of the recipe, from below the smallest to above the largest
    /// area; returns why the path ended before that, if it did.
    fn sweep(&mut self, areas: &[f64], guess: f64) -> Result<Option<FemError>, SolveError> {
        let (smallest, largest) = (areas[0], areas[areas.len() - 1]);
        let mut pressure = guess;
        let mut row = self.point(pressure)?;
        while row.contact_area_fraction > smallest && self.solves.len() < MOST_SOLVES {
            pressure /= self.ratio;
            row = self.point(pressure)?;
        }
        pressure = guess;
        let last = self.solves.iter().max_by(|a, b| a.pressure_mpa.total_cmp(&b.pressure_mpa));
        let mut area = last.map_or(0.0, |row| row.contact_area_fraction);
        let mut ended = None;
        while area < largest && self.solves.len() < MOST_SOLVES {
            pressure *= self.ratio;
            match self.point(pressure) {
                Ok(row) => area = row.contact_area_fraction,
                Err(SolveError::FiniteDeformation(error @ FemError::PathEnded { .. })) => {
                    ended = Some(error);
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        self.solves.sort_by(|a, b| a.pressure_mpa.total_cmp(&b.pressure_mpa));
        Ok(ended)
    }

    /// A warning where friction and heat are apart: the mesh is too coarse for these contacts.
    fn coarse_mesh(&self) -> Option<String> {
        let apart = |row: &FemSolveRow| {
            let difference = (row.friction_coefficient - row.friction_from_heat).abs();
            difference > MOST_APART * row.friction_coefficient.abs().max(LEAST_FRICTION)
        };
        let solves: Vec<&FemSolveRow> = self.solves.iter().filter(|row| apart(row)).collect();
        let largest = solves.iter().map(|row| row.contact_area_fraction).fold(0.0, f64::max);
        let Surface { waves, realisation, .. } = self.surface;
        (!solves.is_empty()).then(|| {
            format!(
                "{waves} waves, realisation {realisation}, {} mm/s: friction and heat are more than 5 % \
                 apart in {} of {} solves, up to area {largest:.3}: more elements would tell them \
                 better (fem.columns_per_shortest_wavelength)",
                self.speed_mm_s,
                solves.len(),
                self.solves.len()
            )
        })
    }

    /// Friction at the areas that lie between solved ones. Nodes come into contact one by one, so
    /// that the area may stand still from one pressure to the next; solves that add no area are
    /// left out of the curve.
    fn values(&self, areas: &[f64]) -> Vec<FemCurveRow> {
        let mut rising: Vec<&FemSolveRow> = Vec::new();
        for row in self.solves.iter().filter(|row| row.contact_area_fraction > 0.0) {
            let before = rising.last().map_or(0.0, |last| last.contact_area_fraction);
            if row.contact_area_fraction > before {
                rising.push(row);
            }
        }
        let column = |value: fn(&FemSolveRow) -> f64| -> Vec<f64> {
            rising.iter().map(|row| value(row)).collect()
        };
        let areas_solved = column(|row| row.contact_area_fraction);
        let (Some(first), Some(last)) = (areas_solved.first(), areas_solved.last()) else {
            return Vec::new();
        };
        let friction = column(|row| row.friction_coefficient);
        let logarithms: Vec<f64> = areas_solved.iter().map(|area| area.ln()).collect();
        let curve = CubicHermite::smooth(logarithms.clone(), friction.clone());
        let pressures = column(|row| row.pressure_mpa.ln());
        let pressure = CubicHermite::monotone(logarithms.clone(), pressures);
        let errors =
            CubicHermite::linear(logarithms, interpolation_errors(&areas_solved, &friction));
        areas
            .iter()
            .filter(|area| (*first..=*last).contains(*area))
            .map(|area| FemCurveRow {
                waves: self.surface.waves,
                realisation: self.surface.realisation,
                speed_mm_s: self.speed_mm_s,
                contact_area_fraction: *area,
                pressure_mpa: pressure.at(area.ln()).exp(),
                friction_coefficient: curve.at(area.ln()),
                interpolation_error: errors.at(area.ln()),
                discretisation_error: None,
            })
            .collect()
    }

    fn point(&mut self, pressure: f64) -> Result<FemSolveRow, SolveError> {
        if self.context.check_interrupt().is_err() {
            return Err(SolveError::Interrupted);
        }
        self.key["pressure"] = json!(pressure);
        let key = Digest::of_value(&self.key);
        let (waves, realisation) = (self.surface.waves, self.surface.realisation);
        let row = match self.store.get::<FemSolveRow>(&key)? {
            Some(row) => {
                self.skipped.push(pressure);
                FemSolveRow { waves, realisation, ..row }
            }
            None => {
                let row = self.solve(pressure)?;
                self.store.put(&key, &row)?;
                row
            }
        };
        self.solves.push(row.clone());
        Ok(row)
    }

    fn solve(&mut self, pressure: f64) -> Result<FemSolveRow, SolveError> {
        for skipped in std::mem::take(&mut self.skipped) {
            self.block.solve(skipped)?;
        }
        let start = Instant::now();
        let solution = self.block.solve(pressure)?;
        Ok(FemSolveRow {
            waves: self.surface.waves,
            realisation: self.surface.realisation,
            speed_mm_s: self.speed_mm_s,
            pressure_mpa: pressure / 1e6,
            friction_coefficient: solution.friction_coefficient,
            friction_from_heat: solution.hysteretic_friction,
            contact_area_fraction: solution.contact_area_fraction,
            mean_separation_mm: solution.mean_separation * 1e3,
            residual: solution.residual,
            newton_steps: solution.newton_steps as u64,
            columns: self.columns as u64,
            seconds: start.elapsed().as_secs_f64(),
        })
    }
}
