//! Study of the representative contact element (De Lorenzis & Wriggers, Comput. Mater. Sci. 77, 2013,
//! doi:10.1016/j.commatsci.2013.04.049): the height of the block, its upper edge, the mesh, pressure and speed, each varied
//! alone, by the steady route; and time of pressing in and distance of dragging, which that route does not have, by the
//! transient one.
//!
//!     cargo run --release --example contact_element

use asperity::fem::profile::RigidProfile;
use asperity::fem::steady::solution::SteadySolution;
use asperity::fem::steady::{BlockOptions, SteadyContact, UpperEdge};
use asperity::fem::transient::{TransientContact, TransientOptions};
use asperity::rubber::{Rheology, Rubber};
use asperity::surface::Wave;
use std::error::Error;
use std::f64::consts::TAU;
use std::time::Instant;

/// The steepest wave of Table 3.1 of the thesis, in m.
const WAVE: Wave = Wave { wavelength: 6.25e-5, amplitude: 1.867e-5, phase: 0.0 };
const PRESSURE: f64 = 1e6;
const SPEED: f64 = 0.01;

fn steady(
    options: BlockOptions,
    pressure: f64,
    speed: f64,
) -> Result<SteadySolution, Box<dyn Error>> {
    let profile = RigidProfile::from_waves(&[WAVE], WAVE.wavelength);
    let law = Rheology::NeoHookean;
    let mut contact = SteadyContact::new(&Rubber::table_2_1(), law, speed, profile, options)?;
    Ok(contact.solve(pressure)?)
}

fn print(what: &str, solution: &SteadySolution) {
    let SteadySolution { friction_coefficient, contact_area_fraction, .. } = solution;
    println!("{what:<28} {friction_coefficient:9.5} {contact_area_fraction:9.5}");
}

fn main() -> Result<(), Box<dyn Error>> {
    let usual = BlockOptions::new(128);
    println!("{:<28} {:>9} {:>9}", "steady", "friction", "area");
    for height_ratio in [0.25, 0.5, 0.75, 1.5, 3.0] {
        for upper_edge in [UpperEdge::Pressure, UpperEdge::Plate] {
            let options = BlockOptions { height_ratio, upper_edge, ..usual };
            let name = format!("H/L {height_ratio}, {upper_edge:?}");
            match steady(options, PRESSURE, SPEED) {
                Ok(solution) => print(&name, &solution),
                Err(error) => println!("{name:<28} {error}"),
            }
        }
    }
    for columns in [16, 32, 64, 128, 256, 512] {
        print(&format!("{columns} columns"), &steady(BlockOptions::new(columns), PRESSURE, SPEED)?);
    }
    // Pressure and speed enter as p over the modulus at the frequency of the wave, and as that frequency.
    let rubber = Rubber::table_2_1();
    let modulus = |speed: f64| rubber.reduced_modulus(TAU / WAVE.wavelength * speed).norm();
    for pressure in [0.25, 0.5, 1.0, 2.0, 4.0] {
        let share = pressure * 1e6 / modulus(SPEED);
        let name = format!("{pressure} MPa, p/|E| {share:.4}");
        print(&name, &steady(usual, pressure * 1e6, SPEED)?);
    }
    for speed in [1e-3, 1e-2, 1e-1] {
        let name = format!("{} mm/s, p/|E| 0.05", 1e3 * speed);
        print(&name, &steady(usual, 0.05 * modulus(speed), speed)?);
    }
    dragged()
}

/// Friction over the distance of dragging after short and long pressing in.
fn dragged() -> Result<(), Box<dyn Error>> {
    let columns = 32;
    let start = Instant::now();
    let options = BlockOptions { coarsening: false, ..BlockOptions::new(columns) };
    let steady = steady(options, PRESSURE, SPEED)?;
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "\ntransient on {columns} columns; steady {:.5} in {seconds:.2} s",
        steady.friction_coefficient
    );
    let titles = ["period 1", "period 2", "period 4", "period 8", "period 12"];
    print!("{:<28}", "pressed in for");
    titles.iter().for_each(|title| print!(" {title:>9}"));
    println!(" {:>9}", "seconds");
    for periods in [0.1, 1.0, 10.0] {
        let press_time = Some(periods * WAVE.wavelength / SPEED);
        let drag = TransientOptions { press_time, ..TransientOptions::default() };
        let profile = RigidProfile::from_waves(&[WAVE], WAVE.wavelength);
        let rubber = Rubber::table_2_1();
        let mut mesh = options.mesh(WAVE.wavelength);
        let shear_modulus = rubber.equilibrium_modulus / (2.0 * (1.0 + rubber.poisson_ratio));
        mesh.skew = -0.5 * steady.friction_coefficient * PRESSURE / shear_modulus;
        let start = Instant::now();
        let contact =
            TransientContact::new(&rubber, Rheology::NeoHookean, SPEED, profile, mesh, drag)?;
        let samples = contact.run(PRESSURE, |_| ())?.samples;
        let within = |period: f64| {
            let place = |d: f64| d / WAVE.wavelength;
            let inside: Vec<f64> = samples
                .iter()
                .filter(|s| place(s.displacement) > period - 1.0 && place(s.displacement) <= period)
                .map(|s| s.friction_coefficient)
                .collect();
            inside.iter().sum::<f64>() / inside.len() as f64
        };
        print!("{:<28}", format!("{periods} periods of sliding"));
        [1.0, 2.0, 4.0, 8.0, 12.0].iter().for_each(|period| print!(" {:9.5}", within(*period)));
        println!(" {:9.1}", start.elapsed().as_secs_f64());
    }
    Ok(())
}
