//! bem and tables, against contacts solved one by one.

use super::{Campaign, recipe, run};
use asperity::artifact::RunView;
use asperity::contact::SlidingContact;
use asperity::numerics::statistics::{MeanEstimate, combined_95};
use asperity::recipe::Recipe;
use asperity::rubber::read_rubber;
use asperity::stages::bem::{CURVES, CurveRow, FIELDS, REALISATIONS, SOLVES, SolveRow};
use asperity::stages::realise::{Surface, read_surfaces};
use asperity::stages::tables::{FRICTION, FrictionRow};
use asperity::surface::wave;

const TOLERANCE: f64 = 1e-3;

/// A run over four realisations, with the waves stated in the recipe.
fn solved() -> (Campaign, Recipe, RunView) {
    let campaign = Campaign::new();
    campaign.write(
        "recipe.toml",
        r#"
        title = "Three given waves"
        [[approximate.given]]
        source = "a test"
        scales = [
            { wavelength_mm = 0.25, amplitude_mm = 0.005 },
            { wavelength_mm = 0.5, amplitude_mm = 0.01 },
            { wavelength_mm = 1.0, amplitude_mm = 0.02 },
        ]
        [realise]
        waves = [3]
        realisations = 4
        seed = 5
        [bem]
        rubber = "rubber.toml"
        speeds_mm_s = [1.0, 100.0]
        area_fractions = [0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.2]
        field_area_fractions = [0.1]
        tolerance = 1e-3
        points_per_shortest_wavelength = 64
        "#,
    );
    let recipe = recipe(&campaign);
    let out = campaign.path("out");
    run(&recipe, &out);
    (campaign, recipe, RunView::of(out))
}

#[test]
fn every_solve_is_a_solution_and_the_curve_holds_between_them() {
    let (_campaign, recipe, view) = solved();
    let solves = view.rows(SOLVES).unwrap();
    let curves = view.rows(CURVES).unwrap();
    assert_eq!(curves.len(), 4 * 2 * 7);
    for row in &solves {
        assert!(row.residual <= 1e-10, "{row:?}");
        assert!((0.0..=1.0).contains(&row.contact_area_fraction), "{row:?}");
        // Fewer points in contact only at 16 times the points of the coarsest grid, 256.
        let contact_points = row.contact_area_fraction * row.grid_points as f64;
        assert!(contact_points >= 100.0 || row.grid_points == 4096, "{row:?}");
    }
    let rubber = read_rubber(&recipe.bem.as_ref().unwrap().rubber).unwrap();
    let surfaces = read_surfaces(&view).unwrap();
    for row in &curves {
        let same = |solve: &&SolveRow| {
            (solve.realisation, solve.speed_mm_s) == (row.realisation, row.speed_mm_s)
        };
        let (mut below, mut above) = (false, false);
        for solve in solves.iter().filter(same) {
            below |= solve.contact_area_fraction <= row.contact_area_fraction;
            above |= solve.contact_area_fraction >= row.contact_area_fraction;
        }
        assert!(below && above, "not bracketed: {row:?}");

        let nearest = solves.iter().filter(same).min_by(|a, b| {
            let far = |s: &SolveRow| (s.pressure_mpa / row.pressure_mpa).ln().abs();
            far(a).total_cmp(&far(b))
        });
        let points = nearest.unwrap().grid_points as usize;
        let Surface { profile, .. } =
            surfaces.iter().find(|surface| surface.realisation == row.realisation).unwrap();
        let heights = wave::sample(profile, 1e-3, points);
        let mut contact =
            SlidingContact::new(&rubber, row.speed_mm_s / 1e3, 1e-3, &heights).unwrap();
        let direct = contact.solve_for_area(row.contact_area_fraction, 1e-9).unwrap();
        // Twice the tolerance: the check that ended the sampling was made beside this area.
        let friction = direct.friction_coefficient;
        let error = (friction - row.friction_coefficient).abs();
        assert!(error <= 2.0 * TOLERANCE * friction, "{row:?}: direct {friction}");
        // The pressure has no tolerance of its own; the area is nearly proportional to it.
        let pressure = direct.mean_pressure / 1e6;
        approx::assert_relative_eq!(row.pressure_mpa, pressure, max_relative = 0.02);
    }
}

