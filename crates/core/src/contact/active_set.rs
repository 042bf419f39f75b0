//! Active-set iteration for the contact on one grid.
//!
//! Semismooth Newton for the complementarity problem: solve the linear system for the pressures
//! on the present contact set, then drop points under tension and add points that penetrate.
//! The linear systems are solved by GMRES, preconditioned from the left, so that its tolerance
//! is one of pressure: near a contact edge the sign of a small pressure decides.

use super::direct::{self, Dense};
use super::half_space::HalfSpace;
use super::preconditioner::Preconditioner;
use super::solution::displacement_scale;
use crate::numerics::Interrupt;
use crate::numerics::krylov::{KrylovLimits, euclidean_norm, gmres};

/// How accurately a grid is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Goal {
    /// As a start for the next finer grid: until few points still change.
    Start,
    /// As the solution: until no point changes and the residual is below the tolerance.
    Solution {
        /// Tolerance of the residual.
        tolerance: f64,
    },
}

/// Contact on one grid, updated in place.
pub(super) struct Contact<'a> {
    pub space: &'a mut HalfSpace,
    /// Heights with mean zero.
    pub heights: &'a [f64],
    /// Displacement by a unit pressure at point 0.
    pub kernel: &'a [f64],
    pub mean_pressure: f64,
    /// Pressures; the contact set is where they are positive.
    pub pressure: Vec<f64>,
    /// Displacement under `pressure`.
    pub displacement: Vec<f64>,
    pub mean_separation: f64,
    /// Ends the iteration early, without convergence.
    pub interrupt: &'a Interrupt,
}

/// What an iteration ended with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outcome {
    pub converged: bool,
    pub iterations: usize,
    pub applications: usize,
    pub changes: usize,
}

/// Krylov tolerance once the active set is unchanged, or if it has not settled under looser ones. While the set changes
/// the tolerance is one over the number of points: the pressure next to a contact edge, whose sign decides, falls with
/// a power of the spacing between a half and one.
const TIGHT: f64 = 1e-8;
/// Factor of that looser tolerance if the set has not settled in the first iterations: where loss makes the edge
/// condition of one side weak, wrong signs keep the set changing.
const LOOSE_LATER: f64 = 1e-2;
/// Active-set iterations with loose, then with tight linear solves.
const LOOSE_ITERATIONS: usize = 25;
const MOST_ITERATIONS: usize = 600;
/// Tight solves on an unchanged set without a lower residual, after which the rest counts as round-off. The caller
/// checks whether it is small enough.
const STALLED_ITERATIONS: usize = 3;
/// Iteration after which the set grows again from the highest point alone: the start was too far off, for example
/// because the coarser grids miss a peak of one point that carries the load.
const RESTART_ITERATION: usize = 60;
/// Iterations before a growing number of changes is damped.
pub(super) const UNDAMPED_ITERATIONS: usize = 3;
/// Smallest fraction of a run of wrong points that changes sides.
const LEAST_DAMPING: f64 = 0.1;
/// Iterations after which a coarse grid is left, converged or not.
const START_ITERATIONS: usize = 40;
const MOST_KRYLOV_ITERATIONS: usize = 120;
/// Most corrections of a direct solve, and the residual below which none is made.
const MOST_CORRECTIONS: usize = 5;
const ROUND_OFF: f64 = 1e-13;

/// Points that are on the wrong side.
pub(super) struct Violations {
    pub leave: Vec<u32>,
    pub enter: Vec<u32>,
}

/// Detects a residual that no longer falls.
struct Stall {
    least: f64,
    iterations: usize,
}

impl Stall {
    /// Records a residual; returns whether it has stopped falling under tight solves.
    fn after(&mut self, residual: f64, tight: bool) -> bool {
        let falls = residual < 0.5 * self.least;
        self.iterations = if falls || !tight { 0 } else { self.iterations + 1 };
        self.least = self.least.min(residual);
        self.iterations >= STALLED_ITERATIONS
    }
}

