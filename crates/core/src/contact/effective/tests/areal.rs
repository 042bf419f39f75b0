//! Heat of areal contacts.

use super::*;
use crate::contact::areal::{ArealContact, ArealSetup, ArealSurface, Sliding, wave_moduli};
use crate::heat::{ArealHeat, ArealLoad, HeatSource, LineLoad};

fn solve(
    rubber: &Rubber,
    sliding: Sliding,
    heights: &[f64],
    points: [usize; 2],
    periods: [f64; 2],
    pressure: f64,
) -> crate::contact::areal::ArealSolution {
    let surface = ArealSurface { heights, points, periods };
    let setup = ArealSetup { rubber, sliding, surface, thickness: None, memory_limit: None };
    ArealContact::new(&setup).unwrap().solve(pressure).unwrap()
}

#[test]
fn an_extruded_contact_has_the_heat_of_its_line() {
    let rubber = Rubber::table_2_1();
    let (nx, ny, speed) = (128, 4, 0.1);
    let line = five_waves(nx);
    let pressure = plain(&rubber, speed, &line, 3e5).pressure;
    let moduli = wave_moduli_of_line(&rubber, speed, nx);
    let load = LineLoad { speed, period: PERIOD, pressure: &pressure, moduli: &moduli };
    let expected = HeatSource::new(&load, &thermal()).unwrap();

    let sliding = Sliding { speed, angle: 0.0 };
    let (points, periods) = ([nx, ny], [PERIOD, 0.3e-3]);
    let moduli = wave_moduli(&rubber, sliding, periods, points);
    let extruded: Vec<f64> = (0..ny).flat_map(|_| pressure.clone()).collect();
    let load = ArealLoad {
        rubber: &rubber,
        velocity: [speed, 0.0],
        periods,
        points,
        pressure: &extruded,
        moduli: &moduli,
    };
    let mut found = ArealHeat::new(&load).unwrap();
    approx::assert_relative_eq!(found.power(), expected.power(), max_relative = 1e-12);
    // Waves with a tapered phase, those of the upper octave, have the mixed terms of the rubber here and of the tapered moduli on
    // the line; at every depth both have the same mean.
    let mean = |heat: Vec<f64>| heat.iter().sum::<f64>() / heat.len() as f64;
    let means: Vec<f64> =
        (0..expected.depths().len()).map(|index| mean(expected.at_depth(index))).collect();
    let most = means.iter().fold(0.0_f64, |a, q| a.max(*q));
    for (index, z) in expected.depths().into_iter().enumerate().step_by(11) {
        let difference = (mean(found.at(z)) - means[index]).abs();
        assert!(difference < 1e-10 * most, "{z}: {difference} of {most}");
    }
}

#[test]
fn without_a_taper_the_extruded_heat_is_that_of_the_line_to_ten_digits() {
    let rubber = Rubber::table_2_1();
    let (nx, ny, speed) = (64, 3, 0.1);
    let pressure: Vec<f64> = (0..nx).map(|i| 1e5 * (f64::from(i) * 0.2).sin().max(0.0)).collect();
    let nx = nx as usize;
    let q = |k: usize| std::f64::consts::TAU * k as f64 / PERIOD;
    let moduli: Vec<_> = (1..32).map(|k| rubber.reduced_modulus(q(k) * speed)).collect();
    let load = LineLoad { speed, period: PERIOD, pressure: &pressure, moduli: &moduli };
    let expected = HeatSource::new(&load, &thermal()).unwrap();
    let areal: Vec<_> =
        (0..=nx / 2).flat_map(|k| vec![rubber.reduced_modulus(q(k) * speed); ny]).collect();
    let extruded: Vec<f64> = (0..ny).flat_map(|_| pressure.clone()).collect();
    let load = ArealLoad {
        rubber: &rubber,
        velocity: [speed, 0.0],
        periods: [PERIOD, 0.3e-3],
        points: [nx, ny],
        pressure: &extruded,
        moduli: &areal,
    };
    let mut found = ArealHeat::new(&load).unwrap();
    let most = (0..expected.depths().len())
        .flat_map(|index| expected.at_depth(index))
        .fold(0.0_f64, f64::max);
    let mut compared = 0;
    for (index, z) in expected.depths().into_iter().enumerate().step_by(7) {
        let of_line = expected.at_depth(index);
        for (i, heat) in found.at(z).into_iter().enumerate() {
            let error = (heat - of_line[i % nx]).abs();
            assert!(error < 1e-10 * most, "{z} {i}: {heat} {}", of_line[i % nx]);
            compared += 1;
        }
    }
    assert!(compared > 1000);
}

fn wave_moduli_of_line(
    rubber: &Rubber,
    speed: f64,
    points: usize,
) -> Vec<crate::numerics::Complex64> {
    crate::contact::half_space::wave_moduli(rubber, speed, PERIOD, points)
}

#[test]
fn the_heat_of_an_areal_contact_is_its_friction_times_speed_at_any_angle() {
    let rubber = Rubber::table_2_1();
    let (points, periods) = ([32, 24], [PERIOD, 0.8e-3]);
    let height = |i: usize| {
        let (x, y) = ((i % 32) as f64 / 32.0, (i / 32) as f64 / 24.0);
        let wave =
            |m: f64, n: f64, phase: f64| (std::f64::consts::TAU * (m * x + n * y) + phase).sin();
        2e-5 * wave(1.0, 1.0, 0.3) + 1e-5 * wave(3.0, -1.0, 1.0) + 5e-6 * wave(2.0, 4.0, 2.0)
    };
    let heights: Vec<f64> = (0..32 * 24).map(height).collect();
    for (speed, angle) in [(0.1, 0.0), (1.0, 0.7)] {
        let sliding = Sliding { speed, angle };
        let solution = solve(&rubber, sliding, &heights, points, periods, 3e5);
        assert!(solution.contact_area_fraction < 0.9);
        let moduli = wave_moduli(&rubber, sliding, periods, points);
        let load = ArealLoad {
            rubber: &rubber,
            velocity: [speed * angle.cos(), speed * angle.sin()],
            periods,
            points,
            pressure: &solution.pressure,
            moduli: &moduli,
        };
        let mut source = ArealHeat::new(&load).unwrap();
        let traction = solution.hysteretic_friction * solution.mean_pressure;
        let heat = source.integral().unwrap();
        approx::assert_relative_eq!(heat, traction * speed, max_relative = 1e-8);
        assert!(source.at(2e-5).iter().all(|q| *q >= 0.0));
    }
    let load = ArealLoad {
        rubber: &rubber,
        velocity: [0.1, f64::NAN],
        periods,
        points,
        pressure: &heights,
        moduli: &[],
    };
    assert!(ArealHeat::new(&load).is_err());
    let load = ArealLoad { velocity: [0.1, 0.0], ..load };
    let error = ArealHeat::new(&load).err().unwrap().to_string();
    assert!(error.contains("0 moduli of waves, 408 are needed"), "{error}");
}
