//! The shear stress of the contact area in the tables.

use super::{Campaign, recipe, run, stale};
use asperity::artifact::RunView;
use asperity::recipe::Recipe;
use asperity::stages;
use asperity::stages::bem::{CURVES, Given};
use asperity::stages::tables::{FRICTION, TOTAL};

const SECTION: &str = "[adhesion]\nlaw = \"gaussian\"\nshear_mpa = 6.5\nspeed_mm_s = 6.0\nwidth = 0.1\n\
     shortest_wavelength_mm = 0.25\n";

fn with_adhesion(campaign: &Campaign) -> Recipe {
    let text = campaign.read("recipe.toml");
    if !text.contains("[adhesion]") {
        let pressures = text.replace("[bem]\n", "[bem]\npressures_mpa = [0.3]\n");
        campaign.write("recipe.toml", &(pressures + "\n" + SECTION));
    }
    recipe(campaign)
}

/// The mean of shear stress times area over pressure, realisation by realisation, and the sum of both frictions.
#[test]
fn the_total_is_hysteresis_and_shear_of_the_area_of_every_realisation() {
    let campaign = Campaign::new();
    let out = campaign.path("out");
    run(&with_adhesion(&campaign), &out);
    let view = RunView::of(&out);
    let (totals, friction) = (view.rows(TOTAL).unwrap(), view.rows(FRICTION).unwrap());
    let curves = view.rows(CURVES).unwrap();
    assert_eq!(totals.len(), friction.len());
    assert!(totals.iter().any(|row| row.given == Given::Pressure));
    for (total, row) in totals.iter().zip(&friction) {
        let decades = (total.speed_mm_s / 6.0).log10();
        let stress = 6.5 * (-0.1 * decades * decades).exp();
        approx::assert_relative_eq!(total.shear_mpa, stress, max_relative = 1e-12);
        let own = curves.iter().filter(|c| {
            c.kind == total.kind
                && c.speed_mm_s == total.speed_mm_s
                && c.given == total.given
                && match c.given {
                    Given::Area => c.contact_area_fraction == row.contact_area_fraction,
                    Given::Pressure => c.pressure_mpa == row.pressure_mpa,
                }
        });
        let ratios: Vec<f64> = own.map(|c| c.contact_area_fraction / c.pressure_mpa).collect();
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        approx::assert_relative_eq!(total.adhesive, stress * mean, max_relative = 1e-10);
        approx::assert_relative_eq!(
            total.total,
            total.hysteretic + total.adhesive,
            max_relative = 1e-12
        );
        assert_eq!(total.hysteretic, row.mean);
        // The error of the area by the grid is part of the error of the total.
        let known = total.error_estimate.zip(total.confidence_95);
        assert!(known.is_none_or(|(all, scatter)| all >= scatter), "{total:?}");
    }
    // The waves of the campaign end elsewhere than those of the law.
    let warnings = view.stage_manifest("tables").unwrap().unwrap().warnings;
    assert!(
        warnings.iter().any(|w| w.contains("belongs to a shortest wavelength of 0.25 mm")),
        "{warnings:?}"
    );
}

#[test]
fn the_section_concerns_the_tables_alone() {
    let campaign = Campaign::new();
    let out = campaign.path("out");
    let text = campaign.read("recipe.toml");
    run(&recipe(&campaign), &out);
    campaign.write("recipe.toml", &(text + "\n" + SECTION));
    let recipe = recipe(&campaign);
    let stale = stale(&recipe, &out);
    assert_eq!((stale.len(), stale[0].0), (1, stages::tables::STAGE), "{stale:?}");
    assert_eq!(run(&recipe, &out), [stages::tables::STAGE]);
    assert!(RunView::of(&out).path_of(TOTAL).exists());
}

#[test]
fn a_law_that_shifts_with_temperature_needs_one() {
    let campaign = Campaign::new();
    let text = campaign.read("recipe.toml")
        + "\n"
        + SECTION
        + "activation_ev = 0.97\nreference_c = 20.0\n";
    let error = Recipe::parse(&text, &campaign.path("recipe.toml")).unwrap_err().to_string();
    assert!(error.contains("bem.temperature_c is missing"), "{error}");
}