impl Contact<'_> {
    /// Iterates until the goal is reached or the iterations are used up.
    pub fn solve(&mut self, goal: Goal) -> Outcome {
        let mut set = self.contact_set();
        if set.is_empty() {
            // Heights of a coarser grid may exceed the range of numbers.
            set = vec![self.highest_point()];
            self.keep_pressure_on(&set);
        }
        let mut tight = false;
        let mut applications = 0;
        let mut iteration = 0;
        let mut damping: f64 = 1.0;
        let mut previous = usize::MAX;
        let mut stall = Stall { least: f64::INFINITY, iterations: 0 };
        loop {
            iteration += 1;
            let loose = if iteration > UNDAMPED_ITERATIONS { LOOSE_LATER } else { 1.0 };
            let loose = (loose / self.heights.len() as f64).max(TIGHT);
            let tolerance = if tight { TIGHT } else { loose };
            applications += self.solve_on(&set, tolerance);
            let residual = self.residual(&set);
            let wrong = self.violations(&set, goal);
            let changes = wrong.leave.len() + wrong.enter.len();
            let outcome =
                |converged| Outcome { converged, iterations: iteration, applications, changes };
            if self.interrupt.is_set() {
                return outcome(false);
            }
            match goal {
                Goal::Start if changes == 0 || iteration == START_ITERATIONS => {
                    self.drop_tension();
                    return outcome(true);
                }
                Goal::Solution { tolerance }
                    if changes == 0 && (residual <= tolerance || stall.after(residual, tight)) =>
                {
                    self.drop_tension();
                    return outcome(true);
                }
                _ if iteration == MOST_ITERATIONS => return outcome(false),
                _ => {}
            }
            tight = changes == 0 || iteration > LOOSE_ITERATIONS;
            if iteration > UNDAMPED_ITERATIONS {
                damping = damped(damping, changes >= previous);
            }
            previous = changes;
            set = exchange(&set, &wrong, damping, self.heights.len());
            if set.is_empty() || iteration == RESTART_ITERATION {
                set = vec![self.highest_point()];
            }
            self.keep_pressure_on(&set);
        }
    }

    fn contact_set(&self) -> Vec<u32> {
        let points = 0..self.pressure.len() as u32;
        points.filter(|i| self.pressure[*i as usize] > 0.0).collect()
    }

    fn highest_point(&self) -> u32 {
        let height = |i: &usize| self.heights[*i];
        (0..self.heights.len()).max_by(|a, b| height(a).total_cmp(&height(b))).unwrap_or(0) as u32
    }

    /// Solves `w + ubar = z` on the set at the given load; returns the applications of the
    /// operator to the grid.
    fn solve_on(&mut self, set: &[u32], tolerance: f64) -> usize {
        let load = self.mean_pressure * self.pressure.len() as f64;
        if direct::is_worth_it(set.len(), self.pressure.len())
            && let Some(applications) = self.solve_directly(set, load)
        {
            return applications;
        }
        self.iterate_on(set, tolerance, load)
    }

    /// The same by dense factors, with corrections as long as they lower the residual: for a small load on large
    /// heights the first solve has too few digits. `None` if the matrix is singular.
    fn solve_directly(&mut self, set: &[u32], load: f64) -> Option<usize> {
        let dense = Dense::new(self.kernel, set);
        let heights: Vec<f64> = set.iter().map(|i| self.heights[*i as usize]).collect();
        let mut pressure = dense.solve(&heights, load)?;
        self.place(set, pressure.iter().copied());
        let mut residual = self.residual(set);
        for applications in 1..=MOST_CORRECTIONS {
            if residual <= ROUND_OFF {
                return Some(applications);
            }
            let gaps: Vec<f64> = set.iter().map(|i| -self.separation(*i as usize)).collect();
            let correction = dense.solve(&gaps, load - pressure.iter().sum::<f64>())?;
            let before = pressure.clone();
            pressure.iter_mut().zip(correction).for_each(|(t, dt)| *t += dt);
            self.place(set, pressure.iter().copied());
            let next = self.residual(set);
            if next >= residual {
                self.place(set, before.into_iter());
                return Some(applications + 2);
            }
            residual = next;
        }
        Some(1 + MOST_CORRECTIONS)
    }

    /// Puts the pressures on the set and computes displacements and mean separation.
    fn place(&mut self, set: &[u32], pressure: impl Iterator<Item = f64>) {
        self.pressure.fill(0.0);
        for (i, t) in set.iter().zip(pressure) {
            self.pressure[*i as usize] = t;
        }
        self.space.displacement(&self.pressure, &mut self.displacement);
        let gap = |i: &u32| self.heights[*i as usize] - self.displacement[*i as usize];
        // About the first gap: a plain sum of many equal gaps has a round-off that, on a plateau
        // under a small load, exceeds 1e-10 of the displacement.
        let first = set.first().map_or(0.0, gap);
        let about_first = set.iter().map(|i| gap(i) - first).sum::<f64>();
        self.mean_separation = first + about_first / set.len() as f64;
    }

    fn iterate_on(&mut self, set: &[u32], tolerance: f64, load: f64) -> usize {
        let preconditioner = Preconditioner::new(self.space, self.kernel, set);
        let mut t: Vec<f64> = set.iter().map(|i| self.pressure[*i as usize]).collect();
        preconditioner.add_force(load - t.iter().sum::<f64>(), &mut t);
        let mut r = vec![0.0; set.len()];
        self.space.displacement_on(set, &t, &mut r);
        for (r, i) in r.iter_mut().zip(set) {
            *r = self.heights[*i as usize] - *r;
        }
        let mut correction = vec![0.0; set.len()];
        preconditioner.apply(self.space, set, &r, &mut correction);
        // Corrections below the round-off of the pressures are not needed.
        let limits = KrylovLimits {
            tolerance: (tolerance * euclidean_norm(&correction)).max(1e-15 * euclidean_norm(&t)),
            max_iterations: MOST_KRYLOV_ITERATIONS,
        };
        let mut displaced = vec![0.0; set.len()];
        let operator = |v: &[f64], out: &mut [f64]| {
            self.space.displacement_on(set, v, &mut displaced);
            preconditioner.apply(self.space, set, &displaced, out);
        };
        let report = gmres(operator, &mut correction, limits, self.interrupt);
        self.place(set, t.iter().zip(&correction).map(|(t, dt)| t + dt));
        // Two more for the first residual and the last displacement.
        report.iterations + 2
    }

    /// Largest separation on the set over the scale of displacements, or the relative error of the load, whichever is
    /// larger: where the set has shrunk from far larger pressures, the load has lost digits that only another iteration
    /// restores.
    fn residual(&self, set: &[u32]) -> f64 {
        let scale = self.displacement_scale();
        let largest =
            set.iter().map(|i| self.separation(*i as usize).abs()).fold(0.0_f64, f64::max);
        let mean = self.pressure.iter().sum::<f64>() / self.pressure.len() as f64;
        (largest / scale).max((mean / self.mean_pressure - 1.0).abs())
    }

    fn separation(&self, i: usize) -> f64 {
        self.mean_separation + self.displacement[i] - self.heights[i]
    }

    fn displacement_scale(&self) -> f64 {
        displacement_scale(&self.displacement, self.heights)
    }

    fn violations(&self, set: &[u32], goal: Goal) -> Violations {
        // Round-off decides the side of a point whose pressure and gap both vanish.
        let margin = match goal {
            Goal::Start => 0.0,
            Goal::Solution { tolerance } => 0.5 * tolerance,
        };
        let tension = -margin * self.mean_pressure;
        let penetration = -margin * self.displacement_scale();
        let mut wrong = Violations { leave: Vec::new(), enter: Vec::new() };
        let mut in_contact = set.iter().copied().peekable();
        for i in 0..self.heights.len() {
            if in_contact.next_if_eq(&(i as u32)).is_some() {
                if self.pressure[i] < tension {
                    wrong.leave.push(i as u32);
                }
            } else if self.separation(i) < penetration {
                wrong.enter.push(i as u32);
            }
        }
        wrong
    }

    fn keep_pressure_on(&mut self, set: &[u32]) {
        let mut in_contact = set.iter().copied().peekable();
        for (i, t) in self.pressure.iter_mut().enumerate() {
            *t = if in_contact.next_if_eq(&(i as u32)).is_some() { t.max(0.0) } else { 0.0 };
        }
    }

    /// Sets pressures below zero, which are within the tolerance, to zero.
    fn drop_tension(&mut self) {
        self.pressure.iter_mut().for_each(|t| *t = t.max(0.0));
    }
}

