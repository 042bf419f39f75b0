//! Contacts with their own heat and strain, beside those without.

use super::{Campaign, digests, recipe, run, try_run};
use asperity::artifact::RunView;
use asperity::contact::effective::{
    EffectiveContact, FeedbackContact, FeedbackSetup, HeatFeedback, StrainLaw,
};
use asperity::heat::{Thermal, ThermalSetting};
use asperity::numerics::Interrupt;
use asperity::numerics::statistics::MeanEstimate;
use asperity::pipeline::{self, Event, Selection};
use asperity::recipe::Recipe;
use asperity::rubber::payne::elongation_of_tensor_shear;
use asperity::rubber::read_rubber_at;
use asperity::stages::bem::{CURVES, REALISATIONS};
use asperity::stages::feedback::{self, CONTACTS, ContactRow, UNSOLVED};
use asperity::stages::realise::{Method, read_surfaces};
use asperity::stages::tables::{EFFECTS, Effect, FRICTION};
use asperity::surface::wave;

/// How the rubber of the campaign shifts and softens.
const LAWS: &str = "\n[temperature]\nreference_c = 20.0\nwlf = { c1 = 8.86, c2_k = 101.6 }\n\n[payne]\n\
    strain_kind = \"elongation\"\n[[payne.kraus]]\ncritical_strain = 0.01\nexponent = 0.6\nstorage_limit = 0.4\n\
    loss_limit = 0.4\nloss_peak = 0.2\nhighest_strain = 0.5\n";
const SECTION: &str = "\n[feedback]\nstrain = true\n\n[feedback.heat]\nconductivity_w_mk = 0.3\ndensity_kg_m3 = 1150\n\
    heat_capacity_j_kgk = 1500\nsliding_time_s = 0.02\n";
const ADHESION: &str = "\n[adhesion]\nlaw = \"gaussian\"\nshear_mpa = 1.5\nspeed_mm_s = 6.0\nwidth = 0.1\n\
    shortest_wavelength_mm = 0.5\n";

/// Two speeds and one pressure, of measured profiles.
fn campaign() -> Campaign {
    let campaign = Campaign::new();
    let rubber = campaign.read("rubber.toml");
    campaign.write("rubber.toml", &(rubber + LAWS));
    campaign.edit(
        "recipe.toml",
        "waves = [3]\nrealisations = 2\nseed = 1",
        "methods = [\"measured\"]",
    );
    campaign.edit("recipe.toml", "area_fractions = [0.02, 0.05, 0.1]", "area_fractions = []");
    campaign.edit(
        "recipe.toml",
        "tolerance = 5e-3",
        "pressures_mpa = [0.05]\ntemperature_c = 25.0",
    );
    campaign.edit("recipe.toml", "[10.0]", "[10.0, 1000.0]");
    let text = campaign.read("recipe.toml");
    campaign.write("recipe.toml", &(text + SECTION));
    campaign
}

fn warnings(view: &RunView, stage: &str) -> String {
    view.stage_manifest(stage).unwrap().unwrap().warnings.join("\n")
}

#[test]
fn cold_contacts_are_those_of_bem() {
    let campaign = campaign();
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let (contacts, curves) = (view.rows(CONTACTS).unwrap(), view.rows(CURVES).unwrap());
    let cold: Vec<&ContactRow> = contacts.iter().filter(|row| row.effect == Effect::Cold).collect();
    assert_eq!((cold.len(), curves.len(), contacts.len()), (6, 6, 24));
    for (cold, curve) in cold.iter().zip(&curves) {
        assert_eq!((cold.kind, cold.realisation), (curve.kind, curve.realisation));
        assert_eq!(cold.speed_mm_s, curve.speed_mm_s);
        assert_eq!(cold.friction_coefficient, curve.friction_coefficient);
        assert_eq!(cold.contact_area_fraction, curve.contact_area_fraction);
        assert_eq!(cold.discretisation_error, curve.discretisation_error);
        assert_eq!(cold.relative_area_error, curve.relative_area_error);
    }
    let (effects, friction) = (view.rows(EFFECTS).unwrap(), view.rows(FRICTION).unwrap());
    let order: Vec<(f64, Effect)> =
        effects.iter().map(|row| (row.speed_mm_s, row.effect)).collect();
    let expected = [10.0, 1000.0].map(|speed| Effect::ALL.map(|effect| (speed, effect)));
    assert_eq!(order, expected.concat());
    for row in &friction {
        let same = |e: &&asperity::stages::tables::EffectRow| {
            e.effect == Effect::Cold && e.speed_mm_s == row.speed_mm_s
        };
        let cold = effects.iter().find(same).unwrap();
        assert_eq!((cold.hysteretic, cold.confidence_95), (row.mean, row.confidence_95));
        assert_eq!(cold.error_estimate, row.error_estimate);
        assert_eq!((cold.windows, &cold.realisations), (row.windows, &row.realisations));
        assert_eq!((cold.contact_rise_k, cold.total, cold.adhesive), (None, None, None));
    }
}

