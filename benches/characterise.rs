//! Characterisation of a measuring campaign: 30 scans of 160 000 points, one in two with gaps; the
//! kernels, and the stages ingest and characterise from text files to artifacts.

use asperity::numerics::Interrupt;
use asperity::pipeline::{self, Selection};
use asperity::recipe::Recipe;
use asperity::stages;
use asperity::stages::Stage;
use asperity::surface::correlation::{correlate_scans, log_spaced_lags};
use asperity::surface::parameters::AverageRoughness;
use asperity::surface::self_affine::fit_self_affine;
use asperity::surface::spectrum::{Window, power_spectra};
use asperity::surface::wave::sample;
use asperity::surface::{
    HeightDifferenceCorrelation, LineScan, PowerSpectrum, RoughnessParameters, Wave,
};
use criterion::{Criterion, criterion_group, criterion_main};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::hint::black_box;
use std::path::Path;

const SCANS: u64 = 30;
const POINTS: usize = 160_000;
const SPACING: f64 = 6.25e-6;

/// Waves from 0.0625 mm to 32 mm with C growing like s^1.3, random phases, 2 % missing in every
/// other scan.
fn scan(seed: u64) -> LineScan {
    let mut generator = Pcg64::seed_from_u64(seed);
    let waves: Vec<Wave> = (0..10)
        .map(|i| Wave {
            wavelength: 6.25e-5 * 2_f64.powi(i),
            amplitude: 1.5e-5 * 2_f64.powf(0.65 * f64::from(i)),
            phase: TAU * generator.random::<f64>(),
        })
        .collect();
    let mut heights = sample(&waves, POINTS as f64 * SPACING, POINTS);
    if seed % 2 == 1 {
        heights.iter_mut().filter(|_| generator.random::<f64>() < 0.02).for_each(|z| *z = f64::NAN);
    }
    LineScan { name: format!("{seed:02}"), origin: 0.0, spacing: SPACING, heights }
}

fn characterise(criterion: &mut Criterion) {
    let scans: Vec<LineScan> = (0..SCANS).into_par_iter().map(scan).collect();
    let correlations = correlate_scans(&scans, None).unwrap();
    let mut group = criterion.benchmark_group("characterise 30 x 160000");
    group.sample_size(10);
    group.bench_function("roughness parameters", |bench| {
        bench.iter(|| roughness(black_box(&scans)));
    });
    group.bench_function("correlation", |bench| {
        bench.iter(|| correlate_scans(black_box(&scans), None).unwrap());
    });
    group.bench_function("spectrum", |bench| {
        bench.iter(|| power_spectra(black_box(&scans), &correlations, Window::Hann).unwrap());
    });
    group.bench_function("self-affine fit", |bench| {
        bench.iter(|| fit_self_affine(black_box(&correlations), None).unwrap());
    });
    group.bench_function("all", |bench| bench.iter(|| all(black_box(&scans))));
    group.finish();
}

fn roughness(scans: &[LineScan]) -> AverageRoughness {
    let parameters: Vec<RoughnessParameters> =
        scans.par_iter().map(|scan| RoughnessParameters::of(scan, 0.0).unwrap()).collect();
    AverageRoughness::of(&parameters).unwrap()
}

fn all(scans: &[LineScan]) -> usize {
    black_box(roughness(scans));
    let correlations = correlate_scans(scans, None).unwrap();
    let average = HeightDifferenceCorrelation::average(&correlations).unwrap();
    let spectra = power_spectra(scans, &correlations, Window::Hann).unwrap();
    let bins = PowerSpectrum::average(&spectra).unwrap().log_binned(20);
    let fit = fit_self_affine(&correlations, None).unwrap();
    let samples = average.sample(&log_spaced_lags(average.maximum_lag(), 20));
    bins.len() + samples.len() + fit.lags
}

/// The files of a campaign and a recipe for them, on the grid they were measured on.
const RECIPE: &str = r#"
title = "thirty scans"
[ingest]
scans = ["scans"]
[ingest.text]
separator = "semicolon"
header = false
x_spacing_um = 6.25
z_column = 1
z_unit = "um"
missing = ["BAD"]
[approximate]
waves = [8]
[realise]
waves = [8]
realisations = 1
seed = 1
[bem]
rubber = "rubber.toml"
speeds_mm_s = [10.0]
"#;

fn write_campaign(folder: &Path) -> Recipe {
    let scans = folder.join("scans");
    std::fs::create_dir(&scans).unwrap();
    (0..SCANS).into_par_iter().for_each(|seed| {
        let mut text = String::new();
        for height in scan(seed).heights {
            match height.is_nan() {
                true => text.push_str("BAD\n"),
                false => writeln!(text, "{:.2}", height * 1e6).unwrap(),
            }
        }
        std::fs::write(scans.join(format!("{seed:02}.txt")), text).unwrap();
    });
    let rubber = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/rubber/table_2_1.toml");
    std::fs::copy(rubber, folder.join("rubber.toml")).unwrap();
    Recipe::parse(RECIPE, &folder.join("recipe.toml")).unwrap()
}

fn stages(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let recipe = write_campaign(folder.path());
    let stage = |stage: Stage| {
        let selection = Selection { only: Some(stage), force: Some(stage), from: None };
        let interrupted = Interrupt::default();
        let out = folder.path().join("out");
        pipeline::run(&recipe, &out, selection, &interrupted, &|_| {}).unwrap();
    };
    let mut group = criterion.benchmark_group("stages 30 x 160000");
    group.sample_size(10);
    group.bench_function("ingest", |bench| bench.iter(|| stage(stages::ingest::STAGE)));
    group.bench_function("characterise", |bench| bench.iter(|| stage(stages::characterise::STAGE)));
    group.finish();
}

criterion_group!(benches, characterise, stages);
criterion_main!(benches);
