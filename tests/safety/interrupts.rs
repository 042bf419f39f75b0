//! Ctrl-C and SIGTERM in the middle of a solve.

use std::f64::consts::TAU;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::{Campaign, leftovers, quietly};

/// A second, and what a machine takes that does eight other things.
const BOUND: Duration = Duration::from_secs(10);

/// Contacts on four million points, of 64 shortest waves a period: setting up one takes seconds, solving it minutes.
fn long_solve() -> Campaign {
    let campaign = Campaign::new();
    for (from, to) in [
        ("waves = [2, 3]", "waves = [7]"),
        ("waves = [3]", "waves = [7]"),
        ("shortest_wavelength_mm = 0.5", "shortest_wavelength_mm = 0.0625"),
        ("form = \"slope\"", "form = \"slope\"\nlateral_resolution_um = 50.0"),
        ("points_per_shortest_wavelength = 16", "points_per_shortest_wavelength = 65536"),
    ] {
        campaign.edit("recipe.toml", from, to);
    }
    for scan in 0..3 {
        campaign.write(&format!("scans/track_{scan}.txt"), &fine_scan(scan));
    }
    campaign
}

/// 8 mm with seven waves of 0.0625 to 4 mm, whose amplitudes grow with their length.
fn fine_scan(scan: u32) -> String {
    let mut text = String::from("x_mm;z_um\n");
    for i in 0..1600 {
        let x = 0.005 * f64::from(i);
        let wave = |n: i32| {
            let turn = f64::from(n * n) * 0.37 + 0.29 * f64::from(scan * n as u32);
            let wavelength = 0.0625 * 2.0_f64.powi(n);
            15.0 * wavelength.powf(0.8) * (TAU * (x / wavelength + turn)).sin()
        };
        text += &format!("{x:.3};{:.3}\n", (0..7).map(wave).sum::<f64>());
    }
    text
}

/// A command on which an interrupt has its effect, also where the tests are started in the background of a shell,
/// which has its children ignore it.
fn interruptible(campaign: &Campaign, arguments: &str) -> Command {
    let plain = campaign.command(arguments);
    let mut command = Command::new("env");
    command.arg("--default-signal=INT").arg(plain.get_program()).args(plain.get_args());
    command.current_dir(plain.get_current_dir().unwrap());
    command
}

fn start(campaign: &Campaign) -> Child {
    let mut command = interruptible(campaign, "run recipe.toml --out out --threads 1");
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until the contacts have begun for so long.
fn wait_for_a_solve(campaign: &Campaign, child: &mut Child, seconds: f64) {
    let begin = Instant::now();
    while !campaign.path("out/realise/manifest.json").exists() {
        assert!(begin.elapsed() < Duration::from_mins(2), "no solve has begun");
        assert!(child.try_wait().unwrap().is_none(), "ended before it was interrupted");
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_secs_f64(seconds));
    assert!(child.try_wait().unwrap().is_none(), "ended before it was interrupted");
}

/// Sends a signal by the shell, which knows kill itself.
fn send(signal: &str, child: &Child) {
    let kill = format!("kill -{signal} {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
}

fn ended_within(bound: Duration, mut child: Child) -> (Option<i32>, Duration, String) {
    let begin = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begin.elapsed() > bound {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("did not end within {bound:?}");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let elapsed = begin.elapsed();
    let output = child.wait_with_output().unwrap();
    (output.status.code(), elapsed, String::from_utf8(output.stderr).unwrap())
}

#[test]
fn an_interrupt_is_heard_within_the_set_up_of_a_contact_and_a_solve() {
    let campaign = long_solve();
    for (signal, seconds) in [("INT", 0.5), ("TERM", 4.0)] {
        let mut child = start(&campaign);
        wait_for_a_solve(&campaign, &mut child, seconds);
        send(signal, &child);
        let (code, elapsed, told) = ended_within(BOUND, child);
        eprintln!("SIG{signal} after {seconds} s: ended after {elapsed:.2?}");
        assert_eq!(code, Some(130), "{told}");
        assert!(told.contains("the same command continues"), "{told}");
        assert_eq!(leftovers(&campaign.path("out")), Vec::<std::path::PathBuf>::new());
    }
    // What was done is kept, and a run on a usual grid goes on from there.
    campaign.edit("recipe.toml", "65536", "16");
    let done = quietly(&campaign, "run recipe.toml --out out --json").json();
    let computed = |stage: &serde_json::Value| stage["computed"].as_bool().unwrap();
    let stages = done["stages"].as_array().unwrap();
    let new: Vec<&str> =
        stages.iter().filter(|s| computed(s)).map(|s| s["stage"].as_str().unwrap()).collect();
    assert_eq!(new, ["bem", "tables"], "{done}");
}

#[test]
fn the_second_interrupt_ends_the_process_at_once() {
    let campaign = long_solve();
    let mut child = start(&campaign);
    wait_for_a_solve(&campaign, &mut child, 0.0);
    // A stopped process takes both signals when it goes on, before any of its own work.
    send("STOP", &child);
    send("INT", &child);
    send("TERM", &child);
    let (code, elapsed, told) = {
        send("CONT", &child);
        ended_within(Duration::from_secs(5), child)
    };
    eprintln!("ended after {elapsed:.2?}");
    // Without a word: the first alone says that the same command continues.
    assert!(code == Some(130) && !told.contains("interrupted"), "{code:?} {told}");
}

#[test]
fn a_single_solve_ends_at_once() {
    let campaign = Campaign::new();
    for arguments in [
        "solve bem --wave 0.0625:0.01867 --speed 10 --area 0.02 --points 4194304",
        "solve fem --wave 0.0625:0.01867 --speed 10 --pressure 3 --columns 2048",
    ] {
        let mut command = interruptible(&campaign, arguments);
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_secs(1));
        send("INT", &child);
        // By the signal itself: there is nothing to keep.
        let (code, elapsed, _) = ended_within(BOUND, child);
        eprintln!("{arguments}: ended after {elapsed:.2?}");
        assert_eq!(code, None);
    }
}
