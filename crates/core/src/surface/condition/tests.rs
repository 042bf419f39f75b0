//! Conditioning as a whole, on made scans.

use super::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn scan(spacing: f64, heights: Vec<f64>) -> RawScan {
    let positions = (0..heights.len()).map(|i| i as f64 * spacing).collect();
    RawScan { name: "road".into(), positions, heights }
}

fn recipe(toml: &str) -> Conditioning {
    toml::from_str(toml).unwrap()
}

#[test]
fn an_empty_recipe_is_the_default_and_all_keys_are_read() {
    assert_eq!(recipe(""), Conditioning::default());
    let all = recipe(
        "valid_range_mm = [-5, 5]\nspike_threshold = 0\nlateral_resolution_um = 50\n\
         samples_per_resolution = 4\nwindow_length_mm = 20\nmax_missing = 0.2\n\
         form = { polynomial = 3 }\nform_extent = 'scan'",
    );
    assert_eq!(all.form, Form::Polynomial(3));
    assert_eq!(recipe(&toml::to_string(&all).unwrap()), all);
    assert!(toml::from_str::<Conditioning>("window_length = 20").is_err());
}

#[test]
fn parameters_out_of_range_are_named() {
    for (toml, key) in [
        ("valid_range_mm = [1, 5]", "valid_range_mm"),
        (
            "valid_range_mm = [5, -5]",
            "valid_range_mm is 5; the range is [lowest, highest], and its ends are swapped",
        ),
        ("spike_threshold = nan", "spike_threshold"),
        ("lateral_resolution_um = 0", "lateral_resolution_um"),
        ("samples_per_resolution = inf", "samples_per_resolution"),
        ("window_length_mm = -1", "window_length_mm"),
        ("max_missing = 1", "max_missing"),
        ("form = { polynomial = 13 }", "form.polynomial"),
    ] {
        let error = condition(&scan(1e-6, vec![0.0; 9]), &recipe(toml)).unwrap_err();
        assert!(error.to_string().starts_with(key), "{error}");
    }
}

#[test]
fn an_oversampled_scan_comes_to_half_its_resolution_with_exact_means() {
    let heights = (0..1000).map(|i| 1e-6 * f64::from(i % 10)).collect();
    let keys = "spike_threshold = 0\nlateral_resolution_um = 20\nform = 'mean'";
    let (windows, report) = condition(&scan(1e-6, heights), &recipe(keys)).unwrap();
    assert_eq!((report.points_per_cell, report.cells, report.cells_missing), (10, 100, 0));
    assert_eq!(windows[0].name, "road");
    approx::assert_relative_eq!(windows[0].spacing, 10e-6, max_relative = 1e-12);
    approx::assert_abs_diff_eq!(windows[0].origin, 4.5e-6, epsilon = 1e-18);
    // Every cell has the mean 4.5 um of ten heights, which the form takes to nothing.
    assert!(windows[0].heights.iter().all(|z| z.abs() < 1e-20));
    let level = report.windows[0].form.as_ref().unwrap().legendre_coefficients_mm[0];
    approx::assert_relative_eq!(level, 4.5e-3, max_relative = 1e-14);
}

#[test]
fn white_noise_loses_variance_as_the_points_per_cell() {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let heights: Vec<f64> = (0..160_000).map(|_| random.random::<f64>() * 1e-6).collect();
    let keys = "lateral_resolution_um = 50\nform = 'mean'";
    let (windows, report) = condition(&scan(0.1e-6, heights), &recipe(keys)).unwrap();
    assert_eq!((report.points_per_cell, report.cells), (250, 640));
    let variance = windows[0].heights.iter().map(|z| z * z).sum::<f64>() / 639.0;
    // Of 640 cells the variance is known to sqrt(2 / 639) = 5.6 %; four times that.
    approx::assert_relative_eq!(variance, 1e-12 / 12.0 / 250.0, max_relative = 0.23);
}

#[test]
fn a_coarse_scan_keeps_its_spacing() {
    let keys = "lateral_resolution_um = 50";
    let (windows, report) =
        condition(&scan(37.5e-6, vec![1.0, 2.0, 1.5, 1.7, 1.0, 1.2]), &recipe(keys)).unwrap();
    assert_eq!((report.points_per_cell, report.spacing_um), (1, report.raw_spacing_um));
    assert_eq!(windows[0].heights.len(), 6);
}

