//! One sine in full contact, where strain and heat follow from closed forms.

use super::limits::Softening;
use super::*;

/// In full contact the displacement is the profile whatever the moduli, so that a sine of the amplitude `D` is met at the strain
/// `e² = ∫ 4q³z²e^(-2qz) (z q² D e^(-qz))² dz = 96/1024 (qD)²`. Without conduction, heat of the power `mu p v` for the time t warms it by
/// `∫ (4q³z²e^(-2qz))² dz mu p v t / (rho c) = 3/8 q mu p v t / (rho c)`. Friction is `q² D² g E''(a q v) / (4 (1 - nu²) p)`.
#[test]
fn a_sine_in_full_contact_has_the_strain_and_the_heat_of_the_closed_forms() {
    let rubber = Rubber::table_2_1();
    let law = Softening { critical: 0.05, depth: 0.8 };
    let wlf = wlf();
    let (amplitude, speed, pressure) = (0.5e-3, 10.0, 2e10);
    let wave = Wave { wavelength: PERIOD, amplitude, phase: 0.0 };
    let heights = wave::sample(&[wave], PERIOD, 256);
    // So little conduction that the heat stays where it is made.
    let rubber_heat = Thermal { conductivity: 1e-12, density: 1150.0, heat_capacity: 1500.0 };
    let thermal = ThermalSetting { rubber: rubber_heat, duration: 1e-3, ..thermal() };
    let heat = HeatFeedback { thermal, law: &wlf, temperature_c: 20.0 };
    let setup = FeedbackSetup {
        strain: Some(&law),
        heat: Some(heat),
        ..FeedbackSetup::new(&rubber, speed, PERIOD, &heights)
    };
    let found = FeedbackContact::new(setup).unwrap().solve(pressure).unwrap();
    let q = std::f64::consts::TAU / PERIOD;
    let strain = (96.0_f64 / 1024.0).sqrt() * q * amplitude;
    approx::assert_relative_eq!(found.strain[0], strain, max_relative = 1e-6);
    let softened = law.loss_factor(strain).unwrap();
    let friction = |rise: f64| {
        let modulus = rubber.complex_modulus(q * speed * wlf.shift_factor(20.0 + rise).unwrap());
        let scale = q * q * amplitude * amplitude / (4.0 * (1.0 - 0.49_f64.powi(2)) * pressure);
        softened * scale * modulus.im
    };
    let rise = |rise: f64| 0.375 * q * friction(rise) * pressure * speed * 1e-3 / (1150.0 * 1500.0);
    // Warmer rubber makes less heat here: one root.
    let (mut low, mut high) = (0.0, rise(0.0));
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if rise(middle) > middle { low = middle } else { high = middle }
    }
    assert!(low > 10.0, "{low}");
    approx::assert_relative_eq!(found.with.contact_area_fraction, 1.0);
    approx::assert_relative_eq!(found.rise[0], low, max_relative = 1e-5);
    approx::assert_relative_eq!(
        found.with.friction_coefficient,
        friction(low),
        max_relative = 1e-5
    );
}
