//! Maps, rows and curves that fail, and the others that go on.

use super::areal::{campaign, road, warnings, write_map};
use super::{Campaign, recipe, run, stale, try_run};
use asperity::artifact::RunView;
use asperity::pipeline::Selection;
use asperity::stages;
use asperity::stages::areal::{AREAL_CURVES, AREAL_UNSOLVED};
use asperity::stages::bem::Given;
use asperity::stages::ingest::{MAP_WINDOWS, WINDOWS, read_maps};
use asperity::stages::realise::{AREAL_SURFACES, Method};
use asperity::stages::tables::FRICTION;
use asperity::surface::synthesis::SyntheticMap;

fn heights() -> Vec<f64> {
    let map = SyntheticMap { length: 6.4e-3, rms_height: 5e-5, ..SyntheticMap::bundled() };
    map.generate("map").unwrap().heights
}

/// Rows that no line can be made of, level rows, and a second map of another size.
fn difficult() -> Campaign {
    let mut all = heights();
    for row in all.chunks_exact_mut(128).take(3) {
        row[..60].fill(f64::NAN);
    }
    all[64 * 128..66 * 128].fill(0.0);
    let campaign = campaign(128, all);
    let smaller =
        heights().chunks_exact(128).take(70).flat_map(|row| &row[..100]).copied().collect();
    write_map(&campaign, "smaller.sdf", 100, smaller);
    campaign.edit("recipe.toml", "[\"map.sdf\"]", "[\"map.sdf\", \"smaller.sdf\"]");
    campaign
}

#[test]
fn maps_alone_do_without_lines() {
    let campaign = difficult();
    campaign.edit("recipe.toml", "periodic = \"blend\"", "periodic = \"blend\"\nprofiles = false");
    // As a line neither map is as long as a window.
    campaign.edit("recipe.toml", "window_length_mm = 3.2\n", "window_length_mm = 30.0\n");
    let out = campaign.path("out");
    let computed = run(&recipe(&campaign), &out);
    assert!(!computed.contains(&stages::approximate::STAGE), "{computed:?}");
    let told = warnings(&campaign, "ingest").join("\n");
    assert!(told.contains("the maps stand alone (realise.profiles = false)"), "{told}");
    assert!(told.contains("[ingest.conditioning] does nothing"), "{told}");
    let view = RunView::of(&out);
    assert!(view.rows(WINDOWS).unwrap().is_empty());
    assert_eq!(read_maps(&view).unwrap().len(), 5);
    let rows = view.rows(FRICTION).unwrap();
    assert_eq!(rows.len(), 2);
    for row in &rows {
        assert_eq!((row.kind.method, row.windows), (Method::ArealMeasured, 5));
        assert_eq!(row.shortest_wavelength_mm, 0.4);
        assert_eq!(row.shortest_reliable_wavelength_mm, Some(0.1));
    }
    // Nothing is computed twice, and without a shortest wavelength it is what the maps show.
    assert!(stale(&recipe(&campaign), &out).is_empty());
    campaign.edit("recipe.toml", "shortest_wavelength_mm = 0.4\n", "");
    campaign.edit("recipe.toml", "profiles = false", "profiles = false\nmost_windows = 1");
    try_run(
        &recipe(&campaign),
        &out,
        Selection { only: Some(stages::realise::STAGE), ..Selection::default() },
    )
    .unwrap();
    let surfaces = view.rows(AREAL_SURFACES).unwrap();
    assert!((surfaces[0].shortest_wavelength_mm - 0.1).abs() < 1e-12, "{surfaces:?}");
}

#[test]
fn rows_that_cannot_be_conditioned_are_left_out_beside_their_map() {
    let campaign = difficult();
    campaign.edit("recipe.toml", "[\"map.sdf\", \"smaller.sdf\"]", "[\"map.sdf\"]");
    campaign.edit("recipe.toml", "window_length_mm = 3.2\n", "window_length_mm = 6.4\n");
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let told = warnings(&campaign, "ingest").join("\n");
    assert!(
        told.contains("1 of 16 lines of height maps are left out: the first, map_row_0000 of "),
        "{told}"
    );
    assert!(told.contains("map.sdf, because") && told.contains("are missing"), "{told}");
    let view = RunView::of(&out);
    let windows = view.rows(WINDOWS).unwrap();
    assert!(windows.len() == 15 && windows.iter().all(|row| row.rejected.is_none()));
    let rows = view.rows(FRICTION).unwrap();
    for method in [Method::Measured, Method::ArealMeasured] {
        assert_eq!(rows.iter().filter(|row| row.kind.method == method).count(), 2);
    }
}

