//! bem: sliding contact of the viscoelastic half-space, for every realisation and speed.
//!
//! | module | what it holds |
//! |---|---|
//! | `attainable` | whether the realisations that may be drawn can have the accuracy that is asked for, before grids are refined to it |
//! | `curve` | one curve of friction over contact area: one surface at one speed |
//! | `ensemble` | the curves of one approximation at one speed, of as many realisations as their average needs |
//! | `reduction` | waves that matter less than the accuracy that is asked for are left out, and what that changes is bounded |
//! | `rows` | what the stage writes |
//! | `scans` | what the choice of scans does to friction of sines |
//! | `speeds` | sliding speeds of a recipe: a list, or a range |
//! | `task` | one curve as a task of a sweep, which any machine can solve |
//! | `wanted` | contact areas and pressures at which a recipe asks for friction |
//! | `work` | the curves of all ensembles: those that are missing, solved side by side |

mod attainable;
mod curve;
mod ensemble;
mod reduction;
mod rows;
mod scans;
mod speeds;
mod task;
mod wanted;
mod work;
mod worth;

use super::contract::{Context, Contract, Inputs, Planned, Request};
use super::realise::{Surface, read_surfaces};
use super::{Stage, StageError, Watch};
use crate::artifact::{ArrayDataset, Pending, RunView, SolveStore, Storage};
use crate::contact::refine::{SHARES, SHARES_IN_WORDS, TOLERANCES, TOLERANCES_IN_WORDS};
use crate::requirement::{InvalidRecipe, require};
use crate::rubber::{FrequencyRange, RubberData, RubberModel, read_rubber_at};
use crate::units::Units;
pub(crate) use attainable::require_attainable;
use curve::FieldSolution;
pub(crate) use curve::{Curve, GridRule, solved};
pub(crate) use ensemble::FIRST_REALISATIONS;
use ensemble::{CurveResult, Ensemble};
pub use rows::{
    CURVES, CurveRow, FIELDS, REALISATIONS, RealisationsRow, SOLVES, SolveRow, fields_schema,
    schemas,
};
pub use scans::{SCAN_ERRORS, ScanErrorRow, Scans};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
pub(crate) use speeds::{Speeds, deserialize_some as some_speeds};
use std::path::{Path, PathBuf};
pub use task::Task;
pub use wanted::{Given, Wanted};
use work::Work;
pub(crate) use worth::{NEGLIGIBLE, Worth};

/// Revision of this stage: raised when the same parameters give other numbers.
pub const REVISION: u32 = 7;

/// The stage.
pub const STAGE: Stage = Stage(&CONTRACT);

static CONTRACT: Contract = Contract {
    name: "bem",
    summary: "Sliding contact of the half-space",
    revision: REVISION,
    schemas,
    plan,
};

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    let bem = request.chain()?.bem;
    let material = &request.material;
    let run = move |inputs: &Inputs, context: &mut Context| {
        run(bem, material, &inputs.results, &inputs.store()?, context)
    };
    let chain = request.chain()?;
    let scans = chain.has_lines() && bem.estimate_scan_error;
    let windows = bem.average_tolerance.is_some() && chain.realise.has_windows();
    Some(
        Planned::new(bem.resolved(material), run)
            .reading(super::realise::SURFACES)
            .reading_if(scans, super::approximate::REPLICATES)
            .reading_if(windows, super::realise::PROFILES),
    )
}

pub(crate) const SPEEDS: &str = "one speed or more from 1e-9 to 1e9 mm/s, without repeats";

