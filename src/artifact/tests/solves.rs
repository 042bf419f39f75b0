use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use serde::{Deserialize, Serialize};

use crate::artifact::{ArtifactError, Digest, SolveStore};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Solve {
    friction: f64,
    area_fraction: Option<f64>,
    pressures: Vec<f64>,
    seed: u64,
}

fn solve() -> Solve {
    Solve {
        friction: 0.1 + 0.2,
        area_fraction: None,
        pressures: vec![1e-300, -0.0],
        seed: u64::MAX,
    }
}

fn key() -> Digest {
    Digest::of_bytes(b"solve")
}

fn file_of(dir: &Path, key: &Digest) -> PathBuf {
    dir.join(&key.to_string()[..2]).join(format!("{key}.json"))
}

#[test]
fn a_result_comes_back_under_its_key_alone() {
    let folder = tempfile::tempdir().unwrap();
    let store = SolveStore::open(folder.path().join("cache")).unwrap();
    assert_eq!(store.get::<Solve>(&key()).unwrap(), None);
    store.put(&key(), &solve()).unwrap();
    assert_eq!(store.get(&key()).unwrap(), Some(solve()));
    assert_eq!(store.get::<Solve>(&Digest::of_bytes(b"other")).unwrap(), None);
    let files = fs::read_dir(file_of(&folder.path().join("cache"), &key()).parent().unwrap());
    assert_eq!(files.unwrap().count(), 1, "no temporary file stays");
}

proptest! {
    #[test]
    fn every_finite_float_comes_back_to_the_bit(values in prop::collection::vec(any::<f64>(), 0..20)) {
        let folder = tempfile::tempdir().unwrap();
        let store = SolveStore::open(folder.path()).unwrap();
        store.put(&key(), &values).unwrap();
        let found: Vec<f64> = store.get(&key()).unwrap().unwrap();
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&found), bits(&values));
    }
}

#[test]
fn a_nan_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let store = SolveStore::open(folder.path()).unwrap();
    let error = store.put(&key(), &Solve { friction: f64::NAN, ..solve() }).unwrap_err();
    assert!(matches!(error, ArtifactError::NotRepresentable { .. }), "{error}");
    assert_eq!(store.get::<Solve>(&key()).unwrap(), None);
}

#[test]
fn a_file_cut_or_flipped_anywhere_is_absent_and_removed() {
    let folder = tempfile::tempdir().unwrap();
    let store = SolveStore::open(folder.path()).unwrap();
    store.put(&key(), &solve()).unwrap();
    let path = file_of(folder.path(), &key());
    let bytes = fs::read(&path).unwrap();
    let flipped = (0..bytes.len()).map(|index| {
        let mut flipped = bytes.clone();
        flipped[index] ^= 1;
        flipped
    });
    let cut = (0..bytes.len()).map(|length| bytes[..length].to_vec());
    for damaged in flipped.chain(cut) {
        fs::write(&path, &damaged).unwrap();
        let found = store.get::<Solve>(&key()).unwrap();
        // Only a change that JSON takes for the same number may pass, such as 1e-300 to 1E-300.
        assert!(found.is_none() || found == Some(solve()), "{found:?}");
        assert_eq!(path.exists(), found.is_some());
    }
}

#[test]
fn another_version_key_or_type_is_absent() {
    let folder = tempfile::tempdir().unwrap();
    let store = SolveStore::open(folder.path()).unwrap();
    let path = file_of(folder.path(), &key());
    store.put(&key(), &solve()).unwrap();
    let text = fs::read_to_string(&path).unwrap();

    fs::write(&path, text.replace("\"version\":1", "\"version\":2")).unwrap();
    assert_eq!(store.get::<Solve>(&key()).unwrap(), None);

    let other = Digest::of_bytes(b"other");
    fs::create_dir_all(file_of(folder.path(), &other).parent().unwrap()).unwrap();
    fs::write(file_of(folder.path(), &other), &text).unwrap();
    assert_eq!(store.get::<Solve>(&other).unwrap(), None);

    store.put(&key(), &solve()).unwrap();
    assert_eq!(store.get::<Vec<f64>>(&key()).unwrap(), None);
}

#[test]
fn writers_of_one_key_do_not_disturb_readers() {
    let folder = tempfile::tempdir().unwrap();
    let store = SolveStore::open(folder.path()).unwrap();
    store.put(&key(), &solve()).unwrap();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..50 {
                    store.put(&key(), &solve()).unwrap();
                    assert_eq!(store.get(&key()).unwrap(), Some(solve()));
                }
            });
        }
    });
}

