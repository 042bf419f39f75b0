//! Tasks that follow from results: microscales, finite elements, realisations for a tolerance.

use super::{alone, campaign, plan, quietly, solved, tables};
use serde_json::Value;
use std::fs;

/// Stages of the tasks of a plan of one shard.
fn stages(plan: &str) -> Vec<String> {
    let path = plan.replace("plan.json", "shard_00000.json");
    let list: Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
    let tasks = list["tasks"].as_array().unwrap();
    let mut stages: Vec<String> =
        tasks.iter().map(|task| task["stage"].as_str().unwrap().to_owned()).collect();
    stages.sort();
    stages.dedup();
    stages
}

/// Two waves of which the short one is the steeper, and two seeds.
const STEEP: &str = r#"title = "Steep"

[[approximate.given]]
source = "a test"
scales = [
    { wavelength_mm = 0.5, amplitude_mm = 0.02 },
    { wavelength_mm = 2.0, amplitude_mm = 0.03 },
]

[realise]
waves = [2]
realisations = 2

[bem]
rubber = "rubber.toml"
speeds_mm_s = [10.0]
area_fractions = [0.05, 0.1]
tolerance = 5e-3

[sweep]
seeds = [1, 2]

[micro]
rms_slope_threshold = 0.1
columns_per_shortest_wavelength = 24
tolerance = 0.05

[fem]
columns_per_shortest_wavelength = 16
pressure_ratio = 1.6
"#;

/// A small map, and the profiles of its rows.
const MAPS: &str = r#"title = "Maps"

[ingest]
scans = ["road.sdf"]
map_line_step = 16

[ingest.maps]
window_length_mm = [3.2, 3.2]

[ingest.conditioning]
window_length_mm = 3.2

[approximate]
waves = [3]
shortest_wavelength_mm = 0.4

[realise]
methods = ["measured", "random-phase"]
realisations = 3
periodic = "blend"

[bem]
rubber = "rubber.toml"
speeds_mm_s = [10.0]
area_fractions = [0.05]
points_per_shortest_wavelength = 16

[areal]
points_per_shortest_wavelength = 8

[sweep]
seeds = [1, 2]
"#;

#[test]
fn areal_surfaces_are_spread_with_the_profiles() {
    let campaign = campaign();
    campaign.write("recipe.toml", MAPS);
    let synth = "synth map --out road.sdf --length-mm 6.4 --rms-height-mm 0.05";
    quietly(&campaign, synth).result();
    let expected = alone(&campaign);
    let plan = solved(&campaign, "out", 1);
    assert_eq!(stages(&plan), ["areal", "bem"]);
    quietly(&campaign, &format!("sweep collect {plan}")).result();
    assert_eq!(tables(&campaign, "out"), expected);
    let text = quietly(&campaign, "export out --format markdown").result();
    assert!(text.contains("10 mm/s at 0° from x, "), "{text}");
}

#[test]
fn microscales_and_finite_elements_come_after_the_half_space() {
    let campaign = campaign();
    campaign.write("recipe.toml", STEEP);
    let expected = alone(&campaign);
    let first = solved(&campaign, "out", 1);
    assert_eq!(stages(&first), ["bem"]);
    let second = solved(&campaign, "out", 1);
    assert_eq!(stages(&second), ["fem", "micro"]);
    let third = plan(&campaign, "out", 1);
    assert_eq!(stages(&third), Vec::<String>::new());
    quietly(&campaign, &format!("sweep collect {second}")).result();
    assert_eq!(tables(&campaign, "out"), expected);
    // Whoever collects after the first round has the rest solved where it collects.
    let first = solved(&campaign, "early", 1);
    quietly(&campaign, &format!("sweep collect {first}")).result();
    assert_eq!(tables(&campaign, "early"), expected);
}

#[test]
fn a_tolerance_asks_for_realisations_in_rounds() {
    let campaign = campaign();
    campaign.edit("recipe.toml", "temperatures_c = [10.0, 40.0]\n", "");
    campaign.edit("recipe.toml", "[10.0, 50.0]", "[10.0]");
    campaign.edit("recipe.toml", "[0.02, 0.05, 0.1]", "[0.05, 0.1]");
    campaign.edit("recipe.toml", "realisations = 2", "most_realisations = 60");
    campaign.edit("recipe.toml", "tolerance = 5e-3\npoints_per_shortest_wavelength = 16\n", "");
    campaign.edit("recipe.toml", "title = ", "tolerance = 0.1\ntitle = ");
    let expected = alone(&campaign);
    let mut rounds = 0;
    let last = loop {
        let plan = solved(&campaign, "out", 1);
        if stages(&plan).is_empty() {
            break plan;
        }
        rounds += 1;
        assert!(rounds < 10);
    };
    assert!(rounds >= 2, "{rounds}");
    quietly(&campaign, &format!("sweep collect {last}")).result();
    assert_eq!(tables(&campaign, "out"), expected, "{rounds} rounds");
}

#[test]
fn pairs_of_multilevel_come_after_the_half_space() {
    let campaign = campaign();
    let (chain, _) = STEEP.split_once("[micro]").unwrap();
    let multilevel = "[multilevel]\ncolumns_per_shortest_wavelength = 16\npressure_ratio = 1.6\n\
                      first_realisations = 3\n";
    let chain = chain.replace("realisations = 2", "realisations = 4");
    campaign.write("recipe.toml", &format!("{chain}{multilevel}"));
    let expected = alone(&campaign);
    let first = solved(&campaign, "out", 1);
    assert_eq!(stages(&first), ["bem"]);
    let second = solved(&campaign, "out", 1);
    assert_eq!(stages(&second), ["multilevel"]);
    assert_eq!(stages(&plan(&campaign, "out", 1)), Vec::<String>::new());
    quietly(&campaign, &format!("sweep collect {second}")).result();
    assert_eq!(tables(&campaign, "out"), expected);
}
