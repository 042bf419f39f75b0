//! Whether the interval over windows of a road holds what it promises.

use crate::surfaces::table_2_1;
use asperity::contact::SlidingContact;
use asperity::numerics::statistics::MeanEstimate;
use asperity::rubber::Rubber;
use asperity::surface::realisation::random_phases;
use asperity::surface::{Closure, LineScan, PeriodicProfile, SineScale, wave};
use rayon::prelude::*;

const SPECIMENS: u64 = 1000;
const WINDOWS: u64 = 6;
const WINDOW_M: f64 = 8e-3;
const SHORTEST_M: f64 = 0.5e-3;
const POINTS: usize = 512;

/// Friction at 0.2 MPa of a window of 8 mm, cut from a road of its own that repeats after 32 mm.
fn friction(rubber: &Rubber, seed: u64, window: u64) -> f64 {
    let road_m = 4.0 * WINDOW_M;
    let scale = |k: u32| {
        let wavelength = road_m / f64::from(k);
        SineScale { wavelength, amplitude: 0.012 * wavelength * (f64::from(k)).powf(-0.2) }
    };
    let scales: Vec<SineScale> = (1..=160).rev().map(scale).collect();
    let road = wave::sample(&random_phases(&scales, seed, window), road_m, 2048);
    let heights = road[..512].to_vec();
    let cut = LineScan { name: "w".into(), origin: 0.0, spacing: road_m / 2048.0, heights };
    let profile = PeriodicProfile::new(&cut, Closure::Mirror, SHORTEST_M, 0.0).unwrap();
    let heights = wave::sample(&profile.waves, profile.period, POINTS);
    let mut contact = SlidingContact::new(rubber, 0.01, profile.period, &heights).unwrap();
    contact.solve(2e5).unwrap().friction_coefficient
}

#[test]
fn the_interval_over_windows_holds_the_mean_of_the_road_as_often_as_it_says() {
    let rubber = table_2_1();
    let specimens: Vec<MeanEstimate> = (1..=SPECIMENS)
        .into_par_iter()
        .map(|seed| {
            let windows: Vec<f64> =
                (1..=WINDOWS).map(|window| friction(&rubber, seed, window)).collect();
            MeanEstimate::of(&windows)
        })
        .collect();
    let truth = specimens.iter().map(|estimate| estimate.mean).sum::<f64>() / SPECIMENS as f64;
    let held = specimens.iter().filter(|e| (e.mean - truth).abs() <= e.confidence_95).count();
    let share = held as f64 / SPECIMENS as f64;
    println!("{share}");
    assert!((0.93..=0.97).contains(&share), "{share}");
}
