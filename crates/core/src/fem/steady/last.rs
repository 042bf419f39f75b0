//! The last solution before a pressure that has none.

use super::super::error::PathEnd;
use super::path::Path;
use super::solution::SteadySolution;
use super::{NotConverged, SteadyContact};

/// Points of a path that ended whose contact is closed, from the last one back, before it is given up.
const MOST_CLOSED: usize = 8;
/// Halvings of what lies between the last such point and the next one that is none.
const MOST_HALVINGS: usize = 3;

impl SteadyContact {
    /// The highest pressure below a wanted one that has been solved. A profile of many scales has no other point:
    /// to close contacts behind the barrier one after the other would cost more than a solution.
    pub(super) fn last_solved(&self, wanted: f64) -> PathEnd {
        let below = self.solved.iter().filter(|(pressure, _)| *pressure < wanted);
        let last = below.max_by(|(one, _), (other, _)| one.total_cmp(other));
        last.map_or(PathEnd::NotGrown, |(_, at)| *at)
    }

    /// The highest point at which the contact converges, of the path that ended or of what was known
    /// before; a coarser grid may have reached the `wanted` one, which says nothing of this one.
    pub(super) fn last_converged(&mut self, ended: Option<Box<Path>>, wanted: f64) -> PathEnd {
        let known = self.path.take();
        let mut reached: Option<SteadySolution> = None;
        for mut path in ended.map(|path| *path).into_iter().chain(known) {
            path.take_cost();
            let before = self.path.replace(path);
            let solution = self.last_of_path();
            // Only a path on the grid of the ladder can be gone on with.
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
            path.step_back()?;
        }
        None
    }

    /// Looks for a later exact solution than the one at the path, before a pressure at which there is
    /// none.
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
