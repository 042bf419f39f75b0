//! methods: the older multiscale methods beside the models of the run.
//!
//! | module | what it holds |
//! |---|---|
//! | `section` | section `[methods]` of a recipe |
//! | `task` | one surface under one method |
//! | `beside` | averages of the methods and of the models of the tables in one table |
//! | `rows` | the tables of the stage |

mod beside;
mod rows;
mod section;
mod task;

use super::bem::{self, CURVES, CurveRow};
use super::contract::{Chain, Context, Contract, Inputs, Planned, Request};
use super::fem::FEM_SOLVES;
use super::kept::Tally;
use super::realise::{Method, SURFACES, Surface, SurfaceKind, read_surfaces};
use super::tables::{FRICTION, Model};
use super::{Stage, StageError};
use crate::artifact::{RunView, SolveStore};
use crate::fem::cost::{MeshCost, solves_of_curve};
use crate::rubber::RubberModel;
use beside::{CurveSeconds, ModelSeconds};
pub use rows::{METHOD_CURVES, METHOD_FRICTION, MethodCurveRow, MethodFrictionRow, schemas};
pub use section::{Methods, OlderMethod, ScaleMechanics};
use serde_json::json;
use task::{Curve, Task};

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 1;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "methods",
    summary: "Older multiscale methods beside the models",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let chain = request.chain()?;
    let (methods, bem, rubber) = (chain.methods?, chain.bem, request.rubber());
    let parameters = json!({
        "methods": methods,
        "rubber": rubber,
        "speeds_mm_s": bem.speeds_mm_s,
        "area_fractions": bem.area_fractions,
        "pressures_mpa": bem.pressures_mpa,
    });
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(methods, chain, rubber, &inputs.results, &inputs.store()?, context)
    };
    let planned = Planned::new(parameters, run)
        .reading(SURFACES)
        .reading(CURVES)
        .reading(FRICTION)
        .reading(bem::SOLVES)
        .reading_if(chain.fem.is_some(), FEM_SOLVES);
    Some(planned)
}

/// Why there may be nothing to solve.
const ALONE: &str = "a surface of one wave cannot be split; methods = [\"recursive\"] takes it";

/// A task, and the surfaces that it stands for.
struct Shared<'a> {
    task: Task,
    surfaces: Vec<&'a Surface>,
}

/// Solves the curves that are not in the store and writes the results; returns warnings.
///
/// # Errors
/// [`StageError::NoMethods`] where no curve has a solution; [`StageError::Interrupted`]. Curves that are done are kept in the
/// store.
pub fn run(
    methods: &Methods,
    chain: &Chain,
    rubber: &RubberModel,
    run: &RunView,
    store: &SolveStore,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let surfaces = read_surfaces(run)?;
    let half_space = run.rows(CURVES)?;
    let shared = tasks(methods, chain, &surfaces, &half_space);
    let interrupted = context.watch.interrupted;
    let solve = |shared: &Shared| shared.task.solve(methods, rubber, store, interrupted);
    let tally = Tally::new(context.watch);
    let found: Vec<Curve> = tally.side_by_side(&shared, shared.len() as u64, solve)?;
    let wanted = chain.bem.wanted();
    let (mut curves, mut times, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
    for (shared, curve) in shared.iter().zip(&found) {
        let task = &shared.task;
        let mut missing = 0;
        for surface in &shared.surfaces {
            let rows = curve.rows(task, surface, &wanted);
            missing += wanted.count() - rows.len();
            times.extend(curve.seconds().map(|seconds| CurveSeconds {
                method: (task.method, task.mechanics, task.split_waves),
                kind: surface.kind,
                speed_mm_s: task.speed_mm_s,
                seconds,
            }));
            curves.extend(rows);
        }
        warnings.extend(doubt(shared, curve, [missing, shared.surfaces.len() * wanted.count()]));
    }
    if curves.is_empty() {
        let reason = warnings.first().cloned().unwrap_or_else(|| ALONE.to_owned());
        return Err(StageError::NoMethods { reason });
    }
    let friction = run.rows(FRICTION)?;
    let of_models = model_seconds(chain, run)?;
    let takes = |kind: SurfaceKind| kind.method == Method::Sines && methods.takes(kind.waves);
    let table = beside::table(&curves, &friction, (&times, &of_models), takes);
    context.pending.write_rows(METHOD_CURVES, &curves)?;
    context.pending.write_rows(METHOD_FRICTION, &table)?;
    Ok(warnings)
}

/// Every surface of sines under every method at every speed, each problem once.
fn tasks<'a>(
    methods: &Methods,
    chain: &Chain,
    surfaces: &'a [Surface],
    half_space: &[CurveRow],
) -> Vec<Shared<'a>> {
    let mut all: Vec<Shared<'a>> = Vec::new();
    let largest_area = chain.bem.area_fractions.last().copied().unwrap_or(0.0);
    let sines = |surface: &&Surface| {
        surface.kind.method == Method::Sines && methods.takes(surface.kind.waves)
    };
    for surface in surfaces.iter().filter(sines) {
        for &speed_mm_s in &chain.bem.speeds_mm_s {
            let Some(range) = pressures(half_space, surface.kind, speed_mm_s) else { continue };
            for task in Task::of(methods, surface, speed_mm_s, range, largest_area) {
                match all.iter_mut().find(|shared| shared.task == task) {
                    Some(shared) => shared.surfaces.push(surface),
                    None => all.push(Shared { task, surfaces: vec![surface] }),
                }
            }
        }
    }
    all
}

