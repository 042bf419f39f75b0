//! The tangent of an element with a short relaxation history: what the preconditioner factorises.
//!
//! The internal measure of a branch depends on all points upstream. The local tangent lets it depend
//! on the measures of its own point and of the one before, `δm_k = w δm_n + w' δm_{n-1}`, with the two
//! real weights that give the complex response `R` of the flow rule at one wavenumber a row, `θ` an
//! element:
//!
//! ```text
//! w' = -Im R / sin θ,   w = Re R - w' cos θ
//! ```
//!
//! So every row has its storage and its loss modulus; a symmetric matrix could carry the first alone.
//! The wavelength is that of the row's distance from the contact, to which the others have decayed.

use super::super::kinematics::Tensor;
use super::super::mesh::{CENTRE, POINTS};
use super::flow::Weights;
use super::point::History;
use super::row::{Material, Row, before};
use super::tangent::stress_change;
use crate::rubber::finite_strain::Symmetric;

/// Largest angle a wave advances in an element: the cubic of the flow rule does not resolve shorter waves.
const LARGEST_ANGLE: f64 = 0.9;

/// Rows: `(x, z)` of the four corners of an element. Columns: the same, then those of the two left
/// corners of the element before.
pub(super) type Local = [[f64; 12]; 8];

/// Changes by the displacements of the corners, at one point.
struct Unit {
    gradient: [Tensor; 8],
    deformation: [Tensor; 8],
    strain: [Symmetric; 8],
    measure: [Symmetric; 8],
}

/// Column of a corner of the element before.
const UPSTREAM: [usize; 4] = [8, 0, 10, 4];

impl Row {
    /// The local tangents of all elements, for a row whose middle is `depth` in m above the contact.
    pub fn local(&self, material: &Material, depth: f64, column: usize) -> Local {
        let angle = LARGEST_ANGLE.min(self.width / depth);
        let mut local = [[0.0; 12]; 8];
        for kind in 0..POINTS {
            let (own, upstream) = self.followed(material, kind, column, angle);
            let unit = self.unit(kind, column);
            self.add_own(&mut local, kind, column, &unit, &own);
            let unit = self.unit(kind, before(column, self.columns));
            self.add_upstream(&mut local, kind, column, &unit, &upstream);
        }
        local
    }

    fn unit(&self, kind: usize, column: usize) -> Unit {
        let index = kind * self.columns + column;
        let (point, conversion) = (self.point(kind, column), self.conversions.get(index));
        let mut unit = Unit {
            gradient: [[0.0; 4]; 8],
            deformation: [[0.0; 4]; 8],
            strain: [[0.0; 3]; 8],
            measure: [[0.0; 3]; 8],
        };
        for (corner, shape) in self.element.gradients[kind].iter().enumerate() {
            for direction in 0..2 {
                let at = 2 * corner + direction;
                unit.gradient[at][2 * direction..2 * direction + 2].copy_from_slice(shape);
                unit.deformation[at] = point.deformation_change(&unit.gradient[at]);
                unit.strain[at] = point.strain_change(&unit.deformation[at]);
                unit.measure[at] = conversion
                    .map_or(unit.strain[at], |with| with.measure.derivative(&unit.strain[at]));
            }
        }
        unit
    }

    /// Changes of the conjugate stress by the measure of the point and by that of the one before, in
    /// rows of three.
    fn followed(
        &self,
        material: &Material,
        kind: usize,
        column: usize,
        angle: f64,
    ) -> ([Symmetric; 3], [Symmetric; 3]) {
        let volumetric = kind == CENTRE;
        let point = self.point(kind, column);
        let branches = material.relaxations.len();
        let units = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut own = units.map(|unit| point.own_stress(volumetric, &unit));
        if let Some(hardened) = self.own(kind, column) {
            for (own, unit) in own.iter_mut().zip(&units) {
                let more = hardened.stress(unit);
                (0..3).for_each(|i| own[i] += more[i]);
            }
        }
        let mut upstream = [[0.0; 3]; 3];
        for k in 0..branches {
            let history = self.history(kind, [k, column]);
            let (here, there) = shares(&history, angle);
            let hardened = self.relief(kind, [k, column]);
            for (unit, (own, upstream)) in units.iter().zip(own.iter_mut().zip(&mut upstream)) {
                let mut relief = history.relief(volumetric, &point, unit);
                if let Some(more) = hardened.map(|hardened| hardened.of(unit)) {
                    (0..3).for_each(|i| relief[i] += more[i]);
                }
                for i in 0..3 {
                    own[i] -= here * relief[i];
                    upstream[i] -= there * relief[i];
                }
            }
        }
        (own, upstream)
    }

    fn add_own(
        &self,
        local: &mut Local,
        kind: usize,
        column: usize,
        unit: &Unit,
        law: &[Symmetric; 3],
    ) {
        let (index, point) = (kind * self.columns + column, self.point(kind, column));
        for at in 0..8 {
            let conjugate = apply(law, &unit.measure[at]);
            let stress = match self.conversions.get(index) {
                Some(conversion) => conversion.stress_change(&conjugate, &unit.strain[at]),
                None => conjugate,
            };
            let total = stress_change(&point, &unit.deformation[at], &stress, &unit.gradient[at]);
            self.add(local, kind, at, &total);
        }
    }

    fn add_upstream(
        &self,
        local: &mut Local,
        kind: usize,
        column: usize,
        unit: &Unit,
        law: &[Symmetric; 3],
    ) {
        let (index, point) = (kind * self.columns + column, self.point(kind, column));
        for at in 0..8 {
            let conjugate = apply(law, &unit.measure[at]);
            let stress = match self.conversions.get(index) {
                Some(conversion) => conversion.measure.derivative(&conjugate),
                None => conjugate,
            };
            let total = stress_change(&point, &[0.0; 4], &stress, &[0.0; 4]);
            self.add(local, kind, UPSTREAM[at / 2] + at % 2, &total);
        }
    }

    fn add(&self, local: &mut Local, kind: usize, at: usize, stress: &Tensor) {
        let weight = self.element.weights[kind];
        for (corner, [along, up]) in self.element.gradients[kind].iter().enumerate() {
            local[2 * corner][at] += weight * (stress[0] * along + stress[1] * up);
            local[2 * corner + 1][at] += weight * (stress[2] * along + stress[3] * up);
        }
    }
}

#[inline]
fn apply(law: &[Symmetric; 3], measure: &Symmetric) -> Symmetric {
    [0, 1, 2].map(|i| (0..3).map(|unit| law[unit][i] * measure[unit]).sum())
}

/// Weights of the measure at the point and at the point before in the internal measure of a branch.
fn shares(history: &History, angle: f64) -> (f64, f64) {
    let weights = Weights { decay: 1.0 - history.relaxed, of: history.weights };
    let response = weights.response(angle);
    let upstream = -response.im / angle.sin();
    (response.re - upstream * angle.cos(), upstream)
}
