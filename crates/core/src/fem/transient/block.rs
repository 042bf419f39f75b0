//! The block in time: strains, internal tensors, internal forces and their exact tangent.

use super::flow::{FlowRule, FlowStep};
use super::point::{Part, Response};
use crate::fem::kinematics::{Tensor, green_strain, nodal_strain_change};
use crate::fem::mesh::{CENTRE, Element, Mesh, POINTS};
use crate::rubber::finite_strain::{
    FiniteStrainRubber, Measure, Rheology, Spring, Symmetric, contract, difference, dilatation,
};
use rayon::prelude::*;

/// Stiffness of one element: by the displacements `(x, z)` of the nodes lower left, lower right,
/// upper left, upper right.
pub type Stiffness = [[f64; 8]; 8];

/// Forces in N/m on the nodes of one element and their derivative.
#[derive(Debug, Clone, Copy)]
pub struct Linearised {
    /// Internal forces, as [`Stiffness`] is ordered.
    pub forces: [f64; 8],
    /// Derivative of the forces by the displacements.
    pub stiffness: Stiffness,
}

/// An element is inverted, or an internal tensor is not positive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Inverted;

/// The rubber block with its relaxation history at the end of the last step.
#[derive(Debug, Clone)]
pub struct TransientBlock {
    mesh: Mesh,
    rubber: FiniteStrainRubber,
    elements: Vec<Element>,
    /// Strain in the measure of the law at each point of each element, elements row after row.
    strains: Vec<[Symmetric; POINTS]>,
    /// Internal tensors: branches of a point together, points of an element together.
    internal: Vec<Symmetric>,
}

/// Contribution of the relaxation history to the internal tensors at the end of a step.
#[derive(Debug, Clone)]
pub struct History {
    steps: Vec<FlowStep>,
    fractions: Vec<f64>,
    internal: Vec<Symmetric>,
}

