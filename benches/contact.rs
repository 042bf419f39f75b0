//! Contacts of one to eight waves on 2^10 to 2^20 points, contact area 5 %.

use asperity::contact::SlidingContact;
use asperity::rubber::Rubber;
use asperity::surface::{TABLE_3_1_MM, Wave, wave};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Duration;

fn contact(waves: usize, points: usize) -> SlidingContact {
    let mut generator = Pcg64::seed_from_u64(1);
    let sines: Vec<Wave> = TABLE_3_1_MM[..waves]
        .iter()
        .map(|(wavelength, amplitude)| Wave {
            wavelength: 1e-3 * wavelength,
            amplitude: 1e-3 * amplitude,
            phase: TAU * generator.random::<f64>(),
        })
        .collect();
    let period = 1e-3 * TABLE_3_1_MM[waves - 1].0;
    let heights = wave::sample(&sines, period, points);
    SlidingContact::new(&Rubber::table_2_1(), 0.01, period, &heights).expect("the profile is sound")
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
