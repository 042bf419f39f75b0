//! A stage that the program does not have is one file, this one, and one line, its place in the order.

use super::{Campaign, recipe};
use asperity::artifact::{Row, RunFolder, RunView, SchemaVersion, Table};
use asperity::numerics::Interrupt;
use asperity::pipeline::{Event, PipelineError, Ready, Selection};
use asperity::recipe::Recipe;
use asperity::stages::tables::FRICTION;
use asperity::stages::{Context, Contract, Inputs, Planned, Request, Stage, StageError, tables};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::Path;
use std::sync::Mutex;

/// The largest averaged friction of a run.
#[derive(Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
struct LargestRow {
    /// Number of waves.
    waves: u32,
    /// Friction coefficient.
    #[schemars(extend("unit" = "1"))]
    friction: f64,
}

impl Row for LargestRow {
    const SCHEMA: &'static str = "asperity.test.largest";
    const VERSION: u32 = 1;
}

const LARGEST_TABLE: Table<LargestRow> = Table::new("largest", "largest.arrow");

static LARGEST: Contract = Contract {
    name: "largest",
    summary: "The largest averaged friction",
    revision: 1,
    schemas,
    plan,
};

/// The same, which does not say what it reads.
static SILENT: Contract = Contract {
    name: "silent",
    summary: "Reads what it does not declare",
    revision: 1,
    schemas,
    plan: silent,
};

fn schemas() -> Vec<SchemaVersion> {
    vec![LARGEST_TABLE.schema()]
}

fn plan<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    silent(request).map(|planned| planned.reading(FRICTION))
}

fn silent<'a>(request: &'a Request<'a>) -> Option<Planned<'a>> {
    request.chain()?;
    Some(Planned::new(json!({}), compute))
}

fn compute(inputs: &Inputs, context: &mut Context) -> Result<Vec<String>, StageError> {
    let rows = inputs.results.rows(FRICTION)?;
    let largest = rows.iter().max_by(|a, b| a.mean.total_cmp(&b.mean));
    let rows: Vec<LargestRow> = largest
        .map(|row| LargestRow { waves: row.kind.waves, friction: row.mean })
        .into_iter()
        .collect();
    context.pending.write_rows(LARGEST_TABLE, &rows)?;
    Ok(vec!["a test".into()])
}

/// The stages of the program with one behind them.
fn with(stage: &'static Contract) -> Vec<Stage> {
    Stage::ALL.into_iter().chain([Stage(stage)]).collect()
}

/// The stages that were computed.
fn run(
    recipe: &Recipe,
    out: &Path,
    selection: Selection,
    stages: &[Stage],
) -> Result<Vec<Stage>, PipelineError> {
    let computed = Mutex::new(Vec::new());
    let ready = Ready::with_stages(recipe, out, selection, stages)?;
    ready.run(&RunFolder::open(out)?, &Interrupt::default(), &|event| {
        if let Event::Finished(stage, _) = event {
            computed.lock().unwrap().push(stage);
        }
    })?;
    Ok(computed.into_inner().unwrap())
}

#[test]
fn a_stage_is_added_by_a_file_and_its_place() {
    let campaign = Campaign::new();
    let (recipe, out) = (recipe(&campaign), campaign.path("out"));
    let (all, stages) = (Selection::default(), with(&LARGEST));
    let computed = run(&recipe, &out, all, &stages).unwrap();
    assert_eq!(computed.last(), Some(&Stage(&LARGEST)));
    let view = RunView::of(&out);
    let rows = view.rows(LARGEST_TABLE).unwrap();
    let friction = view.rows(FRICTION).unwrap();
    let most = friction.iter().map(|row| row.mean).fold(0.0, f64::max);
    assert_eq!(rows[0].friction, most);
    let manifest = view.stage_manifest("largest").unwrap().unwrap();
    assert_eq!(manifest.inputs[0].name, format!("tables/{FRICTION}"));
    // Known like any other: up to date, forced, stale where what it reads is another.
    assert_eq!(run(&recipe, &out, all, &stages).unwrap(), []);
    let force = Selection { force: Some(Stage(&LARGEST)), ..all };
    assert_eq!(run(&recipe, &out, force, &stages).unwrap(), [Stage(&LARGEST)]);
    let force = Selection { force: Some(tables::STAGE), ..all };
    assert_eq!(run(&recipe, &out, force, &stages).unwrap(), [tables::STAGE]);
    // Not known to the program without its line.
    let only = Selection { only: Some(Stage(&LARGEST)), ..all };
    let unknown = run(&recipe, &out, only, &Stage::ALL).unwrap_err().to_string();
    assert!(unknown.contains("the recipe has no stage largest"), "{unknown}");
}

#[test]
fn a_read_that_is_not_declared_is_an_error() {
    let campaign = Campaign::new();
    let (recipe, out) = (recipe(&campaign), campaign.path("out"));
    let error = run(&recipe, &out, Selection::default(), &with(&SILENT)).unwrap_err().to_string();
    let said = format!("silent: a stage reads tables/{FRICTION} without declaring it");
    assert!(error.starts_with(&said), "{error}");
    assert!(!out.join("silent").exists());
}
