//! What a recipe will compute, on which models and grids, and what that costs, before it runs.
//!
//! The stages before the contact are cheap and are run for it, and so is the half-space of one
//! realisation, in a folder that is removed again: areas, pressures, grids and seconds of the others
//! follow from this one. Finite elements are too dear to try; their cost is that of the main job,
//! scaled ([`micro`]).

pub mod micro;
mod scales;

pub use micro::MicroForecast;
pub use scales::{ScaleForecast, ScaleModel};

use crate::artifact::{ArtifactError, RunView};
use crate::pipeline::{self, PipelineError, Selection};
use crate::recipe::{Recipe, Violation, Work};
use crate::rubber::Rubber;
use crate::stages::bem::{CURVES_FILE, CurveRow, SOLVES_FILE, SolveRow};
use crate::stages::realise::{Surface, read_surfaces};
use crate::stages::{Stage, StageError};
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Bytes for a grid point of a contact, with its coarser grids and the vectors of the iteration, as
/// measured on a solve of 2^20 points with its error estimate.
const BYTES_PER_POINT: f64 = 250.0;
/// Memory of the program before any contact.
const BASE_MEGABYTES: f64 = 40.0;

/// Why there is no forecast.
#[derive(Debug, thiserror::Error)]
pub enum ForecastError {
    /// The trial run.
    #[error(transparent)]
    Pipeline(#[from] PipelineError),
    /// Its results.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// Its folder.
    #[error(transparent)]
    Artifact(#[from] ArtifactError),
    /// The temporary folder.
    #[error("the folder for a trial run cannot be made: {0}")]
    Folder(std::io::Error),
    /// The recipe.
    #[error(transparent)]
    Recipe(#[from] Violation),
    /// The study of one sine wave has no scales to choose models for.
    #[error("[sinusoid] solves what it lists, with the models it lists: there is nothing to plan")]
    Sinusoid,
}

/// The half-space curves of one approximation at one speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurveForecast {
    /// Number of waves of the approximation.
    pub waves: u32,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// Mean pressures at the smallest and the largest wanted area in MPa.
    pub pressures_mpa: [f64; 2],
    /// Grid points of the coarsest and the finest solve that a value rests on.
    pub grid_points: [u64; 2],
    /// Pressures solved for one realisation.
    pub solves: usize,
    /// What each scale gets.
    pub scales: Vec<ScaleForecast>,
}

/// A stage that a run would compute.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageForecast {
    /// The stage.
    pub stage: Stage,
    /// Expected wall time in s; none where it cannot be told.
    pub seconds: Option<f64>,
}

/// What a recipe will compute.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Forecast {
    /// Half-space curves.
    pub curves: Vec<CurveForecast>,
    /// Microscales at finite deformation.
    pub micro: Vec<MicroForecast>,
    /// All stages in their order.
    pub stages: Vec<StageForecast>,
    /// Expected largest memory in MB.
    pub megabytes: f64,
}

