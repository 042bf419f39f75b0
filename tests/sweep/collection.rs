//! What is missing, damaged or foreign is named with its shard, and nothing of it gets into a table.

use super::{alone, campaign, packs, plan, quietly, solved, tables};
use asperity::artifact::{Digest, read_table};
use asperity::sweep::SweepFrictionRow;
use serde_json::Value;
use std::fs;
use std::path::Path;

#[test]
fn shards_that_did_not_run_are_named() {
    let campaign = campaign();
    let plan = plan(&campaign, "out", 4);
    for shard in [0, 3] {
        quietly(&campaign, &format!("sweep run {plan} --shard {shard}")).result();
    }
    let error = quietly(&campaign, &format!("sweep collect {plan}")).error(1);
    assert!(error.contains("shard 1: ") && error.contains("shard 2: "), "{error}");
    assert!(!error.contains("shard 0: ") && !error.contains("shard 3: "), "{error}");
    assert!(error.contains("not solved") && error.contains("specimen="), "{error}");
    assert!(error.contains(&format!("asperity sweep run {plan} --shard 1")), "{error}");
    assert!(!campaign.path("out/sweep").exists());
    let status = quietly(&campaign, &format!("sweep status {plan}")).result();
    assert!(status.contains("2 of 4 shards complete"), "{status}");
}

/// What is done to a file with its bytes, another one being at hand.
type Damage = fn(&Path, &[u8], &Path);

/// Whatever is done to a file of solves: its task counts as missing, and its shard makes it anew.
#[test]
fn a_damaged_result_is_named_and_made_anew() {
    let campaign = campaign();
    let expected = alone(&campaign);
    let plan = solved(&campaign, "out", 3);
    let files = packs(&campaign, "out");
    let intact: Vec<Vec<u8>> = files.iter().map(|path| fs::read(path).unwrap()).collect();
    let damages: [(&str, Damage); 5] = [
        ("a flipped bit", |path, bytes, _| {
            let mut bytes = bytes.to_vec();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            fs::write(path, bytes).unwrap();
        }),
        ("cut", |path, bytes, _| fs::write(path, &bytes[..bytes.len() / 3]).unwrap()),
        ("emptied", |path, _, _| fs::write(path, b"").unwrap()),
        ("deleted", |path, _, _| fs::remove_file(path).unwrap()),
        ("of another task", |path, _, other| {
            fs::copy(other, path).unwrap();
        }),
    ];
    for (k, (what, damage)) in damages.into_iter().enumerate() {
        let (path, other) = (&files[k], &files[k + 7]);
        damage(path, &intact[k], other);
        let error = quietly(&campaign, &format!("sweep collect {plan}")).error(1);
        let shard: usize =
            error.split("shard ").nth(1).unwrap().split(':').next().unwrap().parse().unwrap();
        let shards = error.lines().filter(|line| line.trim_start().starts_with("shard "));
        assert_eq!(shards.count(), 1, "{what}: {error}");
        if what != "deleted" {
            assert!(error.contains(path.file_name().unwrap().to_str().unwrap()), "{what}: {error}");
            // The folder has the solves of other tasks too.
            assert!(!error.contains("delete its folder"), "{what}: {error}");
            let verified = quietly(&campaign, "verify out");
            assert_eq!(verified.code, 1, "{what}");
            assert!(!verified.stdout.contains("delete its folder"), "{what}: {}", verified.stdout);
        }
        quietly(&campaign, &format!("sweep run {plan} --shard {shard}")).result();
        quietly(&campaign, &format!("sweep collect {plan}")).result();
        assert_eq!(tables(&campaign, "out"), expected, "{what}");
    }
}

/// The file as an older version would have written it, with a digest that holds.
fn by_older_version(path: &Path) {
    let mut document: Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
    document["tool_version"] = "0.0.9".into();
    let mut sealed = document.clone();
    // What is measured is no part of the digest of a plan.
    if let Some(slowness) = sealed.get_mut("slowness") {
        *slowness = 0.0.into();
    }
    document["digest"] = Digest::seal_of(&sealed).unwrap().to_string().into();
    fs::write(path, serde_json::to_vec(&document).unwrap()).unwrap();
}

