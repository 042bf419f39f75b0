use std::fs;
use std::path::Path;

use serde_json::json;

use super::{Sample, samples};
use crate::artifact::*;

const FILE: &str = "samples.arrow";

fn identity(revision: u32) -> Identity {
    Identity {
        stage: "bem".into(),
        stage_revision: revision,
        output_schemas: Vec::new(),
        parameters: json!({}),
        inputs: Vec::new(),
    }
}

fn fill(pending: &mut Pending) {
    pending.write_table(FILE, &samples(), &Metadata::new()).unwrap();
    let array = ArrayDataset {
        name: "heights".into(),
        unit: "m".into(),
        attributes: Default::default(),
        values: vec![1.0, 2.0],
    };
    pending
        .write_arrays("heights.h5", "asperity.test.heights", 1, "Heights", Storage::Plain, &[array])
        .unwrap();
    fs::write(pending.path("notes.txt"), "notes").unwrap();
    pending.record("notes.txt", "asperity.test.notes", 1, None).unwrap();
}

fn run_stage(run: &RunFolder, revision: u32) {
    let mut pending = run.begin("bem").unwrap();
    fill(&mut pending);
    let outputs = pending.outputs().to_vec();
    let manifest = Manifest::new(&identity(revision), outputs, Vec::new(), 1.0).unwrap();
    pending.commit(&manifest).unwrap();
}

fn entries(path: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(path)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_committed_result_is_in_place_and_verified() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path().join("deep/out")).unwrap();
    assert_eq!(run.stage_manifest("bem").unwrap(), None);
    run_stage(&run, 1);
    assert_eq!(entries(run.path()), [".lock", "bem"]);
    assert_eq!(
        entries(&run.path().join("bem")),
        ["heights.h5", "manifest.json", "notes.txt", FILE]
    );
    run.verify("bem").unwrap();
    assert_eq!(run.read_table::<Sample>("bem", FILE).unwrap().0, samples());
    let arrays = run.read_arrays("bem", "heights.h5", "asperity.test.heights", 1).unwrap();
    assert_eq!(arrays[0].values, [1.0, 2.0]);
    let manifest = run.stage_manifest("bem").unwrap().unwrap();
    assert_eq!(manifest.outputs.len(), 3);
    let info = table_info(&run.file("bem", FILE)).unwrap();
    assert_eq!(manifest.output(FILE).unwrap().content_digest, info.content_digest);
}

#[test]
fn a_newer_result_replaces_the_old_one_whole() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    run_stage(&run, 1);
    fs::write(run.file("bem", "stray"), "").unwrap();
    run_stage(&run, 2);
    assert_eq!(run.stage_manifest("bem").unwrap().unwrap().stage_revision, 2);
    assert!(!run.file("bem", "stray").exists());
    assert_eq!(entries(run.path()), [".lock", "bem"]);
}

#[test]
fn a_result_that_is_dropped_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    let mut pending = run.begin("bem").unwrap();
    fill(&mut pending);
    drop(pending);
    assert_eq!(entries(run.path()), [".lock"]);
    assert!(matches!(run.verify("bem"), Err(ArtifactError::NoResult { .. })));
}

/// A killed process runs no destructors; `mem::forget` is that kill.
#[test]
fn a_kill_before_the_rename_leaves_the_old_result() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    run_stage(&run, 1);
    let mut pending = run.begin("bem").unwrap();
    fill(&mut pending);
    std::mem::forget(pending);
    drop(run);
    assert_eq!(entries(folder.path()).len(), 3);

    let run = RunFolder::open(folder.path()).unwrap();
    assert_eq!(entries(run.path()), [".lock", "bem"]);
    run.verify("bem").unwrap();
}

#[test]
fn a_kill_between_the_renames_brings_the_old_result_back() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    run_stage(&run, 1);
    drop(run);
    fs::rename(folder.path().join("bem"), folder.path().join(".old-bem")).unwrap();
    fs::create_dir(folder.path().join(".tmp-bem-x")).unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    assert_eq!(entries(run.path()), [".lock", "bem"]);
    run.verify("bem").unwrap();
}

#[test]
fn a_kill_after_the_renames_keeps_the_new_result() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    run_stage(&run, 2);
    drop(run);
    fs::create_dir(folder.path().join(".old-bem")).unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    assert_eq!(entries(run.path()), [".lock", "bem"]);
    assert_eq!(run.stage_manifest("bem").unwrap().unwrap().stage_revision, 2);
}

#[test]
fn a_second_run_is_refused_while_a_view_may_look() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    run_stage(&run, 1);
    let message = RunFolder::open(folder.path()).unwrap_err().to_string();
    assert!(message.contains("another run is using"), "{message}");
    assert!(message.contains("choose another --out"), "{message}");
    RunView::of(folder.path()).verify("bem").unwrap();
    drop(run);
    RunFolder::open(folder.path()).unwrap();
}

#[test]
fn verification_names_the_bad_file() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    run_stage(&run, 1);
    let path = run.file("bem", FILE);
    let bytes = fs::read(&path).unwrap();

    fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    let truncated = run.verify("bem").unwrap_err();
    assert!(matches!(truncated, ArtifactError::WrongSize { .. }), "{truncated}");
    assert!(truncated.to_string().contains(FILE), "{truncated}");

    // The first padding byte after the magic: Arrow does not look at it, the digest does.
    let mut flipped = bytes.clone();
    flipped[6] ^= 1;
    fs::write(&path, &flipped).unwrap();
    read_table::<Sample>(&path).unwrap();
    assert!(matches!(run.verify("bem"), Err(ArtifactError::Damaged { .. })));
    assert!(matches!(run.read_table::<Sample>("bem", FILE), Err(ArtifactError::Damaged { .. })));

    fs::remove_file(&path).unwrap();
    let missing = run.verify("bem").unwrap_err();
    assert!(matches!(missing, ArtifactError::Io { .. }), "{missing}");

    let other = run.read_table::<Sample>("bem", "other.arrow").unwrap_err().to_string();
    assert!(
        other.contains("has no file `other.arrow`, it has: samples.arrow, heights.h5"),
        "{other}"
    );
}

#[test]
fn a_manifest_of_another_version_is_told_from_a_damaged_one() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    fs::create_dir(run.path().join("bem")).unwrap();
    let path = run.file("bem", Manifest::FILE);
    fs::write(&path, r#"{"schema":"asperity.manifest","version":9,"other":1}"#).unwrap();
    assert!(matches!(run.stage_manifest("bem"), Err(ArtifactError::WrongVersion { found: 9, .. })));
    fs::write(&path, r#"{"schema":"asperity.mani"#).unwrap();
    assert!(matches!(run.stage_manifest("bem"), Err(ArtifactError::Unreadable { .. })));
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let message = RunFolder::open(file.join("out")).unwrap_err().to_string();
    assert!(message.contains("cannot create") && message.contains("file/out"), "{message}");
}
