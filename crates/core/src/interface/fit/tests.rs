//! Fits of synthetic friction.

use super::*;

fn law() -> GaussianShear {
    let shift = Some(Activation { energy_ev: 0.97, reference_c: 20.0 });
    GaussianShear { peak_stress: 6.5e6, peak_speed: 6e-3, width: 0.1, shift }
}

/// Friction by a law, with an error that alternates in sign.
fn measured(law: GaussianShear, celsius: &[f64], error: f64) -> Vec<MeasuredFriction> {
    let mut all = Vec::new();
    for temperature_c in celsius {
        for k in 0..7 {
            let speed = 10.0_f64.powf(-5.0 + f64::from(k));
            let (pressure, hysteretic) = (3e5, 0.3 + 0.05 * f64::from(k));
            let contact_area_fraction = 0.05 / (1.0 + f64::from(k));
            let stress = ShearLaw::Gaussian(law).stress(speed, *temperature_c).unwrap();
            let sign = if all.len() % 2 == 0 { 1.0 } else { -1.0 };
            let friction = hysteretic + stress * contact_area_fraction / pressure + sign * error;
            all.push(MeasuredFriction {
                speed,
                temperature_c: *temperature_c,
                pressure,
                friction,
                hysteretic,
                contact_area_fraction,
            });
        }
    }
    all
}

#[test]
fn exact_friction_gives_the_law_back() {
    let fit =
        fit_shear(&measured(law(), &[0.0, 20.0, 60.0], 0.0), Some(20.0), Fixed::default()).unwrap();
    let found =
        [fit.law.peak_stress, fit.law.peak_speed, fit.law.width, fit.law.shift.unwrap().energy_ev];
    for (found, expected) in found.into_iter().zip([6.5e6, 6e-3, 0.1, 0.97]) {
        approx::assert_relative_eq!(found, expected, max_relative = 1e-7);
    }
    assert!(fit.rms < 1e-9 && fit.degrees_of_freedom == 17, "{}", fit.rms);
}

#[test]
fn one_temperature_needs_no_energy_and_does_not_determine_one() {
    let law = GaussianShear { shift: None, ..law() };
    let measured = measured(law, &[20.0], 0.0);
    let fit = fit_shear(&measured, None, Fixed::default()).unwrap();
    approx::assert_relative_eq!(fit.law.peak_speed, 6e-3, max_relative = 1e-7);
    assert!(fit.energy_ev.is_none());
    let error = fit_shear(&measured, Some(20.0), Fixed::default()).unwrap_err();
    assert!(matches!(error, ShearError::OneTemperature));
    let fixed = Fixed { energy_ev: Some(0.97), ..Fixed::default() };
    let fit = fit_shear(&measured, Some(20.0), fixed).unwrap();
    assert_eq!(fit.energy_ev.unwrap(), Interval { value: 0.97, ends: None });
}

/// Intervals of many noisy sets hold the law as often as they say.
#[test]
fn intervals_hold_the_law_in_95_of_100_sets() {
    use rand::{RngExt, SeedableRng};
    let mut random = rand_pcg::Pcg64::seed_from_u64(7);
    let (sets, mut held, mut next) = (400, [0; 4], 0);
    let exact = measured(law(), &[20.0], 0.0)[3];
    // A sum of twelve is normally distributed to a few parts in a thousand.
    let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
    for _ in 0..sets {
        let mut measured = measured(law(), &[0.0, 20.0, 60.0], 0.0);
        for m in &mut measured {
            m.friction += 0.01 * normal();
        }
        let fit = fit_shear(&measured, Some(20.0), Fixed::default()).unwrap();
        let intervals = [fit.peak_stress, fit.peak_speed, fit.width, fit.energy_ev.unwrap()];
        for (k, (interval, truth)) in intervals.iter().zip([6.5e6, 6e-3, 0.1, 0.97]).enumerate() {
            let [low, high] = interval.ends.unwrap();
            held[k] += usize::from(low <= truth && truth <= high);
        }
        let predicted = fit.predict(&exact).unwrap();
        let one_more = exact.friction + 0.01 * normal();
        next += usize::from((predicted.friction - one_more).abs() <= predicted.half_width_95);
    }
    // 95 % of 400 sets have a standard deviation of 1.1 %.
    for count in held.into_iter().chain([next]) {
        let share = count as f64 / f64::from(sets);
        assert!((0.915..0.985).contains(&share), "{held:?} {next}");
    }
}

#[test]
fn measurements_that_determine_nothing_are_refused() {
    let all = measured(law(), &[20.0], 0.0);
    let few = fit_shear(&all[..3], None, Fixed::default()).unwrap_err();
    assert!(few.to_string().contains("at least 4"), "{few}");
    let below: Vec<_> = all.iter().map(|m| MeasuredFriction { friction: 0.1, ..*m }).collect();
    assert!(matches!(fit_shear(&below, None, Fixed::default()), Err(ShearError::NothingLeft)));
    let nan: Vec<_> = all.iter().map(|m| MeasuredFriction { friction: f64::NAN, ..*m }).collect();
    assert!(fit_shear(&nan, None, Fixed::default()).is_err());
    // One speed, many times.
    let one = vec![all[3]; 8];
    assert!(fit_shear(&one, None, Fixed::default()).is_err());
}
