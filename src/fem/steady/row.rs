//! One row of elements: its forces, and the tangent with its relaxation history.
//!
//! The internal measure of a branch at a point follows from the measures of the points of the same
//! kind in all elements of the row, so a row is the smallest piece whose forces follow from its
//! displacements.

use super::super::kinematics::Tensor;
use super::super::mesh::{CENTRE, Element, PLACES, POINTS};
use super::Inverted;
use super::flow::{Relaxation, Weights, window};
use super::long::Value;
use super::point::{Conversion, Law, Memory, Point, narrow};
use crate::rubber::finite_strain::{FiniteStrainRubber, Rheology, Symmetric};

/// What all rows share: the rubber and its memory at one speed.
#[derive(Debug, Clone)]
pub(super) struct Material {
    pub rubber: FiniteStrainRubber,
    /// The relaxation of each branch.
    pub relaxations: Vec<Relaxation>,
}

/// How far the elements are from being inverted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Validity {
    /// Smallest det F.
    pub volume: f64,
    /// Smallest `A`, the inverse of the stretch of the surface along x.
    pub label: f64,
}

impl Validity {
    pub const BEST: Self = Self { volume: f64::INFINITY, label: f64::INFINITY };

    pub fn and(self, other: Self) -> Self {
        Self { volume: self.volume.min(other.volume), label: self.label.min(other.label) }
    }
}

/// Deformation, stress and linearised law of a row of elements.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub element: Element,
    /// Width and height of an element in m.
    pub width: f64,
    pub height: f64,
    pub columns: usize,
    /// Points of one kind after another, columns first.
    pub points: Vec<Point>,
    /// Branches of one kind of points after another, columns first.
    pub memory: Vec<Memory>,
    /// As the points, under the linear law alone.
    pub conversions: Vec<Conversion>,
}

/// Differences of displacements in m between the corners of each element of a row, `(x, z)`.
pub(super) struct Differences {
    /// From the left to the right lower corner.
    lower: Vec<[f64; 2]>,
    /// From the left to the right upper corner.
    upper: Vec<[f64; 2]>,
    /// From the lower to the upper left corner.
    across: Vec<[f64; 2]>,
}

impl Differences {
    /// Of the values at the lower and at the upper corners, `(x, z)` each.
    pub fn new<T: Value>(lower: &[T], upper: &[T]) -> Self {
        let along = |row: &[T]| -> Vec<[f64; 2]> {
            let right = row.iter().cycle().skip(2);
            let differences: Vec<f64> =
                row.iter().zip(right).map(|(left, right)| right.minus(*left)).collect();
            differences.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
        };
        let across = upper.chunks_exact(2).zip(lower.chunks_exact(2));
        let across = across.map(|(upper, lower)| [0, 1].map(|i| upper[i].minus(lower[i])));
        Self { lower: along(lower), upper: along(upper), across: across.collect() }
    }
}

/// Measures of a kind of points and the distances of their labels from the points before.
struct Line {
    measures: Vec<Symmetric>,
    spacings: Vec<f64>,
}

impl Row {
    /// A row that has taken over no displacements yet; period and height of an element in m.
    pub fn new(
        element: Element,
        columns: usize,
        [period, height]: [f64; 2],
        material: &Material,
    ) -> Self {
        let points = POINTS * columns;
        let converted = material.rubber.rheology == Rheology::Linear;
        Self {
            element,
            width: period / columns as f64,
            height,
            columns,
            points: vec![Point::default(); points],
            memory: vec![Memory::default(); points * material.relaxations.len()],
            conversions: vec![Conversion::default(); if converted { points } else { 0 }],
        }
    }

    /// Takes over the displacements and returns the internal forces in N/m at the corners.
    ///
    /// # Errors
    /// [`Inverted`]; the state of the row is then meaningless.
    pub fn deform(
        &mut self,
        material: &Material,
        differences: &Differences,
    ) -> Result<([Vec<f64>; 2], Validity), Inverted> {
        let mut forces = [vec![0.0; 2 * self.columns], vec![0.0; 2 * self.columns]];
        let mut validity = Validity::BEST;
        for kind in 0..POINTS {
            let line = self.line(material.rubber.rheology, differences, kind)?;
            let conjugates = self.stresses(material, &line, kind)?;
            let first = kind * self.columns;
            for (column, conjugate) in conjugates.iter().enumerate() {
                let point = &mut self.points[first + column];
                point.stress = match self.conversions.get_mut(first + column) {
                    Some(conversion) => {
                        conversion.conjugate = *conjugate;
                        conversion.measure.derivative(conjugate)
                    }
                    None => *conjugate,
                };
                let here = Validity { volume: point.volume(), label: point.label[0] };
                validity = validity.and(here);
                let stress = Point::first_stress(&point.deformation, &point.stress);
                scatter(&self.element, kind, column, &nodal(&stress, &point.label), &mut forces);
            }
        }
        Ok((forces, validity))
    }

