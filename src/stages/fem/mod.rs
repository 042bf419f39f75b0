//! fem: friction over contact area with all waves at finite deformation, for surfaces that are
//! small enough; what the other models are measured by.
//!
//! | module | what it holds |
//! |---|---|
//! | `curve` | one curve of friction over contact area: one surface at one speed, solved along its pressures |
//! | `rows` | the tables of the stage |
//! | `task` | one curve as a task, which any machine can solve |

mod curve;
mod rows;
mod task;

use super::bem::{Bem, CURVES, CurveRow};
use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::kept::{SolveTask, Tally, unfinished};
use super::realise::{SURFACES, Surface, read_surfaces};
use super::{Stage, StageError};
use crate::artifact::{ArtifactError, RunView, SolveStore};
use crate::fem::cost::MeshCost;
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::RubberModel;
use crate::stages::realise::{Method, SurfaceKind};
pub(crate) use curve::CurveResult as FemCurve;
pub use rows::{FEM, FEM_SOLVES, FemCurveRow, FemSolveRow, schemas};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
pub use task::{Sweep, Task};

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 10;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "fem",
    summary: "All waves at finite deformation",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let chain = request.chain()?;
    let (fem, bem, rubber) = (chain.fem?, chain.bem, request.rubber());
    let parameters = json!({
        "fem": fem,
        "rubber": rubber,
        "speeds_mm_s": bem.speeds_mm_s,
        "area_fractions": bem.area_fractions,
        "pressures_mpa": bem.pressures_mpa,
    });
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(fem, bem, rubber, &inputs.results, &inputs.store()?, context)
    };
    Some(Planned::new(parameters, run).reading(SURFACES).reading(CURVES))
}

/// Section `[fem]` of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Fem {
    /// Numbers of waves whose surfaces are solved, among those of `[realise]`; all of them if empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub waves: Vec<u32>,
    /// Other surfaces that are solved with all their waves, among those of `[realise]`: profiles of windows are
    /// long, and a curve of one takes hours. None by default.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub methods: Vec<Method>,
    /// Elements on the shortest wave.
    pub columns_per_shortest_wavelength: u32,
    /// Ratio of neighbouring pressures that are solved; friction is interpolated between them.
    pub pressure_ratio: f64,
    /// Whether the curves are solved on half the columns too, for the error by the mesh: two fifths more
    /// work. Surfaces of many scales on at least 64 columns a wave
    /// are solved from there in any case.
    pub estimate_mesh_error: bool,
}

impl Default for Fem {
    fn default() -> Self {
        Self {
            waves: Vec::new(),
            methods: Vec::new(),
            columns_per_shortest_wavelength: 96,
            pressure_ratio: 1.25,
            estimate_mesh_error: true,
        }
    }
}

impl Fem {
    /// Whether surfaces of that kind are solved.
    pub fn solves(&self, kind: SurfaceKind) -> bool {
        match kind.method {
            Method::Sines => self.waves.is_empty() || self.waves.contains(&kind.waves),
            method => self.methods.contains(&method),
        }
    }

    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        let columns = self.columns_per_shortest_wavelength;
        let key = "fem.columns_per_shortest_wavelength";
        require((16..=1024).contains(&columns), key, columns, "16 to 1024")?;
        let ratio = self.pressure_ratio;
        require((1.01..=2.0).contains(&ratio), "fem.pressure_ratio", ratio, "between 1.01 and 2")
    }
}

/// Solves the contacts that are not in the store and writes the results; returns warnings.
///
/// # Errors
/// [`StageError::FiniteDeformation`] for a curve that cannot be had; [`StageError::Interrupted`]. Solves that
/// are done are kept in the store.
pub fn run(
    parameters: &Fem,
    bem: &Bem,
    rubber: &RubberModel,
    run: &RunView,
    store: &SolveStore,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let surfaces = read_surfaces(run)?;
    let half_space = run.rows(CURVES)?;
    let tasks = task::tasks(parameters, bem, &surfaces, &half_space);
    let sweep = Sweep { fem: parameters.clone(), wanted: bem.wanted() };
    let solve = |task: &Task| task.solve(&sweep, rubber, store, context.watch);
    let tally = Tally::new(context.watch);
    let results: Vec<FemCurve> = tally.side_by_side(&tasks, tasks.len() as u64, solve)?;
    let curves: Vec<_> = results.iter().flat_map(|result| result.rows.iter().cloned()).collect();
    context.pending.write_rows(FEM, &curves)?;
    let solves: Vec<_> = results.iter().flat_map(|result| result.solves.iter().cloned()).collect();
    context.pending.write_rows(FEM_SOLVES, &solves)?;
    Ok(results.into_iter().flat_map(|result| result.warnings).collect())
}

/// The tasks of a run that a packed store does not have; `curves` are those of the half-space.
///
/// # Errors
/// [`ArtifactError::Io`].
pub fn missing(
    sweep: &Sweep,
    bem: &Bem,
    rubber: &RubberModel,
    surfaces: &[Surface],
    curves: &[CurveRow],
    store: &SolveStore,
) -> Result<Vec<Task>, ArtifactError> {
    unfinished(task::tasks(&sweep.fem, bem, surfaces, curves), sweep, rubber, store)
}

/// What a contact of a surface costs.
pub(crate) fn cost(parameters: &Fem, surface: &Surface) -> MeshCost {
    task::cost_of(parameters, surface)
}

/// Columns of the mesh of a surface.
pub(crate) fn columns(parameters: &Fem, surface: &Surface) -> usize {
    task::columns_of(parameters, surface)
}
