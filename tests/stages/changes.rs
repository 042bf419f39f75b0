//! What a change of the recipe, the rubber or a scan makes stale, and what it does not.

use super::{Campaign, STAGES, digests, recipe, run, stale, try_run};
use asperity::pipeline::Selection;
use asperity::stages::{Stage, approximate, bem, characterise, ingest, realise, tables};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Modification times of the stored solves.
fn solves(out: &Path) -> BTreeMap<PathBuf, SystemTime> {
    let mut files = BTreeMap::new();
    for folder in std::fs::read_dir(out.join("solves")).unwrap() {
        for file in std::fs::read_dir(folder.unwrap().path()).unwrap() {
            let file = file.unwrap();
            files.insert(file.path(), file.metadata().unwrap().modified().unwrap());
        }
    }
    files
}

#[test]
fn a_second_run_computes_nothing() {
    let campaign = Campaign::new();
    let (recipe, out) = (recipe(&campaign), campaign.path("out"));
    assert_eq!(stale(&recipe, &out).len(), 6);
    assert_eq!(run(&recipe, &out), STAGES);
    let (first, files) = (digests(&out), solves(&out));
    assert_eq!(stale(&recipe, &out), []);
    assert_eq!(run(&recipe, &out), []);
    let only = Selection { only: Some(bem::STAGE), ..Selection::default() };
    assert_eq!(try_run(&recipe, &out, only).unwrap(), []);
    assert_eq!((digests(&out), solves(&out)), (first, files));
}

#[test]
fn a_forced_stage_is_computed_again_with_the_same_result() {
    let campaign = Campaign::new();
    let (recipe, out) = (recipe(&campaign), campaign.path("out"));
    run(&recipe, &out);
    let (first, files) = (digests(&out), solves(&out));
    let force = Selection { force: Some(bem::STAGE), ..Selection::default() };
    assert_eq!(try_run(&recipe, &out, force).unwrap(), [bem::STAGE]);
    assert_eq!(digests(&out), first);
    let again = solves(&out);
    assert!(again.keys().eq(files.keys()));
    assert!(again.iter().all(|(file, time)| files[file] < *time), "stored solves were reused");
}

#[test]
fn another_speed_costs_the_solves_of_that_speed_only() {
    let campaign = Campaign::new();
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let first = solves(&out);
    campaign.edit("recipe.toml", "[10.0]", "[10.0, 50.0]");
    let wanted = recipe(&campaign);
    let reasons = stale(&wanted, &out);
    assert_eq!(reasons[0], (bem::STAGE, "bem.speeds_mm_s: [10.0] -> [10.0,50.0]".into()));
    assert_eq!(reasons[1], (tables::STAGE, "bem is stale".into()));
    assert_eq!(run(&wanted, &out), [bem::STAGE, tables::STAGE]);
    let second = solves(&out);
    assert!(second.len() > first.len());
    assert!(first.iter().all(|(file, time)| second[file] == *time));
    // Back to the one speed: all its solves are there.
    campaign.edit("recipe.toml", "[10.0, 50.0]", "[10.0]");
    assert_eq!(run(&recipe(&campaign), &out), [bem::STAGE, tables::STAGE]);
    assert_eq!(solves(&out), second);
}

