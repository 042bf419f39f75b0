//! areal: sliding contact of the viscoelastic half-space, or a layer, with surfaces that are rough in both directions.
//!
//! | module | what it holds |
//! |---|---|
//! | `curve` | one curve of friction over contact area: one surface, one speed, one direction |
//! | `doubts` | what a user is told of the curves |
//! | `rows` | the tables of the stage |
//! | `scale` | the friction beside which errors are judged where friction vanishes |
//! | `task` | one curve as a task of a sweep, which any machine can solve |

mod curve;
mod doubts;
mod rows;
mod scale;
mod task;

use super::bem::Bem;
use super::contract::{Chain, Context, Contract, Inputs, Planned, Request};
use super::kept::{SolveTask, Tally, unfinished};
use super::realise::{AREAL, ArealSurface, read_areal_surfaces};
use super::{Stage, StageError};
use crate::artifact::{ArrayDataset, ArtifactError, RunView, SolveStore, Storage};
use crate::contact::areal::memory_bytes;
use crate::contact::refine::{SHARES, SHARES_IN_WORDS};
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::RubberModel;
use curve::CurveResult;
pub use rows::{
    AREAL_CURVES, AREAL_FIELDS, AREAL_SOLVES, AREAL_UNSOLVED, ArealCurveRow, ArealSolveRow,
    ArealUnsolvedRow, areal_fields_schema, schemas,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
pub use task::{Sweep, Task};

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 2;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "areal",
    summary: "Sliding contact of areal surfaces",
    revision: REVISION,
    schemas,
    plan,
};

impl Chain<'_> {
    /// Whether maps are kept beside their lines.
    pub fn has_maps(&self) -> bool {
        self.ingest.is_some_and(|ingest| ingest.maps.is_some())
    }

    /// Whether line scans are taken: not where maps stand alone, because no method makes profiles or needs the statistics of
    /// lines.
    pub fn has_lines(&self) -> bool {
        let realise = self.realise;
        let needed = realise.has_windows() || realise.is_isotropic() || !realise.waves.is_empty();
        self.ingest.is_some() && (!self.has_maps() || needed)
    }

    /// Whether there are surfaces that are rough in both directions.
    pub fn has_areal_surfaces(&self) -> bool {
        self.realise.is_isotropic() || self.has_maps() && self.realise.names_windows()
    }
}

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let chain = request.chain()?;
    if !chain.has_areal_surfaces() {
        return None;
    }
    let (areal, bem, rubber) = (chain.areal, chain.bem, request.rubber());
    let parameters = json!({
        "areal": areal,
        "rubber": rubber,
        "speeds_mm_s": bem.speeds_mm_s,
        "area_fractions": bem.area_fractions,
        "pressures_mpa": bem.pressures_mpa,
    });
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(areal, bem, rubber, &inputs.results, &inputs.store()?, context)
    };
    Some(Planned::new(parameters, run).reading(AREAL))
}

/// Section `[areal]` of a recipe: how areal surfaces are solved. Rubber, speeds, areas and pressures are those of `[bem]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Areal {
    /// Directions in which the rubber slides, in degrees from x (the rows of a map) towards y. The friction tables have the
    /// first; all are in the curves of the stage.
    pub angles_deg: Vec<f64>,
    /// Grid points on the shortest wave along each direction, at least.
    pub points_per_shortest_wavelength: f64,
    /// Relative accuracy of friction by interpolation between solved pressures.
    pub tolerance: f64,
    /// Thickness in mm of a rubber layer that is bonded to a rigid base; a half-space if not set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness_mm: Option<f64>,
    /// Most memory in GB that the contacts may take together; a grid that needs more is refused before it is solved.
    pub memory_gb: f64,
    /// Contact area fractions at which pressure and separation are kept as fields.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub field_area_fractions: Vec<f64>,
}

impl Default for Areal {
    fn default() -> Self {
        Self {
            angles_deg: vec![0.0],
            points_per_shortest_wavelength: 16.0,
            tolerance: 0.01,
            thickness_mm: None,
            memory_gb: 4.5,
            field_area_fractions: Vec::new(),
        }
    }
}

