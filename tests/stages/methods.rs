//! The older multiscale methods beside the models of a run.

use super::{Campaign, digests, recipe, run, try_run};
use asperity::artifact::RunView;
use asperity::pipeline::Selection;
use asperity::recipe::Recipe;
use asperity::stages::bem::CURVES;
use asperity::stages::methods::{
    self, METHOD_CURVES, METHOD_FRICTION, MethodCurveRow, OlderMethod, ScaleMechanics,
};
use asperity::stages::tables::FRICTION;

/// Three waves and two realisations at one speed, on the half-space alone.
fn campaign(section: &str) -> Campaign {
    let campaign = Campaign::new();
    let text = campaign.read("recipe.toml");
    campaign.write("recipe.toml", &format!("{text}\n[methods]\n{section}"));
    campaign
}

const HALF_SPACE: &str = "mechanics = [\"half-space\"]\npoints_per_shortest_wavelength = 64\n";

#[test]
fn every_method_has_a_curve_and_an_average_beside_the_models() {
    let campaign = campaign(HALF_SPACE);
    let out = campaign.path("out");
    assert_eq!(run(&recipe(&campaign), &out).last(), Some(&methods::STAGE));
    let view = RunView::of(&out);
    let (curves, table) = (view.rows(METHOD_CURVES).unwrap(), view.rows(METHOD_FRICTION).unwrap());
    let half_space = view.rows(CURVES).unwrap();
    let of = |model: OlderMethod, split: Option<u32>| -> Vec<&MethodCurveRow> {
        curves.iter().filter(|row| (row.model, row.split_waves) == (model, split)).collect()
    };
    let warnings = view.stage_manifest("methods").unwrap().unwrap().warnings;
    let asked = half_space.len();
    for (model, split) in [
        (OlderMethod::Recursive, None),
        (OlderMethod::Split, Some(1)),
        (OlderMethod::Particles, None),
        (OlderMethod::Projection, Some(1)),
    ] {
        let own = of(model, split);
        assert_eq!(own.len(), asked, "{model} {split:?}: {warnings:?}");
        assert!(own.iter().all(|row| row.mechanics == ScaleMechanics::HalfSpace));
        assert!(own.iter().all(|row| row.friction_coefficient > 0.0 && row.load_beyond_law < 0.05));
        let average = table.iter().find(|row| {
            (row.model.as_str(), row.split_waves) == (model.name(), split)
                && row.contact_area_fraction == own[0].contact_area_fraction
                && row.speed_mm_s == own[0].speed_mm_s
        });
        let same = own.iter().filter(|row| {
            row.contact_area_fraction == own[0].contact_area_fraction
                && row.speed_mm_s == own[0].speed_mm_s
        });
        let values: Vec<f64> = same.map(|row| row.friction_coefficient).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        assert!((average.unwrap().mean / mean - 1.0).abs() < 1e-12);
    }
    // Single waves have no phase: all realisations are one.
    let recursive = of(OlderMethod::Recursive, None);
    let first = recursive.iter().find(|row| row.realisation == 1).unwrap();
    let second = recursive.iter().find(|row| row.realisation == 2).unwrap();
    assert_eq!(first.friction_coefficient, second.friction_coefficient);
    // The half-space of the tables is in the one table as it is there.
    let friction = view.rows(FRICTION).unwrap();
    let bem: Vec<f64> = table.iter().filter(|row| row.model == "bem").map(|row| row.mean).collect();
    assert_eq!(bem, friction.iter().map(|row| row.mean).collect::<Vec<_>>());
    assert!(table.iter().all(|row| row.from_all_waves.is_none()));
}

#[test]
fn a_kept_curve_is_not_solved_again_and_another_section_changes_it() {
    let campaign = campaign(HALF_SPACE);
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let first = digests(&out);
    assert_eq!(run(&recipe(&campaign), &out), []);
    campaign.edit("recipe.toml", "mechanics", "methods = [\"split\"]\nmechanics");
    assert_eq!(run(&recipe(&campaign), &out), [methods::STAGE]);
    let view = RunView::of(&out);
    let split = view.rows(METHOD_CURVES).unwrap();
    assert!(split.iter().all(|row| row.model == OlderMethod::Split));
    campaign.edit("recipe.toml", "methods = [\"split\"]\n", "");
    run(&recipe(&campaign), &out);
    assert_eq!(digests(&out), first, "the same section gives the same files");
}

#[test]
fn at_finite_deformation_gentle_waves_have_the_friction_of_the_half_space() {
    let campaign = campaign(
        "methods = [\"recursive\"]\ncolumns_per_shortest_wavelength = 48\npressure_ratio = 1.6\n",
    );
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let curves = RunView::of(&out).rows(METHOD_CURVES).unwrap();
    let of = |mechanics: ScaleMechanics| -> Vec<&MethodCurveRow> {
        curves.iter().filter(|row| row.mechanics == mechanics).collect()
    };
    let (half_space, finite) =
        (of(ScaleMechanics::HalfSpace), of(ScaleMechanics::FiniteDeformation));
    assert!(!finite.is_empty());
    for row in finite {
        let other = half_space.iter().find(|other| {
            other.realisation == row.realisation
                && other.speed_mm_s == row.speed_mm_s
                && other.contact_area_fraction == row.contact_area_fraction
        });
        let ratio = row.friction_coefficient / other.unwrap().friction_coefficient;
        assert!((0.8..1.25).contains(&ratio), "{ratio} at {row:?}");
    }
}

/// A curve does not end with its first contact, even if that has the largest area of the recipe: values are interpolated.
#[test]
fn one_wave_is_a_surface_that_cannot_be_split() {
    let one = |section: &str| {
        let campaign = campaign(section);
        campaign.edit("recipe.toml", "waves = [2, 3]", "waves = [1]");
        campaign.edit("recipe.toml", "waves = [3]", "waves = [1]");
        campaign
    };
    let alone = one("methods = [\"recursive\"]\ncolumns_per_shortest_wavelength = 32\n");
    let out = alone.path("out");
    run(&recipe(&alone), &out);
    assert!(!RunView::of(&out).rows(METHOD_CURVES).unwrap().is_empty());
    let split = one("methods = [\"split\"]\nmechanics = [\"half-space\"]\n");
    let error = try_run(&recipe(&split), &split.path("out"), Selection::default()).unwrap_err();
    assert!(error.to_string().contains("one wave cannot be split"), "{error}");
}

#[test]
fn what_no_method_can_do_is_refused() {
    for (section, expected) in [
        ("methods = []", "methods.methods = []"),
        ("methods = [\"split\", \"split\"]", "each once"),
        ("mechanics = []", "methods.mechanics = []"),
        ("split_waves = [3]", "methods.split_waves = [3]"),
        ("split_waves = [0]", "methods.split_waves = [0]"),
        ("waves = [7]", "methods.waves = [7]"),
        ("columns_per_shortest_wavelength = 33", "even"),
        ("pressure_ratio = 3.0", "methods.pressure_ratio = 3"),
    ] {
        let campaign = campaign(section);
        let read = Recipe::read(&campaign.path("recipe.toml")).map(|recipe| recipe.job().err());
        let message = match read {
            Ok(Some(error)) => error.to_string(),
            Ok(None) => String::new(),
            Err(error) => error.to_string(),
        };
        assert!(message.contains(expected), "{section}: {message}");
    }
}
