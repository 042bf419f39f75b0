//! The road that was scanned: its windows as surfaces, beside other surfaces with their spectrum.

use super::{Campaign, recipe, run, try_run};
use asperity::artifact::RunView;
use asperity::numerics::statistics::combined_95;
use asperity::pipeline::Selection;
use asperity::recipe::Recipe;
use asperity::stages::bem::{CURVES, Given, SCAN_ERRORS};
use asperity::stages::hybrid::HYBRID;
use asperity::stages::micro::SAMPLES;
use asperity::stages::realise::{Method, PROFILES, SurfaceKind, read_surfaces};
use asperity::stages::tables::{BUDGET, FRICTION, FrictionRow, METHODS, Model, Part};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;

const ALL: &str = r#"methods = ["measured", "matched", "random-phase", "sines"]"#;

fn with(realise: &str) -> Campaign {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "[realise]", &format!("[realise]\n{realise}"));
    campaign
}

fn error(campaign: &Campaign) -> String {
    Recipe::read(&campaign.path("recipe.toml")).unwrap_err().to_string()
}

#[test]
fn all_surfaces_of_a_road_go_through_the_chain_side_by_side() {
    let campaign = with(ALL);
    campaign.edit("recipe.toml", "[bem]", "[bem]\npressures_mpa = [0.1, 0.3]");
    campaign.edit("recipe.toml", "realisations = 2", "realisations = 6");
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let profiles = view.rows(PROFILES).unwrap();
    let of = |method| profiles.iter().filter(move |row| row.kind.method == method);
    assert_eq!(of(Method::Measured).count(), 3);
    assert_eq!((of(Method::Matched).count(), of(Method::RandomPhase).count()), (6, 6));
    for row in &profiles {
        // Windows of 8 mm with missing points, mirrored.
        assert!((row.period_mm - 16.0).abs() < 0.1 && row.filled > 0.0, "{row:?}");
        assert!((0.499..0.52).contains(&row.shortest_wavelength_mm), "{row:?}");
        let measured = of(Method::Measured).find(|other| other.window == row.window).unwrap();
        // The spectrum is that of the window, whatever the phases.
        assert!((row.rms_height_mm / measured.rms_height_mm - 1.0).abs() < 1e-9);
        assert!((row.rms_slope / measured.rms_slope - 1.0).abs() < 1e-9);
    }
    let rows = view.rows(FRICTION).unwrap();
    // Three areas and two pressures of four kinds.
    assert_eq!(rows.len(), 20);
    for row in &rows {
        let pressures = [0.1, 0.3];
        match row.given {
            Given::Area => assert!([0.02, 0.05, 0.1].contains(&row.contact_area_fraction)),
            Given::Pressure => assert!(pressures.contains(&row.pressure_mpa)),
        }
        assert!(row.mean > 0.0 && row.windows == 3, "{row:?}");
        assert_eq!(row.scan_error == Some(0.0), row.kind.method != Method::Sines);
        assert!(row.error_estimate.is_some_and(|error| error > 0.0), "{row:?}");
    }
    // Six draws of three windows are three scans.
    let draws = rows.iter().find(|row| row.kind.method == Method::Matched).unwrap();
    let by_draw = 2.571 * draws.standard_deviation.unwrap() / 6.0_f64.sqrt();
    assert_eq!(draws.realisations.len(), 6);
    assert!((draws.confidence_95.unwrap() / by_draw - 1.0).abs() > 0.05);
    let methods = view.rows(METHODS).unwrap();
    assert_eq!(methods.len(), rows.len());
    for (compared, row) in methods.iter().zip(&rows) {
        let same = |other: &&FrictionRow| {
            other.kind == SurfaceKind::of(Method::Measured)
                && other.given == row.given
                && match row.given {
                    Given::Area => other.contact_area_fraction == row.contact_area_fraction,
                    Given::Pressure => other.pressure_mpa == row.pressure_mpa,
                }
        };
        let measured = rows.iter().find(same).unwrap();
        assert_eq!(compared.ratio_to_measured, row.mean / measured.mean);
    }
    let budget = view.rows(BUDGET).unwrap();
    let first_of_measured = budget.iter().find(|row| row.kind.method == Method::Measured).unwrap();
    // What the half-space leaves out is not known without finite elements.
    assert_eq!((first_of_measured.part, first_of_measured.rank), (Part::Model, 1));
    assert!(
        !budget.iter().any(|row| row.kind.method == Method::Measured && row.part == Part::Phases)
    );
    let errors = view.rows(SCAN_ERRORS).unwrap();
    assert!(errors.len() == 5 && errors.iter().all(|row| row.groups == 3), "{errors:?}");
}

