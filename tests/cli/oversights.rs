//! What was once taken without a word, or lost: each is told of, refused or kept.

use super::Outcome;
use crate::common::Campaign;
use std::fs;

fn outcome(campaign: &Campaign, arguments: &str) -> Outcome {
    Outcome::of(&mut campaign.command(arguments))
}

const RUN: &str = "run recipe.toml --out out";

#[test]
fn every_exported_table_has_a_file_of_its_own() {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "speeds_mm_s = [10.0]", "speeds_mm_s = [0.25, 0.5, 10.5]");
    assert_eq!(outcome(&campaign, &format!("{RUN} --quiet")).code, 0);
    outcome(&campaign, "export out --format csv --to tables").result();
    let mut names: Vec<String> = fs::read_dir(campaign.path("tables"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let expected = ["0.25", "0.5", "10.5"].map(|v| format!("friction_bem_3_waves_{v}_mm_s.csv"));
    assert_eq!(names, expected);
    let misnamed = outcome(&campaign, "export out --format svg --to figure.png").error(2);
    assert!(misnamed.contains("figure.png") && misnamed.contains("*.svg"), "{misnamed}");
    let misnamed = outcome(&campaign, "export out --format xlsx --to figure.svg").error(2);
    assert!(misnamed.contains("figure.svg") && misnamed.contains("--format xlsx"), "{misnamed}");
}

/// A folder of its own is made by an export of several tables; one in which a single file is to stand must be there.
#[test]
fn a_folder_that_is_missing_is_told_of_before_anything_is_computed() {
    let campaign = Campaign::new();
    for command in [
        "solve bem --wave 1:0.05 --speed 10 --pressure 0.1 --fields nowhere/f.csv",
        "solve fem --wave 0.0625:0.01 --speed 10 --pressure 1 --fields nowhere/f.csv",
        "convert scans/track_0.txt --to nowhere/scan.csv --separator semicolon --comment # --x-column x_mm --x-unit mm \
         --z-column z_um --z-unit um",
    ] {
        let told = outcome(&campaign, command).error(2);
        assert!(told.contains("there is no folder nowhere"), "{command}: {told}");
    }
}

#[test]
fn all_cases_of_a_sweep_tell_the_warnings_of_their_scans_each_time() {
    let campaign = Campaign::new();
    fs::create_dir(campaign.path("stuck")).unwrap();
    let scan = campaign.read("scans/track_0.txt");
    let stuck: String = scan
        .lines()
        .enumerate()
        .map(|(i, line)| match line.split_once(';') {
            Some((x, _)) if i > 100 && i < 200 => format!("{x};400.0\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    campaign.write("stuck/track.txt", &stuck);
    campaign.edit("recipe.toml", "scans = [\"scans\"]\n", "");
    let sweep = "[sweep]\nspecimens = [{ name = 'A', scans = ['scans'] }, { name = 'B', scans = ['stuck'] }]\n[ingest]\n";
    campaign.edit("recipe.toml", "[ingest]\n", sweep);
    for _ in 0..2 {
        let told = outcome(&campaign, RUN);
        assert_eq!(told.code, 0, "{}", told.stderr);
        let line = told.stderr.lines().find(|line| line.contains("stand still"));
        let line = line.unwrap_or_else(|| panic!("{}", told.stderr));
        assert!(line.contains("specimen=B, ingest: 1 of 1 files stand still"), "{line}");
    }
    let json: serde_json::Value =
        serde_json::from_str(&outcome(&campaign, &format!("{RUN} --quiet --json")).stdout).unwrap();
    let told = json["warnings"].as_array().unwrap();
    assert!(told.iter().any(|one| one["stage"] == "ingest"), "{json}");
}

#[cfg(unix)]
#[test]
fn a_link_that_leads_nowhere_is_a_scan_that_is_missed() {
    let campaign = Campaign::new();
    std::os::unix::fs::symlink("unplugged/track.txt", campaign.path("scans/track_9.txt")).unwrap();
    let told = outcome(&campaign, &format!("{RUN} --quiet")).error(2);
    assert!(told.contains("scans/track_9.txt"), "{told}");
    let told = outcome(&campaign, "init project --scans scans").error(2);
    assert!(told.contains("scans/track_9.txt"), "{told}");
}

#[test]
fn copies_stuck_sensors_and_temperatures_in_kelvin_are_told() {
    let campaign = Campaign::new();
    campaign.write("scans/track_3.txt", &campaign.read("scans/track_1.txt"));
    let told = outcome(&campaign, RUN).stderr;
    assert!(told.contains("track_3 has the bytes of track_1"), "{told}");
    let rubber = campaign.read("rubber.toml").replace(
        "[[branches]]\nmodulus_mpa = 8.0",
        "[temperature]\nreference_c = 20.0\nwlf = { c1 = 8.0, c2_k = 100.0 }\n\n[[branches]]\nmodulus_mpa = 8.0",
    );
    campaign.write("warm.toml", &rubber);
    let solve = "solve bem --wave 1:0.05 --speed 10 --pressure 0.1 --points 256 --rubber warm.toml";
    let told = outcome(&campaign, &format!("{solve} --temperature-c 293.15"));
    assert!(told.stderr.contains("is it in K? Then write 20.00"), "{}", told.stderr);
    outcome(&campaign, &format!("{solve} --temperature-c 60")).result();
    let branch = "[[branches]]\nmodulus_mpa = 8.0\nrelaxation_time_s = 1e-3\n";
    campaign.write("twice.toml", &format!("{}\n{branch}", campaign.read("rubber.toml")));
    let solve = solve.replace("warm", "twice");
    let told = outcome(&campaign, &solve).stderr;
    assert!(told.contains("branch 3 stands there twice"), "{told}");
    campaign.write("negative.toml", &campaign.read("rubber.toml").replace("= 8.0", "= -8.0"));
    let told = outcome(&campaign, &solve.replace("twice", "negative")).error(2);
    assert!(told.contains("modulus_mpa of branch 1 is -8,"), "{told}");
}

#[test]
fn results_do_not_go_among_the_scans_and_scans_do_not_go_lost_in_a_conversion() {
    let campaign = Campaign::new();
    let told = outcome(&campaign, "run recipe.toml --out scans").error(2);
    assert!(told.contains("--out scans") && told.contains("taken for scans"), "{told}");
    assert_eq!(fs::read_dir(campaign.path("scans")).unwrap().count(), 3);
    let before = campaign.read("scans/track_0.txt");
    fs::copy(campaign.path("scans/track_0.txt"), campaign.path("scan.csv")).unwrap();
    let options = "--separator semicolon --comment # --x-column x_mm --x-unit mm --z-column z_um --missing BAD";
    let itself = format!("convert scan.csv --to scan.csv --force {options} --z-unit um");
    let told = outcome(&campaign, &itself).error(2);
    assert!(told.contains("would overwrite the input"), "{told}");
    assert_eq!(campaign.read("scan.csv"), before);
    let other = format!("convert scan.csv --to other.csv {options} --z-unit nm");
    let told = outcome(&campaign, &other);
    assert_eq!(told.code, 0, "{}", told.stderr);
    assert!(told.stderr.contains("the column `z_um` states um"), "{}", told.stderr);
    let negative = format!("{} --cut-start-mm -1", other.replace("other", "third"));
    let told = outcome(&campaign, &negative).error(2);
    assert!(told.contains("cut_start_mm"), "{told}");
}

#[test]
fn one_column_is_not_two_quantities_and_flat_scans_have_no_roughness() {
    let campaign = Campaign::new();
    let told = |campaign: &Campaign| outcome(campaign, &format!("{RUN} --quiet")).error(2);
    campaign.edit("recipe.toml", "z_column = \"z_um\"", "z_column = \"x_mm\"");
    let one_column = told(&campaign);
    assert!(one_column.contains("z_column"), "{one_column}");
    let campaign = Campaign::new();
    for scan in 0..3 {
        let name = format!("scans/track_{scan}.txt");
        let flat: String = campaign
            .read(&name)
            .lines()
            .map(|line| match line.split_once(';') {
                Some((x, z)) if z != "z_um" => format!("{x};1.0\n"),
                _ => format!("{line}\n"),
            })
            .collect();
        campaign.write(&name, &flat);
    }
    let flat = told(&campaign);
    assert!(flat.contains("do the scans have any roughness"), "{flat}");
}

#[test]
fn heights_of_no_road_maps_of_four_points_and_waves_that_cancel_are_told() {
    let campaign = Campaign::new();
    for scan in 0..3 {
        let name = format!("scans/track_{scan}.txt");
        let in_metres: String = campaign
            .read(&name)
            .lines()
            .map(|line| match line.split_once(';').map(|(x, z)| (x, z.parse::<f64>())) {
                Some((x, Ok(z))) => format!("{x};{:e}\n", z * 1e-6),
                _ => format!("{line}\n"),
            })
            .collect();
        campaign.write(&name, &in_metres);
    }
    let told = outcome(&campaign, &format!("{RUN} --only ingest")).stderr;
    assert!(
        told.contains("3 of 3 files are smoother than any road: in the first, track_0"),
        "{told}"
    );
    assert!(told.contains("another unit than ingest.text.z_unit says"), "{told}");

    campaign.write("map.csv", "x,y,z\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n");
    let map = "inspect map.csv --separator comma --x-column x --x-unit mm --y-column y --y-unit mm --z-column z --z-unit um";
    let told = outcome(&campaign, map).error(2);
    assert!(told.contains("at least 2 lines of 3 points, 6 in all, and these are 4"), "{told}");

    let waves = "--wave 0.1:0.01 --wave 0.1:-0.01 --speed 10 --pressure 1 --rubber rubber.toml";
    for solve in ["bem", "fem"] {
        let told = outcome(&campaign, &format!("solve {solve} {waves}")).error(2);
        assert!(told.contains("the waves cancel each other: of amplitudes of 0.02 mm"), "{told}");
    }
}

#[test]
fn a_period_that_does_not_close_is_told() {
    let campaign = Campaign::new();
    let row = |i: i32| {
        let x = f64::from(i) / 128.0;
        format!("{x} {}\n", 0.3 * x + 0.05 * (std::f64::consts::TAU * x).sin())
    };
    campaign.write("tilted.txt", &(0..128).map(row).collect::<String>());
    let solve =
        "solve bem --profile tilted.txt --profile-unit mm --speed 10 --pressure 0.1 --points 128";
    let told = outcome(&campaign, solve).stderr;
    assert!(told.contains("has a cliff there"), "{told}");
}

/// A stage without its manifest is a folder that nobody knows who wrote: the advice must lead out.
#[test]
fn the_advice_for_an_unreadable_manifest_leads_to_a_run_that_works() {
    let campaign = Campaign::new();
    assert_eq!(outcome(&campaign, &format!("{RUN} --quiet")).code, 0);
    campaign.write("out/bem/manifest.json", "x");
    let told = outcome(&campaign, "verify out");
    let told = told.stdout + &told.stderr;
    assert!(told.contains("delete its folder and run the stage again"), "{told}");
    fs::remove_dir_all(campaign.path("out/bem")).unwrap();
    assert_eq!(outcome(&campaign, &format!("{RUN} --quiet")).code, 0);
}

/// The folder from which a command is given is no parameter of a stage.
#[test]
fn published_tables_do_not_make_a_result_stale_from_another_folder() {
    let campaign = Campaign::new();
    campaign.write("published.csv", "area_fraction,average\n0.05,1.0\n");
    let published = "\n[[tables.published]]\nname = \"Other\"\nwaves = 3\nspeed_mm_s = 10.0\nfile = \"published.csv\"\n";
    campaign.write("recipe.toml", &(campaign.read("recipe.toml") + published));
    assert_eq!(outcome(&campaign, &format!("{RUN} --quiet")).code, 0);
    let mut again =
        campaign.command("run ../recipe.toml --out ../out --only tables --quiet --json");
    let json = Outcome::of(again.current_dir(campaign.path("scans"))).json();
    assert_eq!(json["stages"][0]["computed"], false, "{json}");
    let export = outcome(&campaign, "export out --format markdown --comparison");
    assert_eq!((export.code, export.stderr.as_str()), (0, ""));
    assert!(export.stdout.contains("## Other"), "{}", export.stdout);
}
