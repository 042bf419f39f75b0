//! Approximate inverse of the half-space operator on a contact set, by factors.
//!
//! The matrix of the operator on the set, `K(i - j)` with `K` the displacement by a unit pressure, is smooth away from
//! its diagonal. Compressed to four digits it is factorised in [`O(n log² n)`](super::hierarchical) for `n` points in
//! contact, however many patches they make and however lossy the rubber is, and with these factors a Krylov method needs
//! two or three iterations, of one pair of transforms each.
//!
//! For a set that differs by few points the same factors serve. With `O` the points of the factors, `R` those that have
//! left and `D` those that have entered, the system on the new set is that on `O` and `D` with forces `λ` that hold the
//! pressures on `R` at zero:
//!
//! ```text
//! t_O = A_OO^-1 (r_O + E_R λ - A_OD t_D),    t_R = 0,    A_DO t_O + A_DD t_D = r_D
//! ```
//!
//! which is a small dense system for `λ` and `-t_D`.

use super::hierarchical::{Compressed, Factors};
use super::influence::Influence;
use faer::linalg::solvers::DenseSolveCore;
use faer::{Col, ColRef, Mat};

/// What compression may leave out, relative: solves then take two or three iterations. A hundredth costs an elastic body
/// no more time, with twice the iterations, but is too much where losses are high.
const TOLERANCE: f64 = 1e-4;
/// Points by which a set may differ from that of the factors.
const MOST_CHANGES: usize = 32;

/// Approximates, like the [`Preconditioner`](super::preconditioner::Preconditioner), the pressures on the contact set
/// that give a displacement there at unchanged load.
pub(super) struct Inverse {
    /// Set of the factors.
    factorised: Vec<u32>,
    factors: Factors,
    /// Unit of the factors in m/Pa.
    softness: f64,
    /// The set that they are taken for, and how it differs from theirs.
    present: Vec<u32>,
    changes: Changes,
    /// Pressures with unit sum on the present set that displace it uniformly.
    uniform: Vec<f64>,
}

/// From the set of the factors to the present one.
struct Changes {
    /// Places in the set of the factors and in the present one of the points of both.
    common: Vec<(u32, u32)>,
    /// Places in the present set of the points that have entered.
    entered: Vec<u32>,
    /// Rows of the points that have left in the identity, then rows `A_DO`.
    rows: Mat<f64>,
    /// `A_OO^-1 [E_R, A_OD]`
    columns: Mat<f64>,
    /// Inverse of `rows columns - [0 0; 0 A_DD]`.
    small: Mat<f64>,
}

impl Inverse {
    /// Factors for a nonempty set; `kernel` is the displacement by a unit pressure at point 0.
    pub fn new(kernel: &[f64], set: &[u32]) -> Self {
        let influence = Influence::new(kernel);
        let entry = |i: usize, j: usize| influence.at(set[i], set[j]);
        let compressed = Compressed::new(0..set.len(), TOLERANCE, &entry);
        let mut inverse = Self {
            factorised: set.to_vec(),
            factors: compressed.factorise(&vec![influence.at(0, 0); set.len()]),
            softness: influence.softness,
            present: set.to_vec(),
            changes: Changes::none(set.len()),
            uniform: Vec::new(),
        };
        inverse.uniform = inverse.under_a_flat_punch(set.len());
        inverse
    }

    /// Takes the factors for another set; `false` if it differs by too many points.
    pub fn adapt(&mut self, kernel: &[f64], set: &[u32]) -> bool {
        if self.present == set {
            return true;
        }
        let Some(changes) = self.changes_to(kernel, set) else {
            return false;
        };
        self.changes = changes;
        self.present = set.to_vec();
        self.uniform = self.under_a_flat_punch(set.len());
        true
    }

    /// Spreads `force` (a sum over grid points) over the set without a change of its shape.
    pub fn add_force(&self, force: f64, pressure: &mut [f64]) {
        pressure.iter_mut().zip(&self.uniform).for_each(|(t, u)| *t += force * u);
    }

