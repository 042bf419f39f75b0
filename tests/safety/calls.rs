//! System calls that fail, by strace; all of them one by one: `scripts/check_system_calls.py --all`.

use std::fs;
use std::process::{Command, Stdio};

use super::{Campaign, finished, leftovers, quietly};
use crate::digests::digests;
use crate::outcome::Outcome;

/// The binary with the calls of a kind failing; none where strace may not trace, which is said.
fn with_failing(campaign: &Campaign, inject: &str, arguments: &str) -> Option<Outcome> {
    let strace = || {
        let mut command = Command::new("strace");
        command.args(["-f", "-qq", "-o", "/dev/null"]).current_dir(campaign.root());
        command
    };
    let probe = strace().args(["-e", "trace=none", "true"]).stderr(Stdio::null()).status();
    if !probe.is_ok_and(|status| status.success()) {
        eprintln!(
            "NOT TESTED HERE: strace is missing or may not trace (sh scripts/setup --strace)"
        );
        return None;
    }
    let (call, _) = inject.split_once(':').unwrap();
    let binary = assert_cmd::cargo::cargo_bin!("asperity");
    let traced =
        ["-e".to_owned(), format!("trace={call}"), "-e".into(), format!("inject={inject}")];
    let mut command = strace();
    command.args(traced).arg(binary).arg("--quiet").args(arguments.split_whitespace());
    Some(Outcome::of(&mut command))
}

#[test]
fn a_failed_write_of_arrays_is_never_a_result() {
    let campaign = finished();
    let whole = digests(&campaign.path("out"));
    // The first call of this kind notes who holds the lock.
    for number in 2..=4 {
        let out = format!("failed_{number}");
        let inject = format!("pwrite64:error=ENOSPC:when={number}");
        let run = format!("run recipe.toml --out {out}");
        let Some(failed) = with_failing(&campaign, &inject, &run) else { return };
        let error = failed.error(1);
        assert!(error.contains(".h5") && error.contains("No space left"), "{error}");
        assert!(error.contains("free some space") && error.lines().count() == 1, "{error}");
        quietly(&campaign, &run).result();
        assert_eq!(digests(&campaign.path(&out)), whole);
        assert_eq!(leftovers(&campaign.path(&out)), Vec::<std::path::PathBuf>::new());
        quietly(&campaign, &format!("verify {out}")).result();
    }
}

#[test]
fn threads_that_cannot_be_started_are_an_error() {
    let campaign = Campaign::new();
    let run = "run recipe.toml --out out --threads 4";
    let Some(failed) = with_failing(&campaign, "clone3:error=EAGAIN", run) else { return };
    let error = failed.error(1);
    assert!(error.contains("4 threads") && error.contains("ulimit -u"), "{error}");
    quietly(&campaign, run).result();
}

/// A file of a solve that cannot be read is not a grid without solution: the run must not go on with fewer grids and
/// no error estimate.
#[test]
fn a_solve_that_cannot_be_read_is_an_error() {
    let campaign = finished();
    let whole = digests(&campaign.path("out"));
    let solves: Vec<_> = super::files(&campaign.path("out/solves"));
    assert!(solves.len() > 20, "{}", solves.len());
    for solve in solves.iter().step_by(solves.len() / 12) {
        fs::remove_dir_all(campaign.path("out/bem")).unwrap();
        let kept = fs::read(solve).unwrap();
        fs::remove_file(solve).unwrap();
        // Reading a folder is an error that is not "not found", for root too.
        fs::create_dir(solve).unwrap();
        // Whoever put the folder there can mend it.
        let error = quietly(&campaign, "run recipe.toml --out out").error(2);
        let name = solve.file_name().unwrap().to_str().unwrap();
        assert!(error.contains(name) && error.contains("Is a directory"), "{error}");
        assert!(error.contains("move it away"), "{error}");
        fs::remove_dir(solve).unwrap();
        fs::write(solve, kept).unwrap();
        quietly(&campaign, "run recipe.toml --out out").result();
        assert_eq!(digests(&campaign.path("out")), whole);
    }
}
