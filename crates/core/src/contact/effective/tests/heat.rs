//! Heat of contacts.

use super::*;
use crate::contact::half_space::wave_moduli;
use crate::heat::{HeatSource, LineLoad, Road};

#[test]
fn the_heat_of_a_partial_contact_is_its_friction_times_speed() {
    let rubber = Rubber::table_2_1();
    let period = 0.0625e-3;
    let wave = Wave { wavelength: period, amplitude: 0.01867e-3, phase: 0.0 };
    let heights = wave::sample(&[wave], period, 1024);
    for speed in [0.01, 0.1, 10.0] {
        let mut contact = SlidingContact::new(&rubber, speed, period, &heights).unwrap();
        let solution = contact.solve_near_area(0.15, 1e-3).unwrap();
        let moduli = wave_moduli(&rubber, speed, period, 1024);
        let pressure = &solution.pressure;
        let load = LineLoad { speed, period, pressure, moduli: &moduli };
        let source = HeatSource::new(&load, &thermal()).unwrap();
        let traction = solution.hysteretic_friction * solution.mean_pressure;
        approx::assert_relative_eq!(source.heat(), traction * speed, max_relative = 1e-8);
        approx::assert_relative_eq!(source.power(), traction * speed, max_relative = 1e-12);
        // From the heights, as far as the grid resolves the contact.
        let from_heights = solution.friction_coefficient / solution.hysteretic_friction;
        assert!((from_heights - 1.0).abs() < 0.02, "{speed}: {from_heights}");
    }
}

fn hot(speed: f64, points: usize, thermal: ThermalSetting) -> Feedback {
    let (rubber, heights, wlf) = (Rubber::table_2_1(), five_waves(points), wlf());
    let heat = HeatFeedback { thermal, law: &wlf, temperature_c: 20.0 };
    let setup = FeedbackSetup::new(&rubber, speed, PERIOD, &heights);
    let setup = FeedbackSetup { heat: Some(heat), ..setup };
    FeedbackContact::new(setup).unwrap().solve(3e5).unwrap()
}

#[test]
fn a_hot_contact_is_the_contact_of_the_rubber_that_its_heat_makes() {
    let found = hot(0.1, 1024, thermal());
    let rubber = Rubber::table_2_1();
    let effective = EffectiveRubber { rubber: &rubber, factors: &found.factors, speed: 0.1 };
    let heights = five_waves(1024);
    let again = SlidingContact::new(&effective, 0.1, PERIOD, &heights).unwrap().solve(3e5).unwrap();
    let friction = (again.friction_coefficient, found.with.friction_coefficient);
    approx::assert_relative_eq!(friction.0, friction.1, max_relative = 1e-8);
    for (rise, shift) in found.rise.iter().zip(&found.factors.ln_shift) {
        let exact = wlf().shift_factor(20.0 + rise).unwrap().ln();
        approx::assert_abs_diff_eq!(*shift, exact, epsilon = 2e-6);
    }
    let heat = found.heat.unwrap();
    approx::assert_relative_eq!(heat.heat, heat.power, max_relative = 1e-8);
    let traction = found.with.hysteretic_friction * 3e5;
    approx::assert_relative_eq!(heat.power, 0.1 * traction, max_relative = 1e-10);
    assert!(heat.contact_mean > heat.background && heat.highest > heat.contact_mean);
}

/// The moduli of a coarser grid lead to the same contact in fewer steps.
#[test]
fn a_fixed_point_does_not_depend_on_where_it_is_sought_from() {
    let (rubber, law) = (Rubber::table_2_1(), wlf());
    let heat = HeatFeedback { thermal: thermal(), law: &law, temperature_c: 20.0 };
    let on = |points: usize, start: Option<&WaveFactors>| {
        let heights = five_waves(points);
        let setup = FeedbackSetup::new(&rubber, 0.3, PERIOD, &heights);
        let mut contact =
            FeedbackContact::new(FeedbackSetup { heat: Some(heat), ..setup }).unwrap();
        match start {
            Some(start) => contact.solve_from(3e5, start).unwrap(),
            None => contact.solve_effective(3e5).unwrap(),
        }
    };
    let coarse = on(512, None);
    let (cold, near) = (on(1024, None), on(1024, Some(&coarse.factors)));
    assert!(near.steps < cold.steps, "{} {}", near.steps, cold.steps);
    let same = |a: f64, b: f64| approx::assert_relative_eq!(a, b, max_relative = 1e-5);
    same(near.solution.friction_coefficient, cold.solution.friction_coefficient);
    same(near.solution.contact_area_fraction, cold.solution.contact_area_fraction);
    same(near.heat.unwrap().contact_mean, cold.heat.unwrap().contact_mean);
    // Contact and moduli that agree already need one contact, and stay.
    let again = on(1024, Some(&cold.factors));
    assert_eq!(again.steps, 1);
    same(again.solution.friction_coefficient, cold.solution.friction_coefficient);
    // Factors are kept where they are stated, and constant beyond.
    let q = &coarse.factors.wavenumber;
    let resampled = coarse.factors.at_waves(vec![q[0], q[9], 1e3 * q[q.len() - 1]]);
    let stated = &coarse.factors.ln_shift;
    assert_eq!(resampled.ln_shift, [stated[0], stated[9], stated[stated.len() - 1]]);
}