/// Of one problem, with the solves under these keys and their tasks finished.
fn finish(store: &SolveStore, problem: &Digest, tasks: &[Digest]) {
    let mut solves = store.problem(problem).unwrap();
    for task in tasks {
        solves.put(task, &solve()).unwrap();
        solves.finish(task).unwrap();
    }
}

#[test]
fn a_packed_store_keeps_all_solves_of_a_problem_in_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let store = SolveStore::open_packed(folder.path()).unwrap();
    let (problem, tasks) = (key(), [b"a", b"b"].map(|name| Digest::of_bytes(name)));
    assert_eq!(store.pack_info(&problem).unwrap(), None);
    finish(&store, &problem, &tasks);
    let info = store.pack_info(&problem).unwrap().unwrap();
    assert_eq!((info.solves, info.finished.len()), (2, 2));
    assert_eq!(fs::read_dir(store.pack_path(&problem).parent().unwrap()).unwrap().count(), 1);
    // A store of single files reads it too.
    let single = SolveStore::open(folder.path()).unwrap();
    let solves = single.problem(&problem).unwrap();
    assert_eq!(solves.get(&tasks[1]).unwrap(), Some(solve()));
    assert!(solves.is_finished(&tasks[0]) && !solves.is_finished(&problem));
}

/// Two copies of a shard, one of which read the file before the other wrote to it.
#[test]
fn who_writes_last_keeps_what_the_other_has_finished() {
    let folder = tempfile::tempdir().unwrap();
    let store = SolveStore::open_packed(folder.path()).unwrap();
    let (problem, tasks) = (key(), [b"a", b"b", b"c"].map(|name| Digest::of_bytes(name)));
    let mut behind = store.problem(&problem).unwrap();
    behind.put(&tasks[2], &solve()).unwrap();
    finish(&store, &problem, &tasks[..2]);
    // Saves by being dropped, as when it is interrupted.
    drop(behind);
    let info = store.pack_info(&problem).unwrap().unwrap();
    assert_eq!((info.solves, info.finished.len()), (3, 2));
}

#[test]
fn a_pack_that_is_not_as_it_was_written_counts_as_absent() {
    let folder = tempfile::tempdir().unwrap();
    let store = SolveStore::open_packed(folder.path()).unwrap();
    let (problem, task) = (key(), Digest::of_bytes(b"a"));
    finish(&store, &problem, &[task]);
    let path = store.pack_path(&problem);
    let intact = fs::read(&path).unwrap();
    for byte in (0..intact.len()).step_by(7) {
        let mut bytes = intact.clone();
        bytes[byte] ^= 1;
        fs::write(&path, &bytes).unwrap();
        assert!(store.pack_info(&problem).is_err(), "byte {byte}");
        assert!(!store.problem(&problem).unwrap().is_finished(&task), "byte {byte}");
    }
    finish(&store, &problem, &[task]);
    assert!(store.pack_info(&problem).is_ok());
}

/// A stage that is computed again finds nothing of before, and takes nothing from other stages.
#[test]
fn a_store_that_is_filled_anew_keeps_what_it_does_not_replace() {
    let folder = tempfile::tempdir().unwrap();
    let store = SolveStore::open(folder.path()).unwrap();
    let other = Digest::of_bytes(b"of another stage");
    store.put(&key(), &solve()).unwrap();
    store.put(&other, &solve()).unwrap();
    let anew = store.clone().anew();
    assert_eq!(anew.get::<Solve>(&key()).unwrap(), None);
    let changed = Solve { friction: 0.7, ..solve() };
    anew.problem(&key()).unwrap().put(&key(), &changed).unwrap();
    assert_eq!(anew.clone().get(&key()).unwrap(), Some(changed.clone()));
    assert_eq!(store.get(&key()).unwrap(), Some(changed));
    assert_eq!(store.get(&other).unwrap(), Some(solve()));
}

/// A link would lead writes and removals to what others own.
#[test]
fn a_store_is_not_reached_through_links_of_others() {
    let (folder, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let link = folder.path().join("solves");
    std::os::unix::fs::symlink(elsewhere.path(), &link).unwrap();
    let refused = SolveStore::open(&link).unwrap_err();
    assert!(matches!(refused, ArtifactError::Foreign { .. }), "{refused}");
    let store = SolveStore::open(folder.path().join("own")).unwrap();
    let shelf = file_of(&folder.path().join("own"), &key()).parent().unwrap().to_owned();
    std::os::unix::fs::symlink(elsewhere.path(), shelf).unwrap();
    assert!(matches!(store.put(&key(), &solve()), Err(ArtifactError::Foreign { .. })));
    assert_eq!(fs::read_dir(elsewhere.path()).unwrap().count(), 0);
}
