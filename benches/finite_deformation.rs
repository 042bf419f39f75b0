//! The steady finite-deformation contact: one pressure further on a path, a path from its start,
//! three waves.

use asperity::fem::profile::RigidProfile;
use asperity::fem::steady::{BlockOptions, SteadyContact};
use asperity::rubber::{Rheology, Rubber};
use asperity::surface::{TABLE_3_1_MM, Wave};
use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;

/// Phases of the first waves of thesis Table 3.1.
const PHASES: [f64; 3] = [0.3, 1.2, 2.5];
const SPEED: f64 = 0.01;

fn contact(waves: usize, columns: usize) -> SteadyContact {
    let waves: Vec<Wave> = TABLE_3_1_MM[..waves]
        .iter()
        .zip(PHASES)
        .map(|((wavelength, amplitude), phase)| Wave {
            wavelength: 1e-3 * wavelength,
            amplitude: 1e-3 * amplitude,
            phase,
        })
        .collect();
    let period = waves[waves.len() - 1].wavelength;
    let profile = RigidProfile::from_waves(&waves, period);
    let options = BlockOptions::new(columns);
    SteadyContact::new(&Rubber::table_2_1(), Rheology::NeoHookean, SPEED, profile, options)
        .expect("the profile is sound")
}

/// From 1.0 to 1.1 MPa.
fn continued(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("one pressure on a continued path");
    group.sample_size(10).measurement_time(Duration::from_secs(10));
    for columns in [64, 128, 256] {
        let reached = || {
            let mut contact = contact(1, columns);
            contact.solve(1e6).expect("a moderate pressure");
            contact
        };
        group.bench_function(BenchmarkId::new("one wave", columns), |bencher| {
            bencher.iter_batched(
                reached,
                |mut contact| black_box(contact.solve(1.1e6).expect("a moderate pressure")),
                BatchSize::PerIteration,
            );
        });
    }
}

fn from_scratch(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("from scratch");
    group.sample_size(10).measurement_time(Duration::from_secs(20));
    for (waves, columns, pressure) in [(1, 64, 1e6), (1, 128, 1e6), (1, 128, 3e6), (3, 512, 3e5)] {
        let name = format!("{waves} waves at {} MPa", pressure / 1e6);
        group.bench_function(BenchmarkId::new(name, columns), |bencher| {
            bencher.iter(|| {
                black_box(contact(waves, columns).solve(pressure).expect("a moderate pressure"))
            });
        });
    }
}

criterion_group!(benches, continued, from_scratch);
criterion_main!(benches);