/// The contact of the first profile by the library alone, sought from the cold one.
fn alone(campaign: &Campaign, row: &ContactRow, stress: f64) -> EffectiveContact {
    let view = RunView::of(campaign.path("out"));
    let surfaces = read_surfaces(&view).unwrap();
    let surface = surfaces.iter().find(|surface| surface.realisation == row.realisation).unwrap();
    let material = read_rubber_at(campaign.path("rubber.toml"), Some(25.0)).unwrap();
    let (law, payne) = (material.temperature.clone().unwrap(), material.payne_law().unwrap());
    let period = surface.period();
    let heights = wave::sample(&surface.profile, period, row.grid_points as usize);
    let rubber = Thermal { conductivity: 0.3, density: 1150.0, heat_capacity: 1500.0 };
    let thermal = ThermalSetting { rubber, duration: 0.02, shear_stress: stress, road: None };
    let heat = HeatFeedback { thermal, law: &law, temperature_c: 25.0 };
    let strain: &dyn StrainLaw = &payne;
    let speed = row.speed_mm_s / 1e3;
    let setup = FeedbackSetup {
        heat: row.effect.has_heat().then_some(heat),
        strain: row.effect.has_strain().then_some(strain),
        ..FeedbackSetup::new(&material.rubber, speed, period, &heights)
    };
    FeedbackContact::new(setup).unwrap().solve_effective(row.pressure_mpa * 1e6).unwrap()
}

#[test]
fn every_effect_is_that_of_its_contact_alone() {
    let campaign = campaign();
    let text = campaign.read("recipe.toml");
    campaign.write("recipe.toml", &(text + ADHESION));
    run(&recipe(&campaign), &campaign.path("out"));
    let contacts = RunView::of(campaign.path("out")).rows(CONTACTS).unwrap();
    let mut compared = 0;
    for row in contacts.iter().filter(|row| row.effect != Effect::Cold && row.realisation == 1) {
        let stress = 1.5 * (-0.1 * (row.speed_mm_s / 6.0).log10().powi(2)).exp();
        let found = alone(&campaign, row, stress * 1e6);
        let same = |a: f64, b: f64| approx::assert_relative_eq!(a, b, max_relative = 2e-5);
        same(row.friction_coefficient, found.solution.friction_coefficient);
        same(row.contact_area_fraction, found.solution.contact_area_fraction);
        assert_eq!(row.shear_mpa.is_some(), row.effect.has_heat());
        assert_eq!(row.largest_strain.is_some(), row.effect.has_strain());
        if let Some(heat) = found.heat {
            same(row.contact_rise_k.unwrap(), heat.contact_mean);
            same(row.highest_rise_k.unwrap(), heat.highest);
            same(row.shear_mpa.unwrap(), stress);
        }
        if let Some(strain) = row.largest_strain {
            let largest = found.strain.iter().copied().fold(0.0, f64::max);
            same(strain, elongation_of_tensor_shear(largest));
        }
        compared += 1;
    }
    assert_eq!(compared, 6);
    // Softer rubber has more contact, and warm rubber at speed too.
    let area = |effect: Effect| {
        let own = |row: &&ContactRow| row.effect == effect && row.speed_mm_s == 1000.0;
        contacts.iter().find(own).unwrap().contact_area_fraction
    };
    let [cold, soft, hot, both] = Effect::ALL.map(area);
    assert!(cold < hot && cold < soft && soft < both && hot < both, "{cold} {soft} {hot} {both}");
}

