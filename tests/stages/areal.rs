//! Maps through the pipeline: areal surfaces beside the profiles of their rows.

use super::{Campaign, recipe, run, try_run};
use asperity::artifact::{Manifest, RunView};
use asperity::pipeline::Selection;
use asperity::recipe::Recipe;
use asperity::scans::file::{Grid, ScanFile, write_sdf};
use asperity::stages::areal::{AREAL_CURVES, AREAL_FIELDS, AREAL_SOLVES};
use asperity::stages::bem::{CURVES, Given};
use asperity::stages::characterise::{AREAL_AVERAGES, AREAL_DIRECTIONS, AREAL_PARAMETERS};
use asperity::stages::ingest::{FAULTS, MAP_WINDOWS, read_maps};
use asperity::stages::realise::{AREAL_SURFACES, Method, SurfaceKind, read_areal_surfaces};
use asperity::stages::tables::{BUDGET, FRICTION, METHODS, Part};
use asperity::surface::synthesis::SyntheticMap;
use std::f64::consts::TAU;

const RECIPE: &str = r#"title = "A map"

[ingest]
scans = ["map.sdf"]
map_line_step = 8

[ingest.maps]
window_length_mm = [3.2, 3.2]

[ingest.conditioning]
window_length_mm = 3.2

[approximate]
waves = [3]
shortest_wavelength_mm = 0.4

[realise]
methods = ["measured"]
periodic = "blend"

[bem]
rubber = "rubber.toml"
speeds_mm_s = [10.0]
area_fractions = [0.05]
pressures_mpa = [0.2]
points_per_shortest_wavelength = 16
"#;

pub(super) fn campaign(columns: usize, heights: Vec<f64>) -> Campaign {
    let campaign = Campaign::new();
    write_map(&campaign, "map.sdf", columns, heights);
    campaign.write("recipe.toml", RECIPE);
    campaign
}

/// Writes a map of points every 50 µm.
pub(super) fn write_map(campaign: &Campaign, name: &str, columns: usize, heights: Vec<f64>) {
    let scan = ScanFile {
        format: "test".into(),
        detected: String::new(),
        grid: Grid::Map {
            columns,
            rows: heights.len() / columns,
            spacing_x: 5e-5,
            spacing_y: 5e-5,
        },
        heights,
        instrument: Vec::new(),
    };
    std::fs::write(campaign.path(name), write_sdf(&scan)).unwrap();
}

/// 6.4 mm of a rough road: four windows.
pub(super) fn road() -> Campaign {
    let map = SyntheticMap { length: 6.4e-3, rms_height: 5e-5, ..SyntheticMap::bundled() };
    campaign(128, map.generate("map").unwrap().heights)
}

pub(super) fn warnings(campaign: &Campaign, stage: &str) -> Vec<String> {
    let text = campaign.read(&format!("out/{stage}/manifest.json"));
    serde_json::from_str::<Manifest>(&text).unwrap().warnings
}

/// A map whose rows are all the same is the line, whatever solver it goes through.
#[test]
fn ridges_have_the_friction_of_their_profile() {
    let height = |i: usize| {
        let x = i as f64 * 5e-5;
        let wave = |length: f64, slope: f64, turn: f64| {
            slope * length / TAU * (TAU * (x / length + turn)).sin()
        };
        wave(3.05e-3, 0.1, 0.1) + wave(1.1e-3, 0.2, 0.7) + wave(0.5e-3, 0.2, 0.4)
    };
    let campaign = campaign(128, (0..128 * 128).map(|k| height(k % 128)).collect());
    // Lines are solved on finer grids for small contacts otherwise.
    campaign.edit("recipe.toml", "[bem]", "[bem]\nfewest_contact_points = 1");
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let (lines, maps) = (view.rows(CURVES).unwrap(), view.rows(AREAL_CURVES).unwrap());
    // Two windows of every eighth of 128 rows; two by two of the map.
    assert_eq!((lines.len(), maps.len()), (2 * 16 * 2, 2 * 4));
    for given in [Given::Area, Given::Pressure] {
        for (name, other) in [("map_row_0000/000", 0), ("map_row_0000/001", 1)] {
            let line = lines.iter().filter(|row| row.given == given).nth(other).unwrap();
            let of_map = maps.iter().filter(|row| row.given == given).nth(other).unwrap();
            let apart = |a: f64, b: f64| (a / b - 1.0).abs();
            let friction = apart(of_map.friction_coefficient, line.friction_coefficient);
            let area = apart(of_map.contact_area_fraction, line.contact_area_fraction);
            // The same grid of 128 points along x: the line solver to its tolerance where the pressure is given, and to
            // the tolerance of interpolation between pressures (5e-3 and 1e-2 of the recipe) where it is the area.
            let most = if given == Given::Pressure { 1e-8 } else { 1e-2 };
            assert!(friction < most, "{name}: {of_map:?} {line:?}");
            // Edges are read between the points in another way.
            assert!(area < 2e-2, "{name}: {of_map:?} {line:?}");
        }
    }
}