impl Areal {
    pub(crate) fn check(&self, bem: &Bem) -> Result<(), InvalidRecipe> {
        let angles = &self.angles_deg;
        let turned = |a: f64| a.rem_euclid(360.0);
        let same = |a: f64| move |b: &f64| turned(a) == turned(*b);
        let once = angles.iter().enumerate().all(|(i, a)| !angles[..i].iter().any(same(*a)));
        let inside = angles.iter().all(|a| (-360.0..=360.0).contains(a));
        let wanted = "one angle or more from -360 to 360, without repeats";
        require(!angles.is_empty() && once && inside, "areal.angles_deg", angles, wanted)?;
        let points = self.points_per_shortest_wavelength;
        let key = "areal.points_per_shortest_wavelength";
        require((4.0..=256.0).contains(&points), key, points, "4 to 256")?;
        let tolerance = self.tolerance;
        require(SHARES.contains(&tolerance), "areal.tolerance", tolerance, SHARES_IN_WORDS)?;
        if let Some(mm) = self.thickness_mm {
            require((1e-6..=1e6).contains(&mm), "areal.thickness_mm", mm, "1e-6 to 1e6")?;
        }
        let memory = self.memory_gb;
        require(memory > 0.0, "areal.memory_gb", memory, "positive")?;
        let (fields, areas) = (&self.field_area_fractions, &bem.area_fractions);
        let (first, last) = (areas.first(), areas.last());
        let within = fields.iter().all(|a| first <= Some(a) && last >= Some(a));
        let ascend = fields.windows(2).all(|pair| pair[0] < pair[1]);
        let wanted = "ascending and within the range of bem.area_fractions";
        require(within && ascend, "areal.field_area_fractions", fields, wanted)
    }

    /// Points of the grid of a surface.
    pub(crate) fn grid(&self, surface: &ArealSurface) -> [usize; 2] {
        surface.map.grid(self.points_per_shortest_wavelength)
    }
}

/// Solves the contacts that are not in the store and writes the results; returns warnings.
///
/// # Errors
/// [`StageError::ArealMemory`] for grids that do not fit into the memory that may be taken; [`StageError::ArealContact`] where
/// no curve has a value; [`StageError::Interrupted`]. Solves that are done are kept in the store. A value that cannot be had is
/// left out with a warning and a row in [`AREAL_UNSOLVED`].
pub fn run(
    parameters: &Areal,
    bem: &Bem,
    rubber: &RubberModel,
    run: &RunView,
    store: &SolveStore,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let surfaces = read_areal_surfaces(run)?;
    require_memory(parameters, &surfaces)?;
    let tasks = tasks(parameters, bem, &surfaces);
    let sweep = Sweep { areal: parameters.clone(), wanted: bem.wanted() };
    let solve = |task: &Task| task.solve(&sweep, rubber, store, context.watch);
    let tally = Tally::new(context.watch);
    let mut results: Vec<CurveResult> = tally.side_by_side(&tasks, tasks.len() as u64, solve)?;
    if results.iter().all(|result| result.curve.is_empty())
        && let Some(failure) = results.iter_mut().find_map(|result| result.failure.take())
    {
        return Err(failure);
    }
    let warnings = doubts::of_curves(&results);
    let pending = &mut context.pending;
    let curves: Vec<_> = results.iter().flat_map(|result| result.curve.iter().cloned()).collect();
    pending.write_rows(AREAL_CURVES, &curves)?;
    let solves: Vec<_> = results.iter().flat_map(|result| result.solves.iter().cloned()).collect();
    pending.write_rows(AREAL_SOLVES, &solves)?;
    let unsolved: Vec<_> = results.iter().flat_map(|r| r.unsolved.iter().cloned()).collect();
    pending.write_rows(AREAL_UNSOLVED, &unsolved)?;
    let fields: Vec<ArrayDataset> = results.into_iter().flat_map(|result| result.fields).collect();
    if !fields.is_empty() {
        pending.write_arrays(AREAL_FIELDS, Storage::Compressed, &fields)?;
    }
    Ok(warnings)
}

/// Every curve, the first realisations of all kinds first.
fn tasks(parameters: &Areal, bem: &Bem, surfaces: &[ArealSurface]) -> Vec<Task> {
    let mut tasks = Vec::new();
    for surface in surfaces {
        for &speed_mm_s in &bem.speeds_mm_s {
            for &angle_deg in &parameters.angles_deg {
                tasks.push(Task { surface: surface.clone(), speed_mm_s, angle_deg });
            }
        }
    }
    tasks
}

/// The tasks of a run that a packed store does not have.
///
/// # Errors
/// [`ArtifactError::Io`].
pub fn missing(
    sweep: &Sweep,
    bem: &Bem,
    rubber: &RubberModel,
    surfaces: &[ArealSurface],
    store: &SolveStore,
) -> Result<Vec<Task>, ArtifactError> {
    unfinished(tasks(&sweep.areal, bem, surfaces), sweep, rubber, store)
}

/// Refuses grids that do not fit into the memory that may be taken by as many contacts as there are threads.
pub(crate) fn require_memory(
    parameters: &Areal,
    surfaces: &[ArealSurface],
) -> Result<(), StageError> {
    const BYTES_PER_GB: f64 = 1e9;
    for surface in surfaces {
        let points = parameters.grid(surface);
        let at_once = rayon::current_num_threads().min(surfaces.len());
        let needed_gb = memory_bytes(points[0], points[1]) as f64 * at_once as f64 / BYTES_PER_GB;
        if needed_gb > parameters.memory_gb {
            return Err(StageError::ArealMemory {
                kind: surface.kind,
                points,
                at_once,
                needed_gb,
                limit_gb: parameters.memory_gb,
            });
        }
    }
    Ok(())
}
