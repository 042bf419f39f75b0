//! ingest of instrument files beside text.

use super::{Campaign, recipe, try_run};
use asperity::artifact::RunView;
use asperity::pipeline::Selection;
use asperity::scans::file::{Grid, ScanFile, write_x3p};
use asperity::stages::Stage;
use asperity::stages::ingest::read_windows;

const ONLY_INGEST: Selection = Selection { only: Some(Stage::Ingest), from: None, force: None };

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
