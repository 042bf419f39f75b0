//! approximate and realise on a correlation that is known in closed form.

use super::Campaign;
use asperity::artifact::{Identity, Manifest, Metadata, Pending, RunFolder, RunView};
use asperity::numerics::Interrupt;
use asperity::stages::approximate::{self, Approximate, FITS, ScaleRow};
use asperity::stages::characterise::{AVERAGE, CORRELATION, CorrelationRow, WINDOW_LENGTH_KEY};
use asperity::stages::realise::{self, Realise, Surface, read_surfaces};
use asperity::stages::tables::{COMPARISON, FRICTION};
use asperity::stages::{Context, StageError, Watch};
use asperity::surface::SineScale;
use asperity::surface::ladder::Undetermined;
use asperity::surface::realisation::random_phases;
use asperity::surface::sine_fit::FitRule;
use serde_json::json;
use std::f64::consts::PI;

const SPACING_MM: f64 = 0.025;
const WINDOW_POINTS: usize = 400;
/// Wavelength and amplitude in mm.
const WAVES: [(f64, f64); 4] = [(0.25, 0.01), (0.5, 0.02), (1.0, 0.015), (2.0, 0.05)];

/// (3.3.12-13), summed over the waves.
fn correlation_mm2(lag_mm: f64) -> f64 {
    let of = |(wavelength, amplitude): (f64, f64)| {
        let rise = (PI * lag_mm.min(wavelength / 2.0) / wavelength).sin();
        2.0 * amplitude * amplitude * rise * rise
    };
    WAVES.into_iter().map(of).sum()
}

/// Calls `compute` as the pipeline does and makes what it writes the result of the stage.
fn commit<T>(
    folder: &RunFolder,
    stage: &str,
    compute: impl FnOnce(&mut Context) -> Result<T, StageError>,
) -> Result<T, StageError> {
    let interrupted = Interrupt::default();
    let pending: Pending = folder.begin(stage)?;
    let watch = Watch { progress: &|_, _| {}, interrupted: &interrupted };
    let mut context = Context { pending, watch };
    let result = compute(&mut context)?;
    let identity = Identity {
        stage: stage.into(),
        stage_revision: 1,
        output_schemas: Vec::new(),
        parameters: json!({}),
        inputs: Vec::new(),
    };
    let outputs = context.pending.outputs().to_vec();
    context.pending.commit(&Manifest::new(&identity, outputs, Vec::new(), 0.0)?)?;
    Ok(result)
}

/// A run folder that has a window of 10 mm and that correlation in it.
fn measured(campaign: &Campaign) -> RunFolder {
    let folder = RunFolder::open(campaign.path("out")).unwrap();
    commit(&folder, "characterise", |context| {
        let row = |lag: usize| CorrelationRow {
            scan: AVERAGE.into(),
            lag_mm: SPACING_MM * lag as f64,
            correlation_mm2: correlation_mm2(SPACING_MM * lag as f64),
            pairs: (WINDOW_POINTS - lag) as u64,
        };
        // Nearly log-spaced, and short of half the window, as the stage keeps them.
        let mut lags: Vec<usize> = (0..36).map(|i| 1.15_f64.powi(i) as usize).collect();
        lags.dedup();
        let rows: Vec<_> = lags.into_iter().map(row).collect();
        let metadata = Metadata::from([(WINDOW_LENGTH_KEY.to_owned(), "10".to_owned())]);
        Ok(context.pending.write_table(CORRELATION, &rows, &metadata)?)
    })
    .unwrap();
    folder
}

fn parameters(shortest_wavelength_mm: f64, waves: &[u32]) -> Approximate {
    Approximate {
        waves: waves.to_vec(),
        given: Vec::new(),
        shortest_wavelength_mm: Some(shortest_wavelength_mm),
        undetermined: Undetermined::Drop,
        rule: FitRule::Thesis,
        longest_lag_mm: None,
    }
}

