//! Depths and levels of profiles of which they are known.

use super::*;

const SPACING: f64 = 5e-4;

/// A tilted series of waves of 20 mm, of which a segment of 100 mm holds five.
fn waves(amplitude: f64) -> Vec<f64> {
    (0..1000).map(|i| amplitude * (TAU * (f64::from(i) + 0.5) / 40.0).cos()).collect()
}

fn depths_of(heights: &[f64], spacing: f64, options: &DepthOptions) -> Vec<SegmentDepth> {
    mean_profile_depths(heights, spacing, options).unwrap()
}

#[test]
fn profiles_too_coarse_for_texture_and_filters_without_effect_are_refused() {
    let usual = DepthOptions::default();
    let heights = waves(1e-3);
    for spacing in [1.01e-3, 25e-3, 0.25] {
        let refused = mean_profile_depths(&heights, spacing, &usual).unwrap_err();
        assert_eq!(refused, DepthError::Spacing { spacing });
        assert!(refused.to_string().contains("asks for at most 1 mm"), "{refused}");
    }
    // One millimetre is allowed, also when fitted to positions.
    assert_eq!(depths_of(&heights, 1.0001e-3, &usual).len(), 10);
    let low_pass = DepthOptions { low_pass: 2e-3, ..usual };
    let refused = mean_profile_depths(&heights, 1e-3, &low_pass).unwrap_err();
    assert_eq!(refused, DepthError::LowPass { low_pass: 2e-3, spacing: 1e-3 });
    let segment = DepthOptions { segment: 3e-3, ..usual };
    let refused = mean_profile_depths(&heights, 1e-3, &segment).unwrap_err();
    assert_eq!(refused, DepthError::FewPoints { segment: 3e-3, points: 3 });
}

#[test]
fn the_depth_of_a_wave_is_its_amplitude_whatever_its_tilt() {
    let tilted =
        waves(1e-3).iter().enumerate().map(|(i, z)| z + 1e-5 * i as f64).collect::<Vec<_>>();
    let depths = depths_of(&tilted, SPACING, &DepthOptions::default());
    assert_eq!(depths.len(), 5);
    for segment in &depths {
        // The low-pass takes (2.4/20)^4 = 2e-4, the crest lies half a point off (3e-3), and a
        // line through five waves tilts by some per cent of the amplitude at each end.
        approx::assert_relative_eq!(segment.depth.unwrap(), 1e-3, max_relative = 0.06);
        assert_eq!(segment.interpolated, 0.0);
    }
}

#[test]
fn a_constructed_segment_has_its_known_depth() {
    // Even about the middle, so that the line is level: 2 mm in both halves over a mean of 0.5 mm.
    // Plateaus of 12.5 mm are long against the filter.
    let segment: Vec<f64> = (0..200)
        .map(|i| if (38..63).contains(&i) || (137..162).contains(&i) { 2e-3 } else { 0.0 })
        .collect();
    approx::assert_abs_diff_eq!(segment_depth(&segment, Form::Slope), 1.5e-3, epsilon = 1e-15);
}

#[test]
fn drop_outs_beyond_a_tenth_and_short_scans_have_no_depth() {
    let mut heights = waves(1e-3);
    heights[10..31].fill(f64::NAN);
    heights[200..220].fill(f64::NAN);
    let depths = depths_of(&heights, SPACING, &DepthOptions::default());
    assert_eq!((depths[0].depth, depths[0].interpolated), (None, 0.105));
    assert!(depths[1].depth.is_some());
    let refused = |heights: &[f64]| {
        mean_profile_depths(heights, SPACING, &DepthOptions::default()).unwrap_err()
    };
    assert_eq!(refused(&heights[..100]), DepthError::Short { length: 0.05, segment: 0.1 });
    assert_eq!(refused(&[f64::NAN; 400]), DepthError::NoHeights);
}

#[test]
fn the_choices_of_the_standard_can_be_made() {
    let heights = waves(1e-3);
    let usual = DepthOptions::default();
    let depths = |options| depths_of(&heights, SPACING, &options);
    let halved = DepthOptions { segment: 0.05, ..usual };
    assert_eq!(depths(halved).len(), 2 * depths(usual).len());
    // Nothing of a wave of 20 mm is left by a low-pass ten times as long.
    let flat = depths(DepthOptions { low_pass: 0.2, ..usual });
    assert!(flat[2].depth.unwrap() < 0.1e-3, "{flat:?}");
    let high = depths(DepthOptions { high_pass: Some(2e-3), ..usual });
    assert!(high[2].depth.unwrap() < 0.1e-3, "{high:?}");
    let mut spiked = heights.clone();
    spiked[100] += 9e-3;
    let blunt = DepthOptions { spike_slope: 30.0, ..usual };
    assert_eq!(depths_of(&spiked, SPACING, &blunt)[0].interpolated, 0.0);
    spiked[110..120].fill(f64::NAN);
    let strict = DepthOptions { most_drop_outs: 0.04, ..usual };
    assert_eq!(depths_of(&spiked, SPACING, &strict)[0].depth, None);
}

