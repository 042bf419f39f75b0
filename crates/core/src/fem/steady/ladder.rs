//! Finer grids above the one of a path.
//!
//! A path has many points, and the exact contact at one pressure needs none of them on a fine grid: the exact contact
//! of one grid, interpolated to twice the columns, is a few Newton steps from the exact contact there. So a profile of
//! many scales is grown and pressed on a coarse grid, and each solution is refined from there; the difference of its
//! last two grids estimates the error of the mesh.

use super::super::profile::RigidProfile;
use super::NotConverged;
use super::level::{Cost, Level};
use super::path::{BARRIER, EXACT, EXACT_ENOUGH, Path, close, close_nearby, open};
use super::solution::SteadySolution;
use super::state::State;
use super::transfer::transfer;

/// Fewest columns on the shortest wave on the grid of a path.
const FEWEST_PER_WAVE: f64 = 32.0;

/// The numbers of columns of the grids, and the levels made so far.
pub(super) struct Ladder {
    /// From the grid of the path to the finest.
    columns: Vec<usize>,
    /// Levels above that of the path.
    levels: Vec<Level>,
}

impl Ladder {
    /// The grid of the path alone.
    pub fn none(columns: usize) -> Self {
        Self { columns: vec![columns], levels: Vec::new() }
    }

    /// Grids up to one of `columns` over a profile of many scales.
    pub fn new(columns: usize, profile: &RigidProfile) -> Self {
        let least = FEWEST_PER_WAVE * profile.shortest_waves();
        let mut all = vec![columns];
        while let Some(finer) = all.last()
            && finer.is_multiple_of(2)
            && (finer / 2) as f64 >= least
        {
            all.push(finer / 2);
        }
        all.reverse();
        Self { columns: all, levels: Vec::new() }
    }

    /// Columns of the grid of the path.
    pub fn path_columns(&self) -> usize {
        self.columns[0]
    }

    /// Residual of the exact contact on the grid of the path.
    pub fn path_tolerance(&self) -> f64 {
        tolerance(self.columns.len() == 1)
    }

    pub fn interrupt(&mut self, interrupt: &crate::numerics::Interrupt) {
        self.levels.iter_mut().for_each(|level| level.interrupt = interrupt.clone());
    }

    /// The solution on the finest grid from the exact contact of the path and its residual, with the work spent since
    /// the solution before; `new` makes a level of so many columns.
    pub fn climb(
        &mut self,
        path: &mut Path,
        (mut state, residual): (State, f64),
        speed: f64,
        new: impl Fn(usize) -> Level,
    ) -> Result<SteadySolution, NotConverged> {
        let mut cost = path.take_cost();
        let mut solution = SteadySolution::read(&path.level, &state, speed, residual);
        for (above, columns) in self.columns[1..].iter().enumerate() {
            if above == self.levels.len() {
                self.levels.push(new(*columns));
            }
            let (below, finer) = self.levels.split_at_mut(above);
            let (below, finer) = (below.last_mut().unwrap_or(&mut path.level), &mut finer[0]);
            let tolerance = tolerance(above + 1 == self.columns.len() - 1);
            let raised = raise(below, finer, &state, tolerance);
            cost = cost + std::mem::take(&mut finer.cost) + std::mem::take(&mut below.cost);
            let (raised, residual) = raised?;
            state = raised;
            solution = SteadySolution::read(finer, &state, speed, residual).above(&solution);
        }
        let Cost { newton_steps, krylov_iterations, .. } = cost;
        Ok(SteadySolution { newton_steps, krylov_iterations, ..solution })
    }
}

/// Residual of an exact contact.
fn tolerance(last: bool) -> f64 {
    if last { EXACT } else { EXACT_ENOUGH }
}

/// The exact contact on a finer grid and its residual: from that on the coarser grid, or if its edges are too far away,
/// from the same with a barrier.
fn raise(
    below: &mut Level,
    finer: &mut Level,
    state: &State,
    tolerance: f64,
) -> Result<(State, f64), NotConverged> {
    let guess = transfer(state, 0.0, below, finer);
    close_nearby(finer, guess, tolerance).or_else(|NotConverged| {
        let opened = open(below, state.clone())?;
        let guess = transfer(&opened, BARRIER, below, finer);
        close(finer, guess, tolerance)
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::setting;
    use super::super::{BlockOptions, SteadyContact, growth};
    use super::*;
    use crate::rubber::{Rheology, Rubber};
    use crate::surface::Wave;
    use approx::assert_relative_eq;

    const PERIOD: f64 = 1e-3;
    const SPEED: f64 = 0.05;

    /// Four octaves with an rms slope of 0.5 each.
    fn profile() -> RigidProfile {
        let wave = |octave: i32| {
            let wavelength = PERIOD / 2_f64.powi(octave);
            Wave {
                wavelength,
                amplitude: 0.11 * wavelength,
                phase: 1.3 * f64::from(octave * octave),
            }
        };
        RigidProfile::from_waves(&(0..4).map(wave).collect::<Vec<_>>(), PERIOD)
    }

    #[test]
    fn a_solution_from_half_the_columns_is_that_of_the_grid_itself() {
        let (rubber, law) = (Rubber::table_2_1(), Rheology::NeoHookean);
        let contact = |columns: usize| {
            SteadyContact::new(&rubber, law, SPEED, profile(), BlockOptions::new(columns)).unwrap()
        };
        let (mut climbed, mut half) = (contact(512), contact(256));
        // The second pressure is reached from the first, the third is too far for that.
        for pressure in [2e5, 2.5e5, 5e5] {
            let solution = climbed.solve(pressure).unwrap();
            assert_eq!(solution.mean_pressure, pressure);
            assert!(solution.residual < EXACT);
            let coarser = solution.coarser.unwrap();
            let expected = half.solve(pressure).unwrap();
            assert_eq!(expected.coarser, None);
            assert_relative_eq!(
                coarser.friction_coefficient,
                expected.friction_coefficient,
                max_relative = 1e-4
            );
            let setting = setting(&rubber, law, SPEED);
            let mut path =
                growth::grow(&setting, &profile(), BlockOptions::new(512), pressure).unwrap();
            let (state, residual) = path.finish(EXACT).unwrap();
            let grown = SteadySolution::read(&path.level, &state, SPEED, residual);
            assert_relative_eq!(
                solution.friction_coefficient,
                grown.friction_coefficient,
                max_relative = 1e-7
            );
            assert_relative_eq!(
                solution.contact_area_fraction,
                grown.contact_area_fraction,
                max_relative = 1e-6
            );
        }
    }
}