#[test]
fn averages_and_errors_are_sums_over_the_surfaces() {
    let campaign = campaign();
    let text = campaign.read("recipe.toml");
    campaign.write("recipe.toml", &(text + ADHESION));
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let (contacts, effects) = (view.rows(CONTACTS).unwrap(), view.rows(EFFECTS).unwrap());
    assert_eq!(effects.len(), 8);
    for row in &effects {
        let own =
            contacts.iter().filter(|c| (c.effect, c.speed_mm_s) == (row.effect, row.speed_mm_s));
        let own: Vec<&ContactRow> = own.collect();
        let mean = |of: &dyn Fn(&ContactRow) -> f64| {
            own.iter().map(|c| of(c)).sum::<f64>() / own.len() as f64
        };
        let stress = 1.5 * (-0.1 * (row.speed_mm_s / 6.0).log10().powi(2)).exp();
        let adhesive = |c: &ContactRow| stress * c.contact_area_fraction / c.pressure_mpa;
        let same = |a: f64, b: f64| approx::assert_relative_eq!(a, b, max_relative = 1e-9);
        same(row.hysteretic, mean(&|c| c.friction_coefficient));
        same(row.contact_area_fraction, mean(&|c| c.contact_area_fraction));
        same(row.adhesive.unwrap(), mean(&adhesive));
        same(row.total.unwrap(), row.hysteretic + row.adhesive.unwrap());
        same(row.discretisation_error.unwrap(), mean(&|c| c.discretisation_error.unwrap()));
        same(row.relative_area_error.unwrap(), mean(&|c| c.relative_area_error.unwrap()));
        let sums: Vec<f64> = own.iter().map(|c| c.friction_coefficient + adhesive(c)).collect();
        let grid = |c: &ContactRow| {
            c.discretisation_error.unwrap() + c.relative_area_error.unwrap() * adhesive(c)
        };
        let error = MeanEstimate::of(&sums).confidence_95 + mean(&grid);
        same(row.error_estimate.unwrap(), error);
        same(row.confidence_95.unwrap(), MeanEstimate::of(&row.realisations).confidence_95);
        assert_eq!(row.contact_rise_k.is_some(), row.effect.has_heat());
        if row.effect.has_heat() {
            same(row.contact_rise_k.unwrap(), mean(&|c| c.contact_rise_k.unwrap()));
        }
    }
    // The power of the shear stress heats the contact: without it the rise is less.
    let rise = |view: &RunView| {
        let rows = view.rows(EFFECTS).unwrap();
        let hot = rows.iter().find(|row| row.effect == Effect::Hot && row.speed_mm_s == 1000.0);
        hot.unwrap().contact_rise_k.unwrap()
    };
    let with = rise(&view);
    campaign.edit("recipe.toml", ADHESION, "");
    run(&recipe(&campaign), &out);
    assert!(rise(&view) < with, "{} {with}", rise(&view));
}

#[test]
fn a_run_that_was_interrupted_ends_as_one_that_was_not() {
    let campaign = campaign();
    let recipe = recipe(&campaign);
    run(&recipe, &campaign.path("whole"));
    let (out, interrupt) = (campaign.path("out"), Interrupt::default());
    let error = pipeline::run(&recipe, &out, Selection::default(), &interrupt, &|event| {
        // Two of six surfaces and speeds are done.
        if matches!(event, Event::Progress(stage, 2, _) if stage == feedback::STAGE) {
            interrupt.set();
        }
    })
    .unwrap_err();
    assert!(error.is_interrupt(), "{error}");
    assert!(!out.join("feedback").exists() && out.join("solves").is_dir());
    run(&recipe, &out);
    assert_eq!(digests(&out), digests(&campaign.path("whole")));
}

/// Measured shift factors are not extrapolated.
#[test]
fn a_contact_that_the_rubber_is_not_known_at_has_no_number() {
    let campaign = campaign();
    campaign.edit(
        "rubber.toml",
        "reference_c = 20.0\nwlf = { c1 = 8.86, c2_k = 101.6 }",
        "reference_c = 25.0\nshift = [{ temperature_c = 15, log10_shift = 0.8 }, { temperature_c = 25, log10_shift = 0 }, \
         { temperature_c = 25.05, log10_shift = -0.003 }]",
    );
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let unsolved = view.rows(UNSOLVED).unwrap();
    // The hot contacts and those that are both, of three profiles at the higher speed.
    assert_eq!(unsolved.len(), 6);
    for row in &unsolved {
        assert!(row.effect.has_heat() && row.speed_mm_s == 1000.0, "{row:?}");
        assert!(row.reason.contains("no shift factor at"), "{row:?}");
    }
    let effects = view.rows(EFFECTS).unwrap();
    let has = |effect, speed| effects.iter().any(|r| (r.effect, r.speed_mm_s) == (effect, speed));
    assert!(has(Effect::Hot, 10.0) && has(Effect::Cold, 1000.0) && has(Effect::Soft, 1000.0));
    for row in &unsolved {
        assert!(!has(row.effect, row.speed_mm_s));
    }
    let told = warnings(&view, "feedback");
    let count = "6 of 24 contacts have no solution (unsolved.arrow)";
    assert!(told.contains(count), "{told}");
    // Where nothing else was asked for, that is an error.
    campaign.edit("recipe.toml", "[10.0, 1000.0]", "[1000.0]");
    campaign.edit("recipe.toml", "strain = true", "strain = false");
    let error = try_run(&recipe(&campaign), &out, Selection::default()).unwrap_err().to_string();
    assert!(error.contains("no contact has a solution with its own heat or strain"), "{error}");
}

