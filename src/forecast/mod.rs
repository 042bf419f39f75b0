//! What a recipe will compute, on which models and grids, and what that costs, before it runs.
//!
//! The stages before the contact are cheap and are run for it, and so is the half-space of one
//! realisation, in a folder that is removed again: areas, pressures, grids and seconds of the others
//! follow from this one. Where an accuracy of the average is asked for it is eight, whose spread tells how
//! many more are needed. Finite elements are too dear to try; their cost is that of the main job,
//! scaled ([`micro`]).
//!
//! | module | what it holds |
//! |---|---|
//! | `fem` | what all waves at finite deformation will ask for |
//! | `micro` | what the microscales will ask of the finite elements |
//! | `multilevel` | how many realisations the stage multilevel will solve with finite elements, and what they cost |
//! | `scales` | which model each scale of a surface gets, and why |

mod fem;
pub mod micro;
mod multilevel;
mod scales;

pub use fem::FemForecast;
pub use micro::MicroForecast;
pub use multilevel::MultilevelForecast;
pub use scales::{ScaleForecast, ScaleModel};

use crate::artifact::{ArtifactError, RunView, SolveStore};
use crate::contact::areal::memory_bytes;
use crate::error_kind::{ErrorKind, HasKind};
use crate::numerics::Interrupt;
use crate::pipeline::{self, PipelineError, Selection};
use crate::recipe::Recipe;
use crate::requirement::InvalidRecipe;
use crate::rubber::RubberModel;
use crate::stages;
use crate::stages::areal;
use crate::stages::bem::{self, CURVES, CurveRow, FIRST_REALISATIONS, SOLVES, SolveRow, Worth};
use crate::stages::feedback::{self, Feedback};
use crate::stages::ingest::{read_maps, read_windows};
use crate::stages::methods::{self, Methods};
use crate::stages::micro::Parting;
use crate::stages::realise::SurfaceKind;
use crate::stages::realise::{Surface, read_areal_surfaces, read_surfaces};
use crate::stages::{Chain, Job};
use crate::stages::{Stage, StageError, Watch};
use crate::units::Units;
use serde::Serialize;
use std::path::Path;

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
    #[error(
        "cannot make a temporary folder for a trial run: {0}; set TMPDIR to a folder that you may write to"
    )]
    Folder(std::io::Error),
    /// The recipe.
    #[error(transparent)]
    Recipe(#[from] InvalidRecipe),
    /// The study of one sine wave has no scales to choose models for.
    #[error("[sinusoid] solves what it lists, with the models it lists: there is nothing to plan")]
    Sinusoid,
}

impl HasKind for ForecastError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Pipeline(source) => source.kind(),
            Self::Stage(source) => source.kind(),
            Self::Artifact(source) => source.kind(),
            Self::Folder(_) => ErrorKind::Failure,
            Self::Recipe(source) => source.kind(),
            Self::Sinusoid => ErrorKind::Input,
        }
    }
}

/// The half-space curves of one approximation at one speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurveForecast {
    /// Which surfaces.
    #[serde(flatten)]
    pub kind: SurfaceKind,
    /// Sliding speed in mm/s.
    pub speed_mm_s: f64,
    /// Realisations: those of the recipe, or what an accuracy of the average is expected to take.
    pub realisations: u32,
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
    /// Curves with all waves at finite deformation.
    pub fem: Vec<FemForecast>,
    /// Realisations solved under both models.
    pub multilevel: Vec<MultilevelForecast>,
    /// All stages in their order.
    pub stages: Vec<StageForecast>,
    /// Expected largest memory in MB.
    pub megabytes: f64,
}