#[test]
fn tables_average_over_the_realisations() {
    let (_campaign, _, view) = solved();
    let curves = view.rows(CURVES).unwrap();
    let rows = view.rows(FRICTION).unwrap();
    assert_eq!(rows.len(), 2 * 7);
    for row in &rows {
        let of_row = |c: &&CurveRow| {
            (c.speed_mm_s, c.contact_area_fraction) == (row.speed_mm_s, row.contact_area_fraction)
        };
        let friction: Vec<f64> =
            curves.iter().filter(of_row).map(|c| c.friction_coefficient).collect();
        let estimate = MeanEstimate::of(&friction);
        assert_eq!(row.realisations, friction);
        assert_eq!(
            (row.mean, row.standard_deviation),
            (friction.iter().sum::<f64>() / 4.0, Some(estimate.standard_deviation))
        );
        // t(0.975, 3) = 3.18245 in every table.
        let half_width = 3.18245 * estimate.standard_deviation / 2.0;
        approx::assert_relative_eq!(row.confidence_95.unwrap(), half_width, max_relative = 1e-5);
    }
}

#[test]
fn fields_are_kept_at_the_wanted_areas() {
    let (_campaign, _, view) = solved();
    let datasets = view.read_arrays(FIELDS).unwrap();
    assert_eq!(datasets.len(), 4 * 2 * 2);
    for pair in datasets.chunks(2) {
        let [pressure, separation] = pair else { unreachable!("chunks of two") };
        let group = "waves_3/realisation_1/speed_1_mm_s/area_0.1/pressure";
        assert!(pressure.name != group || pressure.unit == "Pa", "{}", pressure.unit);
        assert!(pressure.name.ends_with("/pressure") && separation.name.ends_with("/separation"));
        assert_eq!(pressure.values.len(), separation.values.len());
        let mut touching = 0;
        for (t, u) in pressure.values.iter().zip(&separation.values) {
            // Closed to round-off against waves of 20 µm.
            let closed = *t == 0.0 || u.abs() < 1e-15;
            assert!(*t >= 0.0 && *u > -1e-15 && closed, "{t} Pa at a separation of {u} m");
            touching += usize::from(*t > 0.0);
        }
        let area = touching as f64 / pressure.values.len() as f64;
        // Counted in points, a contact is uncertain by one at each edge.
        assert!((area - 0.1).abs() < 0.02, "{area}");
    }
}

#[test]
fn a_wanted_accuracy_refines_the_grids_and_is_kept() {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "tolerance = 5e-3\npoints_per_shortest_wavelength = 16", "");
    campaign.edit("recipe.toml", "realisations = 2", "most_realisations = 2");
    let text = campaign.read("recipe.toml");
    let wanted = |tolerance: f64| {
        campaign.write("recipe.toml", &format!("tolerance = {tolerance}\n{text}"));
        let out = campaign.path(&format!("out_{tolerance}"));
        run(&recipe(&campaign), &out);
        let view = RunView::of(out);
        let curves = view.rows(CURVES).unwrap();
        let solves = view.rows(SOLVES).unwrap();
        (curves, solves.iter().map(|solve| solve.grid_points).sum::<u64>(), view)
    };
    let (coarse, points, view) = wanted(0.2);
    let (fine, more_points, _) = wanted(2e-3);
    assert!(points < more_points, "{points} and {more_points}");
    for (coarse, fine) in coarse.iter().zip(&fine) {
        let friction = coarse.friction_coefficient;
        let error = coarse.interpolation_error + coarse.discretisation_error.unwrap();
        assert!(error <= 0.5 * 0.2 * friction, "{coarse:?}");
        assert!((friction - fine.friction_coefficient).abs() <= error, "{coarse:?} {fine:?}");
    }
    // Two realisations are far from two in a thousand, and the tables say so.
    let rows = view.rows(FRICTION).unwrap();
    for row in &rows {
        let parts = row.confidence_95.unwrap() + row.interpolation_error;
        // Two realisations and three windows, independent of each other; grid and interpolation are what they are.
        let statistical =
            combined_95(&[(row.confidence_95.unwrap(), 1.0), (row.scan_error.unwrap(), 2.0)]);
        let sum = statistical + row.interpolation_error + row.discretisation_error.unwrap();
        approx::assert_relative_eq!(row.error_estimate.unwrap(), sum, max_relative = 1e-12);
        assert!(row.error_estimate.unwrap() > parts);
    }
    let fine = RunView::of(campaign.path("out_0.002"));
    let warnings = fine.stage_manifest("tables").unwrap().unwrap().warnings;
    assert!(warnings.iter().any(|w| w.contains("exceeds the tolerance 0.002")), "{warnings:?}");
}

/// Waves of 0.25 to 8 mm, the longest of next to no height and the shortest so low that it is pressed flat.
const SIX_WAVES: &str = r#"
        title = "Six given waves"
        TOLERANCE
        [[approximate.given]]
        source = "a test"
        scales = [
            { wavelength_mm = 0.25, amplitude_mm = 0.00001 },
            { wavelength_mm = 0.5, amplitude_mm = 0.01 },
            { wavelength_mm = 1.0, amplitude_mm = 0.02 },
            { wavelength_mm = 2.0, amplitude_mm = 0.03 },
            { wavelength_mm = 4.0, amplitude_mm = 0.04 },
            { wavelength_mm = 8.0, amplitude_mm = 0.0005 },
        ]
        [realise]
        waves = [6]
        REALISATIONS
        seed = 5
        [bem]
        rubber = "rubber.toml"
        speeds_mm_s = [1.0, 100.0]
        area_fractions = [0.05, 0.1]
