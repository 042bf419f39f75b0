//! Change of the forces of a row by that of its displacements.
//!
//! The Gauss points of an element are carried side by side. In single precision the directions would be too poor at
//! a large shear, where glassy stiffnesses cancel: one wave at 25 MPa took five times the iterations, or ended.

use super::super::mesh::CENTRE;
use super::flow::Relaxation;
use super::hardening::Relief;
use super::lanes::{Lanes, Rule, lane, set_lane};
use super::point::{History, Point};
use super::row::{Differences, Linearised, Material, Row, nodal, scatter};
use crate::rubber::finite_strain::{Scalar, Symmetric};

/// Changes at points of a row, by columns.
struct Changes<T> {
    gradients: Vec<[T; 4]>,
    /// Those of the last two columns first, that of the first column again behind the last one: what
    /// the flow rule sees of a periodic row.
    measures: Vec<[T; 3]>,
    /// Decrease of the distances of the labels.
    shifts: Vec<T>,
    stresses: Vec<[T; 3]>,
}

impl Row {
    /// Change of the forces at the corners for a change of the displacements.
    pub fn tangent(&self, material: &Material, differences: &Differences) -> [Vec<f64>; 2] {
        let mut forces = [vec![0.0; 2 * self.columns], vec![0.0; 2 * self.columns]];
        self.add_tangent(material, differences, (0, &self.gauss), &mut forces);
        self.add_tangent(material, differences, (CENTRE, &self.centre), &mut forces);
        forces
    }

    /// Adds the part of the points from kind `first` on.
    fn add_tangent<T: Lanes>(
        &self,
        material: &Material,
        differences: &Differences,
        (first, law): (usize, &Linearised<T>),
        forces: &mut [Vec<f64>; 2],
    ) {
        let rule = Rule::new(&self.element, first);
        let mut changes = self.changes(differences, &rule, (first, law));
        let branches = law.history.chunks_exact(self.columns);
        for (k, (relaxation, history)) in material.relaxations.iter().zip(branches).enumerate() {
            let more = law.hardened.as_ref().map_or(&[][..], |hardened| hardened.branch(k));
            changes.relax(relaxation, (history, more), &law.points, first == CENTRE);
        }
        let made = changes.gradients.iter().zip(&changes.stresses);
        for (column, (point, (gradient, conjugate))) in law.points.iter().zip(made).enumerate() {
            let df = point.deformation_change(gradient);
            let stress = self.stress(point, &df, conjugate, [first, column]);
            let total = stress_change(point, &df, &stress, gradient);
            scatter(&rule, column, &total, forces);
        }
    }

    /// Changes of deformation and measure, and of the stresses if no branch relaxed.
    fn changes<T: Lanes>(
        &self,
        differences: &Differences,
        rule: &Rule<T>,
        (first, law): (usize, &Linearised<T>),
    ) -> Changes<T> {
        let count = self.columns;
        let mut changes = Changes {
            gradients: Vec::with_capacity(count),
            measures: vec![[T::default(); 3]; 2],
            shifts: self.shifts(differences, rule),
            stresses: Vec::with_capacity(count),
        };
        changes.measures.reserve_exact(count + 1);
        for (column, point) in law.points.iter().enumerate() {
            let gradient = self.displacement_gradient(differences, rule, column);
            let strain = point.strain_change(&point.deformation_change(&gradient));
            let measure = self.measure(&strain, [first, column]);
            let mut stress = point.own_stress(first == CENTRE, &measure);
            if let Some(own) = law.hardened.as_ref().and_then(|hardened| hardened.own(column)) {
                let more = own.stress(&measure);
                (0..3).for_each(|i| stress[i] = stress[i] + more[i]);
            }
            changes.stresses.push(stress);
            changes.gradients.push(gradient);
            changes.measures.push(measure);
        }
        changes.measures.copy_within(count.., 0);
        changes.measures.push(changes.measures[2]);
        changes
    }