fn tables_are_averages_of_the_first_direction(view: &RunView) {
    let curves = view.rows(AREAL_CURVES).unwrap();
    let rows = view.rows(FRICTION).unwrap();
    let areal: Vec<_> = rows.iter().filter(|row| row.kind.method.is_areal()).collect();
    assert_eq!(areal.len(), 3 * 2);
    for row in &areal {
        let forward = curves.iter().filter(|curve| {
            curve.kind == row.kind && curve.angle_deg == 0.0 && curve.given == row.given
        });
        let friction: Vec<f64> = forward.map(|curve| curve.friction_coefficient).collect();
        assert_eq!(row.realisations, friction);
        assert!(
            (row.windows, row.shortest_wavelength_mm) == (4, 0.4) && row.error_estimate > Some(0.0)
        );
    }
    let compared = view.rows(METHODS).unwrap();
    let ratio = compared.iter().find(|row| row.kind == SurfaceKind::of(Method::ArealMeasured));
    // Lines need less pressure for an area, and have less friction at it.
    let ratio = ratio.unwrap().ratio_to_measured;
    assert!((0.5..3.0).contains(&ratio) && ratio != 1.0, "{ratio}");
    let budget = view.rows(BUDGET).unwrap();
    let of_maps = budget.iter().filter(|row| row.kind.method == Method::ArealMeasured);
    assert!(of_maps.clone().any(|row| row.part == Part::Scans));
    assert!(of_maps.clone().any(|row| row.part == Part::Grid && row.remedy.contains("areal.")));
}

fn fields_carry_the_load(view: &RunView) {
    let fields = view.read_arrays(AREAL_FIELDS).unwrap();
    assert_eq!(fields.len(), 3 * 4 * 2 * 2);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    for field in fields.iter().filter(|field| field.name.ends_with("pressure")) {
        let asperity::artifact::Attribute::Float(pressure) = field.attributes["mean_pressure_pa"]
        else {
            panic!("{field:?}")
        };
        assert!((mean(&field.values) / pressure - 1.0).abs() < 1e-9);
    }
}

#[test]
fn maps_go_through_the_chain_beside_their_rows() {
    let campaign = road();
    campaign.edit(
        "recipe.toml",
        "methods = [\"measured\"]",
        "methods = [\"measured\", \"matched\", \"random-phase\"]\nrealisations = 5\nseed = 3\nareal_realisations = 4",
    );
    campaign.edit(
        "recipe.toml",
        "[bem]",
        "[areal]\nangles_deg = [0.0, 90.0]\nfield_area_fractions = [0.05]\n\n[bem]",
    );
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let windows = view.rows(MAP_WINDOWS).unwrap();
    assert_eq!(windows.len(), 4);
    assert!(windows.iter().all(|row| row.points_missing > 100 && row.rejected.is_none()));
    assert!(
        view.rows(FAULTS).unwrap().iter().any(|row| row.scan == "map" && row.fault == "spikes")
    );
    let kept = read_maps(&view).unwrap();
    assert_eq!((kept.len(), kept[0].points, kept[0].spacing), (4, [64, 64], [5e-5; 2]));
    let parameters = view.rows(AREAL_PARAMETERS).unwrap();
    assert!(
        parameters.len() == 4 && parameters.iter().all(|row| row.ssk < 0.0 && row.sq_mm > 0.02)
    );
    assert!(view.rows(AREAL_AVERAGES).unwrap().iter().any(|row| row.parameter == "Vvv [mm]"));
    assert_eq!(view.rows(AREAL_DIRECTIONS).unwrap().len(), 4 * 18);
    let surfaces = view.rows(AREAL_SURFACES).unwrap();
    let of = |method| surfaces.iter().filter(move |row| row.kind.method == method);
    let methods = [Method::ArealMeasured, Method::ArealMatched, Method::ArealRandomPhase];
    for method in methods {
        assert_eq!(of(method).count(), 4);
        for (row, measured) in of(method).zip(of(Method::ArealMeasured)) {
            assert!((row.rms_height_mm / measured.rms_height_mm - 1.0).abs() < 1e-9);
            assert!((row.rms_gradient / measured.rms_gradient - 1.0).abs() < 1e-9);
            assert!(row.filled > 0.0 && row.window == measured.window, "{row:?}");
        }
    }
    let curves = view.rows(AREAL_CURVES).unwrap();
    // Three methods of four surfaces in two directions at an area and a pressure.
    assert_eq!(curves.len(), 3 * 4 * 2 * 2);
    let solves = view.rows(AREAL_SOLVES).unwrap();
    assert!(solves.iter().all(|row| row.residual <= 1e-10 && row.points_x == 128));
    tables_are_averages_of_the_first_direction(&view);
    fields_carry_the_load(&view);
    // Nothing is computed twice.
    assert!(try_run(&recipe(&campaign), &out, Selection::default()).unwrap().is_empty());
    // What was solved is taken from the store: another area asks for its own solves alone.
    campaign.edit("recipe.toml", "field_area_fractions = [0.05]\n", "");
    let text =
        campaign.read("recipe.toml").replace("speeds_mm_s = [10.0]", "speeds_mm_s = [10.0, 20.0]");
    campaign.write("recipe.toml", &text);
    let again = try_run(&recipe(&campaign), &out, Selection::default()).unwrap();
    assert!(again.iter().any(|stage| stage.name() == "areal"));
    let curves = view.rows(AREAL_CURVES).unwrap();
    assert_eq!(curves.len(), 2 * 3 * 4 * 2 * 2);
}