#[test]
fn a_value_at_a_pressure_is_that_of_the_contact_itself() {
    let campaign = with("methods = [\"measured\"]");
    campaign.edit("recipe.toml", "waves = [3]\n", "");
    campaign.edit("recipe.toml", "seed = 1\n", "");
    campaign.edit(
        "recipe.toml",
        "area_fractions = [0.02, 0.05, 0.1]",
        "area_fractions = []\npressures_mpa = [0.2]",
    );
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let curves = view.rows(CURVES).unwrap();
    assert_eq!(curves.len(), 3);
    let solves = view.rows(asperity::stages::bem::SOLVES).unwrap();
    for row in &curves {
        assert_eq!(
            (row.given, row.pressure_mpa, row.interpolation_error),
            (Given::Pressure, 0.2, 0.0)
        );
        let own = solves.iter().filter(|solve| solve.realisation == row.realisation);
        let finest = own.max_by_key(|solve| solve.grid_points).unwrap();
        assert_eq!(row.contact_area_fraction, finest.contact_area_fraction);
    }
}

#[test]
fn a_road_has_two_directions_and_its_mirror_image_one() {
    let campaign = with(
        "methods = [\"measured\", \"sines\"]\nperiodic = \"blend\"\ndirections = [\"forward\", \"backward\"]",
    );
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let surfaces = read_surfaces(&view).unwrap();
    let of = |method: Method| surfaces.iter().filter(move |surface| surface.kind.method == method);
    for (ahead, back) in of(Method::Measured).zip(of(Method::MeasuredBackward)) {
        let period = ahead.period();
        assert!(period < 8e-3 && period == back.period());
        let height = |profile: &[asperity::surface::Wave], x: f64| -> f64 {
            profile.iter().map(|wave| wave.height(x)).sum()
        };
        for k in 0..50 {
            let x = period * f64::from(k) / 50.0;
            assert!((height(&ahead.profile, x) - height(&back.profile, period - x)).abs() < 1e-15);
        }
    }
    let rows = view.rows(FRICTION).unwrap();
    let mean = |method| rows.iter().find(|row| row.kind.method == method).unwrap().mean;
    let (ahead, back) = (mean(Method::Measured), mean(Method::MeasuredBackward));
    assert!((ahead / back - 1.0).abs() > 1e-6, "{ahead} {back}");
}

#[test]
fn contradictions_of_the_section_are_named() {
    let refused = |realise: &str, expected: &[&str]| {
        let message = error(&with(realise));
        assert!(expected.iter().all(|text| message.contains(text)), "{message}");
    };
    refused("methods = []", &["realise.methods"]);
    refused("methods = [\"sines\", \"sines\"]", &["realise.methods", "each once"]);
    refused("methods = [\"measured-backward\", \"sines\"]", &["realise.directions"]);
    refused("methods = [\"measured\"]", &["realise.waves", "none without it"]);
    refused(
        "directions = [\"backward\"]\nperiodic = \"blend\"",
        &["realise.directions", "measured"],
    );
    refused(
        "methods = [\"measured\", \"sines\"]\ndirections = [\"forward\", \"backward\"]",
        &["blend"],
    );
    refused("methods = [\"measure\", \"sines\"]", &["measure", "methods"]);
    refused("longest_gap_mm = 1.0", &["realise.longest_gap_mm"]);
    refused("methods = [\"measured\", \"sines\"]\nmost_windows = 0", &["realise.most_windows"]);
}

