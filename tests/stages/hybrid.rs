//! micro, hybrid, fem and the tables of several models, against contacts solved one by one.

use super::{Campaign, digests, recipe, run, stale, try_run};
use asperity::artifact::RunView;
use asperity::fem::profile::RigidProfile;
use asperity::fem::steady::{BlockOptions, SteadyContact};
use asperity::multiscale::{LawEnd, LocalLaw, SoftContact};
use asperity::pipeline::Selection;
use asperity::recipe::Recipe;
use asperity::rubber::{Rheology, read_rubber};
use asperity::schemas::documents;
use asperity::stages;
use asperity::stages::Stage;
use asperity::stages::bem::CURVES;
use asperity::stages::fem::FEM_SOLVES;
use asperity::stages::hybrid::{HYBRID, HybridRow, LOCAL};
use asperity::stages::micro::{LAW, SAMPLES, SampleRow};
use asperity::stages::realise::read_surfaces;
use asperity::stages::tables::Model;
use asperity::stages::tables::{CORRECTIONS, FRICTION, MODELS};
use asperity::surface::{Wave, wave};
use std::path::Path;

const COLUMNS: usize = 48;

/// A steep wave on a gentle one, few columns.
fn campaign(steep_mm: f64, extra: &str) -> Campaign {
    let campaign = Campaign::new();
    campaign.write(
        "recipe.toml",
        &format!(
            r#"
            title = "A steep wave on a gentle one"
            [[approximate.given]]
            source = "a test"
            scales = [
                {{ wavelength_mm = 0.0625, amplitude_mm = {steep_mm} }},
                {{ wavelength_mm = 0.25, amplitude_mm = 0.01 }},
            ]
            [realise]
            waves = [2]
            realisations = 2
            seed = 5
            [bem]
            rubber = "rubber.toml"
            speeds_mm_s = [20.0]
            area_fractions = [0.03, 0.06]
            tolerance = 1e-3
            [micro]
            columns_per_shortest_wavelength = {COLUMNS}
            tolerance = 5e-3
            {extra}
            "#
        ),
    );
    campaign
}

fn solved(campaign: &Campaign) -> (Recipe, RunView) {
    let recipe = recipe(campaign);
    let out = campaign.path("out");
    run(&recipe, &out);
    (recipe, RunView::of(out))
}

#[test]
fn the_microscale_is_solved_over_the_pressures_that_the_macro_contact_asks_for() {
    let campaign = campaign(0.016, "");
    let (recipe, view) = solved(&campaign);
    let rubber = read_rubber(&recipe.bem.as_ref().unwrap().rubber).unwrap();
    let samples = view.rows(SAMPLES).unwrap();
    let wave = Wave { wavelength: 6.25e-5, amplitude: 1.6e-5, phase: 0.0 };
    let profile = RigidProfile::from_waves(&[wave], wave.wavelength);
    let options = BlockOptions::of_profile(COLUMNS, &profile);
    let middle = &samples[samples.len() / 2];
    let mut block =
        SteadyContact::new(&rubber, Rheology::NeoHookean, 0.02, profile, options).unwrap();
    let solution = block.solve(middle.pressure_mpa * 1e6).unwrap();
    // Another path to the same solution, rows slanted by up to a tenth less.
    let difference = solution.friction_coefficient - middle.friction_finite_deformation;
    assert!(difference.abs() < 2e-3 * solution.friction_coefficient, "{difference}");
    assert!(samples.iter().all(|row| row.residual <= 1e-8));
    assert!(samples.iter().all(|row| row.realisation == 0), "one wave, one curve");
    let rows = view.rows(HYBRID).unwrap();
    let asked = rows.iter().map(|row| row.largest_pressure_mpa).fold(0.0, f64::max);
    assert!(samples[samples.len() - 1].pressure_mpa >= asked);
}