    /// Takes over the deformation of a kind of points.
    fn line(
        &mut self,
        rheology: Rheology,
        differences: &Differences,
        kind: usize,
    ) -> Result<Line, Inverted> {
        let first = kind * self.columns;
        let mut measures = Vec::with_capacity(self.columns);
        for column in 0..self.columns {
            let gradient = self.displacement_gradient(differences, kind, column);
            let strain = self.points[first + column].deform(&gradient)?;
            match self.conversions.get_mut(first + column) {
                Some(conversion) => {
                    conversion.measure = rheology.measure(&strain).ok_or(Inverted)?;
                    measures.push(conversion.measure.value());
                }
                None => measures.push(strain),
            }
        }
        let spacings = self.spacings(differences, kind);
        if spacings.iter().all(|spacing| *spacing > 0.0) {
            Ok(Line { measures, spacings })
        } else {
            Err(Inverted)
        }
    }

    /// Distances in m of the labels ξ of a kind of points from those before.
    fn spacings(&self, differences: &Differences, kind: usize) -> Vec<f64> {
        self.shifts(differences, kind).map(|shift| self.width - shift).collect()
    }

    /// Differences in m of the x displacements of a kind of points to those of the points before.
    pub fn shifts(
        &self,
        differences: &Differences,
        kind: usize,
    ) -> impl Iterator<Item = f64> + use<'_> {
        let (a, b) = PLACES[kind];
        let Differences { lower, upper, .. } = differences;
        let along = |column: usize| (1.0 - b) * lower[column][0] + b * upper[column][0];
        let along: Vec<f64> = (0..self.columns).map(along).collect();
        (0..self.columns)
            .map(move |column| (1.0 - a) * along[before(column, self.columns)] + a * along[column])
    }

    /// `(q_s, q_Z, w_s, w_Z)` at a point of a column.
    #[inline]
    pub fn displacement_gradient(
        &self,
        differences: &Differences,
        kind: usize,
        column: usize,
    ) -> Tensor {
        let (a, b) = PLACES[kind];
        let right = if column + 1 == self.columns { 0 } else { column + 1 };
        let Differences { lower, upper, across } = differences;
        let along = |i: usize| ((1.0 - b) * lower[column][i] + b * upper[column][i]) / self.width;
        let up = |i: usize| ((1.0 - a) * across[column][i] + a * across[right][i]) / self.height;
        [along(0), up(0), along(1), up(1)]
    }

    /// Conjugate stresses at a kind of points, and their linearised law.
    fn stresses(
        &mut self,
        material: &Material,
        line: &Line,
        kind: usize,
    ) -> Result<Vec<Symmetric>, Inverted> {
        let law = Law { rubber: &material.rubber, volumetric: kind == CENTRE };
        let points = &mut self.points[kind * self.columns..(kind + 1) * self.columns];
        let measures = points.iter_mut().zip(&line.measures);
        let stresses: Result<Vec<_>, _> =
            measures.map(|(point, measure)| law.equilibrium(point, measure)).collect();
        let mut stresses = stresses?;
        let branches = material.rubber.branches.len();
        for (k, (spring, relaxation)) in
            material.rubber.branches.iter().zip(&material.relaxations).enumerate()
        {
            let start = (kind * branches + k) * self.columns;
            let memory = &mut self.memory[start..start + self.columns];
            let mut valid = Ok(());
            relax(relaxation, line, |column, passage| {
                let memory = &mut memory[column];
                passage.keep(memory, relaxation.length);
                let both = [&line.measures[column], &passage.after];
                let added =
                    law.branch(spring, &mut points[column], memory, both, &mut stresses[column]);
                if added.is_err() {
                    valid = added;
                }
            });
            valid?;
        }
        Ok(stresses)
    }

    /// Power in W/m that the branches turn into heat in the state that was taken over last, at its
    /// displacements.
    pub fn dissipation(&self, material: &Material, differences: &Differences) -> f64 {
        let mut power = 0.0;
        for kind in 0..POINTS {
            let points = &self.points[kind * self.columns..(kind + 1) * self.columns];
            let measures: Vec<Symmetric> = (0..self.columns)
                .map(|column| match self.conversions.get(kind * self.columns + column) {
                    Some(conversion) => conversion.measure.value(),
                    None => {
                        let gradient = self.displacement_gradient(differences, kind, column);
                        points[column].clone().deform(&gradient).unwrap_or([f64::NAN; 3])
                    }
                })
                .collect();
            let line = Line { measures, spacings: self.spacings(differences, kind) };
            for (spring, relaxation) in material.rubber.branches.iter().zip(&material.relaxations) {
                relax(relaxation, &line, |column, passage| {
                    let measure = &line.measures[column];
                    let [shear, volumetric] =
                        material.rubber.dissipation(spring, measure, &passage.after);
                    let part = if kind == CENTRE { volumetric } else { shear };
                    // An area of the undeformed block: dX = A ds dZ.
                    power += self.element.weights[kind] * points[column].label[0] * part;
                });
            }
        }
        power
    }
}

