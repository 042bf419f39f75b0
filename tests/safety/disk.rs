//! Full and read-only disks: a small file system in a name space of its own.

use std::process::{Command, Stdio};

use super::{Campaign, finished, leftovers, quietly};
use crate::digests::digests;

/// Runs a shell script that may mount; none where this is not allowed, which a test must say.
fn with_mounts(campaign: &Campaign, script: &str) -> Option<String> {
    let attempt = |options: &[&str]| {
        let mut command = Command::new("unshare");
        command.args(options).args(["sh", "-c"]).current_dir(campaign.root());
        command
    };
    // As root, else as the root of a user name space.
    let allowed = |options: &[&&str]| {
        let options: Vec<&str> = options.iter().map(|option| **option).collect();
        let test = "mount -t tmpfs -o size=64k tmpfs /mnt";
        let status =
            attempt(&options).arg(test).stdout(Stdio::null()).stderr(Stdio::null()).status();
        status.is_ok_and(|status| status.success())
    };
    let options: &[&str] = if allowed(&[&"-m"]) {
        &["-m"]
    } else if allowed(&[&"-rm"]) {
        &["-rm"]
    } else {
        eprintln!(
            "NOT TESTED HERE: unshare may not mount, neither as root nor in a user name space"
        );
        return None;
    };
    let binary = assert_cmd::cargo::cargo_bin!("asperity");
    let output = attempt(options).arg(script).env("ASPERITY", binary).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    Some(String::from_utf8(output.stdout).unwrap() + &told)
}

#[test]
fn a_full_disk_is_named_and_what_was_done_is_kept() {
    let campaign = finished();
    let whole = digests(&campaign.path("out"));
    // From a disk without room for the first stage to one that lacks only the last.
    let mut stages = Vec::new();
    for kilobytes in [16, 64, 200, 360, 440, 520, 560] {
        let after = format!("after_{kilobytes}");
        let script = format!(
            "mkdir -p disk && mount -t tmpfs -o size={kilobytes}k tmpfs disk
             $ASPERITY --quiet run recipe.toml --out disk/out 2>error
             echo code $?
             ls disk/out | tr '\\n' ' '
             mount -o remount,size=64m disk || exit 1
             $ASPERITY --quiet run recipe.toml --out disk/out || exit 1
             cp -r disk/out {after}"
        );
        let Some(told) = with_mounts(&campaign, &script) else { return };
        let error = campaign.read("error");
        if told.contains("code 0") {
            // Large enough: the sizes above were too few to tell.
            assert!(stages.len() >= 5, "only {stages:?} filled the disk");
            break;
        }
        assert!(told.contains("code 1"), "{kilobytes}: {told} {error}");
        assert!(error.contains("disk/out") && error.contains("No space left"), "{error}");
        assert!(error.contains("free some space"), "{kilobytes}: {error}");
        stages.push(told.lines().nth(1).unwrap_or_default().to_owned());
        assert_eq!(digests(&campaign.path(&after)), whole, "{kilobytes}");
        assert_eq!(leftovers(&campaign.path(&after)), Vec::<std::path::PathBuf>::new());
        quietly(&campaign, &format!("verify {after}")).result();
    }
    // Disks filled in different stages.
    eprintln!("{stages:#?}");
    stages.dedup();
    assert!(stages.len() >= 3, "{stages:?}");
}

#[test]
fn a_read_only_folder_is_named_and_can_be_read() {
    let campaign = finished();
    campaign.edit("recipe.toml", "seed = 1", "seed = 2");
    let script =
        "mkdir -p disk && mount -t tmpfs -o size=64m tmpfs disk && cp -r out disk/out || exit 1
        mount -o remount,ro disk || exit 1
        $ASPERITY --quiet run recipe.toml --out disk/out 2>error; echo run $?
        $ASPERITY --quiet run recipe.toml --out disk/new 2>error_new; echo new $?
        $ASPERITY --quiet report disk/out 2>error_report; echo report $?
        $ASPERITY --quiet status recipe.toml --out disk/out >status; echo status $?
        $ASPERITY --quiet verify disk/out >verified; echo verify $?
        $ASPERITY --quiet export disk/out --format csv >table; echo export $?
        $ASPERITY --quiet plot friction disk/out --to friction.svg; echo plot $?
        $ASPERITY --quiet report disk/out --to report.html; echo elsewhere $?";
    let Some(told) = with_mounts(&campaign, script) else { return };
    let codes: Vec<&str> = told.lines().filter(|line| line.split(' ').count() == 2).collect();
    let wanted =
        ["run 1", "new 1", "report 1", "status 0", "verify 0", "export 0", "plot 0", "elsewhere 0"];
    assert_eq!(codes, wanted, "{told}");
    for (file, folder) in
        [("error", "disk/out"), ("error_new", "disk/new"), ("error_report", "disk/out")]
    {
        let error = campaign.read(file);
        assert!(
            error.contains(folder) && error.to_lowercase().contains("read-only file"),
            "{error}"
        );
    }
    assert_eq!(campaign.read("table"), quietly(&campaign, "export out --format csv").result());
}

#[test]
fn a_table_that_does_not_fit_on_standard_output_is_an_error() {
    let campaign = finished();
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let mut command = campaign.command("--quiet export out --format csv");
    let output = command.stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("cannot write to standard output: No space left"), "{error}");
}