/// Lowest and highest pressure in MPa of the half-space on all surfaces of a kind at a speed.
fn pressures(half_space: &[CurveRow], kind: SurfaceKind, speed_mm_s: f64) -> Option<[f64; 2]> {
    let of_kind = half_space.iter().filter(|row| row.kind == kind && row.speed_mm_s == speed_mm_s);
    let ends = of_kind.fold([f64::INFINITY, 0.0_f64], |[least, most], row| {
        [least.min(row.pressure_mpa), most.max(row.pressure_mpa)]
    });
    (ends[1] > 0.0).then_some(ends)
}

/// A warning where a curve, or a part of it, is missing.
fn doubt(shared: &Shared, curve: &Curve, [missing, all]: [usize; 2]) -> Option<String> {
    let Shared { task, surfaces } = shared;
    let of = format!("{}, {}", surfaces[0].kind, task.name());
    match curve {
        Curve::Unsolved(reason) => Some(format!("{of}: no solution: {reason}")),
        Curve::Solved { .. } if missing > 0 => Some(format!(
            "{of}: {missing} of {all} values are missing: their area is not reached, or a part of their load is on local pressures \
             for which a shorter scale has no solution",
        )),
        Curve::Solved { .. } => None,
    }
}

/// Seconds of a curve of the half-space and of all waves at finite deformation, for each kind of surfaces and speed.
fn model_seconds(chain: &Chain, run: &RunView) -> Result<Vec<ModelSeconds>, StageError> {
    let half_space = run.rows(bem::SOLVES)?;
    let mut solves: Vec<_> = half_space
        .iter()
        .map(|row| (Model::Bem, row.kind, row.speed_mm_s, row.realisation, row.seconds))
        .collect();
    if chain.fem.is_some() {
        let finite = run.rows(FEM_SOLVES)?;
        solves.extend(
            finite
                .iter()
                .map(|row| (Model::Fem, row.kind, row.speed_mm_s, row.realisation, row.seconds)),
        );
    }
    let mut times: Vec<ModelSeconds> = Vec::new();
    for &(model, kind, speed_mm_s, ..) in &solves {
        let known = |time: &ModelSeconds| {
            (time.model, time.kind) == (model, kind) && time.speed_mm_s == speed_mm_s
        };
        if times.iter().any(known) {
            continue;
        }
        let own = || {
            solves
                .iter()
                .filter(move |solve| (solve.0, solve.1) == (model, kind) && solve.2 == speed_mm_s)
        };
        let realisations = own().map(|solve| solve.3).max().unwrap_or(1);
        let seconds = own().map(|solve| solve.4).sum::<f64>() / f64::from(realisations);
        times.push(ModelSeconds { model, kind, speed_mm_s, seconds });
    }
    Ok(times)
}

/// Decades of pressure of a law.
const DECADES_OF_A_LAW: f64 = 3.0;
/// Work on half of all that is resolved, for the error.
const WITH_COARSER: f64 = 1.3;

/// Expected seconds of one thread for one realisation of a surface at one speed; what all realisations share is counted
/// with each. On the half-space a contact takes next to nothing.
pub(crate) fn seconds(methods: &Methods, chain: &Chain, surface: &Surface) -> f64 {
    if surface.kind.method != Method::Sines || !methods.takes(surface.kind.waves) {
        return 0.0;
    }
    let wanted = chain.bem.wanted();
    let range = wanted.range();
    // The curve begins at half the pressure, and goes on to where it has the largest area.
    let curve = [range[0] / 2.0, range[range.len() - 1] * 2.0];
    let law = [1.0, 10.0_f64.powf(DECADES_OF_A_LAW)];
    let finite = |task: &Task| task.mechanics == ScaleMechanics::FiniteDeformation;
    let tasks = Task::of(methods, surface, chain.bem.speeds_mm_s[0], [1.0, 1.0], 1.0);
    let of_task = |task: &Task| -> f64 {
        let last = task.groups.len() - 1;
        let of_group = |(at, group): (usize, &task::Group)| {
            let profile = group.profile();
            let resolution = methods.columns_per_shortest_wavelength as usize;
            let columns = resolution * profile.shortest_waves() as usize;
            let range = if at == last { &curve } else { &law };
            MeshCost::new(&profile, columns, false)
                .seconds_of_solves(solves_of_curve(range, methods.pressure_ratio))
        };
        WITH_COARSER * task.groups.iter().enumerate().map(of_group).sum::<f64>()
    };
    tasks.iter().filter(|task| finite(task)).map(of_task).sum()
}
