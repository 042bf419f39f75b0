//! hybrid: friction of the half-space, corrected where the steepest waves deform too much for it
//! (thesis 5.1).
//!
//! ```text
//! μ = μ_init(p) mean_i μ_FEM(p_i) / mean_i μ_BEM(p_i)        correction = "ratio"
//! μ = μ_init(p) + mean_i (μ_FEM(p_i) - μ_BEM(p_i))           correction = "difference", the thesis' rule
//! ```
//!
//! with the local pressures `p_i` of the macro surface under the repulsive law of the microscale.

//!
//! | module | what it holds |
//! |---|---|
//! | `rows` | the tables of the stage |
//! | `sampled` | samples and laws of the microscales |
//! | `stretches` | one value from those by several stretches of the microscale |

mod rows;
mod sampled;
mod stretches;

use super::bem::{CURVES, CurveRow};
use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::micro::{LAW, Micro, Parting, SAMPLES, partings};
use super::realise::{SURFACES, Surface, read_surfaces};
use super::{SolveError, Stage, StageError};
use crate::artifact::RunView;
use crate::multiscale::correction::{CorrectionRule, MeanRule, Microscale, running_mean};
use crate::multiscale::{LawError, SoftContact, SoftContactError, SoftContactSolution};
use crate::numerics::Interrupt;
use crate::rubber::RubberModel;
use crate::surface::Wave;
use crate::units::Units;
use rayon::prelude::*;
pub use rows::{HYBRID, HybridRow, LOCAL, LocalRow, schemas};
use sampled::{Data, Sampled, microscale};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 6;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "hybrid",
    summary: "Friction of the half-space corrected by the microscale",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let chain = request.chain()?;
    let (hybrid, micro, rubber) = (chain.hybrid, chain.micro?, request.rubber());
    let parameters = json!({ "hybrid": hybrid, "micro": micro, "rubber": rubber });
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(&hybrid, micro, rubber, &inputs.results, context)
    };
    Some(
        Planned::new(parameters, run)
            .reading(SURFACES)
            .reading(CURVES)
            .reading(SAMPLES)
            .reading(LAW),
    )
}

/// Section `[hybrid]` of a recipe.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Hybrid {
    /// How the change of the friction of the microscale is applied to the friction of all waves.
    pub correction: CorrectionRule,
    /// How the friction of the microscale is averaged over the macro contact.
    pub mean: MeanRule,
    /// Whose separation over pressure the macro surface meets.
    pub law: RepulsiveLaw,
    /// Which pressures of the macro surface the microscale is asked at.
    pub local_pressures: LocalPressures,
}

/// The pressures at which the microscale is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LocalPressures {
    /// Those of the points of the macro grid.
    Points,
    /// Their means over one period of the microscale about each point: what its friction is a function of.
    #[default]
    Periods,
}

/// The model that gives the repulsive law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RepulsiveLaw {
    /// The half-space, up to full contact.
    #[default]
    HalfSpace,
    /// Finite deformation, as far as it was sampled and the separation falls.
    FiniteDeformation,
}

/// Corrects the curves of the half-space and writes them; returns warnings.
///
/// # Errors
/// [`StageError::Microscale`] for a macro contact that has no solution.
pub fn run(
    parameters: &Hybrid,
    micro: &Micro,
    rubber: &RubberModel,
    run: &RunView,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let surfaces = read_surfaces(run)?;
    let data =
        Data { curves: run.rows(CURVES)?, samples: run.rows(SAMPLES)?, laws: run.rows(LAW)? };
    let results: Vec<(Vec<HybridRow>, Vec<LocalRow>)> = surfaces
        .par_iter()
        .map(|surface| {
            context.check_interrupt()?;
            let own = |(own, _): &(&[Surface], Parting)| own[0].kind == surface.kind;
            let parting = partings(&surfaces, micro.rms_slope_threshold).find(own);
            let parting = parting.map_or(Parting::Shorter(0.0), |(_, parting)| parting);
            let problem = Problem { parameters, micro, rubber, surface, parting };
            one_surface(&problem, &data, context.watch.interrupted)
        })
        .collect::<Result<_, StageError>>()?;
    let (rows, locals): (Vec<_>, Vec<_>) = results.into_iter().unzip();
    let (rows, locals): (Vec<HybridRow>, Vec<LocalRow>) = (rows.concat(), locals.concat());
    context.pending.write_rows(HYBRID, &rows)?;
    context.pending.write_rows(LOCAL, &locals)?;
    let beyond = rows.iter().filter(|row| row.friction_coefficient.is_none());
    let (unsampled, beyond): (Vec<_>, Vec<_>) =
        beyond.partition(|row| row.largest_sample_mpa == 0.0);
    let needed = beyond.iter().map(|row| row.largest_pressure_mpa).fold(0.0, f64::max);
    let (count, unsampled, of) = (beyond.len(), unsampled.len(), rows.len());
    let beyond = (count > 0).then(|| {
        format!(
            "{count} of {of} values have no correction: the local pressure reaches {needed:.3} MPa, \
             outside the sampled microscale (largest_pressure_mpa and largest_sample_mpa in {HYBRID})"
        )
    });
    let unsampled = (unsampled > 0).then(|| {
        format!(
            "{unsampled} of {of} values have no correction: their microscale has no sample, micro \
             warns why"
        )
    });
    Ok(beyond.into_iter().chain(unsampled).chain(pressed_flat(&rows)).collect())
}

