//! The same map in a second implementation: surfalize 0.19.2 (F. Schell, https://github.com/fredericjs/surfalize).

use super::test_maps::map;
use super::{ArealParameters, HeightMap};
use approx::assert_relative_eq;
use std::f64::consts::{PI, TAU};

/// Forty sines with wavelengths from 60 down to 1.46 in ratios of 1.1 and directions that do not repeat, with the heights
/// of a Hurst exponent of 0.8, and their upper part pressed flatter.
fn forty_sines(spacing: [f64; 2]) -> HeightMap {
    map([240, 200], spacing, |x, y| {
        let sine = |n: i32| {
            let (q, m) = (TAU / 60.0 * 1.1_f64.powi(n), f64::from(n));
            let angle = m * m * 0.61803398875 * PI + m * 2.39996322973;
            q.powf(-0.8) * 0.05 * (q * (x * angle.cos() + y * angle.sin()) + 1.7 * m * m).sin()
        };
        let z: f64 = (0..40).map(sine).sum();
        z - 0.12 * z * z
    })
}

/// Values of surfalize in the order of [`ours`], Sdr, Smr1 and Smr2 in %.
const EQUAL_SPACING: [f64; 20] = [
    0.4498824491074588,
    0.5676870794326309,
    -0.48715150107735816,
    3.2222414957349352,
    1.5102250125324719,
    2.35795056601228,
    3.8681755785447516,
    0.19430995460362824,
    1.851840541083738,
    11.105011898112725,
    0.6091971933695965,
    1.4100089646491198,
    0.3606698438613661,
    0.7122068855393208,
    7.6926925942153295,
    87.05858244315844,
    0.019330361343069997,
    0.5159068179711623,
    0.6303758685208708,
    0.07892050794369122,
];
const UNEQUAL_SPACING: [f64; 20] = [
    0.448503422081237,
    0.5642682728014837,
    -0.4599206987571027,
    3.1833252977632474,
    1.5064361985961487,
    2.3555596253783744,
    3.861995823974523,
    0.18708928878783193,
    1.7191173531488912,
    11.020236637453637,
    0.5976943946294773,
    1.4158924543233984,
    0.3657919309259192,
    0.6942445664483624,
    7.581195459811093,
    87.37392679807219,
    0.019849802981006744,
    0.5163891430241186,
    0.6276158501188805,
    0.0765388366019193,
];

fn ours(p: &ArealParameters) -> [f64; 20] {
    let f = p.functional;
    let (sal, str) = (p.sal.unwrap(), p.str.unwrap());
    let percent = [p.sdr, f.smr1, f.smr2].map(|share| 100.0 * share);
    [
        p.sa, p.sq, p.ssk, p.sku, p.sp, p.sv, p.sz, p.sdq, percent[0], sal, str, f.sk, f.spk,
        f.svk, percent[1], percent[2], f.vmp, f.vmc, f.vvc, f.vvv,
    ]
}

/// The same, on the same map, with numpy and scipy: Sal and Str by a cubic spline of the autocorrelation of surfalize in
/// 3601 directions, the others by sums over all points; Sk, Spk, Svk, Smr1, Smr2 (as shares), Vmp, Vmc, Vvc, Vvv.
const DIRECT: [[f64; 11]; 2] = [
    [
        11.078100243479467,
        0.6073524556466775,
        1.4100341646127876,
        0.36176513076150113,
        0.7124471614468169,
        0.07694044092121052,
        0.8705846723422047,
        0.01934519422983926,
        0.5162405205333191,
        0.6303892411501966,
        0.07893366640528117,
    ],
    [
        11.016246457207712,
        0.5976361004890978,
        1.4160257825446243,
        0.36657111310033197,
        0.6946631893920859,
        0.07579741881411264,
        0.873758035798835,
        0.01988550317318403,
        0.5166344488319938,
        0.6276524846283326,
        0.07654877950525855,
    ],
];

#[test]
fn all_parameters_are_those_of_the_second_implementation() {
    // Heights, gradient and area are the same sums over the same triangles: round-off. Sal and Str: surfalize reads the
    // autocorrelation along rays to the pixels at the border of the region above 0.2, which are few: it misses the shortest
    // and the longest by some tenths of a per cent. The Sk family: surfalize takes 10000 quantiles instead of all 48000
    // points, and ends the areas of Spk, Svk and the volumes at the nearest of these.
    let tolerance = |n: usize| match n {
        0..=8 => 1e-11,
        9 | 10 => 6e-3,
        11 | 14 | 15 => 3e-4,
        12 | 13 => 4e-3,
        _ => 2.5e-3,
    };
    for (spacing, theirs) in [([1.0, 1.0], EQUAL_SPACING), ([1.0, 1.3], UNEQUAL_SPACING)] {
        let found = ours(&ArealParameters::of(&forty_sines(spacing)).unwrap());
        for (n, (a, b)) in found.iter().zip(theirs).enumerate() {
            assert_relative_eq!(*a, b, max_relative = tolerance(n));
        }
    }
}

#[test]
fn lengths_and_material_ratio_curve_are_those_of_direct_sums() {
    for (spacing, [sal, str, rest @ ..]) in [[1.0, 1.0], [1.0, 1.3]].into_iter().zip(DIRECT) {
        let p = ArealParameters::of(&forty_sines(spacing)).unwrap();
        // Cubic polynomials through four points instead of a spline through all, of a map whose shortest waves its points
        // do not resolve.
        assert_relative_eq!(p.sal.unwrap(), sal, max_relative = 5e-4);
        assert_relative_eq!(p.str.unwrap(), str, max_relative = 3e-3);
        let f = p.functional;
        let found = [f.sk, f.spk, f.svk, f.smr1, f.smr2, f.vmp, f.vmc, f.vvc, f.vvv];
        for (a, b) in found.into_iter().zip(rest) {
            // The sums end at a point instead of between two: parts of 1/48000 squared.
            assert_relative_eq!(a, b, max_relative = 1e-8);
        }
    }
}

#[test]
fn the_texture_direction_is_that_of_the_second_implementation() {
    // Three waves of the grid, since surfalize has no window and the ends of others would leak along the axes; steps of
    // half a degree, of which it gives the lower end; its rows turned round, as it counts them from above.
    for (dy, theirs) in [(1.0, 55.5), (1.3, 48.0)] {
        let wave = |x: f64, y: f64, k: f64, l: f64| TAU * (k * x / 240.0 + l * y / (200.0 * dy));
        let map = map([240, 200], [1.0, dy], |x, y| {
            let rest = 0.3 * (wave(x, y, 5.0, 40.0) + 2.0).sin();
            wave(x, y, 9.0, 11.0).sin() + 0.4 * (wave(x, y, 30.0, -20.0) + 1.0).sin() + rest
        });
        let std = ArealParameters::of(&map).unwrap().std;
        // The window spreads a wave over its neighbours, here 4 degrees away: a few tenths of a degree.
        assert!((theirs - 0.3..theirs + 0.8).contains(&std), "{std}");
    }
}
