//! `asperity synth`.

use std::fs;

use super::{asperity, asperity_at, project};

#[test]
fn the_defaults_reproduce_the_bundled_scans() {
    let folder = tempfile::tempdir().unwrap();
    let listing = asperity_at("synth --out {}", folder.path()).result();
    assert_eq!(listing.lines().count(), 31);
    for number in 1..=30 {
        let name = format!("scan_{number:02}.txt");
        let made = fs::read(folder.path().join(&name)).unwrap();
        let bundled = fs::read(project("data/scans/specimen").join(&name)).unwrap();
        // Compared as a condition: a failed assert_eq would print a hundred kilobytes.
        assert!(made == bundled, "{name}");
        assert!(listing.contains(&name));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 30);
}

#[test]
fn the_rolled_texture_reproduces_the_bundled_road() {
    let folder = tempfile::tempdir().unwrap();
    let listing = asperity_at("synth --out {} --texture rolled", folder.path()).result();
    assert_eq!(listing.lines().count(), 10);
    for number in 1..=9 {
        let name = format!("scan_{number:02}.txt");
        let made = fs::read(folder.path().join(&name)).unwrap();
        let bundled = fs::read(project("data/scans/rolled").join(&name)).unwrap();
        assert!(made == bundled, "{name}");
    }
}

#[test]
fn files_are_overwritten_by_force_only() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scan_02.txt");
    let small = "synth --out {} --scans 2 --length-mm 1";
    fs::write(&file, "mine").unwrap();
    let refused = asperity_at(small, folder.path()).error(2);
    assert!(refused.contains("scan_02.txt exists already") && refused.contains("--force"));
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    asperity_at(&format!("{small} --force"), folder.path()).result();
    assert!(fs::read_to_string(&file).unwrap().starts_with("# instrument"));

    let fewer = asperity_at("synth --out {} --scans 1 --length-mm 1 --force", folder.path());
    assert_eq!(fewer.code, 0);
    assert!(fewer.stderr.contains("holds 1 other scans"), "{}", fewer.stderr);
}

#[test]
fn options_reach_the_scans() {
    let folder = tempfile::tempdir().unwrap();
    let options = "synth --out {} --scans 1 --length-mm 2 --spacing-um 20 --no-outer-regime --skewness -2 \
        --spot-diameter-um 0 --tilt 0 --noise-um 0 --missing-fraction 0.1 --seed 7 --quiet";
    assert_eq!(asperity_at(options, folder.path()).result(), "");
    let text = fs::read_to_string(folder.path().join("scan_01.txt")).unwrap();
    let points: Vec<&str> = text.lines().skip(4).collect();
    assert_eq!(points.len(), 100);
    assert!(points[1].starts_with("0.0200;"));
    assert_eq!(points.iter().filter(|point| point.ends_with(";BAD")).count(), 10);
}

#[test]
fn impossible_scans_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("--length-mm -1", "--length-mm is -1 mm: it must be positive"),
        ("--hurst-exponent 1", "--hurst-exponent is 1: it must be above 0 and below 1"),
        ("--noise-um NaN", "`NaN` is not a finite number"),
        ("--scans 0", "--scans is 0"),
        ("--scans -1", "not a whole number"),
        ("--scans 1000000000", "lower --scans"),
        ("--no-outer-regime --crossover-lag-mm 1", "cannot be used with"),
        ("--stone-depth-mm 1", "--stone-depth-mm needs --texture rolled"),
        ("--texture rolled --stone-flatness 0", "--stone-flatness is 0: it must be from 1 to 32"),
        (
            "--texture rolled --stone-depth-mm -1",
            "--stone-depth-mm is -1 mm: it must be at least 0",
        ),
    ];
    for (options, part) in cases {
        let error = asperity_at(&format!("synth --out {{}}/new {options}"), folder.path()).error(2);
        assert!(error.contains(part), "{options}: {error}");
    }
    let map = |options: &str| {
        asperity_at(&format!("synth map --out {{}}/new.x3p {options}"), folder.path()).error(2)
    };
    let error = map("--length-mm 1000");
    assert!(error.contains("--length-mm is 1000 mm: it must be from 0.4 to "), "{error}");
    assert!(error.trim_end().ends_with(" mm"), "{error}");
    let error = map("--missing-diameter-um 1");
    assert!(
        error.contains("--missing-diameter-um is 1 um: it must be from 50 to 19200 um"),
        "{error}"
    );
    assert!(asperity("synth").error(2).contains("--out <DIR>"));
    assert!(!folder.path().join("new").exists());
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let error = asperity_at("synth --out {} --scans 1 --length-mm 1", &file).error(2);
    assert!(error.contains("is a file, not a folder: choose another place"), "{error}");
}