"#;

#[test]
fn as_many_realisations_are_solved_as_the_average_needs_without_the_waves_that_do_not_matter() {
    let campaign = Campaign::new();
    let wanted = |tolerance: &str, realisations: &str| {
        let text = SIX_WAVES.replace("TOLERANCE", tolerance).replace("REALISATIONS", realisations);
        campaign.write("recipe.toml", &text);
        let out = campaign.path(&format!("out{}", realisations.len()));
        run(&recipe(&campaign), &out);
        let view = RunView::of(out);
        let rows = view.rows(FRICTION).unwrap();
        let counts = view.rows(REALISATIONS).unwrap();
        (rows, counts, view)
    };
    let (rows, counts, view) = wanted("tolerance = 0.05", "");
    for row in &rows {
        let error = row.error_estimate.unwrap();
        assert!(error <= 0.05 * row.mean, "{row:?}");
        // No more than they have to be: the last extension asked for a tenth more at least.
        assert!(row.realisations.len() < 1000);
    }
    for count in &counts {
        assert_eq!(count.with_all_waves, 8, "{count:?}");
        assert_eq!(count.left_out_wavelengths_mm, [0.25, 8.0], "{count:?}");
        assert!(count.realisations > 24, "{count:?}");
        let of = |row: &&FrictionRow| row.speed_mm_s == count.speed_mm_s;
        for row in rows.iter().filter(of) {
            assert_eq!(row.realisations.len(), count.realisations as usize);
        }
    }
    // The last realisations once more, with all waves: the change of the mean is within its bound.
    let count = counts.iter().map(|count| count.realisations).min().unwrap();
    let (all, _, full) = wanted("", &format!("realisations = {count}"));
    let reduced_curves = view.rows(CURVES).unwrap();
    let full_curves = full.rows(CURVES).unwrap();
    for row in &all {
        let mean = |curves: &[CurveRow]| {
            let of = |c: &&CurveRow| {
                (c.speed_mm_s, c.contact_area_fraction)
                    == (row.speed_mm_s, row.contact_area_fraction)
                    && c.realisation > 8
                    && c.realisation <= count
            };
            let of: Vec<&CurveRow> = curves.iter().filter(of).collect();
            let error: f64 = of.iter().map(|c| c.left_out_error + c.interpolation_error).sum();
            let grid: f64 = of.iter().map(|c| c.discretisation_error.unwrap()).sum();
            let friction: f64 = of.iter().map(|c| c.friction_coefficient).sum();
            (friction / of.len() as f64, (error + grid) / of.len() as f64)
        };
        let ((reduced, bound), (full, own)) = (mean(&reduced_curves), mean(&full_curves));
        assert!((reduced - full).abs() <= bound + own, "{reduced} {full} {bound} {own} {row:?}");
        assert!((reduced - full).abs() > 0.0);
    }
}

#[test]
fn a_limit_of_realisations_without_an_accuracy_is_refused_and_so_is_no_number_at_all() {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "realisations = 2", "most_realisations = 20");
    let message = Recipe::read(&campaign.path("recipe.toml")).unwrap_err().to_string();
    assert!(message.contains("realise.most_realisations = 20"), "{message}");
    campaign.edit("recipe.toml", "most_realisations = 20", "");
    let message = Recipe::read(&campaign.path("recipe.toml")).unwrap_err().to_string();
    assert!(message.contains("realise.realisations is missing: give a number"), "{message}");
}

#[test]
fn an_accuracy_beside_those_that_follow_from_it_is_refused() {
    let campaign = Campaign::new();
    let text = campaign.read("recipe.toml");
    campaign.write("recipe.toml", &format!("tolerance = 0.01\n{text}"));
    let message = Recipe::read(&campaign.path("recipe.toml")).unwrap_err().to_string();
    assert!(
        message.contains("tolerance = 0.01: must be given alone: leave out bem.tolerance"),
        "{message}"
    );
    campaign.edit("recipe.toml", "tolerance = 5e-3\n", "");
    let text = campaign.read("recipe.toml").replace("tolerance = 0.01\n", "");
    campaign.write("recipe.toml", &format!("tolerance = 2\n{text}"));
    let message = Recipe::read(&campaign.path("recipe.toml")).unwrap_err().to_string();
    assert!(message.contains("tolerance = 2") && message.contains("1e-8 and 0.5"), "{message}");
}