#[test]
fn approximate_recovers_the_amplitudes() {
    let campaign = Campaign::new();
    let folder = measured(&campaign);
    let warnings =
        commit(&folder, "approximate", |c| approximate::run(&parameters(0.25, &[4]), &folder, c));
    assert_eq!(warnings.unwrap(), Vec::<String>::new());
    let rows = folder.rows(approximate::WAVES).unwrap();
    assert_eq!(rows.len(), 4);
    for (row, (wavelength, amplitude)) in rows.iter().zip(WAVES) {
        assert_eq!(row.wavelength_mm, wavelength);
        // The fit ends at a gradient of 1e-9 or so in relative amplitudes.
        approx::assert_relative_eq!(row.amplitude_mm, amplitude, max_relative = 1e-6);
        approx::assert_relative_eq!(
            row.rms_slope,
            2_f64.sqrt() * PI * row.amplitude_mm / wavelength,
            max_relative = 1e-12
        );
        assert_eq!(row.amplitude_confidence_95_mm, None, "one window has no spread");
    }
    let fits = folder.rows(FITS).unwrap();
    assert!(fits[0].rms_residual_log10 < 1e-6 && fits[0].warnings.is_empty(), "{fits:?}");
    // Beyond half the longest wave the correlation is 2 sum D², that of a surface sqrt 2 higher than the waves.
    let ratio = fits[0].rms_height_mm / fits[0].scans_rms_height_mm;
    approx::assert_relative_eq!(fits[0].rms_height_ratio, ratio, max_relative = 1e-12);
    approx::assert_relative_eq!(ratio, 0.5_f64.sqrt(), max_relative = 1e-6);
}

/// The correlation of the thesis' waves is no sum of sines; what its rule holds at the maximum, the other rule averages.
#[test]
fn the_rule_of_the_fit_reaches_the_tables() {
    let campaign = Campaign::new();
    let folder = measured(&campaign);
    let asked = Approximate { rule: FitRule::Sines, ..parameters(0.25, &[4]) };
    commit(&folder, "approximate", |c| approximate::run(&asked, &folder, c)).unwrap();
    let (fits, metadata) = folder.read_table(FITS).unwrap();
    assert!(metadata[approximate::RULE_KEY].starts_with("sines: "), "{metadata:?}");
    // Up to half the longest wave its correlation is that of the sine; the others, held at 2 D², are sqrt 2 higher.
    let [rest @ .., longest] = WAVES.map(|(_, amplitude)| amplitude * amplitude);
    let others: f64 = rest.iter().sum();
    let ratio = ((0.5 * longest + others) / (longest + others)).sqrt();
    // The waves next to the longest are still rising within half of it, which pulls them towards the rule of the thesis.
    let found = fits[0].rms_height_ratio;
    assert!(0.5_f64.sqrt() < found && found < ratio, "{found} {ratio}");
    let rows = folder.rows(approximate::FITTED).unwrap();
    let (sum, count) = rows.iter().fold((0.0, 0.0), |(sum, count), row| {
        (sum + (row.fitted_mm2 / row.measured_mm2).log10().powi(2), count + 1.0)
    });
    let residual = f64::sqrt(sum / count);
    approx::assert_relative_eq!(residual, fits[0].rms_residual_log10, max_relative = 1e-9);
}

#[test]
fn the_rule_of_the_thesis_does_not_appear_in_the_parameters() {
    let thesis = json!(parameters(0.25, &[4]));
    assert_eq!(thesis.get("rule"), None);
    let sines = json!(Approximate { rule: FitRule::Sines, ..parameters(0.25, &[4]) });
    assert_eq!(sines["rule"], "sines");
}

/// Half a window is half of the 10 mm that ingest cut, not of the longest lag that was kept.
#[test]
fn waves_beyond_two_samples_and_half_a_window_are_left_out_or_kept_with_a_warning() {
    let campaign = Campaign::new();
    let folder = measured(&campaign);
    let fit = |parameters: &Approximate| {
        commit(&folder, "approximate", |c| approximate::run(parameters, &folder, c)).unwrap();
        folder.read_table(approximate::WAVES).unwrap()
    };
    let wavelengths =
        |rows: &[ScaleRow]| rows.iter().map(|row| row.wavelength_mm).collect::<Vec<_>>();

    let mut asked = parameters(5.0 / 128.0, &[9]);
    let (rows, metadata) = fit(&asked);
    assert_eq!(wavelengths(&rows), [5.0 / 64.0, 5.0 / 32.0, 0.3125, 0.625, 1.25, 2.5, 5.0]);
    let of_the_limits = |metadata: &Metadata| -> Vec<String> {
        metadata.values().filter(|text| text.contains("not determined")).cloned().collect()
    };
    let warnings = of_the_limits(&metadata);
    assert_eq!(warnings.len(), 2);
    assert!(warnings[0].contains("0.03906") && warnings[0].contains("two sample spacings"));
    assert!(warnings[1].contains("10.000000 mm") && warnings[1].contains("(5.000000 mm)"));

    asked.undetermined = Undetermined::Keep;
    let (rows, metadata) = fit(&asked);
    let warnings = of_the_limits(&metadata);
    assert_eq!((rows.len(), warnings.len()), (9, 2));
    assert!(warnings.iter().all(|warning| warning.ends_with("kept")), "{warnings:?}");
}

