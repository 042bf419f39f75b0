//! The older theories as columns of the tables.

use super::{Campaign, recipe, run, stale};
use asperity::artifact::RunView;
use asperity::recipe::Recipe;
use asperity::rubber::read_rubber;
use asperity::stages;
use asperity::stages::bem::CURVES;
use asperity::stages::realise::read_surfaces;
use asperity::stages::tables::Model;
use asperity::stages::tables::{FRICTION, MODELS, THEORIES, TheoryRow};
use asperity::surface::SineScale;
use asperity::theory::Persson;
use std::path::Path;

const BOTH_THEORIES: &str = "[tables]\ntheories = [\"persson\", \"klueppel-heinrich\"]\n";

fn with_tables(campaign: &Campaign, tables: &str) -> String {
    campaign.read("recipe.toml") + "\n" + tables
}

#[test]
fn theories_stand_beside_the_half_space_where_they_are_asked_for() {
    let campaign = Campaign::new();
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    assert!(!view.path_of(THEORIES).exists(), "only on request");
    campaign.write("recipe.toml", &with_tables(&campaign, BOTH_THEORIES));
    let recipe = recipe(&campaign);
    let stale = stale(&recipe, &out);
    assert_eq!((stale.len(), stale[0].0), (1, stages::tables::STAGE), "{stale:?}");
    assert!(stale[0].1.contains("tables.theories: not set"), "{stale:?}");
    assert_eq!(run(&recipe, &out), [stages::tables::STAGE]);
    let warnings = view.stage_manifest("tables").unwrap().unwrap().warnings;
    assert!(warnings.len() == 1 && warnings[0].contains("layer_ratio"), "{warnings:?}");

    let friction = view.rows(FRICTION).unwrap();
    let of = |model: Model| friction.iter().filter(|row| row.model == model).collect::<Vec<_>>();
    let areas =
        |model: Model| of(model).iter().map(|r| r.contact_area_fraction).collect::<Vec<_>>();
    for model in [Model::Persson, Model::KlueppelHeinrich] {
        assert_eq!(areas(model), areas(Model::Bem));
        assert!(of(model).iter().all(|row| row.realisations.len() == 2 && row.mean > 0.0));
    }
    let models = view.rows(MODELS).unwrap();
    let pair = models
        .iter()
        .find(|row| row.model == Model::Persson && row.reference == Model::Bem)
        .unwrap();
    let pairs = of(Model::Persson).into_iter().zip(of(Model::Bem));
    let by_hand = pairs.map(|(a, b)| a.mean / b.mean - 1.0).sum::<f64>() / 3.0;
    assert!((pair.bias - by_hand).abs() < 1e-12, "{pair:?}");
}

#[test]
fn a_theory_is_taken_at_the_pressure_of_its_own_area() {
    let campaign = Campaign::new();
    let constants =
        "[tables.theory_constants]\npersson_gamma = 0.75\nklueppel_heinrich_layer_ratio = 20.0\n";
    campaign.write("recipe.toml", &with_tables(&campaign, &format!("{BOTH_THEORIES}{constants}")));
    let recipe = recipe(&campaign);
    let out = campaign.path("out");
    run(&recipe, &out);
    let view = RunView::of(&out);
    assert!(view.stage_manifest("tables").unwrap().unwrap().warnings.is_empty());
    let rubber = read_rubber(&recipe.bem.as_ref().unwrap().rubber).unwrap();
    let surface = &read_surfaces(&view).unwrap()[1];
    let scale = |w: &asperity::surface::Wave| SineScale {
        wavelength: w.wavelength,
        amplitude: w.amplitude,
    };
    let scales: Vec<SineScale> = surface.profile.iter().map(scale).collect();
    let theory = Persson::new(&scales, &rubber, 0.01, 0.75).unwrap();
    let rows = view.rows(THEORIES).unwrap();
    let half_space = view.rows(CURVES).unwrap();
    assert_eq!(rows.len(), 2 * half_space.len());
    let of_surface = |row: &&TheoryRow| row.model == Model::Persson && row.realisation == 2;
    for row in rows.iter().filter(of_surface) {
        let pressure = row.pressure_mpa * 1e6;
        let area = theory.contact_area_fraction(pressure);
        // The inverse of erf has eleven digits.
        assert!((area / row.contact_area_fraction - 1.0).abs() < 1e-10, "{row:?}");
        let friction = theory.friction_coefficient(pressure);
        // MPa and back may change the last digit.
        assert!((friction / row.friction_coefficient - 1.0).abs() < 1e-14, "{row:?}");
    }
}

#[test]
fn constants_out_of_range_and_repeated_theories_are_refused() {
    let campaign = Campaign::new();
    let refused = |tables: &str| {
        let text = with_tables(&campaign, tables);
        Recipe::parse(&text, Path::new("recipe.toml")).unwrap_err().to_string()
    };
    let error = refused("[tables]\ntheories = [\"persson\", \"persson\"]");
    assert!(
        error.contains("tables.theories") && error.contains("a list without repeats"),
        "{error}"
    );
    let error = refused("[tables.theory_constants]\npersson_gamma = 1.5");
    assert!(error.contains("persson_gamma = 1.5: must be between 0 and 1"), "{error}");
    let error = refused("[tables.theory_constants]\nklueppel_heinrich_layer_ratio = 0.0");
    assert!(error.contains("klueppel_heinrich_layer_ratio = 0.0"), "{error}");
    let error = refused("[tables]\ntheories = [\"grosch\"]");
    assert!(error.contains("klueppel-heinrich"), "{error}");
}
