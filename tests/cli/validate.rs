//! `validate`: measured friction beside a recipe, and what goes wrong on the way.

use super::Outcome;
use super::common::Campaign;
use super::project;
use asperity::artifact::RunView;
use asperity::recipe::Recipe;
use asperity::stages::realise::Method;
use asperity::stages::tables::{FRICTION, FrictionRow};
use serde_json::Value;
use std::fmt::Write;

fn outcome(campaign: &Campaign, arguments: &str) -> Outcome {
    Outcome::of(&mut campaign.command(arguments))
}

fn judged(campaign: &Campaign, arguments: &str) -> Value {
    let text = outcome(campaign, &format!("validate {arguments} --json --quiet")).result();
    serde_json::from_str(&text).unwrap()
}

/// The small campaign over five decades of speed at a pressure, with a measurement to come.
fn campaign() -> Campaign {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "[10.0]", "{ from = 0.01, to = 1000, per_decade = 2 }");
    campaign.edit(
        "recipe.toml",
        "area_fractions = [0.02, 0.05, 0.1]",
        "area_fractions = []\npressures_mpa = [0.3]",
    );
    outcome(&campaign, "run recipe.toml --out out/recipe --quiet").result();
    let recipe = campaign.read("recipe.toml") + "\n[validation]\nmeasured = \"measured.csv\"\n";
    campaign.write("recipe.toml", &recipe);
    campaign
}

/// Stress in MPa of a law of 5 MPa, 2 mm/s and width 0.15.
fn stress(speed_mm_s: f64) -> f64 {
    5.0 * (-0.15 * (speed_mm_s / 2.0).log10().powi(2)).exp()
}

fn rows(campaign: &Campaign) -> Vec<FrictionRow> {
    RunView::of(campaign.path("out/recipe")).rows(FRICTION).unwrap()
}

/// Friction as the law makes it of hysteresis and area of the run.
fn measured(rows: &[FrictionRow]) -> String {
    let mut text = String::from("speed_mm_s,friction\n");
    for row in rows {
        let adhesive = stress(row.speed_mm_s) * row.contact_area_fraction / row.pressure_mpa;
        writeln!(text, "{},{}", row.speed_mm_s, row.mean + adhesive).unwrap();
    }
    text
}

fn result<'a>(judged: &'a Value, case: &str) -> &'a Value {
    let results = judged["results"].as_array().unwrap();
    results.iter().find(|result| result["case"] == case).unwrap()
}

#[test]
fn the_law_behind_a_measurement_is_found_and_hysteresis_misses_it_by_its_part() {
    let campaign = campaign();
    let rows = rows(&campaign);
    campaign.write("measured.csv", &measured(&rows));
    let judged = judged(&campaign, "recipe.toml --out out --figure friction.svg");
    let own = result(&judged, "own");
    assert!(own["rms"].as_f64().unwrap() < 1e-8, "{own}");
    assert_eq!(judged["rms"], own["rms"]);
    assert_eq!(judged["points"].as_array().unwrap().len(), rows.len());
    assert_eq!(judged["inside_band"], rows.len());
    for (constant, expected) in
        own["laws"][0]["constants"].as_array().unwrap().iter().zip([5.0, 2.0, 0.15])
    {
        let value = constant["value"].as_f64().unwrap();
        approx::assert_relative_eq!(value, expected, max_relative = 1e-6);
    }
    let squares = rows
        .iter()
        .map(|row| (stress(row.speed_mm_s) * row.contact_area_fraction / row.pressure_mpa).powi(2));
    let expected = (squares.sum::<f64>() / rows.len() as f64).sqrt();
    let alone = result(&judged, "hysteresis");
    approx::assert_relative_eq!(alone["rms"].as_f64().unwrap(), expected, max_relative = 1e-9);
    assert_eq!(alone["laws"].as_array().unwrap().len(), 0);
    let svg = campaign.read("friction.svg");
    assert!(svg.contains("measured") && svg.contains("hysteresis"));
    // The stages do not read the measurement: nothing was computed again.
    let again = outcome(&campaign, "validate recipe.toml --out out");
    assert!(
        again.stderr.contains("up to date") && !again.stderr.contains(" s\n"),
        "{}",
        again.stderr
    );
    assert!(again.stdout.contains("own         a law fitted to each set"), "{}", again.stdout);
}

