//! ingest of instrument files beside text.

use super::{Campaign, recipe, try_run};
use asperity::artifact::{Manifest, RunView};
use asperity::pipeline::Selection;
use asperity::recipe::Recipe;
use asperity::scans::file::{Grid, ScanFile, write_x3p};
use asperity::stages;
use asperity::stages::ingest::{read_maps, read_windows};

const ONLY_INGEST: Selection =
    Selection { only: Some(stages::ingest::STAGE), from: None, force: None };

/// The heights of the text scans of the campaign: 320 points, 25 um apart.
fn write(campaign: &Campaign, name: &str, rows: usize) {
    let height = |i: usize| (0.3 * i as f64).sin() * 1e-5;
    let heights: Vec<f64> = (0..320 * rows).map(height).collect();
    let grid = match rows {
        1 => Grid::Profile { spacing: 25e-6 },
        _ => Grid::Map { columns: 320, rows, spacing_x: 25e-6, spacing_y: 25e-6 },
    };
    let scan = ScanFile {
        format: "test".into(),
        detected: String::new(),
        grid,
        heights,
        instrument: Vec::new(),
    };
    std::fs::write(campaign.path(name), write_x3p(&scan).unwrap()).unwrap();
}

fn windows(campaign: &Campaign) -> Vec<String> {
    try_run(&recipe(campaign), &campaign.path("out"), ONLY_INGEST).unwrap();
    let windows = read_windows(&RunView::of(campaign.path("out"))).unwrap();
    windows.into_iter().map(|window| window.name).collect()
}

#[test]
fn instrument_files_and_texts_are_read_side_by_side() {
    let campaign = Campaign::new();
    // The name says nothing: the content does.
    write(&campaign, "scans/x3p_scan.dat", 1);
    assert_eq!(windows(&campaign), ["track_0", "track_1", "track_2", "x3p_scan"]);
}

/// Warnings of ingest.
fn warnings(campaign: &Campaign) -> Vec<String> {
    try_run(&recipe(campaign), &campaign.path("out"), ONLY_INGEST).unwrap();
    let text = campaign.read("out/ingest/manifest.json");
    serde_json::from_str::<Manifest>(&text).unwrap().warnings
}