#[test]
fn realise_stores_the_waves_of_the_fit_with_phases_of_the_seed() {
    let campaign = Campaign::new();
    let folder = measured(&campaign);
    commit(&folder, "approximate", |c| approximate::run(&parameters(0.25, &[3, 4]), &folder, c))
        .unwrap();
    let realised = |seed| -> Vec<Surface> {
        let section = format!("waves = [3, 4]\nrealisations = 5\nseed = {seed}");
        let parameters: Realise = toml::from_str(&section).unwrap();
        commit(&folder, "realise", |c| realise::run(&parameters, false, None, &folder, c)).unwrap();
        read_surfaces(&folder).unwrap()
    };
    let surfaces = realised(7);
    let names: Vec<_> = surfaces.iter().map(|s| (s.kind.waves, s.realisation)).collect();
    let expected: Vec<_> = [3, 4].iter().flat_map(|w| (1..=5).map(move |r| (*w, r))).collect();
    assert_eq!(names, expected);

    let fitted = folder.rows(approximate::WAVES).unwrap();
    for surface in &surfaces {
        let scales: Vec<SineScale> = fitted
            .iter()
            .filter(|row| row.waves == surface.kind.waves)
            .map(|row| SineScale {
                wavelength: row.wavelength_mm / 1e3,
                amplitude: row.amplitude_mm / 1e3,
            })
            .collect();
        // To the last bit, through the file.
        assert_eq!(surface.profile, random_phases(&scales, 7, surface.realisation.into()));
    }
    assert_eq!(realised(7), surfaces);
    assert_ne!(realised(8), surfaces);
}

#[test]
fn approximations_with_the_same_surfaces_are_solved_once_and_compared_under_both_names() {
    let campaign = Campaign::new();
    campaign.write("published.csv", "area_fraction,average\n0.1,0.5\n");
    campaign.write(
        "recipe.toml",
        r#"title = "A wave without amplitude"
        [[approximate.given]]
        source = "a test"
        scales = [{ wavelength_mm = 1.0, amplitude_mm = 0.02 }]
        [[approximate.given]]
        source = "a test"
        scales = [
            { wavelength_mm = 1.0, amplitude_mm = 0.02 },
            { wavelength_mm = 2.0, amplitude_mm = 0.0 },
        ]
        [realise]
        waves = [1, 2]
        realisations = 2
        seed = 1
        [bem]
        rubber = "rubber.toml"
        speeds_mm_s = [10.0]
        area_fractions = [0.1]
        [[tables.published]]
        name = "Two waves"
        waves = 2
        speed_mm_s = 10.0
        file = "published.csv"
        "#,
    );
    let out = campaign.path("out");
    super::run(&super::recipe(&campaign), &out);
    let view = RunView::of(out);
    let surfaces = read_surfaces(&view).unwrap();
    assert!(surfaces.len() == 2 && surfaces.iter().all(|surface| surface.kind.waves == 1));
    let warnings = view.stage_manifest("realise").unwrap().unwrap().warnings;
    assert!(warnings[0].starts_with("2 waves: the surfaces are those of 1 waves"), "{warnings:?}");
    let friction = view.rows(FRICTION).unwrap();
    assert_eq!(friction.len(), 1);
    let compared = view.rows(COMPARISON).unwrap();
    assert_eq!((compared.len(), compared[0].waves, compared[0].computed), (1, 2, friction[0].mean));
}