/// Section `[bem]` of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bem {
    /// Rubber file. Left out beside `sweep.rubbers`.
    #[serde(default, skip_serializing_if = "is_no_path", with = "crate::files::name::path")]
    #[schemars(with = "String")]
    pub rubber: PathBuf,
    /// Temperature in °C to which the rubber is shifted; its file needs a `[temperature]` section.
    /// Not set: the moduli as they stand in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature_c: Option<f64>,
    /// Sliding speeds in mm/s: a list, or a range such as `{ from = 0.001, to = 10000, per_decade = 3 }`.
    #[serde(deserialize_with = "speeds::deserialize")]
    #[schemars(with = "speeds::Speeds")]
    pub speeds_mm_s: Vec<f64>,
    /// Contact area fractions at which friction is wanted, ascending; empty where pressures are given in their place.
    #[serde(default = "published_area_fractions")]
    pub area_fractions: Vec<f64>,
    /// Mean pressures in MPa at which friction is wanted, ascending, beside or in place of contact areas: the load over
    /// the area that it is spread on, which a friction tester knows.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pressures_mpa: Vec<f64>,
    /// Relative accuracy of friction by interpolation between solved pressures; 1e-3 by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Relative accuracy of friction by the grid: every pressure is solved on doubled grids until their
    /// differences show it. Not set: one grid for all, as the next two keys say, whose error is
    /// estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid_tolerance: Option<f64>,
    /// Relative accuracy of the averages over the realisations, with all errors: realisations are solved
    /// until their averages have it or there are no more, and waves that matter less are left out of most of
    /// them. Not set: all realisations, with all waves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub average_tolerance: Option<f64>,
    /// Grid points per shortest wavelength, at least; the grid is the next power of two.
    #[serde(default = "default_points")]
    pub points_per_shortest_wavelength: u32,
    /// A contact of fewer grid points than this is solved again on twice as many, up to 16 times
    /// as many: small contacts are a few points on a grid that suits large ones.
    #[serde(default = "default_contact_points")]
    pub fewest_contact_points: u32,
    /// Whether sines are solved with the amplitudes of parts of the scans too, for the error of friction by the choice of
    /// scans: up to twenty curves more for each number of waves and speed.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub estimate_scan_error: bool,
    /// Contact area fractions at which pressure and separation are kept as fields; none by
    /// default.
    #[serde(default)]
    pub field_area_fractions: Vec<f64>,
}

fn yes() -> bool {
    true
}

// The signature is that of serde.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_yes(flag: &bool) -> bool {
    *flag
}

fn is_no_path(path: &Path) -> bool {
    path == Path::new("")
}

fn published_area_fractions() -> Vec<f64> {
    vec![0.002, 0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1]
}

fn default_points() -> u32 {
    64
}

fn default_contact_points() -> u32 {
    100
}

/// Speeds that a recipe may ask for: from below any creep to above any vehicle, and well inside the
/// range of floating-point numbers.
pub(crate) const SPEEDS_MM_S: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

impl Bem {
    pub(crate) fn check(&self) -> Result<(), InvalidRecipe> {
        let speeds = &self.speeds_mm_s;
        let possible = speeds.iter().all(|v| SPEEDS_MM_S.contains(v));
        let valid = !speeds.is_empty() && possible && no_repeats(speeds);
        require(valid, "bem.speeds_mm_s", speeds, SPEEDS)?;
        self.check_wanted()?;
        let tolerances = [
            ("bem.tolerance", Some(self.interpolation_tolerance())),
            ("bem.grid_tolerance", self.grid_tolerance),
        ];
        for (key, tolerance) in tolerances.into_iter().filter_map(|(key, t)| Some((key, t?))) {
            require(SHARES.contains(&tolerance), key, tolerance, SHARES_IN_WORDS)?;
        }
        if let Some(tolerance) = self.average_tolerance {
            let key = "bem.average_tolerance";
            require(TOLERANCES.contains(&tolerance), key, tolerance, TOLERANCES_IN_WORDS)?;
        }
        let points = self.points_per_shortest_wavelength;
        let key = "bem.points_per_shortest_wavelength";
        require((4..=65536).contains(&points), key, points, "4 to 65536")
    }