#[test]
fn windows_with_long_gaps_are_left_out_and_named() {
    let campaign = with("methods = [\"measured\", \"sines\"]\nlongest_gap_mm = 0.1");
    // A gap of 0.25 mm in one of the three.
    let text = campaign.read("scans/track_1.txt");
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for line in &mut lines[100..110] {
        let (x, _) = line.split_once(';').unwrap();
        *line = format!("{x};BAD");
    }
    campaign.write("scans/track_1.txt", &(lines.join("\n") + "\n"));
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    assert_eq!(view.rows(PROFILES).unwrap().len(), 2);
    let warnings = view.stage_manifest("realise").unwrap().unwrap().warnings;
    assert!(
        warnings[0].contains("1 of 3 windows") && warnings[0].contains("track_1"),
        "{warnings:?}"
    );
    // Where all have one there is nothing to solve.
    campaign.edit("recipe.toml", "longest_gap_mm = 0.1", "longest_gap_mm = 0.01");
    let error = try_run(&recipe(&campaign), &out, Selection::default()).unwrap_err().to_string();
    assert!(error.contains("realise.longest_gap_mm") && error.contains("track_0"), "{error}");
}

#[test]
fn the_microscale_of_windows_is_that_of_stretches_with_an_error() {
    let campaign = with("methods = [\"measured\"]");
    campaign.edit("recipe.toml", "waves = [3]\n", "");
    campaign.edit("recipe.toml", "area_fractions = [0.02, 0.05, 0.1]", "area_fractions = [0.1]");
    let micro = "\n[micro]\nrms_slope_threshold = 0.08\nstretches = 3\nestimate_mesh_error = false\n\
                 columns_per_shortest_wavelength = 24\ntolerance = 0.05\n";
    campaign.write("recipe.toml", &(campaign.read("recipe.toml") + micro));
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let samples = view.rows(SAMPLES).unwrap();
    let stretches: std::collections::BTreeSet<(Method, u32)> =
        samples.iter().map(|row| (row.kind.method, row.stretch)).collect();
    let expected = [(Method::Measured, 1), (Method::Measured, 2), (Method::Measured, 3)];
    assert!(expected.iter().all(|of| stretches.contains(of)), "{stretches:?}");
    let hybrid = view.rows(HYBRID).unwrap();
    let measured: Vec<_> =
        hybrid.iter().filter(|row| row.kind.method == Method::Measured).collect();
    assert_eq!(measured.len(), 3);
    for row in measured {
        assert!(row.microscale_error.is_some_and(|error| error > 0.0), "{row:?}");
        assert!(row.friction_coefficient.is_some_and(|friction| friction > 0.0));
        assert_ne!(row.friction_coefficient, Some(row.friction_half_space));
    }
    let rows = view.rows(FRICTION).unwrap();
    let own =
        |row: &&FrictionRow| row.model == Model::Hybrid && row.kind.method == Method::Measured;
    assert!(rows.iter().find(own).unwrap().microscale_error.unwrap() > 0.0);
}

/// Three sections of the road of the validation set, as `measured_against_random_phases.py` has them: friction and contact
/// area at 0.3 MPa and 20 °C over the measured profile.
const SECTIONS: [(usize, [(f64, f64); 2]); 3] = [
    (0, [(0.0327, 0.249), (0.0713, 0.115)]),
    (5, [(0.0451, 0.217), (0.111, 0.086)]),
    (10, [(0.144, 0.109), (0.390, 0.031)]),
];

