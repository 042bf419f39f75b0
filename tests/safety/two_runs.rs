//! Two runs in one folder.

use std::process::Stdio;
use std::time::{Duration, Instant};

use super::{Campaign, quietly};

#[test]
fn the_second_run_names_the_first_and_the_lock_of_a_killed_one_is_free() {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "realisations = 2", "realisations = 200");
    campaign.edit(
        "recipe.toml",
        "points_per_shortest_wavelength = 16",
        "points_per_shortest_wavelength = 1024",
    );
    let mut command = campaign.command("--quiet run recipe.toml --out out");
    let mut first = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_mins(1);
    while !campaign.path("out/solves").is_dir() {
        assert!(Instant::now() < deadline, "no solves after a minute");
        assert!(first.try_wait().unwrap().is_none(), "the first run has ended");
        std::thread::sleep(Duration::from_millis(5));
    }
    let second = quietly(&campaign, "run recipe.toml --out out").error(1);
    let holder = format!("another run is using out (process {}): wait for it", first.id());
    assert!(second.contains(&holder), "{second}");
    // Reading needs no lock.
    quietly(&campaign, "status recipe.toml --out out").result();
    first.kill().unwrap();
    first.wait().unwrap();
    campaign.edit("recipe.toml", "realisations = 200", "realisations = 2");
    quietly(&campaign, "run recipe.toml --out out").result();
}
