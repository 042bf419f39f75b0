//! The last solution before a pressure that has none.

use super::super::error::PathEnd;
use super::path::Path;
use super::solution::SteadySolution;
use super::{NotConverged, SteadyContact};

/// Points of an ended path, from the last one back, at which the exact contact is tried.
const MOST_CLOSED: usize = 8;
/// Ratio of the pressures that are tried below one at which the law of the rubber does not hold.
const LOWER: f64 = 1.5;
/// Halvings of the interval between the last point with an exact contact and the first without.
const MOST_HALVINGS: usize = 3;

impl SteadyContact {
    /// The highest solved pressure below `wanted`. For a profile of many scales only solved pressures count: to solve
    /// the exact contact at points of the path would cost more than a solution.
    pub(super) fn last_solved(&self, wanted: f64) -> PathEnd {
        let below = self.solved.iter().filter(|(pressure, _)| *pressure < wanted);
        let last = below.max_by(|(one, _), (other, _)| one.total_cmp(other));
        last.map_or(PathEnd::NotGrown, |(_, at)| *at)
    }

    /// The highest point at which the contact converges, of the path that ended or of what was known
    /// before; a coarser grid may have reached the `wanted` one, which proves nothing for this one.
    pub(super) fn last_converged(&mut self, ended: Option<Box<Path>>, wanted: f64) -> PathEnd {
        let known = self.path.take();
        let mut reached: Option<SteadySolution> = None;
        for mut path in ended.map(|path| *path).into_iter().chain(known) {
            path.take_cost();
            let before = self.path.replace(path);
            let solution = self.last_of_path();
            // Only a path on the grid of the ladder can be continued.
            let usable = self.path.as_ref().is_some_and(|path| {
                solution.is_some()
                    && path.level.grid().contact_nodes() == self.ladder.path_columns()
            });
            if !usable {
                self.path = before;
            }
            reached = match (reached, solution) {
                (Some(best), Some(new)) if best.mean_pressure >= new.mean_pressure => Some(best),
                (best, new) => new.or(best),
            };
        }
        let before = reached.filter(|solution| solution.mean_pressure < wanted);
        before.map_or(PathEnd::NotStarted, |solution| PathEnd::at(&solution))
    }

    /// The exact solution at the last point of the path at which it converges; the path is there then.
    fn last_of_path(&mut self) -> Option<SteadySolution> {
        let mut beyond = None;
        for _ in 0..MOST_CLOSED {
            if let Ok(solution) = self.conclude() {
                return Some(match beyond {
                    Some(beyond) => self.last_before(solution, beyond),
                    None => solution,
                });
            }
            let path = self.path.as_mut()?;
            beyond = Some(path.state.pressure);
            if path.step_back().is_none() {
                // On a new grid no state was passed; where the law of the rubber ended the path, there are contacts below.
                self.beyond?;
                path.jump_to(path.state.pressure / LOWER).ok()?;
            }
        }
        None
    }

    /// Looks for an exact solution at a higher pressure than that of the path, below a pressure that has none.
    fn last_before(&mut self, mut last: SteadySolution, mut beyond: f64) -> SteadySolution {
        for _ in 0..MOST_HALVINGS {
            let Some(path) = self.path.as_mut() else { break };
            let (state, middle) = (path.state.clone(), (last.mean_pressure * beyond).sqrt());
            match path.jump_to(middle).and_then(|()| self.conclude()) {
                Ok(solution) => last = solution,
                Err(NotConverged) => {
                    beyond = middle;
                    if let Some(path) = self.path.as_mut() {
                        path.state = state;
                    }
                }
            }
        }
        last
    }
}