/// Runs a trial of the recipe on the half-space, with one realisation or those that tell how many are
/// needed, and tells from it.
///
/// # Errors
/// [`ForecastError`]; those of the trial are those that the run would have.
pub fn forecast(
    recipe: &Recipe,
    threads: usize,
    interrupted: &Interrupt,
) -> Result<Forecast, ForecastError> {
    let chain = match recipe.job()? {
        Job::Chain(chain) => chain,
        Job::Sinusoid(_) => return Err(ForecastError::Sinusoid),
    };
    let folder = tempfile::tempdir().map_err(ForecastError::Folder)?;
    let (mut stages, bem_seconds) = run_trial(recipe, folder.path(), interrupted)?;
    let trial = Trial::read(&RunView::of(folder.path()), &chain)?;
    let curves = trial.curves(&chain);

    // Curves that the trial could not run side by side first fill the threads that it left idle.
    let tried = trial.count() as f64;
    let total: f64 = curves.iter().map(|curve| f64::from(curve.realisations)).sum();
    let busy = (tried / threads as f64).min(1.0);
    let half_space = bem_seconds * (total / tried * busy).max(1.0);
    stages.push(StageForecast { stage: stages::bem::STAGE, seconds: Some(half_space) });
    let mut areal_megabytes = 0.0;
    if chain.has_areal_surfaces() {
        let (seconds, megabytes) = areal(&chain, &RunView::of(folder.path()), threads)?;
        stages.push(StageForecast { stage: stages::areal::STAGE, seconds: Some(seconds) });
        areal_megabytes = megabytes;
    }
    if let Some(section) = chain.feedback {
        let seconds = trial.feedback(section, &chain) / threads as f64;
        stages.push(StageForecast { stage: stages::feedback::STAGE, seconds: Some(seconds) });
    }
    let mut microscales = Vec::new();
    if let Some(parameters) = chain.micro {
        microscales = micro::microscales(parameters, &trial, &curves, interrupted)?;
        let seconds = micro::seconds(&microscales, threads);
        stages.push(StageForecast { stage: stages::micro::STAGE, seconds: Some(seconds) });
        // The macro surfaces under the local law: one contact, on a coarser grid, for each value of the
        // table, a fifth of the half-space in the main job.
        stages
            .push(StageForecast { stage: stages::hybrid::STAGE, seconds: Some(0.2 * half_space) });
    }
    let mut all_waves = Vec::new();
    if let Some(parameters) = chain.fem {
        all_waves = fem::curves(parameters, &chain, &trial, &curves);
        let seconds = fem::seconds(&all_waves, threads);
        stages.push(StageForecast { stage: stages::fem::STAGE, seconds: Some(seconds) });
    }
    let mut pairs = Vec::new();
    if let Some(parameters) = chain.multilevel {
        pairs = multilevel::pairs(parameters, &chain, &trial, &curves);
        let seconds = multilevel::seconds(&pairs, threads);
        stages.push(StageForecast { stage: stages::multilevel::STAGE, seconds: Some(seconds) });
    }
    stages.push(StageForecast { stage: stages::tables::STAGE, seconds: Some(0.0) });
    if let Some(section) = chain.methods {
        let seconds = trial.methods(section, &chain) / threads as f64;
        stages.push(StageForecast { stage: stages::methods::STAGE, seconds: Some(seconds) });
    }
    let most = curves.iter().map(|curve| curve.grid_points[1]).max().unwrap_or(0);
    // Each thread keeps the contacts of a curve on all of its grids: twice the finest one.
    let points = 2.0 * most as f64 * threads as f64;
    let half_space = (BYTES_PER_POINT * points).bytes_to_megabytes();
    let blocks = all_waves.iter().map(|curve| curve.megabytes_each).fold(0.0, f64::max);
    let megabytes = BASE_MEGABYTES + half_space.max(blocks * threads as f64).max(areal_megabytes);
    Ok(Forecast {
        curves,
        micro: microscales,
        fem: all_waves,
        multilevel: pairs,
        stages,
        megabytes,
    })
}

/// Computes all stages up to the half-space in a folder; returns the seconds of those before it, and
/// of it.
fn run_trial(
    recipe: &Recipe,
    folder: &Path,
    interrupted: &Interrupt,
) -> Result<(Vec<StageForecast>, f64), ForecastError> {
    let trial = shortened(recipe);
    let (mut stages, mut bem_seconds) = (Vec::new(), 0.0);
    for (stage, _) in pipeline::status(&trial, folder)? {
        if [stages::tables::STAGE, stages::areal::STAGE].contains(&stage) {
            continue;
        }
        if stage == stages::bem::STAGE {
            require_attainable(recipe, folder, interrupted)?;
        }
        let seconds = computed(&trial, folder, stage, interrupted)?;
        if stage == stages::bem::STAGE {
            bem_seconds = seconds;
        } else {
            stages.push(StageForecast { stage, seconds: Some(seconds) });
        }
    }
    Ok((stages, bem_seconds))
}

