//! Direct solves for small contacts.
//!
//! A contact of a few points on a fine grid is a small dense system, whose matrix is read from the kernel. Its factors
//! cost less than the transforms of the whole grid that an iteration takes, and a fine grid then needs only one
//! transform, to check that its other points stay open.

use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Col, Mat};

/// Largest ratio of the multiplications of the factors, `m³/3` for `m` contact points, to `n log2 n` of a grid of `n`
/// points at which factors are used: about where they cost as much as an iteration, for 1024 to 65536 points.
const WORTH: f64 = 30.0;

/// Whether a set of `contact` points on a grid of `points` is small enough.
pub(super) fn is_worth_it(contact: usize, points: usize) -> bool {
    let grid = points as f64;
    (contact as f64).powi(3) / 3.0 <= WORTH * grid * grid.log2()
}

/// The dense system of a contact set, factorised.
pub(super) struct Dense {
    factors: PartialPivLu<f64>,
    /// Scale of a displacement in m/Pa, the unit of the separation, so that all columns have the same size.
    softness: f64,
}

impl Dense {
    /// For the `kernel` K in m/Pa, the displacement by a unit pressure at point 0 of a line.
    pub fn new(kernel: &[f64], set: &[u32]) -> Self {
        let n = kernel.len();
        Self::with_influence(set, kernel[0].abs(), |i, j| {
            kernel[(set[i] as usize + n - set[j] as usize) % n]
        })
    }

    /// For the displacement in m/Pa, `influence(i, j)`, of the point `set[i]` by a unit pressure at `set[j]`, and their
    /// scale, `softness`.
    pub fn with_influence(
        set: &[u32],
        softness: f64,
        influence: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let m = set.len();
        let matrix = Mat::from_fn(m + 1, m + 1, |i, j| match (i == m, j == m) {
            (true, true) => 0.0,
            (false, false) => influence(i, j) / softness,
            _ => 1.0,
        });
        Self { factors: PartialPivLu::new(matrix.as_ref()), softness }
    }

    /// Pressures `t_j` in Pa with the sum `load` for which `sum_j K(i - j) t_j + ubar = gap_i`, with some
    /// separation `ubar`. `None` if the system is singular to working precision.
    pub fn solve(&self, gaps: &[f64], load: f64) -> Option<Vec<f64>> {
        let m = gaps.len();
        // A separation common to all points does not change the pressures; subtracted first, it costs them no digits.
        let common = gaps[0];
        let right =
            Col::from_fn(m + 1, |i| if i == m { load } else { (gaps[i] - common) / self.softness });
        let solution = self.factors.solve(right);
        let pressure: Vec<f64> = (0..m).map(|i| solution[i]).collect();
        pressure.iter().all(|t| t.is_finite()).then_some(pressure)
    }
}

#[cfg(test)]
mod tests {
    use super::super::half_space::HalfSpace;
    use super::*;
    use crate::rubber::{MaxwellBranch, Rubber};
    use realfft::RealFftPlanner;

    #[test]
    fn the_pressures_close_the_gap_on_the_set_under_the_transform_too() {
        let branches = vec![MaxwellBranch { modulus: 5e8, relaxation_time: 1e-5 }];
        let (name, equilibrium_modulus, poisson_ratio) = ("one branch".into(), 2e6, 0.45);
        let rubber =
            Rubber { name, branches, ..Rubber::elastic(equilibrium_modulus, poisson_ratio) };
        let n = 512;
        let mut space = HalfSpace::new(&mut RealFftPlanner::new(), &rubber, 0.2, 1e-3, n).unwrap();
        let mut unit = vec![0.0; n];
        unit[0] = 1.0;
        let mut kernel = vec![0.0; n];
        space.displacement(&unit, &mut kernel);
        let heights: Vec<f64> = (0..n).map(|i| 1e-6 * ((i * i) as f64 * 0.01).sin()).collect();
        // Two contacts, one of them across the end of the period, and a single point.
        let set: Vec<u32> =
            [(0..9), (200..240), (300..301), (505..512)].into_iter().flatten().collect();
        let load = 3e5 * n as f64;
        let gaps: Vec<f64> = set.iter().map(|i| heights[*i as usize]).collect();
        let solved = Dense::new(&kernel, &set).solve(&gaps, load).unwrap();
        let mut pressure = vec![0.0; n];
        set.iter().zip(&solved).for_each(|(i, t)| pressure[*i as usize] = *t);
        let mut displacement = vec![0.0; n];
        space.displacement(&pressure, &mut displacement);
        let scale = displacement.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        // The same separation everywhere.
        let separation = |i: &u32| heights[*i as usize] - displacement[*i as usize];
        for i in &set {
            let gap = separation(i) - separation(&set[0]);
            assert!(gap.abs() <= 1e-13 * scale, "{i}: {gap}");
        }
        approx::assert_relative_eq!(pressure.iter().sum::<f64>(), load, max_relative = 1e-12);
    }

    #[test]
    fn small_contacts_of_fine_grids_are_worth_it() {
        assert!(is_worth_it(1, 64) && is_worth_it(300, 65536) && is_worth_it(30, 64));
        assert!(!is_worth_it(65536, 65536) && !is_worth_it(60, 64));
    }
}
