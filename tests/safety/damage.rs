//! Every file of a run folder, damaged in every way.

use std::fs;
use std::path::{Path, PathBuf};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{Campaign, files, finished, quietly};
use crate::digests::digests;
use crate::outcome::Outcome;

/// The folder with all in it, for a fresh start after each damage.
fn copy(from: &Path, to: &Path) {
    for file in files(from) {
        let place = to.join(file.strip_prefix(from).unwrap());
        fs::create_dir_all(place.parent().unwrap()).unwrap();
        fs::copy(&file, place).unwrap();
    }
}

/// Files that hold no result: the lock, whose content is for people.
fn is_result(file: &Path) -> bool {
    file.file_name().is_some_and(|name| name != ".lock")
}

/// Runs, after the folder of a manifest that cannot be read any more is removed as the run says.
fn run_again(campaign: &Campaign, damaged: &Path) {
    let run = quietly(campaign, "run recipe.toml --out out");
    if damaged.ends_with("manifest.json") && run.code == 2 {
        let folder = Path::new("out").join(damaged.parent().unwrap());
        assert!(run.stderr.contains(&folder.display().to_string()), "{}", run.stderr);
        fs::remove_dir_all(campaign.root().join(folder)).unwrap();
        quietly(campaign, "run recipe.toml --out out").result();
    } else {
        run.result();
    }
}

/// Content of a file after each damage, by name: `None` if the file is removed, or if the damage does not change it.
fn damages(
    bytes: &[u8],
    foreign: Option<Vec<u8>>,
    bit: usize,
) -> [(&'static str, Option<Vec<u8>>); 5] {
    let flipped = |mut bytes: Vec<u8>| {
        let before = serde_json::from_slice::<serde_json::Value>(&bytes).ok();
        bytes[bit / 8] ^= 1 << (bit % 8);
        // `1e-5` and `1E-5` are one number.
        let same = before.is_some() && before == serde_json::from_slice(&bytes).ok();
        (!same).then_some(bytes)
    };
    [
        ("truncated", Some(bytes[..bytes.len() / 2].to_vec())),
        ("one bit flipped", flipped(bytes.to_vec())),
        ("of another run", foreign),
        ("empty", Some(Vec::new())),
        ("gone", None),
    ]
}

/// A file of another run in place of one: of stored solves, whose name says what they are, another solve of the same run.
fn foreign_file(name: &Path, solves: &[PathBuf], spare: &Path, other: &Path) -> PathBuf {
    if name.starts_with("solves") {
        spare.join(solves.iter().find(|solve| *solve != name).unwrap())
    } else {
        other.join(name)
    }
}

#[test]
fn damage_to_any_file_is_found_named_and_mended() {
    let campaign = finished();
    let other = finished();
    other.edit("recipe.toml", "seed = 1", "seed = 2");
    other.edit("rubber.toml", "8.0", "9.0");
    // A tilt is form and leaves the heights as they are.
    let scan = other.read("scans/track_1.txt").replace(";4", ";5");
    other.write("scans/track_1.txt", &scan);
    quietly(&other, "run recipe.toml --out out").result();

    let out = campaign.path("out");
    let (whole, spare) = (digests(&out), campaign.path("spare"));
    copy(&out, &spare);
    quietly(&campaign, "verify out").result();
    let table = quietly(&campaign, "export out --format csv").result();
    let names: Vec<PathBuf> = files(&spare)
        .into_iter()
        .map(|file| file.strip_prefix(&spare).unwrap().to_owned())
        .filter(|name| is_result(name))
        .collect();
    // Of the stored solves, which are all of one kind, every fifth.
    let (solves, others): (Vec<PathBuf>, Vec<PathBuf>) =
        names.iter().cloned().partition(|name| name.starts_with("solves"));
    assert!(solves.len() > 20 && others.len() > 30, "{} {}", solves.len(), others.len());
    let damaged: Vec<&PathBuf> = others.iter().chain(solves.iter().step_by(5)).collect();
    let mut rng = Pcg64::seed_from_u64(7);
    let mut done = 0;
    for name in damaged.iter().copied() {
        let bytes = fs::read(spare.join(name)).unwrap();
        let foreign = fs::read(foreign_file(name, &solves, &spare, &other.path("out")));
        let foreign = foreign.ok().filter(|other| *other != bytes);
        let damages = damages(&bytes, foreign, rng.random_range(0..8 * bytes.len()));
        for (what, content) in damages {
            let gone = what == "gone";
            let place = out.join(name);
            match content {
                Some(content) => fs::write(&place, content).unwrap(),
                None if gone => fs::remove_file(&place).unwrap(),
                None => continue,
            }
            done += 1;
            // A stored solve saves time; without it nothing is wrong. So it is with the note of
            // the last run.
            let spares = name.starts_with("solves") || name.ends_with("last_run.json");
            let verified = quietly(&campaign, "verify out");
            if gone && spares {
                assert_eq!(verified.code, 0, "{name:?} {what}");
            } else if what == "of another run" && name.ends_with("last_run.json") {
                // A whole note of another recipe: these results are not what that one asks for.
                let export = Outcome::of(&mut campaign.command("export out --format csv"));
                assert!(export.stderr.contains("warning: "), "{}", export.stderr);
            } else {
                assert_eq!(verified.code, 1, "{name:?} {what}");
                let named = match what {
                    // A whole manifest of other files: these are not those it speaks of.
                    "of another run" if name.ends_with("manifest.json") => name.parent().unwrap(),
                    _ => name.as_path(),
                };
                let named = Path::new("out").join(named).display().to_string();
                assert!(verified.stdout.contains(&named), "{name:?} {what}: {}", verified.stdout);
            }
            // Whatever is exported, is what was computed.
            let exported = quietly(&campaign, "export out --format csv");
            assert!(
                exported.stdout == table || exported.stdout.is_empty() && exported.code != 0,
                "{name:?} {what}: {}",
                exported.stdout
            );
            if !spares {
                run_again(&campaign, name);
                assert_eq!(digests(&out), whole, "{name:?} {what}");
                quietly(&campaign, "verify out").result();
            }
            fs::copy(spare.join(name), &place).unwrap();
        }
    }
    eprintln!("{done} damages to {} of {} files", damaged.len(), names.len());
}

/// Solves are looked at when their stage is computed again.
#[test]
fn damaged_solves_are_solved_again() {
    let campaign = finished();
    let out = campaign.path("out");
    let whole = digests(&out);
    let mut rng = Pcg64::seed_from_u64(9);
    for file in files(&campaign.path("out/solves")) {
        let mut bytes = fs::read(&file).unwrap();
        let bit = rng.random_range(0..8 * bytes.len());
        bytes[bit / 8] ^= 1 << (bit % 8);
        fs::write(&file, bytes).unwrap();
    }
    fs::remove_dir_all(campaign.path("out/bem")).unwrap();
    quietly(&campaign, "run recipe.toml --out out").result();
    assert_eq!(digests(&out), whole);
    let verified = quietly(&campaign, "verify out --json").json();
    let findings = verified.as_array().unwrap();
    assert!(findings.iter().all(|finding| finding["damaged"].as_array().unwrap().is_empty()));
}
