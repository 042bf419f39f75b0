//! Nothing is ever lost or half-true: kills, interrupts, failing system calls, full and read-only disks, damaged and foreign files, clocks, edits
//! during a run, many scans and large ones, each done to the real binary.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/digests.rs"]
mod digests;
#[path = "../common/outcome.rs"]
mod outcome;

mod arrays;
mod calls;
mod changes;
mod damage;
mod disk;
mod foreign;
mod interrupts;
mod kills;
mod mixed;
mod sizes;
mod two_runs;

use std::fs;
use std::path::{Path, PathBuf};

use common::Campaign;
use outcome::Outcome;

/// What the binary does in the folder of a campaign, without its notes.
fn quietly(campaign: &Campaign, arguments: &str) -> Outcome {
    Outcome::of(&mut campaign.command(&format!("--quiet {arguments}")))
}

/// A finished run of a small campaign in `out`, with fields.
fn finished() -> Campaign {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "[bem]\n", "[bem]\nfield_area_fractions = [0.05]\n");
    quietly(&campaign, "run recipe.toml --out out").result();
    campaign
}

/// All files below a folder, sorted.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

/// Temporary files and folders anywhere in a run folder.
fn leftovers(out: &Path) -> Vec<PathBuf> {
    let temporary = |path: &PathBuf| {
        let names = path.strip_prefix(out).unwrap().components();
        names
            .map(|name| name.as_os_str().to_string_lossy())
            .any(|name| name.starts_with(".asperity") || name.starts_with(".tmp-"))
    };
    files(out).into_iter().filter(temporary).collect()
}