/// Refuses an accuracy that the realisations of the recipe are far from giving: the trial has the first
/// of them alone, which would be refined to it.
fn require_attainable(
    recipe: &Recipe,
    folder: &Path,
    interrupted: &Interrupt,
) -> Result<(), ForecastError> {
    let (Some(parameters), Some(realise)) = (&recipe.bem, &recipe.realise) else { return Ok(()) };
    let view = RunView::of(folder);
    let surfaces = read_surfaces(&view)?;
    let rubber = bem::rubber(parameters)?.rubber;
    let store = SolveStore::open(folder.join("trial"))?;
    let watch = Watch { progress: &|_, _| (), interrupted };
    let most = realise.drawn() as usize;
    Ok(bem::require_attainable(parameters, &rubber, &surfaces, most, &store, watch)?)
}

/// The recipe without what is dear.
fn shortened(recipe: &Recipe) -> Recipe {
    let mut trial = recipe.clone();
    (trial.micro, trial.hybrid, trial.fem, trial.multilevel) = (None, None, None, None);
    (trial.feedback, trial.methods) = (None, None);
    (trial.tables.published, trial.tables.theories) = (Vec::new(), Vec::new());
    let averaged = trial.bem.as_ref().is_some_and(|bem| bem.average_tolerance.is_some());
    if let Some(realise) = &mut trial.realise {
        let count = if averaged { realise.drawn().min(FIRST_REALISATIONS as u32) } else { 1 };
        realise.realisations = Some(count);
        realise.most_windows = Some(1);
        realise.areal_realisations = realise.areal_realisations.map(|_| 1);
        realise.most_realisations = averaged.then_some(count);
    }
    if let Some(bem) = &mut trial.bem {
        bem.field_area_fractions.clear();
        bem.estimate_scan_error = false;
    }
    trial
}

/// Expected wall time in s and memory in MB of the areal surfaces, from the grids of those of the first window.
fn areal(chain: &Chain, view: &RunView, threads: usize) -> Result<(f64, f64), ForecastError> {
    let sweep = areal::Sweep { areal: chain.areal.clone(), wanted: chain.bem.wanted() };
    let surfaces = read_areal_surfaces(view)?;
    areal::require_memory(chain.areal, &surfaces)?;
    let maps = if chain.has_maps() { read_maps(view)?.len().min(most_windows(chain)) } else { 0 };
    let curves = (chain.bem.speeds_mm_s.len() * chain.areal.angles_deg.len()) as f64;
    let (mut seconds, mut megabytes) = (0.0, 0.0_f64);
    for first in surfaces.iter().filter(|surface| surface.realisation == 1) {
        let measured = first.kind.method.is_measured();
        let count = if measured { maps } else { chain.realise.areal_drawn() as usize };
        let points = chain.areal.grid(first);
        seconds += count as f64 * curves * sweep.seconds(points) / threads as f64;
        let bytes = memory_bytes(points[0], points[1]) as f64 * threads as f64;
        megabytes = megabytes.max(bytes.bytes_to_megabytes());
    }
    Ok((seconds, megabytes))
}

fn most_windows(chain: &Chain) -> usize {
    chain.realise.most_windows.map_or(usize::MAX, |most| most as usize)
}

/// What the trial gave.
struct Trial {
    rubber: RubberModel,
    surfaces: Vec<Surface>,
    curves: Vec<CurveRow>,
    solves: Vec<SolveRow>,
    /// Windows that the run will have.
    windows: u32,
}

impl Trial {
    fn read(view: &RunView, chain: &Chain) -> Result<Self, ForecastError> {
        let windows =
            if chain.realise.has_windows() { read_windows(view)?.len() as u32 } else { 0 };
        let windows = windows.min(chain.realise.most_windows.unwrap_or(u32::MAX));
        Ok(Self {
            rubber: bem::rubber(chain.bem)?.rubber,
            surfaces: read_surfaces(view)?,
            curves: view.rows(CURVES)?,
            solves: view.rows(SOLVES)?,
            windows,
        })
    }

    /// Number of curves.
    fn count(&self) -> usize {
        self.by_curve().count()
    }

    fn by_curve(&self) -> impl Iterator<Item = &[CurveRow]> {
        self.curves.chunk_by(CurveRow::same_curve)
    }

    /// The curves of the first realisation.
    fn first_curves(&self) -> impl Iterator<Item = &[CurveRow]> {
        self.by_curve().filter(|curve| curve[0].realisation == 1)
    }

    /// The first realisation of each approximation.
    fn first_surfaces(&self) -> impl Iterator<Item = &Surface> {
        self.surfaces.iter().filter(|surface| surface.realisation == 1)
    }

    fn curves(&self, chain: &Chain) -> Vec<CurveForecast> {
        let threshold = chain.micro.map(|micro| micro.rms_slope_threshold);
        self.first_curves().map(|curve| self.curve(curve, chain, threshold)).collect()
    }

