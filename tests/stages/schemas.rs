//! The committed schemas, and that the files are as they say.

use super::{Campaign, STAGES, recipe, run};
use asperity::artifact::{ArraysSchema, Attribute, RunView, arrays_info, check_or_write};
use asperity::schemas::documents;
use asperity::stages::{bem, ingest};
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn the_committed_schemas_are_those_of_the_program() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas");
    let update = std::env::var_os("ASPERITY_UPDATE_SCHEMAS").is_some();
    let documents = documents().unwrap();
    for (name, document) in &documents {
        if let Err(error) = check_or_write(&folder, name, document, update) {
            panic!(
                "{error}\n(new kinds: `ASPERITY_UPDATE_SCHEMAS=1 cargo test --release --test \
                 stages schemas`)"
            );
        }
    }
    let expected: BTreeSet<String> =
        documents.iter().map(|(name, _)| format!("{name}.json")).collect();
    let found: BTreeSet<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".json"))
        .collect();
    assert_eq!(found, expected, "delete the files of kinds that are gone");
}

#[test]
fn every_output_of_a_run_has_a_schema() {
    let (_campaign, view) = run_with_fields();
    let names: BTreeSet<String> = documents().unwrap().into_iter().map(|(name, _)| name).collect();
    for stage in STAGES {
        let outputs = view.stage_manifest(stage.name()).unwrap().unwrap().outputs;
        // Documents are for people.
        for output in outputs.iter().filter(|output| output.schema != "asperity.document") {
            let name = format!("{}.v{}", output.schema, output.schema_version);
            assert!(names.contains(&name), "{stage}/{}: {name}", output.file);
        }
    }
}

#[test]
fn array_files_are_as_their_schemas_say() {
    let (_campaign, view) = run_with_fields();
    conforms(&view.path_of(ingest::SCANS), &ingest::scans_schema());
    conforms(&view.path_of(bem::FIELDS), &bem::fields_schema());
}

fn run_with_fields() -> (Campaign, RunView) {
    let campaign = Campaign::new();
    let fields = "tolerance = 5e-3\nfield_area_fractions = [0.05]";
    campaign.edit("recipe.toml", "tolerance = 5e-3", fields);
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    (campaign, RunView::of(out))
}

fn conforms(path: &Path, schema: &ArraysSchema) {
    let info = arrays_info(path).unwrap();
    assert_eq!((info.schema.as_str(), info.version), (schema.schema, schema.version));
    assert_eq!(info.description, schema.description);
    assert!(!info.datasets.is_empty());
    for dataset in &info.datasets {
        // Kinds are told apart by the last part of their path, if they are several.
        let last = |path: &str| path.rsplit('/').next().unwrap().to_owned();
        let kind = schema
            .datasets
            .iter()
            .find(|kind| schema.datasets.len() == 1 || last(kind.path) == last(&dataset.name))
            .unwrap_or_else(|| panic!("{} is of no documented kind", dataset.name));
        assert_eq!(dataset.unit, kind.unit);
        let found: BTreeSet<(&str, &str)> = dataset
            .attributes
            .iter()
            .map(|(name, value)| match value {
                Attribute::Float(_) => (name.as_str(), "f64"),
                Attribute::Integer(_) => (name.as_str(), "i64"),
                Attribute::Text(_) => (name.as_str(), "string"),
            })
            .collect();
        let documented: BTreeSet<_> = kind.attributes.iter().map(|a| (a.name, a.kind)).collect();
        assert_eq!(found, documented, "{}", dataset.name);
    }
}