#[test]
fn one_law_of_two_sets_predicts_each_from_the_other() {
    let campaign = campaign();
    let text = measured(&rows(&campaign));
    let lines: Vec<&str> = text.lines().collect();
    campaign.write("measured.csv", &lines[..6].join("\n"));
    let wide = format!("{}\n{}", lines[0], lines[5..].join("\n"));
    campaign.write("measured_2.csv", &wide);
    let second = campaign.read("recipe.toml").replace("measured.csv", "measured_2.csv");
    campaign.write("second.toml", &second);
    let same = outcome(&campaign, "validate recipe.toml second.toml --out out --quiet").error(2);
    assert!(same.contains("two sets have the title"), "{same}");
    let second = second.replace("title = \"", "title = \"second, ");
    campaign.write("second.toml", &second);
    let judged = judged(&campaign, "recipe.toml second.toml --out out");
    for case in ["own", "joint", "other"] {
        let rms = result(&judged, case)["rms"].as_f64().unwrap();
        assert!(rms < 1e-7, "{case}: {rms}");
    }
    assert_eq!(judged["headline"]["case"], "joint");
    let laws = result(&judged, "other")["laws"].as_array().unwrap();
    assert_eq!(laws.len(), 2);
    // Another law behind the second set: own laws meet both, one for both does not.
    let mut moved = String::from("speed_mm_s,friction\n");
    for line in wide.lines().skip(1) {
        let (speed, friction) = line.split_once(',').unwrap();
        writeln!(moved, "{speed},{}", friction.parse::<f64>().unwrap() + 0.2).unwrap();
    }
    campaign.write("measured_2.csv", &moved);
    let judged = self::judged(&campaign, "recipe.toml second.toml --out out");
    let rms = |case: &str| result(&judged, case)["rms"].as_f64().unwrap();
    assert!(rms("own") < rms("joint") && rms("joint") < rms("other"), "{judged}");
}

#[test]
fn a_law_that_is_given_and_a_spectrum_alone_fit_nothing() {
    let campaign = campaign();
    campaign.write("measured.csv", &measured(&rows(&campaign)));
    let law = "\n[adhesion]\nlaw = \"gaussian\"\nshear_mpa = 5.0\nspeed_mm_s = 2.0\nwidth = 0.15\nshortest_wavelength_mm = 0.5\n";
    campaign.write("recipe.toml", &(campaign.read("recipe.toml") + law));
    let judged = judged(&campaign, "recipe.toml --out out");
    assert_eq!(judged["headline"]["case"], "given");
    assert!(judged["rms"].as_f64().unwrap() < 1e-9, "{judged}");

    campaign.write("spectrum.txt", "1e3 1e-12\n1e4 3e-16\n1e5 1e-19\n");
    let alone = "title = \"a spectrum\"\n[bem]\nrubber = \"rubber.toml\"\nspeeds_mm_s = [1.0]\narea_fractions = []\n\
        pressures_mpa = [0.3]\n[validation]\nmeasured = \"measured.csv\"\nwidth = 0.15\nspeed_mm_s = 2.0\n\
        [validation.spectrum]\nfile = \"spectrum.txt\"\nwavenumber_unit = \"rad/m\"\ndensity_unit = \"m4\"\n";
    campaign.write("spectrum.toml", alone);
    let judged = self::judged(&campaign, "spectrum.toml --out out");
    assert_eq!(judged["headline"]["model"], "persson");
    let theory = outcome(
        &campaign,
        "theory persson --spectrum spectrum.txt --wavenumber-unit rad/m --density-unit m4 --pressure 0.3 --speed 0.01 --rubber rubber.toml --json --quiet",
    );
    let theory: Value = serde_json::from_str(&theory.result()).unwrap();
    assert_eq!(judged["points"][0]["hysteretic"], theory["rows"][0]["friction_coefficient"]);
    let parts = &judged["points"][0]["band_parts"];
    assert!(parts["hysteresis"].as_f64().unwrap() > 0.0 && parts["fit"].is_number(), "{parts}");
    // The theory takes any pressure and, of moduli that are held, any frequency: both are told.
    let pascal = alone.replace("width = 0.15", "width = 0.15\npressure_mpa = 300000");
    campaign.write("spectrum.toml", &pascal);
    let refused = outcome(&campaign, "validate spectrum.toml --out out").error(2);
    assert!(refused.contains("validation.pressure_mpa = 300000") && refused.contains("in Pa"));
    campaign.write("spectrum.toml", alone);
    let held = "name = \"held\"\npoisson_ratio = 0.49\nmodulus_kind = \"youngs\"\nextrapolate = \"hold\"\n\
        [[moduli]]\nfrequency_hz = 1.0\nstorage_mpa = 5.0\nloss_mpa = 0.5\n\
        [[moduli]]\nfrequency_hz = 10.0\nstorage_mpa = 6.0\nloss_mpa = 0.7\n\
        [[moduli]]\nfrequency_hz = 100.0\nstorage_mpa = 7.0\nloss_mpa = 0.9\n";
    campaign.write("rubber.toml", held);
    let warned = outcome(&campaign, "validate spectrum.toml --out out").stderr;
    assert!(warned.contains("measured.csv, line 2") && warned.contains("held at"), "{warned}");
    let refused = outcome(&campaign, "run spectrum.toml --out out/none").error(2);
    assert!(refused.contains("asperity validate"), "{refused}");
}

