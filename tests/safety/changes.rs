//! Clocks that go wrong, and scans and recipes that change under a run.

use std::fs::{self, File, FileTimes};
use std::process::Stdio;
use std::time::{Duration, Instant, SystemTime};

use super::{Campaign, files, finished, quietly};
use crate::digests::digests;
use crate::outcome::Outcome;

/// All files of the campaign from another time.
fn date(campaign: &Campaign, time: SystemTime) {
    for file in files(campaign.root()) {
        let times = FileTimes::new().set_modified(time).set_accessed(time);
        File::options().append(true).open(file).unwrap().set_times(times).unwrap();
    }
}

#[test]
fn time_has_no_say() {
    let campaign = finished();
    let whole = digests(&campaign.path("out"));
    let year = Duration::from_hours(8760);
    let old = SystemTime::UNIX_EPOCH + 31 * year;
    let future = SystemTime::UNIX_EPOCH + 130 * year;
    for (results, sources) in [(old, future), (future, old)] {
        date(&campaign, results);
        for file in ["recipe.toml", "rubber.toml", "scans/track_0.txt"] {
            let times = FileTimes::new().set_modified(sources);
            File::options()
                .append(true)
                .open(campaign.path(file))
                .unwrap()
                .set_times(times)
                .unwrap();
        }
        // Nothing is computed because of a date, ...
        let done = quietly(&campaign, "run recipe.toml --out out --json").json();
        let stages = done["stages"].as_array().unwrap();
        assert!(stages.iter().all(|stage| stage["computed"] == false), "{done}");
    }
    // ... and nothing is left as it is because of one.
    campaign.edit("recipe.toml", "seed = 1", "seed = 2");
    date(&campaign, old);
    quietly(&campaign, "run recipe.toml --out out").result();
    assert_ne!(digests(&campaign.path("out")), whole);
    campaign.edit("recipe.toml", "seed = 2", "seed = 1");
    date(&campaign, future);
    quietly(&campaign, "run recipe.toml --out out").result();
    assert_eq!(digests(&campaign.path("out")), whole);
}

#[test]
fn a_scan_that_changed_is_noticed_though_size_and_date_are_the_same() {
    let campaign = finished();
    let path = campaign.path("scans/track_1.txt");
    let (text, metadata) = (fs::read_to_string(&path).unwrap(), fs::metadata(&path).unwrap());
    let changed = text.replacen(";41", ";42", 1);
    assert!(changed != text && changed.len() == text.len());
    fs::write(&path, &changed).unwrap();
    let times = FileTimes::new().set_modified(metadata.modified().unwrap());
    File::options().append(true).open(&path).unwrap().set_times(times).unwrap();

    let status = quietly(&campaign, "status recipe.toml --out out").result();
    let first = status.lines().next().unwrap();
    assert!(first.starts_with("ingest") && first.contains("stale"), "{status}");
    assert!(first.contains("track_1"), "{status}");
    let exported = Outcome::of(&mut campaign.command("export out --format csv"));
    assert!(exported.stderr.contains("warning") && exported.stderr.contains("track_1"));
    let done = quietly(&campaign, "run recipe.toml --out out --json").json();
    assert_eq!(done["stages"][0]["computed"], true);
}

/// A run goes on with what it has read, and says which recipe that was.
#[test]
fn a_recipe_that_is_edited_during_a_run_counts_from_the_next_run_on() {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "realisations = 2", "realisations = 20");
    campaign.edit(
        "recipe.toml",
        "points_per_shortest_wavelength = 16",
        "points_per_shortest_wavelength = 1024",
    );
    let mut command = campaign.command("--quiet run recipe.toml --out out");
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::inherit()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_mins(1);
    while !campaign.path("out/solves").is_dir() {
        assert!(Instant::now() < deadline, "no solves after a minute");
        std::thread::sleep(Duration::from_millis(1));
    }
    let before = campaign.read("recipe.toml");
    campaign.edit("recipe.toml", "[10.0]", "[30.0]");
    assert!(child.try_wait().unwrap().is_none(), "the run ended before the edit");
    assert!(child.wait().unwrap().success());

    let note: serde_json::Value =
        serde_json::from_str(&campaign.read("out/last_run.json")).unwrap();
    assert_eq!(note["text"], before);
    let table = Outcome::of(&mut campaign.command("export out --format csv --speed 10"));
    assert_eq!(table.code, 0);
    assert!(table.stderr.contains("bem.speeds_mm_s: [10.0] -> [30.0]"), "{}", table.stderr);
    let status = quietly(&campaign, "status recipe.toml --out out").result();
    assert!(status.contains("stale: bem.speeds_mm_s: [10.0] -> [30.0]"), "{status}");
}
