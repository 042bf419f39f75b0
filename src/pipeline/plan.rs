//! The stages of a recipe, and all that determines the result of each.

use super::{PipelineError, Selection};
use crate::artifact::{ArtifactError, Identity, Input, RunView, SchemaVersion};
use crate::recipe::{Chain, Recipe, Work};
use crate::rubber::{FiniteStrainRubber, Rheology, Rubber, RubberData};
use crate::stages::ingest::ScanFile;
use crate::stages::{
    Stage, StageError, approximate, bem, characterise, fem, hybrid, ingest, micro, multilevel,
    realise, sinusoid, tables,
};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

/// What the recipe asks for with what it refers to.
pub(super) struct Plan<'a> {
    pub work: Work<'a>,
    pub scans: Vec<ScanFile>,
    pub material: RubberData,
    published: Vec<Input>,
}

impl<'a> Plan<'a> {
    /// With the scans of the recipe, if they are known already: to digest them takes time.
    pub fn new(recipe: &'a Recipe, known: Option<&[ScanFile]>) -> Result<Self, PipelineError> {
        let of = |stage| move |source| PipelineError::Stage { stage, source: Box::new(source) };
        let work = recipe.work()?;
        let (mut scans, mut published) = (Vec::new(), Vec::new());
        let material = match work {
            Work::Chain(chain) => {
                if let Some(ingest) = chain.ingest {
                    scans = match known {
                        Some(known) => known.to_vec(),
                        None => ingest::find_scans(&ingest.scans).map_err(of(Stage::Ingest))?,
                    };
                }
                published = tables::inputs(chain.tables).map_err(of(Stage::Tables))?;
                let material = bem::rubber(chain.bem).map_err(of(Stage::Bem))?;
                let finite = [
                    (chain.micro.is_some(), Stage::Micro),
                    (chain.fem.is_some(), Stage::Fem),
                    (chain.multilevel.is_some(), Stage::Multilevel),
                ];
                if let Some((_, stage)) = finite.into_iter().find(|(asked, _)| *asked) {
                    check_finite_strain(&material.rubber, &chain.bem.rubber).map_err(of(stage))?;
                }
                material
            }
            Work::Sinusoid(study) => {
                let rubber = sinusoid::rubber(study).map_err(of(Stage::Sinusoid))?;
                check_finite_strain(&rubber, &study.rubber).map_err(of(Stage::Sinusoid))?;
                RubberData::from(rubber)
            }
        };
        Ok(Self { work, scans, material, published })
    }

    /// The stages of the recipe.
    pub fn stages(&self) -> Vec<Stage> {
        stages(self.work)
    }

    /// Fails for a selected stage that the recipe does not have, and for a forced one that is not
    /// among those to be brought up to date.
    pub fn check(&self, selection: Selection) -> Result<(), PipelineError> {
        let selected = [selection.only, selection.from, selection.force].into_iter().flatten();
        for selected in selected {
            if !self.stages().contains(&selected) {
                let stages = self.stages().iter().map(|stage| stage.name()).collect();
                return Err(PipelineError::NoSuchStage { selected, stages });
            }
        }
        match selection.force {
            Some(forced) if !selection.includes(forced) => {
                Err(PipelineError::ForcedOutside { forced })
            }
            _ => Ok(()),
        }
    }

    /// All that determines the result of a stage, given the results before it.
    pub fn identity(&self, stage: Stage, view: &RunView) -> Result<Identity, ArtifactError> {
        let (stage_revision, output_schemas, parameters, inputs) = match self.work {
            Work::Chain(chain) => self.chain_identity(chain, stage, view)?,
            Work::Sinusoid(study) => {
                let parameters = study.resolved(&self.material.rubber);
                (sinusoid::REVISION, sinusoid::schemas(), parameters, Vec::new())
            }
        };
        let stage = stage.name().to_owned();
        Ok(Identity { stage, stage_revision, output_schemas, parameters, inputs })
    }

    /// The files of other stages that a stage reads.
    fn reads(&self, stage: Stage) -> Vec<(Stage, &'static str)> {
        let Work::Chain(chain) = self.work else { return Vec::new() };
        let surfaces = (Stage::Realise, realise::SURFACES_FILE);
        let curves = (Stage::Bem, bem::CURVES_FILE);
        match stage {
            Stage::Ingest | Stage::Sinusoid => Vec::new(),
            Stage::Characterise => vec![(Stage::Ingest, ingest::SCANS_FILE)],
            Stage::Approximate if chain.ingest.is_none() => Vec::new(),
            Stage::Approximate => vec![(Stage::Characterise, characterise::CORRELATION_FILE)],
            Stage::Realise => vec![(Stage::Approximate, approximate::WAVES_FILE)],
            Stage::Bem => vec![surfaces],
            Stage::Micro | Stage::Fem => vec![surfaces, curves],
            Stage::Multilevel => vec![surfaces, curves, (Stage::Bem, bem::SOLVES_FILE)],
            Stage::Hybrid => {
                let microscale = [micro::SAMPLES_FILE, micro::LAW_FILE];
                let microscale = microscale.map(|file| (Stage::Micro, file));
                [surfaces, curves].into_iter().chain(microscale).collect()
            }
            Stage::Tables => {
                let hybrid = chain.micro.map(|_| (Stage::Hybrid, hybrid::HYBRID_FILE));
                let fem = chain.fem.map(|_| (Stage::Fem, fem::FEM_FILE));
                let averages = (Stage::Multilevel, multilevel::AVERAGES_FILE);
                let pairs = (Stage::Multilevel, multilevel::PAIRS_FILE);
                let multilevel = chain.multilevel.map(|_| [averages, pairs]);
                let theories = (!chain.tables.theories.is_empty()).then_some(surfaces);
                let samples = (Stage::Micro, micro::SAMPLES_FILE);
                let corrections = !chain.tables.published_corrections.is_empty();
                let corrections = corrections.then_some(samples);
                let waves = (Stage::Approximate, approximate::WAVES_FILE);
                let finite = hybrid.into_iter().chain(fem).chain(multilevel.into_iter().flatten());
                let others = theories.into_iter().chain(corrections);
                [curves, waves].into_iter().chain(finite).chain(others).collect()
            }
        }
    }

