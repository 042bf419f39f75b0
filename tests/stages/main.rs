//! The stages on data of which the result is known, and the run folder through everything that
//! happens to it.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/digests.rs"]
mod digests;

mod added;
mod adhesion;
mod areal;
mod areal_failures;
mod bem;
mod changes;
mod characterise;
mod damage;
mod feedback;
mod golden;
mod hybrid;
mod instrument_files;
mod interruption;
mod keys;
mod methods;
mod metrology;
mod multilevel;
mod reliability;
mod road;
mod scans;
mod schemas;
mod sinusoid;
mod theories;
mod waves;

use asperity::numerics::Interrupt;
use asperity::pipeline::{self, PipelineError, Selection, State};
use asperity::recipe::Recipe;
use asperity::stages;
use asperity::stages::Stage;
use common::Campaign;
use digests::digests;
use std::path::Path;

/// The stages of the small campaign, which is solved on the half-space alone.
const STAGES: [Stage; 6] = [
    stages::ingest::STAGE,
    stages::characterise::STAGE,
    stages::approximate::STAGE,
    stages::realise::STAGE,
    stages::bem::STAGE,
    stages::tables::STAGE,
];

fn recipe(campaign: &Campaign) -> Recipe {
    Recipe::read(&campaign.path("recipe.toml")).unwrap()
}

/// Runs what the selection asks for and returns the stages that were computed.
fn try_run(recipe: &Recipe, out: &Path, selection: Selection) -> Result<Vec<Stage>, PipelineError> {
    let computed = std::sync::Mutex::new(Vec::new());
    pipeline::run(recipe, out, selection, &Interrupt::default(), &|event| {
        if let pipeline::Event::Finished(stage, _) = event {
            computed.lock().unwrap().push(stage);
        }
    })?;
    Ok(computed.into_inner().unwrap())
}

fn run(recipe: &Recipe, out: &Path) -> Vec<Stage> {
    try_run(recipe, out, Selection::default()).unwrap()
}

/// The stages that are stale, and why.
fn stale(recipe: &Recipe, out: &Path) -> Vec<(Stage, String)> {
    let states = pipeline::status(recipe, out).unwrap().into_iter();
    states
        .filter_map(|(stage, state)| match state {
            State::Fresh => None,
            State::Stale(reasons) => Some((stage, reasons.join("; "))),
        })
        .collect()
}
