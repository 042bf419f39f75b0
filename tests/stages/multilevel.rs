//! multilevel: averages at finite deformation from many realisations on the half-space and few with all
//! waves.

use super::{Campaign, digests, recipe, run, stale, try_run};
use asperity::artifact::RunView;
use asperity::forecast::forecast;
use asperity::numerics::Interrupt;
use asperity::numerics::statistics::MeanEstimate;
use asperity::pipeline::{self, Event, Selection};
use asperity::recipe::Recipe;
use asperity::stages;
use asperity::stages::bem::CURVES;
use asperity::stages::fem::FEM;
use asperity::stages::multilevel::{AVERAGES, AverageRow, Estimate, FURTHER, PAIRS, PairRow};
use asperity::stages::tables::Model;
use asperity::stages::tables::{FRICTION, FrictionRow, MODELS};
use std::sync::atomic::{AtomicBool, Ordering};

/// Two waves that half-space and finite elements differ for by some per cent, few columns.
const RECIPE: &str = r#"title = "Two waves under both models"

[[approximate.given]]
source = "a test"
scales = [
    { wavelength_mm = 0.125, amplitude_mm = 0.012 },
    { wavelength_mm = 0.25, amplitude_mm = 0.016 },
]

[realise]
waves = [2]
realisations = 12
seed = 5

[bem]
rubber = "rubber.toml"
speeds_mm_s = [10.0]
area_fractions = [0.2, 0.4]
tolerance = 1e-3

[multilevel]
columns_per_shortest_wavelength = 16
pressure_ratio = 1.4
first_realisations = 4
"#;

fn campaign() -> Campaign {
    let campaign = Campaign::new();
    campaign.write("recipe.toml", RECIPE);
    campaign
}

/// The same with realisations as a relative accuracy asks for them.
fn with_tolerance(tolerance: &str) -> Campaign {
    let campaign = campaign();
    campaign.edit("recipe.toml", "title = ", &format!("tolerance = {tolerance}\ntitle = "));
    campaign.edit("recipe.toml", "realisations = 12", "most_realisations = 300");
    campaign.edit("recipe.toml", "tolerance = 1e-3\n", "");
    campaign
}

fn solved(campaign: &Campaign, out: &str) -> (Recipe, RunView) {
    let recipe = recipe(campaign);
    run(&recipe, &campaign.path(out));
    (recipe, RunView::of(campaign.path(out)))
}

fn averages(view: &RunView) -> Vec<AverageRow> {
    view.rows(AVERAGES).unwrap()
}