/// Runs a trial of the recipe with one realisation on the half-space, and tells from it.
///
/// # Errors
/// [`ForecastError`]; those of the trial are those that the run would have.
pub fn forecast(
    recipe: &Recipe,
    threads: usize,
    interrupted: &AtomicBool,
) -> Result<Forecast, ForecastError> {
    let chain = match recipe.work()? {
        Work::Chain(chain) => chain,
        Work::Sinusoid(_) => return Err(ForecastError::Sinusoid),
    };
    let folder = tempfile::tempdir().map_err(ForecastError::Folder)?;
    let trial = one_realisation(recipe);
    let (mut stages, mut bem_seconds) = (Vec::new(), 0.0);
    for (stage, _) in pipeline::status(&trial, folder.path())? {
        if stage == Stage::Tables {
            continue;
        }
        let seconds = computed(&trial, folder.path(), stage, interrupted)?;
        if stage == Stage::Bem {
            bem_seconds = seconds;
        } else {
            stages.push(StageForecast { stage, seconds: Some(seconds) });
        }
    }
    let view = RunView::of(folder.path());
    let surfaces = read_surfaces(&view)?;
    let rubber = crate::stages::bem::rubber(chain.bem)?;
    let (curve_rows, _) = view.read_table::<CurveRow>("bem", CURVES_FILE)?;
    let (solve_rows, _) = view.read_table::<SolveRow>("bem", SOLVES_FILE)?;
    let threshold = chain.micro.map(|micro| micro.rms_slope_threshold);
    let curves = curves(&rubber, &surfaces, &curve_rows, &solve_rows, threshold);

    // The trial has a task for each curve; more realisations first fill threads that it left idle.
    let (tasks, realisations) = (curves.len() as f64, f64::from(chain.realise.realisations));
    let idle = (tasks / threads as f64).min(1.0);
    let half_space = bem_seconds * (realisations * idle).max(1.0);
    stages.push(StageForecast { stage: Stage::Bem, seconds: Some(half_space) });
    let mut microscales = Vec::new();
    if let Some(parameters) = chain.micro {
        microscales =
            micro::microscales(parameters, &rubber, &surfaces, &curve_rows, realisations)?;
        let seconds = micro::seconds(&microscales, threads);
        stages.push(StageForecast { stage: Stage::Micro, seconds: Some(seconds) });
        // The macro surfaces under the local law: one contact, on a coarser grid, for each value of the
        // table, a fifth of the half-space in the main job.
        stages.push(StageForecast { stage: Stage::Hybrid, seconds: Some(0.2 * half_space) });
    }
    if chain.fem.is_some() {
        stages.push(StageForecast { stage: Stage::Fem, seconds: None });
    }
    stages.push(StageForecast { stage: Stage::Tables, seconds: Some(0.0) });
    let most = curves.iter().map(|curve| curve.grid_points[1]).max().unwrap_or(0);
    // Each thread keeps the contacts of a curve on all of its grids: twice the finest one.
    let points = 2.0 * most as f64 * threads as f64;
    let megabytes = BASE_MEGABYTES + BYTES_PER_POINT * points / 1e6;
    Ok(Forecast { curves, micro: microscales, stages, megabytes })
}

/// The recipe without what is dear.
fn one_realisation(recipe: &Recipe) -> Recipe {
    let mut trial = recipe.clone();
    (trial.micro, trial.hybrid, trial.fem) = (None, None, None);
    (trial.tables.published, trial.tables.theories) = (Vec::new(), Vec::new());
    if let Some(realise) = &mut trial.realise {
        realise.realisations = 1;
    }
    if let Some(bem) = &mut trial.bem {
        bem.field_area_fractions.clear();
    }
    trial
}

/// Computes a stage and returns the seconds it took.
fn computed(
    recipe: &Recipe,
    out: &Path,
    stage: Stage,
    interrupted: &AtomicBool,
) -> Result<f64, ForecastError> {
    let selection = Selection { only: Some(stage), ..Selection::default() };
    pipeline::run(recipe, out, selection, interrupted, &|_| ())?;
    let manifest = RunView::of(out).stage_manifest(stage.name())?;
    Ok(manifest.map_or(0.0, |manifest| manifest.seconds))
}

fn curves(
    rubber: &Rubber,
    surfaces: &[Surface],
    curves: &[CurveRow],
    solves: &[SolveRow],
    threshold: Option<f64>,
) -> Vec<CurveForecast> {
    let same = |a: &CurveRow, b: &CurveRow| (a.waves, a.speed_mm_s) == (b.waves, b.speed_mm_s);
    let of_one = |rows: &[CurveRow]| {
        let (first, last) = (&rows[0], &rows[rows.len() - 1]);
        let (waves, speed_mm_s) = (first.waves, first.speed_mm_s);
        let own = || solves.iter().filter(|row| (row.waves, row.speed_mm_s) == (waves, speed_mm_s));
        let points = || own().map(|row| row.grid_points);
        let profile = surfaces.iter().find(|s| s.waves == waves).map_or(&[][..], |s| &s.profile);
        let contact = [last.pressure_mpa * 1e6, last.contact_area_fraction];
        CurveForecast {
            waves,
            speed_mm_s,
            pressures_mpa: [first.pressure_mpa, last.pressure_mpa],
            grid_points: [points().min().unwrap_or(0), points().max().unwrap_or(0)],
            solves: own().count(),
            scales: scales::scales(rubber, profile, speed_mm_s / 1e3, contact, threshold),
        }
    };
    curves.chunk_by(same).map(of_one).collect()
}
