//! Conditioning as a whole, on made maps.

use super::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn map_of(
    points: [usize; 2],
    spacing: [f64; 2],
    height: impl FnMut([usize; 2]) -> f64,
) -> HeightMap {
    let places = (0..points[1]).flat_map(|j| (0..points[0]).map(move |i| [i, j]));
    HeightMap { name: "road".into(), points, spacing, heights: places.map(height).collect() }
}

fn rough(points: [usize; 2]) -> HeightMap {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    map_of(points, [1e-5, 1e-5], |_| 1e-6 * random.random::<f64>())
}

fn recipe(toml: &str) -> MapConditioning {
    toml::from_str(toml).unwrap()
}

#[test]
fn an_empty_recipe_is_the_default_and_all_keys_are_read() {
    assert_eq!(recipe(""), MapConditioning::default());
    let all = recipe(
        "valid_range_mm = [-5, 5]\nspike_threshold = 0\nlevel_jumps = 'missing'\njump_threshold = 8\n\
         lateral_resolution_um = 50\nsamples_per_resolution = 4\nwindow_length_mm = [20, 10]\n\
         max_missing = 0.2\nform = { polynomial = 3 }",
    );
    assert_eq!((all.form, all.level_jumps), (FormOfMap::Polynomial(3), Handling::Missing));
    assert_eq!(recipe(&toml::to_string(&all).unwrap()), all);
    assert_eq!(recipe("form = 'plane'").form, FormOfMap::Plane);
    assert!(toml::from_str::<MapConditioning>("window_length = [20, 20]").is_err());
}

#[test]
fn parameters_out_of_range_are_named() {
    for (toml, key) in [
        ("valid_range_mm = [1, 5]", "valid_range_mm is 1;"),
        ("valid_range_mm = [-1, nan]", "valid_range_mm is NaN;"),
        (
            "valid_range_mm = [5, -5]",
            "valid_range_mm is 5; the range is [lowest, highest], and its ends are swapped",
        ),
        ("spike_threshold = nan", "spike_threshold is NaN;"),
        ("jump_threshold = -1", "jump_threshold is -1;"),
        ("lateral_resolution_um = 0", "lateral_resolution_um is 0;"),
        ("samples_per_resolution = inf", "samples_per_resolution is inf;"),
        ("window_length_mm = [3, -2]", "window_length_mm is -2;"),
        ("max_missing = 1", "max_missing is 1;"),
        ("form = { polynomial = 9 }", "form.polynomial is 9;"),
    ] {
        let error = condition_map(&rough([9, 9]), &recipe(toml)).unwrap_err();
        assert!(error.to_string().starts_with(key), "{error}");
    }
}

#[test]
fn maps_that_are_none_are_told() {
    let error = |map: HeightMap| condition_map(&map, &recipe("")).unwrap_err().to_string();
    let map = || rough([9, 8]);
    assert_eq!(
        error(HeightMap { points: [9, 9], ..map() }),
        "map road has 72 heights for 9 x 9 points"
    );
    assert!(error(HeightMap { points: [0, 9], heights: vec![], ..map() }).contains("0 heights"));
    assert_eq!(
        error(HeightMap { spacing: [1e-5, 0.0], ..map() }),
        "map road: the spacing along y is 0 um; it must be positive"
    );
    let mut infinite = map();
    infinite.heights[12] = f64::INFINITY;
    assert!(error(infinite).contains("column 3, row 1"));
}

#[test]
fn an_oversampled_map_comes_to_half_its_resolution() {
    // The same number of points along both axes at the same spacing, others at others.
    let keys = recipe("lateral_resolution_um = 40\nform = 'mean'");
    let map = map_of([100, 60], [10e-6, 5e-6], |[i, j]| 1e-6 * (i % 2 + j % 4) as f64);
    let (windows, report) = condition_map(&map, &keys).unwrap();
    assert_eq!((report.points_per_cell, report.cells, report.cells_missing), ([2, 4], [50, 15], 0));
    approx::assert_relative_eq!(windows[0].spacing[0], 20e-6, max_relative = 1e-12);
    approx::assert_relative_eq!(windows[0].spacing[1], 20e-6, max_relative = 1e-12);
    assert_eq!(windows[0].name, "road");
    // Every cell has the mean 0.5 + 1.5 um.
    assert!(windows[0].heights.iter().all(|z| *z == 0.0));
    let level = report.windows[0].form.as_ref().unwrap().legendre_coefficients_mm[0];
    approx::assert_relative_eq!(level, 2e-3, max_relative = 1e-14);
    approx::assert_relative_eq!(report.windows[0].origin_mm[0], 5e-3, max_relative = 1e-12);
    approx::assert_relative_eq!(report.windows[0].origin_mm[1], 7.5e-3, max_relative = 1e-12);
    let error = condition_map(&map, &recipe("lateral_resolution_um = 1000")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "map road is 0.300 mm long along y, shorter than one cell of 0.500 mm (lateral_resolution_um)"
    );
}

