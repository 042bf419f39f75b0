//! Run folders that something happened to.

use super::{Campaign, STAGES, digests, recipe, run, stale, try_run};
use asperity::artifact::{ArtifactError, RunFolder, RunView};
use asperity::pipeline::{PipelineError, Selection};
use asperity::stages::Stage;
use std::fs;
use std::path::{Path, PathBuf};

fn outputs(out: &Path) -> Vec<(Stage, String)> {
    let view = RunView::of(out);
    let files = |stage: Stage| {
        let manifest = view.stage_manifest(stage.name()).unwrap().unwrap();
        manifest.outputs.into_iter().map(move |output| (stage, output.file)).collect::<Vec<_>>()
    };
    STAGES.into_iter().flat_map(files).collect()
}

/// What happens to the bytes of a file.
type Damage = (&'static str, fn(&mut Vec<u8>));

#[test]
fn every_damaged_file_is_named_and_made_again() {
    let campaign = Campaign::new();
    let (recipe, out) = (recipe(&campaign), campaign.path("out"));
    run(&recipe, &out);
    let before = digests(&out);
    let damages: [Damage; 4] = [
        ("truncated", |bytes| bytes.truncate(bytes.len() / 2)),
        ("one bit flipped", |bytes| {
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
        }),
        ("emptied", Vec::clear),
        ("longer", |bytes| bytes.push(0)),
    ];
    for (i, (stage, file)) in outputs(&out).into_iter().enumerate() {
        let (damage, apply) = damages[i % damages.len()];
        let path = out.join(stage.name()).join(&file);
        let mut bytes = fs::read(&path).unwrap();
        apply(&mut bytes);
        fs::write(&path, bytes).unwrap();
        let found = stale(&recipe, &out);
        assert_eq!(found[0].0, stage, "{file} {damage}");
        assert!(found[0].1.contains(&file), "{file} {damage}: {}", found[0].1);
        // The result is the same, so nothing after it is computed again.
        assert_eq!(run(&recipe, &out), [stage], "{file} {damage}");
        assert_eq!(digests(&out), before, "{file} {damage}");
    }
}

/// What is left is not known as asperity's, which a run says in place of removing it.
const KNOWN_NO_MORE: [&str; 4] =
    ["no manifest", "half a manifest", "the manifest of another stage", "a file for a folder"];

#[test]
fn missing_and_foreign_files_and_manifests_are_made_again() {
    let campaign = Campaign::new();
    let (recipe, out) = (recipe(&campaign), campaign.path("out"));
    run(&recipe, &out);
    let before = digests(&out);
    let in_out = |path: &str| out.join(path);
    let accidents: [(&str, &str, &dyn Fn()); 6] = [
        ("no file", "bem", &|| fs::remove_file(in_out("bem/curves.arrow")).unwrap()),
        ("another table", "bem", &|| {
            fs::copy(in_out("tables/friction.arrow"), in_out("bem/curves.arrow"))
                .map(drop)
                .unwrap();
        }),
        ("no manifest", "realise", &|| fs::remove_file(in_out("realise/manifest.json")).unwrap()),
        ("half a manifest", "approximate", &|| {
            fs::write(in_out("approximate/manifest.json"), "{\"schema\":").unwrap();
        }),
        ("the manifest of another stage", "tables", &|| {
            fs::copy(in_out("bem/manifest.json"), in_out("tables/manifest.json"))
                .map(drop)
                .unwrap();
        }),
        ("a file for a folder", "tables", &|| {
            fs::remove_dir_all(in_out("tables")).unwrap();
            fs::write(in_out("tables"), "mine").unwrap();
        }),
    ];
    for (accident, stage, happen) in accidents {
        happen();
        let found = stale(&recipe, &out);
        assert_eq!(found[0].0.name(), stage, "{accident}");
        let place = in_out(stage);
        if KNOWN_NO_MORE.contains(&accident) {
            let refused = try_run(&recipe, &out, Selection::default()).unwrap_err();
            assert!(matches!(refused, PipelineError::Artifact(ArtifactError::Foreign { .. })));
            assert!(refused.to_string().contains(place.to_str().unwrap()), "{refused}");
            if place.is_dir() {
                fs::remove_dir_all(&place).unwrap();
            } else {
                assert_eq!(fs::read(&place).unwrap(), b"mine");
                fs::remove_file(&place).unwrap();
            }
        }
        run(&recipe, &out);
        assert_eq!((digests(&out), stale(&recipe, &out)), (before.clone(), vec![]), "{accident}");
    }
}

/// Two accidents at once: what cannot be read must not hide what is missing after it.
#[test]
fn status_survives_several_unreadable_manifests() {
    let campaign = Campaign::new();
    let (recipe, out) = (recipe(&campaign), campaign.path("out"));
    run(&recipe, &out);
    fs::write(out.join("approximate/manifest.json"), "{").unwrap();
    fs::remove_dir_all(out.join("realise")).unwrap();
    fs::write(out.join("bem/manifest.json"), "{").unwrap();
    let found = stale(&recipe, &out);
    let reasons: Vec<&str> = found.iter().map(|(_, reason)| reason.as_str()).collect();
    assert!(reasons[0].contains("approximate/manifest.json cannot be read as manifest"));
    assert_eq!(reasons[1], "not computed yet");
    assert!(reasons[2].contains("bem/manifest.json cannot be read as manifest"));
    assert_eq!(reasons[3], "approximate is stale");
    for stage in ["approximate", "bem"] {
        let refused = try_run(&recipe, &out, Selection::default()).unwrap_err().to_string();
        let advice = format!("{} is yours, delete that folder", out.join(stage).display());
        assert!(refused.contains(&advice), "{refused}");
        fs::remove_dir_all(out.join(stage)).unwrap();
    }
    run(&recipe, &out);
    assert_eq!(stale(&recipe, &out), []);
}

#[test]
fn a_damaged_solve_is_solved_again_and_the_others_are_not() {
    let campaign = Campaign::new();
    let (recipe, out) = (recipe(&campaign), campaign.path("out"));
    run(&recipe, &out);
    let before = digests(&out);
    let solves: Vec<PathBuf> = fs::read_dir(out.join("solves"))
        .unwrap()
        .flat_map(|folder| fs::read_dir(folder.unwrap().path()).unwrap())
        .map(|file| file.unwrap().path())
        .collect();
    let damaged = 3;
    fs::write(&solves[0], "").unwrap();
    let half = fs::read(&solves[1]).unwrap();
    fs::write(&solves[1], &half[..half.len() / 2]).unwrap();
    let text = fs::read_to_string(&solves[2]).unwrap();
    fs::write(
        &solves[2],
        text.replacen("\"friction_coefficient\":0.", "\"friction_coefficient\":1.", 1),
    )
    .unwrap();
    assert_ne!(fs::read_to_string(&solves[2]).unwrap(), text);
    let modified = |path: &PathBuf| fs::metadata(path).unwrap().modified().unwrap();
    let times: Vec<_> = solves.iter().map(modified).collect();
    // With its result in place the stage would not look at its solves.
    fs::remove_dir_all(out.join("bem")).unwrap();
    run(&recipe, &out);
    assert_eq!(digests(&out), before);
    let unchanged: Vec<_> = solves.iter().map(modified).zip(&times).map(|(a, b)| a == *b).collect();
    assert_eq!(unchanged[..damaged], [false; 3]);
    assert!(unchanged[damaged..].iter().all(|same| *same));
}

#[test]
fn a_second_run_in_the_same_folder_says_so_and_ends() {
    let campaign = Campaign::new();
    let lock = RunFolder::open(campaign.path("out")).unwrap();
    let output = campaign.command("run recipe.toml --out out").output().unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
    let message = String::from_utf8(output.stderr).unwrap();
    let holder = format!("(process {})", std::process::id());
    assert!(message.contains(&format!("using out {holder}: wait for it or choose another --out")));
    drop(lock);
    assert!(campaign.command("run recipe.toml --out out").output().unwrap().status.success());
}

#[test]
fn what_a_killed_export_left_in_the_folder_does_not_stop_a_run() {
    let campaign = Campaign::new();
    let (recipe, out) = (recipe(&campaign), campaign.path("out"));
    run(&recipe, &out);
    fs::write(out.join(".tmp-x1y2z3"), "half a table").unwrap();
    assert_eq!(run(&recipe, &out), []);
}
