//! `asperity run` and `status`: what they print, and what they refuse.

use super::Outcome;
use crate::common::Campaign;
use std::fs;

pub(super) fn outcome(campaign: &Campaign, arguments: &str) -> Outcome {
    Outcome::of(&mut campaign.command(arguments))
}

pub(super) const RUN: &str = "run recipe.toml --out out";

#[test]
fn a_run_tells_of_each_stage_and_leaves_standard_output_to_json() {
    let campaign = Campaign::new();
    let first = outcome(&campaign, RUN);
    assert_eq!((first.code, first.stdout.as_str()), (0, ""));
    let lines: Vec<&str> = first.stderr.lines().collect();
    assert!(lines[0].starts_with("ingest ") && lines[0].ends_with(" s"), "{}", first.stderr);
    assert_eq!(lines.last(), Some(&"results in out"));

    assert_eq!(outcome(&campaign, &format!("{RUN} --quiet")).result(), "");
    let json = outcome(&campaign, &format!("{RUN} --only tables --quiet --json")).json();
    assert_eq!(json["out"], "out");
    assert_eq!(json["stages"], serde_json::json!([{ "stage": "tables", "computed": false }]));

    let status = outcome(&campaign, "status recipe.toml --out out").result();
    assert_eq!(status.lines().count(), 6);
    assert!(status.lines().all(|line| line.ends_with(" fresh")), "{status}");
    campaign.edit("recipe.toml", "seed = 1", "seed = 2");
    let status = outcome(&campaign, "status recipe.toml --out out").result();
    assert!(status.contains("realise       stale: realise.seed: 1 -> 2\n"), "{status}");
    let json = outcome(&campaign, "status recipe.toml --out out --json").json();
    assert_eq!((&json[2]["fresh"], &json[3]["fresh"]), (&true.into(), &false.into()));
}