/// Beyond this share of the load a correction is mostly that of waves that are pressed flat.
const MUCH_BEYOND_FULL_CONTACT: f64 = 0.2;

/// A warning for every speed at which much of the load is beyond full contact of the microscale.
fn pressed_flat(rows: &[HybridRow]) -> Vec<String> {
    let mut speeds: Vec<f64> = rows.iter().map(|row| row.speed_mm_s).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let at_speed = |speed: f64| {
        let own = rows.iter().filter(|row| row.speed_mm_s == speed);
        let most =
            own.max_by(|a, b| a.load_beyond_full_contact.total_cmp(&b.load_beyond_full_contact))?;
        let share = most.load_beyond_full_contact;
        (share > MUCH_BEYOND_FULL_CONTACT).then(|| {
            format!(
                "{speed} mm/s: up to {:.0} % of the load is on points where the microscale is pressed flat, and its \
                 correction says least (contact area {}, {}; load_beyond_full_contact in {HYBRID})",
                100.0 * share,
                most.contact_area_fraction,
                most.kind
            )
        })
    };
    speeds.into_iter().filter_map(at_speed).collect()
}

/// One surface, and how it is corrected.
struct Problem<'a> {
    parameters: &'a Hybrid,
    micro: &'a Micro,
    rubber: &'a RubberModel,
    surface: &'a Surface,
    parting: Parting,
}

fn one_surface(
    problem: &Problem,
    data: &Data,
    interrupt: &Interrupt,
) -> Result<(Vec<HybridRow>, Vec<LocalRow>), StageError> {
    let Problem { micro, surface, parting, .. } = *problem;
    let scales = parting.scales(&surface.profile);
    let curves: Vec<&CurveRow> =
        data.curves.iter().filter(|row| row.curve() == surface.at(row.speed_mm_s)).collect();
    if scales.micro.is_empty() {
        return Ok((curves.into_iter().map(uncorrected).collect(), Vec::new()));
    }
    let cell = match parting {
        Parting::Steep(_) => scales.micro.iter().map(|wave| wave.wavelength).fold(0.0, f64::max),
        Parting::Shorter(limit) => f64::from(micro.stretch_length) * limit,
    };
    let macro_surface = MacroSurface::new(micro, surface, &scales.macroscale, cell);
    let (mut rows, mut locals) = (Vec::new(), Vec::new());
    for at_one_speed in curves.chunk_by(|a, b| a.speed_mm_s == b.speed_mm_s) {
        let speed_mm_s = at_one_speed[0].speed_mm_s;
        let failed = |source: SolveError| {
            let owners = surface.kind.to_string();
            source.in_stage(|source| StageError::Microscale { owners, speed_mm_s, source })
        };
        let numbers = data.stretches(surface, speed_mm_s);
        let by_stretch = numbers.iter().map(|stretch| {
            let own = data.of(surface, speed_mm_s, *stretch);
            by_one_microscale(problem, &macro_surface, at_one_speed, &own, interrupt)
        });
        let by_stretch: Vec<_> = by_stretch.collect::<Result<_, _>>().map_err(failed)?;
        if by_stretch.is_empty() {
            rows.extend(at_one_speed.iter().map(|curve| beyond(curve, 0.0, 0.0)));
        }
        let (values, of_stretches): (Vec<Vec<HybridRow>>, Vec<Vec<LocalRow>>) =
            by_stretch.into_iter().unzip();
        locals.extend(of_stretches.concat());
        rows.extend(stretches::combined(&values));
    }
    Ok((rows, locals))
}

