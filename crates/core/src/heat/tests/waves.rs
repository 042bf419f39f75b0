//! Sources and temperatures of few waves.

use super::*;
use crate::heat::road::decay;
use crate::rubber::MaxwellBranch;

const PERIOD: f64 = 1e-3;

/// `Σ_k G_k/τ_k conj(b_k(ω_1)) b_k(ω_2)` over the branches of a rubber, of which nothing else knows.
fn mixed(rubber: &Rubber, first: f64, second: f64) -> Complex64 {
    let part = |branch: &MaxwellBranch, w: f64| {
        let x = Complex64::new(0.0, w * branch.relaxation_time);
        x / (1.0 + x)
    };
    let reduction = 4.0 * (1.0 - rubber.poisson_ratio.powi(2));
    rubber
        .branches
        .iter()
        .map(|b| {
            let weight = b.modulus / reduction / b.relaxation_time;
            weight * part(b, first).conj() * part(b, second)
        })
        .sum()
}

/// Strain `q t_q / G_q` of a wave of the number `k`.
fn strain(rubber: &Rubber, speed: f64, k: usize, amplitude: Complex64) -> Complex64 {
    let q = TAU * k as f64 / PERIOD;
    4.0 * q * amplitude / rubber.reduced_modulus(q * speed)
}

#[test]
fn one_wave_heats_uniformly_at_the_depth_of_its_length_and_has_no_flash() {
    let rubber = Rubber::table_2_1();
    for speed in [1e-6, 0.01, 1.0, 10.0, -0.1] {
        let pressure = waves(64, 1e5, &[(1, 5e4, 0.3)]);
        let moduli = moduli(&rubber, speed, PERIOD, 64);
        let load = LineLoad { speed, period: PERIOD, pressure: &pressure, moduli: &moduli };
        let source = HeatSource::new(&load, &setting()).unwrap();
        let q = TAU / PERIOD;
        // mu p v of full contact: v |t|² E'' / |E|².
        let e = rubber.reduced_modulus(q * speed);
        let power = speed * 2.5e9 * e.im / e.norm_sqr();
        assert!(power > 0.0);
        approx::assert_relative_eq!(source.power(), power, max_relative = 1e-12);
        approx::assert_relative_eq!(source.heat(), power, max_relative = 1e-12);
        let most = power * 4.0 * q * (-2.0_f64).exp();
        for (index, z) in source.depths().into_iter().enumerate() {
            let expected = power * 4.0 * q.powi(3) * z * z * (-2.0 * q * z).exp();
            for heat in source.at_depth(index) {
                assert!((heat - expected).abs() < 1e-12 * most, "{z}: {heat} {expected}");
            }
        }
        // After a time in which the mean is no longer small beside what a wave of the same heat would be.
        let setting = ThermalSetting { duration: 10.0, ..setting() };
        let temperatures = Temperatures::new(&source, &pressure, &setting).unwrap();
        let surface = temperatures.surface();
        let mean = temperatures.background();
        assert!(mean > 0.0);
        for t in surface {
            assert!((t / mean - 1.0).abs() < 1e-13, "{t} {mean}");
        }
    }
}

#[test]
fn two_waves_meet_the_closed_form_at_the_surface() {
    let rubber = Rubber::table_2_1();
    for speed in [1e-6, 1e-3, 0.01, 1.0, 10.0] {
        let (first, second) = ((3, 4e4, 0.2), (8, 3e4, 1.1));
        let pressure = waves(64, 2e5, &[first, second]);
        let moduli = moduli(&rubber, speed, PERIOD, 64);
        let load = LineLoad { speed, period: PERIOD, pressure: &pressure, moduli: &moduli };
        let source = HeatSource::new(&load, &setting()).unwrap();
        let temperatures = Temperatures::new(&source, &pressure, &setting()).unwrap();
        let [(w1, b1), (w2, b2)] = [first, second].map(|(k, amplitude, phase)| {
            let amplitude = Complex64::from_polar(amplitude, phase);
            (TAU * k as f64 / PERIOD, strain(&rubber, speed, k, amplitude))
        });
        let heat = b1.conj() * b2 * mixed(&rubber, w1 * speed, w2 * speed);
        let (a, k) = (w1 + w2, w2 - w1);
        let s = decay(k, speed, RUBBER.diffusivity());
        let expected = 2.0 * heat / (RUBBER.conductivity * s * (a + s).powi(3));
        let found = source::spectrum(&temperatures.surface())[5];
        let error = (found - expected).norm() / expected.norm();
        assert!(error < 1e-10, "{speed}: {error:e}");
    }
}