#[test]
fn the_average_is_the_mean_of_the_half_space_plus_the_mean_difference_of_the_pairs() {
    let campaign = campaign();
    let (_, view) = solved(&campaign, "out");
    let curves = view.rows(CURVES).unwrap();
    let pairs = view.rows(PAIRS).unwrap();
    let averages = averages(&view);
    assert_eq!((averages.len(), pairs.len()), (2, 8));
    let area = 0.4;
    let b: Vec<f64> = curves
        .iter()
        .filter(|row| row.contact_area_fraction == area)
        .map(|row| row.friction_coefficient)
        .collect();
    let own: Vec<&PairRow> = pairs.iter().filter(|r| r.contact_area_fraction == area).collect();
    let d: Vec<f64> = own.iter().map(|row| row.difference).collect();
    for (row, (b, d)) in own.iter().zip(b.iter().zip(&d)) {
        assert_eq!(row.friction_half_space, *b);
        assert_eq!(row.friction_finite_deformation - b, *d);
    }
    let (n, all) = (4.0, 12.0);
    let mean = b.iter().sum::<f64>() / all + d.iter().sum::<f64>() / n;
    // The variance by model: Var(b)/N + Var(d)/n + 2 Cov(b, d)/N, against that by realisation, with the
    // variances of the two halves in place of those of all.
    let half: Vec<f64> = b.iter().zip(&d).map(|(b, d)| d + n / all * b).collect();
    let [paired, rest] = [MeanEstimate::of(&half), MeanEstimate::of(&b[4..])];
    let parts = [
        paired.standard_deviation.powi(2) / n,
        (8.0_f64 / 12.0 * rest.standard_deviation).powi(2) / 8.0,
    ];
    let variance = parts[0] + parts[1];
    let freedom = variance.powi(2) / (parts[0].powi(2) / 3.0 + parts[1].powi(2) / 7.0);
    let row = &averages[1];
    assert!((row.friction_coefficient - mean).abs() < 1e-14);
    assert!((row.degrees_of_freedom.unwrap() - freedom).abs() < 1e-9 * freedom);
    let quantile = row.confidence_95.unwrap() / variance.sqrt();
    assert!((2.0..3.2).contains(&quantile), "{quantile} for {freedom}");
    assert_eq!((row.half_space_realisations, row.pairs, row.model_error), (12, 4, 0.0));

    let friction = view.rows(FRICTION).unwrap();
    let table: Vec<&FrictionRow> =
        friction.iter().filter(|r| r.model == Model::Multilevel).collect();
    assert_eq!((table.len(), table[1].mean), (2, row.friction_coefficient));
    assert_eq!(table[1].confidence_95, row.confidence_95);
    assert_eq!(table[1].half_space_realisations, Some(12));
    let full: Vec<f64> = own.iter().map(|row| row.friction_finite_deformation).collect();
    assert_eq!(table[1].realisations, full);
    let models = view.rows(MODELS).unwrap();
    assert!(models.iter().any(|r| r.model == Model::Bem && r.reference == Model::Multilevel));
}