#[test]
fn maps_alone_and_isotropic_surfaces_of_lines_are_surfaces_too() {
    let campaign = road();
    campaign.edit("recipe.toml", "periodic = \"blend\"", "periodic = \"blend\"\nprofiles = false");
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let rows = RunView::of(&out).rows(FRICTION).unwrap();
    assert!(rows.len() == 2 && rows.iter().all(|row| row.kind.method == Method::ArealMeasured));
    // Lines alone, whose spectrum is that of an isotropic surface.
    campaign.edit("recipe.toml", "[ingest.maps]\nwindow_length_mm = [3.2, 3.2]\n", "");
    campaign.edit("recipe.toml", "map_line_step = 8", "map_line_step = 8\nmap_lines = \"rows\"");
    campaign.edit(
        "recipe.toml",
        "methods = [\"measured\"]\nperiodic = \"blend\"\nprofiles = false",
        "methods = [\"isotropic\"]\nrealisations = 3\nseed = 1",
    );
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let surfaces = read_areal_surfaces(&view).unwrap();
    assert_eq!(surfaces.len(), 3);
    for surface in &surfaces {
        assert_eq!(surface.kind, SurfaceKind::of(Method::Isotropic));
        assert!((surface.map.periods[0] / 3.2e-3 - 1.0).abs() < 1e-9, "{:?}", surface.map.periods);
        // Gaussian, by its phases.
        assert!(surface.map.roughness().skewness.abs() < 0.6);
    }
    let rows = view.rows(FRICTION).unwrap();
    assert!(rows.len() == 2 && rows.iter().all(|row| row.kind.method == Method::Isotropic));
    // What the choice of scans does to them is not known.
    assert!(rows.iter().all(|row| row.scan_error.is_none() && row.error_estimate.is_none()));
    let budget = view.rows(BUDGET).unwrap();
    let scans = budget.iter().filter(|row| row.part == Part::Scans);
    let reason = "isotropic surfaces have the averaged spectrum of all scans";
    assert!(scans.clone().count() == 2 && scans.clone().all(|row| row.remedy.starts_with(reason)));
}

#[test]
fn heights_of_depth_maps_are_turned() {
    let heights = |key: &str| {
        let campaign = road();
        campaign.edit("recipe.toml", "map_line_step = 8", &format!("map_line_step = 8\n{key}"));
        let selection =
            Selection { only: Some(asperity::stages::ingest::STAGE), ..Selection::default() };
        try_run(&recipe(&campaign), &campaign.path("out"), selection).unwrap();
        read_maps(&RunView::of(campaign.path("out"))).unwrap().remove(0).heights
    };
    let (up, down) = (heights(""), heights("invert_instrument_heights = true"));
    for (a, b) in up.iter().zip(&down).filter(|(a, _)| !a.is_nan()) {
        assert!((a + b).abs() < 1e-12, "{a} {b}");
    }
}

