//! Stage folders of another run, of another stage, and with files besides.

use std::fs;
use std::path::Path;

use super::{Campaign, finished, quietly};

const STAGES: [&str; 6] = ["ingest", "characterise", "approximate", "realise", "bem", "tables"];

/// Two runs that differ in every result.
fn two_runs() -> (Campaign, Campaign) {
    let (one, other) = (finished(), finished());
    for scan in 0..3 {
        let name = format!("scans/track_{scan}.txt");
        other.write(&name, &rougher(&other.read(&name)));
    }
    quietly(&other, "run recipe.toml --out out").result();
    (one, other)
}

/// A scan whose heights are a third larger.
fn rougher(text: &str) -> String {
    let line = |line: &str| match line.split_once(';') {
        Some((x, z)) => match z.parse::<f64>() {
            Ok(z) => format!("{x};{:.3}\n", 1.3 * z),
            Err(_) => format!("{line}\n"),
        },
        None => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

fn exchange(a: &Path, b: &Path) {
    let aside = a.with_extension("aside");
    fs::rename(a, &aside).unwrap();
    fs::rename(b, a).unwrap();
    fs::rename(&aside, b).unwrap();
}

/// What `verify` says of the folder, which must not be that all is well.
fn faults(campaign: &Campaign, what: &str) -> String {
    let verified = quietly(campaign, "verify out");
    assert_eq!(verified.code, 1, "{what}: {}", verified.stdout);
    verified.stdout
}

#[test]
fn a_stage_of_another_run_is_named() {
    let (one, other) = two_runs();
    for (a, first) in STAGES.iter().enumerate() {
        for second in &STAGES[a..] {
            let (here, there) = (one.path("out").join(first), other.path("out").join(second));
            exchange(&here, &there);
            for (campaign, stage, from) in [(&one, first, second), (&other, second, first)] {
                let what = format!("{from} of another run as {stage}");
                let said = faults(campaign, &what);
                assert!(said.contains(&format!("out/{stage}")), "{what}: {said}");
                if stage != from {
                    let named = format!("out/{stage}: it is the result of the stage {from}");
                    assert!(said.contains(&named), "{what}: {said}");
                }
                // As far as the recipe is concerned, too.
                let status = quietly(campaign, "status recipe.toml --out out").result();
                assert!(status.contains("stale"), "{what}: {status}");
            }
            exchange(&here, &there);
            quietly(&one, "verify out").result();
        }
    }
}

#[test]
fn stages_of_one_run_that_are_exchanged_are_named() {
    let campaign = finished();
    for (a, first) in STAGES.iter().enumerate() {
        for second in &STAGES[a + 1..] {
            let (here, there) =
                (campaign.path("out").join(first), campaign.path("out").join(second));
            exchange(&here, &there);
            let said = faults(&campaign, first);
            for (stage, from) in [(first, second), (second, first)] {
                let named = format!("out/{stage}: it is the result of the stage {from}");
                assert!(said.contains(&named), "{said}");
            }
            exchange(&here, &there);
        }
    }
    quietly(&campaign, "verify out").result();
}

#[test]
fn files_besides_are_named_and_stop_a_run_that_would_replace_their_folder() {
    let campaign = finished();
    for stage in STAGES {
        let name = format!("out/{stage}/notes.txt");
        campaign.write(&name, "mine");
        let said = faults(&campaign, stage);
        assert!(said.contains(&format!("{name}: its manifest does not list it")), "{said}");
        // Nothing is to be computed: nothing is in the way.
        quietly(&campaign, "run recipe.toml --out out").result();
        let error =
            quietly(&campaign, &format!("run recipe.toml --out out --force {stage}")).error(2);
        assert!(error.contains(&name) && error.contains("move it away"), "{error}");
        assert_eq!(campaign.read(&name), "mine");
        fs::remove_file(campaign.path(&name)).unwrap();
    }
    quietly(&campaign, "verify out").result();
}
