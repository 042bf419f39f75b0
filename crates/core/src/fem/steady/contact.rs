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

/// Forces and gaps of the contact nodes, with their derivatives by τ.
#[derive(Debug, Clone, Default)]
pub(super) struct Pairs {
    /// λ in N/m.
    pub forces: Vec<f64>,
    /// g in m.
    pub gaps: Vec<f64>,
    pub force_slopes: Vec<f64>,
    pub gap_slopes: Vec<f64>,
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