/// The next damping, smaller after a number of changes that did not fall.
pub(super) fn damped(damping: f64, grows: bool) -> f64 {
    if grows { (0.5 * damping).max(LEAST_DAMPING) } else { (1.5 * damping).min(1.0) }
}

/// The next contact set: of each run of neighbouring wrong points the share `damping` (at least
/// one) changes sides, from the contact edge on.
///
/// Where the rubber is lossy the edge condition is so weak on one side of a contact that an edge
/// one point off makes many points change; exchanging them all at once can then overshoot without end.
pub(super) fn exchange(set: &[u32], wrong: &Violations, damping: f64, points: usize) -> Vec<u32> {
    let in_contact = |i: usize| set.binary_search(&(i as u32)).is_ok();
    let chosen = |list: &[u32], leaving: bool| -> Vec<u32> {
        let mut chosen = Vec::with_capacity(list.len());
        for run in list.chunk_by(|a, b| *b == a + 1) {
            let (first, last) = (run[0] as usize, run[run.len() - 1] as usize);
            // The edge is where the neighbour of the run is on the side that the run goes to.
            let edge_before = in_contact((first + points - 1) % points) != leaving;
            let edge_after = in_contact((last + 1) % points) != leaving;
            let count = ((run.len() as f64 * damping).ceil() as usize).max(1);
            chosen.extend(from_the_edge(run, count, edge_before, edge_after));
        }
        chosen
    };
    let (leave, enter) = (chosen(&wrong.leave, true), chosen(&wrong.enter, false));
    let mut leave = leave.iter().peekable();
    let mut next: Vec<u32> =
        set.iter().filter(|i| leave.next_if_eq(i).is_none()).copied().collect();
    next.extend(&enter);
    next.sort_unstable();
    next
}

