//! feedback: contacts whose moduli follow from their own heat and strain, for every surface, speed and pressure.
//!
//! | module | what it holds |
//! |---|---|
//! | `contact` | the contacts of one surface at one speed, under every effect |
//! | `doubts` | what a user is told of them |
//! | `laws` | what of a recipe and its rubber changes the moduli |
//! | `rows` | the tables of the stage |
//! | `section` | section `[feedback]` of a recipe |

mod contact;
mod doubts;
mod laws;
mod rows;
mod section;

use super::bem::{Bem, GridRule, REALISATIONS, RealisationsRow};
use super::contract::{Chain, Context, Contract, Inputs, Planned, Request};
use super::kept::Tally;
use super::realise::{SURFACES, Surface, read_surfaces};
use super::tables::Adhesion;
use super::{Stage, StageError};
use crate::artifact::{RunView, SolveStore};
use crate::rubber::RubberData;
use crate::units::Units;
use contact::{Common, Contacts, Outcome};
use laws::Laws;
pub(crate) use laws::require_laws;
pub use rows::{CONTACTS, ContactRow, Effect, UNSOLVED, UnsolvedRow, schemas};
pub use section::{Feedback, Heat, RoadBody};
use serde_json::json;

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 1;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "feedback",
    summary: "Contacts with their own heat and strain",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let chain = request.chain()?;
    let feedback = chain.feedback?;
    let (bem, material) = (chain.bem, &request.material);
    // The shear stress of the contact area is of effect here by its heat alone.
    let adhesion = chain.adhesion.filter(|_| feedback.heat.is_some());
    let averaged = bem.average_tolerance.is_some();
    let parameters = json!({
        "feedback": feedback,
        "rubber": material.rubber,
        "temperature": material.temperature.as_ref().filter(|_| feedback.heat.is_some()),
        "payne": material.payne_law().filter(|_| feedback.strain),
        "adhesion": adhesion,
        "speeds_mm_s": feedback.speeds(bem),
        "pressures_mpa": bem.pressures_mpa,
        "grid_tolerance": bem.grid_tolerance,
        "points_per_shortest_wavelength": bem.points_per_shortest_wavelength,
        "fewest_contact_points": bem.fewest_contact_points,
        "areal_surfaces": chain.has_areal_surfaces(),
    });
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(feedback, chain, material, adhesion, &inputs.results, &inputs.store()?, context)
    };
    Some(Planned::new(parameters, run).reading(SURFACES).reading_if(averaged, REALISATIONS))
}

/// Seconds of one thread for a point of the usual grid of a contact that is heated, coarser grids included: 2.5 s on 8192 points.
const SECONDS_PER_POINT_HOT: f64 = 3e-4;
/// The same of one that is softened alone.
const SECONDS_PER_POINT_SOFT: f64 = 4e-5;

/// Expected seconds of one thread for one realisation of a surface, at all speeds and pressures.
pub(crate) fn seconds(feedback: &Feedback, bem: &Bem, surface: &Surface) -> f64 {
    let of_effect = |effect: Effect| match (effect.has_heat(), effect.has_strain()) {
        (true, _) => SECONDS_PER_POINT_HOT,
        (false, true) => SECONDS_PER_POINT_SOFT,
        (false, false) => 0.0,
    };
    if !feedback.takes(surface.kind.method) {
        return 0.0;
    }
    let each: f64 = feedback.effects().into_iter().map(of_effect).sum();
    let contacts = feedback.speeds(bem).len() * bem.pressures_mpa.len();
    each * (contacts * GridRule::new(bem, surface).usual_points()) as f64
}

/// One surface at one speed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Task<'a> {
    /// The surface.
    surface: &'a Surface,
    /// Sliding speed in mm/s.
    speed_mm_s: f64,
}

