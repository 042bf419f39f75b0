//! `adhesion fit`: from measured friction to the section of a recipe, and what goes wrong on the way.

use super::Outcome;
use super::common::Campaign;
use asperity::artifact::RunView;
use asperity::stages::tables::{FRICTION, TOTAL};
use std::fmt::Write;

fn outcome(campaign: &Campaign, arguments: &str) -> Outcome {
    Outcome::of(&mut campaign.command(arguments))
}

const RUN: &str = "run recipe.toml --out out --quiet";

/// The small campaign over seven decades of speed at a pressure, solved.
fn solved() -> Campaign {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "[10.0]", "{ from = 0.01, to = 1000, per_decade = 2 }");
    campaign.edit(
        "recipe.toml",
        "area_fractions = [0.02, 0.05, 0.1]",
        "area_fractions = []\npressures_mpa = [0.3]",
    );
    outcome(&campaign, RUN).result();
    campaign
}

/// Friction as a law of 5 MPa, 2 mm/s and width 0.15 makes it of the hysteresis and the areas of the run.
fn measured(campaign: &Campaign) -> String {
    let rows = RunView::of(campaign.path("out")).rows(FRICTION).unwrap();
    let mut text = String::from("speed_mm_s,friction\n");
    for row in rows.iter().step_by(2) {
        let decades = (row.speed_mm_s / 2.0).log10();
        let stress = 5.0 * (-0.15 * decades * decades).exp();
        let friction = row.mean + stress * row.contact_area_fraction / row.pressure_mpa;
        writeln!(text, "{},{friction}", row.speed_mm_s).unwrap();
    }
    text
}

#[test]
fn the_law_behind_measured_friction_is_found_and_gives_it_back() {
    let campaign = solved();
    campaign.write("measured.csv", &measured(&campaign));
    let text = outcome(&campaign, "adhesion fit measured.csv --run out --to law.toml").result();
    for part in
        ["bem, 3 waves, 0.300000 MPa", "shear_mpa", "5.00000", "95 %:", "rms misfit", "hysteretic"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    let fit: serde_json::Value = serde_json::from_str(
        &outcome(&campaign, "adhesion fit measured.csv --run out --json").result(),
    )
    .unwrap();
    assert!(fit["reference_c"].is_null());
    // As a German spreadsheet writes it.
    let german = campaign.read("measured.csv").replace(',', ";").replace('.', ",");
    campaign.write("german.csv", &german);
    let again = outcome(&campaign, "adhesion fit german.csv --run out --json").result();
    let again: serde_json::Value = serde_json::from_str(&again).unwrap();
    assert_eq!(again["constants"], fit["constants"]);
    let fixed = outcome(
        &campaign,
        "adhesion fit measured.csv --run out --speed 2 --width 0.15 --activation-ev 0.9 --reference-c 30",
    );
    let fixed = fixed.result();
    assert!(fixed.contains("30  °C, at which speed_mm_s holds"), "{fixed}");
    for (constant, expected) in fit["constants"].as_array().unwrap().iter().zip([5.0, 2.0, 0.15]) {
        approx::assert_relative_eq!(
            constant["value"].as_f64().unwrap(),
            expected,
            max_relative = 1e-6
        );
    }
    // The section goes into the recipe as it is.
    let recipe = campaign.read("recipe.toml") + "\n" + &campaign.read("law.toml");
    campaign.write("recipe.toml", &recipe);
    let warnings = outcome(&campaign, "run recipe.toml --out out");
    assert!(!warnings.stderr.contains("belongs to a shortest wavelength"), "{}", warnings.stderr);
    assert_eq!(warnings.code, 0);
    let totals = RunView::of(campaign.path("out")).rows(TOTAL).unwrap();
    for (total, line) in totals.iter().step_by(2).zip(campaign.read("measured.csv").lines().skip(1))
    {
        let friction: f64 = line.split(',').nth(1).unwrap().parse().unwrap();
        // The mean of ratios is not the ratio of means, which the fit has at a given pressure: here they are the same.
        approx::assert_relative_eq!(total.total, friction, max_relative = 1e-6);
    }
}

#[test]
fn mistakes_say_what_to_do() {
    let campaign = solved();
    let refused = |file: &str, options: &str| {
        campaign.write("measured.csv", file);
        outcome(&campaign, &format!("adhesion fit measured.csv --run out {options}")).error(2)
    };
    let beyond = refused("speed_mm_s,friction\n1,1.2\n1e5,1.2\n2,1\n3,1\n", "");
    assert!(beyond.contains("line 3") && beyond.contains("0.01 to 1000 mm/s"), "{beyond}");
    let few = refused("speed_mm_s,friction\n1,1.2\n2,1\n3,1\n", "");
    assert!(few.contains("at least 4"), "{few}");
    let pressure = refused("speed_mm_s,friction,pressure_mpa\n1,1.2,0.5\n", "");
    assert!(pressure.contains("line 2") && pressure.contains("0.5 MPa"), "{pressure}");
    let warm = refused("speed_mm_s,friction,temperature_c\n1,1.2,40\n", "");
    assert!(warm.contains("bem.temperature_c"), "{warm}");
    let less = refused("speed_mm_s,friction\n1,0\n2,0\n3,0\n10,0\n20,0\n", "");
    assert!(less.contains("nowhere above the hysteretic"), "{less}");
    let method = refused("speed_mm_s,friction\n1,1\n", "--method matched");
    assert!(method.contains("matched") && method.contains("3 waves"), "{method}");
}
