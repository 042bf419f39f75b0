//! ingest and characterise on a single wave, of which everything is known.

use super::{Campaign, recipe, run, try_run};
use asperity::artifact::RunView;
use asperity::pipeline::Selection;
use asperity::stages;
use asperity::stages::characterise::{
    AVERAGE, CORRELATION, PARAMETERS, PROFILE, SPECTRUM, TEXTURE,
};
use asperity::stages::ingest::{FAULTS, REPORT, WINDOWS, read_windows};
use asperity::surface::{Conditioning, RawScan, condition};
use std::f64::consts::{PI, TAU};

const POINTS: usize = 400;
const SPACING_MM: f64 = 0.02;
const WAVELENGTH_MM: f64 = 1.0;
const AMPLITUDE_UM: f64 = 50.0;
const TILT_UM_PER_MM: f64 = 10.0;

/// Distance from the middle of the scan in mm.
fn from_middle(i: usize) -> f64 {
    SPACING_MM * (i as f64 - (POINTS - 1) as f64 / 2.0)
}

fn height_um(i: usize) -> f64 {
    AMPLITUDE_UM * (TAU * from_middle(i) / WAVELENGTH_MM).cos()
}

/// A scan of eight whole waves that are even about the middle: mean and line of the wave vanish
/// exactly, so the form is the tilt. Gaps must be even, too.
fn scan_text(gaps: &[usize]) -> String {
    let mut text = String::from("x_mm;z_um\n");
    for i in 0..POINTS {
        let z = 300.0 + TILT_UM_PER_MM * from_middle(i) + height_um(i);
        let z = if gaps.contains(&i) { "BAD".into() } else { format!("{z:.9}") };
        text += &format!("{:.2};{z}\n", SPACING_MM * i as f64);
    }
    text
}