#[test]
fn spikes_are_interpolated() {
    let mut heights = waves(1e-3);
    let clean = depths_of(&heights, SPACING, &DepthOptions::default());
    heights[100] += 9e-3;
    let spiked = depths_of(&heights, SPACING, &DepthOptions::default());
    assert_eq!(spiked[0].interpolated, 1.0 / 200.0);
    // A wave of 40 points is straight between neighbours to 1.2 %.
    approx::assert_relative_eq!(
        spiked[0].depth.unwrap(),
        clean[0].depth.unwrap(),
        max_relative = 0.02
    );
}

#[test]
fn the_filters_have_their_three_decibels_at_3_and_140_mm() {
    let crest = |wavelength: f64, filter: &Butterworth, spacing: f64| {
        let points = 40_000;
        let heights: Vec<f64> = (0..=points)
            .map(|i| (TAU * f64::from(i - points / 2) * spacing / wavelength).cos())
            .collect();
        both_ways(&heights, filter)[points as usize / 2]
    };
    let both = |spacing: f64, wavelength: f64, cutoff: f64| {
        // The bilinear transform maps a wavenumber to the tangent of half of it.
        let tangent = |length: f64| (PI * spacing / length).tan();
        1.0 / (1.0 + (tangent(wavelength) / tangent(cutoff)).powi(4))
    };
    let spacing = 5e-5;
    let found = crest(3e-3, &Butterworth::low_pass(spacing / 2.4e-3), spacing);
    approx::assert_abs_diff_eq!(found, both(spacing, 3e-3, 2.4e-3), epsilon = 1e-9);
    approx::assert_abs_diff_eq!(found, 0.5_f64.sqrt(), epsilon = 3e-3);
    let spacing = 5e-4;
    let found = crest(0.14, &Butterworth::high_pass(spacing / 0.1742), spacing);
    approx::assert_abs_diff_eq!(found, 1.0 - both(spacing, 0.14, 0.1742), epsilon = 1e-9);
    approx::assert_abs_diff_eq!(found, 0.5_f64.sqrt(), epsilon = 3e-3);
}

fn spectrum(density: Vec<f64>, wavenumber_step: f64) -> PowerSpectrum {
    PowerSpectrum { wavenumber_step, density, routes: Vec::new() }
}

#[test]
fn bands_lose_no_power() {
    let density: Vec<f64> = (0..5000).map(|k| 1.0 / (1.0 + f64::from(k))).collect();
    let spectrum = spectrum(density, TAU / 0.1);
    let bands = texture_bands(&spectrum);
    let edge = |band: &TextureBand, side: f64| 0.1 / band.wavelength * 10_f64.powf(side / 20.0);
    let (first, last) = (&bands[0], &bands[bands.len() - 1]);
    let sum: f64 = bands.iter().map(|band| band.mean_square).sum();
    let whole = power(&spectrum, edge(first, -1.0), edge(last, 1.0));
    approx::assert_relative_eq!(sum, whole, max_relative = 1e-12);
    assert!(bands.windows(2).all(|pair| pair[0].wavelength > pair[1].wavelength));
}

#[test]
fn a_sine_stands_in_its_band_with_its_mean_square() {
    // Wavelength 10 mm, the centre of a band: the 100th wavenumber of a scan of 1 m.
    let mut density = vec![0.0; 2000];
    density[100] = 5e-13 / (TAU / 1.0);
    let bands = texture_bands(&spectrum(density, TAU / 1.0));
    let band = bands.iter().find(|band| (band.wavelength - 0.01).abs() < 1e-9).unwrap();
    approx::assert_relative_eq!(band.mean_square, 5e-13, max_relative = 1e-12);
    // An amplitude of 1 um has 3 dB less than its peak value.
    approx::assert_abs_diff_eq!(band.level(), -10.0 * 2_f64.log10(), epsilon = 1e-9);
}
