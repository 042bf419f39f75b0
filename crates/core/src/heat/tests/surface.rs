//! Heat at the surface: Jaeger's band, uniform flux, roads.

use super::*;
use std::f64::consts::PI;

/// A source that is next to nothing, for what the surface alone does.
fn no_source(points: usize, period: f64, speed: f64, setting: &ThermalSetting) -> HeatSource {
    let rubber = Rubber::elastic(1e6, 0.5);
    let moduli = moduli(&rubber, speed, period, points);
    let pressure = vec![1.0; points];
    let load = LineLoad { speed, period, pressure: &pressure, moduli: &moduli };
    HeatSource::new(&load, setting).unwrap()
}

/// Modified Bessel function K_0 by the trapezoidal rule of `∫ exp(-x cosh t) dt`, exact to round-off.
fn k0(x: f64) -> f64 {
    let step = 0.02;
    let term = |n: i32| (-x * (f64::from(n) * step).cosh()).exp();
    step * (0.5 * term(0) + (1..1500).map(term).sum::<f64>())
}

/// Rise at `x` by a band of the width `b` with 1 MW/m² on a half-space that moves in +x (Jaeger 1942).
fn jaeger(x: f64, b: f64, speed: f64) -> f64 {
    let diffusivity = RUBBER.diffusivity();
    let scale = speed / (2.0 * diffusivity);
    let kernel = |distance: f64| (scale * distance).exp() * k0(scale * distance.abs());
    // Substituted by cubes from the singularity on, which takes the logarithm away.
    let from_zero = |end: f64| {
        let n = 600;
        let at = |i: i32| {
            let t = (f64::from(i) + 0.5) / f64::from(n);
            kernel(end * t.powi(5)) * 5.0 * t.powi(4)
        };
        end * (0..n).map(at).sum::<f64>() / f64::from(n)
    };
    // ∫ kernel(x - x') dx' over the band, as a difference of integrals from zero.
    let integral = from_zero(x + 0.5 * b) - from_zero(x - 0.5 * b);
    1e6 / (PI * RUBBER.conductivity) * integral
}

/// The rise that a shear stress in contact makes where a flux in W/m² is.
fn by_shear(flux: &[f64], speed: f64, period: f64) -> Vec<f64> {
    let setting = ThermalSetting { shear_stress: 1e6 / speed, ..setting() };
    let source = no_source(flux.len(), period, speed, &setting);
    // Positive pressures are contact; their waves are too small to matter to a rubber without loss.
    Temperatures::new(&source, flux, &setting).unwrap().surface()
}

fn assert_close(found: &[f64], expected: &[f64]) {
    for (a, b) in found.iter().zip(expected) {
        approx::assert_relative_eq!(a, b, max_relative = 1e-9);
    }
}

#[test]
fn a_band_is_that_of_jaeger_as_the_period_grows() {
    let b = 20e-6;
    // Slow bands warm what is far away, fast ones have steep edges.
    for (speed, per_band, longest) in
        [(1e-3, 64, 8192), (0.01, 128, 2048), (0.1, 128, 2048), (1.0, 256, 2048)]
    {
        let places = [0.0, 0.25, 0.75, 1.0];
        let up = jaeger(-4.0 * b, b, speed);
        let exact = places.map(|place| jaeger(place * b, b, speed) - up);
        let errors = [longest / 64, longest / 8, longest].map(|bands: usize| {
            let (points, period) = (bands * per_band, bands as f64 * b);
            // The edges lie between two points.
            let band: Vec<f64> =
                (0..points).map(|i| if i < per_band { 1e6 } else { 0.0 }).collect();
            let rises = crate::heat::road::of_rubber(&setting(), speed, period, points);
            let rise = source::spectrum(&band).into_iter().zip(rises).map(|(q, r)| q * r);
            let surface = source::on_points(rise, points);
            if points <= 1 << 13 {
                assert_close(&surface, &by_shear(&band, speed, period));
            }
            // Between the points next to a place.
            let at = |x: f64| {
                let right = (x + 0.5) * per_band as f64;
                let index = |i: f64| surface[(i as i64).rem_euclid(points as i64) as usize];
                let [a, b, c, d] = [-2.0, -1.0, 0.0, 1.0].map(|k| index((right + k).floor()));
                (9.0 * (b + c) - a - d) / 16.0
            };
            let found = places.map(|x| at(x) - at(-4.0));
            let error = |(f, e): (f64, f64)| (f / e - 1.0).abs();
            (0..4).map(|i| error((found[i], exact[i]))).fold(0.0, f64::max)
        });
        println!("{speed} m/s: {errors:?}");
        assert!(errors[2] < 1e-4 && errors[2] < errors[0], "{speed}: {errors:?}");
    }
}

