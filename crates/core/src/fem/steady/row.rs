//! One row of elements: its forces, and the tangent with its relaxation history.
//!
//! The internal measure of a branch at a point follows from the measures of the points of the same
//! kind in all elements of the row, so a row is the smallest part whose forces depend on its displacements alone.

use super::super::mesh::{CENTRE, Element, POINTS};
use super::Inverted;
use super::flow::Relaxation;
use super::lanes::{Lanes, Rule};
use super::long::Value;
use super::passage::{Line, relax};
use super::point::{Conversion, History, Law, Point};
use crate::rubber::finite_strain::{FiniteStrainRubber, Rheology, Scalar, Symmetric};
use wide::f64x4;

/// What all rows share: the rubber and the lengths in which its branches relax at one speed.
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

/// Deformation, stress and linearised law at points of a row, in all lanes.
#[derive(Debug, Clone)]
pub(super) struct Linearised<T> {
    /// One a column.
    pub points: Vec<Point<T>>,
    /// One branch after another, columns first.
    pub history: Vec<History<T>>,
}

impl<T: Lanes> Linearised<T> {
    fn new(columns: usize, branches: usize) -> Self {
        Self {
            points: vec![Point::default(); columns],
            history: vec![History::default(); branches * columns],
        }
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
    /// At the Gauss points.
    pub gauss: Linearised<f64x4>,
    pub centre: Linearised<f64>,
    /// One kind of points after another, columns first; for laws that are not in `C - 1` alone.
    pub conversions: Vec<Conversion>,
}

/// Differences of displacements in m between the corners of each element of a row, `(x, z)`.
pub(super) struct Differences {
    /// From the left to the right lower corner.
    lower: Vec<[f64; 2]>,
    /// From the left to the right upper corner.
    upper: Vec<[f64; 2]>,
    /// From the lower to the upper left corner.
    left: Vec<[f64; 2]>,
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
        let left = upper.chunks_exact(2).zip(lower.chunks_exact(2));
        let left = left.map(|(upper, lower)| [0, 1].map(|i| upper[i].minus(lower[i])));
        Self { lower: along(lower), upper: along(upper), left: left.collect() }
    }
}

impl Row {
    /// A row without displacements yet; period and height of an element in m.
    pub fn new(
        element: Element,
        columns: usize,
        [period, height]: [f64; 2],
        material: &Material,
    ) -> Self {
        let points = POINTS * columns;
        let converted = !material.rubber.rheology.is_in_green_strain();
        Self {
            element,
            width: period / columns as f64,
            height,
            columns,
            gauss: Linearised::new(columns, material.relaxations.len()),
            centre: Linearised::new(columns, material.relaxations.len()),
            conversions: vec![Conversion::default(); if converted { points } else { 0 }],
        }
    }