#[test]
fn the_ratios_of_the_validation_road_come_out_of_one_recipe() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/validation");
    let road = shared.join("idiada_road_profile.csv");
    if !road.exists() {
        println!("skipped: {} is not there", road.display());
        return;
    }
    let campaign = Campaign::new();
    std::fs::remove_dir_all(campaign.path("scans")).unwrap();
    std::fs::create_dir(campaign.path("scans")).unwrap();
    let text = std::fs::read_to_string(&road).unwrap();
    let lines: Vec<&str> = text.lines().skip(5).filter(|line| !line.trim().is_empty()).collect();
    let points = (24.0 / 2.67069e-3) as usize;
    for (section, _) in SECTIONS {
        let first = section * (lines.len() / 12);
        campaign.write(
            &format!("scans/section_{section:02}.csv"),
            &lines[first..first + points].join("\n"),
        );
    }
    campaign.write("rubber.toml", &s100(&shared));
    campaign.write("recipe.toml", VALIDATION);
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let curves = RunView::of(&out).rows(CURVES).unwrap();
    let kind = SurfaceKind::of(Method::Measured);
    for (speed, mm_s) in [0.01, 1000.0].into_iter().enumerate() {
        let own: Vec<_> =
            curves.iter().filter(|row| row.kind == kind && row.speed_mm_s == mm_s).collect();
        for (row, (section, expected)) in own.iter().zip(SECTIONS) {
            let (friction, area) = expected[speed];
            // Three digits are published, of another fit of the rubber.
            let near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.03;
            assert!(
                near(row.friction_coefficient, friction) && near(row.contact_area_fraction, area),
                "section {section}, {mm_s} mm/s: {} {} instead of {friction} {area}",
                row.friction_coefficient,
                row.contact_area_fraction
            );
        }
    }
    let methods = RunView::of(&out).rows(METHODS).unwrap();
    let ratio = |method| {
        let own = methods.iter().filter(|row| row.kind.method == method);
        let ratios: Vec<f64> = own.map(|row| row.ratio_to_measured).collect();
        ratios.iter().sum::<f64>() / ratios.len() as f64
    };
    let (matched, random, sines) =
        (ratio(Method::Matched), ratio(Method::RandomPhase), ratio(Method::Sines));
    // Of single sections 1.2 to 2.6 and 1.8 to 3.7; their mean is governed by the one of most friction.
    assert!((1.1..1.7).contains(&matched) && (1.7..2.7).contains(&random), "{matched} {random}");
    assert!(sines > random, "{sines}");
}

const VALIDATION: &str = r#"title = "Validation road"

[ingest]
scans = ["scans"]

[ingest.text]
separator = "whitespace"
header = false
x_column = 1
x_unit = "um"
z_column = 2
z_unit = "um"

[ingest.conditioning]
form = "slope"
spike_threshold = 1e9              # as the oracle, which takes the points as they are

[approximate]
waves = [8]
shortest_wavelength_mm = 0.0597663

[realise]
methods = ["measured", "matched", "random-phase", "sines"]
waves = [8]
realisations = 6
seed = 1

[bem]
rubber = "rubber.toml"
speeds_mm_s = [0.01, 1000.0]
area_fractions = []
pressures_mpa = [0.3]
estimate_scan_error = false
points_per_shortest_wavelength = 32
"#;

/// The compound at 20.2 °C, whose shift factor the set has, as a rubber file of the fit of its master curve.
fn s100(shared: &Path) -> String {
    let master = std::fs::read_to_string(shared.join("S100_master_curve.txt")).unwrap();
    let mut sweep = String::from("frequency_hz,storage_mpa,loss_mpa\n");
    for line in master.lines().filter(|line| !line.starts_with('#')) {
        let numbers: Vec<f64> = line.split_whitespace().map(|n| n.parse().unwrap()).collect();
        let (frequency, storage, loss) = (numbers[0] / 87.32, numbers[1] / 1e6, numbers[2] / 1e6);
        writeln!(sweep, "{frequency:e},{storage:e},{loss:e}").unwrap();
    }
    let campaign = Campaign::new();
    campaign.write("sweep.csv", &sweep);
    let fit = campaign
        .command("rubber fit sweep.csv --kind youngs --name S100 --to fitted.toml")
        .output()
        .unwrap();
    assert!(fit.status.success(), "{}", String::from_utf8_lossy(&fit.stderr));
    campaign.read("fitted.toml")
}