/// Heat at one point by a sum over the branches, each with its own stress.
fn by_branches(rubber: &Rubber, speed: f64, amplitudes: &[Complex64], x: f64, z: f64) -> f64 {
    let reduction = 4.0 * (1.0 - rubber.poisson_ratio.powi(2));
    let branch = |b: &MaxwellBranch| {
        let modulus = b.modulus / reduction;
        let wave = |(i, t): (usize, &Complex64)| {
            let q = TAU * (i + 1) as f64 / PERIOD;
            let wt = Complex64::new(0.0, q * speed * b.relaxation_time);
            let phase = Complex64::from_polar((-q * z).exp(), q * x);
            strain(rubber, speed, i + 1, *t) * modulus * wt / (1.0 + wt) * phase
        };
        let stress: Complex64 = amplitudes.iter().enumerate().map(wave).sum();
        (z * stress).norm_sqr() / (modulus * b.relaxation_time)
    };
    rubber.branches.iter().map(branch).sum()
}

#[test]
fn the_source_is_that_of_all_branches_at_every_point() {
    let rubber = Rubber::table_2_1();
    let points = 48;
    let pressure: Vec<f64> =
        (0..points).map(|i| 1e5 * (i as f64 * 0.37).sin().max(0.0) * (i % 5) as f64).collect();
    for speed in [0.01, 1.0, -0.2] {
        let moduli = moduli(&rubber, speed, PERIOD, points);
        let load = LineLoad { speed, period: PERIOD, pressure: &pressure, moduli: &moduli };
        let source = HeatSource::new(&load, &setting()).unwrap();
        approx::assert_relative_eq!(source.heat(), source.power(), max_relative = 1e-11);
        let coefficients = source::spectrum(&pressure);
        let amplitudes: Vec<Complex64> =
            coefficients[1..=moduli.len()].iter().map(|t| 2.0 * t).collect();
        let most = |index: usize| source.at_depth(index).into_iter().fold(0.0_f64, f64::max);
        let depths = source.depths();
        let most_of_all = (0..depths.len()).map(most).fold(0.0_f64, f64::max);
        for (index, z) in depths.into_iter().enumerate().step_by(7) {
            let here = most(index);
            for (i, found) in source.at_depth(index).into_iter().enumerate() {
                let x = PERIOD * i as f64 / points as f64;
                let expected = by_branches(&rubber, speed, &amplitudes, x, z);
                let error = (found - expected).abs();
                assert!(error < 1e-11 * most_of_all, "{speed} {x} {z}: {found} {expected}");
                // Deep down, where little is left.
                let little = here < 1e-5 * most_of_all;
                assert!(little || error < 1e-8 * here, "{speed} {x} {z}: {found} {expected}");
            }
        }
    }
}