    fn curve(&self, curve: &[CurveRow], chain: &Chain, threshold: Option<f64>) -> CurveForecast {
        let by_pressure = |a: &&CurveRow, b: &&CurveRow| a.pressure_mpa.total_cmp(&b.pressure_mpa);
        let first = curve.iter().min_by(by_pressure).unwrap_or(&curve[0]);
        let last = curve.iter().max_by(by_pressure).unwrap_or(&curve[0]);
        let (kind, speed_mm_s) = (first.kind, first.speed_mm_s);
        let own = |row: &&SolveRow| (row.kind, row.speed_mm_s) == (kind, speed_mm_s);
        let points = || self.solves.iter().filter(own).map(|row| row.grid_points);
        let one = |row: &&SolveRow| own(row) && row.realisation == 1;
        let surface = self.first_surfaces().find(|surface| surface.kind == kind);
        let profile = surface.map_or_else(Vec::new, |surface| match kind.method.of_a_window() {
            true => scales::octaves_as_sines(&surface.profile),
            false => surface.profile.clone(),
        });
        let contact = [last.pressure_mpa.mpa_to_pa(), last.contact_area_fraction];
        let speed = speed_mm_s.mm_to_m();
        CurveForecast {
            kind,
            speed_mm_s,
            realisations: self.realisations(kind, speed_mm_s, chain),
            pressures_mpa: [first.pressure_mpa, last.pressure_mpa],
            grid_points: [points().min().unwrap_or(0), points().max().unwrap_or(0)],
            solves: self.solves.iter().filter(one).count(),
            scales: match (surface, threshold) {
                (Some(surface), Some(threshold)) if kind.method.of_a_window() => {
                    let parting = Parting::of(std::slice::from_ref(surface), threshold);
                    let scales = scales::scales(&self.rubber, &profile, speed, contact, None);
                    scales::parted(scales, parting)
                }
                _ => scales::scales(&self.rubber, &profile, speed, contact, threshold),
            },
        }
    }

    /// Expected seconds on one thread of the contacts with their own heat and strain.
    fn feedback(&self, section: &Feedback, chain: &Chain) -> f64 {
        let of_kind = |surface: &Surface| {
            let speeds = chain.bem.speeds_mm_s.iter();
            let realisations = speeds.map(|v| self.realisations(surface.kind, *v, chain)).max();
            f64::from(realisations.unwrap_or(0)) * feedback::seconds(section, chain.bem, surface)
        };
        self.first_surfaces().map(of_kind).sum()
    }

    /// Expected seconds on one thread of the older multiscale methods.
    fn methods(&self, section: &Methods, chain: &Chain) -> f64 {
        let of_kind = |surface: &Surface| {
            let speeds = chain.bem.speeds_mm_s.iter();
            let curves = speeds.map(|v| f64::from(self.realisations(surface.kind, *v, chain)));
            curves.sum::<f64>() * methods::seconds(section, chain, surface)
        };
        self.first_surfaces().map(of_kind).sum()
    }

    /// Realisations that the recipe takes, or is expected to take for the accuracy it asks for.
    fn realisations(&self, kind: SurfaceKind, speed_mm_s: f64, chain: &Chain) -> u32 {
        if kind.method.is_measured() {
            return self.windows;
        }
        let drawn = chain.realise.drawn();
        let Some(tolerance) = chain.bem.average_tolerance else { return drawn };
        let family: Vec<&[CurveRow]> = self
            .by_curve()
            .filter(|curve| (curve[0].kind, curve[0].speed_mm_s) == (kind, speed_mm_s))
            .collect();
        // The trial has one window, so what the scans are worth is not known: an upper bound.
        let needed = Worth::UNLIMITED.realisations_needed(&family, tolerance).unwrap_or(0);
        let needed = needed.max(family.len());
        drawn.min(u32::try_from(needed).unwrap_or(u32::MAX))
    }
}

/// Computes a stage and returns the seconds it took.
fn computed(
    recipe: &Recipe,
    out: &Path,
    stage: Stage,
    interrupted: &Interrupt,
) -> Result<f64, ForecastError> {
    let selection = Selection { only: Some(stage), ..Selection::default() };
    pipeline::run(recipe, out, selection, interrupted, &|_| ())?;
    let manifest = RunView::of(out).stage_manifest(stage.name())?;
    Ok(manifest.map_or(0.0, |manifest| manifest.seconds))
}