/// Two hundred small roads of their own, six windows of three times the longest wave each: the interval of sines, by phases and
/// by scans, against the mean over all of them.
#[test]
#[ignore = "200 runs with 26 curves each: .ci/full"]
fn the_interval_of_sines_holds_the_mean_of_the_road_as_often_as_it_says() {
    use asperity::surface::SineScale;
    use asperity::surface::realisation::random_phases;
    const SPECIMENS: u64 = 200;
    const WINDOW_POINTS: u32 = 960;
    let scales: Vec<SineScale> = (1..=384)
        .rev()
        .map(|k| {
            let wavelength = 96e-3 / f64::from(k);
            let share = f64::from(k) / 3.0;
            SineScale { wavelength, amplitude: 0.007 * wavelength * share.powf(-0.2) }
        })
        .collect();
    let run_of = |seed: u64| -> (f64, f64) {
        let campaign = Campaign::new();
        for scan in 0..3 {
            std::fs::remove_file(campaign.path(&format!("scans/track_{scan}.txt"))).unwrap();
        }
        for window in 0..6 {
            let road = random_phases(&scales, seed, window);
            let mut text = String::from("x_mm;z_um\n");
            for i in 0..WINDOW_POINTS {
                let x = 25e-6 * f64::from(i);
                let height: f64 = road.iter().map(|wave| wave.height(x)).sum();
                writeln!(text, "{:.3};{:.4}", 1e3 * x, 1e6 * height).unwrap();
            }
            campaign.write(&format!("scans/window_{window}.txt"), &text);
        }
        campaign.edit("recipe.toml", "seed = 1", &format!("seed = {seed}"));
        campaign.edit("recipe.toml", "realisations = 2", "realisations = 6");
        campaign.edit("recipe.toml", "waves = [2, 3]", "waves = [5]");
        campaign.edit("recipe.toml", "waves = [3]", "waves = [5]");
        let wanted = "area_fractions = []\npressures_mpa = [0.2]";
        campaign.edit("recipe.toml", "area_fractions = [0.02, 0.05, 0.1]", wanted);
        let out = campaign.path("out");
        run(&recipe(&campaign), &out);
        let row = RunView::of(&out).rows(FRICTION).unwrap().remove(0);
        // The errors by interpolation and by the grid are a few thousandths of these.
        let parts = [(row.confidence_95.unwrap(), 5.0), (row.scan_error.unwrap(), 5.0)];
        (row.mean, combined_95(&parts))
    };
    let found: Vec<(f64, f64)> = (1..=SPECIMENS).into_par_iter().map(run_of).collect();
    let truth = found.iter().map(|(mean, _)| mean).sum::<f64>() / SPECIMENS as f64;
    let held = found.iter().filter(|(mean, half)| (mean - truth).abs() <= *half).count();
    let share = held as f64 / SPECIMENS as f64;
    println!("{share}");
    assert!((0.93..=0.97).contains(&share), "{share}");
}

/// Three disjoint thirds of the bundled specimen, whose friction differed by twice their combined intervals as long as only
/// phases counted.
#[test]
fn thirds_of_a_specimen_agree_within_their_intervals() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(project.join("pipelines/asphalt.toml")).unwrap();
    let of_third = |third: u32| -> Vec<FrictionRow> {
        let scans: Vec<String> = (1..=10)
            .map(|k| {
                format!(
                    "\"{}\"",
                    project
                        .join(format!("data/scans/specimen/scan_{:02}.txt", 10 * third + k))
                        .display()
                )
            })
            .collect();
        let recipe = text
            .replace("[\"../data/scans/specimen\"]", &format!("[{}]", scans.join(", ")))
            .replace("../data", &project.join("data").display().to_string())
            .replace("waves = [7, 8, 9]", "waves = [8]")
            .replace("waves = [8, 9]", "methods = [\"measured\", \"sines\"]\nwaves = [8]")
            .replace("speeds_mm_s = [10.0, 50.0]", "speeds_mm_s = [50.0]")
            .replace(
                "[0.002, 0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1]",
                "[0.1]",
            )
            .replace("field_area_fractions = [0.05]", "points_per_shortest_wavelength = 32");
        let recipe = &recipe[..recipe.find("[micro]").unwrap()];
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("recipe.toml");
        std::fs::write(&path, recipe).unwrap();
        run(&Recipe::read(&path).unwrap(), folder.path());
        RunView::of(folder.path()).rows(FRICTION).unwrap()
    };
    let thirds: Vec<Vec<FrictionRow>> = (0..3).map(of_third).collect();
    for k in 0..thirds[0].len() {
        let rows: Vec<&FrictionRow> = thirds.iter().map(|rows| &rows[k]).collect();
        for (i, a) in rows.iter().enumerate() {
            for b in &rows[..i] {
                let half = a.error_estimate.unwrap().hypot(b.error_estimate.unwrap());
                println!("{} {:.3} {:.3} {half:.3}", a.kind, a.mean, b.mean);
                assert!((a.mean - b.mean).abs() <= half, "{} {} {} {half}", a.kind, a.mean, b.mean);
            }
        }
    }
}
