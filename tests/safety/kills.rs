//! SIGKILL at random moments.

use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{Campaign, leftovers, quietly};
use crate::digests::digests;

const KILLS: u32 = 200;

/// A campaign whose stages take long against the start of a process.
fn longer() -> Campaign {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "realisations = 2", "realisations = 8");
    campaign.edit("recipe.toml", "[10.0]", "[10.0, 50.0]");
    campaign.edit(
        "recipe.toml",
        "points_per_shortest_wavelength = 16",
        "points_per_shortest_wavelength = 512\nfield_area_fractions = [0.05]",
    );
    campaign
}

fn start(campaign: &Campaign, out: &str) -> Child {
    let mut command = campaign.command(&format!("--quiet run recipe.toml --out {out}"));
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Kills that hit a living process count; what finished before its kill is compared and begun anew.
#[test]
fn two_hundred_kills_do_not_show() {
    let campaign = longer();
    let begin = Instant::now();
    quietly(&campaign, "run recipe.toml --out whole").result();
    let whole_run = begin.elapsed();
    let whole = digests(&campaign.path("whole"));
    let mut rng = Pcg64::seed_from_u64(1);
    let (mut kills, mut folders, mut tries) = (0, 0, 0);
    while kills < KILLS {
        folders += 1;
        let out = format!("killed_{folders}");
        // What is kept shortens the next run, so that a folder comes to its end in some kills; the
        // longer waits meet the late stages.
        let patience: f64 = rng.random_range(0.1..1.0);
        loop {
            tries += 1;
            assert!(tries < 20 * KILLS, "{kills} kills in {tries} runs");
            let mut child = start(&campaign, &out);
            let wait = whole_run.mul_f64(patience * rng.random::<f64>());
            std::thread::sleep(wait.max(Duration::from_millis(1)));
            if let Some(status) = child.try_wait().unwrap() {
                assert!(status.success(), "{status}");
                break;
            }
            child.kill().unwrap();
            child.wait().unwrap();
            kills += 1;
            if kills == KILLS {
                break;
            }
        }
        quietly(&campaign, &format!("run recipe.toml --out {out}")).result();
        let path = campaign.path(&out);
        assert_eq!(digests(&path), whole, "{out} after {kills} kills");
        assert_eq!(leftovers(&path), Vec::<std::path::PathBuf>::new());
        quietly(&campaign, &format!("verify {out}")).result();
        std::fs::remove_dir_all(path).unwrap();
    }
    eprintln!(
        "{kills} kills in {tries} runs of {folders} folders, {:.0} s; a whole run takes {:.2} s",
        begin.elapsed().as_secs_f64(),
        whole_run.as_secs_f64()
    );
}
