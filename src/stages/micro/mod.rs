//! micro: friction, area and separation of the steepest waves over their mean pressure, on the
//! half-space and at finite deformation.
//!
//! | module | what it holds |
//! |---|---|
//! | `curve` | one microscale at one speed, sampled as densely as the tolerance needs |
//! | `monotony` | what every contact does as it is pressed harder: its area grows and its separation falls |
//! | `rows` | the tables of the stage |
//! | `stretches` | the microscale of surfaces, and its stretches where they are windows of the scans |
//! | `task` | one microscale at one speed: what it is pressed by, and its sampling, on any machine |

mod curve;
mod monotony;
mod rows;
mod stretches;
mod task;

use super::bem::{CURVES, CurveRow};
use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::kept::{SolveTask, Tally, unfinished};
use super::realise::{SURFACES, Surface, read_surfaces};
use super::{Stage, StageError};
use crate::artifact::{RunView, SolveStore};
use crate::contact::refine::{SHARES, SHARES_IN_WORDS};
use crate::fem::steady::COLUMNS_RANGE;
use crate::multiscale::correction::Microscale;
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::RubberModel;
use crate::surface::{Wave, wave};
use crate::units::Units;
pub(crate) use curve::law_of;
pub use rows::{LAW, LawRow, SAMPLES, SampleRow, schemas};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
pub(crate) use stretches::{Parting, partings, steepest_octave_left, stretches};
pub(crate) use task::is_of;
pub use task::{Owner, PressedSurface, Task};

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 8;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "micro",
    summary: "The steepest waves at finite deformation",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let micro = request.chain()?.micro?;
    let rubber = request.rubber();
    let parameters = json!({ "micro": micro, "rubber": rubber });
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(micro, rubber, &inputs.results, &inputs.store()?, context)
    };
    Some(Planned::new(parameters, run).reading(SURFACES).reading(CURVES))
}

/// Section `[micro]` of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Micro {
    /// Waves with a larger root mean square slope are the microscale, where deformations are too
    /// large for the half-space. The default of 0.7 takes in three waves of the bundled asphalt. Of surfaces of
    /// windows, which have waves of all lengths, it is the shortest octaves: as few as together have a larger slope, or
    /// leave the rest none.
    pub rms_slope_threshold: f64,
    /// Elements on the shortest wave.
    pub columns_per_shortest_wavelength: u32,
    /// Accuracy of friction by interpolation between sampled pressures, relative to the friction.
    pub tolerance: f64,
    /// Whether every sample is solved on half the columns too, for the error by the mesh: two fifths more
    /// work.
    pub estimate_mesh_error: bool,
    /// Grid points of the macro surface on its shortest wave, at least; the grid is the next power
    /// of two.
    pub points_per_shortest_macro_wavelength: u32,
    /// Length in mm of a macro contact: branches that relax over a longer distance of sliding do not follow the mean
    /// strain of the microscale. If not given, all have relaxed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_length_mm: Option<f64>,
    /// Stretches of the microscale of windows that are solved: their differences are the statistical error of its
    /// correction.
    #[serde(skip_serializing_if = "are_default_stretches")]
    pub stretches: u32,
    /// Length of such a stretch, in wavelengths of the longest wave of the microscale.
    #[serde(skip_serializing_if = "is_default_length")]
    pub stretch_length: u32,
}

// The signature is that of serde.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn are_default_stretches(stretches: &u32) -> bool {
    *stretches == Micro::default().stretches
}

// The signature is that of serde.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_default_length(length: &u32) -> bool {
    *length == Micro::default().stretch_length
}

impl Default for Micro {
    fn default() -> Self {
        Self {
            rms_slope_threshold: 0.7,
            columns_per_shortest_wavelength: 48,
            tolerance: 5e-3,
            estimate_mesh_error: true,
            points_per_shortest_macro_wavelength: 32,
            contact_length_mm: None,
            stretches: 4,
            stretch_length: 2,
        }
    }
}

/// What sets the mesh, for messages.
const COLUMNS_KEY: &str = "micro.columns_per_shortest_wavelength";

impl Micro {
    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        let threshold = self.rms_slope_threshold;
        let key = "micro.rms_slope_threshold";
        require(threshold > 0.0 && threshold.is_finite(), key, threshold, "positive and finite")?;
        let columns = self.columns_per_shortest_wavelength;
        require((16..=1024).contains(&columns), COLUMNS_KEY, columns, "16 to 1024")?;
        let tolerance = self.tolerance;
        let key = "micro.tolerance";
        require(SHARES.contains(&tolerance), key, tolerance, SHARES_IN_WORDS)?;
        if let Some(length) = self.contact_length_mm {
            let key = "micro.contact_length_mm";
            require(length > 0.0 && length.is_finite(), key, length, "positive and finite")?;
        }
        let (key, stretches) = ("micro.stretches", self.stretches);
        require((1..=1000).contains(&stretches), key, stretches, "1 to 1000")?;
        let (key, length) = ("micro.stretch_length", self.stretch_length);
        require((1..=64).contains(&length), key, length, "1 to 64")?;
        let points = self.points_per_shortest_macro_wavelength;
        let key = "micro.points_per_shortest_macro_wavelength";
        require((4..=4096).contains(&points), key, points, "4 to 4096")
    }

    /// The heights of a macro surface in m on its grid, and their period in m.
    pub(crate) fn macro_heights(&self, surface: &Surface, macroscale: &[Wave]) -> (Vec<f64>, f64) {
        let period = surface.profile.iter().map(|wave| wave.wavelength).fold(0.0, f64::max);
        let shortest = macroscale.iter().map(|wave| wave.wavelength).fold(period, f64::min);
        let points = f64::from(self.points_per_shortest_macro_wavelength) * period / shortest;
        let points = (points.round() as usize).next_power_of_two();
        (wave::sample(macroscale, period, points), period)
    }
}