/// A campaign of that one scan; the self-affine fit is kept to lags at which a sine still rises.
fn campaign(gaps: &[usize]) -> Campaign {
    let campaign = Campaign::new();
    campaign.write("wave.txt", &scan_text(gaps));
    campaign.edit("recipe.toml", r#"["scans"]"#, r#"["wave.txt"]"#);
    let limit = "[characterise]\nself_affine_longest_lag_mm = 0.3";
    campaign.edit("recipe.toml", "[characterise]", limit);
    // No further: the correlation of a pure sine vanishes at its wavelength and has no logarithm.
    for stage in [stages::ingest::STAGE, stages::characterise::STAGE] {
        let only = Selection { only: Some(stage), ..Selection::default() };
        try_run(&recipe(&campaign), &campaign.path("out"), only).unwrap();
    }
    campaign
}

#[test]
fn ingest_takes_the_tilt_off_a_wave_and_keeps_its_gaps() {
    let gaps = [3, 150, 151, POINTS - 152, POINTS - 151, POINTS - 4];
    let campaign = campaign(&gaps);
    let view = RunView::of(campaign.path("out"));
    let windows = read_windows(&view).unwrap();
    assert_eq!(windows.len(), 1);
    let window = &windows[0];
    assert_eq!((window.name.as_str(), window.heights.len()), ("wave", POINTS));
    approx::assert_relative_eq!(window.spacing, SPACING_MM / 1e3, max_relative = 1e-12);
    // A wave with gaps is not quite free of mean: the largest share of it that six of 400 points
    // can make.
    let shift = 6.0 / POINTS as f64 * AMPLITUDE_UM * 1e-6;
    for (i, height) in window.heights.iter().enumerate() {
        assert_eq!(height.is_nan(), gaps.contains(&i), "point {i}");
        let error = (height - height_um(i) * 1e-6).abs();
        assert!(height.is_nan() || error <= shift, "point {i}: {error}");
    }
    let report = view.rows(REPORT).unwrap();
    assert_eq!((report.len(), report[0].points_read, report[0].points_missing), (1, 400, 6));
    assert_eq!((report[0].windows_kept, report[0].windows_rejected), (1, 0));
    let windows = view.rows(WINDOWS).unwrap();
    assert_eq!((windows[0].missing_share, &windows[0].rejected), (6.0 / 400.0, &None));
    let tilt_mm = TILT_UM_PER_MM * 1e-3 * SPACING_MM * ((POINTS * POINTS - 1) as f64 / 12.0).sqrt();
    // Six points of 400 are left out of the mean square.
    approx::assert_relative_eq!(windows[0].form_rms_mm.unwrap(), tilt_mm, max_relative = 0.015);
}

#[test]
fn characterise_finds_the_parameters_of_a_sine() {
    let campaign = campaign(&[]);
    let view = RunView::of(campaign.path("out"));
    let rows = view.rows(PARAMETERS).unwrap();
    let (row, amplitude) = (&rows[0], AMPLITUDE_UM / 1e3);
    // Means over whole waves of equidistant points are exact; the file keeps 1e-9 µm.
    approx::assert_relative_eq!(row.rq_mm, amplitude / 2_f64.sqrt(), max_relative = 1e-9);
    approx::assert_relative_eq!(row.rku, 1.5, max_relative = 1e-9);
    approx::assert_abs_diff_eq!(row.rsk, 0.0, epsilon = 1e-9);
    // Half a step beside the peaks, at 50 points a wave: cos(π / 50).
    approx::assert_relative_eq!(row.rp_mm, amplitude * (PI / 50.0).cos(), max_relative = 1e-9);
    approx::assert_relative_eq!(row.rv_mm, amplitude * (PI / 50.0).cos(), max_relative = 1e-9);
    // First differences see sin(q dx / 2) / (q dx / 2) of a slope, here 1 - 7e-4.
    let slope = 2_f64.sqrt() * PI * amplitude / WAVELENGTH_MM;
    approx::assert_relative_eq!(row.rms_slope, slope, max_relative = 5e-3);
}

#[test]
fn characterise_finds_correlation_and_spectrum_of_a_sine() {
    let campaign = campaign(&[]);
    let view = RunView::of(campaign.path("out"));
    let rows = view.rows(CORRELATION).unwrap();
    let amplitude = AMPLITUDE_UM / 1e3;
    for row in &rows {
        // (3.3.12): 4 D² sin²(q s / 2) times the mean of sin² over the pairs, which is 1/2 but for
        // the last, incomplete half wave of 25 points.
        let sine = (PI * row.lag_mm / WAVELENGTH_MM).sin();
        let largest = 4.0 * amplitude * amplitude * sine * sine;
        let error = (row.correlation_mm2 - largest / 2.0).abs();
        assert!(error <= largest * 12.5 / row.pairs as f64 + 1e-15, "{row:?}");
    }
    // A single window is its own average.
    let of = |name: &str| -> Vec<f64> {
        rows.iter().filter(|row| row.scan == name).map(|row| row.correlation_mm2).collect()
    };
    assert!(of("wave").len() > 20);
    assert_eq!(of("wave"), of(AVERAGE));

    let rows = view.rows(SPECTRUM).unwrap();
    let peak = rows.iter().max_by(|a, b| a.density_mm3.total_cmp(&b.density_mm3)).unwrap();
    // Ten bins a decade.
    let bin = 10_f64.powf(0.1);
    let ratio = peak.wavenumber_rad_mm / (TAU / WAVELENGTH_MM);
    assert!((1.0 / bin..bin).contains(&ratio), "{ratio}");
}

#[test]
fn characterise_finds_the_parameters_of_the_standards() {
    let campaign = campaign(&[]);
    let view = RunView::of(campaign.path("out"));
    let rows = view.rows(PROFILE).unwrap();
    let amplitude = AMPLITUDE_UM / 1e3;
    assert_eq!((rows.len(), rows[0].sections), (1, 5));
    approx::assert_relative_eq!(rows[0].rq_mm, amplitude / 2_f64.sqrt(), max_relative = 1e-9);
    approx::assert_relative_eq!(rows[0].rsm_mm.unwrap(), WAVELENGTH_MM, max_relative = 1e-6);
    let slope = 2_f64.sqrt() * PI * amplitude / WAVELENGTH_MM;
    // The formula errs by (q dx)^6 / 140; six points of 400 have no slope.
    approx::assert_relative_eq!(rows[0].rdq.unwrap(), slope, max_relative = 0.015);

    let rows = view.rows(TEXTURE).unwrap();
    let bands: Vec<_> = rows.iter().filter(|row| row.scan == "wave").collect();
    let sum: f64 = bands.iter().map(|row| row.mean_square_mm2).sum();
    // Hann's window keeps a whole number of waves within a wavenumber to either side.
    approx::assert_relative_eq!(sum, amplitude * amplitude / 2.0, max_relative = 1e-6);
    let loudest = bands.iter().max_by(|a, b| a.level_db.total_cmp(&b.level_db)).unwrap();
    approx::assert_relative_eq!(loudest.wavelength_mm, WAVELENGTH_MM, max_relative = 1e-12);
}

#[test]
fn ingest_tells_of_every_fault() {
    let campaign = campaign(&[]);
    let view = RunView::of(campaign.path("out"));
    let rows = view.rows(FAULTS).unwrap();
    let of = |name: &str| rows.iter().find(|row| row.fault == name).unwrap();
    for fault in ["repeated positions", "end plates", "spikes", "level jumps"] {
        assert_eq!(of(fault).count, 0, "{fault}");
    }
    approx::assert_relative_eq!(of("tilt").measure.unwrap(), 0.01, max_relative = 1e-6);
    assert_eq!(of("level jumps").high_frequency_ratio, Some(1.0));
}

#[test]
fn walls_are_kept_or_missing_as_the_recipe_says() {
    let heights: Vec<f64> = (0..1000)
        .map(|i| 1e-6 * (0.1 * f64::from(i)).sin() + if i < 500 { 0.0 } else { 20e-6 })
        .collect();
    let positions = (0..1000).map(|i| 1e-6 * f64::from(i)).collect();
    let scan = RawScan { name: "road".into(), positions, heights };
    let missing = |keys: &str| {
        let conditioning: Conditioning = toml::from_str(keys).unwrap();
        let (windows, report) = condition(&scan, &conditioning).unwrap();
        let fault = report.faults.iter().find(|fault| fault.fault == "level jumps").unwrap();
        assert_eq!((fault.count, fault.high_frequency_ratio.unwrap() < 0.01), (1, true));
        windows[0].heights.iter().filter(|z| z.is_nan()).count()
    };
    assert_eq!(missing(""), 0);
    assert_eq!(missing("level_jumps = 'missing'"), 2);
    assert_eq!(missing("level_jumps = 'missing'\njump_margin_points = 4"), 8);
    assert!(toml::from_str::<Conditioning>("level_jumps = 'split'").is_err());
    let off: Conditioning = toml::from_str("jump_margin_points = 0").unwrap();
    assert!(condition(&scan, &off).unwrap_err().to_string().starts_with("jump_margin_points"));
}

/// Encoders jitter, so the spacing fitted to the positions differs from scan to scan; lags of the
/// average and of the windows must be the same numbers all the same.
#[test]
fn scans_of_nearly_equal_spacing_share_one() {
    let campaign = Campaign::new();
    let stretched: String = campaign
        .read("scans/track_1.txt")
        .lines()
        .map(|line| match line.split_once(';').map(|(x, z)| (x.parse::<f64>(), z)) {
            Some((Ok(x), z)) => format!("{:.6};{z}\n", x * 1.0001),
            _ => format!("{line}\n"),
        })
        .collect();
    campaign.write("scans/track_1.txt", &stretched);
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let rows = RunView::of(out).rows(CORRELATION).unwrap();
    let lags = |name: &str| -> Vec<f64> {
        rows.iter().filter(|row| row.scan == name).map(|row| row.lag_mm).collect()
    };
    for scan in ["track_0", "track_1", "track_2"] {
        assert_eq!(lags(scan), lags(AVERAGE), "{scan}");
    }
}
