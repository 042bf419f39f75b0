//! A rubber of one's own: a fractional Maxwell solid, `E(ω) = E∞ + E1 (iωτ)^a / (1 + (iωτ)^a)`, which has no
//! relaxation times, is sampled as a laboratory would and fitted by Maxwell branches; then friction over speed.
//!
//!     cargo run --release --example custom_rubber

use asperity::contact::SlidingContact;
use asperity::numerics::Complex64;
use asperity::rubber::fit::{FitOptions, Sweep, SweepPoint, fit_sweeps};
use asperity::surface::{Wave, wave};
use std::error::Error;
use std::f64::consts::TAU;

const WAVELENGTH_M: f64 = 1e-4;

/// Complex modulus in Pa at an angular frequency in rad/s.
fn fractional(omega: f64) -> Complex64 {
    let z = Complex64::new(0.0, omega * 1e-6).powf(0.4);
    3e6 + 1e9 * z / (1.0 + z)
}

fn main() -> Result<(), Box<dyn Error>> {
    let measure = |k: i32| {
        let angular_frequency = 10_f64.powf(0.25 * f64::from(k));
        let modulus = fractional(angular_frequency);
        SweepPoint { angular_frequency, storage_modulus: modulus.re, loss_modulus: modulus.im }
    };
    let sweep = Sweep { temperature_c: None, points: (-8..=32).map(measure).collect() };
    let fit = fit_sweeps(&[sweep], &FitOptions::default())?;
    let data = fit.rubber("fractional", 0.49);
    let rubber = data.rubber.maxwell()?;
    println!("{} Maxwell branches\n", rubber.branches.len());

    let profile = [Wave { wavelength: WAVELENGTH_M, amplitude: 1e-5, phase: 0.0 }];
    let heights = wave::sample(&profile, WAVELENGTH_M, 1024);
    println!("{:>10} {:>10} {:>9} {:>9}", "v / mm/s", "f / Hz", "tan δ", "friction");
    for speed in [1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0] {
        let frequency = speed / WAVELENGTH_M;
        let modulus = rubber.complex_modulus(TAU * frequency);
        let contact = SlidingContact::new(rubber, speed, WAVELENGTH_M, &heights)?.solve(1e6)?;
        let (loss, friction) = (modulus.im / modulus.re, contact.friction_coefficient);
        println!("{:10} {frequency:10} {loss:9.4} {friction:9.4}", 1e3 * speed);
    }
    Ok(())
}
