//! Contacts of one to eight waves on 2^10 to 2^20 points, contact area 5 %.

use asperity::contact::SlidingContact;
use asperity::rubber::{MaxwellBranch, Rubber};
use asperity::surface::{Wave, wave};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Duration;

/// Wavelengths and amplitudes in mm of thesis Table 3.1.
const WAVES_MM: [(f64, f64); 8] = [
    (0.0625, 0.01867),
    (0.125, 0.02648),
    (0.25, 0.02939),
    (0.5, 0.06626),
    (1.0, 0.06177),
    (2.0, 0.21635),
    (4.0, 0.14772),
    (8.0, 0.48995),
];

/// Moduli in MPa and relaxation times in s of thesis Table 2.1.
const BRANCHES: [(f64, f64); 6] = [
    (1.72, 1.134e-2),
    (7.36, 2.628e-4),
    (70.98, 1.316e-5),
    (505.87, 1.295e-6),
    (1125.85, 7.708e-8),
    (1185.94, 4.200e-10),
];

fn contact(waves: usize, points: usize) -> SlidingContact {
    let branch = |(modulus_mpa, relaxation_time): (f64, f64)| MaxwellBranch {
        modulus: 1e6 * modulus_mpa,
        relaxation_time,
    };
    let rubber = Rubber {
        name: "Table 2.1".into(),
        equilibrium_modulus: 4.17e6,
        branches: BRANCHES.into_iter().map(branch).collect(),
        poisson_ratio: 0.49,
    };
    let mut generator = Pcg64::seed_from_u64(1);
    let sines: Vec<Wave> = WAVES_MM[..waves]
        .iter()
        .map(|(wavelength, amplitude)| Wave {
            wavelength: 1e-3 * wavelength,
            amplitude: 1e-3 * amplitude,
            phase: TAU * generator.random::<f64>(),
        })
        .collect();
    let period = 1e-3 * WAVES_MM[waves - 1].0;
    let heights = wave::sample(&sines, period, points);
    SlidingContact::new(&rubber, 0.01, period, &heights).expect("the profile is sound")
}

fn solve(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("solve");
    for (waves, points) in [(1, 1 << 10), (8, 1 << 13), (8, 1 << 16), (8, 1 << 18), (8, 1 << 20)] {
        // The large grids take seconds a solve.
        let samples = if points > 1 << 16 { 10 } else { 30 };
        group.sample_size(samples).warm_up_time(Duration::from_millis(500));
        group.measurement_time(Duration::from_secs(5));
        let mut contact = contact(waves, points);
        let wanted = contact.solve_for_area(0.05, 1e-2).expect("the grid holds this area");
        let pressure = wanted.mean_pressure;
        let id = BenchmarkId::new(format!("{waves} waves"), points);
        group.bench_function(id, |bencher| {
            bencher.iter(|| contact.solve(black_box(pressure)).expect("the contact converges"));
        });
    }
    group.finish();
}

criterion_group!(benches, solve);
criterion_main!(benches);
