//! The linear system on a contact set.

use super::half_space::{ArealHalfSpace, mean};
use crate::numerics::Interrupt;
use crate::numerics::krylov::{KrylovLimits, euclidean_norm, gmres};

/// Most directions kept between two restarts.
const MOST_DIRECTIONS: usize = 60;
/// Numbers that they take at most: so many, or [`KEPT_PER_POINT`] a grid point if that is more.
const MOST_KEPT: usize = 100_000_000;
/// Numbers a grid point that the directions may take, on grids of any size.
pub(super) const KEPT_PER_POINT: usize = 10;
/// Restarts of one solve; what is left is for the next active-set iteration.
const MOST_RESTARTS: usize = 6;

/// Solves `w + ubar = z` on the set for pressures with a given sum.
///
/// With pressures whose sum is zero and displacements up to a constant the mean separation is no unknown: the operator
/// is `P A M'` with `P` the subtraction of the mean and `M' v = M v - s sum(M v)`, where `M` is the inverse filter
/// restricted to the set and `s` the pressure of a flat punch, `M 1`, with unit sum. This is the solution of the
/// bordered system `[A 1; 1^T 0]` with `M` for the inverse of `A`.
pub(super) struct SetSystem<'a> {
    pub space: &'a mut ArealHalfSpace,
    pub set: &'a [u32],
    pub heights: &'a [f64],
    pub interrupt: &'a Interrupt,
}

impl SetSystem<'_> {
    /// Improves the pressures `t` on the set until the root mean square of the gaps on it is at most `tolerance`, in m;
    /// `load` is the sum of the pressures. Returns the pairs of transforms.
    pub fn solve(&mut self, t: &mut [f64], load: f64, tolerance: f64) -> usize {
        let m = t.len();
        let punch = self.punch();
        let missing = load - t.iter().sum::<f64>();
        t.iter_mut().zip(&punch).for_each(|(t, s)| *t += missing * s);
        let grid: usize = self.space.points().iter().product();
        let limits = KrylovLimits {
            tolerance: tolerance * (m as f64).sqrt(),
            max_iterations: directions(grid, m),
        };
        let mut pairs = 1;
        for _ in 0..MOST_RESTARTS {
            let mut gap = self.gap(t);
            pairs += 1;
            let before = euclidean_norm(&gap);
            if before <= limits.tolerance || self.interrupt.is_set() {
                break;
            }
            let mut pressure = vec![0.0; m];
            let (space, set, interrupt) = (&mut *self.space, self.set, self.interrupt);
            let operator = |v: &[f64], out: &mut [f64]| {
                precondition(space, set, &punch, v, &mut pressure);
                space.displacement_on(set, &pressure, out);
                subtract_mean(out);
            };
            let report = gmres(operator, &mut gap, limits, interrupt);
            precondition(space, set, &punch, &gap, &mut pressure);
            t.iter_mut().zip(&pressure).for_each(|(t, dt)| *t += dt);
            pairs += 2 * report.iterations + 1;
            if report.residual_norm <= limits.tolerance {
                break;
            }
        }
        pairs
    }

    /// Heights less displacements on the set, about their mean.
    fn gap(&mut self, t: &[f64]) -> Vec<f64> {
        let mut gap = vec![0.0; t.len()];
        self.space.displacement_on(self.set, t, &mut gap);
        for (g, i) in gap.iter_mut().zip(self.set) {
            *g = self.heights[*i as usize] - *g;
        }
        subtract_mean(&mut gap);
        gap
    }

    /// Pressures with unit sum of about a flat punch on the set.
    fn punch(&mut self) -> Vec<f64> {
        let m = self.set.len();
        let mut punch = vec![0.0; m];
        self.space.pressure_on(self.set, &vec![1.0; m], &mut punch);
        // That of a lossy body may have both signs and next to no sum.
        punch.iter_mut().for_each(|s| *s = s.max(0.0));
        let sum: f64 = punch.iter().sum();
        if sum > 0.0 {
            punch.iter_mut().for_each(|s| *s /= sum);
        } else {
            punch.fill(1.0 / m as f64);
        }
        punch
    }
}

/// Directions kept for a set of `m` points.
fn directions(grid: usize, m: usize) -> usize {
    (kept(grid) / m).clamp(1, MOST_DIRECTIONS)
}

/// Numbers that directions may take on a grid.
pub(super) fn kept(grid: usize) -> usize {
    MOST_KEPT.min(MOST_DIRECTIONS.saturating_mul(grid)).max(KEPT_PER_POINT.saturating_mul(grid))
}

/// Pressures with sum zero for displacements on the set.
fn precondition(
    space: &mut ArealHalfSpace,
    set: &[u32],
    punch: &[f64],
    displacement: &[f64],
    pressure: &mut [f64],
) {
    space.pressure_on(set, displacement, pressure);
    let sum: f64 = pressure.iter().sum();
    pressure.iter_mut().zip(punch).for_each(|(t, s)| *t -= sum * s);
}

fn subtract_mean(values: &mut [f64]) {
    let mean = mean(values);
    values.iter_mut().for_each(|x| *x -= mean);
}