#[test]
fn all_realisations_as_pairs_are_the_average_of_the_stage_fem() {
    let campaign = campaign();
    campaign.edit("recipe.toml", "realisations = 12", "realisations = 4");
    let fem = "[fem]\ncolumns_per_shortest_wavelength = 16\npressure_ratio = 1.4\n\n[multilevel]";
    campaign.edit("recipe.toml", "[multilevel]", fem);
    let (_, view) = solved(&campaign, "out");
    let curves = view.rows(FEM).unwrap();
    for row in averages(&view) {
        let own = curves.iter().filter(|c| c.contact_area_fraction == row.contact_area_fraction);
        let own: Vec<f64> = own.map(|curve| curve.friction_coefficient).collect();
        let expected = MeanEstimate::of(&own);
        assert!((row.friction_coefficient - expected.mean).abs() < 1e-13);
        assert!((row.confidence_95.unwrap() / expected.confidence_95 - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_tolerance_is_met_by_further_realisations_of_the_half_space_and_few_pairs() {
    let campaign = with_tolerance("0.25");
    let (recipe, view) = solved(&campaign, "out");
    for row in averages(&view) {
        let statistical = row.confidence_95.unwrap();
        assert!(statistical <= 0.25 * row.friction_coefficient, "{row:?}");
        assert!(row.pairs >= 4 && row.pairs <= row.half_space_realisations);
        // Half of so few columns do not reach every area.
        assert_eq!(row.error_estimate.is_some(), row.discretisation_error.is_some());
    }
    // What is there stays as it is, and so does what another number of threads makes of it.
    assert_eq!(stale(&recipe, &campaign.path("out")), []);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| run(&recipe, &campaign.path("one")));
    let of = |out: &str| digests(&campaign.path(out));
    assert_eq!(of("one"), of("out"));
}

#[test]
fn a_gentle_surface_has_no_finite_elements_and_the_bound_among_its_errors() {
    let campaign = with_tolerance("0.2");
    // An rms slope of 0.05, whose bound is 1 % of the friction.
    campaign.edit("recipe.toml", "amplitude_mm = 0.012", "amplitude_mm = 0.001");
    campaign.edit("recipe.toml", "amplitude_mm = 0.016", "amplitude_mm = 0.002");
    let (_, view) = solved(&campaign, "out");
    let pairs = view.rows(PAIRS).unwrap();
    assert_eq!(pairs, []);
    let curves = view.rows(CURVES).unwrap();
    let further = view.rows(FURTHER).unwrap();
    for row in averages(&view) {
        let own = curves.iter().chain(&further);
        let own = own.filter(|c| c.contact_area_fraction == row.contact_area_fraction);
        let own: Vec<f64> = own.map(|curve| curve.friction_coefficient).collect();
        let half_space = MeanEstimate::of(&own);
        assert!((row.friction_coefficient - half_space.mean).abs() < 1e-15);
        assert!((row.confidence_95.unwrap() - half_space.confidence_95).abs() < 1e-12);
        let relative = row.model_error / row.friction_coefficient;
        assert!((0.005..0.025).contains(&relative), "{relative}");
        assert!(row.error_estimate.unwrap() <= 0.2 * row.friction_coefficient, "{row:?}");
    }
    let friction = view.rows(FRICTION).unwrap();
    let row = friction.iter().find(|row| row.model == Model::Multilevel).unwrap();
    assert_eq!((row.realisations.len(), row.standard_deviation), (0, None));
    assert!(row.model_error.unwrap() > 0.0);
}

#[test]
fn a_stopped_run_goes_on_to_the_same_averages() {
    let campaign = campaign();
    let (recipe, _) = solved(&campaign, "whole");
    let (interrupt, out) = (Interrupt::default(), campaign.path("out"));
    let stopped = AtomicBool::new(false);
    let observer = |event: Event| {
        if matches!(event, Event::Progress(stage, 1.., _) if stage == stages::multilevel::STAGE) {
            stopped.store(true, Ordering::Relaxed);
            interrupt.set();
        }
    };
    let result = pipeline::run(&recipe, &out, Selection::default(), &interrupt, &observer);
    assert!(result.unwrap_err().is_interrupt() && stopped.load(Ordering::Relaxed));
    assert!(!out.join("multilevel").exists());
    run(&recipe, &out);
    let of = |out: &str| digests(&campaign.path(out));
    assert_eq!(of("out"), of("whole"));
}

#[test]
fn a_section_that_asks_for_the_impossible_is_refused() {
    let campaign = campaign();
    campaign.edit("recipe.toml", "first_realisations = 4", "first_realisations = 40");
    let error = Recipe::read(&campaign.path("recipe.toml")).unwrap_err().to_string();
    assert!(error.contains("multilevel.most_realisations"), "{error}");
    campaign.edit("recipe.toml", "first_realisations = 40", "pairs = 4");
    let error = Recipe::read(&campaign.path("recipe.toml")).unwrap_err().to_string();
    assert!(error.contains("pairs"), "{error}");
    campaign.edit("recipe.toml", "pairs = 4\n", "");
    campaign.write("rubber.toml", &campaign.read("rubber.toml").replace("0.49", "0.5"));
    let error = try_run(&recipe(&campaign), &campaign.path("out"), Selection::default())
        .unwrap_err()
        .to_string();
    assert!(error.starts_with("multilevel") && error.contains("poisson_ratio"), "{error}");
}

#[test]
fn the_plan_foretells_the_first_pairs() {
    let plan = |campaign: &Campaign| {
        forecast(&recipe(campaign), 1, &Interrupt::default()).unwrap().multilevel.remove(0)
    };
    let all = plan(&campaign());
    assert_eq!((all.pairs, all.most_pairs, all.columns), (4, 4, 32));
    assert!(all.seconds_each > 0.0);
    let first = plan(&with_tolerance("0.25"));
    assert_eq!((first.pairs, first.most_pairs), (4, 30));
    assert_eq!(first.seconds_each, all.seconds_each);
    let one_mesh = campaign();
    one_mesh.edit("recipe.toml", "[multilevel]\n", "[multilevel]\nestimate_mesh_error = false\n");
    assert!(plan(&one_mesh).seconds_each < all.seconds_each, "not on half the columns too");
    let gentle = with_tolerance("0.2");
    gentle.edit("recipe.toml", "amplitude_mm = 0.012", "amplitude_mm = 0.001");
    gentle.edit("recipe.toml", "amplitude_mm = 0.016", "amplitude_mm = 0.002");
    assert_eq!(plan(&gentle).pairs, 0);
}

/// Draws without repeats, the same on every machine: a permutation by a linear congruential generator
/// (Knuth's MMIX constants).
fn permutation(count: usize, seed: u64) -> Vec<usize> {
    let mut state = seed;
    let mut draw = |below: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % below
    };
    let mut order: Vec<usize> = (0..count).collect();
    for k in (1..count).rev() {
        order.swap(k, draw(k + 1));
    }
    order
}

/// 100 families of 30 realisations of three waves, drawn from 120: the average from 30 on the half-space and
/// five pairs against that of all 30 by finite elements, and against that of all 120.
#[test]
#[ignore = "240 curves of three waves at finite deformation: .ci/full"]
fn families_of_three_waves_agree_with_averages_of_thirty_by_finite_elements() {
    let campaign = Campaign::new();
    let project = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let rubber = std::fs::read_to_string(project.join("data/rubber/table_2_1.toml")).unwrap();
    campaign.write("rubber.toml", &rubber);
    campaign.write(
        "recipe.toml",
        r#"title = "Three waves"
        [[approximate.given]]
        source = "thesis, Table 3.1, the three shortest waves"
        scales = [
            { wavelength_mm = 0.0625, amplitude_mm = 0.01867 },
            { wavelength_mm = 0.125, amplitude_mm = 0.02648 },
            { wavelength_mm = 0.25, amplitude_mm = 0.02939 },
        ]
        [realise]
        waves = [3]
        realisations = 120
        seed = 1
        [bem]
        rubber = "rubber.toml"
        speeds_mm_s = [10.0, 50.0]
        area_fractions = [0.03, 0.05, 0.1]
        [fem]
        columns_per_shortest_wavelength = 48
        "#,
    );
    let (_, view) = solved(&campaign, "out");
    let half_space = view.rows(CURVES).unwrap();
    let full = view.rows(FEM).unwrap();
    let mut of_all_families = 0;
    for speed in [10.0, 50.0] {
        for area in [0.03, 0.05, 0.1] {
            let b: Vec<f64> = half_space
                .iter()
                .filter(|r| r.speed_mm_s == speed && r.contact_area_fraction == area)
                .map(|row| row.friction_coefficient)
                .collect();
            let f: Vec<f64> = full
                .iter()
                .filter(|r| r.speed_mm_s == speed && r.contact_area_fraction == area)
                .map(|row| row.friction_coefficient)
                .collect();
            assert_eq!((b.len(), f.len()), (120, 120), "every surface reaches every area");
            let of_all = MeanEstimate::of(&f).mean;
            let (mut of_thirty, mut of_pool) = (0, 0);
            for family in 0..100 {
                let order = &permutation(120, family)[..30];
                let half_space: Vec<f64> = order.iter().map(|k| b[*k]).collect();
                let thirty: Vec<f64> = order.iter().map(|k| f[*k]).collect();
                let estimate = Estimate::new(&half_space, &thirty[..5]);
                let inside =
                    |mean: f64| u32::from((estimate.mean - mean).abs() <= estimate.confidence_95);
                of_thirty += inside(MeanEstimate::of(&thirty).mean);
                of_pool += inside(of_all);
            }
            eprintln!("{speed} mm/s, area {area}: {of_thirty} and {of_pool} of 100");
            // Of 100 families of an interval of exactly 95 % fewer than 90 agree once in a hundred times.
            assert!(of_thirty >= 90, "{speed} mm/s, area {area}: {of_thirty} of 100");
            of_all_families += of_thirty;
            assert!(of_pool >= 90, "{speed} mm/s, area {area}: {of_pool} of 100");
        }
    }
    assert!(of_all_families >= 570, "{of_all_families} of 600");
}