    /// Pressures (sum zero) for the displacements `r` on the set.
    pub fn apply(&self, r: &[f64], pressure: &mut [f64]) {
        // A displacement common to all points makes no pressures of sum zero. Left in, it would make large ones, and
        // what remains of these after the subtraction below would be round-off with a sum, which no Krylov vector has.
        let mean = r.iter().sum::<f64>() / r.len() as f64;
        let about_mean: Vec<f64> = r.iter().map(|r| r - mean).collect();
        self.solve(&about_mean, pressure);
        for _ in 0..2 {
            let total: f64 = pressure.iter().sum();
            self.add_force(-total, pressure);
        }
    }

    fn under_a_flat_punch(&self, points: usize) -> Vec<f64> {
        let mut uniform = vec![0.0; points];
        self.solve(&vec![self.softness; points], &mut uniform);
        let total: f64 = uniform.iter().sum();
        uniform.iter_mut().for_each(|t| *t /= total);
        uniform
    }

    /// Pressures, of any sum, for the displacements `r`.
    fn solve(&self, r: &[f64], pressure: &mut [f64]) {
        let Changes { common, entered, rows, columns, small } = &self.changes;
        let mut solved = vec![0.0; self.factorised.len()];
        for (old, new) in common {
            solved[*old as usize] = r[*new as usize] / self.softness;
        }
        self.factors.solve_one_in_place(&mut solved);
        if rows.nrows() > 0 {
            let left = rows.nrows() - entered.len();
            let mut missing = -(rows * ColRef::from_slice(&solved));
            for (k, new) in entered.iter().enumerate() {
                missing[left + k] += r[*new as usize] / self.softness;
            }
            let forces: Col<f64> = small * missing;
            let correction = columns * &forces;
            solved.iter_mut().zip(correction.iter()).for_each(|(t, dt)| *t += dt);
            for (k, new) in entered.iter().enumerate() {
                pressure[*new as usize] = -forces[left + k];
            }
        }
        for (old, new) in common {
            pressure[*new as usize] = solved[*old as usize];
        }
    }

    fn changes_to(&self, kernel: &[f64], set: &[u32]) -> Option<Changes> {
        let old = &self.factorised;
        let (mut common, mut entered, mut left) = (Vec::new(), Vec::new(), Vec::new());
        let (mut i, mut j) = (0, 0);
        while i < old.len() || j < set.len() {
            match (old.get(i), set.get(j)) {
                (Some(a), Some(b)) if a == b => {
                    common.push((i as u32, j as u32));
                    (i, j) = (i + 1, j + 1);
                }
                (Some(a), b) if b.is_none_or(|b| a < b) => {
                    left.push(i);
                    i += 1;
                }
                _ => {
                    entered.push(j as u32);
                    j += 1;
                }
            }
            if left.len() + entered.len() > MOST_CHANGES {
                return None;
            }
        }
        let (m, n) = (left.len() + entered.len(), old.len());
        let place = |k: usize| set[entered[k - left.len()] as usize];
        let influence = Influence::new(kernel);
        let of = |to: u32, from: u32| influence.at(to, from);
        let unit = |k: usize, i: usize| f64::from(u8::from(left[k] == i));
        let is_unit = |k: usize| k < left.len();
        let rows =
            Mat::from_fn(m, n, |k, i| if is_unit(k) { unit(k, i) } else { of(place(k), old[i]) });
        let mut columns =
            Mat::from_fn(n, m, |i, k| if is_unit(k) { unit(k, i) } else { of(old[i], place(k)) });
        self.factors.solve_in_place(columns.as_mut());
        let product = &rows * &columns;
        let small = Mat::from_fn(m, m, |k, l| {
            let between = if is_unit(k) || is_unit(l) { 0.0 } else { of(place(k), place(l)) };
            product[(k, l)] - between
        });
        Some(Changes { common, entered, rows, columns, small: small.partial_piv_lu().inverse() })
    }
}

