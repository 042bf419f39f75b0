//! characterise where keys do not fit the scans, and scans that have no roughness: numbers are left
//! out with a warning, the others are there.

use super::{Campaign, recipe, try_run};
use asperity::artifact::{Manifest, Row, RunView, Table};
use asperity::pipeline::Selection;
use asperity::stages;
use asperity::stages::characterise::{
    AVERAGE, DEPTH, HURST, ISOTROPIC, PARAMETERS, PROFILE, SELF_AFFINE,
};

/// Ingest and characterise; returns the warnings of the latter.
fn characterise(campaign: &Campaign) -> Vec<String> {
    for stage in [stages::ingest::STAGE, stages::characterise::STAGE] {
        let only = Selection { only: Some(stage), ..Selection::default() };
        try_run(&recipe(campaign), &campaign.path("out"), only).unwrap();
    }
    let text = campaign.read("out/characterise/manifest.json");
    serde_json::from_str::<Manifest>(&text).unwrap().warnings
}

fn with(keys: &str) -> (Campaign, Vec<String>) {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "[characterise]", &format!("[characterise]\n{keys}"));
    let warnings = characterise(&campaign);
    (campaign, warnings)
}

fn rows<R: Row>(campaign: &Campaign, table: Table<R>) -> Vec<R> {
    RunView::of(campaign.path("out")).rows(table).unwrap()
}

#[track_caller]
fn assert_told(warnings: &[String], parts: &[&str]) {
    let told = |warning: &String| parts.iter().all(|part| warning.contains(part));
    assert!(warnings.iter().any(told), "{parts:?} is not in {warnings:#?}");
}

/// Whether a run says nothing but what it says with the keys at their defaults.
fn usual() -> Vec<String> {
    with("").1
}

#[test]
fn cut_offs_and_sections_that_do_not_fit_leave_rows_out_with_a_warning() {
    let cases: [(&str, &[&str]); 4] = [
        ("lambda_c_mm = 0.04", &["characterise.lambda_c_mm = 0.04", "two spacings of 0.0250 mm"]),
        ("lambda_s_mm = 3.0", &["characterise.lambda_s_mm = 3", "a third of its 8.0000 mm"]),
        ("section_length_mm = 0.1", &["a section has 4 of at least 5 points", "section_length_mm"]),
        (
            "lambda_s_mm = 3.0\nlambda_c_mm = 4.0\nsection_length_mm = 4.0",
            &["characterise.lambda_s_mm = 3"],
        ),
    ];
    for (keys, parts) in cases {
        let (campaign, warnings) = with(keys);
        assert_told(&warnings, &["3 of 3 windows have no profile parameters: the first, track_0"]);
        assert_told(&warnings, parts);
        assert_eq!(rows(&campaign, PROFILE), []);
        assert_eq!(rows(&campaign, PARAMETERS).len(), 3);
    }
    let (campaign, warnings) = with("lambda_c_mm = 80.0");
    assert_told(&warnings, &["half a cut-off at each end", "8.0000 mm", "gaussian_regression"]);
    assert_eq!(rows(&campaign, PROFILE), []);
    for (key, keys) in [
        ("lambda_c_mm", "lambda_c_mm = 80.0\nprofile_filter = \"gaussian_regression\""),
        ("section_length_mm", "section_length_mm = 80.0"),
    ] {
        let (campaign, warnings) = with(keys);
        let value = format!(
            "characterise.{key} = 80 is longer than what is evaluated of the window track_0"
        );
        assert_told(&warnings, &[&value, "one section"]);
        let rows = rows(&campaign, PROFILE);
        assert!(rows.len() == 3 && rows.iter().all(|row| row.sections == 1), "{rows:?}");
    }
    // What fits, and a section of the whole window, are no reason for a word.
    let (_, warnings) = with("lambda_s_mm = 0.1\nlambda_c_mm = 0.8\nsection_length_mm = 7.2");
    assert_eq!(warnings, usual());
}