    /// Sets the displacements and returns the internal forces in N/m at the corners.
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
            let rule = Rule::new(&self.element, kind);
            let (line, mut points) =
                self.line(material.rubber.rheology, differences, (kind, &rule))?;
            let conjugates = self.stresses(material, &line, &mut points, kind)?;
            for (column, (point, conjugate)) in points.iter_mut().zip(&conjugates).enumerate() {
                point.stress = match self.conversions.get_mut(kind * self.columns + column) {
                    Some(conversion) => {
                        conversion.conjugate = *conjugate;
                        conversion.measure.derivative(conjugate)
                    }
                    None => *conjugate,
                };
                let here = Validity { volume: point.volume(), label: point.label[0] };
                validity = validity.and(here);
                let stress = Point::first_stress(&point.deformation, &point.stress);
                scatter(&rule, column, &nodal(&stress, &point.label), &mut forces);
                self.keep_point(kind, column, point);
            }
        }
        Ok((forces, validity))
    }

    /// Keeps what the tangent needs of a point.
    fn keep_point(&mut self, kind: usize, column: usize, point: &Point) {
        if kind == CENTRE {
            self.centre.points[column].set_lane(0, point);
        } else {
            self.gauss.points[column].set_lane(kind, point);
        }
    }

    fn keep_history(&mut self, kind: usize, [branch, column]: [usize; 2], history: &History) {
        let at = branch * self.columns + column;
        if kind == CENTRE {
            self.centre.history[at].set_lane(0, history);
        } else {
            self.gauss.history[at].set_lane(kind, history);
        }
    }

    /// A point as the tangent knows it.
    pub fn point(&self, kind: usize, column: usize) -> Point {
        if kind == CENTRE {
            self.centre.points[column].lane(0)
        } else {
            self.gauss.points[column].lane(kind)
        }
    }

    /// A branch at a point as the tangent knows it.
    pub fn history(&self, kind: usize, [branch, column]: [usize; 2]) -> History {
        let at = branch * self.columns + column;
        if kind == CENTRE {
            self.centre.history[at].lane(0)
        } else {
            self.gauss.history[at].lane(kind)
        }
    }

    /// The deformation of a kind of points.
    fn line(
        &mut self,
        rheology: Rheology,
        differences: &Differences,
        (kind, rule): (usize, &Rule<f64>),
    ) -> Result<(Line, Vec<Point>), Inverted> {
        let first = kind * self.columns;
        let mut measures = Vec::with_capacity(self.columns);
        let mut points = vec![Point::default(); self.columns];
        for (column, point) in points.iter_mut().enumerate() {
            let gradient = self.displacement_gradient(differences, rule, column);
            let strain = point.deform(&gradient)?;
            match self.conversions.get_mut(first + column) {
                Some(conversion) => {
                    conversion.measure = rheology.measure(&strain).ok_or(Inverted)?;
                    measures.push(conversion.measure.value());
                }
                None => measures.push(strain),
            }
        }
        let spacings = self.spacings(differences, rule);
        if spacings.iter().all(|spacing| *spacing > 0.0) {
            Ok((Line { measures, spacings }, points))
        } else {
            Err(Inverted)
        }
    }

    /// Distances in m of the labels ξ of a kind of points from those before.
    fn spacings(&self, differences: &Differences, rule: &Rule<f64>) -> Vec<f64> {
        self.shifts(differences, rule).iter().map(|shift| self.width - shift).collect()
    }

    /// Differences in m of the x displacements of points to those of the points before.
    pub fn shifts<T: Lanes>(&self, differences: &Differences, rule: &Rule<T>) -> Vec<T> {
        let Differences { lower, upper, .. } = differences;
        let along = |column: usize| {
            let (lower, upper) = (T::splat(lower[column][0]), T::splat(upper[column][0]));
            rule.z[0] * lower + rule.z[1] * upper
        };
        let mut before = along(self.columns - 1);
        (0..self.columns)
            .map(|column| {
                let here = along(column);
                let shift = rule.x[0] * before + rule.x[1] * here;
                before = here;
                shift
            })
            .collect()
    }

    /// `(q_s, q_Z, w_s, w_Z)` at a point of a column.
    #[inline]
    pub fn displacement_gradient<T: Lanes>(
        &self,
        differences: &Differences,
        rule: &Rule<T>,
        column: usize,
    ) -> [T; 4] {
        let right = if column + 1 == self.columns { 0 } else { column + 1 };
        let Differences { lower, upper, left } = differences;
        let between = |weights: &[T; 2], from: &[f64; 2], to: &[f64; 2]| {
            [0, 1].map(|i| weights[0] * T::splat(from[i]) + weights[1] * T::splat(to[i]))
        };
        let (width, height) = (T::splat(self.width), T::splat(self.height));
        let along = between(&rule.z, &lower[column], &upper[column]).map(|d| d / width);
        let up = between(&rule.x, &left[column], &left[right]).map(|d| d / height);
        [along[0], up[0], along[1], up[1]]
    }

    /// Conjugate stresses at a kind of points, and their linearised law.
    fn stresses(
        &mut self,
        material: &Material,
        line: &Line,
        points: &mut [Point],
        kind: usize,
    ) -> Result<Vec<Symmetric>, Inverted> {
        let law = Law { rubber: &material.rubber, volumetric: kind == CENTRE };
        let measures = points.iter_mut().zip(&line.measures);
        let stresses: Result<Vec<_>, _> =
            measures.map(|(point, measure)| law.equilibrium(point, measure)).collect();
        let mut stresses = stresses?;
        for (k, (spring, relaxation)) in
            material.rubber.branches.iter().zip(&material.relaxations).enumerate()
        {
            let mut valid = Ok(());
            relax(relaxation, line, |column, passage| {
                let mut history = passage.history(relaxation.length);
                let tensors = [&line.measures[column], &passage.after, &passage.lag];
                let (point, stress) = (&mut points[column], &mut stresses[column]);
                let added = law.branch(spring, point, &mut history, tensors, stress);
                if added.is_err() {
                    valid = added;
                }
                self.keep_history(kind, [k, column], &history);
            });
            valid?;
        }
        Ok(stresses)
    }

    /// Power in W/m that the branches turn into heat in the last deformed state, at its displacements.
    pub fn dissipation(&self, material: &Material, differences: &Differences) -> f64 {
        let mut power = 0.0;
        for kind in 0..POINTS {
            let rule = Rule::new(&self.element, kind);
            let mut points = vec![Point::default(); self.columns];
            let measures: Vec<Symmetric> = points
                .iter_mut()
                .enumerate()
                .map(|(column, point)| {
                    let gradient = self.displacement_gradient(differences, &rule, column);
                    let strain = point.deform(&gradient).unwrap_or([f64::NAN; 3]);
                    let conversion = self.conversions.get(kind * self.columns + column);
                    conversion.map_or(strain, |conversion| conversion.measure.value())
                })
                .collect();
            let line = Line { measures, spacings: self.spacings(differences, &rule) };
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

/// The column before, periodic.
#[inline]
pub(super) fn before(column: usize, columns: usize) -> usize {
    if column == 0 { columns - 1 } else { column - 1 }
}

/// Factors of `N_s` and `N_Z` in the nodal force `P (N_s, A N_Z - B N_s)`.
#[inline]
pub(super) fn nodal<T: Scalar>(stress: &[T; 4], [a, b]: &[T; 2]) -> [T; 4] {
    let [xx, xz, zx, zz] = *stress;
    [xx - *b * xz, *a * xz, zx - *b * zz, *a * zz]
}

/// Adds the nodal forces of points.
#[inline]
pub(super) fn scatter<T: Lanes>(
    rule: &Rule<T>,
    column: usize,
    stress: &[T; 4],
    forces: &mut [Vec<f64>; 2],
) {
    let right = if 2 * column + 2 == forces[0].len() { 0 } else { column + 1 };
    for (node, [along, up]) in rule.gradients.iter().enumerate() {
        let at = 2 * if node % 2 == 0 { column } else { right };
        let force = &mut forces[node / 2][at..at + 2];
        force[0] += (rule.weight * (stress[0] * *along + stress[1] * *up)).sum();
        force[1] += (rule.weight * (stress[2] * *along + stress[3] * *up)).sum();
    }
}