#[test]
fn maps_without_a_window_are_left_out() {
    let campaign = road();
    for (name, side) in [("small.sdf", 40), ("tiny.sdf", 20)] {
        let part =
            heights().chunks_exact(128).take(side).flat_map(|row| &row[..side]).copied().collect();
        write_map(&campaign, name, side, part);
    }
    campaign.edit("recipe.toml", "[\"map.sdf\"]", "[\"map.sdf\", \"small.sdf\", \"tiny.sdf\"]");
    campaign.edit("recipe.toml", "periodic = \"blend\"", "profiles = false");
    let out = campaign.path("out");
    let only = Selection { only: Some(stages::ingest::STAGE), ..Selection::default() };
    try_run(&recipe(&campaign), &out, only).unwrap();
    let told = warnings(&campaign, "ingest").join("\n");
    assert!(
        told.contains("2 of 3 height maps are left out: map small is 2.000 mm long along x"),
        "{told}"
    );
    assert!(told.contains("map tiny is 1.000 mm long along x"), "{told}");
    let view = RunView::of(&out);
    assert_eq!(read_maps(&view).unwrap().len(), 4);
    let rows = view.rows(MAP_WINDOWS).unwrap();
    assert_eq!(rows.iter().filter(|row| row.rejected.is_some()).count(), 2);
    campaign.edit("recipe.toml", "\"map.sdf\", ", "");
    let message = try_run(&recipe(&campaign), &out, only).unwrap_err().to_string();
    assert!(message.contains("no height map is left (ingest.maps): map small is"), "{message}");
    assert!(message.contains("; map tiny is"), "{message}");
}

/// Along ridges nothing changes, so that friction is zero by symmetry, and what is left is the grid's.
#[test]
fn friction_that_vanishes_by_symmetry_has_values() {
    let heights = (0..64 * 64).map(|k| if k % 16 < 8 { 0.0 } else { 2e-5 });
    let campaign = campaign(64, heights.collect());
    campaign.edit("recipe.toml", "periodic = \"blend\"", "periodic = \"blend\"\nprofiles = false");
    campaign.edit("recipe.toml", "[bem]", "[areal]\nangles_deg = [0.0, 90.0]\n\n[bem]");
    campaign.edit("recipe.toml", "area_fractions = [0.05]", "area_fractions = [0.1, 0.3]");
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let (curves, unsolved) = (view.rows(AREAL_CURVES).unwrap(), view.rows(AREAL_UNSOLVED).unwrap());
    assert!(unsolved.is_empty(), "{unsolved:?}");
    let across = curves.iter().filter(|row| row.angle_deg == 90.0);
    assert_eq!(across.clone().count(), 3);
    for row in across {
        assert!(row.friction_coefficient.abs() < 1e-9, "{row:?}");
        assert!(row.discretisation_error.is_none_or(|error| error < 1e-6), "{row:?}");
    }
    let along = curves.iter().filter(|row| row.angle_deg == 0.0);
    assert!(along.clone().count() == 3 && along.clone().all(|row| row.friction_coefficient > 1e-3));
    let told = warnings(&campaign, "areal").join("\n");
    let percent =
        |text: &str| text.split(" %").next()?.rsplit("up to ").next()?.parse::<f64>().ok();
    assert!(percent(&told).is_none_or(|worst| worst < 1000.0), "{told}");
}

#[test]
fn one_value_that_cannot_be_had_leaves_the_others() {
    let campaign = road();
    campaign.edit("recipe.toml", "periodic = \"blend\"", "periodic = \"blend\"\nprofiles = false");
    campaign.edit("recipe.toml", "area_fractions = [0.05]", "area_fractions = [1e-5, 0.05]");
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let unsolved = view.rows(AREAL_UNSOLVED).unwrap();
    assert_eq!(unsolved.len(), 4);
    for row in &unsolved {
        assert_eq!(
            (row.given, row.contact_area_fraction, row.pressure_mpa),
            (Given::Area, Some(1e-5), None)
        );
        assert!(row.reason.contains("less than two of 16384 grid points"), "{row:?}");
    }
    let curves = view.rows(AREAL_CURVES).unwrap();
    assert_eq!(curves.len(), 2 * 4);
    assert!(
        curves.iter().all(|row| row.given == Given::Pressure || row.contact_area_fraction == 0.05)
    );
    let rows = view.rows(FRICTION).unwrap();
    assert!(rows.len() == 2 && rows.iter().all(|row| row.realisations.len() == 4));
    let told = warnings(&campaign, "areal").join("\n");
    assert!(told.contains("4 of 12 values of areal surfaces could not be had"), "{told}");
    assert!(told.contains("at 0 degrees, area 0.00001: "), "{told}");
}
