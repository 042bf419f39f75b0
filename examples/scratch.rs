use asperity::fem::profile::RigidProfile;
use asperity::fem::steady::{BlockOptions, SteadyContact};
use asperity::rubber::{Rheology, Rubber};
use asperity::surface::Wave;
use std::time::Instant;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    // law speed_mm_s columns coarsen waves pressures...
    let law = if args[1] == "lin" { Rheology::Linear } else { Rheology::NeoHookean };
    let speed: f64 = args[2].parse().unwrap();
    let columns: usize = args[3].parse().unwrap();
    let coarsening = args[4] == "1";
    let waves: Vec<Wave> = args[5]
        .split(',')
        .map(|w| {
            let p: Vec<f64> = w.split(':').map(|x| x.parse().unwrap()).collect();
            Wave {
                wavelength: p[0] * 1e-3,
                amplitude: p[1] * 1e-3,
                phase: *p.get(2).unwrap_or(&0.0),
            }
        })
        .collect();
    let period = waves.iter().map(|w| w.wavelength).fold(0.0, f64::max);
    let keep = args[6] == "keep";
    let make = || {
        let profile = RigidProfile::from_waves(&waves, period);
        let options = BlockOptions { coarsening, ..BlockOptions::new(columns) };
        SteadyContact::new(&Rubber::table_2_1(), law, speed * 1e-3, profile, options).unwrap()
    };
    let mut contact = make();
    for p in &args[7..] {
        let p: f64 = p.parse().unwrap();
        if !keep {
            contact = make();
        }
        let start = Instant::now();
        match contact.solve(p * 1e6) {
            Ok(s) => println!(
                "v {speed} p {p} N {columns} mu {:.5} heat {:.5} ({:+.2} %) A {:.4} sep {:.6} shear {:.3} res {:.1e} newton {} krylov {} {:.2} s",
                s.friction_coefficient,
                s.hysteretic_friction,
                100.0 * (s.hysteretic_friction / s.friction_coefficient - 1.0),
                s.contact_area_fraction,
                s.mean_separation * 1e3,
                s.shear,
                s.residual,
                s.newton_steps,
                s.krylov_iterations,
                start.elapsed().as_secs_f64()
            ),
            Err(e) => println!("v {speed} p {p}: {e} {:.2} s", start.elapsed().as_secs_f64()),
        }
    }
}
