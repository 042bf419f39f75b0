//! First steps: init, completions, manual pages, verify, and misspelt keys.

use std::fs;

use super::{Outcome, asperity, binary};
use std::path::Path;

/// Runs the binary in a folder, without its notes.
fn within(folder: &Path, arguments: &str) -> Outcome {
    Outcome::of(binary().current_dir(folder).arg("--quiet").args(arguments.split_whitespace()))
}

#[test]
fn a_folder_for_scans_that_are_there_runs_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("road");
    let specimen = concat!(env!("CARGO_MANIFEST_DIR"), "/data/scans/specimen");
    let made = asperity(&format!("--quiet init {} --scans {specimen}", project.display()));
    let made = made.result();
    assert!(made.contains("asperity plan"), "{made}");
    let recipe = fs::read_to_string(project.join("recipe.toml")).unwrap();
    assert!(recipe.contains("waves = [8]") && recipe.contains("x_column = \"x_mm\""), "{recipe}");
    // 2 µm between points, 62.5 µm the shortest wave.
    assert!(recipe.contains("\nlateral_resolution_um = 50.0\n"), "{recipe}");
    // A tolerance that a test can wait for.
    fs::write(project.join("recipe.toml"), recipe.replace("tolerance = 0.1", "tolerance = 0.5"))
        .unwrap();
    within(&project, "run recipe.toml --only ingest").result();
    within(&project, "run recipe.toml --only characterise").result();
    within(&project, "run recipe.toml --only approximate").result();
    within(&project, "verify runs/recipe").result();

    // Without the resolution the shortest wave would stand for all that is finer.
    fs::write(project.join("recipe.toml"), recipe.replace("\nlateral_resolution_um", "\n#"))
        .unwrap();
    for stage in ["ingest", "characterise"] {
        within(&project, &format!("run recipe.toml --only {stage}")).result();
    }
    let run = Outcome::of(binary().current_dir(&project).args([
        "run",
        "recipe.toml",
        "--only",
        "approximate",
    ]));
    assert_eq!(run.code, 0);
    assert!(run.stderr.contains("lateral_resolution_um = 50.0, or begin"), "{}", run.stderr);
}

#[test]
fn a_folder_for_scans_to_come_says_what_to_do_and_is_not_made_twice() {
    let folder = tempfile::tempdir().unwrap();
    let made = within(folder.path(), "init road").result();
    assert!(made.contains("put the scans into road/scans"), "{made}");
    assert!(folder.path().join("road/scans").is_dir());
    assert!(folder.path().join("road/rubber.toml").is_file());
    let again = within(folder.path(), "init road").error(2);
    assert!(again.contains("road is not empty"), "{again}");
    let missing = within(folder.path(), "init other --scans nowhere").error(2);
    assert!(missing.contains("nowhere"), "{missing}");
    assert!(!folder.path().join("other").exists());
}

#[test]
fn shells_and_the_manual_know_every_command() {
    for shell in ["bash", "zsh", "fish"] {
        let text = asperity(&format!("completions {shell}")).result();
        assert!(text.contains("verify") && text.contains("tolerance"), "{shell}");
    }
    let manual = asperity("man").result();
    assert!(manual.contains(".TH asperity 1") && manual.contains("asperity\\-run"), "{manual}");
    assert!(asperity("man solve bem").result().contains("pressure"));
    assert!(asperity("man sovle").error(2).contains("no command sovle"));
}

#[test]
fn a_misspelt_key_is_named_with_its_line_and_the_nearest_one() {
    let folder = tempfile::tempdir().unwrap();
    within(folder.path(), "init road").result();
    let path = folder.path().join("road/recipe.toml");
    let recipe = fs::read_to_string(&path).unwrap();
    fs::write(&path, recipe.replace("speeds_mm_s", "speed_mm_s")).unwrap();
    let message = within(folder.path(), "status road/recipe.toml").error(2);
    assert!(message.contains("speed_mm_s = [10.0, 50.0]"), "{message}");
    assert!(message.contains("did you mean `speeds_mm_s`?"), "{message}");
    fs::write(&path, recipe.replace("speeds_mm_s", "xyz")).unwrap();
    let message = within(folder.path(), "status road/recipe.toml").error(2);
    assert!(message.contains("unknown key `xyz`") && !message.contains("did you mean"));
}

#[test]
fn damage_is_found_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let wave = "solve bem --wave 1:0.01 --speed 10 --pressure 0.1";
    within(folder.path(), wave).result();
    let none = within(folder.path(), "verify .").error(2);
    assert!(none.contains("holds no result"), "{none}");
    let recipe = "title = 'x'\n[approximate]\n\
        given = [{ source = 'x', scales = [{ wavelength_mm = 1.0, amplitude_mm = 0.01 }] }]\n\
        [realise]\nwaves = [1]\nrealisations = 1\nseed = 1\n\
        [bem]\nrubber = 'rubber.toml'\nspeeds_mm_s = [10.0]\narea_fractions = [0.1]\n";
    fs::write(folder.path().join("recipe.toml"), recipe).unwrap();
    let rubber = concat!(env!("CARGO_MANIFEST_DIR"), "/data/rubber/table_2_1.toml");
    fs::copy(rubber, folder.path().join("rubber.toml")).unwrap();
    within(folder.path(), "run recipe.toml --out out").result();
    let intact = within(folder.path(), "verify out").result();
    assert!(intact.contains("solves") && !intact.contains("damaged"), "{intact}");

    let table = folder.path().join("out/bem/curves.arrow");
    let mut bytes = fs::read(&table).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&table, bytes).unwrap();
    fs::remove_file(folder.path().join("out/tables/friction.arrow")).unwrap();
    let damaged = within(folder.path(), "verify out");
    assert_eq!(damaged.code, 1);
    assert!(damaged.stdout.contains("curves.arrow"), "{}", damaged.stdout);
    assert!(damaged.stderr.contains("2 faults in out"), "{}", damaged.stderr);
    // A run makes both anew.
    within(folder.path(), "run recipe.toml --out out").result();
    within(folder.path(), "verify out").result();
}

#[test]
fn a_workbook_has_a_sheet_for_each_table() {
    let campaign = super::common::Campaign::new();
    within(&campaign.path(""), "run recipe.toml --out out").result();
    within(&campaign.path(""), "export out --format xlsx --to friction.xlsx").result();
    let bytes = fs::read(campaign.path("friction.xlsx")).unwrap();
    // A ZIP archive; its directory names the sheets.
    assert!(bytes.starts_with(b"PK"));
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("xl/worksheets/sheet1.xml"));
    let none = within(&campaign.path(""), "export out --format xlsx").error(2);
    assert!(none.contains("give a file with --to"), "{none}");
}