#[test]
fn heights_of_instruments_are_turned_where_the_recipe_says_so() {
    let heights = |key: &str| {
        let campaign = Campaign::new();
        write(&campaign, "a.x3p", 1);
        campaign.edit("recipe.toml", r#"["scans"]"#, &format!("[\"a.x3p\"]\n{key}"));
        let text = campaign.read("recipe.toml");
        let section = text.find("[ingest.text]").unwrap()..text.find("[ingest.cond").unwrap();
        campaign.edit("recipe.toml", &text[section], "");
        assert_eq!(warnings(&campaign), Vec::<String>::new());
        read_windows(&RunView::of(campaign.path("out"))).unwrap().remove(0).heights
    };
    let (plain, turned) = (heights(""), heights("invert_instrument_heights = true"));
    for (plain, turned) in plain.iter().zip(&turned) {
        // The line taken off is fitted to turned numbers.
        approx::assert_abs_diff_eq!(*plain, -turned, epsilon = 1e-18);
    }
}

#[test]
fn what_describes_no_file_and_units_that_contradict_the_file_are_warned_of() {
    let campaign = Campaign::new();
    assert_eq!(warnings(&campaign), Vec::<String>::new());
    campaign.edit("recipe.toml", "z_unit = \"um\"", "z_unit = \"nm\"");
    let told = warnings(&campaign);
    let parts = ["3 of 3 files", "track_0", "`z_um` states um", "z_unit = \"nm\""];
    assert!(parts.iter().all(|part| told[1].contains(part)), "{told:?}");
    assert!(told.len() == 2 && told[0].contains("smoother than any road"), "{told:?}");

    let campaign = Campaign::new();
    write(&campaign, "a.x3p", 1);
    campaign.edit("recipe.toml", r#"["scans"]"#, r#"["a.x3p"]"#);
    let told = warnings(&campaign);
    assert!(told.len() == 1 && told[0].starts_with("[ingest.text] describes no scan"), "{told:?}");
    let campaign = Campaign::new();
    let key = "[\"scans\"]\ninvert_instrument_heights = true";
    campaign.edit("recipe.toml", r#"["scans"]"#, key);
    let told = warnings(&campaign);
    assert!(told.len() == 1 && told[0].contains("ingest.text.invert_z"), "{told:?}");
}

#[test]
fn positions_in_a_unit_a_thousand_times_off_are_refused() {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "x_unit = \"mm\"", "x_unit = \"um\"");
    let error = try_run(&recipe(&campaign), &campaign.path("out"), ONLY_INGEST).unwrap_err();
    let text = error.to_string();
    let parts = ["track_0", "steeper than", "0.007975 mm long", "`x_unit`"];
    assert!(parts.iter().all(|part| text.contains(part)), "{text}");
}

#[test]
fn repeated_positions_of_a_text_are_averaged_or_refused() {
    let campaign = Campaign::new();
    let text = campaign.read("scans/track_0.txt");
    let line = text.lines().nth(60).unwrap();
    let (position, _) = line.split_once(';').unwrap();
    campaign.edit("scans/track_0.txt", line, &format!("{line}\n{position};400"));
    assert_eq!(windows(&campaign), ["track_0", "track_1", "track_2"]);
    let refuse = "\"slope\"\nrepeated_positions = \"refuse\"";
    campaign.edit("recipe.toml", "\"slope\"", refuse);
    let error = try_run(&recipe(&campaign), &campaign.path("out"), ONLY_INGEST).unwrap_err();
    let text = error.to_string();
    let parts = ["track_0: 1 points", "ingest.conditioning.repeated_positions = \"mean\"", " mm"];
    assert!(parts.iter().all(|part| text.contains(part)), "{text}");
}

#[test]
fn heights_that_no_road_has_are_warned_of_until_they_are_cut() {
    let campaign = Campaign::new();
    let text = campaign.read("scans/track_1.txt");
    let plate = |(i, line): (usize, &str)| match line.split_once(';') {
        Some((position, _)) if (22..30).contains(&i) => format!("{position};48000\n"),
        _ => format!("{line}\n"),
    };
    let plated: String = text.lines().enumerate().map(plate).collect();
    campaign.write("scans/track_1.txt", &plated);
    // Without the detector of spikes, which would take so short a plate.
    campaign.edit("recipe.toml", "\"slope\"", "\"slope\"\nspike_threshold = 0.0");
    let told = warnings(&campaign);
    let parts = ["1 of 3 scans", "track_1, 8 between 0.5 and 0.7 mm", "cut_start_mm"];
    assert!(told.iter().any(|told| parts.iter().all(|part| told.contains(part))), "{told:?}");
    let cut = "\"slope\"\nvalid_range_mm = [-1.0, 1.0]";
    campaign.edit("recipe.toml", "\"slope\"", cut);
    assert_eq!(warnings(&campaign), Vec::<String>::new());
}

#[test]
fn lines_of_a_map_are_scans_if_the_recipe_says_which() {
    let campaign = Campaign::new();
    write(&campaign, "map.x3p", 5);
    campaign.edit("recipe.toml", r#"["scans"]"#, r#"["map.x3p"]"#);
    let error = try_run(&recipe(&campaign), &campaign.path("out"), ONLY_INGEST).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("5 rows of 320 points") && text.contains("ingest.map_lines"), "{text}");
    let chosen = "[\"map.x3p\"]\nmap_lines = \"rows\"\nmap_line_step = 2";
    campaign.edit("recipe.toml", r#"["map.x3p"]"#, chosen);
    assert_eq!(windows(&campaign), ["map_row_0000", "map_row_0002", "map_row_0004"]);
}

#[test]
fn a_text_without_a_description_is_an_error_that_says_how_to_get_one() {
    let campaign = Campaign::new();
    let recipe_text = campaign.read("recipe.toml");
    let start = recipe_text.find("[ingest.text]").unwrap();
    let end = recipe_text.find("[ingest.conditioning]").unwrap();
    campaign.edit("recipe.toml", &recipe_text[start..end], "");
    let error = try_run(&recipe(&campaign), &campaign.path("out"), ONLY_INGEST).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("track_0.txt") && text.contains("[ingest.text]"), "{text}");
}

#[test]
fn a_matrix_of_heights_is_kept_as_a_map() {
    let campaign = Campaign::new();
    let mut text = String::from("exported\n");
    for j in 0..40 {
        let height = |i: i32| match (i, j) {
            (17, 9) => "BAD".to_owned(),
            _ => format!("{:.4}", 8.0 * (0.3 * f64::from(i) + 0.7 * f64::from(j)).sin()),
        };
        text += &((0..320).map(height).collect::<Vec<_>>().join(";") + "\n");
    }
    campaign.write("map.txt", &text);
    let recipe_text = campaign.read("recipe.toml");
    let section =
        recipe_text.find("[ingest.text]").unwrap()..recipe_text.find("[ingest.cond").unwrap();
    let described = "[ingest.text]\nmatrix = true\nseparator = \"semicolon\"\nskip_lines = 1\n\
                     x_spacing_um = 25.0\ny_spacing_um = 50.0\nz_unit = \"um\"\n\n[ingest.maps]\n\n";
    campaign.edit("recipe.toml", &recipe_text[section], described);
    campaign.edit("recipe.toml", r#"["scans"]"#, "[\"map.txt\"]\nmap_line_step = 20");
    assert_eq!(windows(&campaign), ["map_row_0000", "map_row_0020"]);
    let maps = read_maps(&RunView::of(campaign.path("out"))).unwrap();
    let [map] = &maps[..] else { panic!("{} maps", maps.len()) };
    assert_eq!((map.name.as_str(), map.points, map.spacing), ("map", [320, 40], [25e-6, 50e-6]));
    campaign.edit("recipe.toml", "matrix = true", "matrix = true\nx_column = 1");
    let error = Recipe::read(&campaign.path("recipe.toml")).unwrap_err().to_string();
    assert!(error.contains("x_column") && error.contains("matrix = true"), "{error}");
}
