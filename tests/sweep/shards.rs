//! Shards in any order, twice, at once, killed, without locks and with wrong clocks.

use super::{alone, campaign, entries, packs, plan, quietly, solved, tables};
use crate::common::Campaign;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

#[test]
fn shards_give_the_tables_of_one_machine_to_the_bit() {
    let campaign = campaign();
    let expected = alone(&campaign);
    for shards in [1, 3, 40] {
        let out = format!("spread_{shards}");
        let plan = solved(&campaign, &out, shards);
        quietly(&campaign, &format!("sweep collect {plan}")).result();
        assert_eq!(tables(&campaign, &out), expected, "{shards} shards");
        quietly(&campaign, &format!("verify {out}")).result();
    }
}

#[test]
fn a_shard_that_runs_again_or_twice_at_once_does_no_harm() {
    let campaign = campaign();
    let expected = alone(&campaign);
    let plan = plan(&campaign, "out", 2);
    let start = |shard: usize| {
        let mut command = campaign.command(&format!("--quiet sweep run {plan} --shard {shard}"));
        command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    };
    // Each shard three times at once, the second shard first.
    let children: Vec<_> = [1, 0, 1, 0, 1, 0].map(start).into();
    for child in children {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let before = packs(&campaign, "out");
    let report = quietly(&campaign, &format!("sweep run {plan} --shard 0 --json")).json();
    assert_eq!(report["there"], report["tasks"]);
    assert_eq!(packs(&campaign, "out"), before);
    quietly(&campaign, &format!("sweep collect {plan}")).result();
    assert_eq!(tables(&campaign, "out"), expected);
}

#[test]
fn killed_shards_go_on_where_they_were() {
    let campaign = campaign();
    let expected = alone(&campaign);
    let plan = plan(&campaign, "out", 1);
    let mut kills = 0;
    for wait in (5..).step_by(3) {
        let mut command = campaign.command(&format!("--quiet sweep run {plan} --shard 0"));
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait));
        if child.try_wait().unwrap().is_some() {
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
    }
    assert!(kills >= 3, "{kills}");
    quietly(&campaign, &format!("sweep run {plan} --shard 0")).result();
    quietly(&campaign, &format!("sweep collect {plan}")).result();
    assert_eq!(tables(&campaign, "out"), expected, "{kills} kills");
}

/// Code that takes the place of calls of the C library.
const SHIM: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <time.h>
#include <sys/time.h>

int flock(int file, int operation) { (void)file; (void)operation; errno = ENOLCK; return -1; }

static long shift(void) { const char *text = getenv("CLOCK_SHIFT"); return text ? atol(text) : 0; }

int clock_gettime(clockid_t clock, struct timespec *time) {
    static int (*real)(clockid_t, struct timespec *);
    if (!real) real = (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT, "clock_gettime");
    int result = real(clock, time);
    if (clock == CLOCK_REALTIME) time->tv_sec += shift();
    return result;
}
"#;

/// A library of the [`SHIM`], made by the compiler that links the tests.
fn shim(campaign: &Campaign) -> PathBuf {
    campaign.write("shim.c", SHIM);
    let library = campaign.path("shim.so");
    let mut compiler = Command::new("cc");
    compiler
        .args(["-shared", "-fPIC", "-o"])
        .arg(&library)
        .arg(campaign.path("shim.c"))
        .arg("-ldl");
    assert!(compiler.status().unwrap().success());
    library
}

#[test]
fn neither_locks_nor_clocks_are_asked() {
    let campaign = campaign();
    let expected = alone(&campaign);
    let shim = shim(&campaign);
    let run = |arguments: &str, shift: i64| {
        let mut command = campaign.command(&format!("--quiet {arguments}"));
        command.env("LD_PRELOAD", &shim).env("CLOCK_SHIFT", shift.to_string());
        crate::outcome::Outcome::of(&mut command)
    };
    // The shim works: a run of one case takes a lock and fails.
    let single = Campaign::new();
    let mut command = single.command("--quiet run recipe.toml --out out");
    let error = crate::outcome::Outcome::of(command.env("LD_PRELOAD", &shim)).error(1);
    assert!(error.contains("cannot lock"), "{error}");
    let out = "sweep plan recipe.toml --out out --shards 4";
    let plan = run(out, 3600).result().trim().to_owned();
    for (shard, shift) in [(0, 0), (1, 3600), (2, -3600), (3, 1800)] {
        run(&format!("sweep run {plan} --shard {shard}"), shift).result();
    }
    // Two that collect at once, an hour apart.
    let children: Vec<_> = [-3600, 3600]
        .map(|shift: i64| {
            let mut command = campaign.command(&format!("--quiet sweep collect {plan}"));
            command.env("LD_PRELOAD", &shim).env("CLOCK_SHIFT", shift.to_string());
            command.stderr(Stdio::piped()).spawn().unwrap()
        })
        .into();
    for child in children {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert_eq!(tables(&campaign, "out"), expected);
}

#[test]
fn the_element_of_a_job_array_is_the_shard() {
    let campaign = campaign();
    let plan = plan(&campaign, "out", 2);
    let run = format!("--quiet sweep run {plan} --json");
    for name in ["SLURM_ARRAY_TASK_ID", "HQ_TASK_ID"] {
        let output = campaign.command(&run).env(name, "1").output().unwrap();
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["shard"], 1);
    }
    let without = quietly(&campaign, &format!("sweep run {plan}")).error(2);
    assert!(without.contains("--shard") && without.contains("SLURM_ARRAY_TASK_ID"));
    assert!(quietly(&campaign, &format!("sweep run {plan} --shard 2")).error(2).contains("0 to 1"));
}

/// A task is a file, and no folder holds many.
#[test]
fn solves_are_spread_over_folders_a_file_for_each_task() {
    let campaign = campaign();
    campaign.edit("recipe.toml", "realisations = 2", "realisations = 20");
    campaign.edit("recipe.toml", "wavelength = 16", "wavelength = 128");
    solved(&campaign, "out", 2);
    assert_eq!(packs(&campaign, "out").len(), 320);
    let folders = entries(&campaign.path("out/solves"));
    assert!(folders.len() > 100 && folders.len() <= 256, "{}", folders.len());
    assert!(folders.iter().all(|folder| entries(folder).len() < 10));
}
