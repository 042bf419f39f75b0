//! Contact with one smooth variable a node.
//!
//! Force λ and gap g of a node follow from one unknown τ,
//!
//! ```text
//! λ = c (r + τ) / 2,   g = (r - τ) / 2,   r = sqrt(τ² + 4 ε / c),   so that   λ g = ε
//! ```
//!
//! with a stiffness c and a barrier ε. Both are positive for every τ, so no step has to be shortened to keep them
//! positive, and `ε = 0` is the exact law: contact where τ is positive, with the force `c τ`, and the gap `-τ`
//! elsewhere.

use crate::interface::LocalFriction;
use crate::multiscale::LocalLaw;

/// Pressure in Pa below which the compliance of a layer, which may be infinite without pressure, is that there.
const LEAST_PRESSURE: f64 = 1e-3;

/// Forces and gaps of the contact nodes, with their derivatives by τ.
#[derive(Debug, Clone, Default)]
pub(super) struct Pairs {
    /// λ in N/m.
    pub forces: Vec<f64>,
    /// g in m.
    pub gaps: Vec<f64>,
    pub force_slopes: Vec<f64>,
    pub gap_slopes: Vec<f64>,
    /// Heights in m of a layer between profile and rubber: its separation g(p), none without one. The slopes of the gaps
    /// by τ are those of gap and layer together.
    pub layer: Vec<f64>,
    /// Shear forces in N/m, along the profile and per length along x, and their derivatives by λ.
    pub shears: Vec<f64>,
    pub shear_slopes: Vec<f64>,
}

impl Pairs {
    /// Forces and gaps at the unknowns τ in m, for a stiffness in Pa and `barrier` = ε in N.
    pub fn new(unknowns: &[f64], stiffness: f64, barrier: f64) -> Self {
        let product = barrier / stiffness;
        let mut pairs = Self::default();
        for tau in unknowns {
            let root = (tau * tau + 4.0 * product).sqrt();
            // The smaller of the two as a quotient, without cancellation.
            let larger = 0.5 * (root + tau.abs());
            let smaller = if larger > 0.0 { product / larger } else { 0.0 };
            let (force, gap) = if *tau > 0.0 { (larger, smaller) } else { (smaller, larger) };
            let closed = if root > 0.0 { force / root } else { 0.0 };
            pairs.forces.push(stiffness * force);
            pairs.gaps.push(gap);
            pairs.force_slopes.push(stiffness * closed);
            pairs.gap_slopes.push(closed - 1.0);
        }
        pairs
    }

    /// With the shear of an interface on nodes that are `spacing` in m apart along x.
    ///
    /// A piece ds of the surface with the slope h' carries `p ds n = (-h', 1) λ` across and, against the motion,
    /// `-τ(p) ds t = -(1, h') τ(p) dx` along it: p is λ over the length along x.
    pub fn sheared(mut self, law: &LocalFriction, spacing: f64) -> Self {
        let tractions = self.forces.iter().map(|force| law.at(force / spacing));
        (self.shears, self.shear_slopes) =
            tractions.map(|traction| (traction.stress * spacing, traction.slope)).unzip();
        self
    }

    /// With a layer that is as high as the mean separation of short waves under the local pressure.
    pub fn on_layer(mut self, law: Option<&LocalLaw>, spacing: f64) -> Self {
        let Some(law) = law else {
            self.layer = vec![0.0; self.forces.len()];
            return self;
        };
        for j in 0..self.forces.len() {
            let pressure = self.forces[j] / spacing;
            self.layer.push(law.height(pressure));
            if self.force_slopes[j] > 0.0 {
                let compliance = law.compliance(pressure.max(LEAST_PRESSURE));
                self.gap_slopes[j] -= compliance * self.force_slopes[j] / spacing;
            }
        }
        self
    }

    /// Forces of the profile on node `j` in N/m at its slope h': against the motion, and upwards.
    pub fn on_node(&self, j: usize, slope: f64) -> [f64; 2] {
        let (force, shear) = (self.forces[j], self.shears[j]);
        [force * slope + shear, force - shear * slope]
    }

    /// Derivatives of [`Self::on_node`] by τ.
    pub fn on_node_slopes(&self, j: usize, slope: f64) -> [f64; 2] {
        let shear = self.shear_slopes[j];
        [slope + shear, 1.0 - shear * slope].map(|change| self.force_slopes[j] * change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn force_times_gap_is_the_barrier_and_slopes_are_derivatives() {
        let (stiffness, barrier) = (3.0, 1e-3);
        for tau in [-2.0, -1e-2, 0.0, 1e-3, 0.5, 1e3] {
            let step = 1e-6;
            let pairs = Pairs::new(&[tau, tau + step, tau - step], stiffness, barrier);
            assert_relative_eq!(pairs.forces[0] * pairs.gaps[0], barrier, max_relative = 1e-12);
            assert_relative_eq!(
                pairs.forces[0] / stiffness - pairs.gaps[0],
                tau,
                max_relative = 1e-12,
                epsilon = 1e-15
            );
            let slope = |values: &[f64]| (values[1] - values[2]) / (2.0 * step);
            assert_relative_eq!(pairs.force_slopes[0], slope(&pairs.forces), epsilon = 1e-6);
            assert_relative_eq!(pairs.gap_slopes[0], slope(&pairs.gaps), epsilon = 1e-6);
        }
    }

    #[test]
    fn without_a_barrier_either_force_or_gap_is_zero() {
        let pairs = Pairs::new(&[-0.5, 0.25, 0.0], 2.0, 0.0);
        assert_eq!(pairs.forces, [0.0, 0.5, 0.0]);
        assert_eq!(pairs.gaps, [0.5, 0.0, 0.0]);
        assert_eq!(pairs.gap_slopes, [-1.0, 0.0, -1.0]);
    }
}
