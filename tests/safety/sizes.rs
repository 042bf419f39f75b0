//! Many scans, and large ones.

use std::fmt::Write;
use std::fs::File;
use std::io::Write as _;
use std::process::Command;
use std::time::Instant;

use super::{Campaign, quietly};
use crate::outcome::Outcome;

/// The binary under limits of a shell, such as `ulimit -n 64`.
fn limited(campaign: &Campaign, limits: &str, arguments: &str) -> Outcome {
    let mut command = Command::new("sh");
    let script = format!("{limits}; exec \"$ASPERITY\" --quiet {arguments}");
    command.args(["-c", &script]).current_dir(campaign.root());
    command.env("ASPERITY", assert_cmd::cargo::cargo_bin!("asperity"));
    Outcome::of(&mut command)
}

#[test]
fn a_thousand_scans_with_few_open_files() {
    let campaign = Campaign::new();
    let scan = campaign.read("scans/track_2.txt");
    for number in 3..1000 {
        // Another tilt each, so that no two files are the same.
        let mut text = String::from("x_mm;z_um\n");
        for line in scan.lines().skip(2) {
            let (x, z) = line.split_once(';').unwrap();
            match z.parse::<f64>() {
                Ok(z) => {
                    let tilt = 0.01 * f64::from(number) * x.parse::<f64>().unwrap();
                    writeln!(text, "{x};{:.3}", z + tilt).unwrap();
                }
                Err(_) => writeln!(text, "{line}").unwrap(),
            }
        }
        campaign.write(&format!("scans/track_{number}.txt"), &text);
    }
    let begin = Instant::now();
    let done = limited(&campaign, "ulimit -n 64", "run recipe.toml --out out --json").json();
    assert_eq!(done["stages"].as_array().unwrap().len(), 6);
    eprintln!("1000 scans in {:.1} s", begin.elapsed().as_secs_f64());
    let table = quietly(&campaign, "inspect out/ingest/windows.arrow --json").json();
    assert_eq!(table["rows"], 1000, "{table}");
}

/// Ten gigabytes that take no room: holes, behind the beginning of a real file of each kind.
#[test]
fn ten_gigabytes_are_refused_at_once_in_little_memory() {
    let campaign = Campaign::new();
    // The beginning tells what is wrong: holes are no text and no header, and an X3P file is not read as a stream.
    for (name, head, problem) in [
        ("scan.txt", &b"x_mm;z_um\n0.000;1.0\n"[..], "binary data"),
        ("scan.sdf", b"aISO-1.0  ", "is longer than 4194304 bytes without a line end"),
        ("scan.x3p", b"PK\x03\x04", "save it as SDF"),
        ("scan.pro", b"DIGITAL SURF", "an object of type 0"),
        ("scan.erd", b"ERDFILEV2.00\n", "is longer than 4194304 bytes without a line end"),
    ] {
        let mut file = File::create(campaign.path(name)).unwrap();
        file.write_all(head).unwrap();
        file.set_len(10_000_000_000).unwrap();
        let commands = [
            format!("run recipe.toml --scans {name} --out out"),
            format!("plan recipe.toml --scans {name}"),
            format!("inspect {name}"),
            format!("convert {name} --to out.x3p"),
            format!("init project_{} --scans {name}", name.replace('.', "_")),
        ];
        for command in commands {
            let begin = Instant::now();
            // Address space, of which threads and libraries take some.
            let error = limited(&campaign, "ulimit -v 2000000", &command).error(2);
            assert!(error.contains(name), "{command}: {error}");
            // A project is proposed from all of a file; inspect and convert ask how to read a text first.
            let proposed = command.starts_with("init") && error.contains("10000 MB or more");
            let asked = error.contains("not an Arrow table") || error.contains("give --separator");
            let told = error.contains(problem) || proposed || (name == "scan.txt" && asked);
            assert!(told, "{command}: {error}");
            assert!(begin.elapsed().as_secs() < 20, "{command}");
        }
    }
}

/// 100 MB of text, 6 million points, in 1.5 GB of address space.
#[test]
fn a_large_scan_is_read_in_bounded_memory() {
    let campaign = Campaign::new();
    let mut file = std::io::BufWriter::new(File::create(campaign.path("large.txt")).unwrap());
    writeln!(file, "x_mm;z_um").unwrap();
    for i in 0..6_000_000_u32 {
        let x = f64::from(i) * 1e-3;
        writeln!(file, "{x:.4};{:.4}", 30.0 * (x * 1.57).sin() + 8.0 * (x * 12.5).cos()).unwrap();
    }
    drop(file);
    campaign.edit(
        "recipe.toml",
        "form = \"slope\"",
        "form = \"slope\"\nlateral_resolution_um = 50.0\nwindow_length_mm = 100.0",
    );
    let begin = Instant::now();
    let run = "run recipe.toml --scans large.txt --out out --only ingest --threads 1";
    limited(&campaign, "ulimit -v 1500000", run).result();
    eprintln!("6 million points in {:.1} s", begin.elapsed().as_secs_f64());
}

#[test]
fn what_is_no_plain_file_is_no_scan() {
    let campaign = Campaign::new();
    let error = quietly(&campaign, "run recipe.toml --scans /dev/zero --out out").error(2);
    assert!(error.contains("/dev/zero: it is a device, not a file"), "{error}");
    let error = quietly(&campaign, "inspect /dev/zero").error(2);
    assert!(error.contains("/dev/zero"), "{error}");
}
