use super::super::test_maps::{gaussian, map, noise, with_gaps};
use super::*;
use crate::surface::LineScan;
use crate::surface::spectrum::{SpectrumPlan, self_affine_isotropic};
use approx::assert_relative_eq;

const WINDOWS: [Window; 3] = [Window::None, Window::Hann, Window::Welch];

#[test]
fn parseval_holds_for_even_and_odd_numbers_of_points() {
    for points in [[2, 2], [30, 20], [31, 20], [30, 21], [31, 17]] {
        let map = noise(points, [2e-6, 7e-6], 3);
        let count = map.heights.len() as f64;
        let mean = map.heights.iter().sum::<f64>() / count;
        for window in WINDOWS {
            let weights = points.map(|points| window.weights(points));
            let weight = |n: usize| (weights[0][n % points[0]] * weights[1][n / points[0]]).powi(2);
            let squares =
                map.heights.iter().enumerate().map(|(n, z)| weight(n) * (z - mean).powi(2));
            let power = squares.sum::<f64>() / (0..map.heights.len()).map(weight).sum::<f64>();
            let spectrum = ArealSpectrum::of(&map, window).unwrap();
            assert_relative_eq!(spectrum.power(), power, max_relative = 1e-12);
        }
    }
}

#[test]
fn the_density_is_its_definition() {
    let map = noise([7, 6], [2.0, 3.0], 5);
    let mean = map.heights.iter().sum::<f64>() / 42.0;
    let spectrum = ArealSpectrum::of(&map, Window::None).unwrap();
    for (k, l) in [(0, 1), (3, -2), (2, 3), (-1, 2), (-3, -3)] {
        let wave = |n: usize| {
            let phase = k as f64 * (n % 7) as f64 / 7.0 + l as f64 * (n / 7) as f64 / 6.0;
            Complex64::from_polar(map.heights[n] - mean, -TAU * phase)
        };
        let sum: Complex64 = (0..42).map(wave).sum();
        let exact = sum.norm_sqr() / (42.0_f64.powi(2) * TAU / 14.0 * TAU / 18.0);
        assert_relative_eq!(spectrum.density([k, l]), exact, epsilon = 1e-13);
    }
    assert_eq!(spectrum.density([4, 0]), 0.0);
}

#[test]
fn a_sine_carries_half_its_amplitude_squared_in_its_own_direction() {
    let (amplitude, [k, l]) = (2e-5, [12_isize, -7]);
    let (points, spacing) = ([120, 100], [1e-6, 2e-6]);
    let (qx, qy) = (TAU * 12.0 / 120e-6, -TAU * 7.0 / 200e-6);
    let map = map(points, spacing, |x, y| amplitude * (qx * x + qy * y).sin());
    for window in WINDOWS {
        let spectrum = ArealSpectrum::of(&map, window).unwrap();
        let power = amplitude.powi(2) / 2.0;
        // Welch's window is not the sum of two waves of the grid: mean(w^2 sin^2) is not quite half of mean(w^2).
        let tolerance = if window == Window::Welch { 1e-3 } else { 1e-12 };
        assert_relative_eq!(spectrum.power(), power, max_relative = tolerance);
        let peak = spectrum.density.iter().copied().fold(0.0, f64::max);
        assert_relative_eq!(spectrum.density([k, l]), peak);
        assert_relative_eq!(spectrum.density([-k, -l]), peak);
        let angle = (qy / qx).atan().to_degrees() + 180.0;
        assert_relative_eq!(spectrum.texture_direction(), angle, epsilon = 0.1);
        let sectors = spectrum.sectors([0.0, f64::INFINITY]);
        assert_relative_eq!(
            sectors.iter().map(|s| s.share).sum::<f64>(),
            1.0,
            max_relative = 1e-12
        );
        // 160.7 degrees: the sector about 160.
        assert!(sectors[16].angle == 160.0 && sectors[16].share > 0.98, "{:?}", sectors[16]);
    }
}