#[test]
fn faults_are_counted_by_kind_and_stay_missing() {
    let mut map = rough([80, 60]);
    map.heights[81] = f64::NAN;
    map.heights[500] = 7e-3;
    map.heights[2000] += 40e-6;
    (0..80).for_each(|i| map.heights[40 * 80 + i] += 30e-6);
    let keys = "valid_range_mm = [-5, 5]\nmax_missing = 0.2\n";
    for (jumps, missing) in [("keep", 3), ("missing", 83)] {
        let keys = format!("{keys}level_jumps = '{jumps}'");
        let (windows, report) = condition_map(&map, &recipe(&keys)).unwrap();
        assert_eq!((report.points, report.points_missing_in_file), ([80, 60], 1));
        assert_eq!((report.points_out_of_range, report.spikes), (1, 1));
        assert_eq!((report.jumped_rows, report.jumped_columns), (1, 0));
        assert_eq!((windows[0].missing(), report.cells_missing), (missing, missing));
        let kinds: Vec<&str> = report.faults.iter().map(|fault| fault.fault.as_str()).collect();
        let expected =
            ["stair-steps", "out of range", "spikes", "row jumps", "column jumps", "tilt"];
        assert_eq!(kinds, expected);
        let spikes = &report.faults[2];
        assert!(spikes.rms_slope_after < spikes.rms_slope_before);
        let rows = &report.faults[3];
        assert_eq!((rows.count, rows.share), (1, 80.0 / 4800.0));
        assert!(rows.rms_slope_after.unwrap() < 0.5 * rows.rms_slope_before.unwrap());
        assert_eq!(rows.decision == "missing", jumps == "missing");
    }
    let off = recipe("spike_threshold = 0\njump_threshold = 0");
    let (_, report) = condition_map(&map, &off).unwrap();
    assert_eq!((report.spikes, report.jumped_rows, report.faults.len()), (0, 0, 2));
}

#[test]
fn windows_are_cut_row_by_row_in_the_middle_and_rejected_with_the_reason() {
    let mut map = rough([65, 47]);
    let tilted = |k: usize| 0.1 * 1e-5 * (k % 65) as f64;
    map.heights.iter_mut().enumerate().for_each(|(k, z)| *z += tilted(k));
    // 25 points of the second window of 20 x 15, which begins at column 22.
    (0..25).for_each(|k| map.heights[(2 + k / 5) * 65 + 24 + k % 5] = f64::NAN);
    (0..25).for_each(|k| map.heights[(8 + k / 5) * 65 + 24 + k % 5] = f64::NAN);
    let (windows, report) = condition_map(&map, &recipe("window_length_mm = [0.2, 0.15]")).unwrap();
    assert_eq!((report.windows.len(), windows.len()), (9, 8));
    assert_eq!(report.cells_left_out, 65 * 47 - 9 * 300);
    let names: Vec<&str> = windows.iter().map(|window| window.name.as_str()).collect();
    assert_eq!((names[0], names[1], names[7]), ("road/000", "road/002", "road/008"));
    assert_eq!(windows[3].points, [20, 15]);
    assert_eq!(
        report.windows[1].rejected.as_deref(),
        Some("16.7 % of the points are missing, the limit is 10.0 % (max_missing)")
    );
    assert!(report.windows[1].form.is_none());
    // Window 5 begins at column 2 + 2 * 20, row 1 + 15.
    approx::assert_relative_eq!(report.windows[5].origin_mm[0], 0.42, max_relative = 1e-12);
    approx::assert_relative_eq!(report.windows[5].origin_mm[1], 0.16, max_relative = 1e-12);
    // Noise of 0.3 um over 0.2 mm tilts by 1e-4 in a window.
    let form = report.windows[5].form.as_ref().unwrap();
    approx::assert_abs_diff_eq!(form.tilt.unwrap()[0], 0.1, epsilon = 2e-3);
    approx::assert_abs_diff_eq!(report.tilt.unwrap()[0], 0.1, epsilon = 2e-4);
    assert!(windows.iter().flat_map(|w| &w.heights).all(|z| z.is_nan() || z.abs() < 1e-6));
}

#[test]
fn maps_of_which_nothing_is_left_are_errors() {
    let holes =
        map_of(
            [40, 40],
            [1e-3, 1e-3],
            |[i, j]| {
                if (i + j) % 2 == 0 { (i * j) as f64 } else { f64::NAN }
            },
        );
    let error = |keys: &str| condition_map(&holes, &recipe(keys)).unwrap_err().to_string();
    assert_eq!(
        error("window_length_mm = [20, 20]"),
        "map road: none of 4 windows is kept; the first: 50.0 % of the points are missing, \
         the limit is 10.0 % (max_missing)"
    );
    assert_eq!(
        error("window_length_mm = [20, 50]"),
        "map road is 40.000 mm long along y, shorter than one window of 50.000 mm (window_length_mm)"
    );
    let missing = map_of([40, 40], [1e-3, 1e-3], |_| f64::NAN);
    let error = condition_map(&missing, &recipe("")).unwrap_err();
    assert!(matches!(error, MapConditioningError::NothingLeft { windows: 1, .. }), "{error}");
    let row = map_of([40, 1], [1e-3, 1e-3], |[i, _]| i as f64);
    let error = condition_map(&row, &recipe("")).unwrap_err().to_string();
    assert!(error.contains("do not determine a form of degree 1"), "{error}");
}

#[test]
fn a_flat_map_has_heights_of_zero_and_no_round_off() {
    let map = map_of([70, 50], [1e-5, 3e-5], |[i, j]| 4e-4 + 3e-6 * i as f64 - 1e-6 * j as f64);
    let (windows, report) = condition_map(&map, &recipe("")).unwrap();
    assert!(windows[0].heights.iter().all(|z| *z == 0.0));
    assert_eq!((report.spikes, report.jumped_rows, report.jumped_columns), (0, 0, 0));
}
