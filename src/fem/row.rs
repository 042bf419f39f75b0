//! One row of elements in the steady state: forces, and the tangent with its memory.
//!
//! The internal tensor of a branch at a point follows from the strains of the points of the same
//! kind in all elements of the row, so a row is the smallest piece whose forces follow from its
//! displacements.

use super::filter::Filter;
use super::kinematics::{Tensor, green_strain};
use super::mesh::{CENTRE, Element, POINTS};
use super::point::Point;
use crate::rubber::finite_strain::{FiniteStrainRubber, IDENTITY, Symmetric, contract, sandwich};

/// What all rows share: the rubber and its memory at one speed.
#[derive(Debug, Clone)]
pub struct Material {
    /// The rubber.
    pub rubber: FiniteStrainRubber,
    /// The filter of each branch.
    pub filters: Vec<Filter>,
}

/// A row does not exist in the deformation asked for: an element is turned inside out, or an
/// internal tensor is not positive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Inverted;

/// Deformation, stress and linearised law of a row of elements.
#[derive(Debug, Clone)]
pub struct Row {
    element: Element,
    columns: usize,
    /// Points of one kind after another, columns first.
    points: Vec<Point>,
    /// `G_k` of each branch at each point; times `c_k` at the centre, in [`Self::relaxed`].
    internal: Vec<Symmetric>,
    /// `c_k` of each branch at the centres.
    relaxed: Vec<f64>,
}

impl Row {
    /// A row that has taken over no displacements yet.
    pub fn new(element: Element, columns: usize, branches: usize) -> Self {
        Self {
            element,
            columns,
            points: vec![Point::default(); POINTS * columns],
            internal: vec![IDENTITY; POINTS * columns * branches],
            relaxed: vec![0.0; columns * branches],
        }
    }

    /// Takes over the displacements of the nodes below and above and adds the internal forces
    /// (N/m) on them.
    ///
    /// # Errors
    /// [`Inverted`]; the forces are then meaningless.
    pub fn deform(
        &mut self,
        material: &Material,
        nodes: [&[f64]; 2],
        forces: [&mut [f64]; 2],
    ) -> Result<(), Inverted> {
        let [below, above] = forces;
        // From C - 1 rather than C, so that small strains keep their digits.
        let mut strains = vec![[0.0; 3]; self.columns];
        let branches = material.filters.len();
        for kind in 0..POINTS {
            let gradients = &self.element.gradients[kind];
            let range = kind * self.columns..(kind + 1) * self.columns;
            let points = &mut self.points[range];
            for (column, (point, m)) in points.iter_mut().zip(&mut strains).enumerate() {
                let mut f = displacement_gradient(nodes, gradients, column, self.columns);
                let strain = green_strain(&f);
                f[0] += 1.0;
                f[3] += 1.0;
                if f[0] * f[3] - f[1] * f[2] <= 0.0 {
                    return Err(Inverted);
                }
                point.deform(material.rubber.rheology, f, &strain)?;
                *m = point.measure.value();
            }
            let first = kind * self.columns * branches;
            let internal = &mut self.internal[first..first + self.columns * branches];
            relax(&material.filters, &strains, internal);
            let weight = self.element.weights[kind];
            for (column, point) in points.iter_mut().enumerate() {
                let internal = &mut internal[column * branches..(column + 1) * branches];
                if kind == CENTRE {
                    let relaxed = &mut self.relaxed[column * branches..(column + 1) * branches];
                    point.volumetric_law(&material.rubber, internal, relaxed)?;
                } else {
                    point.shear_law(&material.rubber, internal)?;
                }
                let traction = times(&point.deformation, &point.stress, weight);
                scatter(&traction, gradients, column, self.columns, below, above);
            }
        }
        Ok(())
    }

    /// Adds the change of the forces for a change of the displacements, at the deformation taken
    /// over last.
    pub fn tangent(&self, material: &Material, nodes: [&[f64]; 2], forces: [&mut [f64]; 2]) {
        let [below, above] = forces;
        let branches = material.filters.len();
        let mut changes = vec![[0.0; 4]; self.columns];
        let mut strains = vec![[0.0; 3]; self.columns];
        let mut memory = vec![[0.0; 3]; self.columns * branches];
        for kind in 0..POINTS {
            let gradients = &self.element.gradients[kind];
            let points = &self.points[kind * self.columns..(kind + 1) * self.columns];
            for (column, point) in points.iter().enumerate() {
                let df = displacement_gradient(nodes, gradients, column, self.columns);
                strains[column] = point.measure_change(&df);
                changes[column] = df;
            }
            relax(&material.filters, &strains, &mut memory);
            let first = kind * self.columns * branches;
            let internal = &self.internal[first..first + self.columns * branches];
            let weight = self.element.weights[kind];
            for (column, point) in points.iter().enumerate() {
                let range = column * branches..(column + 1) * branches;
                let (internal, changed) = (&internal[range.clone()], &memory[range.clone()]);
                let conjugate = if kind == CENTRE {
                    let relaxed = &self.relaxed[range];
                    point.volumetric_tangent(&strains[column], internal, relaxed, changed)
                } else {
                    point.shear_tangent(&material.rubber, &strains[column], internal, changed)
                };
                let stress = point.stress_change(&conjugate, &changes[column]);
                let elastic = times(&point.deformation, &stress, weight);
                let geometric = times(&changes[column], &point.stress, weight);
                let traction = [0, 1, 2, 3].map(|i| elastic[i] + geometric[i]);
                scatter(&traction, gradients, column, self.columns, below, above);
            }
        }
    }