    /// The stages that a result depends on, through any number of others.
    pub fn upstream(&self, stage: Stage) -> BTreeSet<Stage> {
        let mut found = BTreeSet::new();
        let mut open = vec![stage];
        while let Some(stage) = open.pop() {
            for (read, _) in self.reads(stage) {
                if found.insert(read) {
                    open.push(read);
                }
            }
        }
        found
    }

    fn chain_identity(
        &self,
        chain: Chain,
        stage: Stage,
        view: &RunView,
    ) -> Result<(u32, Vec<SchemaVersion>, Value, Vec<Input>), ArtifactError> {
        let mut inputs = Vec::new();
        for (read, file) in self.reads(stage) {
            let manifest = view.stage_manifest(read.name())?;
            inputs.extend(manifest.and_then(|manifest| manifest.input(file)));
        }
        let (revision, schemas, parameters) = match stage {
            Stage::Ingest => {
                let mut parameters = json!(chain.ingest);
                // Where the scans are is no parameter: their names and digests are inputs.
                if let Value::Object(keys) = &mut parameters {
                    keys.remove("scans");
                }
                inputs.extend(ingest::inputs(&self.scans));
                (ingest::REVISION, ingest::schemas(), parameters)
            }
            Stage::Characterise => {
                (characterise::REVISION, characterise::schemas(), json!(chain.characterise))
            }
            Stage::Approximate => {
                (approximate::REVISION, approximate::schemas(), json!(chain.approximate))
            }
            Stage::Realise => (realise::REVISION, realise::schemas(), json!(chain.realise)),
            Stage::Bem => (bem::REVISION, bem::schemas(), chain.bem.resolved(&self.material)),
            Stage::Micro => {
                let parameters = json!({ "micro": chain.micro, "rubber": self.material.rubber });
                (micro::REVISION, micro::schemas(), parameters)
            }
            Stage::Hybrid => {
                let parameters = json!({ "hybrid": chain.hybrid, "micro": chain.micro, "rubber": self.material.rubber });
                (hybrid::REVISION, hybrid::schemas(), parameters)
            }
            Stage::Fem => {
                let parameters = json!({
                    "fem": chain.fem,
                    "rubber": self.material.rubber,
                    "speeds_mm_s": chain.bem.speeds_mm_s,
                    "area_fractions": chain.bem.area_fractions,
                });
                (fem::REVISION, fem::schemas(), parameters)
            }
            Stage::Multilevel => {
                let parameters = json!({
                    "multilevel": chain.multilevel,
                    "bem": chain.bem.resolved(&self.material),
                });
                (multilevel::REVISION, multilevel::schemas(), parameters)
            }
            Stage::Tables => {
                let mut parameters = json!(chain.tables);
                // Where the published tables are is no parameter: their names and digests are inputs.
                for key in ["published", "published_corrections"] {
                    let tables = parameters.get_mut(key).and_then(Value::as_array_mut);
                    for table in tables.into_iter().flatten().filter_map(Value::as_object_mut) {
                        table.remove("file");
                    }
                }
                if !chain.tables.theories.is_empty() {
                    parameters["rubber"] = json!(self.material.rubber);
                }
                inputs.extend(self.published.iter().cloned());
                (tables::REVISION, tables::schemas(), parameters)
            }
            Stage::Sinusoid => unreachable!("no stage of the chain"),
        };
        Ok((revision, schemas, parameters, inputs))
    }
}

/// The stages of a recipe; a chain that states its waves needs no scans.
pub(super) fn stages(work: Work) -> Vec<Stage> {
    let Work::Chain(chain) = work else { return vec![Stage::Sinusoid] };
    let has = |stage: &Stage| match stage {
        Stage::Ingest | Stage::Characterise => chain.ingest.is_some(),
        Stage::Micro | Stage::Hybrid => chain.micro.is_some(),
        Stage::Fem => chain.fem.is_some(),
        Stage::Multilevel => chain.multilevel.is_some(),
        _ => true,
    };
    Stage::CHAIN.into_iter().filter(has).collect()
}

/// Fails for a rubber that the half-space takes and finite elements do not, before the half-space
/// is solved for nothing.
fn check_finite_strain(rubber: &Rubber, file: &Path) -> Result<(), StageError> {
    match FiniteStrainRubber::new(rubber, Rheology::NeoHookean) {
        Ok(_) => Ok(()),
        Err(source) => {
            Err(StageError::RubberAtFiniteDeformation { path: file.to_path_buf(), source })
        }
    }
}
