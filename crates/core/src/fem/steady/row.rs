//! One row of elements: its forces, and the tangent with its relaxation history.
//!
//! The internal measure of a branch at a point follows from the measures of the points of the same
//! kind in all elements of the row, so a row is the smallest part whose forces depend on its displacements alone.

use super::super::mesh::{CENTRE, Element, POINTS};
use super::Inverted;
use super::flow::Relaxation;
use super::hardening::{Hardened, Own, Relief};
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
    /// Of a law that stiffens.
    pub hardened: Option<Hardened<T>>,
}

impl<T: Lanes> Linearised<T> {
    fn new(columns: usize, branches: usize) -> Self {
        Self {
            points: vec![Point::default(); columns],
            history: vec![History::default(); branches * columns],
            hardened: None,
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
        let branches = material.relaxations.len();
        let mut gauss = Linearised::new(columns, branches);
        if material.rubber.rheology.stiffens() {
            gauss.hardened = Some(Hardened::new(columns, branches));
        }
        Self {
            element,
            width: period / columns as f64,
            height,
            columns,
            gauss,
            centre: Linearised::new(columns, branches),
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

    fn keep_own(&mut self, kind: usize, own: &[Own]) {
        if let Some(hardened) = &mut self.gauss.hardened {
            let own = own.iter().enumerate();
            own.for_each(|(column, own)| hardened.set_own(column, kind, own));
        }
    }

    fn keep_relief(&mut self, kind: usize, at: [usize; 2], relief: &Relief) {
        if let Some(hardened) = &mut self.gauss.hardened {
            hardened.set_relief(at, kind, relief);
        }
    }

    /// The hardening of a law that stiffens, at a point.
    pub fn own(&self, kind: usize, column: usize) -> Option<Own> {
        if kind == CENTRE { None } else { self.gauss.hardened.as_ref()?.own_lane(column, kind) }
    }

    /// The same of a branch.
    pub fn relief(&self, kind: usize, at: [usize; 2]) -> Option<Relief> {
        if kind == CENTRE { None } else { self.gauss.hardened.as_ref()?.relief_lane(at, kind) }
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
        let mut own = vec![Own::default(); points.len()];
        let mut stresses = Vec::with_capacity(points.len());
        for (point, (measure, own)) in points.iter_mut().zip(line.measures.iter().zip(&mut own)) {
            let (stress, hardening) = law.equilibrium(point, measure)?;
            stresses.push(stress);
            if let Some(hardening) = hardening {
                own.add(material.rubber.equilibrium.shear, &hardening);
            }
        }
        for (k, (spring, relaxation)) in
            material.rubber.branches.iter().zip(&material.relaxations).enumerate()
        {
            let mut valid = Ok(());
            relax(relaxation, line, |column, passage| {
                let mut history = passage.history(relaxation.length);
                let tensors = [&line.measures[column], &passage.after, &passage.lag];
                let (point, stress) = (&mut points[column], &mut stresses[column]);
                match law.branch(spring, point, &mut history, tensors, stress) {
                    Ok(None) => {}
                    Ok(Some(hardening)) => {
                        own[column].add(spring.shear, &hardening);
                        self.keep_relief(kind, [k, column], &Relief::new(spring.shear, &hardening));
                    }
                    Err(Inverted) => valid = Err(Inverted),
                }
                self.keep_history(kind, [k, column], &history);
            });
            valid?;
        }
        if kind != CENTRE {
            self.keep_own(kind, &own);
        }
        Ok(stresses)
    }

    /// Power in W/m that the branches turn into heat in the last deformed state, at its displacements.
    pub fn dissipation(&self, material: &Material, differences: &Differences) -> f64 {
        let mut power = 0.0;
        for kind in 0..POINTS {
            let (line, labels) = self.deformed_line(differences, kind);
            for (spring, relaxation) in material.rubber.branches.iter().zip(&material.relaxations) {
                relax(relaxation, &line, |column, passage| {
                    let measure = &line.measures[column];
                    let [shear, volumetric] =
                        material.rubber.dissipation(spring, measure, &passage.after);
                    let part = if kind == CENTRE { volumetric } else { shear };
                    // An area of the undeformed block: dX = A ds dZ.
                    power += self.element.weights[kind] * labels[column] * part;
                });
            }
        }
        power
    }

    /// Largest `I1 - 3` of a spring in the last deformed state, at its displacements, where shear parts are integrated.
    pub fn largest_invariant(&self, material: &Material, differences: &Differences) -> Option<f64> {
        let rubber = &material.rubber;
        let mut largest: Option<f64> = None;
        let mut count = |tensors: [&Symmetric; 3]| {
            let found = rubber.invariant(tensors);
            largest = found.map(|found| largest.map_or(found, |before| before.max(found)));
        };
        for kind in (0..POINTS).filter(|kind| *kind != CENTRE) {
            let (line, _) = self.deformed_line(differences, kind);
            line.measures.iter().for_each(|measure| count([measure, &[0.0; 3], measure]));
            for relaxation in &material.relaxations {
                relax(relaxation, &line, |column, passage| {
                    count([&line.measures[column], &passage.after, &passage.lag]);
                });
            }
        }
        largest
    }

    /// Measures, distances and `A` of a kind of points in the last deformed state, at its displacements.
    fn deformed_line(&self, differences: &Differences, kind: usize) -> (Line, Vec<f64>) {
        let rule = Rule::new(&self.element, kind);
        let mut labels = Vec::with_capacity(self.columns);
        let measures: Vec<Symmetric> = (0..self.columns)
            .map(|column| {
                let mut point = Point::default();
                let gradient = self.displacement_gradient(differences, &rule, column);
                let strain = point.deform(&gradient).unwrap_or([f64::NAN; 3]);
                labels.push(point.label[0]);
                let conversion = self.conversions.get(kind * self.columns + column);
                conversion.map_or(strain, |conversion| conversion.measure.value())
            })
            .collect();
        (Line { measures, spacings: self.spacings(differences, &rule) }, labels)
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