/// The heights of a macro surface on their grid.
struct MacroSurface {
    heights: Vec<f64>,
    /// In m.
    period: f64,
    /// Period of the microscale in m.
    cell: f64,
}

impl MacroSurface {
    fn new(micro: &Micro, surface: &Surface, macroscale: &[Wave], cell: f64) -> Self {
        let (heights, period) = micro.macro_heights(surface, macroscale);
        Self { heights, period, cell }
    }
}

/// The curves of a surface at one speed, corrected by one microscale that has samples.
fn by_one_microscale(
    problem: &Problem,
    macro_surface: &MacroSurface,
    at_one_speed: &[&CurveRow],
    own: &Sampled,
    interrupt: &Interrupt,
) -> Result<(Vec<HybridRow>, Vec<LocalRow>), SolveError> {
    let Problem { parameters, rubber, .. } = *problem;
    let MacroSurface { heights, period, cell } = macro_surface;
    let (period, cell) = (*period, *cell);
    let (microscale, law, full_contact) = microscale(parameters, own)?;
    let (mut rows, mut locals) = (Vec::new(), Vec::new());
    let speed = at_one_speed[0].speed_mm_s.mm_to_m();
    let mut contact =
        SoftContact::new_interruptible(rubber, speed, period, heights, law, interrupt)?;
    for curve in at_one_speed {
        let solution = match contact.solve(curve.pressure_mpa.mpa_to_pa()) {
            Ok(solution) => solution,
            // Pressed harder than the law goes: no correction, and no end of the others.
            Err(SoftContactError::Law {
                source: LawError::BeyondSamples { pressure, largest },
                ..
            }) => {
                rows.push(beyond(curve, pressure, largest));
                continue;
            }
            Err(error) => return Err(error.into()),
        };
        let local = match parameters.local_pressures {
            LocalPressures::Points => solution.pressure.clone(),
            LocalPressures::Periods => {
                let points = cell / period * solution.pressure.len() as f64;
                running_mean(&solution.pressure, points.round() as usize)
            }
        };
        let residual = solution.residual;
        rows.push(corrected(parameters, curve, &microscale, full_contact, &local, residual));
        let stretch = own.samples[0].stretch;
        locals.extend(local_rows(curve, stretch, &microscale, &solution, period, cell));
    }
    Ok((rows, locals))
}

fn corrected(
    parameters: &Hybrid,
    curve: &CurveRow,
    microscale: &Microscale,
    full_contact: f64,
    local: &[f64],
    residual: f64,
) -> HybridRow {
    let points = local.iter().filter(|p| microscale.is_contact_point(**p)).count();
    // A pressure beyond the samples is the only error, and what the missing value says.
    let correction = microscale.correction(local).ok().flatten();
    let (rule, of_all_waves) = (parameters.correction, curve.friction_coefficient);
    let chosen = correction.map(|correction| match parameters.mean {
        MeanRule::Force => correction.force,
        MeanRule::Points => correction.points,
    });
    let gain = chosen.map_or(1.0, |friction| friction.gain(rule, of_all_waves));
    HybridRow {
        friction_coefficient: chosen.map(|friction| friction.applied(rule, of_all_waves)),
        correction_points: correction.map(|c| c.points.difference()),
        correction_force: correction.map(|c| c.force.difference()),
        correction_of_area: correction.map(|c| c.area),
        interpolation_error: curve.interpolation_error + gain * microscale.interpolation_error(),
        discretisation_error: correction
            .and_then(|c| c.discretisation_error)
            .zip(curve.discretisation_error)
            .map(|(mesh, grid)| gain * mesh + grid),
        contact_points_fraction: points as f64 / local.len() as f64,
        load_beyond_full_contact: share_beyond(local, full_contact),
        largest_pressure_mpa: local.iter().copied().fold(0.0, f64::max).pa_to_mpa(),
        largest_sample_mpa: microscale.largest_pressure().pa_to_mpa(),
        residual,
        ..uncorrected(curve)
    }
}