/// The macro contact of the last value of realisation 2, solved here: its row and its pressures in Pa.
fn macro_contact(recipe: &Recipe, view: &RunView) -> (HybridRow, Vec<f64>) {
    let rubber = read_rubber(&recipe.bem.as_ref().unwrap().rubber).unwrap();
    let laws = view.rows(LAW).unwrap();
    let rows = view.rows(HYBRID).unwrap();
    let surface = &read_surfaces(view).unwrap()[1];
    let law = LocalLaw::new(
        laws[0].touch_separation_m,
        &laws.iter().map(|row| row.pressure_pa).collect::<Vec<_>>(),
        &laws.iter().map(|row| row.separation_m).collect::<Vec<_>>(),
        LawEnd::FullContact,
    )
    .unwrap();
    let heights = wave::sample(&surface.profile[1..], 2.5e-4, 32);
    let mut contact = SoftContact::new(&rubber, 0.02, 2.5e-4, &heights, law).unwrap();
    let row = rows.iter().rfind(|row| row.realisation == 2).unwrap().clone();
    let solution = contact.solve(row.pressure_mpa * 1e6).unwrap();
    (row, solution.pressure)
}

/// A value of the samples at a pressure in Pa by straight lines between them, an oracle as good as the samples are
/// dense.
fn between(samples: &[SampleRow], p: f64, value: impl Fn(&SampleRow) -> f64) -> f64 {
    let above = samples.iter().position(|s| s.pressure_mpa * 1e6 > p).unwrap_or(1).max(1);
    let (a, b) = (&samples[above - 1], &samples[above]);
    let t = (p / 1e6 / a.pressure_mpa).ln() / (b.pressure_mpa / a.pressure_mpa).ln();
    value(a) + t.clamp(0.0, 1.0) * (value(b) - value(a))
}

#[test]
fn the_thesis_adds_the_mean_difference_over_the_macro_contact() {
    let rules = "correction = \"difference\"\nmean = \"points\"\nlocal_pressures = \"points\"";
    let campaign = campaign(0.016, &format!("[hybrid]\n{rules}"));
    let (recipe, view) = solved(&campaign);
    let curves = view.rows(CURVES).unwrap();
    let samples = view.rows(SAMPLES).unwrap();
    let rows = view.rows(HYBRID).unwrap();
    assert_eq!(rows.len(), curves.len());
    let (row, pressures) = macro_contact(&recipe, &view);
    let change = |p: f64| between(&samples, p, SampleRow::correction);
    let smallest = samples[0].pressure_mpa * 1e6;
    let pressed = || pressures.iter().copied().filter(|p| *p > 0.0);
    let force = pressed().map(|p| p * change(p)).sum::<f64>() / pressed().sum::<f64>();
    let points: Vec<f64> = pressed().filter(|p| *p >= smallest).map(change).collect();
    let points = points.iter().sum::<f64>() / points.len() as f64;
    assert!((row.correction_force.unwrap() - force).abs() < 5e-3, "{row:?} {force}");
    assert!((row.correction_points.unwrap() - points).abs() < 5e-3, "{row:?} {points}");
    assert!(force.abs() > 0.02, "a correction that matters");
    let corrected = row.friction_half_space + row.correction_points.unwrap();
    assert_eq!(row.friction_coefficient, Some(corrected));
    let locals = view.rows(LOCAL).unwrap();
    for local in &locals {
        let sum = local.friction_half_space + local.correction;
        assert!((sum - local.friction_finite_deformation).abs() < 1e-12);
    }
    assert!(!locals.is_empty());
}

#[test]
fn by_default_friction_changes_by_the_ratio_of_the_forces_of_the_microscale() {
    let campaign = campaign(0.016, "");
    let (recipe, view) = solved(&campaign);
    let samples = view.rows(SAMPLES).unwrap();
    let (row, pressures) = macro_contact(&recipe, &view);
    // Means over a period of the microscale, 8 of the 32 points.
    let window = |i: usize| (0..8).map(|k| pressures[(i + 32 - 4 + k) % 32]).sum::<f64>() / 8.0;
    let local: Vec<f64> = (0..32).map(window).filter(|p| *p > 0.0).collect();
    let force = |value: fn(&SampleRow) -> f64| {
        local.iter().map(|p| p * between(&samples, *p, value)).sum::<f64>()
    };
    let ratio = force(|s| s.friction_finite_deformation) / force(|s| s.friction_half_space);
    let friction = row.friction_coefficient.unwrap();
    let expected = ratio * row.friction_half_space;
    assert!((friction - expected).abs() < 0.01 * friction, "{friction} {expected}");
    assert!((ratio - 1.0).abs() > 0.05, "a correction that matters: {ratio}");
}