    /// Relative accuracy of friction by interpolation.
    pub fn interpolation_tolerance(&self) -> f64 {
        self.tolerance.unwrap_or(1e-3)
    }

    /// The parameters with the rubber itself in place of its file: what the results depend on. The
    /// measured frequencies and temperatures, if there are any, decide on warnings.
    pub fn resolved(&self, material: &RubberData) -> Value {
        let mut value = json!(self);
        value["rubber"] = json!(material.rubber);
        if let Some(measured) = material.measured {
            value["measured"] = json!(measured);
        }
        if let Some(measured_c) = material.temperature.as_ref().and_then(|law| law.measured_c) {
            value["measured_c"] = json!(measured_c);
        }
        value
    }
}

pub(crate) fn no_repeats<T: PartialEq>(values: &[T]) -> bool {
    values.iter().enumerate().all(|(i, a)| values[..i].iter().all(|b| a != b))
}

/// Reads the rubber of a recipe, at its temperature if it has one.
///
/// # Errors
/// [`StageError::Rubber`].
pub fn rubber(parameters: &Bem) -> Result<RubberData, StageError> {
    Ok(read_rubber_at(&parameters.rubber, parameters.temperature_c)?)
}

/// Solves the contacts that are not in the store and writes the results; returns warnings where
/// the rubber looks like a mistake or was not measured at its temperature or at the frequencies that the surfaces excite.
///
/// Realisations and speeds run side by side; each curve is computed by itself, and how many there are
/// follows from the curves, so the numbers do not depend on the number of threads.
///
/// # Errors
/// [`StageError::Contact`] for a curve that cannot be had, the one that failed first in time;
/// [`StageError::TooFewRealisations`]; [`StageError::Interrupted`]. Solves that are done are kept in the store.
pub fn run(
    parameters: &Bem,
    material: &RubberData,
    run: &RunView,
    store: &SolveStore,
    context: &mut Context,
) -> Result<Vec<String>, StageError> {
    let surfaces = read_surfaces(run)?;
    require_for_all(parameters, &material.rubber, &surfaces, store, context.watch)?;
    let work = Work::new(parameters, &material.rubber, store, context.watch);
    let scans = Scans::read(parameters, &surfaces, run)?;
    let errors = scans::errors(parameters, &scans, &work)?;
    let mut ensembles = ensembles(parameters, &surfaces, &scans, &errors);
    work.solve_all(&mut ensembles)?;
    write(&mut context.pending, &ensembles)?;
    context.pending.write_rows(SCAN_ERRORS, &errors)?;
    let mut warnings = material.oddities();
    if surfaces.is_empty() && !parameters.field_area_fractions.is_empty() {
        warnings.push(
            "bem.field_area_fractions does nothing: there is no profile; fields of areal surfaces are those of \
             areal.field_area_fractions"
                .into(),
        );
    }
    warnings.extend(material.extrapolations(excited(parameters, &surfaces)));
    Ok(warnings)
}

/// The tasks of a run that are next and that a packed store does not have: all realisations, or those that
/// an accuracy of the average needs as far as it is known yet.
///
/// # Errors
/// As [`run`].
pub fn missing(
    parameters: &Bem,
    rubber: &RubberModel,
    surfaces: &[Surface],
    scans: &Scans,
    store: &SolveStore,
    watch: Watch,
) -> Result<Vec<Task>, StageError> {
    require_for_all(parameters, rubber, surfaces, store, watch)?;
    let work = Work::new(parameters, rubber, store, watch);
    let mut missing = scans::missing(parameters, rubber, scans, store)?;
    // What the scans are worth decides on more than the first realisations.
    let known = missing.is_empty();
    let decides = known && parameters.average_tolerance.is_some();
    let errors = if decides { scans::errors(parameters, scans, &work)? } else { Vec::new() };
    let mut ensembles = ensembles(parameters, surfaces, scans, &errors);
    if known {
        missing.extend(work.missing(&mut ensembles)?);
    } else {
        missing.extend(work.missing_of_open(&ensembles)?);
    }
    Ok(missing)
}