#[test]
fn faults_are_counted_by_kind_and_stay_missing() {
    let mut heights: Vec<f64> = (0..400).map(|i| 1e-3 * (0.1 * f64::from(i)).sin()).collect();
    heights[10] = f64::NAN;
    heights[50] = 0.047;
    heights[51] = -0.047;
    heights[200] += 2e-3;
    let mut raw = scan(1e-5, heights);
    raw.positions.remove(300);
    raw.heights.remove(300);
    let (windows, report) = condition(&raw, &recipe("valid_range_mm = [-10, 10]")).unwrap();
    assert_eq!((report.points_read, report.points_missing_in_file), (399, 1));
    assert_eq!((report.points_absent, report.points_out_of_range, report.spikes), (1, 2, 1));
    let missing: Vec<usize> = (0..400).filter(|&i| windows[0].heights[i].is_nan()).collect();
    assert_eq!(missing, [10, 50, 51, 200, 300]);
    assert_eq!(report.cells_missing, 5);
}

#[test]
fn windows_with_too_many_gaps_are_rejected_with_the_reason() {
    let mut heights: Vec<f64> = (0..105).map(|i| 1e-3 * (0.7 * f64::from(i)).sin()).collect();
    heights[22..25].fill(f64::NAN);
    let raw = scan(1e-3, heights);
    let keys = recipe("window_length_mm = 20\nspike_threshold = 0");
    let (windows, report) = condition(&raw, &keys).unwrap();
    assert_eq!(report.cells_left_out, 5);
    let names: Vec<&str> = windows.iter().map(|window| window.name.as_str()).collect();
    assert_eq!(names, ["road/000", "road/002", "road/003", "road/004"]);
    assert!(windows.iter().all(|window| window.heights.len() == 20));
    approx::assert_abs_diff_eq!(windows[1].origin, 42e-3, epsilon = 1e-15);
    assert_eq!(
        report.windows[1].rejected.as_deref(),
        Some("15.0 % of the points are missing, the limit is 10.0 % (max_missing)")
    );
    assert_eq!((report.windows[1].missing_share, report.windows[1].form.clone()), (0.15, None));
}

#[test]
fn a_form_of_the_scan_is_removed_before_cutting() {
    let heights: Vec<f64> = (0..100).map(|i| 1e-6 * f64::from(i * i)).collect();
    let keys = "form = { polynomial = 2 }\nform_extent = 'scan'\nwindow_length_mm = 50";
    let (windows, report) = condition(&scan(1e-3, heights), &recipe(keys)).unwrap();
    assert!(windows.iter().flat_map(|window| &window.heights).all(|z| z.abs() < 1e-15));
    assert!(report.form.is_some() && report.windows[0].form.is_none());
}

#[test]
fn scans_of_which_nothing_is_left_are_errors() {
    let holes = scan(1e-3, (0..40).map(|i| if i % 2 == 0 { 1.0 } else { f64::NAN }).collect());
    let error = condition(&holes, &recipe("window_length_mm = 20")).unwrap_err().to_string();
    assert_eq!(
        error,
        "scan road: none of 2 windows is left; the first: 50.0 % of the points are missing, \
         the limit is 10.0 % (max_missing)"
    );
    let error = condition(&holes, &recipe("window_length_mm = 50")).unwrap_err();
    assert!(matches!(error, ConditioningError::TooShort { .. }), "{error}");
    let error = condition(
        &holes,
        &recipe("form_extent = 'scan'\nform = { polynomial = 12 }\nlateral_resolution_um = 8000"),
    );
    assert!(matches!(error, Err(ConditioningError::Form { .. })), "{error:?}");
    let error = condition(&scan(1e-3, vec![]), &recipe("")).unwrap_err();
    assert!(matches!(error, ConditioningError::Grid { .. }), "{error}");
}

#[test]
fn a_flat_scan_has_heights_of_zero_and_no_round_off() {
    let positions: Vec<f64> = (0..300).map(|i| f64::from(i) * 1e-5).collect();
    for tilt in [0.0, 0.3] {
        let heights = positions.iter().map(|x| 4e-4 + tilt * x).collect();
        let scan = RawScan { name: "flat".into(), positions: positions.clone(), heights };
        for extent in [FormExtent::Window, FormExtent::Scan] {
            let conditioning = Conditioning { form_extent: extent, ..Conditioning::default() };
            let (windows, _) = condition(&scan, &conditioning).unwrap();
            assert!(windows[0].heights.iter().all(|z| *z == 0.0), "{tilt} {extent:?}");
        }
    }
}
