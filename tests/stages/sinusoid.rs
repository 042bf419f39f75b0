//! The study of one sine wave, against solves one by one and exact limits.

use super::{Campaign, digests, recipe, run, stale, try_run};
use asperity::artifact::RunView;
use asperity::contact::SlidingContact;
use asperity::fem::profile::RigidProfile;
use asperity::fem::steady::{BlockOptions, SteadyContact};
use asperity::pipeline::Selection;
use asperity::recipe::Recipe;
use asperity::rubber::{Rheology, Rubber, read_rubber};
use asperity::stages;
use asperity::stages::sinusoid::Model;
use asperity::stages::sinusoid::{
    AGREEMENT, ASYMPTOTES, FIELDS, FieldRow, POINTS, PRESSURES, PointRow,
};
use asperity::surface::{Wave, wave};

const STUDY: &str = r#"title = "One sine"
[sinusoid]
rubber = "rubber.toml"
wavelength_mm = 0.02
aspect_ratios = [0.1]
speeds_mm_s = [0.001, 10.0, 1e3]
pressure_mpa = 1.0
columns = 24
half_space_points = 512
[sinusoid.fields]
aspect_ratios = [0.1]
speeds_mm_s = [10.0]
[sinusoid.pressure_dependence]
aspect_ratio = 0.1
speeds_mm_s = [10.0]
pressures_mpa = [0.1, 0.3, 30.0]
"#;

fn study() -> (Campaign, Recipe) {
    let campaign = Campaign::new();
    campaign.write("recipe.toml", STUDY);
    let recipe = recipe(&campaign);
    (campaign, recipe)
}

/// Friction by the solver itself; none where it ends before the pressure.
fn direct(rubber: &Rubber, row: &PointRow, columns: usize) -> Option<f64> {
    let wave = Wave { wavelength: 2e-5, amplitude: row.aspect_ratio * 2e-5, phase: 0.0 };
    let (speed, pressure) = (row.speed_mm_s / 1e3, row.pressure_mpa * 1e6);
    let rheology = match row.model {
        Model::HalfSpace => {
            let heights = wave::sample(&[wave], 2e-5, columns);
            let mut contact = SlidingContact::new(rubber, speed, 2e-5, &heights).unwrap();
            return Some(contact.solve(pressure).unwrap().friction_coefficient);
        }
        Model::Linear => Rheology::Linear,
        Model::NeoHookean => Rheology::NeoHookean,
    };
    let profile = RigidProfile::from_waves(&[wave], 2e-5);
    let options = BlockOptions::of_profile(columns, &profile);
    let mut contact = SteadyContact::new(rubber, rheology, speed, profile, options).unwrap();
    contact.solve(pressure).ok().map(|solution| solution.friction_coefficient)
}

#[test]
fn every_point_is_a_solution_or_says_that_there_is_none() {
    let (campaign, recipe) = study();
    let out = campaign.path("out");
    assert_eq!(run(&recipe, &out), [stages::sinusoid::STAGE]);
    let view = RunView::of(&out);
    let points = view.rows(POINTS).unwrap();
    assert_eq!(points.len(), 3 * 3);
    let rubber = read_rubber(campaign.path("rubber.toml")).unwrap();
    for row in &points {
        let columns = row.columns as usize;
        assert_eq!(row.friction_coefficient, direct(&rubber, row, columns), "{row:?}");
        assert_eq!(row.friction_coarse, direct(&rubber, row, columns / 2), "{row:?}");
        assert_eq!(row.friction_coefficient.is_none(), row.why_missing.is_some(), "{row:?}");
        if let (Some(fine), Some(coarse)) = (row.friction_coefficient, row.friction_coarse) {
            assert!(row.residual.unwrap() <= 1e-8, "{row:?}");
            assert!(row.friction_mesh_error.unwrap() >= (fine - coarse).abs());
            assert_eq!(row.friction_extrapolated, Some(fine + (fine - coarse) / 3.0));
        } else {
            assert_eq!(row.friction_extrapolated, None);
        }
    }
    // The half-space has a solution at every pressure, and its slow and fast limits are elastic.
    let half_space: Vec<&PointRow> =
        points.iter().filter(|r| r.model == Model::HalfSpace).collect();
    assert!(half_space.iter().all(|row| row.friction_coefficient.is_some()));
    let limits = view.rows(ASYMPTOTES).unwrap();
    let slow = half_space[0].contact_area_fraction.unwrap();
    // At 0.001 mm/s the loss modulus is 6e-4 of the relaxed one; the rest is the grid of 512 points.
    approx::assert_relative_eq!(slow, limits[0].westergaard_area_fraction, max_relative = 0.01);

    let agreement = view.rows(AGREEMENT).unwrap();
    assert_eq!(agreement.len(), 2 * 3 * 2);
    for row in &agreement {
        assert_eq!(
            (row.compared + row.missing, row.agree + row.part + row.undecided),
            (3, row.compared)
        );
    }
}

