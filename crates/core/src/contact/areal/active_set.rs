//! Active-set iteration for the areal contact on one grid.
//!
//! Semismooth Newton for the complementarity problem (Hintermüller, Ito & Kunisch 2002,
//! doi:10.1137/S1052623401383558): solve for the pressures on the present contact set, then drop points under tension and
//! add points that penetrate. Early systems are solved as accurately as their set deserves.

use super::super::active_set::{UNDAMPED_ITERATIONS, Violations, damped, exchange};
use super::super::direct::{self, Dense};
use super::super::solution::displacement_scale;
use super::half_space::{ArealHalfSpace, mean};
use super::linear::SetSystem;
use crate::numerics::Interrupt;

/// How accurately a grid is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Goal {
    /// As a start for the next finer grid.
    Start,
    /// As the solution: until no point changes and the residual is below the tolerance.
    Solution {
        /// Tolerance of the residual.
        tolerance: f64,
    },
}

/// Contact on one grid, updated in place.
pub(super) struct Contact<'a> {
    pub space: &'a mut ArealHalfSpace,
    /// Heights with mean zero.
    pub heights: &'a [f64],
    pub mean_pressure: f64,
    /// Pressures; the contact set is where they are positive.
    pub pressure: Vec<f64>,
    /// Displacement under `pressure`.
    pub displacement: Vec<f64>,
    pub mean_separation: f64,
    /// Guess of the root mean square displacement in m.
    pub scale: f64,
    /// Ends the iteration early, without convergence.
    pub interrupt: &'a Interrupt,
}

/// What an iteration ended with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outcome {
    pub converged: bool,
    pub iterations: usize,
    /// Pairs of transforms.
    pub pairs: usize,
    pub changes: usize,
}

/// Gaps on the set that a system leaves, in parts of the root mean square displacement: this factor times the part of
/// points that changed last, within limits.
const GAP_PER_CHANGE: f64 = 1e-2;
const LARGEST_GAP: f64 = 1e-3;
/// The same once no point changes, in parts of what would just meet the tolerance of the residual.
const FINAL_GAP: f64 = 0.5;
/// Smallest root mean square gap asked for, in parts of the tolerance of the largest one.
const SMALLEST_GAP: f64 = 1e-2;
/// Iterations after which a coarse grid is left as it is, since on a grid that does not resolve its contacts the last
/// points change sides one by one; and the part of points below which changes do not matter there.
const START_ITERATIONS: usize = 6;
const START_CHANGES: f64 = 0.02;
const MOST_ITERATIONS: usize = 100;
/// Most corrections of a direct solve, and the residual below which none is made.
const MOST_CORRECTIONS: usize = 5;
const ROUND_OFF: f64 = 1e-13;
/// Solves on an unchanged set without a lower residual, after which the rest counts as round-off.
const STALLED_ITERATIONS: usize = 3;