#[test]
fn sines_that_are_drawn_for_an_accuracy_are_those_of_bem() {
    let campaign = campaign();
    campaign.edit("recipe.toml", "methods = [\"measured\"]", "waves = [2]\nseed = 1");
    campaign.edit("recipe.toml", "title = \"Small campaign\"", "title = \"x\"\ntolerance = 0.4");
    campaign.edit("recipe.toml", "strain = true", "strain = true\nspeeds_mm_s = [1000.0, 2000.0]");
    let heat = SECTION.split("\n\n[feedback.heat]").nth(1).unwrap();
    campaign.edit("recipe.toml", &format!("[feedback.heat]{heat}"), "");
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let realisations = view.rows(REALISATIONS).unwrap();
    let of_speed = |speed| realisations.iter().find(|row| row.speed_mm_s == speed).unwrap();
    let most = realisations.iter().map(|row| row.realisations).max().unwrap() as usize;
    let contacts = view.rows(CONTACTS).unwrap();
    let count = |speed| {
        let own = |row: &&ContactRow| row.speed_mm_s == speed && row.effect == Effect::Soft;
        contacts.iter().filter(own).count()
    };
    assert_eq!(count(1000.0), of_speed(1000.0).realisations as usize);
    assert_eq!((count(2000.0), count(10.0)), (most, 0));
    // The scans are a part of the error where bem has the speed too.
    let effects = view.rows(EFFECTS).unwrap();
    for row in &effects {
        assert_eq!(row.error_estimate.is_some(), row.speed_mm_s == 1000.0, "{row:?}");
    }
}

#[test]
fn only_the_surfaces_that_are_named_are_solved() {
    let campaign = campaign();
    let all = "methods = [\"measured\", \"sines\"]\ndirections = [\"forward\", \"backward\"]\nperiodic = \"blend\"\n\
         waves = [2]\nrealisations = 1\nseed = 1";
    campaign.edit("recipe.toml", "methods = [\"measured\"]", all);
    let (_, heat) = SECTION.split_once("[feedback.heat]").unwrap();
    campaign.edit("recipe.toml", &format!("[feedback.heat]{heat}"), "");
    campaign.edit("recipe.toml", "strain = true", "strain = true\nmethods = [\"measured\"]");
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let contacts = RunView::of(&out).rows(CONTACTS).unwrap();
    let count = |method| contacts.iter().filter(|row| row.kind.method == method).count();
    // Three profiles, two speeds, cold and soft, in each direction.
    let found = [Method::Measured, Method::MeasuredBackward, Method::Sines].map(count);
    assert_eq!(found, [12, 12, 0]);
}