#[test]
fn the_tables_have_every_model_and_how_far_they_are_apart() {
    let campaign = campaign(0.016, "[fem]\ncolumns_per_shortest_wavelength = 24");
    let (_, view) = solved(&campaign);
    let friction = view.rows(FRICTION).unwrap();
    let of = |model: Model| friction.iter().filter(|row| row.model == model).collect::<Vec<_>>();
    for model in [Model::Bem, Model::Hybrid, Model::Fem] {
        assert_eq!(of(model).len(), 2, "{model}");
    }
    let models = view.rows(MODELS).unwrap();
    let hybrid =
        models.iter().find(|r| r.model == Model::Hybrid && r.reference == Model::Fem).unwrap();
    let pairs = of(Model::Hybrid).into_iter().zip(of(Model::Fem));
    let by_hand = pairs.map(|(a, b)| (a.mean / b.mean - 1.0).abs()).sum::<f64>() / 2.0;
    assert!((hybrid.relative_error_of_averages - by_hand).abs() < 1e-12);
    let solves = view.rows(FEM_SOLVES).unwrap();
    assert!(solves.iter().all(|row| row.residual <= 1e-8 && row.columns == 96));
    let kinds: Vec<String> = documents().unwrap().into_iter().map(|(name, _)| name).collect();
    for stage in ["micro", "hybrid", "fem", "tables"] {
        for output in view.stage_manifest(stage).unwrap().unwrap().outputs {
            let name = format!("{}.v{}", output.schema, output.schema_version);
            assert!(kinds.contains(&name), "{stage}/{}: {name}", output.file);
        }
    }
}

/// A stopped run has some of its solves; which ones must not show.
#[test]
fn what_was_solved_before_does_not_show() {
    let campaign = campaign(0.016, "[fem]\ncolumns_per_shortest_wavelength = 24");
    let (recipe, _) = solved(&campaign);
    let out = campaign.path("out");
    let before = digests(&out);
    let folders = std::fs::read_dir(out.join("solves")).unwrap();
    let files = folders.flat_map(|folder| std::fs::read_dir(folder.unwrap().path()).unwrap());
    let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    files.iter().step_by(2).for_each(|file| std::fs::remove_file(file).unwrap());
    for stage in ["micro", "fem"] {
        std::fs::remove_dir_all(out.join(stage)).unwrap();
    }
    run(&recipe, &out);
    assert_eq!(digests(&out), before);
}

#[test]
fn gentle_waves_need_no_correction() {
    let campaign = campaign(0.005, "");
    let (_, view) = solved(&campaign);
    let rows = view.rows(HYBRID).unwrap();
    assert!(rows.iter().all(|row| row.friction_coefficient == Some(row.friction_half_space)));
    let manifest = view.stage_manifest("micro").unwrap().unwrap();
    assert!(manifest.warnings[0].contains("micro.rms_slope_threshold"), "{manifest:?}");
}

#[test]
fn nothing_is_left_without_a_macro_surface() {
    let campaign = campaign(0.016, "rms_slope_threshold = 0.1");
    let error = try_run(&recipe(&campaign), &campaign.path("out"), Selection::default());
    let error = error.unwrap_err().to_string();
    assert!(error.contains("raise micro.rms_slope_threshold"), "{error}");
}

#[test]
fn a_correction_without_a_microscale_is_refused() {
    let text = campaign(0.016, "[hybrid]").read("recipe.toml");
    let start = text.find("[micro]").unwrap();
    let end = text.find("[hybrid]").unwrap();
    let without = format!("{}{}", &text[..start], &text[end..]);
    let error = Recipe::parse(&without, Path::new("recipe.toml")).unwrap_err().to_string();
    assert!(error.contains("[hybrid] without [micro]"), "{error}");
}

#[test]
fn only_the_correction_is_made_anew_when_its_rule_changes() {
    let campaign = campaign(0.016, "");
    let (_, view) = solved(&campaign);
    let text = campaign.read("recipe.toml") + "\n[hybrid]\nmean = \"points\"\n";
    campaign.write("recipe.toml", &text);
    let changed = recipe(&campaign);
    let out = campaign.path("out");
    let stale = stale(&changed, &out);
    assert_eq!(stale[0].0, stages::hybrid::STAGE, "{stale:?}");
    assert!(stale[0].1.contains("mean"), "{stale:?}");
    assert_eq!(run(&changed, &out), [stages::hybrid::STAGE, stages::tables::STAGE]);
    // Solves of the microscale are kept one by one.
    std::fs::remove_dir_all(out.join("micro")).unwrap();
    run(&changed, &out);
    let again = view.rows(SAMPLES).unwrap();
    assert!(again.iter().all(|row| row.residual <= 1e-8));
}