/// [`require_attainable`] of the realisations that there are of every approximation.
fn require_for_all(
    parameters: &Bem,
    rubber: &RubberModel,
    surfaces: &[Surface],
    store: &SolveStore,
    watch: Watch,
) -> Result<(), StageError> {
    let of_each = surfaces.chunk_by(|a, b| a.kind == b.kind);
    let drawn = |of_one: &&[Surface]| {
        of_one.len() > FIRST_REALISATIONS && !of_one[0].kind.method.is_measured()
    };
    for of_one in of_each.filter(drawn) {
        require_attainable(parameters, rubber, of_one, of_one.len(), store, watch)?;
    }
    Ok(())
}

fn ensembles<'a>(
    parameters: &Bem,
    surfaces: &'a [Surface],
    scans: &Scans,
    errors: &[ScanErrorRow],
) -> Vec<Ensemble<'a>> {
    let tolerance = parameters.average_tolerance;
    surfaces
        .chunk_by(|a, b| a.kind == b.kind)
        .flat_map(|of_one| {
            let speeds = parameters.speeds_mm_s.iter();
            speeds.map(move |speed| {
                let worth = scans.worth(of_one[0].kind, *speed, errors);
                Ensemble::new(of_one, *speed, tolerance, worth)
            })
        })
        .collect()
}

/// The frequencies that the waves of all surfaces excite at all speeds.
fn excited(parameters: &Bem, surfaces: &[Surface]) -> Option<FrequencyRange> {
    let waves = surfaces.iter().flat_map(|surface| &surface.profile);
    let wavelengths = waves.filter(|wave| wave.amplitude != 0.0).map(|wave| wave.wavelength);
    let speeds = parameters.speeds_mm_s.iter().map(|speed| speed.mm_to_m());
    FrequencyRange::excited(wavelengths, speeds)
}

/// Writes the results by number of waves, realisation and speed.
fn write(pending: &mut Pending, ensembles: &[Ensemble]) -> Result<(), StageError> {
    let mut results: Vec<&CurveResult> = Vec::new();
    for of_one in ensembles.chunk_by(|a, b| std::ptr::eq(a.surfaces, b.surfaces)) {
        let most = of_one.iter().map(|ensemble| ensemble.results.len()).max().unwrap_or(0);
        for k in 0..most {
            results.extend(of_one.iter().filter_map(|ensemble| ensemble.results.get(k)));
        }
    }
    let solves: Vec<_> = results.iter().flat_map(|r| r.solves.iter().cloned()).collect();
    pending.write_rows(SOLVES, &solves)?;
    let values: Vec<_> = results.iter().flat_map(|r| r.values.iter().cloned()).collect();
    pending.write_rows(CURVES, &values)?;
    let counts: Vec<_> = ensembles.iter().filter_map(realisations_row).collect();
    pending.write_rows(REALISATIONS, &counts)?;
    let fields: Vec<ArrayDataset> =
        results.iter().flat_map(|r| r.fields.iter().flat_map(FieldSolution::datasets)).collect();
    if !fields.is_empty() {
        pending.write_arrays(FIELDS, Storage::Compressed, &fields)?;
    }
    Ok(())
}

fn realisations_row(ensemble: &Ensemble) -> Option<RealisationsRow> {
    let surface = ensemble.surfaces.first()?;
    let left_out =
        ensemble.left_out.wavelengths(surface).iter().map(|metre| metre.m_to_mm()).collect();
    Some(RealisationsRow {
        kind: surface.kind,
        speed_mm_s: ensemble.speed_mm_s,
        realisations: ensemble.results.len() as u32,
        with_all_waves: ensemble.with_all_waves.min(ensemble.results.len()) as u32,
        left_out_wavelengths_mm: left_out,
    })
}