#[test]
fn the_band_has_the_figures_of_the_published_integral() {
    // Differences to x = -4 b of the same integral by adaptive quadrature with scipy.
    let b = 20e-6;
    for (speed, expected) in [
        (1e-3, [71.633, 69.974, 40.408]),
        (0.01, [50.855, 52.760, 31.127]),
        (0.1, [16.326, 19.656, 11.224]),
        (1.0, [4.9816, 6.0925, 3.6221]),
    ] {
        let up = jaeger(-4.0 * b, b, speed);
        for (place, expected) in [0.0, 0.25, 1.0].into_iter().zip(expected) {
            let found = jaeger(place * b, b, speed) - up;
            // Half of the last of five digits.
            assert!((found / expected - 1.0).abs() < 4e-5, "{speed} {place}: {found} {expected}");
        }
    }
}

#[test]
fn the_mean_rises_with_the_root_of_time() {
    let (points, period, speed) = (16, 1e-3, 0.1);
    for duration in [1e-6, 1e-3, 0.02, 10.0] {
        let setting = ThermalSetting { duration, shear_stress: 1e7, ..setting() };
        let source = no_source(points, period, speed, &setting);
        let pressure = vec![1.0; points];
        let found = Temperatures::new(&source, &pressure, &setting).unwrap();
        let exact = 1e6 * RUBBER.uniform_rise(duration);
        approx::assert_relative_eq!(found.background(), exact, max_relative = 1e-12);
        // 2 q sqrt(D t)/κ ierfc(z / 2 sqrt(D t)) below.
        let reach = 2.0 * (RUBBER.diffusivity() * duration).sqrt();
        let mean = found.mean_below(&pressure).unwrap();
        for (t, z) in mean.iter().zip(found.depths()) {
            let x: f64 = z / reach;
            let ierfc = (-x * x).exp() / PI.sqrt() - x * statrs::function::erf::erfc(x);
            let expected = 1e6 * reach / RUBBER.conductivity * ierfc;
            assert!((t - expected).abs() < 1e-9 * exact, "{duration} {z}: {t} {expected}");
        }
    }
}

#[test]
fn the_mean_of_a_source_below_the_surface_is_that_of_its_transient() {
    let rubber = Rubber::table_2_1();
    let (points, period, speed) = (16, 1e-3, 0.1);
    let pressure = waves(points, 1e5, &[(1, 5e4, 0.0)]);
    let moduli = moduli(&rubber, speed, period, points);
    let load = LineLoad { speed, period, pressure: &pressure, moduli: &moduli };
    let q = TAU / period;
    for duration in [1e-3, 0.05, 1.0] {
        let setting = ThermalSetting { duration, ..setting() };
        let source = HeatSource::new(&load, &setting).unwrap();
        let found = Temperatures::new(&source, &pressure, &setting).unwrap().background();
        // Green's function of a plane at depth z after the time t, by the midpoint rule in z.
        let reach = 2.0 * (RUBBER.diffusivity() * duration).sqrt();
        let n = 200_000;
        let step = 20.0 / q / f64::from(n);
        let sum: f64 = (0..n)
            .map(|i| {
                let z = (f64::from(i) + 0.5) * step;
                let x = z / reach;
                let ierfc = (-x * x).exp() / PI.sqrt() - x * statrs::function::erf::erfc(x);
                4.0 * q.powi(3) * z * z * (-2.0 * q * z).exp() * ierfc * step
            })
            .sum();
        let expected = source.power() * reach / RUBBER.conductivity * sum;
        approx::assert_relative_eq!(found, expected, max_relative = 1e-8);
    }
}