#[test]
fn the_rows_have_the_mean_of_their_periodograms() {
    for points in [[50, 20], [51, 21]] {
        let map = noise(points, [2e-6, 7e-6], 8);
        let mean = map.heights.iter().sum::<f64>() / map.heights.len() as f64;
        for window in WINDOWS {
            let plan = SpectrumPlan::new(points[0]).unwrap();
            let weights = window.weights(points[1]);
            let mut expected = vec![0.0; points[0] / 2 + 1];
            for (row, weight) in map.heights.chunks_exact(points[0]).zip(&weights) {
                let heights = row.iter().map(|z| z - mean).collect();
                let scan = LineScan { name: "07".into(), origin: 0.0, spacing: 2e-6, heights };
                let line = plan.periodogram(&scan, window).unwrap().density;
                expected.iter_mut().zip(line).for_each(|(sum, c)| *sum += weight * weight * c);
            }
            let squares: f64 = weights.iter().map(|w| w * w).sum();
            let rows = ArealSpectrum::of(&map, window).unwrap().rows();
            assert_relative_eq!(rows.wavenumber_step, TAU / (points[0] as f64 * 2e-6));
            for (found, sum) in rows.density.iter().zip(expected) {
                assert_relative_eq!(*found, sum / squares, max_relative = 1e-11);
            }
        }
    }
}

/// An isotropic self-affine map of 512 points in each direction.
fn self_affine(hurst: f64, random_amplitudes: bool) -> HeightMap {
    let density = |qx: f64, qy: f64| 1e-12 * qx.hypot(qy).powf(-2.0 - 2.0 * hurst);
    gaussian(512, [1e-3, 1e-3], density, random_amplitudes, 6)
}

#[test]
fn an_isotropic_self_affine_map_has_its_slope_and_its_rows_have_theirs() {
    let hurst = 0.8;
    let map = self_affine(hurst, false);
    let spectrum = ArealSpectrum::of(&map, Window::None).unwrap();
    for bin in spectrum.radial(10).iter().filter(|bin| bin.modes > 100) {
        let exact = 1e-12 * bin.wavenumber.powf(-2.0 - 2.0 * hurst);
        // A mean over a ring a tenth of a decade wide of q^-3.6: up to sinh(0.41) / 0.41 = 3 % more.
        assert!((0.99..1.04).contains(&(bin.density / exact)), "{bin:?} {exact}");
    }
    let rows = spectrum.rows();
    for k in [8, 12, 16, 24] {
        let q = rows.wavenumber(k);
        let plane = self_affine_isotropic(q, rows.density[k], hurst);
        // What is beyond the Nyquist wavenumber is missing: less than 1 % up to a tenth of it.
        assert_relative_eq!(plane, 1e-12 * q.powf(-2.0 - 2.0 * hurst), max_relative = 0.01);
    }
}

#[test]
fn the_window_keeps_level_and_slope_of_a_cut_map_and_all_directions_are_alike() {
    let hurst = 0.7;
    let whole = self_affine(hurst, true);
    // A quarter of the periodic map: its ends do not meet.
    let cut = |n: usize| whole.heights[(n / 256) * 512 + n % 256];
    let map =
        HeightMap { points: [256; 2], heights: (0..256 * 256).map(cut).collect(), ..whole.clone() };
    let spectrum = ArealSpectrum::of(&map, Window::Hann).unwrap();
    let bins = spectrum.radial(5);
    let used: Vec<_> = bins.iter().filter(|bin| bin.modes > 1500).collect();
    assert!(used.len() >= 4);
    for bin in used {
        let exact = 1e-12 * bin.wavenumber.powf(-2.0 - 2.0 * hurst);
        // The mean over a ring a fifth of a decade wide of q^-3.4: up to 11 % more; four standard errors beside.
        let ratio = bin.density / exact;
        assert!(ratio > 0.98 - 4.0 * bin.standard_error / exact, "{bin:?} {exact}");
        assert!(ratio < 1.13 + 4.0 * bin.standard_error / exact, "{bin:?} {exact}");
    }
    let step = spectrum.step[0];
    for sector in spectrum.sectors([30.0 * step, 128.0 * step]) {
        // 18 sectors; the modes of the lower end count most, some hundred of them.
        assert_relative_eq!(sector.share, 1.0 / 18.0, max_relative = 0.35);
    }
}

#[test]
fn gaps_are_an_error() {
    let gappy = with_gaps(noise([20, 20], [1.0; 2], 1), 5);
    let missing = gappy.missing();
    let error = ArealSpectrum::of(&gappy, Window::Hann).unwrap_err();
    assert_eq!(error, ArealError::Gaps { map: "07".into(), missing });
}