#[test]
fn stages_are_stale_behind_those_they_read_alone() {
    let campaign = campaign(0.016, "[fem]\ncolumns_per_shortest_wavelength = 24");
    let (_, _) = solved(&campaign);
    campaign.edit("recipe.toml", "tolerance = 5e-3", "tolerance = 4e-3");
    let (changed, out) = (recipe(&campaign), campaign.path("out"));
    let found = stale(&changed, &out);
    let stages: Vec<Stage> = found.iter().map(|(stage, _)| *stage).collect();
    assert_eq!(stages, [stages::micro::STAGE, stages::hybrid::STAGE, stages::tables::STAGE]);
    assert_eq!(found[0].1, "micro.tolerance: 0.005 -> 0.004");
    let only = |stage| Selection { only: Some(stage), ..Selection::default() };
    assert_eq!(try_run(&changed, &out, only(stages::fem::STAGE)).unwrap(), []);
    let refused = try_run(&changed, &out, only(stages::tables::STAGE)).unwrap_err().to_string();
    assert!(refused.starts_with("tables needs the results of micro"), "{refused}");
    let from = Selection { from: Some(stages::fem::STAGE), ..Selection::default() };
    let refused = try_run(&changed, &out, from).unwrap_err().to_string();
    assert!(refused.starts_with("tables needs the results of micro"), "{refused}");
}

/// Slopes of 71 rms, for which there is not even a first contact.
const TOO_STEEP_MM: f64 = 1.0;

#[test]
fn a_microscale_without_a_solution_leaves_its_values_out() {
    let campaign = campaign(0.016, "");
    campaign.edit("recipe.toml", "waves = [2]", "waves = [2, 3]");
    campaign.edit(
        "recipe.toml",
        "[realise]",
        &format!(
            r#"[[approximate.given]]
            source = "another test"
            scales = [
                {{ wavelength_mm = 0.0625, amplitude_mm = {TOO_STEEP_MM} }},
                {{ wavelength_mm = 0.125, amplitude_mm = 0.001 }},
                {{ wavelength_mm = 0.25, amplitude_mm = 0.01 }},
            ]
            [realise]"#
        ),
    );
    let (_, view) = solved(&campaign);
    let rows = view.rows(HYBRID).unwrap();
    let corrected = |row: &HybridRow| row.friction_coefficient.is_some();
    assert!(rows.iter().any(|row| row.kind.waves == 2 && corrected(row)));
    assert!(rows.iter().any(|row| row.kind.waves == 3));
    assert!(!rows.iter().any(|row| row.kind.waves == 3 && corrected(row)));
    let warnings = |stage| view.stage_manifest(stage).unwrap().unwrap().warnings.join("\n");
    let micro = warnings("micro");
    assert!(micro.contains("3 waves, 20 mm/s: the microscale has not one sample: "), "{micro}");
    assert!(micro.contains("try another micro.columns_per_shortest_wavelength"), "{micro}");
    assert!(warnings("hybrid").contains("their microscale has no sample"));
}

#[test]
fn nothing_to_correct_with_is_an_error_that_says_what_to_do() {
    let campaign = campaign(TOO_STEEP_MM, "");
    let error = try_run(&recipe(&campaign), &campaign.path("out"), Selection::default());
    let error = error.unwrap_err().to_string();
    assert!(error.contains("no microscale has a solution"), "{error}");
    assert!(
        error.contains("micro.columns_per_shortest_wavelength, or leave [micro] out"),
        "{error}"
    );
}