#[test]
fn an_interrupt_ends_a_contact_with_heat() {
    let (rubber, law, heights) = (Rubber::table_2_1(), wlf(), five_waves(512));
    let heat = HeatFeedback { thermal: thermal(), law: &law, temperature_c: 20.0 };
    let interrupt = crate::numerics::Interrupt::default();
    let setup = FeedbackSetup {
        heat: Some(heat),
        interrupt: Some(&interrupt),
        ..FeedbackSetup::new(&rubber, 0.3, PERIOD, &heights)
    };
    let mut contact = FeedbackContact::new(setup).unwrap();
    interrupt.set();
    let error = contact.solve_effective(3e5).unwrap_err();
    assert_eq!(error, EffectiveError::Contact(crate::contact::ContactError::Interrupted));
}

#[test]
fn heat_brings_more_contact_at_speed_and_a_road_takes_some_of_it_back() {
    let slow = hot(1e-6, 512, thermal());
    let change = slow.with.friction_coefficient / slow.without.friction_coefficient - 1.0;
    assert!(change.abs() < 1e-4, "{change}");
    let fast = hot(1.0, 1024, thermal());
    let area = |f: &Feedback| f.with.contact_area_fraction;
    assert!(area(&fast) > 2.0 * fast.without.contact_area_fraction);
    assert!(fast.with.friction_coefficient > 1.2 * fast.without.friction_coefficient);
    let stone = Thermal { conductivity: 2.5, density: 2700.0, heat_capacity: 850.0 };
    let cooled = hot(1.0, 1024, ThermalSetting { road: Some(Road::perfect(stone)), ..thermal() });
    assert!(area(&cooled) < area(&fast), "{} {}", area(&cooled), area(&fast));
    assert!(area(&cooled) > fast.without.contact_area_fraction);
    assert!(cooled.heat.unwrap().road_flux > 0.0);
}

/// The table of cold and hot friction over speed; `--ignored --nocapture` prints it.
#[test]
#[ignore = "a table for people, of some minutes"]
fn table_of_hot_friction_over_speed() {
    for points in [2048, 4096, 8192] {
        for speed in [1e-3, 1e-2, 0.1, 1.0] {
            line(speed, &hot(speed, points, thermal()), points);
        }
    }
}

fn line(speed: f64, f: &Feedback, points: usize) {
    let heat = f.heat.as_ref().unwrap();
    println!(
        "{points} {speed:e} m/s cold {:.4} {:.5} hot {:.4} {:.5} | contact {:.1} K background {:.2} highest {:.1} K at {:.2e} m | T_q {:.2} {:.2} steps {} change {:.0e} {:.0e}",
        f.without.friction_coefficient,
        f.without.contact_area_fraction,
        f.with.friction_coefficient,
        f.with.contact_area_fraction,
        heat.contact_mean,
        heat.background,
        heat.highest,
        heat.highest_depth,
        f.rise[0],
        f.rise[15],
        f.steps,
        f.change[0],
        f.change[1]
    );
}

/// The same on a road-like profile, self-affine from 16 mm on, with 2^14 points.
#[test]
#[ignore = "a table for people, of some minutes"]
fn table_of_hot_friction_on_a_road() {
    let (points, period) = (1 << 14, 0.032);
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    // C ~ q^-(1+2H), H = 0.8, down to 0.03 mm, rms slope 0.3: eight points on the shortest wave at 0.0156 mm.
    let mut waves: Vec<Wave> = (2..=1024)
        .map(|k| Wave {
            wavelength: period / f64::from(k),
            amplitude: f64::from(k).powf(-1.3),
            phase: std::f64::consts::TAU * random(),
        })
        .collect();
    let variance: f64 = waves
        .iter()
        .map(|w| 0.5 * (std::f64::consts::TAU * w.amplitude / w.wavelength).powi(2))
        .sum();
    waves.iter_mut().for_each(|w| w.amplitude *= 0.3 / variance.sqrt());
    let heights = wave::sample(&waves, period, points);
    let (rubber, wlf) = (Rubber::table_2_1(), wlf());
    let heat = HeatFeedback { thermal: thermal(), law: &wlf, temperature_c: 20.0 };
    for speed in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0] {
        let setup = FeedbackSetup::new(&rubber, speed, period, &heights);
        let setup = FeedbackSetup { heat: Some(heat), ..setup };
        let begin = std::time::Instant::now();
        match FeedbackContact::new(setup).unwrap().solve(3e5) {
            Ok(found) => line(speed, &found, points),
            Err(error) => println!("{speed}: {error}"),
        }
        println!("   {:.1} s", begin.elapsed().as_secs_f64());
    }
}
