//! `cargo xtask bench`: the structure of its results; numbers are for an idle machine.

use std::fs;
use std::process::{Command, Output};

fn xtask(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_xtask")).args(arguments).output().unwrap()
}

/// Standard output of a success without a message.
fn result(arguments: &[&str]) -> String {
    let output = xtask(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), &*message), (Some(0), ""));
    String::from_utf8(output.stdout).unwrap()
}

fn json(arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&result(arguments)).unwrap()
}

/// The message that refuses what was given.
fn refusal(arguments: &[&str]) -> String {
    let output = xtask(arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{message}");
    message
}

fn words(arguments: &str) -> Vec<&str> {
    arguments.split(' ').collect()
}

#[test]
fn every_case_has_a_table() {
    let text = result(&words("bench --quick --quiet"));
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
    let results = json(&words(chosen));
    assert_eq!(results[0]["case"], "half-space-3-waves");
    assert_eq!(results[1]["lines"].as_array().unwrap().len(), 2);
    assert!(results[0]["lines"][0]["points"][1]["relative_error"].as_f64().unwrap() > 0.0);
    let unknown = refusal(&words("bench --quick --case sine"));
    assert!(unknown.contains("no case sine: choose from half-space-1-wave, half-space-3-waves"));
    let plot = refusal(&words("bench --quick --growth --format svg"));
    assert!(plot.contains("--growth has no plot"));
    let nowhere = refusal(&words("bench --quick --to nowhere/page.md"));
    assert!(nowhere.contains("there is no folder nowhere"));
}

#[test]
fn a_document_keeps_its_words_and_gets_a_plot() {
    let folder = tempfile::tempdir().unwrap();
    let (page, plot) = (folder.path().join("page.md"), folder.path().join("page.svg"));
    let mut command = words("bench --quick --quiet --case half-space-1-wave --to");
    command.push(page.to_str().unwrap());
    fs::write(&page, "Mine.\n").unwrap();
    assert!(refusal(&command).contains("exists already"));
    fs::write(&page, "Mine.\n<!-- bench: begin -->\nold\n<!-- bench: end -->\nToo.\n").unwrap();
    result(&command);
    let text = fs::read_to_string(&page).unwrap();
    assert!(text.starts_with("Mine.\n") && text.ends_with("\nToo.\n") && !text.contains("old"));
    assert!(text.contains("| half-space, 1 wave | points | 64 |"));
    assert!(fs::read_to_string(&plot).unwrap().starts_with("<svg"));
}

#[test]
#[ignore = "takes minutes: .ci/full"]
fn growth_runs_each_size_in_its_own_process() {
    let series = json(&words("bench --growth --quick --quiet --format json"));
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
