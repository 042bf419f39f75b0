//! Newton's method for the contact under a local law on one grid.
//!
//! The unknown at a point is `s = c p + d` with the indentation `d = g(0) - g`: to every `s`
//! belongs exactly one point of the law, in a gap (`s <= 0`, `p = 0`) as in contact, so that the
//! complementarity is gone and what remains is a system of equations,
//!
//! ```text
//! F = w[p(s)] - z + d(s) - a = 0,   mean(p(s)) = p,   a = g(0) - ubar
//! ```
//!
//! Its Newton step is one of the primal-dual active set: the linear system lives on the points
//! with `s > 0`. With `c` the displacement of a point by its own pressure, the coordinate `s`
//! follows the indentation where the law is soft and the pressure where it is hard; that a law
//! begins with an infinite slope does no harm, since `d` is finite.

use super::law::{LawPoint, LocalLaw};
use super::layer::LayeredSpace;
use crate::contact::half_space::HalfSpace;
use crate::contact::preconditioner::{Preconditioner, SetOperator};
use crate::contact::solution::displacement_scale;
use crate::numerics::Interrupt;
use crate::numerics::krylov::{KrylovLimits, euclidean_norm, gmres};

const MOST_ITERATIONS: usize = 60;
const MOST_KRYLOV_ITERATIONS: usize = 150;
/// Halvings of a step before the iteration is given up.
const MOST_HALVINGS: usize = 10;
/// A step may end above the residual before it, but not above the largest of this many last ones:
/// where the law is hard, the best way passes a point that is worse.
const REMEMBERED: usize = 4;
/// Relative tolerance of the last linear solves.
const TIGHT: f64 = 1e-8;

/// Contact on one grid, updated in place.
pub(super) struct Newton<'a> {
    pub space: &'a mut HalfSpace,
    pub heights: &'a [f64],
    /// Displacement by a unit pressure at point 0.
    pub kernel: &'a [f64],
    pub law: &'a LocalLaw,
    pub mean_pressure: f64,
    /// Compliance in m/Pa by which the law is softened: zero for the law itself.
    pub softening: f64,
    /// Displacement in m that stands for the whole load in the norm that has to fall.
    pub load_length: f64,
    /// Ends the iteration early, without convergence.
    pub interrupt: &'a Interrupt,
}

/// Where an iteration stands.
#[derive(Debug, Clone)]
pub(super) struct State {
    /// `s = c p + d` in m at the grid points.
    pub line: Vec<f64>,
    /// Approach `a` of the mean planes from first touch in m.
    pub approach: f64,
    /// Pressures in Pa that belong to `line`, or a guess at them.
    pub pressure: Vec<f64>,
}

/// What an iteration ended with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outcome {
    pub converged: bool,
    pub iterations: usize,
    pub krylov_iterations: usize,
}

/// A state with all that follows from it.
struct Evaluation {
    state: State,
    compliance: Vec<f64>,
    defect: Vec<f64>,
    /// Mean pressure less the present mean, in Pa.
    missing_pressure: f64,
    /// Largest violation, relative.
    residual: f64,
    /// Root mean square of the defect and of the missing load, in m.
    merit: f64,
}

struct Step {
    line: Vec<f64>,
    approach: f64,
    krylov_iterations: usize,
}

