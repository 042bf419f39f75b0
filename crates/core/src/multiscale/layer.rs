//! The half-space under the tangent compliance of a local law, for the linear solves.

use crate::contact::half_space::HalfSpace;
use crate::contact::preconditioner::SetOperator;

/// Displacement of the half-space plus `K_i p_i` on the points of a contact set.
///
/// Its inverse within a patch is a filter by `1 / (C(q) + K)`. Where `K` varies from point to
/// point, that filter is blended from a few with fixed `K`: exact for a uniform layer, and good
/// where the layer varies slowly against the waves at which the two terms are equal.
pub(super) struct LayeredSpace<'a> {
    pub space: &'a mut HalfSpace,
    /// Tangent compliance of the law at the points of the set in m/Pa.
    compliance: &'a [f64],
    levels: Vec<f64>,
    /// Level below and share of the one above it, for each point of the set.
    blend: Vec<(usize, f64)>,
}

/// Levels of a blend, and the ratio of neighbouring ones as long as these suffice.
const MOST_LEVELS: usize = 6;
const RATIO: f64 = 6.0;
/// Compliances that differ by less, relative, count as equal: on equal peaks the difference is round-off, and two
/// levels that differ by it have no blend.
const UNIFORM: f64 = 1e-9;

impl<'a> LayeredSpace<'a> {
    /// Operator for the compliances at the points of a nonempty set.
    pub fn new(space: &'a mut HalfSpace, compliance: &'a [f64]) -> Self {
        // A layer much less compliant than the shortest wave of the grid has no effect on any wave.
        let shortest = space.compliance_range().1;
        let total = |k: &f64| k + shortest;
        let smallest = compliance.iter().map(total).fold(f64::INFINITY, f64::min);
        let largest = compliance.iter().map(total).fold(0.0_f64, f64::max);
        let spread = (largest / smallest).max(1.0);
        let steps = if spread - 1.0 > UNIFORM {
            (spread.ln() / RATIO.ln()).ceil().min((MOST_LEVELS - 1) as f64)
        } else {
            0.0
        };
        let ratio = if steps > 0.0 { spread.powf(1.0 / steps) } else { 1.0 };
        let totals: Vec<f64> =
            (0..=steps as usize).map(|l| smallest * ratio.powi(l as i32)).collect();
        let blend = compliance.iter().map(total).map(|k| blend(&totals, ratio, k)).collect();
        let levels = totals.iter().map(|k| (k - shortest).max(0.0)).collect();
        Self { space, compliance, levels, blend }
    }
}

/// Weights with which the inverses of two neighbouring totals make that of `total`.
fn blend(totals: &[f64], ratio: f64, total: f64) -> (usize, f64) {
    if totals.len() == 1 {
        return (0, 0.0);
    }
    let position = ((total / totals[0]).ln() / ratio.ln()).max(0.0) as usize;
    let lower = position.min(totals.len() - 2);
    let (a, b) = (1.0 / totals[lower], 1.0 / totals[lower + 1]);
    (lower, ((a - 1.0 / total) / (a - b)).clamp(0.0, 1.0))
}

impl SetOperator for LayeredSpace<'_> {
    fn points(&self) -> usize {
        self.space.points()
    }

    fn displacement_on(&mut self, set: &[u32], pressure: &[f64], out: &mut [f64]) {
        self.space.displacement_on(set, pressure, out);
        for ((w, k), t) in out.iter_mut().zip(self.compliance).zip(pressure) {
            *w += k * t;
        }
    }

    fn pressure_on(&mut self, set: &[u32], displacement: &[f64], out: &mut [f64]) {
        self.space.layered_pressure_on(set, displacement, &self.levels, &self.blend, out);
    }

    fn punch_on(&mut self, set: &[u32], out: &mut [f64]) {
        self.pressure_on(set, &vec![1.0; set.len()], out);
    }
}
