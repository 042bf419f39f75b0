//! The cases of a sweep with their surfaces and rubbers: what is cheap, and is done before anything is dealt.

use super::layout::Layout;
use super::task::{Solvers, Task};
use super::{SweepError, plan::Wanted};
use crate::artifact::{Digest, RunView, SOLVES_FOLDER, SolveStore};
use crate::pipeline::{self, PipelineError, Selection};
use crate::recipe::{Case, Recipe};
use crate::rubber::{RubberData, RubberModel};
use crate::stages;
use crate::stages::bem::{self, CURVES};
use crate::stages::ingest::{ScanFile, find_scans};
use crate::stages::realise::{AREAL, Surface, read_areal_surfaces, read_surfaces};
use crate::stages::{Stage, StageError, Watch, areal, fem, micro, multilevel};
use rayon::prelude::*;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The cases of a recipe in a folder, with the results of the stages up to the realisations.
pub struct Prepared {
    /// Where everything is.
    pub layout: Layout,
    /// The cases.
    pub cases: Vec<Case>,
    /// How all tasks are solved.
    pub solvers: Solvers,
    /// The rubbers, each at each temperature.
    pub materials: Vec<RubberData>,
    /// For each case the number of its rubber.
    pub material_of: Vec<usize>,
    pub(super) scans: Scans,
    surfaces: BTreeMap<PathBuf, Vec<Surface>>,
}

/// By specimen.
type Scans = BTreeMap<Option<String>, Vec<ScanFile>>;

/// Stages of the surfaces, which cases have in common.
pub(super) const SURFACE_STAGES: [Stage; 4] = [
    stages::ingest::STAGE,
    stages::characterise::STAGE,
    stages::approximate::STAGE,
    stages::realise::STAGE,
];

impl Prepared {
    /// Brings the surfaces of all specimens and seeds up to date in the folder of a sweep and reads the rubbers.
    ///
    /// # Errors
    /// Those of the stages; [`SweepError::Recipe`].
    pub fn new(recipe: &Recipe, layout: Layout, watch: Watch) -> Result<Self, SweepError> {
        let cases = recipe.cases()?;
        let solvers = Solvers::of(&cases[0].recipe)?;
        let scans = scans(&cases)?;
        let (materials, material_of) = materials(&cases)?;
        let surfaces = BTreeMap::new();
        let mut prepared = Self { layout, cases, solvers, materials, material_of, scans, surfaces };
        let mut checked = vec![false; prepared.materials.len()];
        for (case, material) in prepared.cases.iter().zip(&prepared.material_of) {
            if !std::mem::replace(&mut checked[*material], true) {
                pipeline::check(&case.recipe, prepared.scans(case)).map_err(of_case(case))?;
            }
        }
        prepared.layout.check(&prepared.cases)?;
        prepared.surfaces = prepared.make_surfaces(watch)?;
        Ok(prepared)
    }

    /// The rubber of a case by its number.
    pub fn rubber(&self, case: usize) -> &RubberModel {
        &self.materials[self.material_of[case]].rubber
    }

    /// The scans of a case; none where it states its waves.
    pub fn scans(&self, case: &Case) -> &[ScanFile] {
        self.scans.get(&case.specimen).map_or(&[], Vec::as_slice)
    }

    /// For each specimen the number of its first case, and the surfaces of that case.
    pub(super) fn first_cases(&self) -> Vec<(usize, &[Surface])> {
        let mut seen = BTreeMap::new();
        for (number, case) in self.cases.iter().enumerate() {
            seen.entry(&case.specimen).or_insert((number, &self.surfaces[&case.surfaces][..]));
        }
        seen.into_values().collect()
    }

    /// The surfaces of each specimen and seed; what does not depend on the seed is computed once and linked.
    fn make_surfaces(&self, watch: Watch) -> Result<BTreeMap<PathBuf, Vec<Surface>>, SweepError> {
        let mut found = BTreeMap::new();
        let mut first: BTreeMap<&Option<String>, PathBuf> = BTreeMap::new();
        for case in &self.cases {
            if found.contains_key(&case.surfaces) {
                continue;
            }
            let folder = self.layout.surfaces(case);
            let stages = pipeline::stages(&case.recipe)?;
            for stage in SURFACE_STAGES.into_iter().filter(|stage| stages.contains(stage)) {
                if let (Some(first), true) =
                    (first.get(&case.specimen), stage != stages::realise::STAGE)
                {
                    self.layout.link(&first.join(stage.name()), &folder.join(stage.name()))?;
                }
                self.run_stage(case, folder.clone(), stage, watch)?;
            }
            first.entry(&case.specimen).or_insert(folder.clone());
            let surfaces = read_surfaces(&RunView::of(folder))?;
            found.insert(case.surfaces.clone(), surfaces);
        }
        Ok(found)
    }

    fn run_stage(
        &self,
        case: &Case,
        folder: PathBuf,
        stage: Stage,
        watch: Watch,
    ) -> Result<(), SweepError> {
        let selection = Selection { only: Some(stage), ..Selection::default() };
        let scans = self.scans(case);
        pipeline::run_shared(&case.recipe, scans, &folder, selection, watch.interrupted, &|_| ())
            .map_err(of_case(case))
    }

    /// Makes the run folder of a case: links to its surfaces and to the solves of the sweep, and its recipe.
    pub(super) fn make_case(&self, case: &Case) -> Result<PathBuf, SweepError> {
        let (folder, surfaces) = (self.layout.case(case), self.layout.surfaces(case));
        for stage in SURFACE_STAGES {
            let target = surfaces.join(stage.name());
            if target.exists() {
                self.layout.link(&target, &folder.join(stage.name()))?;
            }
        }
        self.layout.link(&self.layout.solves(), &folder.join(SOLVES_FOLDER))?;
        Ok(folder)
    }