#[test]
fn mistakes_say_what_to_do() {
    let campaign = campaign();
    let validate = "validate recipe.toml --out out --quiet";
    let refused = |file: &str| {
        campaign.write("measured.csv", file);
        outcome(&campaign, validate).error(2)
    };
    let beyond = refused("speed_mm_s,friction\n1,1.2\n1e5,1.2\n");
    assert!(
        beyond.contains("measured.csv, line 3") && beyond.contains("0.01 to 1000 mm/s"),
        "{beyond}"
    );
    let pressure = refused("speed_mm_s,friction,pressure_mpa\n1,1.2,0.5\n");
    assert!(pressure.contains("line 2") && pressure.contains("0.5 MPa"), "{pressure}");
    let warm = refused("speed_mm_s,friction,temperature_c\n1,1.2,40\n");
    assert!(warm.contains("bem.temperature_c"), "{warm}");
    let word = refused("speed_mm_s,friction\n1,much\n");
    assert!(word.contains("line 2") && word.contains("`much`"), "{word}");
    let twice = outcome(&campaign, "validate recipe.toml ./recipe.toml --out out").error(2);
    assert!(twice.contains("would both be run in"), "{twice}");
    let spelled = outcome(&campaign, "validate recipe.toml out/../recipe.toml").error(2);
    assert!(spelled.contains("would both be run in"), "{spelled}");
    campaign.write("measured.svg", "speed_mm_s,friction\n1,1.2\n");
    let drawn = campaign.read("recipe.toml").replace("measured.csv", "measured.svg");
    campaign.write("drawn.toml", &drawn);
    let over =
        outcome(&campaign, "validate drawn.toml --out out --figure measured.svg --force").error(2);
    assert!(
        over.contains("--figure") && campaign.read("measured.svg").starts_with("speed"),
        "{over}"
    );
    // Too few to fit: said, and hysteresis is still judged.
    campaign.write("measured.csv", "speed_mm_s,friction\n1,1.2\n10,1.1\n");
    let few = outcome(&campaign, "validate recipe.toml --out out");
    assert!(few.code == 0 && few.stdout.contains("at least 4"), "{}", few.stdout);
    let unknown = campaign.read("recipe.toml").replace("measured = ", "width = -1\nmeasured = ");
    campaign.write("recipe.toml", &unknown);
    let width = outcome(&campaign, validate).error(2);
    assert!(width.contains("validation.width = -1") && width.contains("line"), "{width}");
    let without = unknown.split("[validation]").next().unwrap().to_owned();
    campaign.write("recipe.toml", &without);
    let none = outcome(&campaign, validate).error(2);
    assert!(none.contains("no section [validation]"), "{none}");
}

/// The public set: one law for both compounds over the measured road is at least as near as the isotropic theory, whose misfit
/// others have published (0.12 with one pair of constants).
#[test]
fn the_public_set_is_met_at_least_as_well_as_by_the_isotropic_theory() {
    if !project("../shared/validation/S120_measured_friction.txt").exists() {
        println!("skipped: ../shared/validation is not there");
        return;
    }
    let campaign = Campaign::new();
    for name in ["s100", "s120"] {
        let path = project(&format!("pipelines/validation_{name}.toml"));
        let mut recipe = Recipe::read(&path).unwrap();
        // Softening takes minutes; it is held by `tests/stages/feedback.rs`.
        recipe.feedback = None;
        recipe.realise.as_mut().unwrap().methods = vec![Method::Measured];
        let realise = recipe.realise.as_mut().unwrap();
        (realise.realisations, realise.seed) = (None, None);
        campaign.write(&format!("{name}.toml"), &recipe.absolute().unwrap().to_toml().unwrap());
    }
    let judged = judged(&campaign, "s100.toml s120.toml --out out");
    let results = judged["results"].as_array().unwrap();
    let rms = |model: &str, surfaces: &str| {
        let own = results.iter().find(|r| {
            r["model"] == model
                && r["surfaces"] == surfaces
                && r["effect"] == "none"
                && r["case"] == "joint"
        });
        own.unwrap()["rms"].as_f64().unwrap()
    };
    let theory = rms("persson", "isotropic, measured spectrum");
    assert!((0.10..0.14).contains(&theory), "{theory}");
    assert!(rms("bem", "measured profiles") < theory, "{results:?}");
}