#[test]
fn an_accuracy_brings_the_errors_by_the_mesh_into_the_tables() {
    let fem = "[fem]\ncolumns_per_shortest_wavelength = 32\npressure_ratio = 1.5";
    let campaign = campaign(0.016, fem);
    campaign.edit(
        "recipe.toml",
        "area_fractions = [0.03, 0.06]\n            tolerance = 1e-3",
        "area_fractions = [0.03, 0.06]",
    );
    campaign.edit("recipe.toml", "realisations = 2", "most_realisations = 2");
    let text = campaign.read("recipe.toml");
    campaign.write("recipe.toml", &format!("tolerance = 0.2\n{text}"));
    let (recipe, view) = solved(&campaign);
    let rubber = read_rubber(&recipe.bem.as_ref().unwrap().rubber).unwrap();
    let samples = view.rows(SAMPLES).unwrap();
    // Three times as many columns have a ninth of the error.
    let wave = Wave { wavelength: 6.25e-5, amplitude: 1.6e-5, phase: 0.0 };
    let profile = RigidProfile::from_waves(&[wave], wave.wavelength);
    let options = BlockOptions::of_profile(3 * COLUMNS, &profile);
    let mut finer =
        SteadyContact::new(&rubber, Rheology::NeoHookean, 0.02, profile, options).unwrap();
    let mut covered = 0;
    for sample in &samples {
        let fine = finer.solve(sample.pressure_mpa * 1e6).unwrap().friction_coefficient;
        let change = (fine - sample.friction_finite_deformation).abs();
        let error = sample.discretisation_error.unwrap();
        assert!(change <= 2.0 * error, "{change} {sample:?}");
        covered += usize::from(change <= error);
    }
    assert!(10 * covered >= 9 * samples.len(), "{covered} of {}", samples.len());
    let rows = view.rows(FRICTION).unwrap();
    for row in &rows {
        assert_ne!(row.discretisation_error.unwrap(), 0.0, "{row:?}");
        assert!(row.error_estimate.unwrap() > row.confidence_95.unwrap(), "{row:?}");
    }
    let of = |model: Model| rows.iter().filter(|row| row.model == model).count();
    assert_eq!((of(Model::Bem), of(Model::Hybrid)), (2, 2));
    assert!(of(Model::Fem) > 0);
}

/// A published correction at a sampled pressure stands beside that sample; one between two, between them; one beyond
/// all is left out.
#[test]
fn published_corrections_stand_beside_the_samples() {
    let extra = r#"
        [[tables.published_corrections]]
        name = "Local"
        waves = 2
        speed_mm_s = 20.0
        file = "local.csv"
    "#;
    let campaign = campaign(0.016, extra);
    campaign
        .write("local.csv", "pressure_mpa,friction_bem,friction_fem\n1.0,0.5,0.4\n1e4,0.1,0.1\n");
    let (_, view) = solved(&campaign);
    let samples = view.rows(SAMPLES).unwrap();
    let rows = view.rows(CORRECTIONS).unwrap();
    let [row] = rows.as_slice() else { panic!("{rows:?}") };
    assert_eq!((row.published_half_space, row.published_finite_deformation), (0.5, 0.4));
    let above = samples.iter().position(|sample| sample.pressure_mpa > 1.0).unwrap();
    let ends = [&samples[above - 1], &samples[above]];
    for (computed, value) in [
        (row.computed_half_space, (|s: &SampleRow| s.friction_half_space) as fn(&SampleRow) -> f64),
        (row.computed_finite_deformation, |s| s.friction_finite_deformation),
    ] {
        let [a, b] = ends.map(value);
        let margin = 0.1 * (a - b).abs();
        assert!((a.min(b) - margin..=a.max(b) + margin).contains(&computed), "{computed} {a} {b}");
    }
    assert!(row.discretisation_error.unwrap() > 0.0);
}

#[test]
fn finite_elements_of_all_waves_are_solved_for_the_numbers_of_waves_that_are_asked_for() {
    let campaign = campaign(0.004, "[fem]\nwaves = [1]\ncolumns_per_shortest_wavelength = 32");
    let text = std::fs::read_to_string(campaign.path("recipe.toml")).unwrap();
    let other = "[[approximate.given]]\nsource = \"another\"\nscales = [{ wavelength_mm = 0.25, amplitude_mm = 0.01 }]\n[realise]";
    let text = text.replace("[realise]", other).replace("waves = [2]", "waves = [1, 2]");
    campaign.write("recipe.toml", &text);
    let (_, view) = solved(&campaign);
    let solves = view.rows(FEM_SOLVES).unwrap();
    assert!(!solves.is_empty() && solves.iter().all(|row| row.kind.waves == 1), "{solves:?}");
    campaign.write("recipe.toml", &text.replace("[fem]\nwaves = [1]", "[fem]\nwaves = [3]"));
    let error = Recipe::read(&campaign.path("recipe.toml")).unwrap_err().to_string();
    assert!(error.contains("fem.waves") && error.contains("realise.waves"), "{error}");
}