impl Changes {
    fn none(points: usize) -> Self {
        Self {
            common: (0..points as u32).map(|i| (i, i)).collect(),
            entered: Vec::new(),
            rows: Mat::zeros(0, points),
            columns: Mat::zeros(points, 0),
            small: Mat::zeros(0, 0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::direct::Dense;
    use super::super::half_space::HalfSpace;
    use super::*;
    use crate::numerics::krylov::euclidean_norm;
    use crate::rubber::{MaxwellBranch, Rubber};
    use realfft::RealFftPlanner;

    const POINTS: usize = 8192;

    fn kernel() -> Vec<f64> {
        let branches = vec![MaxwellBranch { modulus: 5e8, relaxation_time: 1e-5 }];
        let (name, equilibrium_modulus, poisson_ratio) = ("one branch".into(), 2e6, 0.45);
        let rubber = Rubber { name, equilibrium_modulus, branches, poisson_ratio };
        let mut space =
            HalfSpace::new(&mut RealFftPlanner::new(), &rubber, 0.2, 1e-2, POINTS).unwrap();
        let mut unit = vec![0.0; POINTS];
        unit[0] = 1.0;
        let mut kernel = vec![0.0; POINTS];
        space.displacement(&unit, &mut kernel);
        kernel
    }

    /// Patches of one to nineteen points, one of them across the end of the grid.
    fn patches() -> Vec<u32> {
        (0..POINTS as u32).filter(|i| (i + 9) % 128 < 1 + (i + 9) / 128 * 7 % 19).collect()
    }

    /// Relative error of the pressures for displacements of no particular shape. The condition number makes it larger than
    /// the tolerance.
    fn error(inverse: &Inverse, kernel: &[f64], set: &[u32]) -> f64 {
        let r: Vec<f64> = set.iter().map(|i| 1e-6 * (f64::from(*i) * 0.02).sin()).collect();
        let exact = Dense::new(kernel, set).solve(&r, 0.0).unwrap();
        let mut pressure = vec![f64::NAN; set.len()];
        inverse.apply(&r, &mut pressure);
        assert!(pressure.iter().sum::<f64>().abs() < 1e-10 * euclidean_norm(&exact));
        let difference: Vec<f64> = pressure.iter().zip(&exact).map(|(a, b)| a - b).collect();
        euclidean_norm(&difference) / euclidean_norm(&exact)
    }

    #[test]
    fn the_factors_leave_little_of_the_pressures_to_iterations() {
        let (kernel, set) = (kernel(), patches());
        let inverse = Inverse::new(&kernel, &set);
        let error = error(&inverse, &kernel, &set);
        assert!(error < 2e-2, "{error}");
    }

    #[test]
    fn a_large_common_displacement_leaves_no_force_in_the_round_off() {
        let (kernel, set) = (kernel(), patches());
        let inverse = Inverse::new(&kernel, &set);
        let r: Vec<f64> = set.iter().map(|i| 1.0 + 1e-6 * (f64::from(*i) * 0.02).sin()).collect();
        let mut pressure = vec![f64::NAN; set.len()];
        inverse.apply(&r, &mut pressure);
        let all: f64 = pressure.iter().map(|t| t.abs()).sum();
        // Its own pressures are a million times as large, and so is their round-off.
        assert!(pressure.iter().sum::<f64>().abs() < 1e-14 * all);
    }

    #[test]
    fn they_leave_no_more_where_a_few_points_have_left_or_entered() {
        let (kernel, set) = (kernel(), patches());
        let mut inverse = Inverse::new(&kernel, &set);
        let edges = [set[0], set[40], set[41], set[200]];
        let mut other: Vec<u32> = set.iter().copied().filter(|i| !edges.contains(i)).collect();
        other.extend([set[100] + 64, set[300] + 65]);
        other.extend(
            (0..POINTS as u32).filter(|i| set.binary_search(&(i + 1)).is_ok()).skip(90).take(3),
        );
        other.sort_unstable();
        other.dedup();
        assert!(inverse.adapt(&kernel, &other));
        let adapted = error(&inverse, &kernel, &other);
        assert!(adapted < 2e-2, "{adapted}");
        // Back to its own set, and not to one of too many other points.
        assert!(inverse.adapt(&kernel, &set));
        let own = error(&inverse, &kernel, &set);
        assert!(own < 2e-2, "{own}");
        assert!(!inverse.adapt(&kernel, &set[MOST_CHANGES + 1..]));
    }
}
