use super::super::test_maps::{gaussian, map, noise, with_gaps};
use super::*;
use approx::assert_relative_eq;
use std::f64::consts::{PI, TAU};

fn of(map: &HeightMap) -> ArealParameters {
    ArealParameters::of(map).unwrap()
}

#[test]
fn a_tilted_sine_has_its_exact_moments_and_gradient() {
    let (amplitude, points, spacing) = (2e-7, [400, 300], [1e-6, 2e-6]);
    // 8 waves along x and 5 along y: every phase equally often.
    let q = [TAU * 8.0 / 400e-6, TAU * 5.0 / 600e-6];
    let p = of(&map(points, spacing, |x, y| amplitude * (q[0] * x + q[1] * y + 0.1).sin()));
    assert_relative_eq!(p.sq, amplitude / 2_f64.sqrt(), max_relative = 1e-12);
    assert_relative_eq!(p.sku, 1.5, max_relative = 1e-12);
    assert!(p.ssk.abs() < 1e-12);
    // |z| has a kink: its mean over some 1200 phases misses 2 D / pi by 1e-5.
    assert_relative_eq!(p.sa, 2.0 * amplitude / PI, max_relative = 1e-5);
    assert_relative_eq!(p.sp, amplitude, max_relative = 1e-4);
    assert_relative_eq!(p.sz, p.sp + p.sv);
    // First differences damp each direction by sin(a) / a; the open ends lack one of 400 and one of 300.
    let slope = |axis: usize| {
        let a = q[axis] * spacing[axis] / 2.0;
        (q[axis] * a.sin() / a).powi(2)
    };
    let rms = amplitude * f64::midpoint(slope(0), slope(1)).sqrt();
    assert_relative_eq!(p.sdq, rms, max_relative = 3e-3);
    assert_relative_eq!(p.sdq, amplitude * q[0].hypot(q[1]) / 2_f64.sqrt(), max_relative = 5e-3);
    // Sdr of a gentle sine is half the mean square gradient.
    assert_relative_eq!(p.sdr, p.sdq.powi(2) / 2.0, max_relative = 5e-3);
    // The window spreads the wave over its neighbours, here 6 degrees away.
    assert_relative_eq!(p.std, (q[1] / q[0]).atan().to_degrees(), epsilon = 0.3);
    // cos(q s) = 0.2 along the wave; pairs at an end of the map do not average out.
    let exact = 0.2_f64.acos() / q[0].hypot(q[1]);
    assert_relative_eq!(p.sal.unwrap(), exact, max_relative = 0.02);
}

#[test]
fn the_developed_area_of_a_plane_is_exact_for_unequal_spacing() {
    // z = 3 x + 4 y: sqrt(26) - 1; gradient 5.
    let p = of(&map([12, 9], [0.5, 0.25], |x, y| 3.0 * x + 4.0 * y));
    assert_relative_eq!(p.sdr, 26_f64.sqrt() - 1.0, max_relative = 1e-12);
    assert_relative_eq!(p.sdq, 5.0, max_relative = 1e-12);
}

#[test]
fn a_cut_plane_has_the_parameters_of_its_material_ratio_curve() {
    // A ramp along x cut level at 0.6 of its height: c(p) = min(1 - p, 0.6) less the mean.
    let p = of(&map([1000, 8], [1e-3; 2], |x, _| (x + 0.5e-3).min(0.6)));
    // The first 40 % are level: no fall, Sk = 0 at the top, and all below is valley: 2 0.18 / 0.6.
    let f = p.functional;
    assert!(f.sk.abs() < 1e-12 && f.spk.abs() < 1e-12, "{f:?}");
    assert_relative_eq!(f.smr2, 0.4, epsilon = 1e-3);
    assert_relative_eq!(f.svk, 0.6, max_relative = 2e-3);
    assert!(f.vmp.abs() < 1e-12);
    // Void below c(0.8) = 0.2 is a triangle of 0.2 by 0.2; material above it is 0.8 0.6 - 0.4^2 / 2 - 0.8 0.2.
    assert_relative_eq!(f.vvv, 0.02, max_relative = 1e-4);
    assert_relative_eq!(f.vmc, 0.48 - 0.08 - 0.16, max_relative = 1e-4);
    assert_relative_eq!(f.vvc, 0.18 - 0.02, max_relative = 1e-4);
}