#[test]
fn what_an_older_version_has_solved_is_refused_by_name() {
    let campaign = campaign();
    let expected = alone(&campaign);
    let plan_path = solved(&campaign, "out", 3);
    // Those of the plan and those that were solved while it was made.
    for path in &packs(&campaign, "out") {
        by_older_version(path);
        let error = quietly(&campaign, &format!("sweep collect {plan_path}")).error(1);
        assert!(error.contains("solved by asperity 0.0.9, this is"), "{error}");
        assert!(error.contains(path.file_name().unwrap().to_str().unwrap()), "{error}");
        // A new plan solves it or lists that task alone.
        let next = plan(&campaign, "out", 1);
        let report = quietly(&campaign, &format!("sweep run {next} --shard 0 --json")).json();
        assert!(report["tasks"].as_u64().unwrap() <= 1, "{report}");
    }
    quietly(&campaign, &format!("sweep collect {plan_path}")).result();
    assert_eq!(tables(&campaign, "out"), expected);
}

#[test]
fn a_plan_of_an_older_version_is_refused_by_name() {
    let campaign = campaign();
    let plan = plan(&campaign, "out", 2);
    by_older_version(&campaign.path(&plan));
    for command in ["run --shard 0", "collect", "status", "submit --dry-run"] {
        let (name, rest) = command.split_once(' ').unwrap_or((command, ""));
        let error = quietly(&campaign, &format!("sweep {name} {plan} {rest}")).error(2);
        assert!(error.contains("made by asperity 0.0.9"), "{command}: {error}");
    }
}

#[test]
fn a_rubber_or_a_scan_that_changed_since_the_plan_is_named() {
    let campaign = campaign();
    let plan = solved(&campaign, "out", 2);
    let rubber = campaign.read("rubber.toml");
    campaign.edit("rubber.toml", "modulus_mpa = 200.0", "modulus_mpa = 201.0");
    let error = quietly(&campaign, &format!("sweep collect {plan}")).error(2);
    assert!(error.contains("rubber.toml has changed"), "{error}");
    campaign.write("rubber.toml", &rubber);
    let scan = campaign.read("scans/track_1.txt");
    campaign.write("scans/track_1.txt", &scan.replacen("0.025;", "0.025;1", 1));
    let error = quietly(&campaign, &format!("sweep collect {plan}")).error(2);
    assert!(error.contains("scans of A have changed since the plan"), "{error}");
    campaign.write("scans/track_1.txt", &scan);
    quietly(&campaign, &format!("sweep collect {plan}")).result();
}

/// A shard that is not there does not stop the tables of the cases that need nothing of it.
#[test]
fn incomplete_cases_can_be_left_out() {
    let campaign = campaign();
    alone(&campaign);
    let plan = plan(&campaign, "out", 14);
    let none = format!("sweep collect {plan} --complete-cases");
    assert!(quietly(&campaign, &none).error(1).contains("not one of 8 cases"));
    for shard in (0..14).filter(|shard| *shard != 5) {
        quietly(&campaign, &format!("sweep run {plan} --shard {shard}")).result();
    }
    let outcome = campaign.command(&none).output().unwrap();
    let notes = String::from_utf8(outcome.stderr).unwrap();
    assert!(outcome.status.success(), "{notes}");
    let left_out = notes.matches("left out, its solves are missing: specimen=").count();
    assert!((1..=2).contains(&left_out), "{notes}");
    assert!(notes.contains(&format!("{} of 8 cases, tables in", 8 - left_out)), "{notes}");
    let rows = |out: &str| {
        let path = campaign.path(out).join("sweep/friction.arrow");
        read_table::<SweepFrictionRow>(&path).unwrap().0
    };
    let (some, all) = (rows("out"), rows("alone"));
    assert_eq!(some.len(), 6 * (8 - left_out));
    assert!(some.iter().all(|row| all.contains(row)));
}