/// Share of the load of the local pressures at those above `full_contact`.
fn share_beyond(local: &[f64], full_contact: f64) -> f64 {
    let load: f64 = local.iter().sum();
    let beyond: f64 = local.iter().filter(|pressure| **pressure > full_contact).sum();
    if load > 0.0 { beyond / load } else { 0.0 }
}

/// No correction, because a local pressure in Pa is beyond the largest one that was sampled.
fn beyond(curve: &CurveRow, pressure: f64, largest: f64) -> HybridRow {
    HybridRow {
        friction_coefficient: None,
        correction_points: None,
        correction_force: None,
        correction_of_area: None,
        largest_pressure_mpa: pressure.pa_to_mpa(),
        largest_sample_mpa: largest.pa_to_mpa(),
        ..uncorrected(curve)
    }
}

/// Without a microscale the friction is that of the half-space.
fn uncorrected(curve: &CurveRow) -> HybridRow {
    HybridRow {
        kind: curve.kind,
        realisation: curve.realisation,
        speed_mm_s: curve.speed_mm_s,
        given: curve.given,
        contact_area_fraction: curve.contact_area_fraction,
        pressure_mpa: curve.pressure_mpa,
        friction_half_space: curve.friction_coefficient,
        friction_coefficient: Some(curve.friction_coefficient),
        correction_points: Some(0.0),
        correction_force: Some(0.0),
        correction_of_area: Some(0.0),
        interpolation_error: curve.interpolation_error,
        discretisation_error: curve.discretisation_error,
        left_out_error: curve.left_out_error,
        microscale_error: Some(0.0),
        contact_points_fraction: 0.0,
        load_beyond_full_contact: 0.0,
        largest_pressure_mpa: 0.0,
        largest_sample_mpa: 0.0,
        residual: 0.0,
    }
}

/// The cells, one period of the microscale each, whose mean pressure was sampled.
fn local_rows(
    curve: &CurveRow,
    stretch: u32,
    microscale: &Microscale,
    solution: &SoftContactSolution,
    period: f64,
    cell: f64,
) -> Vec<LocalRow> {
    let cells = (period / cell).round() as usize;
    let points = solution.pressure.len();
    (0..cells)
        .filter_map(|k| {
            let range = k * points / cells..((k + 1) * points / cells).max(k * points / cells + 1);
            let count = range.len() as f64;
            let pressure = solution.pressure[range].iter().sum::<f64>() / count;
            let (half_space, finite) = microscale.friction(pressure)?;
            Some(LocalRow {
                kind: curve.kind,
                realisation: curve.realisation,
                stretch,
                speed_mm_s: curve.speed_mm_s,
                given: curve.given,
                contact_area_fraction: curve.contact_area_fraction,
                x_mm: ((k as f64 + 0.5) * cell).m_to_mm(),
                pressure_mpa: pressure.pa_to_mpa(),
                friction_finite_deformation: finite,
                friction_half_space: half_space,
                correction: finite - half_space,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::bem::Given;
    use crate::stages::realise::SurfaceKind;

    #[test]
    fn the_share_of_the_load_beyond_full_contact_is_weighted_by_pressure_and_warned_of() {
        assert_eq!(share_beyond(&[0.0, 1.0, 2.0, 5.0], 2.0), 0.625);
        assert_eq!(share_beyond(&[0.0, 0.0], 2.0), 0.0);
        let row = |speed_mm_s, load_beyond_full_contact| {
            let curve = CurveRow {
                kind: SurfaceKind::sines(8),
                realisation: 1,
                speed_mm_s,
                given: Given::Area,
                contact_area_fraction: 0.05,
                pressure_mpa: 1.0,
                friction_coefficient: 0.5,
                interpolation_error: 0.0,
                discretisation_error: None,
                left_out_error: 0.0,
                relative_area_error: None,
            };
            HybridRow { load_beyond_full_contact, ..uncorrected(&curve) }
        };
        let warnings = pressed_flat(&[row(10.0, 0.1), row(50.0, 0.05), row(10.0, 0.42)]);
        assert_eq!(warnings.len(), 1);
        assert!(warnings[0].starts_with("10 mm/s: up to 42 % of the load"), "{}", warnings[0]);
    }
}