#[test]
fn recipes_that_do_not_hold_are_named() {
    let campaign = campaign();
    let text = campaign.read("recipe.toml");
    let cases = [
        (SECTION, "\n[feedback]\n", "feedback.strain is missing: [feedback] asks for nothing"),
        (
            "area_fractions = []\npressures_mpa = [0.05]",
            "area_fractions = [0.05]",
            "bem.pressures_mpa is missing",
        ),
        ("temperature_c = 25.0", "", "bem.temperature_c is missing: [feedback.heat]"),
        (
            "strain = true",
            "strain = true\nspeeds_mm_s = [1.0, 1.0]",
            "feedback.speeds_mm_s = [1.0, 1.0]: must be",
        ),
        (
            "strain = true",
            "strain = true\nmethods = [\"sines\"]",
            "feedback.methods = [\"sines\"]: must be profiles of realise.methods",
        ),
        ("sliding_time_s = 0.02", "", "feedback.heat.sliding_time_s is missing"),
        (
            "sliding_time_s = 0.02",
            "sliding_time_s = 0.02\nsliding_distance_mm = 20",
            "feedback.heat.sliding_time_s = 0.02: must be left out beside sliding_distance_mm",
        ),
        ("time_s = 0.02", "time_s = -1", "feedback.heat.sliding_time_s = -1: must be from"),
        ("= 0.3\ndensity", "= 300\ndensity", "feedback.heat.conductivity_w_mk = 300: must be"),
        ("m3 = 1150", "m3 = 1.15", "density_kg_m3 = 1.15: must be from 100 to 5000 kg/m³"),
        ("kgk = 1500", "kgk = 1.5", "feedback.heat.heat_capacity_j_kgk = 1.5: must be"),
        (
            "sliding_time_s = 0.02",
            "sliding_time_s = 0.02\nroad = { conductivity_w_mk = 2.5, density_kg_m3 = 2.7, heat_capacity_j_kgk = 850 }",
            "feedback.heat.road.density_kg_m3 = 2.7: must be",
        ),
        ("kgk = 1500", "kgK = 1500", "heat_capacity_j_kgk"),
        (
            "methods = [\"measured\"]",
            "methods = [\"isotropic\"]\nseed = 1\nareal_realisations = 1\nisotropic_period_mm = 8.0",
            "must be left out where no profile is made: heat and softening are for profiles",
        ),
    ];
    for (from, to, part) in cases {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        let path = campaign.path("recipe.toml");
        let message = Recipe::parse(&text.replace(from, to), &path).unwrap_err().to_string();
        assert!(message.contains(part), "{to}: {message}");
    }
}

#[test]
fn a_table_of_shear_stresses_must_cover_the_speeds_of_the_section() {
    let campaign = campaign();
    let text = campaign.read("recipe.toml")
        + "\n[adhesion]\nlaw = \"table\"\npoints = [[1.0, 1.0], [2000.0, 2.0]]\nshortest_wavelength_mm = 0.5\n";
    let path = campaign.path("recipe.toml");
    Recipe::parse(&text, &path).unwrap();
    let faster = text.replace("strain = true", "strain = true\nspeeds_mm_s = [5000.0]");
    let message = Recipe::parse(&faster, &path).unwrap_err().to_string();
    assert!(message.contains("feedback.speeds_mm_s = [5000.0]: must be within"), "{message}");
}

#[test]
fn a_rubber_without_the_law_is_refused_before_anything_is_solved() {
    let campaign = campaign();
    let rubber = campaign.read("rubber.toml");
    let refused = |part: &str| {
        let out = campaign.path("out");
        let error = try_run(&recipe(&campaign), &out, Selection::default()).unwrap_err();
        let reason = std::error::Error::source(&error).and_then(std::error::Error::source);
        let message = format!("{error}: {}", reason.map(ToString::to_string).unwrap_or_default());
        assert!(message.contains(part), "{message}");
        assert!(!out.join("bem").exists());
    };
    let (without_payne, _) = rubber.split_once("[payne]").unwrap();
    campaign.write("rubber.toml", without_payne);
    refused("rubber.toml: feedback.strain needs a rubber whose softening with strain is known");
    let (without_any, _) = rubber.split_once("[temperature]").unwrap();
    campaign.write("rubber.toml", without_any);
    refused("[temperature]");
}

#[test]
fn isothermal_tables_say_so_once() {
    let campaign = campaign();
    let (out, heat) = (campaign.path("out"), &SECTION[SECTION.find("[feedback.heat]").unwrap()..]);
    let view = RunView::of(&out);
    let told = || warnings(&view, "tables").matches("isothermal also above 0.1 m/s").count();
    run(&recipe(&campaign), &out);
    assert_eq!(told(), 0);
    campaign.edit("recipe.toml", heat, "");
    run(&recipe(&campaign), &out);
    assert_eq!(told(), 1);
    campaign.edit("recipe.toml", "\n[feedback]\nstrain = true\n", "");
    run(&recipe(&campaign), &out);
    assert_eq!(told(), 1);
    campaign.edit("recipe.toml", "[10.0, 1000.0]", "[10.0, 100.0]");
    run(&recipe(&campaign), &out);
    assert_eq!(told(), 0);
    // An elastic body has no loss, and makes no heat.
    campaign.edit("recipe.toml", "[10.0, 100.0]", "[10.0, 1000.0]");
    campaign.edit("recipe.toml", "\ntemperature_c = 25.0", "");
    campaign.write(
        "rubber.toml",
        "name = \"e\"\nequilibrium_modulus_mpa = 4.0\npoisson_ratio = 0.49\n",
    );
    run(&recipe(&campaign), &out);
    assert_eq!(told(), 0);
}