impl Contact<'_> {
    /// Iterates until the goal is reached or the iterations are used up.
    pub fn solve(&mut self, goal: Goal) -> Outcome {
        let mut set = self.contact_set();
        if set.is_empty() {
            set = vec![self.highest_point()];
        }
        let (mut pairs, mut iterations, mut least, mut stalled) = (0, 0, f64::INFINITY, 0);
        let (mut gap, mut damping, mut previous) = (LARGEST_GAP, 1.0, usize::MAX);
        loop {
            iterations += 1;
            pairs += self.solve_on(&set, gap * self.scale);
            let scale = self.displacement_scale();
            self.scale = scale;
            let residual = self.residual(&set, scale);
            let wrong = self.violations(&set, goal, scale);
            let changes = wrong.leave.len() + wrong.enter.len();
            let part = changes as f64 / set.len() as f64;
            let outcome = |converged| Outcome { converged, iterations, pairs, changes };
            if self.interrupt.is_set() {
                return outcome(false);
            }
            match goal {
                Goal::Start if part <= START_CHANGES || iterations == START_ITERATIONS => {
                    self.drop_tension();
                    return outcome(true);
                }
                Goal::Solution { tolerance } => {
                    if changes == 0 {
                        // A start that is better than what was asked for is not improved yet.
                        let asked = gap < residual;
                        stalled =
                            if residual < 0.5 * least { 0 } else { stalled + usize::from(asked) };
                        least = least.min(residual);
                    }
                    if changes == 0 && (residual <= tolerance || stalled == STALLED_ITERATIONS) {
                        self.drop_tension();
                        return outcome(true);
                    }
                    if iterations == MOST_ITERATIONS {
                        return outcome(false);
                    }
                    gap = if changes > 0 {
                        (GAP_PER_CHANGE * part).clamp(FINAL_GAP * tolerance, LARGEST_GAP)
                    } else {
                        // The largest gap is some multiple of the root mean square that was asked for, or less than that
                        // from a good start.
                        let multiple = (residual / gap).max(1.0);
                        (FINAL_GAP * tolerance / multiple).max(SMALLEST_GAP * tolerance)
                    };
                }
                Goal::Start => {}
            }
            if iterations > UNDAMPED_ITERATIONS {
                damping = damped(damping, changes >= previous);
            }
            previous = changes;
            // As on the line: of neighbouring wrong points of a row those next to the edge change sides first.
            set = exchange(&set, &wrong, damping, self.heights.len());
            if set.is_empty() {
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

    /// Solves `w + ubar = z` on the set at the given load, up to root mean square gaps in m; returns the pairs of
    /// transforms.
    fn solve_on(&mut self, set: &[u32], gap: f64) -> usize {
        let load = self.mean_pressure * self.pressure.len() as f64;
        if direct::is_worth_it(set.len(), self.pressure.len())
            && let Some(pairs) = self.solve_directly(set, load)
        {
            return pairs;
        }
        let mut t: Vec<f64> = set.iter().map(|i| self.pressure[*i as usize]).collect();
        let (heights, interrupt) = (self.heights, self.interrupt);
        let mut system = SetSystem { space: &mut *self.space, set, heights, interrupt };
        let pairs = system.solve(&mut t, load, gap);
        self.place(set, &t);
        pairs + 1
    }

    /// The same by dense factors, with corrections as long as they lower the residual. `None` if the matrix is singular.
    fn solve_directly(&mut self, set: &[u32], load: f64) -> Option<usize> {
        let kernel = self.space.kernel();
        let dense = Dense::with_influence(set, kernel.at_origin().abs(), |i, j| {
            kernel.between(set[i], set[j])
        });
        let heights: Vec<f64> = set.iter().map(|i| self.heights[*i as usize]).collect();
        let mut pressure = dense.solve(&heights, load)?;
        self.place(set, &pressure);
        let mut residual = self.residual(set, self.displacement_scale());
        for pairs in 1..=MOST_CORRECTIONS {
            if residual <= ROUND_OFF {
                return Some(pairs);
            }
            let gaps: Vec<f64> = set.iter().map(|i| -self.separation(*i as usize)).collect();
            let correction = dense.solve(&gaps, load - pressure.iter().sum::<f64>())?;
            let before = pressure.clone();
            pressure.iter_mut().zip(correction).for_each(|(t, dt)| *t += dt);
            self.place(set, &pressure);
            let next = self.residual(set, self.displacement_scale());
            if next >= residual {
                self.place(set, &before);
                return Some(pairs + 2);
            }
            residual = next;
        }
        Some(1 + MOST_CORRECTIONS)
    }

    /// Puts the pressures on the set and computes displacements and mean separation.
    fn place(&mut self, set: &[u32], pressure: &[f64]) {
        self.pressure.fill(0.0);
        set.iter().zip(pressure).for_each(|(i, t)| self.pressure[*i as usize] = *t);
        self.space.displacement(&self.pressure, &mut self.displacement);
        let gaps: Vec<f64> = set
            .iter()
            .map(|i| self.heights[*i as usize] - self.displacement[*i as usize])
            .collect();
        self.mean_separation = mean(&gaps);
    }

    /// Largest separation on the set over the scale of displacements, or the relative error of the load, whichever is
    /// larger.
    fn residual(&self, set: &[u32], scale: f64) -> f64 {
        let largest =
            set.iter().map(|i| self.separation(*i as usize).abs()).fold(0.0_f64, f64::max);
        let mean = mean(&self.pressure);
        (largest / scale).max((mean / self.mean_pressure - 1.0).abs())
    }

    fn separation(&self, i: usize) -> f64 {
        self.mean_separation + self.displacement[i] - self.heights[i]
    }

    fn displacement_scale(&self) -> f64 {
        displacement_scale(&self.displacement, self.heights)
    }

    fn violations(&self, set: &[u32], goal: Goal, scale: f64) -> Violations {
        // Round-off decides the side of a point whose pressure and gap both vanish.
        let margin = match goal {
            Goal::Start => 0.0,
            Goal::Solution { tolerance } => 0.5 * tolerance,
        };
        let tension = -margin * self.mean_pressure;
        let penetration = -margin * scale;
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
