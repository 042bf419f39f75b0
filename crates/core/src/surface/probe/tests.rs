use super::*;
use std::f64::consts::TAU;

const SPACING: f64 = 1e-6;

fn scan(heights: Vec<f64>) -> LineScan {
    LineScan { name: "scan".into(), origin: 0.0, spacing: SPACING, heights }
}

fn of_tip(radius: f64, scans: &[LineScan]) -> f64 {
    let probe = Probe { spot_diameter: None, tip_radius: Some(radius) };
    probe.shortest_reliable_wavelength(scans)
}

/// What a parabolic tip traces of a surface: the largest of the surface less the tip above it.
fn traced(heights: &[f64], radius: f64) -> Vec<f64> {
    let reach = 400;
    (0..heights.len())
        .map(|i| {
            let under = i.saturating_sub(reach)..(i + reach + 1).min(heights.len());
            let touching = |j: usize| {
                let distance = j.abs_diff(i) as f64 * SPACING;
                heights[j] - distance * distance / (2.0 * radius)
            };
            under.map(touching).fold(f64::NEG_INFINITY, f64::max)
        })
        .collect()
}

/// The root mean square of second differences over the square of the lag.
fn rms_curvature(heights: &[f64], k: usize) -> f64 {
    let count = (heights.len() - 2 * k) as f64;
    let squares = (k..heights.len() - k)
        .map(|i| (heights[i + k] - 2.0 * heights[i] + heights[i - k]).powi(2))
        .sum::<f64>();
    (squares / count).sqrt() / (k as f64 * SPACING).powi(2)
}

#[test]
fn the_coarsest_limit_counts() {
    let flat = [scan(vec![0.0; 100])];
    let wavelength = |probe: Probe| probe.shortest_reliable_wavelength(&flat);
    assert_eq!(wavelength(Probe::default()), 2e-6);
    assert_eq!(wavelength(Probe { spot_diameter: Some(0.4e-6), tip_radius: None }), 2e-6);
    assert_eq!(wavelength(Probe { spot_diameter: Some(50e-6), tip_radius: None }), 1e-4);
    assert_eq!(wavelength(Probe { spot_diameter: None, tip_radius: Some(5e-6) }), 2e-6);
}

#[test]
fn one_needle_decides_which_the_root_mean_square_does_not_see() {
    // A needle of height h is traced as the tip upside down, of half width sqrt(2 R h). At its top
    // the curvature is 1/R within that, 2 h / s² beyond, which falls to 1/(2 R) at s = 2 sqrt(R h).
    let (height, radius) = (2e-6, 5e-6_f64);
    let mut heights = vec![0.0; 20_001];
    heights[10_000] = height;
    let measured = traced(&heights, radius);
    let exact = 4.0 * (radius * height).sqrt();
    let found = of_tip(radius, &[scan(vec![0.0; 50]), scan(measured.clone())]);
    assert!(found >= exact && found <= exact + 2.0 * SPACING, "{found} {exact}");
    // By the root mean square every lag of it is reliable.
    assert!((1..100).all(|k| rms_curvature(&measured, k) < 0.5 / radius));
    // A gap at the top leaves the flanks, which are not sharp at longer lags.
    let mut gap = measured;
    gap[9_990..10_011].fill(f64::NAN);
    assert!(of_tip(radius, &[scan(gap)]) < exact);
}

#[test]
fn cusps_in_valleys_say_nothing_and_on_crests_all() {
    // Crests of a curvature of 0.4 against 2 of half the tip, and cusps between them.
    let (amplitude, q, radius) = (1e-6, TAU / 1e-5 / 1000.0, 1e-3);
    let arches = |sign: f64| {
        let heights =
            (0..20_000).map(|i| sign * amplitude * (q * f64::from(i) * SPACING).cos().abs());
        of_tip(radius, &[scan(heights.collect())])
    };
    assert!(amplitude * q * q < 0.5 / radius);
    assert_eq!(arches(1.0), 2.0 * SPACING);
    assert!(arches(-1.0) > 4.0 * SPACING, "{}", arches(-1.0));
}

#[test]
fn a_sine_is_reliable_where_its_own_crests_say() {
    // -z'' of second differences at the crest: 2 a (1 - cos q s) / s².
    let (amplitude, wavelength, radius) = (1e-6, 100e-6, 100e-6);
    let heights = (0..2000).map(|i| amplitude * (TAU * f64::from(i) * SPACING / wavelength).cos());
    let curvature =
        |s: f64| 2.0 * amplitude * (1.0 - (TAU * s / wavelength).cos()) / (s * s) - 0.5 / radius;
    // The curvature falls from q² a up to a whole wave: halve the interval that holds its root.
    let (mut low, mut high) = (1e-7, wavelength);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if curvature(middle) > 0.0 { low = middle } else { high = middle }
    }
    let found = of_tip(radius, &[scan(heights.collect())]);
    assert!(found >= 2.0 * low && found <= 2.0 * low + 2.0 * SPACING, "{found} {low}");
}

#[test]
fn traced_waves_are_as_they_were_from_the_cut_off_on_and_not_below() {
    // Sums of sines with the spectrum of a self-affine line of H = 0.8, from 8 to 2048 um.
    let points: usize = 8192;
    let waves: Vec<(f64, f64, f64)> = (4..=1024_u32)
        .map(|n| {
            let q = TAU * f64::from(n) / points as f64;
            (
                q,
                0.3e-6 * f64::from(n).powf(-1.3) * 300.0,
                TAU * (0.618_034 * f64::from(n * n)).fract(),
            )
        })
        .collect();
    let height = |i: usize| waves.iter().map(|(q, a, p)| a * (q * i as f64 + p).cos()).sum();
    let heights: Vec<f64> = (0..points).map(height).collect();
    let radius = 20e-6;
    let measured = traced(&heights, radius);
    let cut_off = of_tip(radius, &[scan(measured.clone())]);
    assert!(cut_off > 8e-6 && cut_off < 1e-3, "{cut_off}");
    let lost = |k: usize| {
        let square = |z: &[f64]| {
            z.iter().zip(&z[k..]).map(|(a, b)| (b - a).powi(2)).sum::<f64>() / (z.len() - k) as f64
        };
        1.0 - square(&measured) / square(&heights)
    };
    let at = (cut_off / 2.0 / SPACING).round() as usize;
    // The correlation at half the cut-off has lost little, that at a tenth of it much more.
    assert!(lost(2 * at).abs() < 0.1, "{}", lost(2 * at));
    assert!(
        lost((at / 8).max(1)) > 3.0 * lost(2 * at).abs(),
        "{} {}",
        lost((at / 8).max(1)),
        lost(2 * at)
    );
}