#[test]
fn segments_without_a_mean_profile_depth_are_told() {
    // The shorter segments have one gap of 160 points or none, the windows of 8 mm two each.
    let (campaign, warnings) =
        with("[characterise.profile_depth]\nsegment_mm = 4.0\nmost_drop_outs = 0.0");
    let rows = rows(&campaign, DEPTH);
    let without = rows.iter().filter(|row| row.depth_mm.is_none()).count();
    assert!(without > 0 && rows.len() == 6, "{rows:?}");
    let count = format!("{without} of 6 segments have no mean profile depth: the first, track_");
    assert_told(
        &warnings,
        &[&count, "the limit is 0.0 %", "cleaning made missing", "most_drop_outs"],
    );
    let (_, warnings) = with("[characterise.profile_depth]\nsegment_mm = 10.0");
    assert_told(
        &warnings,
        &["3 of 3 windows have no mean profile depth: the first, track_0", "segment_mm = 10"],
    );
    // Windows of 8 mm are not made for segments of 100 mm.
    assert!(!usual().iter().any(|warning| warning.contains("depth")), "{:?}", usual());
}

#[test]
fn narrow_bins_leave_out_what_is_not_defined() {
    for bins in [500, 1000] {
        let (campaign, _) = with(&format!("spectrum_bins_per_decade = {bins}"));
        let rows = rows(&campaign, ISOTROPIC);
        assert!(rows.iter().any(|row| row.abel_density_mm4.is_some()), "{bins}");
    }
}

#[test]
fn a_self_affine_fit_that_fails_is_left_out_and_names_its_keys() {
    let (campaign, warnings) = with("self_affine_shortest_lag_mm = 3.9");
    let keys = "characterise.self_affine_shortest_lag_mm, or raise self_affine_longest_lag_mm";
    assert_told(&warnings, &["no self-affine fit of the average", " mm, at least 3", keys]);
    assert_told(&warnings, &["3 of 3 windows have no self-affine fit: the first, track_0"]);
    assert_eq!(rows(&campaign, SELF_AFFINE), []);
    assert_eq!(rows(&campaign, HURST), []);
    assert_eq!(rows(&campaign, PARAMETERS).len(), 3);
}

/// The same positions as before, all at one height.
fn flatten(campaign: &Campaign, scan: &str) {
    let file = format!("scans/{scan}.txt");
    let text = campaign.read(&file);
    let flat = |line: &str| match line.split_once(';') {
        Some((position, z)) if z != "z_um" && z != "BAD" => format!("{position};400\n"),
        _ => format!("{line}\n"),
    };
    campaign.write(&file, &text.lines().map(flat).collect::<String>());
}

#[test]
fn a_flat_scan_among_others_has_no_roughness_and_stops_nothing() {
    let campaign = Campaign::new();
    flatten(&campaign, "track_1");
    let warnings = characterise(&campaign);
    assert_told(&warnings, &["1 of 3 windows have no roughness parameters: the first, track_1"]);
    assert_told(&warnings, &["1 of 3 windows have no self-affine fit: the first, track_1"]);
    assert_told(&warnings, &["1 of 3 windows have no profile parameters: the first, track_1"]);
    let names: Vec<_> = rows(&campaign, PARAMETERS).into_iter().map(|row| row.scan).collect();
    assert_eq!(names, ["track_0", "track_2"]);
    let rows = rows(&campaign, SELF_AFFINE);
    assert_eq!(rows.last().unwrap().scan, AVERAGE);
}

#[test]
fn flat_scans_alone_are_characterised_and_the_fit_of_waves_says_why_it_cannot_be() {
    let campaign = Campaign::new();
    ["track_0", "track_1", "track_2"].iter().for_each(|scan| flatten(&campaign, scan));
    let warnings = characterise(&campaign);
    assert_told(&warnings, &["3 of 3 windows have no roughness parameters"]);
    assert_eq!(rows(&campaign, PARAMETERS), []);
    let only = Selection { only: Some(stages::approximate::STAGE), ..Selection::default() };
    let error = try_run(&recipe(&campaign), &campaign.path("out"), only).unwrap_err();
    assert!(error.to_string().contains("correlation"), "{error}");
}
