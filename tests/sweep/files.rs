//! The folders of a sweep: every case is a run folder, and the whole can be moved.

use super::{campaign, quietly, solved, tables};
use std::fs;

#[test]
fn a_case_is_a_run_folder_with_a_recipe_of_its_own() {
    let campaign = campaign();
    let plan = solved(&campaign, "out", 2);
    quietly(&campaign, &format!("sweep collect {plan}")).result();
    let case = "out/cases/specimen=B/temperature_c=40/seed=2";
    let status = quietly(&campaign, &format!("status {case}/recipe.toml --out {case}")).result();
    assert!(!status.contains("stale"), "{status}");
    quietly(&campaign, &format!("verify {case}")).result();
    let table = quietly(&campaign, &format!("export {case} --format markdown --speed 10"));
    assert!(table.result().contains("rubber tread at 40 °C"));
    quietly(&campaign, &format!("report {case} --to report.html")).result();
    let whole = quietly(&campaign, "report out --to whole.html").error(2);
    assert!(whole.contains("the folder of a sweep") && whole.contains("out/cases"), "{whole}");
    // A run in it continues from what is there.
    let run = quietly(&campaign, &format!("run {case}/recipe.toml --out {case} --json")).json();
    let stages = run["stages"].as_array().unwrap();
    assert!(stages.len() > 5 && stages.iter().all(|stage| stage["computed"] == false), "{run}");
}

#[test]
fn a_sweep_can_be_moved() {
    let campaign = campaign();
    let plan = solved(&campaign, "out", 2);
    fs::rename(campaign.path("out"), campaign.path("moved")).unwrap();
    let moved = plan.replacen("/out/", "/moved/", 1);
    quietly(&campaign, &format!("sweep collect {moved}")).result();
    quietly(&campaign, "verify moved").result();
    assert!(!tables(&campaign, "moved").is_empty());
}

#[test]
fn verify_finds_what_is_damaged_anywhere_in_a_sweep() {
    let campaign = campaign();
    let plan = solved(&campaign, "out", 1);
    quietly(&campaign, &format!("sweep collect {plan}")).result();
    let files = [
        "sweep/friction.arrow",
        "cases/specimen=A/temperature_c=10/seed=1/bem/curves.arrow",
        "surfaces/specimen=B/seed=2/realise/surfaces.arrow",
        "surfaces/specimen=B/seed=1/ingest/scans.h5",
    ];
    for file in files {
        let path = campaign.path("out").join(file);
        let intact = fs::read(&path).unwrap();
        let mut bytes = intact.clone();
        *bytes.last_mut().unwrap() ^= 1;
        fs::write(&path, bytes).unwrap();
        let outcome = quietly(&campaign, "verify out");
        assert_eq!(outcome.code, 1, "{file}");
        assert!(outcome.stdout.contains(file), "{file}: {}", outcome.stdout);
        fs::write(&path, intact).unwrap();
    }
    quietly(&campaign, "verify out").result();
}