#[test]
fn a_road_in_full_contact_takes_its_share_of_every_wave() {
    let rubber = Rubber::table_2_1();
    let (points, period, speed) = (64, 1e-3, 0.05);
    let pressure = waves(points, 2e5, &[(3, 4e4, 0.2), (8, 3e4, 1.1)]);
    let moduli = moduli(&rubber, speed, period, points);
    let load = LineLoad { speed, period, pressure: &pressure, moduli: &moduli };
    let source = HeatSource::new(&load, &setting()).unwrap();
    let body = Thermal { conductivity: 1.0, density: 2400.0, heat_capacity: 900.0 };
    // So long that all waves of the road are steady.
    let duration = 10.0;
    let insulated = ThermalSetting { duration, ..setting() };
    let cooled = ThermalSetting { road: Some(Road::perfect(body)), ..insulated };
    let [free, cool] =
        [insulated, cooled].map(|setting| Temperatures::new(&source, &pressure, &setting).unwrap());
    let [free, cooler] = [&free, &cool].map(|t| source::spectrum(&t.surface()));
    let k = TAU * 5.0 / period;
    let s = crate::heat::road::decay(k, speed, RUBBER.diffusivity());
    let expected = free[5] * RUBBER.conductivity * s / (RUBBER.conductivity * s + k);
    assert!((cooler[5] - expected).norm() < 1e-8 * expected.norm(), "{} {expected}", cooler[5]);
    let share = RUBBER.uniform_rise(1.0) / (RUBBER.uniform_rise(1.0) + body.uniform_rise(1.0));
    approx::assert_relative_eq!(cooler[0].re, free[0].re * (1.0 - share), max_relative = 1e-8);
}

#[test]
fn a_road_cools_the_contact_alone_and_an_interface_keeps_it_warm() {
    let rubber = Rubber::table_2_1();
    let (points, period, speed) = (256, 1e-3, 0.5);
    let pressure: Vec<f64> = (0..points)
        .map(|i| 1e6 * (0.4 - (i as f64 / 40.0 - 2.0).powi(2)).max(0.0).sqrt())
        .collect();
    let moduli = moduli(&rubber, speed, period, points);
    let load = LineLoad { speed, period, pressure: &pressure, moduli: &moduli };
    let source = HeatSource::new(&load, &setting()).unwrap();
    let body = Some(Thermal { conductivity: 2.5, density: 2700.0, heat_capacity: 850.0 });
    let solve = |road| {
        let setting = ThermalSetting { road, shear_stress: 1e6, ..setting() };
        Temperatures::new(&source, &pressure, &setting).unwrap()
    };
    let free = solve(None);
    let perfect = solve(Some(Road { body, transfer: None }));
    let resistive = solve(Some(Road { body, transfer: Some(1e5) }));
    let blocked = solve(Some(Road { body, transfer: Some(1e-3) }));
    let [t0, t1, t2, t3] = [&free, &perfect, &resistive, &blocked].map(Temperatures::contact_mean);
    assert!(t1 < 0.9 * t0 && t1 > 0.0 && t2 > t1 && t2 < t0, "{t0} {t1} {t2}");
    approx::assert_relative_eq!(t3, t0, max_relative = 1e-6);
    for (flux, t) in perfect.road_flux().iter().zip(&pressure) {
        assert!(*t > 0.0 || *flux == 0.0);
    }
    // An isothermal road holds the contact at its own temperature.
    let held = solve(Some(Road { body: None, transfer: None }));
    let surface = held.surface();
    let coverage = crate::heat::road::coverage(&pressure);
    assert!(coverage.iter().filter(|c| **c == 1.0).count() > 40);
    for (rise, c) in surface.iter().zip(&coverage) {
        assert!(*c < 1.0 || rise.abs() < 1e-6 * t0, "{rise}");
    }
    assert!(held.highest().0 > 0.0);
}