    /// The tasks that are next and that the store does not have: those of the half-space, or where it has all
    /// of these, those at finite deformation, for which the stage `bem` of the case is computed.
    pub(super) fn missing(
        &self,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<Vec<Wanted>, SweepError> {
        let of_cases: Vec<Vec<Wanted>> = (0..self.cases.len())
            .into_par_iter()
            .map(|case| {
                watch.check_interrupt()?;
                self.missing_of(case, store, watch)
            })
            .collect::<Result<_, SweepError>>()?;
        Ok(of_cases.concat())
    }

    fn missing_of(
        &self,
        number: usize,
        store: &SolveStore,
        watch: Watch,
    ) -> Result<Vec<Wanted>, SweepError> {
        let (case, rubber, solvers) = (&self.cases[number], self.rubber(number), &self.solvers);
        let surfaces = &self.surfaces[&case.surfaces];
        let silent = Watch { progress: &|_, _| (), interrupted: watch.interrupted };
        let wanted = |task: Task| Wanted::new(number, task, solvers, rubber);
        let view = RunView::of(self.layout.surfaces(case));
        let scans = bem::Scans::read(&solvers.bem, surfaces, &view)?;
        let mut curves: Vec<Task> =
            bem::missing(&solvers.bem, rubber, surfaces, &scans, store, silent)?
                .into_iter()
                .map(Task::Bem)
                .collect();
        if view.has(AREAL)? {
            let maps = read_areal_surfaces(&view)?;
            let missing = areal::missing(&solvers.areal, &solvers.bem, rubber, &maps, store)?;
            curves.extend(missing.into_iter().map(Task::Areal));
        }
        let (micro, fem) = (case.recipe.micro.is_some(), case.recipe.fem.is_some());
        let multilevel = case.recipe.multilevel.is_some();
        if !curves.is_empty() || !(micro || fem || multilevel) {
            return Ok(curves.into_iter().map(wanted).collect());
        }
        let folder = self.make_case(case)?;
        self.run_stage(case, folder.clone(), stages::bem::STAGE, watch)?;
        let view = RunView::of(folder);
        let curves = view.rows(CURVES)?;
        let mut tasks = Vec::new();
        if micro {
            let missing = micro::missing(&solvers.micro, rubber, surfaces, &curves, store)?;
            tasks.extend(missing.into_iter().map(Task::Micro).map(wanted));
        }
        if fem {
            let missing =
                fem::missing(&solvers.fem, &solvers.bem, rubber, surfaces, &curves, store)?;
            tasks.extend(missing.into_iter().map(Task::Fem).map(wanted));
        }
        if multilevel {
            let (parameters, bem) = (&solvers.multilevel, &solvers.bem);
            let missing = multilevel::missing(parameters, bem, rubber, &view, store, silent)?;
            tasks.extend(missing.half_space.into_iter().map(Task::Bem).map(wanted));
            tasks.extend(missing.full.into_iter().map(Task::Multilevel).map(wanted));
        }
        Ok(tasks)
    }
}

/// The scans of each specimen; none where the recipe states its waves.
pub(super) fn scans(cases: &[Case]) -> Result<Scans, SweepError> {
    let mut scans = BTreeMap::new();
    for case in cases {
        if let (Some(ingest), false) = (&case.recipe.ingest, scans.contains_key(&case.specimen)) {
            let found =
                find_scans(&ingest.scans).map_err(|e| of_stage(case, stages::ingest::STAGE, e))?;
            scans.insert(case.specimen.clone(), found);
        }
    }
    Ok(scans)
}

/// A digest of names and contents of the scans of each specimen, by which a plan knows them; the recipe's own
/// scans have an empty name.
pub(super) fn scan_digests(scans: &Scans) -> BTreeMap<String, Digest> {
    let digest = |files: &[ScanFile]| {
        let files: Vec<_> = files.iter().map(|file| (&file.name, file.digest)).collect();
        Digest::of_value(&json!(files))
    };
    let name = |specimen: &Option<String>| specimen.clone().unwrap_or_default();
    scans.iter().map(|(specimen, files)| (name(specimen), digest(files))).collect()
}

/// The distinct rubbers of the cases, and which case has which.
fn materials(cases: &[Case]) -> Result<(Vec<RubberData>, Vec<usize>), SweepError> {
    let mut numbers: BTreeMap<(PathBuf, Option<u64>), usize> = BTreeMap::new();
    let (mut materials, mut material_of) = (Vec::new(), Vec::with_capacity(cases.len()));
    for case in cases {
        let Some(section) = &case.recipe.bem else { continue };
        let key = (section.rubber.clone(), section.temperature_c.map(f64::to_bits));
        let number = match numbers.get(&key) {
            Some(number) => *number,
            None => {
                materials
                    .push(bem::rubber(section).map_err(|e| of_stage(case, stages::bem::STAGE, e))?);
                numbers.insert(key, materials.len() - 1);
                materials.len() - 1
            }
        };
        material_of.push(number);
    }
    Ok((materials, material_of))
}

fn of_stage(case: &Case, stage: Stage, source: StageError) -> SweepError {
    of_case(case)(PipelineError::Stage { stage, source: Box::new(source) })
}

pub(super) fn of_case(case: &Case) -> impl Fn(PipelineError) -> SweepError {
    let case = case.folder.display().to_string();
    move |source| SweepError::Case { case: case.clone(), source: Box::new(source) }
}
