use std::fs;
use std::path::Path;

use serde_json::json;

use super::{Sample, samples};
use crate::artifact::*;

const TABLE: Table<Sample> = Table::new("bem", "samples.arrow");
const FILE: &str = TABLE.name();
const HEIGHTS: ArrayFile = ArrayFile {
    file: ResultFile { stage: "bem", name: "heights.h5" },
    schema: "asperity.test.heights",
    version: 1,
    description: "Heights",
};

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
    pending.write_rows(TABLE, &samples()).unwrap();
    let array = ArrayDataset {
        name: "heights".into(),
        unit: "m".into(),
        attributes: Default::default(),
        values: vec![1.0, 2.0],
    };
    pending.write_arrays(HEIGHTS, Storage::Plain, &[array]).unwrap();
    fs::write(pending.path("notes.txt").unwrap(), "notes").unwrap();
    pending.record("notes.txt", "asperity.test.notes", 1, None).unwrap();
}

fn run_stage(run: &RunFolder, revision: u32) {
    commit(run, revision).unwrap();
}

fn commit(run: &RunFolder, revision: u32) -> Result<(), ArtifactError> {
    let mut pending = run.begin("bem").unwrap();
    fill(&mut pending);
    let outputs = pending.outputs().to_vec();
    let manifest = Manifest::new(&identity(revision), outputs, Vec::new(), 1.0).unwrap();
    pending.commit(&manifest)
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
    assert_eq!(run.rows(TABLE).unwrap(), samples());
    let arrays = run.read_arrays(HEIGHTS).unwrap();
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
    fs::write(run.file("bem", "stray"), "mine").unwrap();
    let refused = commit(&run, 2).unwrap_err();
    assert!(matches!(refused, ArtifactError::Foreign { .. }), "{refused}");
    assert!(refused.to_string().contains("bem/stray"), "{refused}");
    assert_eq!(run.unlisted("bem").unwrap(), [run.file("bem", "stray")]);
    assert_eq!(fs::read(run.file("bem", "stray")).unwrap(), b"mine");
    assert_eq!(run.stage_manifest("bem").unwrap().unwrap().stage_revision, 1);
    fs::remove_file(run.file("bem", "stray")).unwrap();
    run_stage(&run, 2);
    assert_eq!(run.stage_manifest("bem").unwrap().unwrap().stage_revision, 2);
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
    fs::rename(folder.path().join("bem"), folder.path().join(".asperity-old-bem-x")).unwrap();
    fs::create_dir(folder.path().join(".asperity-new-bem-x")).unwrap();
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
    fs::create_dir(folder.path().join(".asperity-old-bem-x")).unwrap();
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
    assert!(matches!(run.rows(TABLE), Err(ArtifactError::Damaged { .. })));

    fs::remove_file(&path).unwrap();
    let missing = run.verify("bem").unwrap_err();
    assert!(matches!(missing, ArtifactError::Io { .. }), "{missing}");

    let other = run.rows(Table::<Sample>::new("bem", "other.arrow")).unwrap_err().to_string();
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

/// Foreign files in every place that is cleared, replaced or written, each with a word of what is said of it.
#[test]
fn what_asperity_did_not_write_stays() {
    let folder = tempfile::tempdir().unwrap();
    let run = RunFolder::open(folder.path()).unwrap();
    run_stage(&run, 1);
    // A kill in the middle of a result, to which a user has added a file.
    let mut pending = run.begin("bem").unwrap();
    fill(&mut pending);
    let begun = pending.path("more.arrow").unwrap();
    fs::write(&begun, "half").unwrap();
    fs::write(begun.with_file_name("mine"), "mine").unwrap();
    std::mem::forget(pending);
    drop(run);
    let key = Digest::of_bytes(b"key");
    let solves = folder.path().join("solves").join(&key.to_string()[..2]);
    fs::create_dir_all(&solves).unwrap();
    let half = solves.join(format!(".asperity-{key}.json-AbCdEf"));
    fs::write(&half, "{").unwrap();
    let foreign = [
        begun.with_file_name("mine"),
        folder.path().join(".tmp-bem-x"),
        folder.path().join(".old-bem"),
        folder.path().join(".asperity-new-bem-AbCdEf"),
        folder.path().join(".asperity-notes"),
        solves.join(".asperity-notes.json-AbCdEf"),
        solves.join(".tmp-x"),
    ];
    for file in &foreign {
        fs::write(file, "mine").unwrap();
    }
    // A kill before the list, within it and at its end.
    let folders = ["none", "begun", "ended"].map(|kill| {
        let path = folder.path().join(format!(".asperity-new-bem-{kill}"));
        fs::create_dir(&path).unwrap();
        path
    });
    for path in &folders[1..] {
        let mark = "asperity is writing here, and removes what .asperity-files lists";
        std::os::unix::fs::symlink(mark, path.join(".asperity")).unwrap();
    }
    fs::write(folders[1].join(".asperity-files"), "").unwrap();
    // The same without the mark is not known.
    let unknown = folder.path().join(".asperity-new-bem-unknown");
    fs::create_dir(&unknown).unwrap();
    fs::write(unknown.join(".asperity-files"), "").unwrap();
    RunFolder::open(folder.path()).unwrap();
    for file in &foreign {
        assert_eq!(fs::read(file).unwrap(), b"mine", "{}", file.display());
    }
    // Of asperity's own nothing is left.
    assert_eq!(entries(begun.parent().unwrap()), ["mine"]);
    assert!(!half.exists() && folders.iter().all(|folder| !folder.exists()));
    assert!(unknown.join(".asperity-files").exists());
}

#[test]
fn a_place_that_is_not_asperitys_is_refused_and_stays() {
    let folder = tempfile::tempdir().unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    fs::write(elsewhere.path().join("scan.txt"), "mine").unwrap();
    let place = folder.path().join("bem");
    let makes: [(&str, &dyn Fn()); 5] = [
        ("bem was not written", &|| fs::write(&place, "mine").unwrap()),
        ("scan.txt is in a folder", &|| {
            fs::create_dir(&place).unwrap();
            fs::write(place.join("scan.txt"), "mine").unwrap();
        }),
        ("manifest.json cannot be used", &|| {
            fs::create_dir(&place).unwrap();
            fs::write(place.join("manifest.json"), "{}").unwrap();
        }),
        ("that of the stage fem", &|| {
            fs::create_dir(&place).unwrap();
            let manifest = r#"{"schema": "asperity.manifest", "stage": "fem", "outputs": []}"#;
            fs::write(place.join("manifest.json"), manifest).unwrap();
        }),
        ("bem is a link", &|| std::os::unix::fs::symlink(elsewhere.path(), &place).unwrap()),
    ];
    for (said, make) in makes {
        make();
        let before = super::tree(folder.path());
        for run in [RunFolder::open(folder.path()), RunFolder::share(folder.path())] {
            let refused = commit(&run.unwrap(), 1).unwrap_err().to_string();
            assert!(refused.contains(said), "{said}: {refused}");
        }
        fs::remove_file(folder.path().join(".lock")).unwrap();
        assert_eq!(super::tree(folder.path()), before, "{said}");
        assert_eq!(super::tree(elsewhere.path()).len(), 1);
        if place.is_dir() && !place.is_symlink() {
            fs::remove_dir_all(&place).unwrap();
        } else {
            fs::remove_file(&place).unwrap();
        }
    }
    // An empty folder has nothing to lose.
    fs::create_dir(&place).unwrap();
    commit(&RunFolder::open(folder.path()).unwrap(), 1).unwrap();
}

#[test]
fn a_file_of_the_name_of_the_lock_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(".lock");
    for text in ["mine", "process 12, said I", "process \n"] {
        fs::write(&path, text).unwrap();
        let refused = RunFolder::open(folder.path()).unwrap_err();
        assert!(matches!(refused, ArtifactError::Foreign { .. }), "{refused}");
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
    // An empty one may be that of a run that was killed as it made it, or another's: it is used and stays empty.
    fs::write(&path, "").unwrap();
    RunFolder::open(folder.path()).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"");
    // That of an earlier version.
    fs::write(&path, "process 4711\n").unwrap();
    RunFolder::open(folder.path()).unwrap();
    assert!(fs::read_to_string(&path).unwrap().contains(&std::process::id().to_string()));
}
