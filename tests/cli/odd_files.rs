//! Files with odd names, and what is no file at all.

use super::common::Campaign;
use super::{Outcome, binary};
use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::PathBuf;
use std::process::Command;

/// "straße" in Latin-1, which is not UTF-8.
const LATIN: &[u8] = b"stra\xdfe";

fn latin(ending: &str) -> OsString {
    let mut name = OsStr::from_bytes(LATIN).to_owned();
    name.push(ending);
    name
}

fn run(campaign: &Campaign, arguments: &[&OsStr]) -> Outcome {
    Outcome::of(binary().current_dir(campaign.path("")).arg("--quiet").args(arguments))
}

/// Arguments from a text, with the Latin-1 name for each `@`.
fn words(text: &str) -> Vec<OsString> {
    let word = |word: &str| match word.split_once('@') {
        None => OsString::from(word),
        Some((before, after)) => {
            let mut name = OsString::from(before);
            name.push(latin(after));
            name
        }
    };
    text.split_whitespace().map(word).collect()
}

fn told(campaign: &Campaign, text: &str) -> Outcome {
    let words = words(text);
    run(campaign, &words.iter().map(OsString::as_os_str).collect::<Vec<_>>())
}

#[test]
fn names_that_are_not_utf_8_work_everywhere() {
    let campaign = Campaign::new();
    let at = |ending: &str| campaign.path("").join(latin(ending));
    let moved = |from: PathBuf, to: PathBuf| fs::rename(from, to).unwrap();
    moved(campaign.path("scans/track_0.txt"), campaign.path("scans").join(latin(".txt")));
    // Another name that differs in the one byte that is not UTF-8.
    moved(
        campaign.path("scans/track_1.txt"),
        campaign.path("scans").join(OsStr::from_bytes(b"stra\xe9e.txt")),
    );
    moved(campaign.path("rubber.toml"), at(".toml"));
    campaign.edit("recipe.toml", "\"rubber.toml\"", "\"bytes:stra%DFe.toml\"");
    moved(campaign.path("recipe.toml"), at("_recipe.toml"));

    told(&campaign, "run @_recipe.toml --out @").result();
    let fresh = told(&campaign, "status @_recipe.toml --out @").result();
    assert!(fresh.lines().all(|line| line.ends_with(" fresh")), "{fresh}");
    let again = told(&campaign, "run @_recipe.toml --out @ --json").json();
    assert_eq!(again["out"], "bytes:stra%DFe");
    let faults = told(&campaign, "export @ --format csv --table ingest/report").result();
    assert!(faults.contains("stra%DFe") && faults.contains("stra%E9e"), "{faults}");

    for command in [
        "plan @_recipe.toml",
        "verify @",
        "inspect @",
        "inspect @ --json",
        "inspect @/tables/friction.arrow --json",
        "inspect scans/@.txt --json",
        "export @ --format markdown --to @.md",
        "report @ --to @.html",
        "plot friction @ --to @.svg",
        "solve bem --wave 1:0.01 --speed 10 --pressure 0.1 --rubber @.toml --fields @.csv",
        "synth --out @_synth --scans 1 --length-mm 2",
        "convert scans/@.txt --to @.sdf --separator semicolon --comment # --x-column x_mm --x-unit mm --z-column z_um --z-unit um",
        "inspect @.sdf --json",
        "run @_recipe.toml --out second --scans scans/@.txt",
        "sweep plan @_recipe.toml --shards 1 --out @_sweep --json",
        "run @_recipe.toml --only ingest",
    ] {
        let told = told(&campaign, command);
        assert_eq!(told.code, 0, "{command}: {}", told.stderr);
        assert!(!told.stderr.contains("warning: whether"), "{command}: {}", told.stderr);
    }
    assert!(at(".md").is_file() && at(".html").is_file() && at(".svg").is_file());
}

#[test]
fn a_recipe_that_is_not_utf_8_inside_is_refused_with_its_line() {
    let campaign = Campaign::new();
    let mut bytes = b"# recipe\n# stra\xdfe\n".to_vec();
    bytes.extend(campaign.read("recipe.toml").into_bytes());
    fs::write(campaign.path("recipe.toml"), bytes).unwrap();
    let told = told(&campaign, "status recipe.toml").error(2);
    assert!(told.contains("line 2 is not UTF-8 text; save the file as UTF-8"), "{told}");
}

/// Every place that takes a file, with `@` for what is given.
const PLACES: [&str; 11] = [
    "run @ --out out",
    "status @",
    "run recipe.toml --scans @ --out out",
    "solve bem --wave 1:0.01 --speed 10 --pressure 0.1 --rubber @",
    "solve bem --profile @ --profile-unit mm --speed 10 --pressure 0.1",
    "inspect @",
    "convert @ --to x.csv",
    "rubber fit @ --kind shear --to y.toml",
    "sweep run @ --shard 0",
    "run rubber_odd.toml --out out",
    "run published_odd.toml --out out",
];

fn refused(campaign: &Campaign, given: &str) {
    let recipe = campaign.read("recipe.toml");
    let odd = recipe.replace("\"rubber.toml\"", &format!("\"{given}\""));
    campaign.write("rubber_odd.toml", &odd);
    let published = format!(
        "{recipe}\n[[tables.published]]\nname = 'x'\nwaves = 3\nspeed_mm_s = 10.0\nfile = '{given}'\n"
    );
    campaign.write("published_odd.toml", &published);
    for place in PLACES {
        // To open a pipe without a writer waits for one: then the time is up.
        let mut command = Command::new("timeout");
        command.arg("60").arg(assert_cmd::cargo::cargo_bin!("asperity"));
        let words = place.split_whitespace().map(|word| word.replace('@', given));
        let told = Outcome::of(command.args(words).current_dir(campaign.path("")));
        assert_eq!(told.code, 2, "{place} with {given}: {}", told.stderr);
        assert!(told.stderr.contains(given), "{place} with {given}: {}", told.stderr);
    }
    assert!(!campaign.path("out").exists());
}

#[test]
fn pipes_devices_and_sockets_are_refused_at_once() {
    let campaign = Campaign::new();
    let pipe = campaign.path("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    refused(&campaign, "pipe");
    let _socket = std::os::unix::net::UnixListener::bind(campaign.path("socket")).unwrap();
    refused(&campaign, "socket");
    refused(&campaign, "/dev/zero");
    // In a folder of scans they are passed over, like everything that is not a file.
    fs::rename(pipe, campaign.path("scans/pipe")).unwrap();
    told(&campaign, "run recipe.toml --only ingest --out out").result();
    // In place of a manifest too.
    fs::remove_file(campaign.path("out/ingest/manifest.json")).unwrap();
    fs::rename(campaign.path("scans/pipe"), campaign.path("out/ingest/manifest.json")).unwrap();
    let status = told(&campaign, "status recipe.toml --out out").result();
    assert!(status.starts_with("ingest        stale"), "{status}");
}

#[test]
fn huge_recipes_and_rubbers_are_refused_at_once() {
    let campaign = Campaign::new();
    // A file of holes takes no place on the disk.
    fs::File::create(campaign.path("huge")).unwrap().set_len(1 << 40).unwrap();
    for command in [
        "run huge --out out",
        "solve bem --wave 1:0.01 --speed 10 --pressure 0.1 --rubber huge",
        "solve bem --profile huge --profile-unit mm --speed 10 --pressure 0.1",
        "rubber fit huge --kind shear --to y.toml",
    ] {
        let told = told(&campaign, command).error(2);
        assert!(told.contains("huge") && told.contains("MB"), "{command}: {told}");
    }
}
