//! One sliding contact, without the pipeline: friction of three superposed waves at a few pressures,
//! each with the error of its grid.
//!
//!     cargo run --release --example one_contact

use asperity::contact::refine::{HALF_SPACE, OnGrid, on_grid};
use asperity::contact::{ContactError, ContactSolution, SlidingContact};
use asperity::rubber::Rubber;
use asperity::surface::{Wave, wave};
use std::error::Error;

const PERIOD_M: f64 = 1e-3;
const SPEED_M_S: f64 = 0.01;
const POINTS: usize = 4096;
/// The error is that between grids; the coarsest of them still resolves the shortest wave.
const FEWEST_POINTS: usize = 64;

fn main() -> Result<(), Box<dyn Error>> {
    let waves = [
        Wave { wavelength: 1e-3, amplitude: 60e-6, phase: 0.0 },
        Wave { wavelength: 0.5e-3, amplitude: 25e-6, phase: 1.0 },
        Wave { wavelength: 0.25e-3, amplitude: 10e-6, phase: 2.0 },
    ];
    let rubber = Rubber::table_2_1();
    println!("{:>9} {:>9} {:>9} {:>9}", "p / MPa", "Ac/A0", "friction", "error");
    for pressure in [0.1e6, 0.3e6, 1e6] {
        let solve = |points| -> Result<ContactSolution, ContactError> {
            let heights = wave::sample(&waves, PERIOD_M, points);
            SlidingContact::new(&rubber, SPEED_M_S, PERIOD_M, &heights)?.solve(pressure)
        };
        let view = |solution: &ContactSolution| OnGrid {
            points: solution.pressure.len(),
            friction_coefficient: solution.friction_coefficient,
            contact_area_fraction: solution.contact_area_fraction,
        };
        let refined =
            on_grid(POINTS, FEWEST_POINTS, HALF_SPACE, solve, ContactError::is_no_solution, view)?;
        let error = refined.error.ok_or("the grids do not resolve the contact")?;
        println!(
            "{:9} {:9.5} {:9.5} {:9.1e}",
            pressure / 1e6,
            refined.solution.contact_area_fraction,
            refined.solution.friction_coefficient,
            error.friction_coefficient,
        );
    }
    Ok(())
}
