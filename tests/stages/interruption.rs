//! Runs that are killed or interrupted, and the number of threads: none of it shows in the results.

use super::{Campaign, digests, recipe, stale};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A campaign whose solves take long against the start of a process.
fn longer() -> Campaign {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "realisations = 2", "realisations = 8");
    campaign.edit("recipe.toml", "[10.0]", "[10.0, 50.0]");
    campaign.edit(
        "recipe.toml",
        "points_per_shortest_wavelength = 16",
        "points_per_shortest_wavelength = 1024\nfield_area_fractions = [0.05]",
    );
    campaign
}

fn complete(campaign: &Campaign, out: &str, threads: usize) {
    let arguments = format!("run recipe.toml --out {out} --threads {threads}");
    let output = campaign.command(&arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn start(campaign: &Campaign, out: &str) -> Child {
    let mut command = campaign.command(&format!("run recipe.toml --out {out}"));
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

#[test]
fn the_number_of_threads_does_not_show() {
    let campaign = longer();
    complete(&campaign, "one", 1);
    complete(&campaign, "two", 2);
    let one = digests(&campaign.path("one"));
    // ingest 8, characterise 11, approximate 4, realise 1, bem 5, tables 2.
    assert_eq!(one.len(), 31);
    assert_eq!(one, digests(&campaign.path("two")));
}

#[test]
fn kills_at_any_moment_do_not_show() {
    let campaign = longer();
    let begin = Instant::now();
    complete(&campaign, "whole", 2);
    let duration = begin.elapsed();
    let wanted = recipe(&campaign);
    for round in 0..4 {
        let out = format!("killed_{round}");
        for kill in 0..5 {
            let mut child = start(&campaign, &out);
            // Moments spread over the run by the golden ratio; with each kill less is left to do.
            let share = (0.618_034 * f64::from(5 * round + kill)).fract();
            std::thread::sleep(duration.mul_f64(share / f64::from(kill + 1)));
            child.kill().unwrap();
            child.wait().unwrap();
            // Whatever is there, is complete.
            let unfinished = stale(&wanted, &campaign.path(&out));
            assert!(
                unfinished.iter().all(|(stage, why)| {
                    why == "not computed yet"
                        || why.ends_with("is stale") && *stage > unfinished[0].0
                }),
                "{unfinished:?}"
            );
        }
        complete(&campaign, &out, 2);
        assert_eq!(digests(&campaign.path(&out)), digests(&campaign.path("whole")));
        assert_eq!(leftovers(&campaign.path(&out)), Vec::<String>::new());
    }
}

/// Temporary files and folders, but for the lock.
fn leftovers(out: &Path) -> Vec<String> {
    let names = std::fs::read_dir(out).unwrap().map(|e| e.unwrap().file_name());
    let names = names.map(|name| name.into_string().unwrap());
    names.filter(|name| name.starts_with('.') && name != ".lock").collect()
}

#[test]
fn an_interrupt_ends_the_run_and_the_same_command_continues() {
    let campaign = longer();
    let out = campaign.path("out");
    complete(&campaign, "whole", 2);
    let child = start(&campaign, "out");
    // In the midst of the solves: some are there, the stage is not.
    let deadline = Instant::now() + Duration::from_mins(1);
    while !out.join("solves").is_dir() {
        assert!(Instant::now() < deadline, "no solves after a minute");
        std::thread::sleep(Duration::from_millis(1));
    }
    // By the shell, which knows kill itself: a minimal Debian has no program of that name.
    let kill = format!("kill -INT {}", child.id());
    let interrupt = Command::new("sh").args(["-c", &kill]).status().unwrap();
    assert!(interrupt.success());
    let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
    let message = String::from_utf8(stderr).unwrap();
    assert_eq!((status.code(), stdout.len()), (Some(130), 0), "{message}");
    assert!(message.ends_with("the same command continues\nerror: interrupted\n"), "{message}");
    assert!(!out.join("bem").exists());
    assert_eq!(leftovers(&out), Vec::<String>::new());
    complete(&campaign, "out", 2);
    assert_eq!(digests(&out), digests(&campaign.path("whole")));
}