/// What is replaced, by what, and parts of the message: file, key, value, what to do.
const MISTAKES: [(&str, &str, &[&str]); 37] = [
    ("seed = 1", "seed = ", &["line 27", "seed ="]),
    ("seed = 1", "sed = 1", &["line 27", "unknown key `sed`", "`seed`"]),
    ("seed = 1", "", &["realise.seed is missing", "line 24", "sweep.seeds"]),
    ("seed = 1", "seed = -1", &["line 27", "seed = -1", "-1 is not a whole number of 0 or more"]),
    ("[realise]", "[realize]", &["unknown key `realize`"]),
    ("speeds_mm_s", "speeds_m_s", &["unknown key `speeds_m_s`", "`speeds_mm_s`"]),
    ("[10.0]", "[0.0]", &["bem.speeds_mm_s = [0.0]"]),
    ("[10.0]", "[-10.0]", &["bem.speeds_mm_s = [-10.0]"]),
    ("[10.0]", "[nan]", &["bem.speeds_mm_s = [nan]"]),
    ("[10.0]", "[inf]", &["bem.speeds_mm_s = [inf]"]),
    ("[10.0]", "[1e-300]", &["bem.speeds_mm_s = [1e-300]", "from 1e-9 to 1e9"]),
    ("[10.0]", "[10.0, 10.0]", &["bem.speeds_mm_s", "without repeats"]),
    ("[10.0]", "[]", &["bem.speeds_mm_s = []"]),
    ("[0.02, 0.05, 0.1]", "[0.05, 0.02]", &["bem.area_fractions", "ascending"]),
    ("[0.02, 0.05, 0.1]", "[0.5, 1.0]", &["bem.area_fractions", "between 0 and 1"]),
    ("[0.02, 0.05, 0.1]", "[]", &["bem.area_fractions = []", "at least one"]),
    ("5e-3", "inf", &["bem.tolerance = inf"]),
    ("5e-3", "5e-3\nfield_area_fractions = [0.2]", &["bem.field_area_fractions = [0.2]"]),
    ("= 16", "= 2", &["bem.points_per_shortest_wavelength = 2", "4 to 65536"]),
    ("waves = [3]", "waves = [3, 4]", &["realise.waves = [3, 4]", "approximate.waves"]),
    ("waves = [3]", "waves = []", &["realise.waves = []"]),
    ("realisations = 2", "realisations = 0", &["realise.realisations = 0"]),
    ("[2, 3]", "[2, 2, 3]", &["approximate.waves = [2, 2, 3]", "each once"]),
    ("mm = 0.5", "mm = nan", &["approximate.shortest_wavelength_mm"]),
    (
        "shortest_wavelength_mm = 0.5",
        "given = [{ source = 'x', scales = [{ wavelength_mm = 1.0, amplitude_mm = 0.1 }] }]",
        &["approximate.given", "without [ingest]"],
    ),
    ("x_unit = \"mm\"\n", "", &["ingest.text", "x_unit", "never guessed", "nm, um, mm, m"]),
    ("x_unit = \"mm\"", "x_unit = \"inch\"", &["unknown value `inch`", "mm"]),
    ("\"slope\"", "\"slope\"\nmax_missing = 1.5", &["ingest.conditioning.max_missing = 1.5"]),
    ("\"slope\"", "{ polynomial = 20 }", &["form.polynomial = 20"]),
    (
        "[realise]",
        "[micro]\nrms_slope_threshold = inf\n[realise]",
        &["micro.rms_slope_threshold = inf: must be positive and finite"],
    ),
    (
        "[characterise]",
        "[characterise]\nlambda_s_mm = 2.5\nlambda_c_mm = 0.8",
        &["characterise.(lambda_s_mm, lambda_c_mm) = (2.5, 0.8)", "in ascending order"],
    ),
    (
        "[characterise]",
        "[characterise]\nlambda_s_mm = 2.5\nsection_length_mm = 2.5",
        &["recipe.toml, line 19: characterise.(lambda_s_mm, section_length_mm) = (2.5, 2.5)"],
    ),
    (
        "[characterise]",
        "[characterise]\nself_affine_shortest_lag_mm = 2\nself_affine_longest_lag_mm = 1",
        &["(self_affine_shortest_lag_mm, self_affine_longest_lag_mm) = (2.0, 1.0)"],
    ),
    (
        "[characterise]",
        "[characterise]\n[characterise.profile_depth]\nhigh_pass_mm = 2",
        &["characterise.profile_depth.(low_pass_mm, high_pass_mm) = (2.4, 2.0)"],
    ),
    (
        "[characterise]",
        "[characterise]\n[characterise.profile_depth]\nsegment_mm = 2",
        &["characterise.profile_depth.(low_pass_mm, segment_mm) = (2.4, 2.0)"],
    ),
    ("mm = 0.5", "mm = inf", &["shortest_wavelength_mm = inf: must be positive and finite"]),
    (
        "shortest_wavelength_mm = 0.5",
        "given = [{ source = 'x', scales = [{ wavelength_mm = 1.0, amplitude_mm = -0.1 }] }]",
        &["scales (wavelength_mm, amplitude_mm) = [(1.0, -0.1)]: must be positive wavelengths"],
    ),
];

#[test]
fn mistakes_in_the_recipe_are_named_and_nothing_is_written() {
    let campaign = Campaign::new();
    let recipe = campaign.read("recipe.toml");
    for (from, to, parts) in MISTAKES {
        campaign.edit("recipe.toml", from, to);
        for command in ["run", "status"] {
            let arguments = format!("{command} recipe.toml --out out");
            let message = outcome(&campaign, &arguments).error(2);
            let placed = ["recipe recipe.toml: ", "recipe recipe.toml, line "];
            assert!(placed.iter().any(|place| message.contains(place)), "{message}");
            for part in parts {
                assert!(message.contains(part), "`{to}`, wanted `{part}`:\n{message}");
            }
        }
        assert!(!campaign.path("out").exists(), "{to}");
        campaign.write("recipe.toml", &recipe);
    }
}

