//! Surfaces that are a polynomial and nothing else, and some that are not.

use super::*;

/// Every monomial up to a degree with a coefficient of its own, in units of the half lengths; some 7 % of the points
/// are missing.
fn polynomial(points: [usize; 2], degree: i32, unit: f64) -> HeightMap {
    let mut heights = Vec::new();
    for (j, i) in (0..points[1]).flat_map(|j| (0..points[0]).map(move |i| (j, i))) {
        let [x, y] =
            [(i, points[0]), (j, points[1])].map(|(k, count)| k as f64 / half_length(count) - 1.0);
        let mut z = 0.0;
        for (n, b) in (0..=degree).flat_map(|n| (0..=n).map(move |b| (n, b))) {
            z += (1.0 + f64::from(n) - 0.3 * f64::from(b)) * x.powi(n - b) * y.powi(b);
        }
        heights.push(if (7 * i + 11 * j * j) % 14 == 3 { f64::NAN } else { unit * z });
    }
    HeightMap { name: "map".into(), points, spacing: [2e-5, 5e-5], heights }
}

fn largest(map: &HeightMap) -> f64 {
    map.heights.iter().fold(0.0, |most, z| most.max(z.abs()))
}

#[test]
fn a_polynomial_surface_with_missing_points_leaves_nothing() {
    for degree in 0..=LARGEST_DEGREE {
        let mut map = polynomial([90, 61], degree as i32, 1.0);
        map.heights[..90 * 4].fill(f64::NAN);
        let (before, missing) = (largest(&map), map.missing());
        remove_form(&mut map, FormOfMap::Polynomial(degree)).unwrap();
        assert!(largest(&map) < 1e-13 * before, "{degree}: {} of {before}", largest(&map));
        assert_eq!(map.missing(), missing);
    }
}

/// Condition number of the scaled normal equations of degree 8.
fn condition_of(map: &HeightMap) -> f64 {
    let gram = Basis::new(map.points, 8).gram(&map.heights);
    let scale = gram.diagonal().map(f64::sqrt);
    let scaled = |p, q| gram[(p, q)] / (scale[p] * scale[q]);
    condition(&DMatrix::from_fn(gram.nrows(), gram.ncols(), scaled))
}

#[test]
fn equations_are_well_conditioned_without_a_third_of_the_map() {
    for points in [[20, 20], [300, 40], [2048, 16]] {
        let heights = vec![0.0; points[0] * points[1]];
        let map = HeightMap { name: "map".into(), points, spacing: [1e-5; 2], heights };
        assert!(condition_of(&map) < 10.0, "{points:?}");
    }
    let mut map = polynomial([100, 100], 8, 1.0);
    (0..10_000).filter(|k| k % 100 > 65).for_each(|k| map.heights[k] = f64::NAN);
    let before = largest(&map);
    assert!((1e7..1e8).contains(&condition_of(&map)), "{:e}", condition_of(&map));
    remove_form(&mut map, FormOfMap::Polynomial(8)).unwrap();
    assert!(largest(&map) < 1e-13 * before, "{}", largest(&map));
}

#[test]
fn a_tilted_plane_has_its_slopes_level_and_rms() {
    let (points, spacing) = ([40, 25], [2e-5, 5e-5]);
    let mut heights = Vec::new();
    for (j, i) in (0..25).flat_map(|j| (0..40).map(move |i| (j, i))) {
        heights.push(3e-3 + 0.2 * f64::from(i) * 2e-5 - 0.1 * f64::from(j) * 5e-5);
    }
    let mut map = HeightMap { name: "map".into(), points, spacing, heights };
    for form in [FormOfMap::Mean, FormOfMap::Plane] {
        let removed = remove_form(&mut map.clone(), form).unwrap();
        let tilt = removed.tilt.unwrap();
        approx::assert_relative_eq!(tilt[0], 0.2, max_relative = 1e-12);
        approx::assert_relative_eq!(tilt[1], -0.1, max_relative = 1e-12);
    }
    let removed = remove_form(&mut map, FormOfMap::Plane).unwrap();
    // The middle of the map: half the rise along either axis above the corner.
    let level = 3.0 + 0.2 * 19.5 * 0.02 - 0.1 * 12.0 * 0.05;
    approx::assert_relative_eq!(removed.legendre_coefficients_mm[0], level, max_relative = 1e-13);
    // The variance of n equidistant points is (n^2 - 1) / 12 steps squared.
    let variance = |slope_step: f64, n: f64| slope_step.powi(2) * (n * n - 1.0) / 12.0;
    let rms = (variance(0.2 * 0.02, 40.0) + variance(0.1 * 0.05, 25.0)).sqrt();
    approx::assert_relative_eq!(removed.rms_mm, rms, max_relative = 1e-12);
}

#[test]
fn the_result_is_independent_of_units() {
    let waves = |unit: f64| {
        let mut map = polynomial([50, 70], 3, unit);
        map.heights.iter_mut().enumerate().for_each(|(k, z)| *z += unit * (k as f64).sin());
        let removed = remove_form(&mut map, FormOfMap::Polynomial(2)).unwrap();
        (map, removed)
    };
    let ((metres, in_m), (nanometres, in_nm)) = (waves(1e-3), waves(1e6));
    let largest = largest(&metres);
    for (a, b) in metres.heights.iter().zip(&nanometres.heights).filter(|(a, _)| !a.is_nan()) {
        assert!((a - b * 1e-9).abs() < 1e-12 * largest);
    }
    approx::assert_relative_eq!(in_m.rms_mm, in_nm.rms_mm * 1e-9, max_relative = 1e-12);
}

/// Least squares: what is left is orthogonal to every monomial up to the degree.
#[test]
fn the_remainder_is_orthogonal_to_the_form() {
    let mut map = polynomial([50, 70], 6, 1.0);
    remove_form(&mut map, FormOfMap::Polynomial(4)).unwrap();
    for (n, b) in (0..=4).flat_map(|n| (0..=n).map(move |b| (n, b))) {
        let monomial = |k: usize| (k % 50) as f64 / 50.0;
        let moment: f64 = (0..map.heights.len())
            .filter(|&k| !map.heights[k].is_nan())
            .map(|k| map.heights[k] * monomial(k).powi(n - b) * ((k / 50) as f64 / 70.0).powi(b))
            .sum();
        // 3500 terms of order 1 to 10.
        assert!(moment.abs() < 1e-10, "{n} {b}: {moment}");
    }
}

#[test]
fn points_that_do_not_determine_the_form_are_told() {
    let mut few = polynomial([3, 1], 1, 1.0);
    let error = remove_form(&mut few, FormOfMap::Polynomial(2)).unwrap_err();
    assert!(matches!(error, MapFormError::TooFew { coefficients: 6, degree: 2, .. }), "{error}");
    // One row determines no slope across it.
    let mut row = polynomial([300, 1], 1, 1.0);
    let error = remove_form(&mut row, FormOfMap::Plane).unwrap_err();
    assert!(matches!(error, MapFormError::Undetermined { degree: 1, .. }), "{error}");
    assert_eq!(remove_form(&mut row, FormOfMap::Mean).unwrap().tilt, None);
    let mut corner = polynomial([100, 100], 8, 1.0);
    (0..10_000).filter(|k| k % 100 > 9).for_each(|k| corner.heights[k] = f64::NAN);
    assert!(remove_form(&mut corner, FormOfMap::Polynomial(8)).is_err());
}