#[test]
fn what_does_not_go_together_is_told() {
    let error = |from: &str, to: &str| {
        let campaign = road();
        campaign.edit("recipe.toml", from, to);
        match Recipe::read(&campaign.path("recipe.toml")) {
            Err(error) => error.to_string(),
            Ok(recipe) => try_run(&recipe, &campaign.path("out"), Selection::default())
                .unwrap_err()
                .to_string(),
        }
    };
    let maps = "[ingest.maps]\nwindow_length_mm = [3.2, 3.2]\n";
    let message = error(maps, "[areal]\nangles_deg = [1.0]\n");
    assert!(message.contains("areal") && message.contains("[ingest.maps]"), "{message}");
    let message = error("window_length_mm = [3.2, 3.2]", "window_length_mm = [30.0, 3.2]");
    assert!(message.contains("window_length_mm") && message.contains("along x"), "{message}");
    assert!(message.contains("no height map is left (ingest.maps): map map is"), "{message}");
    let message = error("window_length_mm = [3.2, 3.2]", "spike_threshold = -1.0");
    assert!(message.contains("ingest.maps.spike_threshold = -1.0"), "{message}");
    let message = error("[bem]", "[areal]\nmemory_gb = 1e-3\n\n[bem]");
    assert!(
        message.contains("128 by 128 points") && message.contains("areal.memory_gb"),
        "{message}"
    );
    let message = error("[bem]", "[areal]\nangles_deg = [0.0, 360.0]\n\n[bem]");
    assert!(message.contains("areal.angles_deg = [0.0, 360.0]"), "{message}");
    let isotropic = |mm: f64| {
        format!(
            "methods = [\"isotropic\"]\nareal_realisations = 1\nseed = 1\nisotropic_period_mm = {mm:?}"
        )
    };
    for mm in [0.4, 1e6] {
        let message = error("methods = [\"measured\"]", &isotropic(mm));
        assert!(message.contains("realise.isotropic_period_mm"), "{message}");
    }
    let small = "periodic = \"blend\"\nprofiles = false\n\n[bem]\narea_fractions = [1e-6]";
    let campaign = road();
    campaign.edit("recipe.toml", "area_fractions = [0.05]\npressures_mpa = [0.2]\n", "");
    campaign.edit("recipe.toml", "periodic = \"blend\"\n\n[bem]", small);
    let stop = try_run(&recipe(&campaign), &campaign.path("out"), Selection::default());
    let message = stop.unwrap_err().to_string();
    assert!(message.contains("at 0 degrees") && message.contains("areal.points_per"), "{message}");
    let message = error("periodic = \"blend\"", "profiles = false\nareal_realisations = 0");
    assert!(message.contains("areal_realisations"), "{message}");
    let message = error(
        "methods = [\"measured\"]",
        "methods = [\"areal-measured\"]\nseed = 1\nrealisations = 1",
    );
    assert!(message.contains("[ingest.maps]"), "{message}");
    // A line that is no map.
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "[ingest.conditioning]", "[ingest.maps]\n\n[ingest.conditioning]");
    let stop = try_run(&recipe(&campaign), &campaign.path("out"), Selection::default());
    let message = stop.unwrap_err().to_string();
    assert!(message.contains("none of the scans is a height map"), "{message}");
}

#[test]
fn doubtful_maps_are_told_of() {
    let map = SyntheticMap { length: 6.4e-3, rms_height: 5e-5, ..SyntheticMap::bundled() };
    let mut heights = map.generate("map").unwrap().heights;
    // A row that jumped, and a window that is flat.
    heights[100 * 128..101 * 128].iter_mut().for_each(|z| *z += 1e-3);
    for row in heights.chunks_exact_mut(128).take(64) {
        row[..64].fill(0.0);
    }
    let campaign = campaign(128, heights);
    campaign.edit(
        "recipe.toml",
        "window_length_mm = [3.2, 3.2]",
        "window_length_mm = [3.2, 3.2]\nform = \"mean\"",
    );
    campaign.edit(
        "recipe.toml",
        "[ingest.conditioning]\n",
        "[ingest.conditioning]\nmax_missing = 0.5\n",
    );
    campaign.edit("recipe.toml", "map_line_step = 8", "map_line_step = 60");
    run(&recipe(&campaign), &campaign.path("out"));
    let told = warnings(&campaign, "ingest").join("\n");
    assert!(told.contains("1 rows and") && told.contains("is tilted by"), "{told}");
    let told = warnings(&campaign, "realise").join("\n");
    assert!(told.contains("1 of 4 maps are flat") && told.contains("map/000"), "{told}");
    assert!(told.contains("less than 4 shortest waves of 0.40 mm"), "{told}");
    let surfaces = RunView::of(campaign.path("out")).rows(AREAL_SURFACES).unwrap();
    assert_eq!(surfaces.len(), 3);
}

#[test]
fn one_map_has_no_interval_and_says_so() {
    let campaign = road();
    campaign.edit("recipe.toml", "window_length_mm = [3.2, 3.2]", "form = { polynomial = 2 }");
    campaign.edit("recipe.toml", "periodic = \"blend\"", "profiles = false\nlongest_gap_mm = 0.5");
    run(&recipe(&campaign), &campaign.path("out"));
    let told = warnings(&campaign, "realise");
    assert!(told.iter().any(|text| text.contains("ingest.maps.window_length_mm")), "{told:?}");
    let rows = RunView::of(campaign.path("out")).rows(FRICTION).unwrap();
    assert!(rows.iter().all(|row| row.confidence_95.is_none() && row.error_estimate.is_none()));
}
