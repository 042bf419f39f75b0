//! What the stiffening of a law adds to the linearised law of a point.
//!
//! ```text
//! δT = Σ_k μ_k Φ''_k K_k (K_k : δm - M_k : δm_k)
//! ```
//!
//! with the [`Hardening`] of each spring. Kept for laws that stiffen alone; neo-Hooke needs neither space nor time for it.

use super::lanes::{Lanes, lane, set_lane};
use crate::rubber::finite_strain::{Hardening, Scalar, contract};

/// `Σ_k μ_k Φ''_k K_k ⊗ K_k` at a point in xx·xx, zz·zz, xz·xz, xx·zz, xx·xz, zz·xz.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Own<T = f64>([T; 6]);

impl Own {
    /// Adds the part of a spring with the shear modulus `shear` in Pa.
    #[inline]
    pub fn add(&mut self, shear: f64, hardening: &Hardening) {
        let k = &hardening.by_strain;
        let factor = shear * hardening.curvature;
        let products =
            [k[0] * k[0], k[1] * k[1], k[2] * k[2], k[0] * k[1], k[0] * k[2], k[1] * k[2]];
        self.0.iter_mut().zip(products).for_each(|(sum, product)| *sum += factor * product);
    }
}

impl<T: Scalar> Own<T> {
    /// Change of the stress with the measure at the point if no branch relaxed.
    #[inline]
    pub fn stress(&self, measure: &[T; 3]) -> [T; 3] {
        let [xx, zz, xz, xx_zz, xx_xz, zz_xz] = self.0;
        let [x, z, half] = *measure;
        // The component xz occurs twice in a contraction.
        let both = half + half;
        [
            xx * x + xx_zz * z + xx_xz * both,
            xx_zz * x + zz * z + zz_xz * both,
            xx_xz * x + zz_xz * z + xz * both,
        ]
    }
}

/// The part of a branch at a point.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Relief<T = f64> {
    /// `|μ_k| Φ''_k K_k`: the sign of a negative modulus is that of the history.
    stress: [T; 3],
    /// `M_k`.
    by: [T; 3],
}

impl Relief {
    /// Of a branch with the shear modulus `shear` in Pa.
    #[inline]
    pub fn new(shear: f64, hardening: &Hardening) -> Self {
        let factor = shear.abs() * hardening.curvature;
        Self { stress: hardening.by_strain.map(|k| factor * k), by: hardening.by_internal }
    }
}

impl<T: Scalar> Relief<T> {
    /// The stress that a change of the internal measure takes away.
    #[inline]
    pub fn of(&self, change: &[T; 3]) -> [T; 3] {
        let growth = contract(&self.by, change);
        self.stress.map(|s| s * growth)
    }
}

/// Both parts at all points of a row of one kind; empty for a law that does not stiffen.
#[derive(Debug, Clone, Default)]
pub(super) struct Hardened<T> {
    /// One a column.
    own: Vec<Own<T>>,
    /// One branch after another, columns first.
    relief: Vec<Relief<T>>,
}

impl<T: Lanes> Hardened<T> {
    pub fn new(columns: usize, branches: usize) -> Self {
        Self {
            own: vec![Own::default(); columns],
            relief: vec![Relief::default(); columns * branches],
        }
    }

    /// The part of a point itself.
    #[inline]
    pub fn own(&self, column: usize) -> Option<&Own<T>> {
        self.own.get(column)
    }

    /// The parts of a branch at all columns.
    pub fn branch(&self, branch: usize) -> &[Relief<T>] {
        let columns = self.own.len();
        &self.relief[branch * columns..(branch + 1) * columns]
    }

    pub fn own_lane(&self, column: usize, at: usize) -> Option<Own> {
        self.own.get(column).map(|own| Own(lane(&own.0, at)))
    }

    pub fn relief_lane(&self, [branch, column]: [usize; 2], at: usize) -> Option<Relief> {
        let relief = self.branch(branch).get(column)?;
        Some(Relief { stress: lane(&relief.stress, at), by: lane(&relief.by, at) })
    }

    pub fn set_own(&mut self, column: usize, at: usize, own: &Own) {
        set_lane(&mut self.own[column].0, at, &own.0);
    }

    pub fn set_relief(&mut self, [branch, column]: [usize; 2], at: usize, relief: &Relief) {
        let to = &mut self.relief[branch * self.own.len() + column];
        set_lane(&mut to.stress, at, &relief.stress);
        set_lane(&mut to.by, at, &relief.by);
    }
}
