//! Sweeps: cases spread over shards give the tables of one machine, whatever happens to shards.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/outcome.rs"]
mod outcome;

mod collection;
mod export;
mod files;
mod plans;
mod rounds;
mod scripts;
mod shards;

use common::Campaign;
use outcome::Outcome;
use std::fs;
use std::path::{Path, PathBuf};

/// What the recipe of a campaign has once in place of lists.
const SWEEP: &str = r#"
[sweep]
temperatures_c = [10.0, 40.0]
seeds = [1, 2]

[[sweep.specimens]]
name = "A"
scans = ["scans"]

[[sweep.specimens]]
name = "B"
scans = ["scans/track_0.txt", "scans/track_1.txt"]
"#;

/// Two specimens, two temperatures and two seeds: eight cases of two realisations at two speeds, 32 curves.
fn campaign() -> Campaign {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "scans = [\"scans\"]\n", "");
    campaign.edit("recipe.toml", "seed = 1\n", "");
    // Its curves are tasks like others, and would be three times as many as those that are counted here.
    campaign.edit("recipe.toml", "[10.0]", "[10.0, 50.0]\nestimate_scan_error = false");
    campaign.write("recipe.toml", &(campaign.read("recipe.toml") + SWEEP));
    let law = "[temperature]\nreference_c = 20.0\nwlf = { c1 = 8.86, c2_k = 101.6 }\n\n[[branches]]\nmodulus_mpa = 8.0";
    campaign.edit("rubber.toml", "[[branches]]\nmodulus_mpa = 8.0", law);
    campaign
}

/// What the binary does in the folder of a campaign, without its notes.
fn quietly(campaign: &Campaign, arguments: &str) -> Outcome {
    Outcome::of(&mut campaign.command(&format!("--quiet {arguments}")))
}

/// The path of a plan of the recipe in `out`.
fn plan(campaign: &Campaign, out: &str, shards: usize) -> String {
    let command = format!("sweep plan recipe.toml --out {out} --shards {shards}");
    quietly(campaign, &command).result().trim().to_owned()
}

/// Plans and runs all shards in `out`; returns the plan.
fn solved(campaign: &Campaign, out: &str, shards: usize) -> String {
    let plan = plan(campaign, out, shards);
    for shard in 0..shards {
        quietly(campaign, &format!("sweep run {plan} --shard {shard}")).result();
    }
    plan
}

/// The bytes of the tables of a sweep.
fn tables(campaign: &Campaign, out: &str) -> Vec<u8> {
    fs::read(campaign.path(out).join("sweep/friction.arrow")).unwrap()
}

/// The tables of the recipe on one machine.
fn alone(campaign: &Campaign) -> Vec<u8> {
    quietly(campaign, "run recipe.toml --out alone").result();
    tables(campaign, "alone")
}

/// All packs of a sweep, sorted.
fn packs(campaign: &Campaign, out: &str) -> Vec<PathBuf> {
    let folders = entries(&campaign.path(out).join("solves"));
    let files = folders.iter().flat_map(|folder| entries(folder));
    files.filter(|path| path.extension().is_some_and(|extension| extension == "pack")).collect()
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}
