//! Change of the forces of a row by that of its displacements.

use super::super::kinematics::Tensor;
use super::super::mesh::{CENTRE, POINTS};
use super::flow::{Relaxation, window};
use super::point::{Memory, Point, wide};
use super::row::{Differences, Material, Row, nodal, scatter};
use crate::rubber::finite_strain::Symmetric;

/// Changes at a kind of points.
struct Changes {
    gradients: Vec<Tensor>,
    deformations: Vec<Tensor>,
    strains: Vec<Symmetric>,
    measures: Vec<Symmetric>,
    /// Of the distances of the labels.
    spacings: Vec<f64>,
    stresses: Vec<Symmetric>,
}

impl Row {
    /// Change of the forces at the corners for a change of the displacements.
    pub fn tangent(&self, material: &Material, differences: &Differences) -> [Vec<f64>; 2] {
        let mut forces = [vec![0.0; 2 * self.columns], vec![0.0; 2 * self.columns]];
        let branches = material.relaxations.len();
        for kind in 0..POINTS {
            let points = &self.points[kind * self.columns..(kind + 1) * self.columns];
            let mut changes = self.changes(differences, kind);
            for (k, relaxation) in material.relaxations.iter().enumerate() {
                let start = (kind * branches + k) * self.columns;
                let memory = &self.memory[start..start + self.columns];
                relax(relaxation, memory, points, kind == CENTRE, &mut changes);
            }
            for (column, point) in points.iter().enumerate() {
                let conjugate = &changes.stresses[column];
                let stress = match self.conversions.get(kind * self.columns + column) {
                    Some(conversion) => {
                        conversion.stress_change(conjugate, &changes.strains[column])
                    }
                    None => *conjugate,
                };
                let (df, gradient) = (&changes.deformations[column], &changes.gradients[column]);
                let total = stress_change(point, df, &stress, gradient);
                scatter(&self.element, kind, column, &total, &mut forces);
            }
        }
        forces
    }

    /// Changes of deformation and measure, and of the stresses if no branch followed.
    fn changes(&self, differences: &Differences, kind: usize) -> Changes {
        let count = self.columns;
        let mut changes = Changes {
            gradients: Vec::with_capacity(count),
            deformations: Vec::with_capacity(count),
            strains: Vec::with_capacity(count),
            measures: Vec::with_capacity(count),
            spacings: self.shifts(differences, kind).map(|shift| -shift).collect(),
            stresses: Vec::with_capacity(count),
        };
        for column in 0..count {
            let point = &self.points[kind * count + column];
            let gradient = self.displacement_gradient(differences, kind, column);
            let df = point.deformation_change(&gradient);
            let strain = point.strain_change(&df);
            let measure = match self.conversions.get(kind * count + column) {
                Some(conversion) => conversion.measure.derivative(&strain),
                None => strain,
            };
            changes.stresses.push(point.own_stress(kind == CENTRE, &measure));
            changes.gradients.push(gradient);
            changes.deformations.push(df);
            changes.strains.push(strain);
            changes.measures.push(measure);
        }
        changes
    }
}

/// Adds what a branch changes of the stresses.
fn relax(
    relaxation: &Relaxation,
    memory: &[Memory],
    points: &[Point],
    volumetric: bool,
    changes: &mut Changes,
) {
    let count = memory.len();
    let step = |state: &Symmetric, column: usize| -> Symmetric {
        let memory = &memory[column];
        let weights = wide(&memory.weights);
        let measures = window(&changes.measures, column);
        let (forgotten, spacing) = (f64::from(memory.forgotten), changes.spacings[column]);
        [0, 1, 2].map(|i| {
            let of: f64 = (0..4).map(|k| weights[k] * measures[k][i]).sum();
            state[i] - forgotten * state[i] + of + f64::from(memory.source[i]) * spacing
        })
    };
    let mut state = [0.0; 3];
    let start = start(memory);
    for column in start..count {
        state = step(&state, column);
    }
    if start == 0 {
        let whole = relaxation.whole_period();
        state = state.map(|y| y / whole);
    }
    for column in 0..count {
        state = step(&state, column);
        let part = memory[column].stress(volumetric, &points[column], &state);
        (0..3).for_each(|i| changes.stresses[column][i] += part[i]);
    }
}

/// What is left of a change is below the accuracy of a direction from here on.
const FORGOTTEN: f64 = 1e-9;

/// First point of a sweep that ends at the last one with what the row has put into it.
fn start(memory: &[Memory]) -> usize {
    let mut left = 1.0;
    let start = memory.iter().rposition(|memory| {
        left *= 1.0 - f64::from(memory.forgotten);
        left < FORGOTTEN
    });
    start.unwrap_or(0)
}

/// Change of what [`nodal`] returns, by those of the deformation gradient, of the stress and of the
/// gradient of the displacements.
#[inline]
pub(super) fn stress_change(
    point: &Point,
    df: &Tensor,
    stress: &Symmetric,
    gradient: &Tensor,
) -> Tensor {
    let geometric = Point::first_stress(df, &point.stress);
    let elastic = Point::first_stress(&point.deformation, stress);
    let change = [0, 1, 2, 3].map(|i| geometric[i] + elastic[i]);
    let total = Point::first_stress(&point.deformation, &point.stress);
    let [q_s, q_z, ..] = *gradient;
    let mut nodal = nodal(&change, &point.label);
    nodal[0] += q_z * total[1];
    nodal[1] -= q_s * total[1];
    nodal[2] += q_z * total[3];
    nodal[3] -= q_s * total[3];
    nodal
}
