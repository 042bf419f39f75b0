//! Approximate inverse of the half-space operator on a contact set.

use super::half_space::HalfSpace;
use super::hierarchical::{Compressed, Factors};
use super::influence::Influence;
use super::patches::Patches;

/// What compression may leave out of the forces between patches, relative: much less than what point forces do.
const TOLERANCE: f64 = 1e-4;

/// What the preconditioner needs of an operator from pressures to displacements on a set.
pub(crate) trait SetOperator {
    /// Number of grid points.
    fn points(&self) -> usize;
    /// Displacements on the set under pressures on it.
    fn displacement_on(&mut self, set: &[u32], pressure: &[f64], out: &mut [f64]);
    /// Pressures that make the displacements, by an inverse that is good within a patch.
    fn pressure_on(&mut self, set: &[u32], displacement: &[f64], out: &mut [f64]);
    /// Pressures under a flat punch on the set, to any scale.
    fn punch_on(&mut self, set: &[u32], out: &mut [f64]);
}

impl SetOperator for HalfSpace {
    fn points(&self) -> usize {
        self.points()
    }

    fn displacement_on(&mut self, set: &[u32], pressure: &[f64], out: &mut [f64]) {
        self.displacement_on(set, pressure, out);
    }

    fn pressure_on(&mut self, set: &[u32], displacement: &[f64], out: &mut [f64]) {
        self.pressure_on(set, displacement, out);
    }

    fn punch_on(&mut self, set: &[u32], out: &mut [f64]) {
        // Without a gap the pressures of a uniform displacement are round-off.
        if set.len() == self.points() {
            out.fill(1.0);
        } else {
            self.pressure_on(set, &vec![1.0; set.len()], out);
        }
    }
}

/// Approximates the pressures on the contact set that give a displacement there at unchanged
/// load: the solution of `[A e; e^T 0] [t; ubar] = [r; 0]` with `A` the half-space operator
/// restricted to the set.
///
/// Two parts. Within a patch the restriction of the inverse operator (a filter by `|q| E_r / 2`) is close to the
/// inverse of the restriction. Between patches it is not, since it keeps the free surface between them at rest: there
/// the displacement of each patch is reduced to one number, and the forces between patches come from a
/// system of the size of their number in which patches act on each other as point forces; compressed, it is factorised
/// for thousands of them in less time than a transform of the grids on which so many occur.
pub(crate) struct Preconditioner {
    patches: Patches,
    /// Pressure under a flat punch on each patch, with unit sum.
    shape: Vec<f64>,
    coarse: Option<Coarse>,
}

struct Coarse {
    factors: Factors,
    scale: f64,
    /// Forces with unit sum that displace all patches alike.
    uniform: Vec<f64>,
}

impl Preconditioner {
    /// Preconditioner for a nonempty contact set; `kernel` is the displacement by a unit pressure
    /// at point 0.
    pub fn new(space: &mut impl SetOperator, kernel: &[f64], set: &[u32]) -> Self {
        let points = space.points();
        let patches = Patches::new(set, points);
        let mut shape = vec![0.0; set.len()];
        space.punch_on(set, &mut shape);
        // The gaps make the edges of a patch stiff, so the sum is positive. Where loss makes one edge weak it may not be:
        // then the pressure is uniform.
        let sums = patches.sums(shape.iter().copied());
        let counts = patches.sums(std::iter::repeat_n(1.0, set.len()));
        for (s, id) in shape.iter_mut().zip(&patches.of_point) {
            let id = *id as usize;
            *s = if sums[id] > 0.0 { *s / sums[id] } else { 1.0 / counts[id] };
        }
        let coarse = (patches.count > 1).then(|| Coarse::new(space, kernel, set, &patches, &shape));
        Self { patches, shape, coarse }
    }

    /// Spreads `force` (a sum over grid points) over the set, each patch in proportion to its
    /// present load.
    pub fn add_force(&self, force: f64, pressure: &mut [f64]) {
        let loads = self.patches.sums(pressure.iter().map(|t| t.max(0.0)));
        let total: f64 = loads.iter().sum();
        for ((t, s), id) in pressure.iter_mut().zip(&self.shape).zip(&self.patches.of_point) {
            let share = if total > 0.0 {
                loads[*id as usize] / total
            } else {
                1.0 / self.patches.count as f64
            };
            *t += force * share * s;
        }
    }

    /// Pressures (sum zero) for the displacements `r` on the set.
    pub fn apply(
        &self,
        space: &mut impl SetOperator,
        set: &[u32],
        r: &[f64],
        pressure: &mut [f64],
    ) {
        let means = self.patches.sums(r.iter().zip(&self.shape).map(|(r, s)| r * s));
        let local: Vec<f64> =
            r.iter().zip(&self.patches.of_point).map(|(r, id)| r - means[*id as usize]).collect();
        space.pressure_on(set, &local, pressure);
        let mut forces = self.patches.sums(pressure.iter().copied());
        let between = match &self.coarse {
            Some(coarse) => coarse.solve(&means),
            None => vec![0.0; self.patches.count],
        };
        for (f, b) in forces.iter_mut().zip(&between) {
            *f = b - *f;
        }
        for ((t, s), id) in pressure.iter_mut().zip(&self.shape).zip(&self.patches.of_point) {
            *t += s * forces[*id as usize];
        }
        // A pressure that makes a uniform displacement is invisible to this inverse. A Krylov method could reach it
        // through round-off in the sum alone, so that is subtracted.
        let mean = pressure.iter().sum::<f64>() / pressure.len() as f64;
        pressure.iter_mut().for_each(|t| *t -= mean);
    }
}

impl Coarse {
    fn new(
        space: &mut impl SetOperator,
        kernel: &[f64],
        set: &[u32],
        patches: &Patches,
        shape: &[f64],
    ) -> Self {
        let (points, count) = (space.points(), patches.count);
        let centres = patches.centres(set, points, shape);
        let mut displaced = vec![0.0; set.len()];
        space.displacement_on(set, shape, &mut displaced);
        let row_sums = patches.sums(displaced.iter().zip(shape).map(|(w, s)| w * s));
        let influence = Influence::new(kernel);
        let place = |x: &f64| (x.round() as i64).rem_euclid(points as i64) as u32;
        let places: Vec<u32> = centres.iter().map(place).collect();
        let entry = |j: usize, k: usize| influence.at(places[j], places[k]);
        let between = Compressed::new(0..count, TOLERANCE, &entry);
        // One application to all shapes at once gives the row sums; what the other patches
        // do not explain is the patch's own compliance.
        let scale = influence.softness;
        let all = row_sums.iter().map(|sum| sum / scale + influence.mean * count as f64);
        let own: Vec<f64> = all.zip(between.row_sums()).map(|(all, others)| all - others).collect();
        let factors = between.factorise(&own);
        let mut uniform = vec![1.0; count];
        factors.solve_one_in_place(&mut uniform);
        let total: f64 = uniform.iter().sum();
        uniform.iter_mut().for_each(|f| *f /= total);
        Self { factors, scale, uniform }
    }

    /// Forces on the patches (sum zero) for their mean displacements.
    fn solve(&self, means: &[f64]) -> Vec<f64> {
        // What displaces all patches alike needs no forces of sum zero; left in, it would only cost digits.
        let common = means.iter().sum::<f64>() / means.len() as f64;
        let mut forces: Vec<f64> = means.iter().map(|m| (m - common) / self.scale).collect();
        self.factors.solve_one_in_place(&mut forces);
        let total: f64 = forces.iter().sum();
        forces.iter_mut().zip(&self.uniform).for_each(|(f, u)| *f -= total * u);
        forces
    }
}