#[test]
fn missing_files_are_named_and_nothing_is_written() {
    let campaign = Campaign::new();
    let recipe = campaign.read("recipe.toml");
    let error = |arguments: &str| outcome(&campaign, arguments).error(2);
    assert!(error("run none.toml --out out").contains("recipe none.toml: cannot be read"));
    assert!(error("run scans --out out").contains("recipe scans: cannot be read"));
    let edited = |from: &str, to: &str| {
        campaign.edit("recipe.toml", from, to);
        let message = error(RUN);
        campaign.write("recipe.toml", &recipe);
        message
    };
    let message = edited(r#"["scans"]"#, r#"["tracks"]"#);
    assert!(message.contains("cannot read the scans tracks: ") && message.contains("--scans"));
    assert!(edited(r#"["scans"]"#, "[]").contains("no scan files in []"));
    fs::create_dir(campaign.path("empty")).unwrap();
    assert!(edited(r#"["scans"]"#, r#"["empty"]"#).contains("no scan files in [empty]"));
    let message = edited(r#"["scans"]"#, r#"["scans", "scans/track_0.txt"]"#);
    assert!(message.contains("two scans are named track_0"), "{message}");
    assert!(
        edited("\"rubber.toml\"", "\"none.toml\"").contains("cannot read the rubber none.toml")
    );
    assert!(
        edited("\"rubber.toml\"", "\"recipe.toml\"")
            .contains("this is a recipe: give the file of the rubber")
    );
    let rubber = campaign.read("rubber.toml");
    campaign.edit("rubber.toml", "= 0.49", "= 0.6");
    let message = error(RUN);
    assert!(message.contains("rubber.toml") && message.contains("poisson_ratio is 0.6"));
    campaign.write("rubber.toml", &rubber);
    assert!(error(&format!("{RUN} --threads 0")).contains("--threads is 0"));
    assert!(error(&format!("{RUN} --threads two")).contains("`two` is not a whole number"));
    assert!(error(&format!("{RUN} --only fem")).contains("approximate, realise, bem, tables"));
    assert!(error(&format!("{RUN} --only bem --from bem")).contains("cannot be used with"));
    assert!(!campaign.path("out").exists());
}

#[test]
fn bad_scans_are_named_with_line_and_reason_and_leave_no_result() {
    let campaign = Campaign::new();
    let good = campaign.read("scans/track_1.txt");
    let refused = |text: &str, parts: &[&str]| {
        campaign.write("scans/track_1.txt", text);
        let message = outcome(&campaign, RUN).error(2);
        for part in ["ingest: ", "track_1"].iter().chain(parts) {
            assert!(message.contains(part), "wanted `{part}`:\n{message}");
        }
        assert!(!campaign.path("out/ingest").exists());
    };
    refused("", &["the file is empty"]);
    refused("\u{89}PNG\0\0", &["binary data"]);
    refused("a,b\n1,2\n3,4\n", &["no column `x_mm`", "separator"]);
    refused(&good.replace("0.050;", "0.050;x"), &["line 5", "z_um", "is not a number"]);
    refused(&good.replace("0.075;", "0.010;"), &["line 6", "comes after 0.05", "`x_column`"]);
    let lines = |keep: usize| good.lines().take(keep).map(|l| format!("{l}\n")).collect::<String>();
    refused(&lines(200), &["same spacing and length", "window_length_mm"]);
    let gaps = |every: usize| -> String {
        let line = |(i, line): (usize, &str)| match line.split_once(';') {
            Some((x, _)) if i > 1 && i.is_multiple_of(every) => format!("{x};BAD\n"),
            _ => format!("{line}\n"),
        };
        good.lines().enumerate().map(line).collect()
    };
    refused(&gaps(1), &["all 320 heights are missing", "`missing`"]);
    refused(&gaps(3), &["of the points are missing", "the limit is 10.0 %", "max_missing"]);

    campaign.write("scans/track_1.txt", &good);
    campaign.write("average.txt", &good);
    let message = outcome(&campaign, &format!("{RUN} --scans scans average.txt")).error(2);
    assert!(message.contains("average.txt") && message.contains("rename the file"), "{message}");
    assert_eq!(outcome(&campaign, &format!("{RUN} --quiet")).result(), "");
}

#[test]
fn a_failed_computation_is_exit_code_1_and_keeps_what_was_done() {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "[0.02, 0.05, 0.1]", "[1e-12]");
    let failed = outcome(&campaign, RUN);
    assert_eq!((failed.code, failed.stdout.as_str()), (1, ""));
    let message = failed.stderr.lines().find(|line| line.starts_with("error: ")).unwrap();
    assert!(message.starts_with("error: bem: 3 waves, realisation "), "{message}");
    assert!(
        failed.stderr.contains("1e-12 is less than two of 512 grid points"),
        "{}",
        failed.stderr
    );
    assert!(campaign.path("out/realise/manifest.json").exists());
    assert!(!campaign.path("out/bem").exists());
}

/// 20 waves at 65536 points a wave would not fit into any memory.
#[test]
fn a_grid_too_large_to_hold_is_refused() {
    let campaign = Campaign::new();
    let longest = 0.0625 * 2_f64.powi(19);
    let given = format!(
        "given = [{{ source = 'x', scales = [{{ wavelength_mm = 0.0625, amplitude_mm = 0.01 }}, \
         {{ wavelength_mm = {longest:?}, amplitude_mm = 1.0 }}] }}]"
    );
    let recipe = format!(
        "title = 'x'\n[approximate]\n{given}\n[realise]\nwaves = [2]\nrealisations = 1\nseed = 1\n\
         [bem]\nrubber = 'rubber.toml'\nspeeds_mm_s = [10.0]\npoints_per_shortest_wavelength = 65536\n"
    );
    campaign.write("recipe.toml", &recipe);
    let failed = outcome(&campaign, RUN);
    // The recipe asks for it: bad input.
    assert_eq!(failed.code, 2);
    assert!(failed.stderr.contains("points_per_shortest_wavelength"), "{}", failed.stderr);
    assert!(failed.stderr.contains("8 to 16777216"), "{}", failed.stderr);
    let refused = outcome(&campaign, &format!("{RUN} --scans scans")).error(2);
    assert!(refused.contains("leave --scans out"), "{refused}");
}

#[test]
fn a_place_that_cannot_be_written_is_named() {
    let campaign = Campaign::new();
    campaign.write("file", "mine");
    let message = outcome(&campaign, "run recipe.toml --out file").error(2);
    assert!(message.contains("cannot create file"), "{message}");
    assert_eq!(campaign.read("file"), "mine");
    let folder = campaign.path("locked");
    fs::create_dir(&folder).unwrap();
    let mut permissions = fs::metadata(&folder).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&folder, permissions).unwrap();
    if fs::write(folder.join("probe"), "").is_ok() {
        eprintln!("skipped: this user may write to a read-only folder");
        return;
    }
    let message = outcome(&campaign, "run recipe.toml --out locked").error(1);
    assert!(message.contains("locked") && message.contains("write access"), "{message}");
}

/// Nothing of the small campaign is steep, so that the microscale costs nothing and warns of it.
pub(super) fn with_microscale() -> Campaign {
    let campaign = Campaign::new();
    campaign.write("recipe.toml", &(campaign.read("recipe.toml") + "\n[micro]\n"));
    campaign
}

#[test]
fn warnings_are_repeated_as_long_as_their_results_are_in_use() {
    let campaign = with_microscale();
    let warning = "no wave is steeper than 0.7 (micro.rms_slope_threshold)";
    for _ in 0..2 {
        let run = outcome(&campaign, RUN);
        assert_eq!(run.code, 0);
        assert!(run.stderr.contains(warning), "{}", run.stderr);
    }
    let json = outcome(&campaign, &format!("{RUN} --quiet --json --only micro")).json();
    assert_eq!(json["stages"][0]["computed"], false);
    assert!(json["stages"][0]["warnings"][0].as_str().unwrap().contains(warning), "{json}");
}

#[test]
fn a_forced_stage_must_be_among_the_selected_ones() {
    let campaign = Campaign::new();
    for selection in ["--only tables --force bem", "--from tables --force bem"] {
        let message = outcome(&campaign, &format!("{RUN} {selection}")).error(2);
        assert!(message.contains("--force bem does nothing"), "{message}");
    }
    assert!(!campaign.path("out").exists());
}

#[test]
fn a_rubber_that_finite_elements_refuse_is_found_before_anything_runs() {
    let campaign = with_microscale();
    campaign.edit("rubber.toml", "= 0.49", "= 0.5");
    for command in [RUN, "status recipe.toml --out out"] {
        let message = outcome(&campaign, command).error(2);
        assert!(message.starts_with("error: micro: rubber.toml: "), "{message}");
        assert!(message.contains("poisson_ratio is 0.5, "), "{message}");
        assert!(!message.contains("caused by"), "{message}");
    }
    assert!(!campaign.path("out").exists());
    campaign.edit("recipe.toml", "[micro]", "");
    outcome(&campaign, &format!("{RUN} --quiet")).result();
}

#[test]
fn a_plan_tells_models_and_grids_and_writes_nothing() {
    let campaign = Campaign::new();
    let text = outcome(&campaign, "plan recipe.toml --out out").result();
    assert!(text.contains("3 waves, 10 mm/s: "), "{text}");
    assert!(text.contains("half-space") && text.contains("no [micro]"), "{text}");
    assert!(!campaign.path("out").exists());

    let steep = campaign.read("recipe.toml") + "\n[micro]\nrms_slope_threshold = 1e-3\n";
    campaign.write("steep.toml", &steep);
    let message = outcome(&campaign, "plan steep.toml --threads 0").error(2);
    assert!(message.contains("--threads is 0"), "{message}");
    let json = outcome(&campaign, "plan recipe.toml --threads 2 --json").json();
    let curve = &json["curves"][0];
    assert_eq!(curve["scales"].as_array().unwrap().len(), 3);
    // What it foretells is what is then solved.
    outcome(&campaign, &format!("{RUN} --quiet")).result();
    let solves = outcome(&campaign, "export out --table bem/solves --format csv").result();
    let header: Vec<&str> = solves.lines().next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|cell| *cell == name).unwrap();
    let (realisation, points) = (column("realisation"), column("grid_points"));
    let of_first = solves.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    let of_first: Vec<u64> = of_first
        .filter(|cells| cells[realisation] == "1")
        .map(|cells| cells[points].parse().unwrap())
        .collect();
    assert_eq!(curve["solves"], of_first.len());
    assert_eq!(curve["grid_points"][1], *of_first.iter().max().unwrap());

    let finer = outcome(&campaign, "plan recipe.toml --tolerance 0.01 --json").json();
    let most = |plan: &serde_json::Value| plan["curves"][0]["grid_points"][1].as_u64().unwrap();
    assert!(most(&finer) > most(&json), "{finer}");
    campaign.write("sine.toml", "title = 'x'\n[sinusoid]\nrubber = 'rubber.toml'\n");
    let message = outcome(&campaign, "plan sine.toml").error(2);
    assert!(message.contains("sinusoid"), "{message}");
}

#[test]
fn a_recipe_has_a_temperature_and_tells_what_is_extrapolated() {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "speeds_mm_s", "temperature_c = 60.0\nspeeds_mm_s");
    let refused = outcome(&campaign, RUN).error(2);
    assert!(refused.contains("rubber.toml") && refused.contains("no [temperature]"), "{refused}");
    assert!(!campaign.path("out").exists());

    let rubber = campaign.read("rubber.toml");
    let section = "measured_hz = [1.0, 1e3]\n[temperature]\nreference_c = 20.0\n\
        measured_c = [0.0, 40.0]\nwlf = { c1 = 8.0, c2_k = 120.0 }\n";
    campaign.write("rubber.toml", &rubber.replacen("\n[[", &format!("\n{section}\n[["), 1));
    let run = outcome(&campaign, RUN);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("60 °C is outside the 0 to 40 °C"), "{}", run.stderr);
    // log10 a = -8 * 40 / 160 = -2: the measured range is 100 to 1e5 Hz, of the waves those of 0.5 and 1 mm have
    // an amplitude.
    let frequencies = "from 1.000e1 to 2.000e1 Hz, it was measured from 1.000e2 to 1.000e5 Hz";
    assert!(run.stderr.contains(frequencies), "{}", run.stderr);

    campaign.edit("recipe.toml", "temperature_c = 60.0", "temperature_c = 20.0");
    let status = outcome(&campaign, "status recipe.toml --out out").result();
    assert!(status.contains("bem.temperature_c: 60.0 -> 20.0"), "{status}");
    let run = outcome(&campaign, RUN);
    assert!(!run.stderr.contains("warning: the waves"), "{}", run.stderr);
}