/// The internal measure from one point to the next.
struct Passage<'a> {
    weights: &'a (Weights, Weights),
    measures: [Symmetric; 4],
    before: Symmetric,
    after: Symmetric,
}

impl Passage<'_> {
    /// Keeps what the tangent needs.
    fn keep(&self, memory: &mut Memory, length: f64) {
        let (weights, slopes) = self.weights;
        memory.forgotten = (1.0 - weights.decay) as f32;
        memory.weights = narrow(&weights.of);
        let source = step(slopes, &self.before, &self.measures).map(|source| source / length);
        memory.source = narrow(&source);
    }
}

#[inline]
fn step(weights: &Weights, before: &Symmetric, measures: &[Symmetric; 4]) -> Symmetric {
    [0, 1, 2].map(|i| {
        let of: f64 = (0..4).map(|k| weights.of[k] * measures[k][i]).sum();
        weights.decay * before[i] + of
    })
}

/// Follows the flow rule of a branch over the period.
fn relax(relaxation: &Relaxation, line: &Line, mut visit: impl FnMut(usize, &Passage<'_>)) {
    let weights: Vec<(Weights, Weights)> = line
        .spacings
        .iter()
        .map(|spacing| Weights::with_slopes(spacing / relaxation.length))
        .collect();
    let mut state = [0.0; 3];
    let start = relaxation.start(&line.spacings);
    for (column, weights) in weights.iter().enumerate().skip(start) {
        state = step(&weights.0, &state, &window(&line.measures, column));
    }
    let whole = relaxation.whole_period();
    state = state.map(|y| y / whole);
    for (column, weights) in weights.iter().enumerate() {
        let measures = window(&line.measures, column);
        let after = step(&weights.0, &state, &measures);
        visit(column, &Passage { weights, measures, before: state, after });
        state = after;
    }
}

/// The column before, periodic.
#[inline]
pub(super) fn before(column: usize, columns: usize) -> usize {
    if column == 0 { columns - 1 } else { column - 1 }
}

/// Factors of `N_s` and `N_Z` in the nodal force `P (N_s, A N_Z - B N_s)`.
#[inline]
pub(super) fn nodal(stress: &Tensor, [a, b]: &[f64; 2]) -> Tensor {
    [stress[0] - b * stress[1], a * stress[1], stress[2] - b * stress[3], a * stress[3]]
}

/// Adds the nodal forces of a point.
#[inline]
pub(super) fn scatter(
    element: &Element,
    kind: usize,
    column: usize,
    stress: &Tensor,
    forces: &mut [Vec<f64>; 2],
) {
    let weight = element.weights[kind];
    let right = if 2 * column + 2 == forces[0].len() { 0 } else { column + 1 };
    for (node, [along, up]) in element.gradients[kind].iter().enumerate() {
        let at = 2 * if node % 2 == 0 { column } else { right };
        let force = &mut forces[node / 2][at..at + 2];
        force[0] += weight * (stress[0] * along + stress[1] * up);
        force[1] += weight * (stress[2] * along + stress[3] * up);
    }
}