impl Newton<'_> {
    /// `c` of the coordinate `s = c p + d`, without the softening.
    pub fn coordinate_compliance(&self) -> f64 {
        self.kernel[0].abs()
    }

    /// Iterates from `state` until the residual is below `tolerance`.
    pub fn solve(&mut self, state: &mut State, tolerance: f64) -> Outcome {
        self.load_length = self.length_of_load();
        let mut now = self.evaluate(state.clone());
        let mut merits = vec![now.merit];
        let mut krylov_iterations = 0;
        let mut iterations = 0;
        let mut tight = false;
        while now.residual > tolerance && iterations < MOST_ITERATIONS && !self.interrupt.is_set() {
            iterations += 1;
            let step = self.step(&now, tight);
            krylov_iterations += step.krylov_iterations;
            let recent = &merits[merits.len().saturating_sub(REMEMBERED)..];
            let allowed = recent.iter().copied().fold(0.0_f64, f64::max);
            match self.search(&now, &step, allowed) {
                Some(next) => {
                    now = next;
                    merits.push(now.merit);
                }
                // A step that leads nowhere may be one of a linear system solved too loosely.
                None if !tight => tight = true,
                None => break,
            }
        }
        let converged = now.residual <= tolerance;
        *state = now.state;
        Outcome { converged, iterations, krylov_iterations }
    }

    /// The longest of the step's halves that ends below `allowed`.
    fn search(&mut self, now: &Evaluation, step: &Step, allowed: f64) -> Option<Evaluation> {
        let mut share = 1.0;
        for _ in 0..=MOST_HALVINGS {
            let line = now.state.line.iter().zip(&step.line).map(|(s, ds)| s + share * ds);
            let next = self.evaluate(State {
                line: line.collect(),
                approach: now.state.approach + share * step.approach,
                pressure: now.state.pressure.clone(),
            });
            if next.merit < allowed * (1.0 - 1e-4 * share) || next.residual < now.residual {
                return Some(next);
            }
            share *= 0.5;
        }
        None
    }

    fn length_of_load(&self) -> f64 {
        let p = self.mean_pressure;
        let heights = euclidean_norm(self.heights) / (self.heights.len() as f64).sqrt();
        let compliance = self.space.compliance_range().0 + self.softening;
        (compliance * p + self.law.indentation(p)).max(1e-4 * heights)
    }

    fn point(&self, line: f64, guess: f64) -> LawPoint {
        let c = self.coordinate_compliance() + self.softening;
        let mut point = self.law.on_line(c, line, guess);
        point.indentation += self.softening * point.pressure;
        point.compliance += self.softening;
        point
    }

    fn evaluate(&mut self, mut state: State) -> Evaluation {
        let n = self.heights.len();
        let mut indentation = vec![0.0; n];
        let mut compliance = vec![0.0; n];
        for i in 0..n {
            let point = self.point(state.line[i], state.pressure[i]);
            state.pressure[i] = point.pressure;
            indentation[i] = point.indentation;
            compliance[i] = point.compliance;
        }
        let mut displacement = vec![0.0; n];
        self.space.displacement(&state.pressure, &mut displacement);
        let defect: Vec<f64> = (0..n)
            .map(|i| displacement[i] - self.heights[i] + indentation[i] - state.approach)
            .collect();
        let mean = state.pressure.iter().sum::<f64>() / n as f64;
        let missing_pressure = self.mean_pressure - mean;
        let scale = violation_scale(
            &displacement,
            self.heights,
            &indentation,
            self.space.compliance_range().0 * self.mean_pressure,
        );
        let violation = defect.iter().zip(&state.line).map(|(f, s)| {
            // In a gap only what the gap lacks to first touch is wrong.
            if *s > 0.0 { f.abs() } else { (s - f).max(0.0) }
        });
        let largest = violation.fold(0.0_f64, f64::max);
        let load = missing_pressure / self.mean_pressure;
        let mean_square = defect.iter().map(|f| f * f).sum::<f64>() / n as f64;
        let merit = mean_square.sqrt().hypot(load * self.load_length);
        let residual = (largest / scale).max(load.abs());
        Evaluation { state, compliance, defect, missing_pressure, residual, merit }
    }

    /// Newton step: `(A + K) dp - da = -F` on the set with the sum of `dp` given, in the gaps
    /// `ds = da - F - A dp`.
    fn step(&mut self, now: &Evaluation, tight: bool) -> Step {
        let n = self.heights.len();
        let set = contact_set(&now.state.line);
        if set.is_empty() {
            return self.touch(now);
        }
        let compliance: Vec<f64> = set.iter().map(|i| now.compliance[*i as usize]).collect();
        let mut layered = LayeredSpace::new(self.space, &compliance);
        let preconditioner = Preconditioner::new(&mut layered, self.kernel, &set);
        let mut change = vec![0.0; set.len()];
        let mut pressure: Vec<f64> = set.iter().map(|i| now.state.pressure[*i as usize]).collect();
        let before = pressure.clone();
        preconditioner.add_force(now.missing_pressure * n as f64, &mut pressure);
        for ((change, after), before) in change.iter_mut().zip(&pressure).zip(&before) {
            *change = after - before;
        }
        let mut r = vec![0.0; set.len()];
        layered.displacement_on(&set, &change, &mut r);
        for (r, i) in r.iter_mut().zip(&set) {
            *r = -now.defect[*i as usize] - *r;
        }
        let mut correction = vec![0.0; set.len()];
        preconditioner.apply(&mut layered, &set, &r, &mut correction);
        let loose = now.residual.clamp(TIGHT, (1.0 / n as f64).max(TIGHT));
        let relative = if tight { TIGHT } else { loose };
        let limits = KrylovLimits {
            tolerance: (relative * euclidean_norm(&correction))
                .max(1e-15 * euclidean_norm(&pressure)),
            max_iterations: MOST_KRYLOV_ITERATIONS,
        };
        let mut displaced = vec![0.0; set.len()];
        let operator = |v: &[f64], out: &mut [f64]| {
            layered.displacement_on(&set, v, &mut displaced);
            preconditioner.apply(&mut layered, &set, &displaced, out);
        };
        let report = gmres(operator, &mut correction, limits, self.interrupt);
        change.iter_mut().zip(&correction).for_each(|(a, b)| *a += b);
        self.complete(now, &set, &compliance, &change, report.iterations)
    }

    /// Without a contact point: an approach until the one nearest to touch carries the load.
    fn touch(&self, now: &Evaluation) -> Step {
        let n = self.heights.len();
        let load = self.mean_pressure * n as f64;
        let c = self.coordinate_compliance() + self.softening;
        let nearest = now.state.line.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let approach = c * load + self.law.indentation(load) - nearest;
        Step { line: vec![approach; n], approach, krylov_iterations: 0 }
    }

    /// The step everywhere from the change of pressure on the set.
    fn complete(
        &mut self,
        now: &Evaluation,
        set: &[u32],
        compliance: &[f64],
        change: &[f64],
        krylov_iterations: usize,
    ) -> Step {
        let n = self.heights.len();
        let mut everywhere = vec![0.0; n];
        set.iter().zip(change).for_each(|(i, dp)| everywhere[*i as usize] = *dp);
        let mut displacement = vec![0.0; n];
        self.space.displacement(&everywhere, &mut displacement);
        let approach = set
            .iter()
            .zip(compliance.iter().zip(change))
            .map(|(i, (k, dp))| now.defect[*i as usize] + displacement[*i as usize] + k * dp)
            .sum::<f64>()
            / set.len() as f64;
        let mut line: Vec<f64> =
            (0..n).map(|i| approach - now.defect[i] - displacement[i]).collect();
        let c = self.coordinate_compliance();
        for (i, (k, dp)) in set.iter().zip(compliance.iter().zip(change)) {
            line[*i as usize] = (c + k) * dp;
        }
        Step { line, approach, krylov_iterations }
    }
}

/// Points in contact.
fn contact_set(line: &[f64]) -> Vec<u32> {
    (0..line.len() as u32).filter(|i| line[*i as usize] > 0.0).collect()
}

/// Scale of violated gaps: that of the hard contact, but not below 1e-4 of the largest indentation
/// nor of the displacement `under_mean` that the mean pressure would make as the longest wave. On
/// a profile flatter than that the round-off of pressures and indentations counts.
pub(super) fn violation_scale(
    displacement: &[f64],
    heights: &[f64],
    indentation: &[f64],
    under_mean: f64,
) -> f64 {
    let largest = indentation.iter().copied().fold(under_mean, f64::max);
    // A flat profile has no scale of its own.
    let flat = heights.iter().all(|z| *z == 0.0);
    let of_heights = if flat { 0.0 } else { displacement_scale(displacement, heights) };
    of_heights.max(1e-4 * largest)
}