#[test]
fn a_gaussian_map_has_gaussian_moments_and_is_isotropic() {
    let length = 5.0_f64;
    let density = |qx: f64, qy: f64| (-(length * qx.hypot(qy)).powi(2) / 2.0).exp();
    let p = of(&gaussian(512, [1.0, 1.0], density, true, 9));
    // Some 3000 areas of correlation: standard errors sqrt(6 / 3000) and sqrt(24 / 3000), four of them.
    assert!(p.ssk.abs() < 0.18, "{}", p.ssk);
    assert_relative_eq!(p.sku, 3.0, epsilon = 0.36);
    assert_relative_eq!(p.sa / p.sq, (2.0 / PI).sqrt(), max_relative = 0.02);
    // ACF = exp(-s^2 / (2 length^2)) = 0.2; the extremes over all directions are a few per cent off.
    let exact = length * (2.0 * 5_f64.ln()).sqrt();
    assert_relative_eq!(p.sal.unwrap(), exact, max_relative = 0.08);
    assert!(p.str.unwrap() > 0.85 && !p.str_is_upper_bound, "{:?}", p.str);
    // Mean square gradient of that ACF: 2 / length^2, first differences 1 % low.
    assert_relative_eq!(p.sdq / p.sq, 2_f64.sqrt() / length, max_relative = 0.05);
}

#[test]
fn ridges_have_an_aspect_near_zero_and_say_that_it_is_a_bound() {
    let ridges = noise([200, 1], [1e-6, 1.0], 2).heights;
    let p = of(&map([200, 150], [1e-6, 3e-6], |x, _| ridges[(x / 1e-6).round() as usize]));
    // Within one point across, beyond half of 150 points along.
    assert!(p.sal.unwrap() < 1e-6 && p.str.unwrap() < 1.0 / 200.0, "{p:?}");
    assert!(p.str_is_upper_bound);
    assert!(p.std.min(180.0 - p.std) < 1e-6, "{}", p.std);
}

#[test]
fn a_stretched_grid_is_the_same_surface() {
    let density = |qx: f64, qy: f64| (-(30.0 * qx).powi(2) / 2.0 - (30.0 * qy).powi(2) / 2.0).exp();
    let p = of(&gaussian(300, [3.0, 5.0], density, true, 4));
    let exact = 30.0 * (2.0 * 5_f64.ln()).sqrt();
    assert_relative_eq!(p.sal.unwrap(), exact, max_relative = 0.12);
    assert!(p.str.unwrap() > 0.8, "{p:?}");
}

#[test]
fn missing_points_do_not_count() {
    let density = |qx: f64, qy: f64| (-(8.0 * qx.hypot(qy)).powi(2) / 2.0).exp();
    let whole = gaussian(256, [1.0, 1.0], density, true, 3);
    let gappy = with_gaps(whole.clone(), 5);
    assert!(gappy.missing() > 256 * 256 / 6);
    let (a, b) = (of(&whole), of(&gappy));
    for (a, b) in [(a.sa, b.sa), (a.sq, b.sq), (a.sdq, b.sdq), (a.sdr, b.sdr)] {
        assert_relative_eq!(a, b, max_relative = 0.01);
    }
    assert_relative_eq!(a.sal.unwrap(), b.sal.unwrap(), max_relative = 0.02);
    assert_relative_eq!(a.functional.sk, b.functional.sk, max_relative = 0.02);
    // A height of a missing point cannot matter: by hand, three heights of a square and one gap.
    let mut small = map([4, 4], [1.0; 2], |x, y| x + 2.0 * y);
    small.heights[15] = f64::NAN;
    let p = of(&small);
    assert_relative_eq!(p.sdq, 5_f64.sqrt(), max_relative = 1e-14);
    assert_relative_eq!(p.sz, 8.0, max_relative = 1e-14);
}

#[test]
fn what_has_no_parameters_is_an_error() {
    let error = |map: &HeightMap| ArealParameters::of(map).unwrap_err();
    let flat = map([5, 5], [1.0; 2], |_, _| 0.1);
    assert!(matches!(error(&flat), ArealError::Flat { height: 0.1, .. }));
    assert!(matches!(error(&map([3, 9], [1.0; 2], |x, _| x)), ArealError::TooSmall { nx: 3, .. }));
    assert!(matches!(error(&map([0, 0], [1.0; 2], |x, _| x)), ArealError::TooSmall { .. }));
    let missing = HeightMap { heights: vec![f64::NAN; 25], ..flat.clone() };
    assert!(matches!(error(&missing), ArealError::TooFewHeights { valid: 0, points: 25, .. }));
    let corner = |n: usize| if [0, 1, 5].contains(&n) { n as f64 } else { f64::NAN };
    let corner = HeightMap { heights: (0..25).map(corner).collect(), ..flat.clone() };
    assert!(matches!(error(&corner), ArealError::TooFewHeights { valid: 3, least: 4, .. }));
    let rows = |n: usize| if (n / 5).is_multiple_of(2) { n as f64 } else { f64::NAN };
    let rows = HeightMap { heights: (0..25).map(rows).collect(), ..flat };
    assert!(matches!(error(&rows), ArealError::NoNeighbours { .. }));
}