impl TransientBlock {
    /// The undeformed, relaxed block.
    pub fn new(mesh: Mesh, rubber: FiniteStrainRubber) -> Self {
        let count = mesh.rows() * mesh.columns;
        let elements = (0..mesh.rows()).map(|row| mesh.element(row)).collect();
        let internal = vec![[0.0; 3]; count * POINTS * rubber.branches.len()];
        Self { mesh, rubber, elements, strains: vec![[[0.0; 3]; POINTS]; count], internal }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The relaxation history for a step in s from the last kept state.
    pub fn history(&self, rule: FlowRule, time_step: f64) -> History {
        let branches = &self.rubber.branches;
        let steps: Vec<FlowStep> =
            branches.iter().map(|branch| rule.step(time_step, branch.relaxation_time)).collect();
        let fractions = steps.iter().map(|step| step.strain).collect();
        let mut internal = Vec::with_capacity(self.internal.len());
        for (point, strain) in self.strains.iter().flatten().enumerate() {
            let first = point * branches.len();
            let old = &self.internal[first..first + branches.len()];
            internal.extend(steps.iter().zip(old).map(|(step, m_i)| step.history(m_i, strain)));
        }
        History { steps, fractions, internal }
    }

    /// Internal forces and stiffness of all elements, row after row, at `displacements` in m of
    /// the nodes: `(x, z)` of each node, row after row from the contact upwards.
    ///
    /// # Errors
    /// [`Inverted`].
    pub fn linearise(
        &self,
        history: &History,
        displacements: &[f64],
    ) -> Result<Vec<Linearised>, Inverted> {
        (0..self.strains.len())
            .into_par_iter()
            .with_min_len(self.mesh.columns)
            .map(|index| self.linearise_element(history, displacements, index))
            .collect()
    }

    fn linearise_element(
        &self,
        history: &History,
        displacements: &[f64],
        index: usize,
    ) -> Result<Linearised, Inverted> {
        let element = &self.elements[index / self.mesh.columns];
        let nodes = self.gather(displacements, index);
        let branches = history.steps.len();
        let mut sum = Linearised { forces: [0.0; 8], stiffness: [[0.0; 8]; 8] };
        for point in 0..POINTS {
            let gradients = &element.gradients[point];
            let (f, measure) = self.deformation(&nodes, gradients)?;
            let first = (index * POINTS + point) * branches;
            let past = &history.internal[first..first + branches];
            let response =
                Response::at(&self.rubber, part_of(point), &measure, past, &history.fractions)
                    .ok_or(Inverted)?;
            sum.add(&f, gradients, element.weights[point], &response);
        }
        Ok(sum)
    }

    /// The law of the rubber.
    pub fn rheology(&self) -> Rheology {
        self.rubber.rheology
    }

    /// Largest `I1 - 3` of a spring at the end of a step, where shear parts are integrated; NaN in an inverted element,
    /// `None` under a law without an end.
    pub fn largest_invariant(&self, history: &History, displacements: &[f64]) -> Option<f64> {
        if self.rubber.rheology.limit() == f64::INFINITY {
            return None;
        }
        let branches = history.steps.len();
        let mut largest = 0.0_f64;
        for index in 0..self.strains.len() {
            let nodes = self.gather(displacements, index);
            let gradients = self.elements[index / self.mesh.columns].gradients.iter().enumerate();
            for (point, gradients) in gradients.filter(|(point, _)| *point != CENTRE) {
                let Ok((_, measure)) = self.deformation(&nodes, gradients) else {
                    return Some(f64::NAN);
                };
                let strain = measure.value();
                let first = (index * POINTS + point) * branches;
                let past = &history.internal[first..first + branches];
                let internal = past
                    .iter()
                    .zip(&history.fractions)
                    .map(|(past, fraction)| [0, 1, 2].map(|i| past[i] + fraction * strain[i]));
                for internal in internal.chain([[0.0; 3]]) {
                    let lag = difference(&strain, &internal);
                    largest = largest.max(self.rubber.invariant([&strain, &internal, &lag])?);
                }
            }
        }
        Some(largest)
    }

    /// Keeps the state at the end of a step and returns the energy in J/m that it turned into heat: `-∂ψ/∂m_i : dm_i`
    /// by the trapezoidal rule over the change of `m_i`. The power at the ends of a step far longer than a relaxation
    /// time is not that in between.
    ///
    /// # Errors
    /// [`Inverted`]; the state kept before is then lost.
    pub fn keep(&mut self, history: &History, displacements: &[f64]) -> Result<f64, Inverted> {
        let branches = history.steps.len();
        let mut heat = 0.0;
        for index in 0..self.strains.len() {
            let nodes = self.gather(displacements, index);
            let element = &self.elements[index / self.mesh.columns];
            for (point, gradients) in element.gradients.iter().enumerate() {
                let weight = element.weights[point];
                let strain = self.deformation(&nodes, gradients)?.1.value();
                let old_strain = std::mem::replace(&mut self.strains[index][point], strain);
                let first = (index * POINTS + point) * branches;
                for (k, branch) in self.rubber.branches.iter().enumerate() {
                    let (past, fraction) = (&history.internal[first + k], history.fractions[k]);
                    let now = [0, 1, 2].map(|i| past[i] + fraction * strain[i]);
                    let before = std::mem::replace(&mut self.internal[first + k], now);
                    let old = self.driving_force(point, branch, &old_strain, &before);
                    let new = self.driving_force(point, branch, &strain, &now);
                    let force = [0, 1, 2].map(|i| 0.5 * (old[i] + new[i]));
                    let flow = [0, 1, 2].map(|i| now[i] - before[i]);
                    heat += weight * contract(&force, &flow);
                }
            }
        }
        Ok(heat)
    }

    /// The part of the force on the flow of a branch that a point integrates.
    fn driving_force(
        &self,
        point: usize,
        branch: &Spring,
        strain: &Symmetric,
        internal: &Symmetric,
    ) -> Symmetric {
        let [shear, volumetric] = self.rubber.driving_force(branch, strain, internal);
        match part_of(point) {
            Part::Shear => shear,
            Part::Volumetric => volumetric,
        }
    }

    /// Energy in J/m stored in the springs, in the state kept last.
    pub fn stored_energy(&self) -> f64 {
        let rubber = &self.rubber;
        let branches = rubber.branches.len();
        let mut sum = 0.0;
        for (index, strains) in self.strains.iter().enumerate() {
            let weights = &self.elements[index / self.mesh.columns].weights;
            for (point, (strain, weight)) in strains.iter().zip(weights).enumerate() {
                // A spring without one of its moduli has the energy of the other part.
                let only = |spring: &Spring| match part_of(point) {
                    Part::Shear => Spring { volumetric: 0.0, ..*spring },
                    Part::Volumetric => Spring { shear: 0.0, ..*spring },
                };
                let first = (index * POINTS + point) * branches;
                let internal = &self.internal[first..first + branches];
                sum += weight * rubber.energy(&only(&rubber.equilibrium), strain, &[0.0; 3]);
                for (branch, internal) in rubber.branches.iter().zip(internal) {
                    sum += weight * rubber.energy(&only(branch), strain, internal);
                }
            }
        }
        sum
    }

    /// Positions in an array over the nodes of the eight displacements of an element.
    pub fn dofs(&self, index: usize) -> [usize; 8] {
        let columns = self.mesh.columns;
        let (row, column) = (index / columns, index % columns);
        let right = (column + 1) % columns;
        let mut dofs = [0; 8];
        for (node, at) in [column, right, column, right].into_iter().enumerate() {
            let first = 2 * ((row + node / 2) * columns + at);
            dofs[2 * node] = first;
            dofs[2 * node + 1] = first + 1;
        }
        dofs
    }

    /// Deformation gradient from the displacements of the nodes, and the strain.
    fn deformation(
        &self,
        nodes: &[f64; 8],
        gradients: &[[f64; 2]; 4],
    ) -> Result<(Tensor, Measure), Inverted> {
        let mut h = [0.0; 4];
        for (node, gradient) in gradients.iter().enumerate() {
            let (x, z) = (nodes[2 * node], nodes[2 * node + 1]);
            h[0] += x * gradient[0];
            h[1] += x * gradient[1];
            h[2] += z * gradient[0];
            h[3] += z * gradient[1];
        }
        let strain = green_strain(&h);
        let f = [1.0 + h[0], h[1], h[2], 1.0 + h[3]];
        // For an element without area the inverse of the strain would be infinite.
        if dilatation(&strain) > -1.0 && f[0] * f[3] - f[1] * f[2] > 0.0 {
            let measure = self.rubber.rheology.measure(&strain).ok_or(Inverted)?;
            Ok((f, measure))
        } else {
            Err(Inverted)
        }
    }

    fn gather(&self, displacements: &[f64], index: usize) -> [f64; 8] {
        self.dofs(index).map(|dof| displacements[dof])
    }
}

impl Linearised {
    fn add(&mut self, f: &Tensor, gradients: &[[f64; 2]; 4], weight: f64, response: &Response) {
        let changes: [Symmetric; 8] =
            std::array::from_fn(|i| nodal_strain_change(f, &gradients[i / 2], i % 2));
        let stress = &response.stress;
        for (i, change) in changes.iter().enumerate() {
            // The forces do the work S : δC / 2.
            self.forces[i] += 0.5 * weight * contract(stress, change);
        }
        for (j, change) in changes.iter().enumerate() {
            let by_strain = response.moduli.map(|row| {
                0.5 * weight * (row[0] * change[0] + row[1] * change[1] + row[2] * change[2])
            });
            let gradient = &gradients[j / 2];
            let along = [
                weight * (stress[0] * gradient[0] + stress[2] * gradient[1]),
                weight * (stress[2] * gradient[0] + stress[1] * gradient[1]),
            ];
            for (i, other) in changes.iter().enumerate() {
                self.stiffness[i][j] += contract(&by_strain, other);
                if i % 2 == j % 2 {
                    let other = &gradients[i / 2];
                    self.stiffness[i][j] += along[0] * other[0] + along[1] * other[1];
                }
            }
        }
    }
}

/// The part of stress and energy that a point integrates.
fn part_of(point: usize) -> Part {
    if point == CENTRE { Part::Volumetric } else { Part::Shear }
}