#[test]
fn temperatures_below_the_surface_obey_the_heat_equation() {
    let rubber = Rubber::table_2_1();
    let (points, speed) = (32, 0.05);
    let pressure = waves(points, 2e5, &[(1, 4e4, 0.2), (2, 3e4, 1.1), (5, 1e4, 2.0)]);
    let moduli = moduli(&rubber, speed, PERIOD, points);
    let load = LineLoad { speed, period: PERIOD, pressure: &pressure, moduli: &moduli };
    let source = HeatSource::new(&load, &setting()).unwrap();
    let temperatures = Temperatures::new(&source, &pressure, &setting()).unwrap();
    // Green's function of one wave by a slow sum over all nodes with a fine rule between them.
    let depths = temperatures.depths();
    let index = depths.iter().position(|z| *z > 0.2 * PERIOD / TAU).unwrap();
    for k in [1, 3] {
        let q = TAU * k as f64 / PERIOD;
        let s = decay(q, speed, RUBBER.diffusivity());
        let pairs = [(1, 2), (2, 5), (1, 5)];
        let coefficients = source::spectrum(&pressure);
        let heat = |z: f64| -> Complex64 {
            pairs
                .iter()
                .filter(|(a, b)| b - a == k)
                .map(|&(a, b)| {
                    let [s1, s2] = [a, b].map(|k| strain(&rubber, speed, k, 2.0 * coefficients[k]));
                    let [q1, q2] = [a, b].map(|k| TAU * k as f64 / PERIOD);
                    let factor = mixed(&rubber, q1 * speed, q2 * speed);
                    s1.conj() * s2 * factor * z * z * (-(q1 + q2) * z).exp()
                })
                .sum()
        };
        let z = depths[index];
        let kernel = |x: f64| ((-s * (z - x).abs()).exp() + (-s * (z + x)).exp()) / (0.6 * s);
        let part = |from: f64, to: f64| -> Complex64 {
            let n = 200_000;
            let step = (to - from) / f64::from(n);
            (0..n)
                .map(|i| {
                    let x = from + (f64::from(i) + 0.5) * step;
                    heat(x) * kernel(x) * step
                })
                .sum()
        };
        let expected = part(0.0, z) + part(z, 2.0 * PERIOD);
        let found = source::spectrum(&temperatures.at_depth(index))[k];
        // The midpoint rule of 200000 steps.
        assert!((found - expected).norm() < 1e-7 * expected.norm(), "{found} {expected}");
    }
}

#[test]
fn input_that_does_not_fit_is_refused() {
    let rubber = Rubber::table_2_1();
    let moduli = moduli(&rubber, 0.1, PERIOD, 16);
    let pressure = waves(16, 1e5, &[(1, 1e4, 0.0)]);
    let good = LineLoad { speed: 0.1, period: PERIOD, pressure: &pressure, moduli: &moduli };
    let message = |load: LineLoad| HeatSource::new(&load, &setting()).unwrap_err().to_string();
    assert!(message(LineLoad { speed: 0.0, ..good }).contains("the speed in m/s is 0"));
    assert!(message(LineLoad { speed: f64::NAN, ..good }).contains("the speed in m/s is NaN"));
    assert!(message(LineLoad { period: -1.0, ..good }).contains("the period in m is -1"));
    assert!(message(LineLoad { pressure: &[], ..good }).contains("number of points is 0"));
    assert!(message(LineLoad { moduli: &moduli[1..], ..good }).contains("6 moduli"));
    let mut broken = pressure.clone();
    broken[3] = f64::INFINITY;
    let said = message(LineLoad { pressure: &broken, ..good });
    assert!(said.contains("pressure number 3 (from zero) is inf"), "{said}");
    let source = HeatSource::new(&good, &setting()).unwrap();
    let refused = |setting: ThermalSetting| {
        Temperatures::new(&source, &pressure, &setting).unwrap_err().to_string()
    };
    assert!(refused(ThermalSetting { duration: 0.0, ..setting() }).contains("time of sliding"));
    let shear_stress = -1.0;
    assert!(refused(ThermalSetting { shear_stress, ..setting() }).contains("shear stress"));
    let rubber = Thermal { density: f64::NAN, ..RUBBER };
    assert!(refused(ThermalSetting { rubber, ..setting() }).contains("density of the rubber"));
    let road = Some(Road { body: None, transfer: Some(0.0) });
    assert!(refused(ThermalSetting { road, ..setting() }).contains("heat-transfer coefficient"));
    let short = Temperatures::new(&source, &pressure[1..], &setting()).unwrap_err();
    assert!(short.to_string().contains("15 pressures, 16 are needed"), "{short}");
    let temperatures = Temperatures::new(&source, &pressure, &setting()).unwrap();
    assert!(temperatures.mean_below(&[0.0; 16]).is_err());
}