/// Solves the contacts that are not in the store and writes the results; returns warnings.
///
/// A contact without a solution has a row in [`UNSOLVED`], and a warning counts them.
///
/// # Errors
/// [`StageError::NoFeedback`] where no contact has a solution under any effect but cold; [`StageError::NoTemperatureLaw`] and
/// [`StageError::NoStrainLaw`] for a rubber without the law that is asked for; [`StageError::Interrupted`]. Contacts that are
/// done are kept in the store.
pub fn run(
    feedback: &Feedback,
    chain: &Chain,
    material: &RubberData,
    adhesion: Option<&Adhesion>,
    run: &RunView,
    store: &SolveStore,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let bem = chain.bem;
    let laws = Laws::new(feedback, material, adhesion, &bem.rubber)?;
    let interrupted = context.watch.interrupted;
    let common = Common { bem, rubber: &material.rubber, laws: &laws, store, interrupted };
    let surfaces = read_surfaces(run)?;
    let solved = match bem.average_tolerance {
        Some(_) => run.rows(REALISATIONS)?,
        None => Vec::new(),
    };
    let tasks = tasks(feedback, bem, &surfaces, &solved);
    let effects = feedback.effects();
    let solve = |task: &Task| solve(task, &effects, &common);
    let tally = Tally::new(context.watch);
    let found = tally.side_by_side(&tasks, tasks.len() as u64, solve)?;
    let (mut contacts, mut unsolved) = (Vec::new(), Vec::new());
    for (rows, without) in found {
        contacts.extend(rows);
        unsolved.extend(without);
    }
    if contacts.iter().all(|row| row.effect == Effect::Cold)
        && let Some(first) = unsolved.first()
    {
        return Err(StageError::NoFeedback { reason: doubts::named(first) });
    }
    let mut warnings = doubts::of_contacts(&contacts, &unsolved);
    warnings.extend(doubts::of_laws(&laws, material, feedback, &contacts));
    warnings.extend(doubts::of_sliding(&laws, &tasks));
    if chain.has_areal_surfaces() {
        warnings.push(
            "areal surfaces are left out: heat and softening of the contact are solved for profiles".into(),
        );
    }
    context.pending.write_rows(CONTACTS, &contacts)?;
    context.pending.write_rows(UNSOLVED, &unsolved)?;
    Ok(warnings)
}

/// Every surface at every speed; of realisations that are drawn for an accuracy of the average, those that `bem` has taken at
/// that speed, or at the speed with the most where it does not have it.
fn tasks<'a>(
    feedback: &Feedback,
    bem: &Bem,
    surfaces: &'a [Surface],
    solved: &[RealisationsRow],
) -> Vec<Task<'a>> {
    let taken = |surface: &Surface, speed_mm_s: f64| {
        let of_kind = || solved.iter().filter(|row| row.kind == surface.kind);
        let here = of_kind().find(|row| row.speed_mm_s == speed_mm_s).map(|row| row.realisations);
        let most = here.or_else(|| of_kind().map(|row| row.realisations).max());
        most.is_none_or(|most| surface.realisation <= most)
    };
    let speeds = feedback.speeds(bem);
    let all = surfaces
        .iter()
        .filter(|surface| feedback.takes(surface.kind.method))
        .flat_map(|surface| speeds.iter().map(move |&speed_mm_s| Task { surface, speed_mm_s }));
    all.filter(|task| taken(task.surface, task.speed_mm_s)).collect()
}

/// The contacts of a task by pressure and effect, and those without a solution.
fn solve(
    task: &Task,
    effects: &[Effect],
    common: &Common,
) -> Result<(Vec<ContactRow>, Vec<UnsolvedRow>), StageError> {
    let shear_stress = common.laws.shear_stress(task.speed_mm_s.mm_to_m())?;
    let mut contacts = Contacts::new(common, task, shear_stress)?;
    let (mut solved, mut unsolved) = (Vec::new(), Vec::new());
    for &pressure_mpa in &common.bem.pressures_mpa {
        for &effect in effects {
            let named = |source| StageError::Solve {
                problem: format!(
                    "{}, {pressure_mpa} MPa, {effect}",
                    task.surface.name_at("feedback", task.speed_mm_s)
                ),
                source,
            };
            match contacts.at(pressure_mpa, effect).map_err(|error| error.in_stage(named))? {
                Outcome::Solved(row) => solved.push(row),
                Outcome::Unsolved(reason) => unsolved.push(UnsolvedRow {
                    kind: task.surface.kind,
                    realisation: task.surface.realisation,
                    effect,
                    speed_mm_s: task.speed_mm_s,
                    pressure_mpa,
                    reason,
                }),
            }
        }
    }
    Ok((solved, unsolved))
}
