//! The binary as a user meets it: output, exit codes, files.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/outcome.rs"]
mod outcome;

mod adhesion;
mod campaign;
mod exports;
mod files;
mod inspect;
mod laboratory;
mod mistakes;
mod names;
mod odd_files;
mod oversights;
mod report;
mod report_effects;
mod road;
mod rubber;
mod rubber_files;
mod rubber_sweeps;
mod rubber_tables;
mod slider;
mod solve;
mod solve_areal;
mod solve_fem;
mod solve_heat;
mod solve_soft;
mod start;
mod synth;
mod theory;
mod validate;
mod water;

use outcome::Outcome;
use std::path::{Path, PathBuf};
use std::process::Command;

fn binary() -> Command {
    Command::new(assert_cmd::cargo::cargo_bin!("asperity"))
}

/// Runs the binary with arguments separated by blanks; a `{}` stands for the path.
fn asperity_at(arguments: &str, path: &Path) -> Outcome {
    let path = path.to_str().unwrap();
    let arguments = arguments.split_whitespace().map(|argument| argument.replace("{}", path));
    Outcome::of(binary().args(arguments))
}

fn asperity(arguments: &str) -> Outcome {
    asperity_at(arguments, Path::new(""))
}

/// A path in the repository.
fn project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

#[test]
fn help_and_version_succeed_on_standard_output() {
    for arguments in
        ["--help", "--version", "solve bem --help", "solve fem --help", "synth -h", "help inspect"]
    {
        assert!(asperity(arguments).result().contains("asperity"), "{arguments}");
    }
}

#[test]
fn unknown_commands_and_no_command_are_bad_input() {
    assert!(asperity("slove").error(2).contains("'solve'"));
    let nothing = asperity("");
    assert_eq!((nothing.code, nothing.stdout.as_str()), (2, ""));
    assert!(nothing.stderr.contains("Usage: asperity"));
}

#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let scans = "solve bem --wave 1:0.01 --speed 1 --pressure 1";
    let output = binary().args(scans.split(' ')).stdout(writer).output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), b"".as_slice()));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_a_failure() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let solve = "solve bem --wave 1:0.01 --speed 1 --pressure 1 --json";
    let output = binary().args(solve.split(' ')).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stderr).unwrap().contains("cannot write to standard output"));
}