    /// Change of the measure by that of C, at the points of a column from kind `first` on.
    #[inline]
    fn measure<T: Lanes>(&self, strain: &[T; 3], [first, column]: [usize; 2]) -> [T; 3] {
        if self.conversions.is_empty() {
            return *strain;
        }
        by_lane(|at| {
            let conversion = &self.conversions[(first + at) * self.columns + column];
            conversion.measure.derivative(&lane(strain, at))
        })
    }

    /// Change of S by that of the conjugate stress.
    #[inline]
    fn stress<T: Lanes>(
        &self,
        point: &Point<T>,
        df: &[T; 4],
        conjugate: &[T; 3],
        [first, column]: [usize; 2],
    ) -> [T; 3] {
        if self.conversions.is_empty() {
            return *conjugate;
        }
        let strain = point.strain_change(df);
        by_lane(|at| {
            let conversion = &self.conversions[(first + at) * self.columns + column];
            conversion.stress_change(&lane(conjugate, at), &lane(&strain, at))
        })
    }
}

fn by_lane<T: Lanes>(value: impl Fn(usize) -> Symmetric) -> [T; 3] {
    let mut lanes = [T::default(); 3];
    (0..T::COUNT).for_each(|at| set_lane(&mut lanes, at, &value(at)));
    lanes
}

impl<T: Lanes> Changes<T> {
    /// Subtracts the relief by a branch from the stresses; `more` is that of a law that stiffens, or empty.
    fn relax(
        &mut self,
        relaxation: &Relaxation,
        (history, more): (&[History<T>], &[Relief<T>]),
        points: &[Point<T>],
        volumetric: bool,
    ) {
        let windows = self.measures.array_windows().zip(&self.shifts);
        let inputs: Vec<[T; 3]> = history
            .iter()
            .zip(windows)
            .map(|(history, (measures, shift))| history.input(measures, *shift))
            .collect();
        let start = start(history);
        let steps = history[start..].iter().zip(&inputs[start..]);
        let mut state =
            steps.fold([T::default(); 3], |state, (history, input)| history.step(&state, input));
        if start == 0 {
            let periods = T::splat(1.0 / relaxation.whole_period());
            state = state.map(|y| y * periods);
        }
        let columns = history.iter().zip(&inputs).zip(points.iter().zip(&mut self.stresses));
        for (column, ((history, input), (point, stress))) in columns.enumerate() {
            state = history.step(&state, input);
            let relief = history.relief(volumetric, point, &state);
            (0..3).for_each(|i| stress[i] = stress[i] - relief[i]);
            if let Some(more) = more.get(column) {
                let relief = more.of(&state);
                (0..3).for_each(|i| stress[i] = stress[i] - relief[i]);
            }
        }
    }
}

/// Beyond this a change has decayed below the accuracy of a direction.
const FORGOTTEN: f64 = 1e-9;

/// First point of a sweep whose state at the last point depends on the row alone.
fn start<T: Lanes>(history: &[History<T>]) -> usize {
    let mut left = T::splat(1.0);
    let start = history.iter().rposition(|history| {
        left = left - history.relaxed * left;
        (0..T::COUNT).all(|at| left.lane(at) < FORGOTTEN)
    });
    start.unwrap_or(0)
}

/// Change of what [`nodal`] returns, by those of the deformation gradient, of the stress and of the
/// gradient of the displacements.
#[inline]
pub(super) fn stress_change<T: Scalar>(
    point: &Point<T>,
    df: &[T; 4],
    stress: &[T; 3],
    gradient: &[T; 4],
) -> [T; 4] {
    let geometric = Point::first_stress(df, &point.stress);
    let elastic = Point::first_stress(&point.deformation, stress);
    let change = [0, 1, 2, 3].map(|i| geometric[i] + elastic[i]);
    let [_, xz, _, zz] = Point::first_stress(&point.deformation, &point.stress);
    let [q_s, q_z, ..] = *gradient;
    let nodal = nodal(&change, &point.label);
    [nodal[0] + q_z * xz, nodal[1] - q_s * xz, nodal[2] + q_z * zz, nodal[3] - q_s * zz]
}