#[test]
fn fields_and_pressures_are_as_the_recipe_asks() {
    let (campaign, _) = study();
    // No mesh this coarse reaches 30 MPa on a wave this steep.
    campaign.edit("recipe.toml", "aspect_ratio = 0.1\n", "aspect_ratio = 0.2\n");
    let recipe = recipe(&campaign);
    let out = campaign.path("out");
    run(&recipe, &out);
    let view = RunView::of(&out);
    let fields = view.rows(FIELDS).unwrap();
    for model in [Model::HalfSpace, Model::NeoHookean] {
        let rows: Vec<&FieldRow> = fields.iter().filter(|row| row.model == model).collect();
        assert_eq!(rows.len(), if model == Model::HalfSpace { 512 } else { 24 });
        assert!(rows.windows(2).all(|pair| pair[0].x_mm < pair[1].x_mm));
        for row in rows {
            // Closed to round-off, or to the residual of the steady solver over 4 µm of height.
            let closed = row.pressure_mpa == 0.0 || row.separation_mm.abs() < 1e-9;
            assert!(row.pressure_mpa >= 0.0 && row.separation_mm > -1e-9 && closed, "{row:?}");
        }
    }
    let pressures = view.rows(PRESSURES).unwrap();
    assert_eq!(pressures.len(), 3 * 3);
    let beyond =
        pressures.iter().find(|r| r.model == Model::Linear && r.pressure_mpa == 30.0).unwrap();
    assert_eq!((beyond.friction_coefficient, beyond.contact_area_fraction), (None, None));
    assert!(beyond.path_ended_at_mpa.unwrap() < 30.0);
    assert!(beyond.why_missing.as_ref().unwrap().contains("the path ended at"));
}

#[test]
fn a_study_is_up_to_date_or_continues_from_its_solves() {
    let (campaign, wanted) = study();
    let out = campaign.path("out");
    run(&wanted, &out);
    let first = digests(&out);
    assert_eq!(stale(&wanted, &out), []);
    assert_eq!(run(&wanted, &out), []);
    campaign.edit("recipe.toml", "speeds_mm_s = [0.001, 10.0, 1e3]", "speeds_mm_s = [0.001, 10.0]");
    let fewer = recipe(&campaign);
    assert_eq!(stale(&fewer, &out)[0].0, stages::sinusoid::STAGE);
    assert_eq!(run(&fewer, &out), [stages::sinusoid::STAGE]);
    assert_ne!(digests(&out), first);
    // From the store and from scratch.
    assert_eq!(run(&wanted, &out), [stages::sinusoid::STAGE]);
    assert_eq!(digests(&out), first);
    let force = Selection { force: Some(stages::sinusoid::STAGE), ..Selection::default() };
    assert_eq!(try_run(&wanted, &out, force).unwrap(), [stages::sinusoid::STAGE]);
    assert_eq!(digests(&out), first);

    let only = Selection { only: Some(stages::bem::STAGE), ..Selection::default() };
    let refused = try_run(&wanted, &out, only).unwrap_err().to_string();
    assert_eq!(refused, "the recipe has no stage bem: it has sinusoid");
}

#[test]
fn a_study_stands_alone_in_its_recipe() {
    let path = std::path::Path::new("recipe.toml");
    let refused = |text: &str| Recipe::parse(text, path).unwrap_err().to_string();
    let message = refused(&format!("{STUDY}\n[realise]\nwaves = [3]\nrealisations = 1\nseed = 1"));
    assert!(message.contains("section [realise] beside [sinusoid]"), "{message}");
    let message = refused("title = 'nothing'");
    assert!(message.contains("missing section [approximate]"), "{message}");
    for (from, to, part) in [
        (
            "aspect_ratios = [0.1]\nspeeds_mm_s = [0.001",
            "aspect_ratios = []\nspeeds_mm_s = [0.001",
            "aspect_ratios = []",
        ),
        ("columns = 24", "columns = 25", "sinusoid.columns = 25"),
        ("pressure_mpa = 1.0", "pressure_mpa = nan", "sinusoid.pressure_mpa = nan"),
        ("speeds_mm_s = [10.0]\n[", "speeds_mm_s = [11.0]\n[", "sinusoid.fields.speeds_mm_s"),
        ("pressures_mpa = [0.1, 0.3, 30.0]", "pressures_mpa = [0.3, 0.1]", "pressures_mpa"),
    ] {
        assert!(STUDY.contains(from), "{from}");
        let message = refused(&STUDY.replacen(from, to, 1));
        assert!(message.contains(part), "{message}");
    }
}