/// Samples the microscales over the pressures that the macro contacts ask for; returns warnings.
///
/// # Errors
/// [`StageError::NoMicroscale`] if none has a solution, [`StageError::Microscale`];
/// [`StageError::Interrupted`]. Solves that are done are kept.
pub fn run(
    parameters: &Micro,
    rubber: &RubberModel,
    run: &RunView,
    store: &SolveStore,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let surfaces = read_surfaces(run)?;
    let curves = run.rows(CURVES)?;
    let tasks = task::tasks(parameters, &surfaces, &curves)?;
    let sample = |task: &Task| task.solve(parameters, rubber, store, context.watch);
    let tally = Tally::new(context.watch);
    let results = tally.side_by_side(&tasks, tasks.len() as u64, sample)?;
    if let Some(reason) = results.iter().find_map(|result| result.warnings.first().cloned())
        && results.iter().all(|result| result.samples.is_empty())
    {
        return Err(StageError::NoMicroscale { reason });
    }
    let results: Vec<TaskResult> =
        tasks.iter().zip(results).map(|(task, result)| result.owned_by(&task.owners)).collect();
    let samples: Vec<_> = results.iter().flat_map(|r| r.samples.iter().cloned()).collect();
    context.pending.write_rows(SAMPLES, &samples)?;
    let laws: Vec<_> = results.iter().flat_map(|r| r.law.iter().cloned()).collect();
    context.pending.write_rows(LAW, &laws)?;
    let mut warnings: Vec<String> = results.into_iter().flat_map(|r| r.warnings).collect();
    if tasks.is_empty() {
        warnings.push(format!(
            "no wave is steeper than {} (micro.rms_slope_threshold): nothing to correct",
            parameters.rms_slope_threshold
        ));
    }
    Ok(warnings)
}

/// Friction and area of a microscale between its samples, which are one or more at ascending pressures.
pub(crate) fn between_samples(samples: &[&SampleRow]) -> Microscale {
    let column = |value: fn(&SampleRow) -> f64| samples.iter().map(|row| value(row)).collect();
    let pressures: Vec<f64> = column(|row| row.pressure_mpa.mpa_to_pa());
    let mesh = samples.iter().map(|row| row.discretisation_error).collect();
    Microscale::new(
        &pressures,
        column(|row| row.friction_half_space),
        column(|row| row.friction_finite_deformation),
        column(|row| row.area_finite_deformation - row.area_half_space),
        column(|row| row.interpolation_error),
    )
    .with_discretisation_errors(&pressures, mesh)
}

/// The tasks of a run that a packed store does not have; `curves` are those of the half-space.
///
/// # Errors
/// As [`run`].
pub fn missing(
    parameters: &Micro,
    rubber: &RubberModel,
    surfaces: &[Surface],
    curves: &[CurveRow],
    store: &SolveStore,
) -> Result<Vec<Task>, StageError> {
    let tasks = task::tasks(parameters, surfaces, curves)?;
    Ok(unfinished(tasks, parameters, rubber, store)?)
}

/// Relative difference of two amplitudes, or phase difference, that is but round-off: fits of eight
/// and of nine waves agree in the steepest one.
const ROUND_OFF: f64 = 1e-9;

/// Whether two microscales are one.
pub(crate) fn same_waves(left: &[Wave], right: &[Wave]) -> bool {
    let same = |(a, b): (&Wave, &Wave)| {
        a.wavelength == b.wavelength
            && (a.amplitude - b.amplitude).abs() <= ROUND_OFF * a.amplitude.abs()
            && (a.phase - b.phase).abs() <= ROUND_OFF
    };
    left.len() == right.len() && left.iter().zip(right).all(same)
}

pub(crate) struct TaskResult {
    samples: Vec<SampleRow>,
    law: Vec<LawRow>,
    warnings: Vec<String>,
}

impl TaskResult {
    /// The rows once for every owner.
    fn owned_by(self, owners: &[Owner]) -> Self {
        let (mut samples, mut law) = (Vec::new(), Vec::new());
        for &Owner { kind, realisation, stretch } in owners {
            let owned = |row: &SampleRow| SampleRow { kind, realisation, stretch, ..row.clone() };
            samples.extend(self.samples.iter().map(owned));
            let owned = |row: &LawRow| LawRow { kind, realisation, stretch, ..row.clone() };
            law.extend(self.law.iter().map(owned));
        }
        Self { samples, law, warnings: self.warnings }
    }
}

/// Columns of the mesh of a microscale: so many elements on its shortest wave.
pub(crate) fn columns(per_wave: u32, period: f64, shortest: f64) -> usize {
    let columns = (f64::from(per_wave) * period / shortest).round() as usize;
    columns.clamp(*COLUMNS_RANGE.start(), *COLUMNS_RANGE.end())
}
