//! `asperity bench`: the structure of its results; figures are for an idle machine.

use std::fs;

use super::{asperity, asperity_at};

#[test]
fn every_case_has_a_table() {
    let text = asperity("bench --quick --quiet").result();
    let cases: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    let expected = [
        "half-space-1-wave",
        "half-space-3-waves",
        "half-space-8-waves",
        "finite-deformation",
        "hybrid",
        "correlation",
        "spectrum",
    ];
    assert_eq!(cases, expected);
    // Eleven methods, two values each.
    assert_eq!(text.lines().filter(|line| line.ends_with("| 1 |")).count(), 22);
}

#[test]
fn cases_are_chosen_by_name() {
    let chosen = "bench --quick --quiet --case half-space-3-waves --case spectrum --format json";
    let results = asperity(chosen).json();
    assert_eq!(results[0]["case"], "half-space-3-waves");
    assert_eq!(results[1]["lines"].as_array().unwrap().len(), 2);
    assert!(results[0]["lines"][0]["points"][1]["relative_error"].as_f64().unwrap() > 0.0);
    let unknown = asperity("bench --quick --case sine").error(2);
    assert!(unknown.contains("no case sine: choose from half-space-1-wave, half-space-3-waves"));
    let plot = asperity("bench --quick --growth --format svg").error(2);
    assert!(plot.contains("--growth has no plot"));
}

#[test]
fn a_document_keeps_its_words_and_gets_a_plot() {
    let folder = tempfile::tempdir().unwrap();
    let (page, plot) = (folder.path().join("page.md"), folder.path().join("page.svg"));
    let command = "bench --quick --quiet --case half-space-1-wave --to {}";
    fs::write(&page, "Mine.\n").unwrap();
    assert!(asperity_at(command, &page).error(2).contains("exists already"));
    fs::write(&page, "Mine.\n<!-- bench: begin -->\nold\n<!-- bench: end -->\nToo.\n").unwrap();
    asperity_at(command, &page).result();
    let text = fs::read_to_string(&page).unwrap();
    assert!(text.starts_with("Mine.\n") && text.ends_with("\nToo.\n") && !text.contains("old"));
    assert!(text.contains("| half-space, 1 wave | points | 64 |"));
    assert!(fs::read_to_string(&plot).unwrap().starts_with("<svg"));
}

#[test]
#[ignore = "takes minutes: .ci/full"]
fn growth_runs_each_size_in_its_own_process() {
    let series = asperity("bench --growth --quick --quiet --format json").json();
    let over: Vec<&str> =
        series.as_array().unwrap().iter().map(|series| series["over"].as_str().unwrap()).collect();
    assert_eq!(over, ["points", "waves", "realisations", "realisations", "threads"]);
    let first = &series[0]["rows"][0];
    assert_eq!(
        (first["size"].as_u64(), first["sample"]["solve"]["points"].as_u64()),
        (Some(1024), Some(1024))
    );
    let memory = first["sample"]["memory_bytes"].as_u64();
    assert_eq!(memory.is_some(), cfg!(target_os = "linux"));
}
