//! The stages of a recipe, and all that determines the result of each.

use super::{PipelineError, Selection};
use crate::artifact::{ArtifactError, Identity, RunView};
use crate::recipe::Recipe;
use crate::rubber::{FiniteStrainRubber, RubberData, RubberModel};
use crate::stages::ingest::ScanFile;
use crate::stages::methods::Methods;
use crate::stages::{
    Job, Planned, Request, Stage, StageError, bem, feedback, fem, ingest, methods, micro,
    multilevel, sinusoid, tables,
};
use std::collections::BTreeSet;
use std::path::Path;

/// What the recipe asks for with what it refers to, and the stages that may do it.
pub(super) struct Plan<'a> {
    request: Request<'a>,
    known: &'a [Stage],
}

impl<'a> Plan<'a> {
    /// With the scans of the recipe, if they are known already: to digest them takes time. `known` are the stages of
    /// the program in the order of the data.
    pub fn new(
        recipe: &'a Recipe,
        scans: Option<&[ScanFile]>,
        known: &'a [Stage],
    ) -> Result<Self, PipelineError> {
        Ok(Self { request: request(recipe, scans)?, known })
    }

    /// The stages of the recipe.
    pub fn stages(&self) -> Vec<Stage> {
        stages(&self.request, self.known)
    }

    /// What a stage does for the recipe, if the recipe asks for it.
    pub fn planned(&self, stage: Stage) -> Option<Planned<'_>> {
        stage.plan(&self.request)
    }

    /// Whether one stage comes before another in the order of the data, or is it.
    pub fn is_up_to(&self, stage: Stage, other: Stage) -> bool {
        let place = |stage| self.known.iter().position(|known| *known == stage);
        place(stage) <= place(other)
    }

    /// Whether a stage is selected.
    pub fn selects(&self, selection: Selection, stage: Stage) -> bool {
        selection.only.is_none_or(|only| only == stage)
            && selection.from.is_none_or(|from| self.is_up_to(from, stage))
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
            Some(forced) if !self.selects(selection, forced) => {
                Err(PipelineError::ForcedOutside { forced })
            }
            _ => Ok(()),
        }
    }

    /// All that determines the result of a planned stage, given the results before it.
    pub fn identity(
        &self,
        stage: Stage,
        planned: &Planned,
        view: &RunView,
    ) -> Result<Identity, ArtifactError> {
        let mut inputs = Vec::new();
        for read in &planned.reads {
            let manifest = view.stage_manifest(read.stage)?;
            inputs.extend(manifest.and_then(|manifest| manifest.input(read.name)));
        }
        inputs.extend(planned.inputs.iter().cloned());
        Ok(Identity {
            stage: stage.name().to_owned(),
            stage_revision: stage.0.revision,
            output_schemas: (stage.0.schemas)(),
            parameters: planned.parameters.clone(),
            inputs,
        })
    }

    /// Names of the stages that a result depends on, through any number of others.
    pub fn upstream(&self, stage: Stage) -> BTreeSet<&'static str> {
        let mut found = BTreeSet::new();
        let mut open = vec![stage];
        while let Some(stage) = open.pop() {
            for read in self.planned(stage).into_iter().flat_map(|planned| planned.reads) {
                if found.insert(read.stage) {
                    open.extend(self.known.iter().filter(|known| known.name() == read.stage));
                }
            }
        }
        found
    }
}

/// The stages that a recipe asks for.
pub(super) fn stages(request: &Request, known: &[Stage]) -> Vec<Stage> {
    known.iter().copied().filter(|stage| stage.plan(request).is_some()).collect()
}

/// Reads what a recipe refers to.
fn request<'a>(
    recipe: &'a Recipe,
    known: Option<&[ScanFile]>,
) -> Result<Request<'a>, PipelineError> {
    let of = |stage| move |source| PipelineError::Stage { stage, source: Box::new(source) };
    let job = recipe.job()?;
    let (mut scans, mut published) = (Vec::new(), Vec::new());
    let material = match job {
        Job::Chain(chain) => {
            if let Some(ingest) = chain.ingest {
                scans = match known {
                    Some(known) => known.to_vec(),
                    None => ingest::find_scans(&ingest.scans).map_err(of(ingest::STAGE))?,
                };
            }
            published = tables::inputs(chain.tables).map_err(of(tables::STAGE))?;
            let material = bem::rubber(chain.bem).map_err(of(bem::STAGE))?;
            let finite = [
                (chain.micro.is_some(), micro::STAGE),
                (chain.fem.is_some(), fem::STAGE),
                (chain.multilevel.is_some(), multilevel::STAGE),
                (chain.methods.is_some_and(Methods::has_finite_deformation), methods::STAGE),
            ];
            if let Some((_, stage)) = finite.into_iter().find(|(asked, _)| *asked) {
                check_finite_strain(&material.rubber, &chain.bem.rubber).map_err(of(stage))?;
            }
            if let Some(section) = chain.feedback {
                feedback::require_laws(section, &material, &chain.bem.rubber)
                    .map_err(of(feedback::STAGE))?;
            }
            material
        }
        Job::Sinusoid(study) => {
            let rubber = sinusoid::rubber(study).map_err(of(sinusoid::STAGE))?;
            let material = RubberData::from(rubber);
            check_finite_strain(&material.rubber, &study.rubber).map_err(of(sinusoid::STAGE))?;
            material
        }
    };
    Ok(Request { job, scans, material, published })
}

/// Fails for a rubber that the half-space takes and finite elements do not, before the half-space
/// is solved for nothing.
fn check_finite_strain(rubber: &RubberModel, file: &Path) -> Result<(), StageError> {
    let rubber = rubber
        .maxwell()
        .map_err(|source| StageError::NoRelaxationTimes { path: file.to_path_buf(), source })?;
    match FiniteStrainRubber::new(rubber, rubber.finite_strain) {
        Ok(_) => Ok(()),
        Err(source) => {
            Err(StageError::RubberAtFiniteDeformation { path: file.to_path_buf(), source })
        }
    }
}