    /// Power in W/m that the branches turn into heat at displacements of the row.
    /// NaN where [`Self::deform`] would fail.
    pub fn dissipation(&self, material: &Material, nodes: [&[f64]; 2]) -> f64 {
        let branches = material.filters.len();
        let mut internal = vec![[0.0; 3]; self.columns * branches];
        let mut power = 0.0;
        for (kind, gradients) in self.element.gradients.iter().enumerate() {
            let strains: Vec<Symmetric> = (0..self.columns)
                .map(|column| {
                    let h = displacement_gradient(nodes, gradients, column, self.columns);
                    let measure = material.rubber.rheology.measure(&green_strain(&h));
                    measure.map_or([f64::NAN; 3], |measure| measure.value())
                })
                .collect();
            relax(&material.filters, &strains, &mut internal);
            for (strain, internal) in strains.iter().zip(internal.chunks_exact(branches.max(1))) {
                for (spring, internal) in material.rubber.branches.iter().zip(internal) {
                    let [shear, volumetric] = material.rubber.dissipation(spring, strain, internal);
                    let part = if kind == CENTRE { volumetric } else { shear };
                    power += self.element.weights[kind] * part;
                }
            }
        }
        power
    }

    /// Stiffness of one element if every internal tensor were that of its own point and followed
    /// it at once by the fraction `follows` of each branch: the tangent without its memory,
    /// symmetric.
    pub fn local_stiffness(
        &self,
        material: &Material,
        follows: &[f64],
        column: usize,
    ) -> [[f64; 8]; 8] {
        let branches = material.filters.len();
        let mut stiffness = [[0.0; 8]; 8];
        let followed: f64 = material
            .rubber
            .branches
            .iter()
            .zip(follows)
            .map(|(spring, follows)| spring.shear * follows)
            .sum();
        for (kind, gradients) in self.element.gradients.iter().enumerate() {
            let weight = self.element.weights[kind];
            let point = &self.points[kind * self.columns + column];
            let relaxed = &self.relaxed[column * branches..(column + 1) * branches];
            let volumetric =
                point.modulus - relaxed.iter().zip(follows).map(|(c, f)| c * f).sum::<f64>();
            let conjugate_of = |strain: &Symmetric| {
                let turned = sandwich(&point.inverse, strain);
                if kind == CENTRE {
                    let pressure = volumetric * contract(&point.inverse, strain);
                    [0, 1, 2].map(|i| pressure * point.inverse[i] - point.pressure * turned[i])
                } else {
                    turned.map(|s| (point.modulus - followed) * s)
                }
            };
            let f = &point.deformation;
            for (node, gradient) in gradients.iter().enumerate() {
                for direction in 0..2 {
                    let mut df = [0.0; 4];
                    df[2 * direction..2 * direction + 2].copy_from_slice(gradient);
                    let conjugate = conjugate_of(&point.measure_change(&df));
                    let elastic = times(f, &point.stress_change(&conjugate, &df), weight);
                    let geometric = times(&df, &point.stress, weight);
                    let traction = [0, 1, 2, 3].map(|i| elastic[i] + geometric[i]);
                    for (other, gradient) in gradients.iter().enumerate() {
                        for i in 0..2 {
                            stiffness[2 * other + i][2 * node + direction] +=
                                traction[2 * i] * gradient[0] + traction[2 * i + 1] * gradient[1];
                        }
                    }
                }
            }
        }
        stiffness
    }
}

/// Internal tensors of all branches (branches of a column together) from the strains of a row.
fn relax(filters: &[Filter], strains: &[Symmetric], internal: &mut [Symmetric]) {
    let n = strains.len();
    let branches = filters.len();
    for (k, filter) in filters.iter().enumerate() {
        let mut state = [0, 1, 2].map(|i| filter.start(|column| strains[column][i], n));
        let mut window = [strains[(n - 2) % n], strains[n - 1], strains[0]];
        for column in 0..n {
            let next = strains[if column + 1 == n { 0 } else { column + 1 }];
            for i in 0..3 {
                state[i] = filter.step(state[i], window[0][i], window[1][i], window[2][i], next[i]);
            }
            internal[column * branches + k] = state;
            window = [window[1], window[2], next];
        }
    }
}

#[inline]
fn displacement_gradient(
    nodes: [&[f64]; 2],
    gradients: &[[f64; 2]; 4],
    column: usize,
    columns: usize,
) -> Tensor {
    let right = if column + 1 == columns { 0 } else { column + 1 };
    let mut f = [0.0; 4];
    for (node, gradient) in gradients.iter().enumerate() {
        let at = 2 * if node % 2 == 0 { column } else { right };
        let (x, z) = (nodes[node / 2][at], nodes[node / 2][at + 1]);
        f[0] += x * gradient[0];
        f[1] += x * gradient[1];
        f[2] += z * gradient[0];
        f[3] += z * gradient[1];
    }
    f
}

/// Weighted product of a tensor with a symmetric one.
#[inline]
fn times(f: &Tensor, s: &Symmetric, weight: f64) -> Tensor {
    [
        weight * (f[0] * s[0] + f[1] * s[2]),
        weight * (f[0] * s[2] + f[1] * s[1]),
        weight * (f[2] * s[0] + f[3] * s[2]),
        weight * (f[2] * s[2] + f[3] * s[1]),
    ]
}

#[inline]
fn scatter(
    traction: &Tensor,
    gradients: &[[f64; 2]; 4],
    column: usize,
    columns: usize,
    below: &mut [f64],
    above: &mut [f64],
) {
    let right = if column + 1 == columns { 0 } else { column + 1 };
    for (node, gradient) in gradients.iter().enumerate() {
        let at = 2 * if node % 2 == 0 { column } else { right };
        let forces = if node < 2 { &mut *below } else { &mut *above };
        forces[at] += traction[0] * gradient[0] + traction[1] * gradient[1];
        forces[at + 1] += traction[2] * gradient[0] + traction[3] * gradient[1];
    }
}