#[test]
fn each_change_makes_the_right_stages_stale_for_the_right_reason() {
    let changes: [(&str, &str, &str, Stage, &str); 12] = [
        ("recipe.toml", "seed = 1", "seed = 2", realise::STAGE, "realise.seed: 1 -> 2"),
        (
            "recipe.toml",
            "realisations = 2",
            "realisations = 3",
            realise::STAGE,
            "realise.realisations: 2 -> 3",
        ),
        ("recipe.toml", "[2, 3]", "[3]", approximate::STAGE, "approximate.waves: [2,3] -> [3]"),
        (
            "recipe.toml",
            "\"slope\"",
            "\"mean\"",
            ingest::STAGE,
            r#"ingest.conditioning.form: "slope" -> "mean""#,
        ),
        (
            "recipe.toml",
            "tolerance = 5e-3",
            "tolerance = 4e-3",
            bem::STAGE,
            "bem.tolerance: 0.005 -> 0.004",
        ),
        (
            "recipe.toml",
            "[characterise]",
            "[characterise]\nlags_per_decade = 19",
            characterise::STAGE,
            "characterise.lags_per_decade: 20 -> 19",
        ),
        (
            "recipe.toml",
            "[characterise]",
            "[characterise]\nlongest_lag_mm = 3.0",
            characterise::STAGE,
            "characterise.longest_lag_mm: not set -> 3.0",
        ),
        (
            "rubber.toml",
            "= 4.0",
            "= 4.5",
            bem::STAGE,
            "bem.rubber.equilibrium_modulus: 4000000.0 -> 4500000.0",
        ),
        ("rubber.toml", "1e-5", "2e-5", bem::STAGE, "bem.rubber.branches: "),
        (
            "scans/track_1.txt",
            "# made by a test",
            "# made by a tesT",
            ingest::STAGE,
            "track_1 has changed",
        ),
        (
            "recipe.toml",
            r#"["scans"]"#,
            r#"["scans/track_0.txt", "scans/track_2.txt"]"#,
            ingest::STAGE,
            "track_1 is gone",
        ),
        ("recipe.toml", r#"["scans"]"#, r#"["scans", "more.txt"]"#, ingest::STAGE, "more is new"),
    ];
    let campaign = Campaign::new();
    campaign.write("more.txt", &campaign.read("scans/track_0.txt"));
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    for (file, from, to, first, reason) in changes {
        let before = campaign.read(file);
        campaign.edit(file, from, to);
        let found = stale(&recipe(&campaign), &out);
        campaign.write(file, &before);
        let stages: Vec<_> = found.iter().map(|(stage, _)| *stage).collect();
        let expected: Vec<_> = STAGES.into_iter().filter(|stage| *stage >= first).collect();
        assert_eq!(stages, expected, "{file}: {to}");
        assert!(found[0].1.starts_with(reason), "{reason}: found {}", found[0].1);
        let inherited = format!("{first} is stale");
        assert!(found[1..].iter().all(|(_, why)| *why == inherited), "{found:?}");
    }
    assert_eq!(stale(&recipe(&campaign), &out), []);
}

#[test]
fn what_determines_no_number_makes_nothing_stale() {
    let campaign = Campaign::new();
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    std::fs::rename(campaign.path("scans"), campaign.path("elsewhere")).unwrap();
    std::fs::rename(campaign.path("rubber.toml"), campaign.path("tread.toml")).unwrap();
    campaign.edit("recipe.toml", r#"["scans"]"#, r#"["elsewhere"]"#);
    campaign.edit("recipe.toml", "\"rubber.toml\"", "\"tread.toml\"");
    campaign.edit("recipe.toml", "Small campaign", "Another title");
    assert_eq!(stale(&recipe(&campaign), &out), []);
}

/// A scan whose bytes change but not its numbers is read again, and that is all.
#[test]
fn equal_results_stop_a_rerun_from_spreading() {
    let campaign = Campaign::new();
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    campaign.edit("recipe.toml", r#"missing = ["BAD"]"#, r#"missing = ["BAD", "-9999"]"#);
    assert_eq!(run(&recipe(&campaign), &out), [ingest::STAGE]);
    assert_eq!(stale(&recipe(&campaign), &out), []);
}

#[test]
fn a_selected_stage_with_stale_inputs_says_what_to_do() {
    let campaign = Campaign::new();
    let (recipe, out) = (recipe(&campaign), campaign.path("out"));
    let only = |stage| Selection { only: Some(stage), ..Selection::default() };
    let from = |stage| Selection { from: Some(stage), ..Selection::default() };
    let refused = try_run(&recipe, &out, only(bem::STAGE)).unwrap_err().to_string();
    assert_eq!(
        refused,
        "bem needs the results of ingest, which is stale (not computed yet); run without --only \
         and --from, or with --from ingest"
    );
    assert_eq!(try_run(&recipe, &out, only(ingest::STAGE)).unwrap(), [ingest::STAGE]);
    let refused = try_run(&recipe, &out, from(realise::STAGE)).unwrap_err().to_string();
    assert!(refused.contains("with --from characterise"), "{refused}");
    assert_eq!(try_run(&recipe, &out, from(characterise::STAGE)).unwrap(), STAGES[1..]);
}