/// `count` points of a run: from its one edge, from both, or from its middle if it has none.
fn from_the_edge(run: &[u32], count: usize, before: bool, after: bool) -> Vec<u32> {
    let n = run.len();
    match (before, after) {
        (true, false) => run[..count].to_vec(),
        (false, true) => run[n - count..].to_vec(),
        (true, true) => {
            let left = count.div_ceil(2);
            let right = (n - (count - left)).max(left);
            [&run[..left], &run[right..]].concat()
        }
        (false, false) => run[(n - count) / 2..usize::midpoint(n, count)].to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rubber::Rubber;
    use realfft::RealFftPlanner;
    use std::f64::consts::TAU;

    #[test]
    fn a_residual_that_cannot_fall_any_more_ends_the_iteration() {
        let n = 128;
        let rubber = Rubber::elastic(3e6, 0.5);
        let mut space = HalfSpace::new(&mut RealFftPlanner::new(), &rubber, 0.01, 1e-3, n).unwrap();
        let (mut unit, mut kernel) = (vec![0.0; n], vec![0.0; n]);
        unit[0] = 1.0;
        space.displacement(&unit, &mut kernel);
        let heights: Vec<f64> =
            (0..n).map(|i| 1e-5 * (TAU * (i as f64 + 0.3) / n as f64).cos()).collect();
        let mut contact = Contact {
            space: &mut space,
            heights: &heights,
            kernel: &kernel,
            mean_pressure: 1e4,
            pressure: vec![1e4; n],
            displacement: vec![0.0; n],
            mean_separation: 0.0,
            interrupt: &Interrupt::default(),
        };
        let outcome = contact.solve(Goal::Solution { tolerance: 0.0 });
        assert!(outcome.converged && outcome.changes == 0);
        // A few for the set, three for the stall.
        assert!(outcome.iterations < 30, "{}", outcome.iterations);
        let set = contact.contact_set();
        let residual = contact.residual(&set);
        assert!(residual > 0.0 && residual < 1e-12, "{residual:e}");
    }
}
