//! The stages of a recipe, and all that determines the result of each.

use super::{PipelineError, Selection};
use crate::artifact::{ArtifactError, Identity, Input, RunView, SchemaVersion};
use crate::recipe::{Chain, Recipe, Work};
use crate::rubber::Rubber;
use crate::stages::ingest::ScanFile;
use crate::stages::{
    Stage, approximate, bem, characterise, fem, hybrid, ingest, micro, realise, sinusoid, tables,
};
use serde_json::{Value, json};

/// What the recipe asks for with what it refers to.
pub(super) struct Plan<'a> {
    pub work: Work<'a>,
    pub scans: Vec<ScanFile>,
    pub rubber: Rubber,
    published: Vec<Input>,
}

impl<'a> Plan<'a> {
    pub fn new(recipe: &'a Recipe) -> Result<Self, PipelineError> {
        let of = |stage| move |source| PipelineError::Stage { stage, source: Box::new(source) };
        let work = recipe.work()?;
        let (mut scans, mut published) = (Vec::new(), Vec::new());
        let rubber = match work {
            Work::Chain(chain) => {
                if let Some(ingest) = chain.ingest {
                    scans = ingest::find_scans(&ingest.scans).map_err(of(Stage::Ingest))?;
                }
                published = tables::inputs(chain.tables).map_err(of(Stage::Tables))?;
                bem::rubber(chain.bem).map_err(of(Stage::Bem))?
            }
            Work::Sinusoid(study) => sinusoid::rubber(study).map_err(of(Stage::Sinusoid))?,
        };
        Ok(Self { work, scans, rubber, published })
    }

    /// The stages of the recipe; a chain that states its waves needs no scans.
    pub fn stages(&self) -> Vec<Stage> {
        let Work::Chain(chain) = self.work else { return vec![Stage::Sinusoid] };
        let has = |stage: &Stage| match stage {
            Stage::Ingest | Stage::Characterise => chain.ingest.is_some(),
            Stage::Micro | Stage::Hybrid => chain.micro.is_some(),
            Stage::Fem => chain.fem.is_some(),
            _ => true,
        };
        Stage::CHAIN.into_iter().filter(has).collect()
    }

    /// Fails for a selected stage that the recipe does not have.
    pub fn check(&self, selection: Selection) -> Result<(), PipelineError> {
        let selected = [selection.only, selection.from, selection.force].into_iter().flatten();
        for selected in selected {
            if !self.stages().contains(&selected) {
                let stages = self.stages().iter().map(|stage| stage.name()).collect();
                return Err(PipelineError::NoSuchStage { selected, stages });
            }
        }
        Ok(())
    }

    /// All that determines the result of a stage, given the results before it.
    pub fn identity(&self, stage: Stage, view: &RunView) -> Result<Identity, ArtifactError> {
        let (stage_revision, output_schemas, parameters, inputs) = match self.work {
            Work::Chain(chain) => self.chain_identity(chain, stage, view)?,
            Work::Sinusoid(study) => {
                let parameters = study.resolved(&self.rubber);
                (sinusoid::REVISION, sinusoid::schemas(), parameters, Vec::new())
            }
        };
        let stage = stage.name().to_owned();
        Ok(Identity { stage, stage_revision, output_schemas, parameters, inputs })
    }

    fn chain_identity(
        &self,
        chain: Chain,
        stage: Stage,
        view: &RunView,
    ) -> Result<(u32, Vec<SchemaVersion>, Value, Vec<Input>), ArtifactError> {
        let from = |stage: Stage, file: &str| -> Result<Vec<Input>, ArtifactError> {
            let manifest = view.stage_manifest(stage.name())?;
            Ok(manifest.and_then(|manifest| manifest.input(file)).into_iter().collect())
        };
        let surfaces_and_curves = || -> Result<Vec<Input>, ArtifactError> {
            let mut inputs = from(Stage::Realise, realise::SURFACES_FILE)?;
            inputs.extend(from(Stage::Bem, bem::CURVES_FILE)?);
            Ok(inputs)
        };
        Ok(match stage {
            Stage::Ingest => {
                let mut parameters = json!(chain.ingest);
                // Where the scans are is no parameter: their names and digests are inputs.
                if let Value::Object(keys) = &mut parameters {
                    keys.remove("scans");
                }
                (ingest::REVISION, ingest::schemas(), parameters, ingest::inputs(&self.scans))
            }
            Stage::Characterise => (
                characterise::REVISION,
                characterise::schemas(),
                json!(chain.characterise),
                from(Stage::Ingest, ingest::SCANS_FILE)?,
            ),
            Stage::Approximate => {
                let inputs = match chain.ingest {
                    Some(_) => from(Stage::Characterise, characterise::CORRELATION_FILE)?,
                    None => Vec::new(),
                };
                let parameters = json!(chain.approximate);
                (approximate::REVISION, approximate::schemas(), parameters, inputs)
            }
            Stage::Realise => (
                realise::REVISION,
                realise::schemas(),
                json!(chain.realise),
                from(Stage::Approximate, approximate::WAVES_FILE)?,
            ),
            Stage::Bem => (
                bem::REVISION,
                bem::schemas(),
                chain.bem.resolved(&self.rubber),
                from(Stage::Realise, realise::SURFACES_FILE)?,
            ),
            Stage::Micro => {
                let parameters = json!({ "micro": chain.micro, "rubber": self.rubber });
                (micro::REVISION, micro::schemas(), parameters, surfaces_and_curves()?)
            }
            Stage::Hybrid => {
                let mut inputs = surfaces_and_curves()?;
                inputs.extend(from(Stage::Micro, micro::SAMPLES_FILE)?);
                inputs.extend(from(Stage::Micro, micro::LAW_FILE)?);
                let parameters =
                    json!({ "hybrid": chain.hybrid, "micro": chain.micro, "rubber": self.rubber });
                (hybrid::REVISION, hybrid::schemas(), parameters, inputs)
            }
            Stage::Fem => {
                let parameters = json!({
                    "fem": chain.fem,
                    "rubber": self.rubber,
                    "speeds_mm_s": chain.bem.speeds_mm_s,
                    "area_fractions": chain.bem.area_fractions,
                });
                (fem::REVISION, fem::schemas(), parameters, surfaces_and_curves()?)
            }
            Stage::Tables => {
                let mut inputs = from(Stage::Bem, bem::CURVES_FILE)?;
                if chain.micro.is_some() {
                    inputs.extend(from(Stage::Hybrid, hybrid::HYBRID_FILE)?);
                }
                if chain.fem.is_some() {
                    inputs.extend(from(Stage::Fem, fem::FEM_FILE)?);
                }
                let mut parameters = json!(chain.tables);
                if !chain.tables.theories.is_empty() {
                    inputs.extend(from(Stage::Realise, realise::SURFACES_FILE)?);
                    parameters["rubber"] = json!(self.rubber);
                }
                inputs.extend(self.published.iter().cloned());
                (tables::REVISION, tables::schemas(), parameters, inputs)
            }
            Stage::Sinusoid => unreachable!("no stage of the chain"),
        })
    }
}
