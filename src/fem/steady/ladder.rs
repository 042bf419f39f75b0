//! Finer grids above the one of a path.
//!
//! A path takes many points, of which the exact contact at one pressure needs none on a fine grid: the
//! exact contact of a grid, taken to one of twice the columns, is a few Newton steps from that one's. So a
//! profile of many scales grows and is pressed on a coarse grid, and each solution climbs from there; what
//! its last two grids say tells the error of the mesh.

use super::super::profile::RigidProfile;
use super::NotConverged;
use super::level::{Cost, Level};
use super::path::{EXACT, EXACT_ENOUGH, Path, close, close_nearby};
use super::solution::SteadySolution;
use super::state::State;
use super::transfer::transfer;

/// Fewest columns on the shortest wave on the grid of a path.
const FEWEST_PER_WAVE: f64 = 32.0;

/// The columns of the grids, and those that have been made.
pub(super) struct Ladder {
    /// Of the path first, of the wanted grid last.
    columns: Vec<usize>,
    /// Those above the path's.
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

    /// The solution on the wanted grid from the exact contact of the path and its residual, with all
    /// that was spent since the one before; `new` makes a level of so many columns.
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
            let (below, finer) = (below.last().unwrap_or(&path.level), &mut finer[0]);
            let tolerance = tolerance(above + 1 == self.columns.len() - 1);
            let raised = raise(below, finer, path, &state, tolerance);
            cost = cost + std::mem::take(&mut finer.cost);
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

/// The exact contact on a finer grid and its residual: from that on the grid below, or where this fails
/// from the state of the path behind its barrier, if that is at the same pressure.
fn raise(
    below: &Level,
    finer: &mut Level,
    path: &Path,
    state: &State,
    tolerance: f64,
) -> Result<(State, f64), NotConverged> {
    let guess = transfer(state, 0.0, below, finer);
    close_nearby(finer, guess, tolerance).or_else(|NotConverged| {
        if path.state.pressure != state.pressure {
            return Err(NotConverged);
        }
        let guess = path.state_on(finer);
        close(finer, guess, tolerance)
    })
}
